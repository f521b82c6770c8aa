"""The handle in the scene that is dragged, and what it stands for: a target of the task."""

from collections.abc import Callable
from typing import Any

import numpy as np
from viser import SceneApi
from viser.transforms import SO3

from .._types import Array
from ..arms import Arm, PlanarArm


class Handle:
    """Arrows to drag and, for poses, arcs to turn; calls `moved` with each new target, in order."""

    def __init__(self, scene: SceneApi, arm: Arm, task: str, size: float, moved: Callable[[Array], object]) -> None:
        self._planar, self._pose = isinstance(arm, PlanarArm), task == "pose"
        self._gizmo = scene.add_transform_controls(
            "/handle",
            scale=size,
            line_width=3.0,
            active_axes=(True, True, not self._planar),
            disable_rotations=not self._pose,
            depth_test=False,
        )

        async def tell(_: Any) -> None:  # What is not async may be called out of order.
            moved(self.target)

        self._gizmo.on_update(tell)

    @property
    def target(self) -> Array:
        """Where it is, shaped as the task's targets are [m, rad]."""
        position, rotation = np.array(self._gizmo.position, dtype=float), SO3(self._gizmo.wxyz).as_matrix()
        if self._planar:
            angle = np.arctan2(rotation[1, 0], rotation[0, 0])
            return np.array([*position[:2], angle]) if self._pose else position[:2]
        if not self._pose:
            return position
        return np.block([[rotation, position[:, None]], [np.zeros((1, 3)), 1.0]])

    @property
    def position(self) -> Array:
        """Where it is in space [m]."""
        return np.array(self._gizmo.position, dtype=float)

    def place(self, x: Array) -> None:
        """Put it on a target."""
        if x.shape == (4, 4):
            self._gizmo.wxyz, x = SO3.from_matrix(x[:3, :3]).wxyz, x[:3, 3]
        elif self._planar and self._pose:
            self._gizmo.wxyz, x = SO3.from_z_radians(x[2]).wxyz, x[:2]
        self._gizmo.position = np.pad(x, (0, 3 - len(x)))
