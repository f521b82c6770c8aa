"""The scene of a servo: the arm, its handles, and the shapes of the clearance."""

from __future__ import annotations

from collections import deque
from functools import partial
from typing import Any

import numpy as np
from viser import TransformControlsHandle, ViserServer
from viser.transforms import SO3

from .._types import Array
from ..arms import PlanarArm
from ..robots import Robot
from ..skeleton import frames_of, joint_points, length
from ..tasks import FrameTask
from .controls import RATE
from .frames import in_space
from .handle import Handle
from .loop import ServoLoop
from .obstacles import can_be_dragged
from .scene import TARGET, TIP, Meshes, segments, set_up
from .shapes import Shapes, centre, draw_bounds
from .strip import SECONDS

REACH = 0.65  # Radius of the view about the base, relative to the length of the arm.


class LiveScene:
    """The arm, a handle for each task of a frame with lines to it, and the path of the tip in the last ten seconds.

    For a Robot, the paths of the frames of the tasks. A task that is relative to another frame has no handle.
    """

    def __init__(self, server: ViserServer, loop: ServoLoop, meshes: Meshes | None) -> None:
        points = in_space(joint_points(loop.arm, loop.q))
        reach = REACH * length(loop.arm, loop.q)
        around = points[0] + reach * np.vstack([np.eye(3)[:2], -np.eye(3)[:2], points[-1:] - points[0]])
        self._arm, self._tip, radius = set_up(server, loop.arm, loop.q, meshes, np.vstack([points, around]))
        self._tip.visible = not isinstance(loop.arm, Robot)
        self.handles = _handles(server, loop, 0.3 * radius)
        nothing = np.zeros((0, 2, 3), dtype=np.float32)
        self._trace, self._gap = (
            server.scene.add_line_segments(name, nothing, color, thickness=width, thickness_units="screen")
            for name, color, width in (("/trace", TIP, 4.0), ("/gap", TARGET, 2.0))
        )
        self._shapes = None if loop.clearance is None else Shapes(server.scene, loop.arm, loop.clearance)
        draw_bounds(server.scene, loop.task_bounds)
        self._grips = _grips(server, loop, 0.12 * radius)
        self.restart(loop)

    def restart(self, loop: ServoLoop) -> None:
        self.place_handles(loop)
        for place, grip in self._grips:
            grip.position = place
        self._passed: deque[Array] = deque(maxlen=round(SECONDS * RATE))

    def place_handles(self, loop: ServoLoop) -> None:
        """Put the handles on the newest targets."""
        for handle in self.handles:
            handle.follow(loop.frame(handle.task.name))
            handle.place(loop.target_of(handle.task.name))

    def show(self, loop: ServoLoop) -> None:
        q = loop.q
        self._arm.pose(q)
        nothing = np.zeros((0, 2, 3), dtype=np.float32)
        gaps: list[Array] = []
        frames = [loop.frame(handle.task.name) for handle in self.handles]
        for handle, frame in zip(self.handles, frames):
            handle.follow(frame)
            gaps.append(handle.gap(frame))
        self._gap.points = np.concatenate([nothing, *gaps]).astype(np.float32)
        if not isinstance(loop.arm, Robot):
            frames = [frames_of(loop.arm, q, "tip")]
            self._tip.position, self._tip.wxyz = frames[0][:3, 3], SO3.from_matrix(frames[0][:3, :3]).wxyz
        self._passed.append(np.array([frame[:3, 3] for frame in frames]))
        self._trace.points = np.concatenate([nothing, *map(segments, np.array(self._passed).swapaxes(0, 1))])
        if self._shapes is not None and loop.clearance is not None:
            self._shapes.at(loop.clearance, q, None if loop.tick is None else loop.tick.nearest)


def _handles(server: ViserServer, loop: ServoLoop, size: float) -> list[Handle]:
    """A handle for each frame task; with a stack, the handle shows the name of the task."""
    handles = []
    own = [task for task in loop.tasks if isinstance(task, FrameTask) and task.reference_frame is None]
    for i, task in enumerate(own):
        push = partial(loop.push, task=task.name)
        handles.append(
            Handle(server.scene, i, isinstance(loop.arm, PlanarArm), task, loop.target_of(task.name), size, push)
        )
        if loop.stack is not None:
            handles[-1].label(server.scene)
    return handles


def _grips(server: ViserServer, loop: ServoLoop, size: float) -> list[tuple[Array, TransformControlsHandle]]:
    """Arrows on each obstacle that can be dragged, and its given place."""
    clearance = loop.clearance
    grips = []
    for i, shape in enumerate(clearance.obstacles if clearance is not None else ()):
        if can_be_dragged(shape):
            look = {"scale": size, "disable_rotations": True, "depth_test": False}
            grip = server.scene.add_transform_controls(f"/grip_{i}", position=centre(shape), **look)
            grips.append((centre(shape), grip))
            _follow(grip, loop, shape.name, centre(shape))
    return grips


def _follow(grip: TransformControlsHandle, loop: ServoLoop, name: str, place: Array) -> None:
    """Make an obstacle follow its arrows."""

    async def tell(_: Any) -> None:
        loop.drag(name, np.array(grip.position) - place)

    grip.on_update(tell)
