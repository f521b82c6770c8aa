"""An arm drawn from its own joints and links."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from viser import SceneApi, SceneNodeHandle

from .._core import Arm
from .._types import Array
from ..joint import Joint
from ..serial_arm import SerialArm
from ..skeleton import joint_points
from .colours import BASE, JOINT, LINK
from .space import along, in_space

RADIUS = 0.019  # Of links, as a part of the arm's length.


class Links:
    """A rod for each link, a can about the axis of each joint that turns, and a box along each that slides."""

    def __init__(self, scene: SceneApi, arm: Arm, q: Array) -> None:
        self._arm = arm
        self._axes = _Axes(arm)
        spans = np.diff(self._points(q), axis=0)
        r = RADIUS * max(float(np.linalg.norm(spans, axis=1).sum()), 1e-3)
        scene.add_cylinder("/arm/base", 2.6 * r, 0.8 * r, BASE)
        self._links = [scene.add_cylinder(f"/arm/link_{i}", r, 1.0, LINK) for i in range(len(spans))]
        self._joints: list[SceneNodeHandle] = [
            scene.add_box(f"/arm/joint_{i}", JOINT, (3.0 * r, 3.0 * r, 3.4 * r))
            if slides
            else scene.add_cylinder(f"/arm/joint_{i}", 1.5 * r, 3.4 * r, JOINT)
            for i, slides in enumerate(self._axes.slide)
        ]
        self.pose(q)

    def pose(self, q: Array) -> None:
        """Put the arm in a posture."""
        points = self._points(q)
        for link, start, end in zip(self._links, points, points[1:]):
            length = float(np.linalg.norm(end - start))
            link.visible = length > 1e-9
            if link.visible:
                link.scale = (1.0, 1.0, length)
                link.position, link.wxyz = (start + end) / 2, along(end - start)
        for joint, point, axis in zip(self._joints, points[-len(self._joints) - 1 :], self._axes(q)):
            joint.position, joint.wxyz = point, along(axis)

    def _points(self, q: Array) -> Array:
        return in_space(joint_points(self._arm, q))


class _Axes:
    """Directions of an arm's joints, those that follow another included."""

    def __init__(self, arm: Arm) -> None:
        self.slide = [False] * arm.dof
        self._joints: tuple[Joint, ...] = ()
        if isinstance(arm, SerialArm):
            # Were each joint its own master, each column of J would be its axis.
            self._free = SerialArm([replace(joint, mimic=None) for joint in arm.joints], arm.tip)
            self._joints = arm.joints
            self.slide = [joint.type == "prismatic" for joint in arm.joints]

    def __call__(self, q: Array) -> Array:
        if not self._joints:
            return np.tile([0.0, 0.0, 1.0], (len(self.slide), 1))
        J = self._free.jacobian(self._positions(q), task="pose")
        axes: Array = np.where(self.slide, J[:3], J[3:]).T
        return axes

    def _positions(self, q: Array) -> list[float]:
        masters = (i for i, joint in enumerate(self._joints) if joint.mimic is None)
        own = dict(zip(masters, q.tolist()))
        mimics = ((i, joint.mimic) for i, joint in enumerate(self._joints))
        return [own[i] if mimic is None else mimic[1] * own[mimic[0]] + mimic[2] for i, mimic in mimics]
