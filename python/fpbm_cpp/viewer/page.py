"""A page in the browser: its server, its address, its clock, and its end."""

from __future__ import annotations

import atexit
import errno
import socket
import threading
import time
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from typing import TypeVar

import rich
import viser

P = TypeVar("P", bound="Page")

RATE = 30.0  # Pictures per second.


class Page(AbstractContextManager["Page"]):
    """Serves from another thread until close(), or until the end of a with block; url is the address of the page.

    Raises OSError if the port is in use, ValueError if the host or the port is invalid.
    """

    def __init__(self, host: str, port: int) -> None:
        _require_free(host, port)
        self._lock, self._closed = threading.RLock(), threading.Event()
        self._clock: threading.Thread | None = None
        with _quiet():
            self._server = viser.ViserServer(host, port, label="fpbm_cpp", verbose=False)
        atexit.register(self.close)  # Runs before viser's own exit handler, which prints.
        shown = {"0.0.0.0": "localhost", "::": "localhost"}.get(host, f"[{host}]" if ":" in host else host)
        self.url = f"http://{shown}:{self._server.get_port()}"
        # The share button would publish the page through a third-party server.
        self._server.gui.configure_theme(control_width="large", show_logo=False, show_share_button=False)
        self._server.gui.main_panel.dock_right()

    def _start(self, step: Callable[[], None], open_browser: bool) -> None:
        """Call a function RATE times per second until close(), from another thread. Open the page on request."""

        def run() -> None:
            while not self._closed.wait(1.0 / RATE):
                step()

        self._clock = threading.Thread(target=run, name="fpbm_cpp page", daemon=True)
        self._clock.start()
        if open_browser:
            webbrowser.open(self.url)

    def wait(self) -> None:
        """Print the address, serve until Ctrl-C, then close."""
        with self, suppress(KeyboardInterrupt):
            print(f"{self.url}: Ctrl-C stops the server.", flush=True)
            while True:
                time.sleep(3600.0)

    def close(self) -> None:
        """Stop serving. A second call has no effect."""
        atexit.unregister(self.close)
        self._closed.set()
        if self._clock is not None:
            self._clock.join()
        with _quiet():
            self._server.stop()

    def __enter__(self: P) -> P:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _repr_html_(self) -> str:
        return f'<iframe src="{self.url}" style="width:100%;height:640px;border:1px solid #ddd"></iframe>'


def _require_free(host: str, port: int) -> None:
    """Raise OSError if the port is not free; viser would use another port without a message."""
    if not 0 <= port <= 65535:
        raise ValueError(f"port = {port}: must be 0 to 65535")
    with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except socket.gaierror as error:
            raise ValueError(f"host = {host!r}: must be an address of this machine: {error.strerror}") from None
        except OSError as error:
            text = f"cannot serve at {host}, port {port}: {error.strerror}: choose another host or port"
            if error.errno == errno.EADDRINUSE:
                text = f"port {port} is in use: choose another port, or 0 for a free port"
            raise OSError(error.errno, text) from None


@contextmanager
def _quiet() -> Iterator[None]:
    """Suppress the messages of viser, which prints them with rich even if verbose is False."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before
