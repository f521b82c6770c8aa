"""A whole motion within the joints' limits."""

from __future__ import annotations

import copyreg
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._core import Arm, JointLimits, Path, Scheme, Tracker
from ._types import Array
from .run import Run, RunStatus


def track(
    arm: Arm,
    path: Path,
    scheme: Scheme,
    q0: ArrayLike,
    *,
    dt: float = 1e-3,
    hold: float = 0.0,
    qd0: ArrayLike | None = None,
    task: str = "position",
    limits: JointLimits | None = None,
    pull: float = 0.1,
    integral_gain: float = 0.0,
    integral_bound: float = 1.0,
    singular_radius: float = 0.02,
    singular_brake: float = 10.0,
) -> Run:
    """Move an arm along a path under a scheme, within its joints' limits and through singular postures.

    What simulate() is for the plain law, track() is for a Tracker: the same path, sampled at the same times, but every
    joint keeps its bounds, near singular postures the motion is damped, and nothing makes it stop early. What the
    limits did is in the run's scale and saturated.

    Sample k is the state at t_k, the tip's error there, and the tick that begins there: its mean acceleration, its
    scale, and which joints it had on a bound.

    Parameters
    ----------
    arm, path, scheme
        What moves, along what, and how.
    q0 : array_like, shape (n,)
        Joint positions at the start [rad], within the limits.
    dt : float
        Length of a tick [s]; it must divide the path's duration and the hold.
    hold : float
        How long to stay on the path's end afterwards [s]: longer where the limits made the arm late.
    qd0 : array_like, shape (n,), optional
        Joint velocities at the start [rad/s], zero unless given.
    task : str
        'position', or 'pose' to track the tip's orientation as well.
    limits : JointLimits, optional
        The arm's own unless given. A joint with bounds needs one on its acceleration, except at velocity level.
    pull : float
        How far away the target may seem at most [m, rad]: a farther one pulls no harder.
    integral_gain, integral_bound : float
        Gain of the integral of the error, [1/s^3] or [1/s^2] at velocity level, off by default, and the most that it
        adds [m/s^2] or [m/s]. Stable below k1 k2.
    singular_radius, singular_brake : float
        Damping near singular postures, where the scheme has none; 0 switches it off.

    Returns
    -------
    Run
        The motion; run.status is the worst of any tick: OK, DAMPED or SLOWED. Without damping it may be SINGULAR: there
        the arm braked.

    Raises
    ------
    ValueError
        Where an argument is out of range, not finite, or of the wrong shape, a limit is missing, or the start breaks
        one; nothing is run.
    """
    _, samples = _core.check_sweep(arm, path, [], np.zeros(arm.dof), dt, hold, task)
    tick_length = path.duration / round(path.duration / dt)  # As in simulate(), where dt divides but for round-off.
    how: dict[str, Any] = {
        "limits": limits,
        "pull": float(pull),
        "integral_gain": float(integral_gain),
        "integral_bound": float(integral_bound),
        "singular_radius": float(singular_radius),
        "singular_brake": float(singular_brake),
    }
    tracker = Tracker(arm, scheme, q0, qd0=qd0, task=task, dt=tick_length, **how)
    course = tracker.course(path)

    n, m = arm.dof, len(arm.jacobian(tracker.q, task=task))
    q, qd, qdd = np.empty((samples, n)), np.empty((samples, n)), np.empty((samples, n))
    error, scale, saturated = np.empty((samples, m)), np.empty(samples), np.empty((samples, n), dtype=bool)
    course_time = np.empty(samples)
    options = {"dt": float(dt), "hold": float(hold), "qd0": tracker.qd.tolist(), **how}
    statuses = set()
    for k in range(samples):
        q[k], qd[k], course_time[k] = tracker.q, tracker.qd, course.time
        tick = tracker.tick(course)
        qdd[k], error[k], scale[k], saturated[k] = tick.qdd, tick.error, tick.scale, tick.saturated
        statuses.add(tick.status)

    t: Array = tick_length * np.arange(samples, dtype=float)
    x = np.array([arm.kinematics(row, row, task=task).tip for row in q])
    status = RunStatus(max(statuses, key=lambda status: int(status.value)), float(t[-1]), q[-1].copy())
    x_ref = _laid_out(path, course_time, x[0])
    return Run(t, q, qd, qdd, x, x_ref, error, status, arm, path, scheme, task, options, scale, saturated)


def _laid_out(path: Path, times: Array, start: Array) -> Array:
    """The path's points at these times, from where the tip starts.

    A path of the plane lies in space's xy plane; a path of positions holds the orientation.
    """
    ways = np.array([path.sample(t)[0] for t in times])
    points = np.repeat(start[None], len(ways), axis=0)
    if ways.ndim == 3:
        points[:, :3, 3] += ways[:, :3, 3]
        points[:, :3, :3] = ways[:, :3, :3] @ start[:3, :3]
    elif start.ndim == 2:
        points[:, : ways.shape[1], 3] += ways
    else:
        points[:, : ways.shape[1]] += ways
    return points


def _made_again(limits: JointLimits) -> tuple[partial[JointLimits], tuple[()]]:
    bounds = {"lower": limits.lower, "upper": limits.upper}
    return partial(JointLimits, **bounds, velocity=limits.velocity, acceleration=limits.acceleration), ()


copyreg.pickle(JointLimits, _made_again)  # Runs hold their limits, and go through pickle with them.
