"""The page's inputs for the scheme: its kind, its parameters, and whether joint limits are kept."""

from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any

import numpy as np
from viser import GuiApi, GuiEvent, GuiSliderHandle

from ..motion.run import Run
from ..parameter import Parameter, parameters
from ..schemes import SCHEMES, Scheme
from ..skeleton import joint_labels

KINDS = {kind.__name__: kind for kind in SCHEMES.values()}


def _own_numbers() -> dict[str, Parameter]:
    """The numbers that some schemes have and others have not; a slider is made for each."""
    return {
        name: known
        for kind in reversed(KINDS.values())  # FPBM, which has most, says in which order.
        for name, known in parameters(kind).items()
        if known.type is float and name not in parameters(Scheme)
    }


def changed(base: Scheme, kind: type[Scheme], values: Mapping[str, Any]) -> Scheme:
    """A scheme of a kind with these values, as far as it has them; its other parameters are those of the base.

    Raises ValueError if a value is out of range.
    """
    kept = {name: getattr(base, name) for name in parameters(type(base))}
    return kind(**{name: value for name, value in {**kept, **values}.items() if name in parameters(kind)})


class Controls:
    """A choice of schemes, a slider for each parameter of the chosen one, and a checkbox for joint limits.

    Calls `on_change` when somebody on the page changes one.
    """

    def __init__(self, gui: GuiApi, run: Run, on_change: Callable[[], None]) -> None:
        self._on_change = on_change
        limits = run.limits
        bounds = [limits.lower, limits.upper, limits.velocity, limits.acceleration]
        with gui.add_folder("Scheme"):
            self._kind = gui.add_dropdown("scheme", tuple(KINDS), hint="The law that resolves the redundancy")
            own = _own_numbers()
            self._initial = {name: known.usual if known.required else known.default for name, known in own.items()}
            self._sliders = {name: _add_slider(gui, known, self._initial[name]) for name, known in own.items()}
            self._folder = gui.add_folder("weights", expand_by_default=False)
            with self._folder:
                self._weights = [
                    gui.add_slider(name, min=0.1, max=10.0, step=0.1, initial_value=1.0)
                    for name in joint_labels(run.arm)
                ]
            there = bool(np.isfinite(bounds).any())
            self._limited = gui.add_checkbox(
                "keep joint limits", run.scale is not None, visible=there, hint="The bounds of every joint"
            )
            reset = gui.add_button("reset", color="gray")
        self.take(run.scheme)
        for widget in (self._kind, self._limited, *self._sliders.values(), *self._weights):
            widget.on_update(self._on_update)
        reset.on_click(lambda _: self._reset(run.scheme))

    @property
    def limited(self) -> bool:
        """Whether joint limits are to be kept."""
        return bool(self._limited.value)

    def scheme(self) -> Scheme:
        """The scheme asked for. Raises ValueError if a parameter is out of range."""
        values: dict[str, Any] = {name: slider.value for name, slider in self._sliders.items()}
        if not self._dense:
            values["weights"] = np.array([slider.value for slider in self._weights])
        return changed(self._base, KINDS[self._kind.value], values)

    def take(self, scheme: Scheme) -> None:
        """Show a scheme; the next ones keep its options."""
        self._base = scheme
        self._kind.value = type(scheme).__name__
        for name, slider in self._sliders.items():
            _set(slider, getattr(scheme, name, self._initial[name]))
        weights = getattr(scheme, "weights", np.ones(len(self._weights)))
        self._dense = weights.ndim == 2  # No slider shows a dense matrix; it stays as it is.
        if not self._dense:
            for slider, weight in zip(self._weights, weights.tolist()):
                _set(slider, weight)
        self._show_sliders()

    def _show_sliders(self) -> None:
        known = parameters(KINDS[self._kind.value])
        for name, slider in self._sliders.items():
            slider.visible = name in known
        self._folder.visible = "weights" in known and not self._dense

    def _on_update(self, event: GuiEvent[Any]) -> None:
        if event.client is None:  # Set by the program, not on the page.
            return
        if event.target is self._kind:
            self._show_sliders()
        self._on_change()

    def _reset(self, scheme: Scheme) -> None:
        self.take(scheme)
        self._on_change()


def _add_slider(gui: GuiApi, known: Parameter, initial: float) -> GuiSliderHandle[float]:
    """A slider from 0 to the parameter's bound or, without one, to ten times its usual value."""
    most = known.high if isfinite(known.high) else 10.0 * (known.usual or 5.0)
    name = known.name.replace("alpha", "α").replace("_", " ").translate(str.maketrans("12", "₁₂"))
    hint = f"{known.help} [{known.unit}]" if known.unit else known.help
    return gui.add_slider(name, min=0.0, max=most, step=most / 100, initial_value=initial, hint=hint)


def _set(slider: GuiSliderHandle[float], value: float) -> None:
    """Set a slider's value, and extend its range if necessary."""
    slider.min, slider.max = min(slider.min, value), max(slider.max, value)
    slider.value = value
