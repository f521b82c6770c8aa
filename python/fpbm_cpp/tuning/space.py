"""The schemes that a search tries, one for each point of the unit cube, and their numbers by name."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._types import Array
from ..parameter import parameters
from ..schemes import FPBM

TUNABLE = ("alpha", "weights", "k1", "k2", "null_damping")

# k1 and k2 act on the tip's error alone, which is zero without disturbances.
SEARCH: dict[str, tuple[float, float]] = {"alpha": (0.0, 1.0), "weights": (0.1, 10.0), "null_damping": (0.01, 10.0)}


def tunable(scheme: FPBM) -> dict[str, Any]:
    """The parameters of a scheme that can be tuned."""
    return {name: getattr(scheme, name) for name in TUNABLE}


def numbers(scheme: FPBM) -> dict[str, float]:
    """The same with a name for each number: 'weights[0]' and so on."""
    return {
        f"{name}[{i}]" if np.ndim(value) else name: entry
        for name, value in tunable(scheme).items()
        for i, entry in enumerate(np.atleast_1d(value).tolist())
    }


def with_numbers(scheme: FPBM, changes: Mapping[str, float]) -> FPBM:
    """The scheme with other numbers, by these names."""
    values: dict[str, Any] = {name: np.array(value) for name, value in tunable(scheme).items()}
    for name, number in changes.items():
        parameter, _, index = name.rstrip("]").partition("[")
        values[parameter][int(index) if index else ()] = number
    return replace(scheme, **values)


class Space:
    """The schemes that differ from a baseline in some numbers, one for each point of the unit cube.

    names holds the number of each coordinate. Raises ValueError for what cannot be searched.
    """

    def __init__(self, search: Mapping[str, ArrayLike] | None, baseline: FPBM, dof: int) -> None:
        if np.shape(baseline.weights) != (dof,):
            raise ValueError(f"baseline = {baseline!r}: W must be diagonal, of {dof} weights")
        self.baseline = baseline
        self.names: list[str] = []
        ranges: list[Array] = []
        for name, given in (SEARCH if search is None else search).items():
            if name not in TUNABLE:
                raise ValueError(f"search: {name!r} must be one of {', '.join(map(repr, TUNABLE))}")
            own = [f"weights[{i}]" for i in range(1, dof)] if name == "weights" else [name]
            self.names += own
            ranges.append(_ranges(name, given, len(own)))
        if not self.names:
            raise ValueError("search: must name at least one parameter")
        self._log, limits = np.array([not _bounded(name) for name in self.names]), np.concatenate(ranges)
        limits[self._log] = np.log(limits[self._log])
        self._low, self._high = limits.T

    def scheme(self, point: Array) -> FPBM:
        values = np.clip(self._low + point * (self._high - self._low), self._low, self._high)
        values[self._log] = np.exp(values[self._log])
        first = {"weights[0]": 1.0} if "weights[1]" in self.names else {}  # Only ratios of weights matter.
        return with_numbers(self.baseline, {**first, **dict(zip(self.names, values.tolist()))})


def _bounded(name: str) -> bool:
    """Whether a number has an upper bound; all others are searched on a logarithmic scale."""
    return bool(np.isfinite(parameters(FPBM)[name.partition("[")[0]].high))


def _ranges(name: str, given: ArrayLike, count: int) -> Array:
    """The ranges of a parameter's numbers, shape (count, 2)."""
    what, bounds = f"search[{name!r}] = {given!r}", parameters(FPBM)[name]
    try:
        ranges = np.asarray(given, float)
    except (TypeError, ValueError):
        ranges = np.empty(0)
    if ranges.shape not in ((2,), (count, 2)):
        also = f", or {count} of them, one for each weight but the first" if name == "weights" else ""
        raise ValueError(f"{what}: must be a pair (low, high){also}")
    if not np.all(np.isfinite(ranges)) or not np.all(ranges[..., 0] < ranges[..., 1]):
        raise ValueError(f"{what}: must be finite, with low < high")
    if _bounded(name) and not np.all((ranges >= bounds.low) & (ranges <= bounds.high)):
        raise ValueError(f"{what}: must lie in [{bounds.low:g}, {bounds.high:g}]")
    if not _bounded(name) and not np.all(ranges > 0.0):
        raise ValueError(f"{what}: must be positive, since it is searched on a logarithmic scale")
    return np.array(np.broadcast_to(ranges, (count, 2)))
