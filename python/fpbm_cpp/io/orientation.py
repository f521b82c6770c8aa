"""Quaternions of rotation matrices."""

import numpy as np

from .._core import rotation_vector
from .._types import Array


def quaternions(rotations: Array) -> Array:
    """Unit quaternions (x, y, z, w) of rotation matrices, shape (N, 4) of (N, 3, 3).

    Of the two quaternions of an orientation, each row takes the one nearer to the row before; the first has w >= 0.
    """
    vectors = np.array([rotation_vector(R) for R in rotations]).reshape(-1, 3)
    half = np.linalg.norm(vectors, axis=1, keepdims=True) / 2
    result = np.hstack([vectors / 2 * np.sinc(half / np.pi), np.cos(half)])
    flipped = (result[1:] * result[:-1]).sum(axis=1) < 0
    result[1:] *= np.where(flipped, -1, 1).cumprod()[:, None]
    return result
