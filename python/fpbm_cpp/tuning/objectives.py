"""What a scheme can be tuned for: one number of a motion, the smaller the better."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable, Union

import numpy as np
from numpy.typing import NDArray

from .._core import Arm
from .._types import Array
from ..run import Run
from ..sweep_result import Sweep

Objective = Union[str, Callable[[Run], float]]

# Key figures that a sweep keeps of each motion, which is what its lanes are fast at.
KEY_FIGURES = {"peak_velocity": "rad/s", "peak_acceleration": "rad/s²", "final_velocity": "rad/s"}


def energy(run: Run) -> float:
    """Integral of |qd|^2 over the motion [rad^2/s], by the trapezoidal rule."""
    squares = np.sum(run.qd**2, axis=1)
    return float(np.sum(np.diff(run.t) * (squares[1:] + squares[:-1])) / 2)


def range_used(run: Run) -> float:
    """Largest share of its range that a joint uses: 0 in the middle, 1 on a bound, more beyond it.

    Over the joints that the arm's limits bound both ways.
    """
    limits = run.arm.limits
    bounded = _bounded(run.arm)
    lower, upper = limits.lower[bounded], limits.upper[bounded]
    return float(np.max(np.abs(2 * run.q[:, bounded] - (lower + upper)) / (upper - lower)))


def _bounded(arm: Arm) -> NDArray[np.bool_]:
    """Which joints are bounded both ways, and free to move between."""
    lower, upper = arm.limits.lower, arm.limits.upper
    return np.isfinite(lower) & np.isfinite(upper) & (lower < upper)


OF_RUNS: dict[str, tuple[Callable[[Run], float], str]] = {
    "energy": (energy, "rad²/s"),
    "limit_distance": (range_used, "of the range"),
}


@dataclass(frozen=True)
class Measure:
    """An objective that was asked for: its name, its unit, and how it is had of a Run; None for a key figure."""

    name: str
    unit: str
    of_run: Callable[[Run], float] | None

    def __call__(self, sweep: Sweep) -> Array:
        """The objective of each scheme of a sweep from one start, not a number where a motion stopped early."""
        if self.of_run is None:
            values = getattr(sweep, self.name)[:, 0]
        else:
            pairs = zip(sweep.ok[:, 0], sweep.motions[:, 0]) if sweep.motions is not None else ()
            values = [float(self.of_run(run)) if ok else np.nan for ok, run in pairs]
        return np.where(sweep.ok[:, 0], values, np.nan)


def measure(objective: Objective, arm: Arm) -> Measure:
    """The measure of an objective; raises ValueError where there is none of that name, or the arm has no bounds."""
    if callable(objective):
        return Measure(getattr(objective, "__name__", type(objective).__name__), "", objective)
    if objective in KEY_FIGURES:
        return Measure(objective, KEY_FIGURES[objective], None)
    if objective not in OF_RUNS:
        names = ", ".join(map(repr, (*KEY_FIGURES, *OF_RUNS)))
        raise ValueError(f"objective = {objective!r}: must be one of {names}, or a function of a Run")
    if objective == "limit_distance" and not np.any(_bounded(arm)):
        raise ValueError("objective = 'limit_distance': the arm has no joint that is bounded both ways")
    return Measure(objective, OF_RUNS[objective][1], OF_RUNS[objective][0])
