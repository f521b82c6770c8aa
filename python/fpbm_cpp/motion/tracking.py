"""A whole motion within the joints' limits."""

from typing import NamedTuple

from numpy.typing import ArrayLike

from .._core import track as rollout
from ..arms import Arm, JointLimits
from ..paths import Path
from ..schemes import Scheme
from .run import Run
from .simulation import make_run, motion_options


class LimitOptions(NamedTuple):
    """How a motion keeps its joints' limits; the fields are arguments of track(), in the compiled part's order."""

    limits: JointLimits | None = None
    max_error: float = 0.1
    integral_gain: float = 0.0
    integral_bound: float = 1.0
    singular_radius: float = 0.02
    singular_brake: float = 10.0


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
    max_error: float = 0.1,
    integral_gain: float = 0.0,
    integral_bound: float = 1.0,
    singular_radius: float = 0.02,
    singular_brake: float = 10.0,
) -> Run:
    """Move an arm along a path under a scheme, within its joints' limits and through singular postures.

    The motion is a Tracker's, where simulate() has the plain law's: the path is the same, sampled at the same times,
    but every joint keeps its bounds, the motion is damped near singular postures, and nothing makes it stop early. The
    run's scale and saturated say what the limits did. Runs without the interpreter's lock.

    Sample k is the state at t_k, the tip's error there, and the tick that begins there: its mean acceleration, its
    scale, and which joints it had on a bound.

    Parameters
    ----------
    arm, path, scheme, q0, dt, hold, qd0, task
        As for simulate(); q0 and qd0 must be within the limits. If the limits make the arm late, a longer hold lets it
        arrive.
    limits : JointLimits, optional
        The arm's own by default. A joint with bounds needs one on its acceleration, except at velocity level.
    max_error : float
        Largest error that the feedback sees [m, rad]; a larger one is scaled down to it.
    integral_gain, integral_bound : float
        Gain of the integral of the error, [1/s^3] or [1/s^2] at velocity level, off by default, and the most that it
        adds [m/s^2] or [m/s]. Stable below k1 k2.
    singular_radius, singular_brake : float
        Damping near singular postures for a scheme that has none; 0 switches it off.

    Returns
    -------
    Run
        The motion; run.status is the worst of all ticks: OK, DAMPED or SLOWED. Without damping it may be SINGULAR:
        there the arm braked.

    Raises
    ------
    ValueError
        If an argument is out of range, not finite, or of the wrong shape, a limit is missing, or the start breaks one;
        nothing is run.
    """
    options = motion_options(arm, dt, hold, qd0)
    limited = LimitOptions(limits, max_error, integral_gain, integral_bound, singular_radius, singular_brake)
    code, time, samples, arrays, scale, saturated = rollout(
        arm, path, scheme, q0, options["qd0"], dt, hold, task, *limited
    )
    made_of = q0, arm, path, scheme, task, {**options, **limited._asdict()}
    return make_run(code, time, samples, (*arrays, scale, saturated), *made_of)
