"""Key figures of several motions as a table."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from textwrap import fill

import numpy as np

from .._core import Status
from ..shown import html_table, number
from .run import Run

WIDTH = 100  # Characters in a line of a remark.
# Key figures: column heading, unit, and the figure of a run.
FIGURES: dict[str, tuple[str, str, Callable[[Run], float]]] = {
    "max_error": ("tip error", "m", Run.max_error),
    "max_orientation_error": ("tip error", "rad", Run.max_orientation_error),
    "peak_velocity": ("peak qd", "rad/s", lambda run: float(np.abs(run.qd).max())),
    "final_velocity": ("final qd", "rad/s", lambda run: float(np.abs(run.qd[-1]).max())),
    "peak_acceleration": ("peak qdd", "rad/s^2", lambda run: float(np.abs(run.qdd).max())),
    "final_acceleration": ("final qdd", "rad/s^2", lambda run: float(np.abs(run.qdd[-1]).max())),
    "manipulability": ("manip.", "least", lambda run: float(run.manipulability().min())),
}
Row = tuple[Sequence[str], str, Mapping[str, float]]


def columns(*rows: Sequence[str]) -> str:
    """Rows of cells as aligned columns; the first column is left-aligned. Rows may be shorter than the first row."""
    whole = [[*row, *[""] * (len(rows[0]) - len(row))] for row in rows]
    widths = [max(map(len, column)) for column in zip(*whole)]
    lines = ("  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]) for row in whole)
    return "\n".join(line.rstrip() for line in lines)


def figure_table(names: Sequence[str], task: str, rows: Iterable[Row], remarks: Iterable[str]) -> str:
    """Table with a row for each scheme: named cells, complete motions, figures of the worst motion; remarks below."""
    header, cells = _cells(names, task, rows)
    lines = [fill(remark, WIDTH, subsequent_indent="  ") for remark in remarks]
    return "\n".join([columns(*header, *cells), *([""] if lines else []), *lines])


def _cells(names: Sequence[str], task: str, rows: Iterable[Row]) -> tuple[list[list[str]], list[list[str]]]:
    """Two rows of headings, and the rows of a table."""
    shown = [name for name in FIGURES if task == "pose" or name != "max_orientation_error"]
    header = zip(*((name, "") for name in (*names, "complete")), *(FIGURES[name][:2] for name in shown))
    cells = [[*first, done, *(number(figures[name]) for name in shown if figures)] for first, done, figures in rows]
    return [list(each) for each in header], cells


def named_runs(runs: Sequence[Run] | Mapping[str, Run]) -> dict[str, Run]:
    """Runs by their names or, without names, by the names of their schemes, with numbers for equal names.

    Raises ValueError if there is no run.
    """
    if not runs:
        raise ValueError("runs: must hold at least one run")
    if isinstance(runs, Mapping):
        return dict(runs)
    names = [type(run.scheme).__name__ for run in runs]
    return {
        name if names.count(name) == 1 else f"{name} {names[: i + 1].count(name)}": run
        for i, (name, run) in enumerate(zip(names, runs))
    }


@dataclass(frozen=True)
class Comparison:
    """Key figures of several motions: print() writes a table, and a notebook shows a table.

    figures: for each run by name, its figures by name: max_error and max_orientation_error, which are the largest
    errors of the tip [m] and [rad]; peak_velocity, final_velocity, peak_acceleration and final_acceleration of the
    joints [rad/s] and [rad/s^2]; and manipulability, which is the least of the motion. A run without a sample has no
    figures. complete: for each run, 'yes', 'off its path', or the time at which the motion stopped. remarks: causes and
    remedies.
    """

    figures: dict[str, dict[str, float]]
    complete: dict[str, str]
    remarks: tuple[str, ...]
    task: str

    def _rows(self) -> list[Row]:
        return [([name], self.complete[name], figures) for name, figures in self.figures.items()]

    def __str__(self) -> str:
        return figure_table(["scheme"], self.task, self._rows(), self.remarks)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        header, cells = _cells(["scheme"], self.task, self._rows())
        headings = [f"{name} [{unit}]" if unit else name for name, unit in zip(*header)]
        return html_table("\n".join(self.remarks), headings, cells)


def comparison(runs: Sequence[Run] | Mapping[str, Run]) -> Comparison:
    """Key figures of several runs as a table, as `fpbm-cpp compare` prints it.

    Runs without names get the names of their schemes. Raises ValueError if there is no run.
    """
    named = named_runs(runs)
    remarks: dict[str, list[str]] = {}
    for name, run in named.items():
        if run.status.code is not Status.OK or run.status.left_path:
            remarks.setdefault(" ".join(str(run.status).split()), []).append(name)
    of_runs = {
        name: {figure: of_run(run) for figure, (_, _, of_run) in FIGURES.items()} if len(run.t) else {}
        for name, run in named.items()
    }
    ends = {name: _end(run) if len(run.t) else "" for name, run in named.items()}
    kind = "pose" if any(run.kind == "pose" for run in named.values()) else "position"
    return Comparison(of_runs, ends, tuple(f"{', '.join(names)}: {text}" for text, names in remarks.items()), kind)


def _end(run: Run) -> str:
    if not run.status:
        return f"to {run.status.time:.3g} s"
    return "off its path" if run.status.left_path else "yes"
