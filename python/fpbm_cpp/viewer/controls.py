"""Inputs of the page: the scheme, its parameters, and the joint limits; the time, and its clock."""

import threading
import time
from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any

import numpy as np
from viser import GuiApi, GuiEvent, GuiSliderHandle, Icon

from ..arms import Arm
from ..joints import JointLimits
from ..parameter import Parameter, parameters
from ..robots import Robot
from ..schemes import SCHEMES, WITHOUT_DYNAMICS, Scheme
from ..skeleton import joint_labels

SPEEDS = {"⅒ ×": 0.1, "¼ ×": 0.25, "½ ×": 0.5, "1 ×": 1.0, "2 ×": 2.0, "5 ×": 5.0}
KINDS = {kind.__name__: kind for kind in SCHEMES.values()}
_PLAIN = tuple(WITHOUT_DYNAMICS.values())
GAINS = ("k1", "k2", "k")
# Numbers of some schemes; each has a slider.
NUMBERS = {
    name: known
    for kind in reversed(KINDS.values())  # FPBM has most numbers and defines the order.
    for name, known in parameters(kind).items()
    if known.type is float and name not in parameters(Scheme)
}


def changed(base: Scheme, kind: type[Scheme], values: Mapping[str, Any]) -> Scheme:
    """A scheme of a kind with the parameters in `values`, and all other parameters of `base`. Raises ValueError."""
    known = {**base._values(), **values}
    return kind(**{name: value for name, value in known.items() if name in parameters(kind)})


class Controls:
    """Inputs for the scheme and its parameters. A change on the page calls `on_change`.

    limits: limits that the page can switch on; limited: the first choice. Without limits, the page has no switch.
    gains: whether schemes have gains; with a stack, whose tasks have gains, the gains of the scheme are 0.
    """

    def __init__(
        self,
        gui: GuiApi,
        arm: Arm | Robot,
        scheme: Scheme,
        on_change: Callable[[], None],
        limits: JointLimits | None = None,
        limited: bool = False,
        gains: bool = True,
    ) -> None:
        self._on_change = on_change
        self._hidden = () if gains else GAINS
        with gui.add_folder("Scheme"):
            shown = [name for name, kind in KINDS.items() if kind in _PLAIN or isinstance(scheme, kind)]
            self._kind = gui.add_dropdown("scheme", shown, hint="Redundancy resolution scheme")
            self._initial = {name: known.usual if known.required else known.default for name, known in NUMBERS.items()}
            self._initial |= dict.fromkeys(self._hidden, 0.0)
            self._sliders = {name: _add_slider(gui, known, self._initial[name]) for name, known in NUMBERS.items()}
            self._folder = gui.add_folder("weights", expand_by_default=False)
            with self._folder:
                self._weights = [
                    gui.add_slider(name, 0.1, 10.0, step=0.1, initial_value=1.0) for name in joint_labels(arm)
                ]
            self._limited = gui.add_checkbox(
                "keep joint limits", limited, visible=_bounded(limits), hint="Bounds of all joints"
            )
            reset = gui.add_button("reset", color="gray")
        self.take(scheme)
        for widget in (self._kind, self._limited, *self._sliders.values(), *self._weights):
            widget.on_update(self._on_update)
        reset.on_click(lambda _: self._reset(scheme))

    @property
    def limited(self) -> bool:
        return bool(self._limited.value)

    def scheme(self) -> Scheme:
        """The requested scheme. Raises ValueError if a parameter is out of range."""
        values: dict[str, Any] = {name: slider.value for name, slider in self._sliders.items()}
        if not self._dense:
            values["weights"] = np.array([slider.value for slider in self._weights])
        return changed(self._base, KINDS[self._kind.value], values)

    def take(self, scheme: Scheme) -> None:
        """Show a scheme; the following schemes keep its options."""
        self._base = scheme
        self._kind.value = type(scheme).__name__
        for name, slider in self._sliders.items():
            _set(slider, getattr(scheme, name, self._initial[name]))
        given = getattr(scheme, "weights", None)
        weights = np.ones(len(self._weights)) if given is None else given
        self._dense = weights.ndim == 2  # A dense matrix has no sliders and is not changed.
        if not self._dense:
            for slider, weight in zip(self._weights, weights.tolist()):
                _set(slider, weight)
        self._show_sliders()

    def _show_sliders(self) -> None:
        known = parameters(KINDS[self._kind.value])
        for name, slider in self._sliders.items():
            slider.visible = name in known and name not in self._hidden
        self._folder.visible = "weights" in known and not self._dense

    def _on_update(self, event: GuiEvent[Any]) -> None:
        if event.client is None:  # The program set the value, not the user.
            return
        if event.target is self._kind:
            self._show_sliders()
        self._on_change()

    def _reset(self, scheme: Scheme) -> None:
        self.take(scheme)
        self._on_change()


def _bounded(limits: JointLimits | None) -> bool:
    if limits is None:
        return False
    bounds = [limits.lower, limits.upper, limits.velocity, limits.acceleration, limits.jerk]
    return bool(np.isfinite(np.array(bounds, dtype=float)).any())


def _add_slider(gui: GuiApi, known: Parameter, initial: float) -> GuiSliderHandle[float]:
    """A slider from 0 to the bound of the parameter or, without a bound, to ten times its usual value."""
    most = known.high if isfinite(known.high) else 10.0 * (known.usual or 5.0)
    name = known.name.replace("alpha", "α").replace("_", " ").translate(str.maketrans("12", "₁₂"))
    hint = f"{known.help} [{known.unit}]" if known.unit else known.help
    return gui.add_slider(name, min=0.0, max=most, step=most / 100, initial_value=initial, hint=hint)


def _set(slider: GuiSliderHandle[float], value: float) -> None:
    """Set a slider's value, and extend its range if necessary."""
    slider.min, slider.max = min(slider.min, value), max(slider.max, value)
    slider.value = value


class Player:
    """Calls `moved` with the time to show, if the user or the clock changes the time."""

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
        self._lock = threading.RLock()  # Acquired before any lock in `moved`.
        self.playing: bool = False
        self._last = time.perf_counter()

    @property
    def time(self) -> float:
        return self._time

    @time.setter
    def time(self, value: float) -> None:
        self._time = min(max(value, 0.0), self.end)
        self._slider.value = self._time
        self._moved(self._time)

    def play(self) -> None:
        if self._time >= self.end:
            self.time = 0.0
        self.playing = True
        self._button.label, self._button.icon = "pause", Icon.PLAYER_PAUSE

    def pause(self) -> None:
        with self._lock:  # After this block, the clock does not change the time.
            self.playing = False
        self._button.label, self._button.icon = "play", Icon.PLAYER_PLAY

    def _on_slider(self, event: GuiEvent[Any]) -> None:
        if event.client is not None:
            self._time = min(float(self._slider.value), self.end)
            self._moved(self._time)

    def advance(self) -> None:
        """Show the present time of the clock."""
        now = time.perf_counter()
        passed, self._last = SPEEDS[self._speed.value] * (now - self._last), now
        with self._lock:
            if not self.playing:
                return
            if self._time < self.end:
                self.time = self._time + passed
            elif self._loop.value:
                self.time = 0.0
            else:
                self.pause()
