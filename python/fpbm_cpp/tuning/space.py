"""What of a scheme is varied, and how far: points of the unit cube, and the schemes that they stand for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._core import FPBM
from .._scheme import arguments
from .._types import Array

PARAMETERS = ("alpha", "weights", "k1", "k2", "null_damping")

# k1 and k2 act on the tip's error alone, and without disturbances there is none.
SEARCH: dict[str, tuple[float, float]] = {"alpha": (0.0, 1.0), "weights": (0.1, 10.0), "null_damping": (0.01, 10.0)}


def parameters(scheme: FPBM) -> dict[str, Any]:
    """The parameters of a scheme that can be tuned: numbers, and an array of the weights."""
    made = arguments(scheme)
    return {name: np.array(made[name], float) if name == "weights" else float(made[name]) for name in PARAMETERS}


def paper_choice(dof: int) -> FPBM:
    """The paper's choice, its W = diag(1, 2, 3, 4) carried on to arms of other numbers of joints."""
    return FPBM(0.6, np.arange(1.0, dof + 1), k1=1.0, k2=1.0)


@dataclass(frozen=True)
class Space:
    """The schemes that a baseline's are varied to: one for each point of the unit cube.

    Of each coordinate, the parameter that it belongs to, and its range, which is that of a logarithm but for alpha.
    """

    baseline: FPBM
    names: tuple[str, ...]
    low: Array
    high: Array

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.names)

    def scheme(self, point: Array) -> FPBM:
        """The scheme of a point."""
        made = arguments(self.baseline)
        values = np.clip(self.low + point * (self.high - self.low), self.low, self.high)
        for name in dict.fromkeys(self.names):
            own = values[[other == name for other in self.names]]
            if name == "weights":
                made["weights"] = np.concatenate([[1.0], np.exp(own)])
            else:
                made[name] = float(own[0] if name == "alpha" else np.exp(own[0]))
        return FPBM(**made)


def make_space(search: Mapping[str, ArrayLike] | None, baseline: FPBM, dof: int) -> Space:
    """The space of a search; raises ValueError for what cannot be searched."""
    if np.shape(arguments(baseline)["weights"]) != (dof,):
        raise ValueError(f"baseline = {baseline!r}: W must be diagonal, of {dof} weights")
    names, ranges = [], []
    for name, wanted in (SEARCH if search is None else search).items():
        if name not in PARAMETERS:
            raise ValueError(f"search: {name!r} is none of {', '.join(map(repr, PARAMETERS))}")
        count = dof - 1 if name == "weights" else 1
        for low, high in _ranges(name, wanted, count):
            names.append(name)
            ranges.append((low, high) if name == "alpha" else (np.log(low), np.log(high)))
    if not names:
        raise ValueError("search: must name one parameter at least")
    low, high = np.array(ranges).T
    return Space(baseline, tuple(names), low, high)


def _ranges(name: str, wanted: ArrayLike, count: int) -> Array:
    """The ranges of a parameter's coordinates, shape (count, 2)."""
    what = f"search[{name!r}] = {wanted!r}"
    try:
        ranges = np.asarray(wanted, float)
    except (TypeError, ValueError):
        ranges = np.empty(0)
    if ranges.shape not in ((2,), (count, 2)):
        also = f", or {count} of them, one for each weight but the first" if name == "weights" else ""
        raise ValueError(f"{what}: must be a pair (low, high){also}")
    if not np.all(np.isfinite(ranges)) or not np.all(ranges[..., 0] < ranges[..., 1]):
        raise ValueError(f"{what}: must be finite, with low < high")
    if name == "alpha" and not np.all((ranges >= 0.0) & (ranges <= 1.0)):
        raise ValueError(f"{what}: must lie in [0, 1]")
    if name != "alpha" and not np.all(ranges > 0.0):
        raise ValueError(f"{what}: must be positive, since it is searched on a logarithmic scale")
    return np.broadcast_to(ranges, (count, 2))
