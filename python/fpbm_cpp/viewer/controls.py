"""Which scheme, with which gains: the page's inputs, and the scheme that they come to."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from viser import GuiApi, GuiEvent, GuiSliderHandle

from .._core import Scheme
from .schemes import GAINS, KINDS, Family

# Label, range, step, and what it does.
SLIDERS = {
    "alpha": ("α", 1.0, 0.01, "Share of WMVN; MAN has the rest"),
    "k": ("k", 50.0, 0.5, "Feedback on the tip's position [1/s]"),
    "k1": ("k₁", 50.0, 0.5, "Feedback on the tip's velocity [1/s]"),
    "k2": ("k₂", 200.0, 1.0, "Feedback on the tip's position [1/s²]"),
    "null_damping": ("null damping", 10.0, 0.1, "Damping of the self-motion [1/s]"),
}
LEAST_WEIGHT, MOST_WEIGHT = 0.1, 10.0


class Controls:
    """A choice of schemes, a slider for each gain of the one that is chosen, and whether limits are kept.

    Calls `changed` when somebody at the page changes one.
    """

    def __init__(
        self, gui: GuiApi, scheme: Scheme, names: list[str], limited: bool | None, changed: Callable[[], None]
    ) -> None:
        self._changed = changed
        with gui.add_folder("Scheme"):
            self._kind = gui.add_dropdown("scheme", tuple(KINDS), hint="The law that resolves the redundancy")
            self._sliders = {
                name: gui.add_slider(label, min=0.0, max=most, step=step, initial_value=0.0, hint=hint)
                for name, (label, most, step, hint) in SLIDERS.items()
            }
            self._folder = gui.add_folder("weights", expand_by_default=False)
            with self._folder:
                self._weights = [
                    gui.add_slider(name, min=LEAST_WEIGHT, max=MOST_WEIGHT, step=0.1, initial_value=1.0)
                    for name in names
                ]
            self._limited = gui.add_checkbox(
                "keep joint limits", bool(limited), visible=limited is not None, hint="The arm's bounds of every joint"
            )
            again = gui.add_button("as it was given", color="gray")
        self.take(scheme)
        for widget in (self._kind, self._limited, *self._sliders.values(), *self._weights):
            widget.on_update(self._on_update)
        again.on_click(lambda _: self._give_back(scheme))

    @property
    def limited(self) -> bool:
        """Whether limits are to be kept."""
        return bool(self._limited.value)

    def scheme(self) -> Scheme:
        """What is asked for. Raises ValueError where a gain is out of range."""
        gains: dict[str, Any] = {name: slider.value for name, slider in self._sliders.items()}
        weights = self._family.gains["weights"]
        gains["weights"] = weights if weights.ndim == 2 else np.array([slider.value for slider in self._weights])
        return self._family.scheme(self._kind.value, gains)

    def take(self, scheme: Scheme) -> None:
        """Show a scheme; the next ones have its options."""
        self._family = Family(scheme, len(self._weights))
        gains = self._family.gains
        self._kind.value = self._family.kind
        for name, slider in self._sliders.items():
            _set(slider, float(gains[name]))
        if gains["weights"].ndim == 1:
            for slider, weight in zip(self._weights, gains["weights"]):
                _set(slider, float(weight))
        self._show_those_that_count()

    def _show_those_that_count(self) -> None:
        taken = GAINS[self._kind.value]
        for name, slider in self._sliders.items():
            slider.visible = name in taken
        self._folder.visible = "weights" in taken and self._family.gains["weights"].ndim == 1

    def _on_update(self, event: GuiEvent[Any]) -> None:
        if event.client is None:  # Set from here.
            return
        if event.target is self._kind:
            self._show_those_that_count()
        self._changed()

    def _give_back(self, scheme: Scheme) -> None:
        self.take(scheme)
        self._changed()


def _set(slider: GuiSliderHandle[float], value: float) -> None:
    """A slider's value, and room for it."""
    slider.min, slider.max = min(slider.min, value), max(slider.max, value)
    slider.value = value
