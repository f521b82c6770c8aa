"""Schemes that were tried, and the results of their motions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._types import Array
from ..motion.sweep_result import Sweep
from .objectives import Measure
from .search import pareto_front
from .space import TUNABLE


@dataclass(frozen=True, repr=False, eq=False)
class Trials:
    """T schemes and the results of their motions: arrays of shape (T,), in the order in which they were tried.

    Attributes
    ----------
    schemes : numpy.ndarray of FPBM
        The schemes.
    value : numpy.ndarray
        The objective; NaN if the motion stopped early.
    peak_velocity, peak_acceleration : numpy.ndarray
        Of the fastest joint [rad/s], [rad/s^2].
    error : numpy.ndarray
        Largest position error of the tip [m] or, where it is a larger number, its largest orientation error [rad].
    feasible : numpy.ndarray of bool
        Whether the motion is complete, its objective finite, and its error within the tolerance.
    """

    schemes: NDArray[Any]
    value: Array
    peak_velocity: Array
    peak_acceleration: Array
    error: Array
    feasible: NDArray[np.bool_]

    @property
    def parameters(self) -> dict[str, Array]:
        """The schemes' parameters by name: arrays of shape (T,), and (T, n) for the weights."""
        return {name: np.array([getattr(scheme, name) for scheme in self.schemes]) for name in TUNABLE}

    def front(self) -> Trials:
        """The feasible trials that no other beats in both peak velocity and peak acceleration, by peak velocity."""
        return self[pareto_front(*self.peaks().T)]

    def scores(self) -> Array:
        """The value of each; NaN if it is infeasible."""
        return np.where(self.feasible, self.value, np.nan)

    def peaks(self) -> Array:
        """Peak velocity and peak acceleration of each, shape (T, 2); NaN if it is infeasible."""
        pairs = np.column_stack([self.peak_velocity, self.peak_acceleration])
        return np.where(self.feasible[:, None], pairs, np.nan)

    def best(self) -> int:
        """Index of the first feasible trial of the least value; there must be a feasible one."""
        return int(np.nanargmin(self.scores()))

    def __getitem__(self, which: Any) -> Trials:
        """Some of the trials: a slice, a mask, or an array of indices."""
        return Trials(*(getattr(self, field.name)[which] for field in fields(self)))

    def __len__(self) -> int:
        return len(self.schemes)

    def __repr__(self) -> str:
        return f"<{len(self)} trials, {int(self.feasible.sum())} feasible>"


def trials_of(sweep: Sweep, measure: Measure, tolerance: float) -> Trials:
    """The trials of a sweep's schemes from one start."""
    value, schemes = measure(sweep), np.empty(len(sweep.schemes), dtype=object)
    schemes[:] = sweep.schemes
    error = np.maximum(sweep.max_error, sweep.max_orientation_error)[:, 0]
    feasible = sweep.ok[:, 0] & np.isfinite(value) & (error <= tolerance)
    return Trials(schemes, value, sweep.peak_velocity[:, 0], sweep.peak_acceleration[:, 0], error, feasible)


def joined(parts: Sequence[Trials]) -> Trials:
    """All trials, one part after another."""
    return Trials(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Trials)))
