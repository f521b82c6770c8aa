"""A motion that keeps its path and takes the least time within the limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._core import failed, message
from .._core import fastest as fastest_motion
from ..arms import Arm
from ..bounds import Bound, bounds_of
from ..errors import wrong
from ..joints import JointLimits, limits_of
from ..robots import Robot
from ..schemes import Scheme
from ..tasks import Stack
from .run import Run
from .run_data import ON_BOUND, Paths
from .simulation import kept_paths, make_run, require_motion, task_and_paths

REMEDY = "Keep the path inside the workspace and away from singular postures, or choose another q0, scheme or weights."


def fastest(
    arm: Arm | Robot,
    path: Paths,
    scheme: Scheme,
    q0: ArrayLike,
    *,
    dt: float = 1e-3,
    task: str | None = None,
    stack: Stack | None = None,
    limits: JointLimits | None = None,
    tip_speed: float | None = None,
    tip_acceleration: float | None = None,
    start_speed: float = 0.0,
    end_speed: float = 0.0,
    bounds: Sequence[Bound] = (),
) -> Run:
    """Move an arm along a path in the least time within its limits; the tip stays on the path.

    The scheme gives the joint positions along the whole path. The clock of the path then minimises the duration within
    the bounds on velocity, acceleration and jerk of all joints (docs: Paths in the least time), and on torques at both
    ends of every tick, with TorqueBounds. The motion begins and ends at rest, or with the given speeds of the tip: the
    bounds then hold from the first sample to the last. The durations and time laws of shapes have no effect: only the
    geometry counts, and paths need no duration. The speed of a path at_speed() is a bound. Between the parts of a
    Sequence, the arm stops. run.saturated, run.bottleneck and run.bound_ratios() show which bounds limit the motion.

    Parameters
    ----------
    arm, path, q0, dt, task, stack
        As for simulate(). The motion lasts a multiple of dt.
    scheme
        A scheme at velocity level.
    limits : JointLimits, optional
        Limits of the joints, by default the arm's; each joint needs a bound on its acceleration.
    tip_speed, tip_acceleration : float, optional
        Bounds on the tip; for a stack, on the frame of the task of x [m/s, m/s^2].
    start_speed, end_speed : float
        Speeds of the tip along the path at the start and at the end; for a stack, of the frame of the task of x [m/s].
        Zero: at rest. Waypoints and cusps have no bounded curvature at their ends, and need zero.
    bounds : sequence of Clearance, TaskBounds and TorqueBounds, optional
        Bounds that the motion must keep. The scheme does not avoid them.

    Raises
    ------
    ParameterError
        If an argument is out of range, or the scheme cannot follow the path within the ranges of the joints and within
        the bounds, or the arm cannot hold a posture of the path. The message says at which fraction of the path. If the
        bounds do not admit a speed at an end, the message has a lower speed.
    """
    require_motion(arm, path, scheme, timed=False)
    if scheme.level != "velocity":
        raise wrong(
            "scheme", scheme, f" = {scheme!r:.80}: must be at velocity level, for example MVN() or WMVN(weights)"
        )
    geometry, speed, _ = kept_paths(path, task)
    name, kind, followed, tasks = task_and_paths(geometry, task, stack)
    options: dict[str, Any] = {
        "dt": float(dt),
        "limits": limits_of(arm, limits),
        "tip_speed": tip_speed,
        "tip_acceleration": tip_acceleration,
        "start_speed": float(start_speed),
        "end_speed": float(end_speed),
        "bounds": bounds_of(bounds),
        "stack": stack,
    }
    tip = speed if tip_speed is None else min(tip_speed, speed), inf if tip_acceleration is None else tip_acceleration
    ends = [options["start_speed"], options["end_speed"]]
    if tasks is not None and tasks.other_paths and any(ends):
        many = f" and end_speed = {ends}: must be zero for paths of several tasks, which have several speeds"
        raise wrong("start_speed", start_speed, many)
    outcome = fastest_motion(
        arm, followed, scheme, q0, dt, kind, options["limits"], *tip, options["bounds"], tasks, ends
    )
    code, fraction, _, arrays = outcome
    if failed(code):
        where = np.array2string(arrays["q"], precision=4, separator=", ")
        problem = f": can be followed to the fraction {fraction:.3f} only, q = {where}: {message(code)}. {REMEDY}"
        raise wrong("path", path, problem)
    run = make_run(outcome, q0, arm, path, scheme, name, options, fastest)
    return replace(run, saturated=np.max(list(run.bound_ratios().values()), axis=0) > ON_BOUND)
