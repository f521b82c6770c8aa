"""The viewer: a server, the page's parts, and what passes between them."""

from __future__ import annotations

import os
import threading
import time
import webbrowser
from types import TracebackType

import numpy as np
import viser
from numpy.typing import ArrayLike

from .._core import Arm, Path, Scheme
from ..joint_text import joint_labels
from ..run import Run
from .chart import Chart
from .controls import Controls
from .film import Film
from .job import Job
from .meshes import Model
from .player import Player
from .port import require_free
from .readout import Readout
from .scene import Scene


class Viewer:
    """A page in the browser with an arm on its path, which is simulated anew whenever a gain is changed there.

    Serves from another thread until it is closed, or until the end of a with block.

    Parameters
    ----------
    arm, path, scheme, q0, dt, hold, task, urdf, host, port
        As for fpbm_cpp.view().
    open_browser : bool
        Open the page in the browser.

    Attributes
    ----------
    url : str
        Where the page is.

    Raises
    ------
    ValueError, OSError
        As fpbm_cpp.view().
    """

    def __init__(
        self,
        arm: Arm,
        path: Path,
        scheme: Scheme,
        q0: ArrayLike,
        *,
        dt: float = 1e-3,
        hold: float = 0.0,
        task: str = "position",
        urdf: str | os.PathLike[str] | None = None,
        host: str = "127.0.0.1",
        port: int = 8080,
        open_browser: bool = False,
    ) -> None:
        job = Job(arm, path, np.array(q0, dtype=float).ravel(), task, {"dt": dt, "hold": hold})
        self._open(job, job.run(scheme), urdf, host, port, open_browser)

    @classmethod
    def of(
        cls,
        run: Run,
        *,
        urdf: str | os.PathLike[str] | None = None,
        host: str = "127.0.0.1",
        port: int = 8080,
        open_browser: bool = False,
    ) -> Viewer:
        """Viewer of a finished run, from which one can go on to other schemes and gains."""
        viewer = cls.__new__(cls)
        viewer._open(Job.of(run), run, urdf, host, port, open_browser)
        return viewer

    def _open(
        self, job: Job, run: Run, urdf: str | os.PathLike[str] | None, host: str, port: int, open_browser: bool
    ) -> None:
        film = Film(run)
        model = None if urdf is None else Model(urdf, job.arm, film.q[0])
        require_free(host, port)
        self._job = job
        self._asked: tuple[str, bool] | None = None  # What is shown; None where it is not what is asked for.
        self._lock = threading.RLock()
        self._server = viser.ViserServer(host, port, label="fpbm_cpp", verbose=False)
        self.url = f"http://{'localhost' if host == '0.0.0.0' else host}:{self._server.get_port()}"
        with self._lock:  # Whoever is at the page already waits until it is there.
            self._build(film, model)
        if open_browser:
            webbrowser.open(self.url)

    def _build(self, film: Film, model: Model | None) -> None:
        job, gui = self._job, self._server.gui
        # Its button to share would show the page to others, by way of somebody's server.
        gui.configure_theme(control_width="large", show_logo=False, show_share_button=False)
        gui.main_panel.dock_right()
        duration = job.path.duration + job.options.get("hold", 0.0)
        limited = film.run.scale is not None if job.has_limits() else None
        self._readout = Readout(gui)
        self._player = Player(gui, duration, self._draw)
        self._controls = Controls(gui, film.run.scheme, joint_labels(job.arm), limited, self._on_change)
        self._chart = Chart(gui, film, duration)
        self._scene = Scene(self._server, film, model)
        self._show(film)

    @property
    def run(self) -> Run:
        """The motion that is shown."""
        return self._film.run

    @property
    def scheme(self) -> Scheme:
        """The scheme that is shown. One that is assigned is simulated at once; ValueError where it cannot be."""
        return self.run.scheme

    @scheme.setter
    def scheme(self, scheme: Scheme) -> None:
        with self._lock:
            run = self._job.run(scheme, self._controls.limited)
            self._controls.take(scheme)
            self._show(Film(run))

    @property
    def time(self) -> float:
        """The time that is shown [s]; one that is assigned is shown at once."""
        return self._player.time

    @time.setter
    def time(self, seconds: float) -> None:
        self._player.time = seconds

    def play(self) -> None:
        """Let time run."""
        self._player.play()

    def pause(self) -> None:
        """Stop time."""
        self._player.pause()

    def wait(self) -> None:
        """Serve until Ctrl-C, then close."""
        with self:
            try:
                while True:
                    time.sleep(3600.0)
            except KeyboardInterrupt:
                pass

    def close(self) -> None:
        """Stop serving; once more does no harm."""
        self._player.close()
        self._server.stop()

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def _repr_html_(self) -> str:
        return f'<iframe src="{self.url}" style="width:100%;height:640px;border:1px solid #ddd"></iframe>'

    def _on_change(self) -> None:
        """Somebody at the page wants another scheme; where several do at once, the last word counts."""
        with self._lock:
            try:
                scheme = self._controls.scheme()
                asked = (repr(scheme), self._controls.limited)
                if asked != self._asked:
                    self._show(Film(self._job.run(scheme, self._controls.limited)))
            except ValueError as error:
                self._asked = None
                self._readout.refuse(str(error))

    def _show(self, film: Film) -> None:
        with self._lock, self._server.atomic():
            self._asked = (repr(film.run.scheme), self._controls.limited)
            self._film = film
            for part in (self._scene, self._readout, self._chart):
                part.show(film)
            self._player.end = float(film.t[-1])
            self._draw(self._player.time)

    def _draw(self, seconds: float) -> None:
        with self._lock, self._server.atomic():
            sample = self._film.at(seconds)
            for part in (self._scene, self._readout, self._chart):
                part.at(sample)
