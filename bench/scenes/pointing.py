"""Tips that move to vertices, one after another: Flacco, De Luca and Khatib (IROS 2012), equations (15) to (17).

The tip's desired velocity points to the next vertex, with the speed kP |e| - kD |v|. A vertex is reached if the tip is
within TOLERANCE.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import fpbm_cpp as fp

Array = NDArray[np.float64]
Step = Callable[[Array, Array, Array], tuple[Array, Array, Array]]  # (q, qd, tip's desired velocity) -> q, qd, scales.

DT = 1e-3  # [s]
TOLERANCE = 5e-3  # [m]
LONGEST = 40.0  # [s]


@dataclass(frozen=True)
class Scene:
    """An arm, by its table of Denavit-Hartenberg parameters (a, alpha, d, theta), and the vertices of its tip."""

    table: Array
    limits: fp.JointLimits
    q0: Array
    vertices: Array  # (k, 3) [m]
    kp: float  # [1/s]
    kd: float
    rows: tuple[str, ...] = ("x", "y", "z")

    @property
    def arm(self) -> fp.SerialArm:
        limits = self.limits
        return fp.SerialArm.from_dh(
            self.table,
            "classic",
            lower=limits.lower,
            upper=limits.upper,
            velocity=limits.velocity,
            acceleration=limits.acceleration,
        )

    def origins(self, q: Array) -> Array:
        """Origins of the frames 0 to n by NumPy, shape (len(q), n + 1, 3)."""
        frame = np.broadcast_to(np.eye(4), (len(q), 4, 4))
        origins = [frame[:, :3, 3]]
        for (a, alpha, d, theta), angle in zip(self.table, q.T, strict=True):
            c, s = np.cos(angle + theta), np.sin(angle + theta)
            cos, sin, zero, one = np.cos(alpha), np.sin(alpha), np.zeros_like(c), np.ones_like(c)
            link = np.array(
                [
                    [c, -s * cos, s * sin, a * c],
                    [s, c * cos, -c * sin, a * s],
                    [zero, sin * one, cos * one, d * one],
                    [zero, zero, zero, one],
                ]
            )
            frame = frame @ np.moveaxis(link, 2, 0)
            origins.append(frame[:, :3, 3])
        return np.stack(origins, axis=1)


class Motion(NamedTuple):
    """Motion of a tip; row i of scales and heading belongs to the tick from state i to state i + 1."""

    q: Array  # (ticks + 1, n)
    qd: Array
    scales: Array  # (ticks, levels)
    heading: NDArray[np.int64]  # (ticks,): index of the vertex.
    reached: int  # Vertices that were reached.


def desired_speed(kp: float, kd: float, error: Array, velocity: Array) -> Array:
    """The velocity (15), toward the target."""
    distance = max(float(np.linalg.norm(error)), 1e-12)
    return (kp * distance - kd * float(np.linalg.norm(velocity))) / distance * error


def pursue(scene: Scene, step: Step, longest: float = LONGEST) -> Motion:
    """Moves to all vertices, one after another, for at most `longest` seconds."""
    arm, q, qd = scene.arm, scene.q0, np.zeros_like(scene.q0)
    states, velocities, k = [q], [qd], 0
    scales: list[Array] = []
    heading: list[int] = []
    while len(scales) * DT < longest:
        error = scene.vertices[k] - arm.forward(q)[:3, 3]
        if np.linalg.norm(error) < TOLERANCE:
            k += 1
            if k == len(scene.vertices):
                break
            error = scene.vertices[k] - arm.forward(q)[:3, 3]
        velocity = arm.jacobian(q) @ qd
        q, qd, scale = step(q, qd, desired_speed(scene.kp, scene.kd, error, velocity))
        states.append(q)
        velocities.append(qd)
        scales.append(scale)
        heading.append(k)
    return Motion(np.array(states), np.array(velocities), np.array(scales), np.array(heading), k)
