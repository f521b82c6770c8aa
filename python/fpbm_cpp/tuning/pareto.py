"""The points of a plane that no other beats in both coordinates."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._types import Array


def unbeaten(x: Array, y: Array) -> NDArray[np.intp]:
    """Which points have none that is as small in both coordinates and smaller in one, by x; of equal ones, the first.

    Points of which a coordinate is not a number are none.
    """
    order = np.lexsort((y, x))
    order = order[~np.isnan(x[order] + y[order])]
    lowest = np.minimum.accumulate(y[order])
    before = np.concatenate([[np.inf], lowest])[: len(order)]
    return order[y[order] < before]
