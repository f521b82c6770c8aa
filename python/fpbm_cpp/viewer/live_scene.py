"""The scene of a servo: the arm, its handles, and the shapes of the clearance."""

from __future__ import annotations

from collections import deque
from functools import partial
from typing import Any

import numpy as np
from viser import TransformControlsHandle, ViserServer

from .._types import Array
from ..arms import PlanarArm
from ..obstacle import HalfSpace
from ..robots import Robot
from ..skeleton import frames_of, joint_points, length
from ..tasks import FrameTask
from .frames import in_space
from .handle import Handle
from .loop import SECONDS, ServoLoop
from .page import RATE
from .scene import TARGET, TIP, Meshes, Scene, segments
from .shapes import centre

REACH = 0.65  # Radius of the view about the base, relative to the length of the arm.


class LiveScene(Scene):
    """The arm, a handle for each task of a frame with lines to it, and the path of the tip in the last ten seconds.

    For a Robot, the paths of the frames of the tasks. A task that is relative to another frame has no handle.
    """

    def __init__(self, server: ViserServer, loop: ServoLoop, meshes: Meshes | None) -> None:
        points = in_space(joint_points(loop.arm, loop.q))
        reach = REACH * length(loop.arm, loop.q)
        around = points[0] + reach * np.vstack([np.eye(3)[:2], -np.eye(3)[:2], points[-1:] - points[0]])
        super().__init__(server, loop.arm, loop.q, meshes, np.vstack([points, around]), loop.bounds)
        self._tip.visible = not isinstance(loop.arm, Robot)
        own = [task for task in loop.tasks if isinstance(task, FrameTask) and task.reference_frame is None]
        planar, size = isinstance(loop.arm, PlanarArm), 0.3 * self._radius
        self.handles = [
            Handle(server.scene, i, planar, task, loop.target_of(task.name), size, partial(loop.push, task=task.name))
            for i, task in enumerate(own)
        ]
        if loop.stack is not None:
            for handle in self.handles:
                handle.label(server.scene)
        self._trace = self._add_lines("/trace", TIP, 4.0)
        self._gap = self._add_lines("/gap", TARGET, 2.0)
        obstacles = () if loop.clearance is None else loop.clearance.obstacles
        self._grips = [
            (centre(shape), self._grip(i, loop, shape.name, centre(shape)))
            for i, shape in enumerate(obstacles)
            if not isinstance(shape, HalfSpace)
        ]
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
        q, nothing = loop.q, np.zeros((0, 2, 3), dtype=np.float32)
        frames = [loop.frame(handle.task.name) for handle in self.handles]
        for handle, frame in zip(self.handles, frames):
            handle.follow(frame)
        gaps = [handle.gap(frame) for handle, frame in zip(self.handles, frames)]
        self._gap.points = np.concatenate([nothing, *gaps]).astype(np.float32)
        tip = np.eye(4) if isinstance(loop.arm, Robot) else frames_of(loop.arm, q, "tip")
        self._pose(q, tip, loop.clearance, None if loop.tick is None else loop.tick.nearest)
        drawn = frames if isinstance(loop.arm, Robot) else [tip]
        self._passed.append(np.array([frame[:3, 3] for frame in drawn]))
        self._trace.points = np.concatenate([nothing, *map(segments, np.array(self._passed).swapaxes(0, 1))])

    def _grip(self, index: int, loop: ServoLoop, name: str, place: Array) -> TransformControlsHandle:
        """Arrows on an obstacle, which follows them."""
        look = {"scale": 0.12 * self._radius, "disable_rotations": True, "depth_test": False}
        grip = self._server.scene.add_transform_controls(f"/grip_{index}", position=place, **look)

        async def tell(_: Any) -> None:
            loop.drag(name, np.array(grip.position) - place)

        grip.on_update(tell)
        return grip
