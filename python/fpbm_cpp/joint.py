"""One joint of a serial arm."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False)
class Joint:
    """One joint of a chain.

    Attributes
    ----------
    type : str
        'revolute', 'continuous' or 'prismatic'.
    placement : array_like, shape (4, 4)
        The joint's frame, seen from the joint before, both at zero [m].
    axis : array_like, shape (3,)
        In the joint's frame; its length does not matter.
    lower, upper : float
        Bounds of its position [rad] or [m]; infinite where there is none.
    velocity, acceleration : float
        Bounds of its speed and acceleration, either way; infinite where there is none.
    name : str
        'joint_1' and so on where empty.
    mimic : (int, float, float) or None
        A joint that another moves: the other's index in the chain, ratio and offset, its position being ratio times the
        other's plus offset. It is no degree of freedom.
    """

    type: str = "revolute"
    placement: ArrayLike = field(default_factory=lambda: np.eye(4))
    axis: ArrayLike = (0.0, 0.0, 1.0)
    lower: float = -inf
    upper: float = inf
    velocity: float = inf
    acceleration: float = inf
    name: str = ""
    mimic: tuple[int, float, float] | None = None
