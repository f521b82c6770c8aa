"""The viewer: the parts of its page, and their connections."""

from __future__ import annotations

import os

from ..bounds import clearance_among
from ..motion.fastest import fastest
from ..motion.run import Run
from ..motion.simulation import simulate, track
from ..schemes import Scheme
from .controls import Controls, Player
from .page import Page
from .playback import Playback
from .readout import Chart, Readout
from .scene import Meshes, RunScene


class Viewer(Page):
    """A page in the browser with a run. A change of a parameter on the page repeats the simulation.

    Serves from another thread until close(), or until the end of a with block; url is the address of the page. All
    later runs have the arm, path, start, task and limits of the first run. Other parameters and errors are as for
    fpbm_cpp.view().
    """

    def __init__(
        self,
        run: Run,
        *,
        urdf: str | os.PathLike[str] | None = None,
        host: str = "127.0.0.1",
        port: int = 8080,
        open_browser: bool = False,
    ) -> None:
        self._bounds = run.options.get("bounds") or ()
        playback = Playback(run, clearance_among(self._bounds))
        meshes = None if urdf is None else Meshes(urdf, run.arm, playback.run.q[0])
        super().__init__(host, port)
        self._first = run
        self._asked: tuple[Scheme, bool] | None = None  # The shown choice; None after a failed choice on the page.
        gui = self._server.gui
        is_fastest = run.function is fastest
        if is_fastest or run.options.get("keep_path"):
            duration = float(run.t[-1])
        else:
            duration = max(path._duration() or 0.0 for path in run.paths.values()) + run.options.get("hold", 0.0)
        with self._lock:  # The first events of the page wait until all parts exist.
            self._readout = Readout(gui)
            self._player = Player(gui, duration, self._draw)
            limits = None if is_fastest else run.limits  # The fastest motion always keeps its limits.
            limited, gains = run.scale is not None, run.stack is None
            self._controls = Controls(gui, run.arm, run.scheme, self._on_change, limits, limited, gains=gains)
            self._chart = Chart(gui, playback, duration)
            self._scene = RunScene(self._server, playback, meshes, self._bounds)
            self._show(run)
        self._start(self._player.advance, open_browser)

    @property
    def run(self) -> Run:
        """The motion shown."""
        return self._run

    @property
    def scheme(self) -> Scheme:
        """The shown scheme. Assign another scheme to simulate it; ValueError if it is invalid for the arm."""
        return self.run.scheme

    @scheme.setter
    def scheme(self, scheme: Scheme) -> None:
        with self._lock:
            run = rerun(self._first, scheme, self._controls.limited)
            self._controls.take(scheme)
            self._show(run)

    @property
    def time(self) -> float:
        """The shown time [s]. Assign another time to show the run at that time."""
        return self._player.time

    @time.setter
    def time(self, seconds: float) -> None:
        self._player.time = seconds

    def play(self) -> None:
        """Start the clock; at the end of the motion, the clock restarts from 0."""
        self._player.play()

    def pause(self) -> None:
        """Stop the clock."""
        self._player.pause()

    def _on_change(self) -> None:
        """Simulate the scheme that is selected on the page; of several simultaneous requests, the last counts."""
        with self._lock:
            try:
                asked = self._controls.scheme(), self._controls.limited
                if asked != self._asked:
                    self._show(rerun(self._first, *asked))
            except ValueError as error:
                self._asked = None
                self._readout.refuse(str(error))

    def _show(self, run: Run) -> None:
        playback = Playback(run, clearance_among(self._bounds))
        with self._lock, self._server.atomic():
            self._asked = run.scheme, self._controls.limited
            self._run, self._playback = run, playback
            for part in (self._scene, self._readout, self._chart):
                part.show(playback)
            self._player.end = float(playback.run.t[-1])
            self._draw(self._player.time)

    def _draw(self, seconds: float) -> None:
        with self._lock, self._server.atomic():
            sample = self._playback.sample(seconds)
            for part in (self._scene, self._readout, self._chart):
                part.at(sample)


def rerun(run: Run, scheme: Scheme, limited: bool) -> Run:
    """The motion of a run under another scheme; if limited, within the run's or the arm's limits. Raises ValueError."""
    if run.function is fastest:
        again: Run = fastest(run.arm, run.path, scheme, run.q0, task=run.task, **run.options)
        return again
    if limited:
        return track(run.arm, run.path, scheme, run.q0, task=run.task, **run.options)
    options = {name: run.options[name] for name in ("dt", "hold", "qd0", "stack") if name in run.options}
    return simulate(run.arm, run.path, scheme, run.q0, task=run.task, partial=True, **options)
