"""What a scheme can be tuned for: a number of its motion, to be made small."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..arms import JointLimits
from ..motion.run import Run

OfRun = Callable[[Run], float]


def energy(run: Run) -> float:
    """Integral of |qd|² over the motion [rad²/s], by the trapezoidal rule."""
    squares = np.sum(run.qd**2, axis=1)
    return float(np.sum(np.diff(run.t) * (squares[1:] + squares[:-1])) / 2)


def limit_distance(run: Run) -> float:
    """Largest share of its range that a joint with two bounds uses: 0 in the middle, 1 on a bound, more beyond it."""
    bounded = _bounded(run.limits)
    lower, upper = run.limits.lower[bounded], run.limits.upper[bounded]
    return float(np.max(np.abs(2 * run.q[:, bounded] - (lower + upper)) / (upper - lower)))


def _bounded(limits: JointLimits) -> NDArray[np.bool_]:
    """Which joints have two bounds, and can move between them."""
    return np.isfinite(limits.lower) & np.isfinite(limits.upper) & (limits.lower < limits.upper)


# Unit, and function of a Run; None for a key figure of a sweep, which is faster.
OBJECTIVES: dict[str, tuple[str, OfRun | None]] = {
    "peak_velocity": ("rad/s", None),
    "peak_acceleration": ("rad/s²", None),
    "final_velocity": ("rad/s", None),
    "energy": ("rad²/s", energy),
    "limit_distance": ("of the range", limit_distance),
}


def measure(objective: str | OfRun, limits: JointLimits) -> tuple[str, str, OfRun | None]:
    """Name, unit and function. Raises ValueError if it is unknown, or needs bounds that the limits do not have."""
    if callable(objective):
        return getattr(objective, "__name__", type(objective).__name__), "", objective
    if objective not in OBJECTIVES:
        names = ", ".join(map(repr, OBJECTIVES))
        raise ValueError(f"objective = {objective!r}: must be one of {names}, or a function of a Run")
    if objective == "limit_distance" and not np.any(_bounded(limits)):
        raise ValueError("objective = 'limit_distance': the arm has no joint that is bounded both ways")
    return objective, *OBJECTIVES[objective]
