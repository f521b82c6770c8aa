"""The search space of schemes, and searches of its unit cube by CMA-ES (Hansen and Ostermeier, 2001).

A search is an endless generator: it yields points, shape (B, d), and receives their scores, shape (B,) or (B, 2), NaN
for an infeasible point. least() searches for the least score, front() for the Pareto front of two scores.
"""

from collections.abc import Generator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._types import Array
from ..errors import extra
from ..parameter import parameters
from ..schemes import FPBM

TUNABLE = ("alpha", "weights", "k1", "k2", "null_damping")

# k1 and k2 have no ranges: they act on the tip error only, which is zero without disturbances.
SEARCH: dict[str, tuple[float, float]] = {"alpha": (0.0, 1.0), "weights": (0.1, 10.0), "null_damping": (0.01, 10.0)}

Search = Generator[Array, Array, None]

LANES, DEVIATION = 8, 0.3  # A generation fills the SIMD lanes; the initial standard deviation covers the cube.
ALIKE = 1e-3  # A search restarts at another point if the relative difference of a generation's scores is smaller.
WEIGHTINGS, LEAST_WEIGHT, SUM = 4, 0.02, 0.01  # Weightings of two scores, least weight of a score, weight of the sum.


def tunable(scheme: FPBM) -> dict[str, Any]:
    """The tunable parameters of a scheme."""
    return {name: getattr(scheme, name) for name in TUNABLE}


def numbers(scheme: FPBM) -> dict[str, float]:
    """The tunable numbers by name: 'weights[0]' and so on."""
    return {
        f"{name}[{i}]" if np.ndim(value) else name: entry
        for name, value in tunable(scheme).items()
        for i, entry in enumerate(np.atleast_1d(value).tolist())
    }


def with_numbers(scheme: FPBM, changes: Mapping[str, float]) -> FPBM:
    """The scheme with other values of these numbers."""
    values: dict[str, Any] = {name: np.array(value) for name, value in tunable(scheme).items()}
    for name, number in changes.items():
        parameter, _, index = name.rstrip("]").partition("[")
        values[parameter][int(index) if index else ()] = number
    return replace(scheme, **values)


class Space:
    """The schemes that differ from a baseline in some numbers, one for each point of the unit cube.

    names has the name of each coordinate's number. Raises ValueError if the search or the baseline is invalid.
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
    """Whether a number has an upper bound; all other numbers are searched on a logarithmic scale."""
    return bool(np.isfinite(parameters(FPBM)[name.partition("[")[0]].high))


def _ranges(name: str, given: ArrayLike, count: int) -> Array:
    """The ranges of a parameter's numbers, shape (count, 2)."""
    what, bounds = f"search[{name!r}] = {given!r}", parameters(FPBM)[name]
    try:
        ranges = np.asarray(given, float)
    except (TypeError, ValueError):
        ranges = np.empty(0)
    if ranges.shape not in ((2,), (count, 2)):
        also = f", or {count} pairs, one for each weight but the first" if name == "weights" else ""
        raise ValueError(f"{what}: must be a pair (low, high){also}")
    if not np.all(np.isfinite(ranges)) or not np.all(ranges[..., 0] < ranges[..., 1]):
        raise ValueError(f"{what}: must be finite, with low < high")
    if _bounded(name) and not np.all((ranges >= bounds.low) & (ranges <= bounds.high)):
        raise ValueError(f"{what}: must be in [{bounds.low:g}, {bounds.high:g}]")
    if not _bounded(name) and not np.all(ranges > 0.0):
        raise ValueError(f"{what}: must be positive, since it is searched on a logarithmic scale")
    return np.array(np.broadcast_to(ranges, (count, 2)))


def require_cmaes() -> Any:
    """The library of the searches. If the library is missing, raises ImportError with the extra to install."""
    return extra("cmaes", "tuning", "tune")


def least(size: int, seed: int) -> Search:
    """Search for the least score, first from the middle of the cube, then from random points."""
    random = np.random.default_rng(seed)
    search = _begin(np.full(size, 0.5), 2 * LANES, random)
    while True:
        points = _ask(search)
        scores = yield points
        _tell(search, points, scores)
        if np.ptp(scores) <= ALIKE * np.max(np.abs(scores)):
            search = _begin(random.uniform(size=size), 2 * LANES, random)


def front(size: int, seed: int) -> Search:
    """Search for the front of two scores, by parallel searches for the minimum of several weightings of the scores.

    A weighting is a Chebyshev norm of the distance from the best value of each score, in units of the front's present
    extent. Each point of a front minimises one of these norms, also in non-convex parts, where weighted sums have no
    minimum (Bowman, 1976). A small weight of the sum decides between points with equal norms.
    """
    random = np.random.default_rng(seed)
    shares = np.linspace(LEAST_WEIGHT, 1.0 - LEAST_WEIGHT, WEIGHTINGS)
    searches = [_begin(np.full(size, 0.5), LANES, random) for _ in shares]
    best = np.empty((0, 2))
    while True:
        points = [_ask(search) for search in searches]
        scores = yield np.concatenate(points)
        best = np.concatenate([best, scores])
        best = best[pareto_front(*best.T)]
        low, extent = (best.min(axis=0), np.ptp(best, axis=0)) if len(best) else (np.zeros(2), np.ones(2))
        shifted = (scores - low) / np.where(extent > 0.0, extent, 1.0)
        for search, share, own, score in zip(searches, shares, points, np.split(shifted, WEIGHTINGS)):
            norms = np.max(np.array([share, 1.0 - share]) * score, axis=1)
            _tell(search, own, norms + SUM * score.sum(axis=1))


def pareto_front(x: Array, y: Array) -> NDArray[np.intp]:
    """Indices of the points that no other point dominates, sorted by x.

    A dominating point is smaller in one score and not larger in the other score. Of equal points, only the first is in
    the front. Points with a NaN are not in the front.
    """
    order = np.lexsort((y, x))
    order = order[~np.isnan(x[order] + y[order])]
    lowest = np.minimum.accumulate(y[order])
    before = np.concatenate([[np.inf], lowest])[: len(order)]
    return order[y[order] < before]


def _begin(middle: Array, count: int, random: np.random.Generator) -> Any:
    """A search around a point, with generations of count points."""
    cube, seed = np.tile([0.0, 1.0], (len(middle), 1)), int(random.integers(2**31))
    return require_cmaes().CMA(middle, DEVIATION, bounds=cube, seed=seed, population_size=count)


def _ask(search: Any) -> Array:
    return np.array([search.ask() for _ in range(search.population_size)])


def _tell(search: Any, points: Array, scores: Array) -> None:
    """Give a search its scores; the score of an infeasible point is infinite."""
    search.tell(list(zip(points, np.where(np.isnan(scores), np.inf, scores).tolist())))
