"""One quantity over time, with a line at the time that is shown."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from viser import GuiApi

from .._types import Array
from ..joint_text import joint_labels, joint_units
from .colours import LINES, NOW
from .film import Film

# Quantities at the samples of a run, and what they are measured in; of joints, what their units become.
OF_JOINTS: dict[str, tuple[Callable[[Film], Array], str]] = {
    "joint velocities": (lambda film: film.qd, "/s"),
    "joint accelerations": (lambda film: film.qdd, "/s²"),
    "joint positions": (lambda film: film.q, ""),
}
OF_TIP: dict[str, tuple[Callable[[Film], Array], str]] = {
    "tip error": (lambda film: film.tip_error[film.frames], "m"),
    "turn error": (lambda film: film.orientation_error[film.frames], "rad"),
    "manipulability": (lambda film: film.manipulability, ""),
}
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class Chart:
    """A chart of the quantity that is chosen at the page, over the time that was planned."""

    def __init__(self, gui: GuiApi, film: Film, duration: float) -> None:
        self._film = film
        self._duration = duration
        self._sample = 0
        quantities = [name for name in (*OF_JOINTS, *OF_TIP) if name != "turn error" or film.run.task == "pose"]
        with gui.add_folder("Over time"):
            self._quantity = gui.add_dropdown("quantity", tuple(quantities))
            nothing = {"label": ""}
            axes = ({"size": 32}, {"size": 44})
            self._plot = gui.add_uplot(
                (np.zeros(1), np.zeros(1)), (nothing, nothing), axes=axes, height=220, padding=(8, 16, 0, 0)
            )
        self._quantity.on_update(lambda _: self.show(self._film))

    def show(self, film: Film) -> None:
        """Draw a run."""
        self._film = film
        labels, values, title = self._curves()
        self._low, self._high = _range(values)
        lines = [
            {"label": label, "stroke": LINES[i % len(LINES)], "width": 1.6, "dash": [] if i < len(LINES) else [6, 3]}
            for i, label in enumerate(labels)
        ]
        now = {"label": "now", "stroke": NOW, "width": 1.5}
        self._plot.series = ({"label": "t [s]"}, *({**line, "points": {"show": False}} for line in (*lines, now)))
        self._plot.scales = {
            "x": {"time": False, "range": (0.0, self._duration)},
            "y": {"range": (self._low, self._high)},
        }
        self._plot.title = title
        self._plot.data = (film.t[film.frames], *values.T, self._now())

    def at(self, sample: int) -> None:
        """Move the line to a sample."""
        self._sample = sample
        self._plot.data = (*self._plot.data[:-1], self._now())

    def _curves(self) -> tuple[list[str], Array, str]:
        """Labels, a column for each, and a title with unit and power of ten."""
        film, quantity = self._film, self._quantity.value
        if quantity in OF_JOINTS:
            values, per = OF_JOINTS[quantity]
            arm = film.run.arm
            unit = ", ".join(f"{unit}{per}" for unit in sorted(set(joint_units(arm)), reverse=True))
            return joint_labels(arm), values(film)[film.frames], f"{quantity} [{unit}]"
        values, unit = OF_TIP[quantity]
        column = values(film)[:, None]
        largest = float(column.max())
        exponent = int(np.floor(np.log10(largest))) if largest > 0.0 else 0
        power = f"10{str(exponent).translate(SUPERSCRIPTS)} " if exponent < -2 else ""
        scale = f"{power}{unit}".strip()
        return [quantity], column / 10.0**exponent if power else column, f"{quantity} [{scale}]" if scale else quantity

    def _now(self) -> Array:
        """A line from below to above, between two neighbours in time."""
        line = np.full(len(self._film.frames), np.nan)
        first = min(self._film.frame(self._sample), max(len(line) - 2, 0))
        line[first : first + 2] = (self._low, self._high)[: len(line)]
        return line


def _range(values: Array) -> tuple[float, float]:
    """From below all values to above, with a little room."""
    low, high = float(values.min()), float(values.max())
    low, high = (0.0, high) if 0.0 <= low < high / 2 else (low, high)
    room = 0.05 * (high - low) or 1.0
    return low - room, high + room
