"""Lower levels of the scenes: as tasks of a Tracker, and as rows of an acceleration for fp.saturate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from pointing import DT, Array, Scene, desired_speed

import fpbm_cpp as fp


class Level(Protocol):
    @property
    def name(self) -> str: ...

    def task(self, k1: float) -> fp.Task: ...

    def reference(self, q: Array, qd: Array) -> tuple[Any, Any]:
        """Point and velocity. The point is the current point of the task, so that only the velocity acts."""
        ...

    def rows(self, q: Array, qd: Array) -> tuple[Array, Array, Array]:
        """J, Jd qd and the desired acceleration."""
        ...


@dataclass(frozen=True)
class Damping:
    """Damping of the self-motion with the gain 1/T: the desired joint velocities are zero."""

    name: str = "damping"

    def task(self, k1: float) -> fp.Task:
        return fp.PostureTask(name=self.name, k1=1 / DT, k2=0)

    def reference(self, q: Array, qd: Array) -> tuple[Any, Any]:
        return q, np.zeros_like(q)

    def rows(self, q: Array, qd: Array) -> tuple[Array, Array, Array]:
        return np.eye(len(q)), np.zeros_like(q), -qd / DT


@dataclass(frozen=True)
class FirstLink:
    """The end of the first link moves toward a point, in the plane."""

    scene: Scene
    target: Array
    name: str = "link 1"

    def task(self, k1: float) -> fp.Task:
        return fp.PositionTask("joint_1", name=self.name, offset=self._offset(), rows=("x", "y"), k1=k1, k2=0)

    def reference(self, q: Array, qd: Array) -> tuple[Any, Any]:
        _, _, velocity, point = self._motion(q, qd)
        return point, desired_speed(self.scene.kp, self.scene.kd, self.target - point, velocity)

    def rows(self, q: Array, qd: Array) -> tuple[Array, Array, Array]:
        J, drift, velocity, point = self._motion(q, qd)
        desired = desired_speed(self.scene.kp, self.scene.kd, self.target - point, velocity)
        return J[:2], drift[:2], (desired - velocity)[:2] / DT

    def _offset(self) -> Array:
        offset = np.eye(4)
        offset[0, 3] = self.scene.table[0, 0]
        return offset

    def _motion(self, q: Array, qd: Array) -> tuple[Array, Array, Array, Array]:
        c, s, length = np.cos(q[0]), np.sin(q[0]), self.scene.table[0, 0]
        point = length * np.array([c, s, 0.0])
        J = np.zeros((3, len(q)))
        J[:, 0] = length * np.array([-s, c, 0.0])
        return J, -point * qd[0] ** 2, J @ qd, point
