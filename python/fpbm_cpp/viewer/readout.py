"""A run in words and numbers: how it ended, and its figures, now and at worst."""

from __future__ import annotations

import html
from collections.abc import Iterable

import numpy as np
from viser import GuiApi

from .._core import advice, message
from .._types import Array
from ..joint_text import joint_labels, joint_units
from ..run import RunStatus
from .film import Film

GOOD, BAD = "#009E73", "#D55E00"
CELL = "padding:0.15em 0.6em 0.15em 0"


class Readout:
    """A line on how the run ended, and a table of figures: each now, and the worst of the whole motion."""

    def __init__(self, gui: GuiApi) -> None:
        self._status = gui.add_html("")
        self._table = gui.add_html("")

    def show(self, film: Film) -> None:
        """Tell of a run."""
        self._film = film
        self._names, self._units = joint_labels(film.run.arm), joint_units(film.run.arm)
        status = film.run.status
        self._say(_ending(status), GOOD if status.ok else BAD)

    def refuse(self, reason: str) -> None:
        """Say why what is asked for cannot be run."""
        self._say(f"not run: {reason}", BAD)

    def at(self, sample: int) -> None:
        """Tell of a sample of the run."""
        film = self._film
        w = film.manipulability
        rows = [
            ("tip error", f"{film.tip_error[sample]:.3g} m", f"{film.tip_error.max():.3g} m"),
            ("fastest joint", self._fastest(film.qd[sample : sample + 1]), self._fastest(film.qd)),
            ("manipulability", f"{w[film.frame(sample)]:.3g}", f"{w.min():.3g}"),
        ]
        if film.run.task == "pose":
            turn = film.orientation_error
            rows.insert(1, ("turn error", f"{turn[sample]:.3g} rad", f"{turn.max():.3g} rad"))
        self._table.content = _table(("", "now", "at worst"), rows)

    @property
    def text(self) -> str:
        """What it says, as HTML."""
        return f"{self._status.content}{self._table.content}"

    def _say(self, text: str, colour: str) -> None:
        style = f"padding:0.4em 0.9em 0;font-size:0.85em;font-weight:600;color:{colour}"
        self._status.content = f'<div style="{style}">{html.escape(text)}</div>'

    def _fastest(self, qd: Array) -> str:
        joint = np.unravel_index(np.abs(qd).argmax(), qd.shape)[1]
        return f"{np.abs(qd).max():.3g} {self._units[joint]}/s ({self._names[joint]})"


def _ending(status: RunStatus) -> str:
    if status.ok:
        return str(status)
    return f"stopped after t = {status.time:g} s: {message(status.code)}. {advice(status.code)}"


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [_line("th", head), *(_line("td", row) for row in rows)]
    style = "font-size:0.8em;margin:0.3em 0.9em;text-align:left;font-variant-numeric:tabular-nums"
    return f'<table style="{style}">{"".join(lines)}</table>'


def _line(tag: str, cells: tuple[str, ...]) -> str:
    return "<tr>" + "".join(f'<{tag} style="{CELL}">{html.escape(cell)}</{tag}>' for cell in cells) + "</tr>"
