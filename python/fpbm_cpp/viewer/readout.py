"""A run in words and numbers: how it ended, and figures of the sample shown and of the whole motion."""

import html
from collections.abc import Iterable

import numpy as np
from viser import GuiApi

from .._core import message
from .._types import Array
from ..skeleton import joint_labels, joint_units
from .playback import Playback

GOOD, BAD = "#009E73", "#D55E00"
CELL = "padding:0.15em 0.6em 0.15em 0"


class Readout:
    """A line on how the run ended, and a table of figures: now, and the worst of the whole motion."""

    def __init__(self, gui: GuiApi) -> None:
        self._status = gui.add_html("")
        self._table = gui.add_html("")

    def show(self, playback: Playback) -> None:
        """Say how a run ended."""
        self._playback, run = playback, playback.run
        self._names, self._units = joint_labels(run.arm), joint_units(run.arm)
        stopped = f"stopped after t = {run.status.time:g} s: {message(run.status.code)}. {run.status.advice}"
        self._say(str(run.status) if run.status else stopped, GOOD if run.status else BAD)

    def refuse(self, reason: str) -> None:
        """Say why the motion asked for cannot be run."""
        self._say(f"not run: {reason}", BAD)

    def at(self, sample: int) -> None:
        """Show the figures of a sample."""
        playback = self._playback
        qd, w = playback.run.qd, playback.manipulability
        rows = [
            ("tip error", *_now_and_worst(playback.tip_error, sample, "m")),
            ("fastest joint", self._fastest(qd[sample : sample + 1]), self._fastest(qd)),
            ("manipulability", f"{w[playback.frame(sample)]:.3g}", f"{w.min():.3g}"),
        ]
        if playback.run.task == "pose":
            rows.insert(1, ("orientation error", *_now_and_worst(playback.orientation_error, sample, "rad")))
        self._table.content = _table(("", "now", "at worst"), rows)

    @property
    def text(self) -> str:
        """The readout as HTML."""
        return f"{self._status.content}{self._table.content}"

    def _say(self, text: str, colour: str) -> None:
        style = f"padding:0.4em 0.9em 0;font-size:0.85em;font-weight:600;color:{colour}"
        self._status.content = f'<div style="{style}">{html.escape(text)}</div>'

    def _fastest(self, qd: Array) -> str:
        joint = np.unravel_index(np.abs(qd).argmax(), qd.shape)[1]
        return f"{np.abs(qd).max():.3g} {self._units[joint]}/s ({self._names[joint]})"


def _now_and_worst(errors: Array, sample: int, unit: str) -> tuple[str, str]:
    return f"{errors[sample]:.3g} {unit}", f"{errors.max():.3g} {unit}"


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [_line("th", head), *(_line("td", row) for row in rows)]
    style = "font-size:0.8em;margin:0.3em 0.9em;text-align:left;font-variant-numeric:tabular-nums"
    return f'<table style="{style}">{"".join(lines)}</table>'


def _line(tag: str, cells: tuple[str, ...]) -> str:
    return "<tr>" + "".join(f'<{tag} style="{CELL}">{html.escape(cell)}</{tag}>' for cell in cells) + "</tr>"
