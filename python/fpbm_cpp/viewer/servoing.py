"""A page with an arm that follows a handle, live: a server, the loop, the parts of the page, and their connections."""

from __future__ import annotations

import os
import threading
import webbrowser
from collections import deque
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from viser import Icon, TransformControlsHandle, ViserServer
from viser.transforms import SO3

from .._core import Status, TargetFilter, Tick
from .._types import Array
from ..arms import Arm, JointLimits
from ..clearance import Clearance
from ..schemes import Scheme
from ..skeleton import joint_points
from .controls import RATE, Controls
from .handle import Handle
from .live import LiveReadout, StripChart
from .loop import ServoLoop
from .obstacles import can_be_dragged
from .page import Page
from .scene import TARGET, TIP, Meshes, in_space, segments, set_up, tip_pose
from .shapes import Shapes, centre
from .strip import SECONDS

REACH = 0.65  # Of the arm's length, about its base, is in view.


class Servo(Page):
    """A page in the browser with an arm that follows a handle at its tip, live, within its joints' limits.

    Serves from another thread until it is closed, or until the end of a with block; url is the page's address. The
    parameters are those of fpbm_cpp.servo(), and so are the errors.
    """

    def __init__(
        self,
        arm: Arm,
        scheme: Scheme,
        q0: ArrayLike,
        *,
        task: str = "position",
        dt: float = 1e-3,
        limits: JointLimits | None = None,
        targets: TargetFilter | None = None,
        clearance: Clearance | None = None,
        urdf: str | os.PathLike[str] | None = None,
        host: str = "127.0.0.1",
        port: int = 8080,
        open_browser: bool = False,
    ) -> None:
        self._loop = ServoLoop(arm, scheme, q0, task=task, dt=dt, limits=limits, targets=targets, clearance=clearance)
        meshes = None if urdf is None else Meshes(urdf, arm, self._loop.q)
        super().__init__(host, port)
        gui = self._server.gui
        self._lock = threading.RLock()
        with self._lock:  # The page's first events wait until all parts are there.
            self._readout = LiveReadout(gui)
            self._button = gui.add_button("stop", color="red", icon=Icon.HAND_STOP, hint="Brake, or follow again")
            start = gui.add_button("back to start", color="gray", hint="Arm and handle as they were at first")
            self._chart = StripChart(gui, self._loop.strip)
            self._controls = Controls(gui, arm, scheme, self._on_change)
            self._scene = LiveScene(self._server, self._loop, meshes)
            self._button.on_click(lambda _: self.resume() if self._loop.stopped else self.stop())
            start.on_click(lambda _: self.restart())
            self._draw()
        self._closed = threading.Event()
        self._clock = threading.Thread(target=self._run, name="fpbm_cpp servo", daemon=True)
        self._clock.start()
        if open_browser:
            webbrowser.open(self.url)

    @property
    def target(self) -> Array:
        """Where the handle is, shaped as targets are [m, rad]. Assign another one to put it there."""
        return self._scene.handle.target

    @target.setter
    def target(self, x: ArrayLike) -> None:
        if not self._loop.push(x):
            raise ValueError("target: must be finite, and its R a rotation")
        self._scene.handle.place(np.array(x, dtype=float))

    @property
    def scheme(self) -> Scheme:
        """The scheme. Assign another one to go on with it; ValueError if it does not suit the arm."""
        return self._loop.scheme

    @scheme.setter
    def scheme(self, scheme: Scheme) -> None:
        with self._lock:
            self._loop.scheme = scheme
            self._controls.take(scheme)
            self._readout.refuse("")

    @property
    def q(self) -> Array:
        """Joint positions [rad]."""
        return self._loop.q

    @property
    def tip(self) -> Array:
        """The tip, shaped as targets are [m, rad]."""
        return self._loop.tip

    @property
    def tick(self) -> Tick | None:
        """The last tick; None before the first."""
        return self._loop.tick

    @property
    def status(self) -> Status:
        """The worst of the last quarter of a second."""
        return self._loop.status

    def stop(self) -> None:
        """Bring every joint to rest as fast as the limits allow."""
        with self._lock:
            self._loop.stop()
            self._button.label, self._button.color, self._button.icon = "go on", "green", Icon.PLAYER_PLAY

    def resume(self) -> None:
        """Follow the handle again."""
        with self._lock:
            self._loop.resume()
            self._button.label, self._button.color, self._button.icon = "stop", "red", Icon.HAND_STOP

    def restart(self) -> None:
        """Begin anew: the arm at rest in its first posture, the handle at its tip."""
        with self._lock:
            self._loop.restart()
            self._scene.restart(self._loop)
            self.resume()

    def close(self) -> None:
        """Stop serving. Closing twice does no harm."""
        self._closed.set()
        self._clock.join()
        super().close()

    def _on_change(self) -> None:
        """Go on with the scheme that the page asks for."""
        with self._lock:
            try:
                self._loop.scheme = self._controls.scheme()
                self._readout.refuse("")
            except ValueError as error:
                self._readout.refuse(str(error))

    def _run(self) -> None:
        while not self._closed.wait(1.0 / RATE):
            self._loop.advance()
            self._draw()

    def _draw(self) -> None:
        with self._lock, self._server.atomic():
            self._scene.show(self._loop)
            self._readout.show(self._loop)
            self._chart.show(self._loop.strip)


class LiveScene:
    """The arm, the handle, the way of the tip in the last ten seconds, and a line from the tip to the handle."""

    def __init__(self, server: ViserServer, loop: ServoLoop, meshes: Meshes | None) -> None:
        points = in_space(joint_points(loop.arm, loop.q))
        reach = REACH * float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
        around = points[0] + reach * np.vstack([np.eye(3)[:2], -np.eye(3)[:2], points[-1:] - points[0]])
        self._arm, self._tip, radius = set_up(server, loop.arm, loop.q, meshes, np.vstack([points, around]))
        self.handle = Handle(server.scene, loop.arm, loop.task, 0.3 * radius, loop.push)
        nothing = np.zeros((0, 2, 3), dtype=np.float32)
        self._way, self._gap = (
            server.scene.add_line_segments(name, nothing, color, thickness=width, thickness_units="screen")
            for name, color, width in (("/way", TIP, 4.0), ("/gap", TARGET, 2.0))
        )
        self._shapes = None if loop.clearance is None else Shapes(server.scene, loop.arm, loop.clearance)
        self._grips = _grips(server, loop, 0.12 * radius)
        self.restart(loop)

    def restart(self, loop: ServoLoop) -> None:
        self.handle.place(loop.target)
        for place, grip in self._grips:
            grip.position = place
        self._passed: deque[Array] = deque(maxlen=round(SECONDS * RATE))

    def show(self, loop: ServoLoop) -> None:
        q = loop.q
        pose = tip_pose(loop.arm, q)
        self._arm.pose(q)
        self._tip.position, self._tip.wxyz = pose[:3, 3], SO3.from_matrix(pose[:3, :3]).wxyz
        self._passed.append(pose[:3, 3])
        self._way.points = segments(np.array(self._passed))
        self._gap.points = segments(np.array([pose[:3, 3], self.handle.position]))
        if self._shapes is not None and loop.clearance is not None:
            nearest = None if loop.tick is None else loop.tick.nearest
            self._shapes.at(loop.clearance, q, None if nearest is None else nearest.pair)


def _grips(server: ViserServer, loop: ServoLoop, size: float) -> list[tuple[Array, TransformControlsHandle]]:
    """Arrows on each obstacle that can be dragged, and where it was given."""
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
    """Let an obstacle follow its arrows."""

    async def tell(_: Any) -> None:
        loop.drag(name, np.array(grip.position) - place)

    grip.on_update(tell)
