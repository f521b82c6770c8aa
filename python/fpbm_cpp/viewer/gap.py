"""Nearest points of two shapes."""

from collections.abc import Callable

import numpy as np

from .._types import Array
from ..capsule import Capsule
from ..clearance import Clearance
from ..obstacle import Cuboid, HalfSpace, Obstacle

Project = Callable[[Array], Array]
ROUNDS, PARTS = 7, 16  # The gap is convex along a capsule: each round narrows the interval of the minimum to two parts.


def nearest_points(clearance: Clearance, frames: Array, pair: tuple[str, str]) -> Array | None:
    """Nearest points on the surfaces of a pair of shapes, given by name, shape (2, 3); frames are the links' frames.

    None for a pair of a tip and a wall of its bounds, because tips and walls are not shapes.
    """
    first, second = pair
    others: list[Obstacle] = [each for each in (*clearance.capsules, *clearance.obstacles) if each.name == second]
    found = [_nearest(each, other, frames) for each in clearance.capsules if each.name == first for other in others]
    return min(found, key=lambda each: each[0])[1] if found else None


def _nearest(capsule: Capsule, other: Obstacle, frames: Array) -> tuple[float, Array]:
    """Distance, and the nearest point of each shape."""
    ends, (project, radius) = core(capsule, frames), _projection(other, frames)
    low, high = 0.0, 1.0
    for _ in range(ROUNDS):
        t = np.linspace(low, high, PARTS + 1)
        points = ends[0] + t[:, None] * (ends[1] - ends[0])
        gaps = np.linalg.norm(points - project(points), axis=1)
        best = int(gaps.argmin())
        low, high = t[max(best - 1, 0)], t[min(best + 1, PARTS)]
    point, there = points[best], project(points)[best]
    direction = (there - point) / max(float(gaps[best]), 1e-12)
    surfaces = np.array([point + capsule.radius * direction, there - radius * direction])
    return float(gaps[best]) - capsule.radius - radius, surfaces


def core(capsule: Capsule, frames: Array) -> Array:
    """Both ends of a capsule's segment in space, shape (2, 3)."""
    frame = frames[capsule.link]
    return np.asarray(np.array([capsule.a, capsule.b]) @ frame[:3, :3].T + frame[:3, 3])


def _projection(shape: Obstacle, frames: Array) -> tuple[Project, float]:
    """Projection of points to the core of a shape, and the radius about the core."""
    if isinstance(shape, HalfSpace):
        normal = shape.normal / np.linalg.norm(shape.normal)
        return lambda x: x - np.maximum(x @ normal - shape.offset, 0.0)[:, None] * normal, 0.0
    if isinstance(shape, Cuboid):
        R, p = shape.pose[:3, :3], shape.pose[:3, 3]
        return lambda x: np.clip((x - p) @ R, -shape.half, shape.half) @ R.T + p, 0.0
    a, b = core(shape, frames)
    square = max(float((b - a) @ (b - a)), 1e-24)
    return lambda x: a + np.clip((x - a) @ (b - a) / square, 0.0, 1.0)[:, None] * (b - a), shape.radius
