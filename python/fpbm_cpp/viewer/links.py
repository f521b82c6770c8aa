"""An arm drawn as rods and cylinders."""

import numpy as np
from viser import SceneApi, SceneNodeHandle

from .._types import Array
from ..arms import Arm, SerialArm
from ..skeleton import joint_axes, joint_points
from .playback import in_space

LINK, JOINT, BASE = (196, 203, 212), (62, 84, 112), (110, 116, 124)
RADIUS = 0.019  # Of links, as a share of the arm's length.


class Links:
    """A rod for each link, a cylinder along the axis of each revolute joint, and a box along each prismatic joint."""

    def __init__(self, scene: SceneApi, arm: Arm, q: Array) -> None:
        self._arm = arm
        spans = np.diff(joint_points(arm, q), axis=0)
        r = RADIUS * max(float(np.linalg.norm(spans, axis=1).sum()), 1e-3)
        scene.add_cylinder("/arm/base", 2.6 * r, 0.8 * r, BASE)
        self._links = [scene.add_cylinder(f"/arm/link_{i}", r, 1.0, LINK) for i in range(len(spans))]
        types = [joint.type for joint in arm.joints] if isinstance(arm, SerialArm) else ["revolute"] * arm.dof
        self._joints: list[SceneNodeHandle] = [
            scene.add_box(f"/arm/joint_{i}", JOINT, (3.0 * r, 3.0 * r, 3.4 * r))
            if kind == "prismatic"
            else scene.add_cylinder(f"/arm/joint_{i}", 1.5 * r, 3.4 * r, JOINT)
            for i, kind in enumerate(types)
        ]
        self.pose(q)

    def pose(self, q: Array) -> None:
        """Move the arm to a posture."""
        points = in_space(joint_points(self._arm, q))
        for link, start, end in zip(self._links, points, points[1:]):
            length = float(np.linalg.norm(end - start))
            link.visible = length > 1e-9
            if link.visible:
                link.scale = (1.0, 1.0, length)
                link.position, link.wxyz = (start + end) / 2, along(end - start)
        for joint, point, axis in zip(self._joints, points[-len(self._joints) - 1 :], joint_axes(self._arm, q)):
            joint.position, joint.wxyz = point, along(axis)


def along(direction: Array) -> Array:
    """Quaternion (w, x, y, z) of a rotation that takes the z axis to a direction."""
    x, y, z = direction / np.linalg.norm(direction)
    if z < -1.0 + 1e-12:
        return np.array([0.0, 1.0, 0.0, 0.0])
    quaternion: Array = np.array([1.0 + z, -y, x, 0.0])
    quaternion /= np.linalg.norm(quaternion)
    return quaternion
