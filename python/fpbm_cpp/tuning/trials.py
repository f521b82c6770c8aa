"""Schemes that were tried, and what came of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._types import Array
from ..sweep_result import Sweep
from .objectives import Measure
from .pareto import unbeaten
from .space import PARAMETERS, parameters


@dataclass(frozen=True, repr=False, eq=False)
class Trials:
    """T schemes and their motions: arrays of shape (T,), in the order in which they were tried.

    Attributes
    ----------
    schemes : numpy.ndarray of FPBM
        The schemes, ready to use.
    value : numpy.ndarray
        The objective; not a number where the motion stopped early.
    peak_velocity, peak_acceleration : numpy.ndarray
        Of the fastest joint [rad/s], [rad/s^2].
    error : numpy.ndarray
        Largest error of the tip [m], or, where that of its orientation [rad] is the larger number, that.
    feasible : numpy.ndarray of bool
        Whether the motion is complete, its objective finite, and its error within the bound.
    """

    schemes: NDArray[Any]
    value: Array
    peak_velocity: Array
    peak_acceleration: Array
    error: Array
    feasible: NDArray[np.bool_]

    @property
    def parameters(self) -> dict[str, Array]:
        """The schemes' parameters by name, arrays of shape (T,), and (T, n) of the weights."""
        rows = [parameters(scheme) for scheme in self.schemes]
        return {name: np.array([row[name] for row in rows]) for name in PARAMETERS}

    def front(self) -> Trials:
        """The feasible trials that no other beats in peak velocity and peak acceleration both, by peak velocity."""
        return self[unbeaten(*self.peaks().T)]

    def scores(self) -> Array:
        """The value of each, not a number where it is infeasible."""
        return np.where(self.feasible, self.value, np.nan)

    def peaks(self) -> Array:
        """Peak velocity and peak acceleration of each, shape (T, 2), not a number where it is infeasible."""
        pairs = np.column_stack([self.peak_velocity, self.peak_acceleration])
        return np.where(self.feasible[:, None], pairs, np.nan)

    def best(self) -> int:
        """Which feasible trial has the least value, the first of several; there must be one."""
        return int(np.nanargmin(self.scores()))

    def __getitem__(self, which: Any) -> Trials:
        """Some of the trials: a slice, a mask, or an array of numbers."""
        return Trials(*(getattr(self, field.name)[which] for field in fields(self)))

    def __len__(self) -> int:
        return len(self.schemes)

    def __repr__(self) -> str:
        return f"<{len(self)} trials, {int(self.feasible.sum())} feasible>"


def trials_of(sweep: Sweep, measure: Measure, max_error: float) -> Trials:
    """What came of the schemes of a sweep from one start."""
    value, schemes = measure(sweep), np.empty(len(sweep.schemes), dtype=object)
    schemes[:] = sweep.schemes
    error = np.maximum(sweep.max_error, sweep.max_orientation_error)[:, 0]
    return Trials(
        schemes,
        value,
        sweep.peak_velocity[:, 0],
        sweep.peak_acceleration[:, 0],
        error,
        sweep.ok[:, 0] & np.isfinite(value) & (error <= max_error),
    )


def joined(parts: Sequence[Trials]) -> Trials:
    """All trials of several, one after another."""
    return Trials(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Trials)))
