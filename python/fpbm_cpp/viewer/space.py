"""Points and directions in three dimensions."""

from __future__ import annotations

import numpy as np

from .._types import Array


def in_space(points: Array) -> Array:
    """Points with three coordinates; z is 0 for points in the plane."""
    missing = 3 - points.shape[-1]
    return np.concatenate([points, np.zeros((*points.shape[:-1], missing))], axis=-1)


def along(direction: Array) -> Array:
    """Quaternion (w, x, y, z) of a rotation that takes the z axis to a direction."""
    x, y, z = direction / np.linalg.norm(direction)
    if z < -1.0 + 1e-12:
        return np.array([0.0, 1.0, 0.0, 0.0])
    quaternion: Array = np.array([1.0 + z, -y, x, 0.0])
    quaternion /= np.linalg.norm(quaternion)
    return quaternion
