"""A whole motion: simulated under the plain law, or tracked within the joints' limits."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .._core import failed, rollout
from ..arms import Arm, JointLimits
from ..clearance import Clearance
from ..errors import ResolutionError
from ..paths import Path
from ..schemes import Scheme
from .run import Run, RunStatus


class LimitOptions(NamedTuple):
    """How a motion keeps its joints' limits; the fields are arguments of track(), in the compiled part's order."""

    limits: JointLimits | None = None
    error_bound: float = 0.1
    integral_gain: float = 0.0
    integral_bound: float = 1.0
    stall_time: float = 2.0
    singular_radius: float = 0.02
    singular_brake: float = 10.0
    null_damping: float = 2.0
    clearance: Clearance | None = None


def simulate(
    arm: Arm,
    path: Path,
    scheme: Scheme,
    q0: ArrayLike,
    *,
    dt: float = 1e-3,
    hold: float = 0.0,
    qd0: ArrayLike | None = None,
    task: str = "position",
    partial: bool = False,
) -> Run:
    """Move an arm along a path under a scheme, by RK4 at fixed steps.

    The path is a displacement from where the tip starts, f(q0). Velocity-level schemes integrate q, acceleration-level
    schemes q and qd. Runs without the interpreter's lock. The run's status says how it ended.

    Raises ValueError if an argument is out of range, not finite, or of the wrong shape: nothing is run. Raises
    ResolutionError if the motion must stop early: its run holds the part before.

    Parameters
    ----------
    arm, path, scheme
        What moves, along what, and how.
    q0 : array_like, shape (n,)
        Joint positions at the start [rad].
    dt : float
        Step [s]; it must divide the path's duration and the hold.
    hold : float
        Time to stay at rest on the path's end afterwards [s].
    qd0 : array_like, shape (n,), optional
        Joint velocities at the start [rad/s], zero by default; velocity-level schemes do not read them.
    task : str
        'position', or 'pose' to track the tip's orientation as well.
    partial : bool
        If the motion must stop early, return what was done instead of raising.
    """
    options = motion_options(arm, dt, hold, qd0)
    outcome = rollout(arm, path, scheme, q0, options["qd0"], dt, hold, task)
    run = make_run(outcome, q0, arm, path, scheme, task, options)
    if failed(run.status.code) and not partial:
        raise ResolutionError(run.status.code, str(run.status), run)
    return run


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
    error_bound: float = 0.1,
    integral_gain: float = 0.0,
    integral_bound: float = 1.0,
    stall_time: float = 2.0,
    singular_radius: float = 0.02,
    singular_brake: float = 10.0,
    null_damping: float = 2.0,
    clearance: Clearance | None = None,
) -> Run:
    """Move an arm along a path under a scheme, within its joints' limits and through singular postures.

    The motion is a Tracker's, where simulate() has the plain law's: every joint keeps its bounds, the motion is damped
    near singular postures, and nothing makes it stop early. Sample k is the state at t_k, the tip's error there, and
    the tick that begins there: its mean acceleration, its scale, and which joints it had on a bound. The run's status
    is the worst of all ticks: OK, DAMPED, SLOWED, BLOCKED or STALLED; without damping it may be SINGULAR, where the arm
    braked. Raises ValueError as simulate() does, and if a limit is missing or the start breaks one or is not clear.

    Parameters
    ----------
    arm, path, scheme, q0, dt, hold, qd0, task
        As for simulate(); q0 and qd0 must be within the limits. If the limits make the arm late, a longer hold lets it
        arrive.
    limits, error_bound, integral_gain, integral_bound, stall_time
        As for Tracker.
    singular_radius, singular_brake, null_damping, clearance
        As for Tracker.
    """
    options = motion_options(arm, dt, hold, qd0)
    limited = LimitOptions(
        limits,
        error_bound,
        integral_gain,
        integral_bound,
        stall_time,
        singular_radius,
        singular_brake,
        null_damping,
        clearance,
    )
    outcome = rollout(arm, path, scheme, q0, options["qd0"], dt, hold, task, limited)
    return make_run(outcome, q0, arm, path, scheme, task, {**options, **limited._asdict()})


def motion_options(arm: Arm, dt: float, hold: float, qd0: ArrayLike | None = None) -> dict[str, Any]:
    """The keyword arguments that every motion has, as its run keeps them."""
    start = np.zeros(arm.dof) if qd0 is None else np.array(qd0, dtype=float)
    return {"dt": float(dt), "hold": float(hold), "qd0": start.ravel().tolist()}


def make_run(
    outcome: Any, q0: ArrayLike, arm: Arm, path: Path, scheme: Scheme, task: str, options: dict[str, Any]
) -> Run:
    """A run of what the compiled part gives: status, time, number of samples, and arrays filled as far as these."""
    code, time, samples, arrays = outcome
    arrays = [array if samples == len(array) else array[:samples].copy() for array in arrays]
    t, q, qd, qdd, x, x_ref, error, *limited = arrays
    if scheme.level == "velocity" and samples > 1 and not limited:
        qdd = np.gradient(qd, t, axis=0)
    status = RunStatus(code, time, q[-1].copy() if samples else np.array(q0, dtype=float))
    return Run(t, q, qd, qdd, x, x_ref, error, status, arm, path, scheme, task, options, *limited)
