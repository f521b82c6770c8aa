"""The time shown: a slider, and a clock that moves it."""

import threading
import time
from collections.abc import Callable
from typing import Any

from viser import GuiApi, GuiEvent, Icon

RATE = 30.0  # Pictures per second.
SPEEDS = {"⅒ ×": 0.1, "¼ ×": 0.25, "½ ×": 0.5, "1 ×": 1.0, "2 ×": 2.0, "5 ×": 5.0}


class Player:
    """Calls `moved` with the time to show, whenever somebody on the page or the clock changes it."""

    def __init__(self, gui: GuiApi, duration: float, moved: Callable[[float], None]) -> None:
        self._moved, self._time, self.end = moved, 0.0, duration
        with gui.add_folder("Time"):
            step = min(0.01, duration / 100)
            self._slider = gui.add_slider("t [s]", min=0.0, max=duration, step=step, initial_value=0.0)
            self._button = gui.add_button("play", icon=Icon.PLAYER_PLAY)
            self._speed = gui.add_dropdown("speed", tuple(SPEEDS), initial_value="1 ×")
            self._loop = gui.add_checkbox("loop", True)
        self._slider.on_update(self._on_slider)
        self._button.on_click(lambda _: self.pause() if self.playing else self.play())
        self._lock = threading.RLock()  # Taken before any lock that `moved` takes.
        self._running = threading.Event()
        self._closed = False
        self._clock = threading.Thread(target=self._tick, name="fpbm_cpp viewer", daemon=True)
        self._clock.start()

    @property
    def time(self) -> float:
        """The time shown [s]."""
        return self._time

    @time.setter
    def time(self, value: float) -> None:
        self._time = min(max(value, 0.0), self.end)
        self._slider.value = self._time
        self._moved(self._time)

    @property
    def playing(self) -> bool:
        return self._running.is_set()

    def play(self) -> None:
        """Start the clock; at the end of the motion it starts from 0."""
        if self._time >= self.end:
            self.time = 0.0
        self._running.set()
        self._button.label, self._button.icon = "pause", Icon.PLAYER_PAUSE

    def pause(self) -> None:
        """Stop the clock; it does not move time after this returns."""
        with self._lock:
            self._running.clear()
        self._button.label, self._button.icon = "play", Icon.PLAYER_PLAY

    def close(self) -> None:
        self._closed = True
        self._running.set()
        self._clock.join()

    def _on_slider(self, event: GuiEvent[Any]) -> None:
        if event.client is not None:
            self._time = min(float(self._slider.value), self.end)
            self._moved(self._time)

    def _tick(self) -> None:
        while not self._closed:
            self._running.wait()
            last = time.perf_counter()
            while self._running.is_set() and not self._closed:
                time.sleep(1.0 / RATE)
                now = time.perf_counter()
                self._advance(SPEEDS[self._speed.value] * (now - last))
                last = now

    def _advance(self, seconds: float) -> None:
        with self._lock:
            if not self.playing:
                return
            if self._time < self.end:
                self.time = self._time + seconds
            elif self._loop.value:
                self.time = 0.0
            else:
                self.pause()
