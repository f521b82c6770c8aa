"""Measures of a motion, from joint positions and velocities by NumPy alone, except for the scales."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from pointing import DT, Array, Motion, Scene


class Measures(NamedTuple):
    time: float  # Until the last vertex [s].
    direction: Array  # Angle (17) between the tip's velocity and the direction to the vertex, each tick [rad].
    off_line: Array  # Distance of the tip from the line between the vertices, each tick [m].
    speed: float  # Mean speed of an inner frame's origin [m/s].
    place: Array  # Mean position of that origin [m].
    excess: tuple[float, float, float, float]  # See excess().


def measure(scene: Scene, motion: Motion, inner: int) -> Measures:
    step = 1e-6  # [s], of central differences along the joint velocities.
    origins = scene.origins(motion.q)
    velocities = (scene.origins(motion.q + step * motion.qd) - scene.origins(motion.q - step * motion.qd)) / (2 * step)
    tip, velocity = origins[1:, -1], velocities[1:, -1]
    ends = scene.vertices[motion.heading]
    starts = np.vstack([origins[:1, -1], scene.vertices])[motion.heading]
    return Measures(
        time=len(motion.q) * DT,
        direction=angle(ends - tip, velocity),
        off_line=from_segment(tip, starts, ends),
        speed=float(np.linalg.norm(velocities[:, inner], axis=1).mean()),
        place=origins[:, inner].mean(axis=0),
        excess=excess(scene, motion),
    )


def angle(a: Array, b: Array) -> Array:
    angles: Array = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.sum(a * b, axis=1))
    return angles


def from_segment(p: Array, start: Array, end: Array) -> Array:
    along = end - start
    share = np.clip(np.sum((p - start) * along, axis=1) / np.sum(along**2, axis=1), 0, 1)
    distances: Array = np.linalg.norm(p - start - share[:, None] * along, axis=1)
    return distances


def excess(scene: Scene, motion: Motion) -> tuple[float, float, float, float]:
    """How far the bounds are exceeded: positions; velocities and accelerations by first differences; accelerations by
    second differences of positions, whose round-off error is about 4e-10 rad/s^2.
    """
    limits, q, qd = scene.limits, motion.q, motion.qd
    change = np.diff(np.vstack([q[:1], q]), axis=0) / DT  # The arm starts at rest.
    return (
        float(np.maximum(limits.lower - q, q - limits.upper).max()),
        float((np.abs(change) - limits.velocity).max()),
        float((np.abs(np.diff(qd, axis=0)) / DT - limits.acceleration).max()),
        float((np.abs(np.diff(change, axis=0)) / DT - limits.acceleration).max()),
    )
