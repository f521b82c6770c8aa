"""The viewer: a server, the parts of the page, and their connections."""

from __future__ import annotations

import atexit
import os
import threading
import time
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType

try:
    import rich
    import viser
    import yourdfpy  # noqa: F401
except ModuleNotFoundError as missing:
    raise ImportError('viewing needs viser: pip install "fpbm_cpp[view]"') from missing

from ..motion.run import Run
from ..schemes import Scheme
from ..skeleton import joint_labels
from .chart import Chart
from .controls import Controls
from .meshes import Meshes
from .playback import Playback
from .player import Player
from .port import require_free
from .readout import Readout
from .rerun import has_limits, rerun
from .scene import Scene


class Viewer:
    """A page in the browser with a run, which is simulated again whenever a parameter is changed on the page.

    Serves from another thread until it is closed, or until the end of a with block.

    Parameters
    ----------
    run : Run
        What to show first; all later runs have its arm, path, start, task and limits.
    urdf, host, port
        As for fpbm_cpp.view().
    open_browser : bool
        Open the page in the browser.

    Attributes
    ----------
    url : str
        Address of the page.

    Raises
    ------
    ValueError, OSError
        As fpbm_cpp.view().
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
        playback = Playback(run)
        meshes = None if urdf is None else Meshes(urdf, run.arm, playback.run.q[0])
        require_free(host, port)
        self._first = run
        self._asked: tuple[Scheme, bool] | None = None  # What is shown; None if the page asks for something else.
        self._lock = threading.RLock()
        with _quiet():
            self._server = viser.ViserServer(host, port, label="fpbm_cpp", verbose=False)
        atexit.register(self.close)  # Before viser's own exit, which prints.
        self.url = f"http://{'localhost' if host == '0.0.0.0' else host}:{self._server.get_port()}"
        with self._lock:  # The page's first events wait until all parts are there.
            self._build(playback, meshes)
        if open_browser:
            webbrowser.open(self.url)

    def _build(self, playback: Playback, meshes: Meshes | None) -> None:
        run, gui = self._first, self._server.gui
        # The share button would show the page to others, through somebody's server.
        gui.configure_theme(control_width="large", show_logo=False, show_share_button=False)
        gui.main_panel.dock_right()
        duration = run.path.duration + run.options.get("hold", 0.0)
        limited = run.scale is not None if has_limits(run) else None
        self._readout = Readout(gui)
        self._player = Player(gui, duration, self._draw)
        self._controls = Controls(gui, run.scheme, joint_labels(run.arm), limited, self._on_change)
        self._chart = Chart(gui, playback, duration)
        self._scene = Scene(self._server, playback, meshes)
        self._show(run)

    @property
    def run(self) -> Run:
        """The motion shown."""
        return self._run

    @property
    def scheme(self) -> Scheme:
        """The scheme shown. Assign another one to simulate it at once; ValueError if it does not suit the arm."""
        return self.run.scheme

    @scheme.setter
    def scheme(self, scheme: Scheme) -> None:
        with self._lock:
            run = rerun(self._first, scheme, self._controls.limited)
            self._controls.take(scheme)
            self._show(run)

    @property
    def time(self) -> float:
        """The time shown [s]. Assign another one to show it."""
        return self._player.time

    @time.setter
    def time(self, seconds: float) -> None:
        self._player.time = seconds

    def play(self) -> None:
        """Start the clock."""
        self._player.play()

    def pause(self) -> None:
        """Stop the clock."""
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
        """Stop serving. Closing twice does no harm."""
        atexit.unregister(self.close)
        self._player.close()
        with _quiet():
            self._server.stop()

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def _repr_html_(self) -> str:
        return f'<iframe src="{self.url}" style="width:100%;height:640px;border:1px solid #ddd"></iframe>'

    def _on_change(self) -> None:
        """Simulate the scheme that the page asks for; of several requests at once, the last one counts."""
        with self._lock:
            try:
                asked = self._controls.scheme(), self._controls.limited
                if asked != self._asked:
                    self._show(rerun(self._first, *asked))
            except ValueError as error:
                self._asked = None
                self._readout.refuse(str(error))

    def _show(self, run: Run) -> None:
        playback = Playback(run)
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


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep viser's messages off the terminal: it prints them with rich, whether it is to be verbose or not."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before
