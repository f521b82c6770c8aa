"""Orientations as others write them."""

from __future__ import annotations

import numpy as np

from .._core import rotation_vector
from .._types import Array


def quaternions(rotations: Array) -> Array:
    """Unit quaternions (x, y, z, w) of rotation matrices, shape (N, 4) of (N, 3, 3).

    Of the two that are one orientation, each is the one nearer to that before; w of the first is not negative.
    """
    vectors = np.array([rotation_vector(R) for R in rotations]).reshape(-1, 3)
    half = np.linalg.norm(vectors, axis=1, keepdims=True) / 2
    result = np.hstack([vectors / 2 * np.sinc(half / np.pi), np.cos(half)])
    turned = (result[1:] * result[:-1]).sum(axis=1) < 0
    result[1:] *= np.where(turned, -1, 1).cumprod()[:, None]
    return result
