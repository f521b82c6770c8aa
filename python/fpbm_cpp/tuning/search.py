"""Searches of the unit cube by CMA-ES (Hansen and Ostermeier, 2001): for the least score, and the Pareto front of two.

Each is an endless generator: it yields points, shape (B, d), and is sent their scores, shape (B,) or (B, 2), NaN where
a point is infeasible.
"""

from collections.abc import Generator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._types import Array
from ..errors import extra

Search = Generator[Array, Array, None]

LANES, DEVIATION = 8, 0.3  # A generation fills a processor's lanes, and its first deviation covers the cube.
ALIKE = 1e-3  # A search starts again elsewhere when a generation's scores differ by less than this share.
WEIGHTINGS, LEAST_WEIGHT, SUM = 4, 0.02, 0.01  # Of two scores: how many, the least weight of one, the sum's share.


def require_cmaes() -> Any:
    """The searches' library. Raises ImportError, with what to install, if it is missing."""
    return extra("cmaes", "tuning", "tune")


def least(size: int, seed: int) -> Search:
    """Search for the least score, first from the cube's middle, then from random points."""
    random = np.random.default_rng(seed)
    search = _begin(np.full(size, 0.5), 2 * LANES, random)
    while True:
        points = _ask(search)
        scores = yield points
        _tell(search, points, scores)
        if np.ptp(scores) <= ALIKE * np.max(np.abs(scores)):
            search = _begin(random.uniform(size=size), 2 * LANES, random)


def front(size: int, seed: int) -> Search:
    """Search for the front of two scores: side by side for the least of several weightings of them.

    A weighting is a Chebyshev norm of the distance from the best of each score, in units of the front's extent so far.
    Every point of a front is the least of such a norm, also in its hollows, where weighted sums find nothing (Bowman,
    1976). A small share of the sum decides between points with equal norms.
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
    """Indices of the points that no other point beats, sorted by x: none is smaller in one and no larger in the other.

    Of equal points only the first counts; a point with a NaN does not.
    """
    order = np.lexsort((y, x))
    order = order[~np.isnan(x[order] + y[order])]
    lowest = np.minimum.accumulate(y[order])
    before = np.concatenate([[np.inf], lowest])[: len(order)]
    return order[y[order] < before]


def _begin(middle: Array, count: int, random: np.random.Generator) -> Any:
    """A search around a point, in generations of so many points."""
    cube, seed = np.tile([0.0, 1.0], (len(middle), 1)), int(random.integers(2**31))
    return require_cmaes().CMA(middle, DEVIATION, bounds=cube, seed=seed, population_size=count)


def _ask(search: Any) -> Array:
    return np.array([search.ask() for _ in range(search.population_size)])


def _tell(search: Any, points: Array, scores: Array) -> None:
    """Tell a search its scores; infeasible points count as worst."""
    search.tell(list(zip(points, np.where(np.isnan(scores), np.inf, scores).tolist())))
