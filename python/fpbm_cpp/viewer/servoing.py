"""A page with an arm that follows handles in real time: a server, the loop, and the parts of the page."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from numpy.typing import ArrayLike
from viser import Icon

from .._core import Status, Tick
from .._types import Array
from ..arms import Arm
from ..errors import wrong
from ..robots import Robot
from ..schemes import Scheme
from .controls import Controls
from .live_scene import LiveScene
from .loop import ServoLoop
from .page import Page
from .readout import LiveReadout, StripChart
from .scene import Meshes

SLOWEST = 5  # Smallest value of the slider of the speed [%].


class Servo(Page):
    """A page in the browser with an arm whose tip follows a handle in real time, within the joint limits.

    For a stack, each frame task has a handle with the name of the task.

    Serves from another thread until close(), or until the end of a with block; url is the address of the page.
    Parameters and errors are as for fpbm_cpp.servo(); options are the parameters of ServoLoop: task, stack, dt, limits,
    targets and bounds.
    """

    def __init__(
        self,
        arm: Arm | Robot,
        scheme: Scheme,
        q0: ArrayLike,
        *,
        urdf: str | os.PathLike[str] | None = None,
        host: str = "127.0.0.1",
        port: int = 8080,
        open_browser: bool = False,
        **options: Any,
    ) -> None:
        self._loop = ServoLoop(arm, scheme, q0, **options)
        meshes = None if urdf is None else Meshes(urdf, arm, self._loop.q)
        super().__init__(host, port)
        gui = self._server.gui
        with self._lock:  # The first events of the page wait until all parts exist.
            self._readout = LiveReadout(gui)
            self._button = gui.add_button("stop", color="red", icon=Icon.HAND_STOP, hint="Stop the arm, or continue")
            start = gui.add_button("back to start", color="gray", hint="Move arm and handles to their start")
            other = gui.add_button("other posture", color="gray", hint="Jump to another posture with the same tip")
            speed = self._loop.speed
            self._speed = gui.add_slider(
                "speed [%]",
                min=SLOWEST,
                max=100,
                step=1,
                initial_value=max(round(100 * (speed or 1.0)), SLOWEST),
                visible=speed is not None,
                hint="Largest velocity of positions and poses that follow a handle, relative to their bounds",
            )
            self._chart = StripChart(gui, self._loop)
            self._controls = Controls(gui, arm, scheme, self._on_change, gains=self._loop.stack is None)
            self._scene = LiveScene(self._server, self._loop, meshes)
            self._button.on_click(lambda _: self.resume() if self._loop.stopped else self.stop())
            start.on_click(lambda _: self.restart())
            other.on_click(lambda _: self.change_posture())
            self._speed.on_update(lambda _: self._on_speed())
            self._draw()
        self._start(self._step, open_browser)

    @property
    def target(self) -> Any:
        """The newest target, in the shape of targets [m, rad]. Assign another target to move the handle.

        For a stack, a dictionary by task name, including postures. An assigned dictionary may have some of the tasks;
        the other tasks keep their targets.
        """
        return self._loop.target

    @target.setter
    def target(self, x: ArrayLike | Mapping[str, ArrayLike]) -> None:
        stacked = self._loop.stack is not None
        if isinstance(x, Mapping) != stacked:
            kind = "a dictionary of points by task names" if stacked else "a point of the tip"
            raise wrong("target", x, f" = {x!r:.80}: must be {kind}")
        for name, point in x.items() if isinstance(x, Mapping) else [(None, x)]:
            if not self._loop.push(point, name):
                where = "" if name is None else f" of {name!r}"
                raise wrong("target", point, f"{where}: must be finite, R a rotation, and a direction not zero")
        self._scene.place_handles(self._loop)

    @property
    def scheme(self) -> Scheme:
        """The scheme. Assign another scheme to continue with it; ValueError if it is invalid for the arm."""
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
    def tip(self) -> Any:
        """The tip, in the shape of targets [m, rad]; for a stack, the point of each task by name."""
        return self._loop.tip

    @property
    def tick(self) -> Tick | None:
        """The last tick; None before the first."""
        return self._loop.tick

    @property
    def status(self) -> Status:
        """The worst status of the last quarter of a second."""
        return self._loop.status

    def stop(self) -> None:
        """Bring every joint to rest as fast as the limits allow."""
        with self._lock:
            self._loop.stop()
            self._button.label, self._button.color, self._button.icon = "continue", "green", Icon.PLAYER_PLAY

    def resume(self) -> None:
        """Follow the handles again."""
        with self._lock:
            self._loop.resume()
            self._button.label, self._button.color, self._button.icon = "stop", "red", Icon.HAND_STOP

    def change_posture(self) -> bool:
        """Put the arm at rest into another posture with the same points of all tasks. Returns whether there is one."""
        with self._lock:
            return self._loop.change_posture()

    def restart(self) -> None:
        """Restart with the arm at rest in its first posture, and the handles on the first targets."""
        with self._lock:
            self._loop.restart()
            self._scene.restart(self._loop)
            self.resume()

    def _on_change(self) -> None:
        """Continue with the scheme that is selected on the page."""
        with self._lock:
            try:
                self._loop.scheme = self._controls.scheme()
                self._readout.refuse("")
            except ValueError as error:
                self._readout.refuse(str(error))

    def _on_speed(self) -> None:
        with self._lock:  # The last call sets the newest value.
            self._loop.set_speed(self._speed.value / 100)

    def _step(self) -> None:
        self._loop.advance()
        self._draw()

    def _draw(self) -> None:
        with self._lock, self._server.atomic():
            self._scene.show(self._loop)
            self._readout.show(self._loop)
            self._chart.show(self._loop)
