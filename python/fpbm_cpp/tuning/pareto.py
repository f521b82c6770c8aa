"""Pareto fronts of two quantities."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._types import Array


def pareto_front(x: Array, y: Array) -> NDArray[np.intp]:
    """Indices of the points that no other point beats, sorted by x: none is smaller in one and no larger in the other.

    Of equal points only the first counts; a point with a NaN does not.
    """
    order = np.lexsort((y, x))
    order = order[~np.isnan(x[order] + y[order])]
    lowest = np.minimum.accumulate(y[order])
    before = np.concatenate([[np.inf], lowest])[: len(order)]
    return order[y[order] < before]
