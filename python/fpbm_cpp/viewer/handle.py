"""A handle to drag in the scene, and its target of a task."""

from collections.abc import Callable
from typing import Any

import numpy as np
from viser import SceneApi
from viser.transforms import SO3

from .._types import Array
from ..tasks import POSITION, ROTATION, FrameTask, RowsTask
from .frames import frame_of, point_of, selected

ANCHORS = ("bottom-left", "top-left", "bottom-right", "top-right")  # Labels at the same place do not cover each other.
COLOURS = ((230, 60, 60), (60, 170, 60), (60, 90, 230))  # Colours of the axes x, y and z.
TURNING = {"axis": [2], "orientation": [0, 1, 2]}  # Tasks without a position, and the axes that their handles show.


class Handle:
    """Arrows to drag for a position, arcs to rotate for an orientation or an axis.

    Calls `moved` with each new target, in order. Coordinates that the task does not select follow the task's frame.
    """

    def __init__(
        self,
        scene: SceneApi,
        index: int,
        planar: bool,
        task: FrameTask,
        x: Array,
        size: float,
        moved: Callable[[Array], object],
    ) -> None:
        self.task, self.axes, self.size = task, TURNING.get(task.kind, []), size
        self._shape, self._index = x.shape, index
        in_frame = isinstance(task, RowsTask) and task.axes == "frame" and not self.axes
        self._held = np.ones(3) if in_frame else selected(task, POSITION)
        at_tip = task.frame == "tip" and task.offset is None
        look = {"axes_length": 0.4 * size, "axes_radius": 0.02 * size, "visible": not at_tip}  # The tip has axes.
        self._frame = scene.add_frame(f"/frames/{index}", **look)
        along = self._held > 0.0 if task.kind == "position" else np.ones(3, dtype=bool)
        active = bool(along[0]), bool(along[1]), bool(along[2]) and not planar
        # A separate node follows the frame, because a handle whose position is set during a rotation jumps.
        self._carrier = scene.add_frame(f"/handles/{index}", show_axes=False)
        self._gizmo = scene.add_transform_controls(
            f"/handles/{index}/gizmo",
            scale=size,
            line_width=3.0,
            active_axes=active,
            disable_axes=bool(self.axes),
            disable_sliders=bool(self.axes),
            disable_rotations=not self.axes and not selected(task, ROTATION).any(),
            depth_test=False,
        )
        widths = {"shaft_radius": 0.02 * size, "head_radius": 0.06 * size, "head_length": 0.15 * size}
        for axis in self.axes:
            arrow = np.array([[np.zeros(3), size * np.eye(3)[axis]]])
            scene.add_arrows(f"/handles/{index}/gizmo/{axis}", arrow, COLOURS[axis], **widths)

        async def tell(event: Any) -> None:  # Functions that are not async may be called out of order.
            if event.phase == "end":  # The browser displaces the handle where the carrier moves during a rotation.
                self._gizmo.position = self._held * self._gizmo.position
            moved(self.target)

        self._gizmo.on_update(tell)

    def label(self, scene: SceneApi) -> None:
        """Show the name of the task beside the handle."""
        anchor = ANCHORS[self._index % len(ANCHORS)]
        scene.add_label(f"/handles/{self._index}/gizmo/name", self.task.name, anchor=anchor)

    @property
    def target(self) -> Array:
        """Target of the handle, in the shape of the task's targets [m, rad]."""
        frame = np.eye(4)
        frame[:3, :3], frame[:3, 3] = SO3(self._gizmo.wxyz).as_matrix(), self.position
        return point_of(self.task, frame, self._shape)

    @property
    def position(self) -> Array:
        """Position of the handle in space [m]."""
        return np.asarray(np.array(self._carrier.position, dtype=float) + self._gizmo.position)

    def place(self, x: Array) -> None:
        """Place the handle on a target."""
        frame = frame_of(self.task, x)
        self._gizmo.wxyz, self._gizmo.position = SO3.from_matrix(frame[:3, :3]).wxyz, self._held * frame[:3, 3]

    def follow(self, frame: Array) -> None:
        """Show the task's frame, and follow the frame in the coordinates that the task does not select."""
        self._frame.position, self._frame.wxyz = frame[:3, 3], SO3.from_matrix(frame[:3, :3]).wxyz
        self._carrier.position = (1.0 - self._held) * frame[:3, 3]

    def gap(self, frame: Array) -> Array:
        """Lines from the task's frame to the handle, shape (N, 2, 3)."""
        p, lines = frame[:3, 3], []
        for axis in self.axes:
            now, target = (p + self.size * R[:3, axis] for R in (frame, SO3(self._gizmo.wxyz).as_matrix()))
            lines += [(p, now), (now, target)]
        return np.array(lines or [(p, self.position)])
