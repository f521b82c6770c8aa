"""Frames of URDF files."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from .._core import rotation
from .._types import Array


def pose(xyz: ArrayLike, rpy: Iterable[float]) -> Array:
    """The frame of a URDF's <origin>."""
    roll, pitch, yaw = rpy
    return frame_at(xyz, rotation([0, 0, yaw]) @ rotation([0, pitch, 0]) @ rotation([roll, 0, 0]))


def frame_at(p: ArrayLike = 0.0, R: ArrayLike = ((1, 0, 0), (0, 1, 0), (0, 0, 1))) -> Array:
    """A homogeneous matrix."""
    T = np.eye(4)
    T[:3, 3], T[:3, :3] = p, R
    return T
