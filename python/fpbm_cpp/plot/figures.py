"""Figures of one motion and of several motions, with the width of a column or a page of a paper."""

import re
import textwrap
from collections.abc import Callable, Mapping, Sequence
from math import ceil
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from .._types import Array
from ..motion.comparison import named_runs
from ..motion.run import Run
from .lines import envelope, foot_height, foot_legend, from_zero, in_decades, label_time_below, over_time
from .panels import Panel, choose, joint_names, unit_of
from .theme import COLUMN, DARK, LIGHT, PAGE, TITLE_ROW, Theme, dress, sheet

ROW, COMPARED_ROW, SLIDE = 1.45, 1.75, 4.0  # [in]
ONE = 2.4  # Height of a single panel [in].


def plot_run(
    run: Run,
    title: str | None = None,
    panels: str | Sequence[str] | None = None,
    *,
    dark: bool = False,
    bounds: bool = False,
) -> Figure:
    """Figure of a run, up to its end: the arm on the left, the first panels beside the arm, the other panels below.

    The text is 9 points high. The figure is two columns of a paper wide, or one column for few panels without an arm.
    The default title has the scheme and the path. panels are names from PANELS; default: all except the components of
    the error, and the torques only if the motion has TorqueBounds. Panels without data are left out: for example
    'saturation' without joint limits, 'clearance' without a clearance, 'axis_orientation_errors' if the task is a
    position. dark: dark background. bounds: whether the panels of the joints show all finite bounds; otherwise, only
    bounds close to a joint. A notebook shows the figure. Raises ValueError if a panel is unknown or given twice, or no
    panel has data.
    """
    chosen = choose(run, panels)
    if title is None:
        title = _title(run, 85 if len(_columns(chosen)[0]) > 1 else 42, 2 if len(chosen) > 1 else 1)
    return lay_out(run, title, chosen, DARK if dark else LIGHT, lettered=len(chosen) > 1, bounds=bounds)[0]


def _title(run: Run, width: int, lines_each: int) -> str:
    """Scheme and path, in lines of at most width characters, and the time of an early stop."""

    def short(part: object) -> str:
        return re.sub(r"\d+\.\d{5,}", lambda number: f"{float(number[0]):.4g}", repr(part))

    paths = run.paths.items()
    along = f"along {', '.join(short(path) if len(paths) == 1 else f'{task}: {short(path)}' for task, path in paths)}"
    whole = f"{short(run.scheme)} {along}"
    lines = [whole] if len(whole) <= width else [short(run.scheme), along]
    if not run.status:
        lines.append(f"stopped after t = {run.status.time:g} s")
    return "\n".join(
        row for line in lines for row in textwrap.wrap(line, width, max_lines=lines_each, placeholder=" …")
    )


def lay_out(
    run: Run, title: str, panels: Mapping[str, Panel], theme: Theme, lettered: bool, bounds: bool = False
) -> tuple[Figure, dict[str, Any]]:
    """Figure of these panels, and the axes of each."""
    columns, rows = _columns(panels)
    width = PAGE if len(columns) > 1 else COLUMN
    entries = [*joint_names(run.arm), "bound"] if any(panel.of_joints for panel in panels.values()) else []
    foot = foot_height(entries, width)
    # Up to three panels beside the arm fill a slide of 16:9.
    slide = SLIDE - foot - (TITLE_ROW * (title.count("\n") + 1) if title else 0.0)
    body = slide if "arm" in panels and rows <= 3 else ROW * rows + 0.25 if len(panels) > 1 else ONE
    figure, (upper, *lower) = sheet(width, [body, foot] if foot else [body], title, theme)
    drawn: dict[str, Any] = {}
    for side, column in zip(upper.subfigures(1, len(columns), squeeze=False)[0], columns):
        heights = [rows - len(column) + 1 if name == "arm" else 1 for name in column]
        for name, cell in zip(column, side.add_gridspec(len(column), 1, height_ratios=heights)):
            space = name == "arm" and run.positions.shape[1] == 3
            drawn[name] = side.add_subplot(cell, projection="3d" if space else None)
    for letter, (name, axes) in zip("abcdefghijklmn", drawn.items()):
        dress(axes, theme, f"({letter}) {panels[name].heading}" if lettered else panels[name].heading)
        panels[name].draw(axes, run, theme, *([bounds] if panels[name].of_joints else []))
    for column in columns:
        label_time_below([drawn[name] for name in column if name != "arm"])
    for part in lower:
        foot_legend(part, theme, [axes for name, axes in drawn.items() if panels[name].of_joints], width)
    return figure, drawn


def _columns(panels: Mapping[str, Panel]) -> tuple[list[list[str]], int]:
    """The panels of each column, and the number of rows; the arm fills the remaining rows of its column."""
    rest = [name for name in panels if name != "arm"]
    if "arm" in panels:
        rows = ceil(len(rest) / 2) + 1
        columns = [["arm", *rest[rows:]], rest[:rows]]
    else:
        rows = len(rest) if len(rest) <= 3 else ceil(len(rest) / 2)
        columns = [rest[:rows], rest[rows:]]
    return [column for column in columns if column], rows


def _norms(rows: Array) -> Array:
    return np.asarray(np.linalg.norm(rows, axis=1))


# Panels of a comparison: heading, values of a run, symbol, and suffix of the joints' unit, or None.
Quantity = tuple[str, Callable[[Run], Array], str, str | None]
VELOCITIES: Quantity = "Joint velocities", lambda run: _norms(run.qd), r"$\|\dot q\|$", "/s"
ACCELERATIONS: Quantity = "Joint accelerations", lambda run: _norms(run.qdd), r"$\|\ddot q\|$", "/s²"
DISTANCES: Quantity = "Distance from the first posture", lambda run: _norms(run.q - run.q[:1]), r"$\|q - q(0)\|$", ""
TIP_ERROR: Quantity = "Tip error", lambda run: run.error_norms()[0], r"$\|e\|$ [m]", None
POSITION_ERROR: Quantity = "Position error", *TIP_ERROR[1:]
ORIENTATION_ERROR: Quantity = "Orientation error", lambda run: run.error_norms()[1], r"$\|e\|$ [rad]", None
MANIPULABILITY: Quantity = "Manipulability", lambda run: run.manipulability(), "√det(JJᵀ)", None
POSITION_TASK = (VELOCITIES, ACCELERATIONS, TIP_ERROR, MANIPULABILITY)
POSE_TASK = (VELOCITIES, ACCELERATIONS, DISTANCES, POSITION_ERROR, ORIENTATION_ERROR, MANIPULABILITY)


def compare(runs: Sequence[Run] | Mapping[str, Run], title: str = "", *, dark: bool = False) -> Figure:
    """Figure of several runs, with one line for each run. Runs without names get the names of their schemes.

    The panels show joint velocities, joint accelerations, tip error and manipulability over time; if the task is a
    pose, also the orientation error and the distance of the joints from their start. dark: dark background. Raises
    ValueError if there is no run.
    """
    named = named_runs(runs)
    theme, shown = DARK if dark else LIGHT, list(named.values())
    quantities = POSE_TASK if any(run.kind == "pose" for run in shown) else POSITION_TASK
    rows = len(quantities) // 2
    figure, (upper, lower) = sheet(PAGE, [COMPARED_ROW * rows, foot_height(list(named), PAGE)], title, theme)
    grid = upper.subplots(rows, 2)
    for letter, axes, (heading, values_of, symbol, per) in zip("abcdef", grid.T.flat, quantities):
        dress(axes, theme, f"({letter}) {heading}")
        log = "error" in heading
        # The first line is widest, so that coincident lines are all visible.
        for run, (colour, dash), width in zip(shown, theme.styles(), np.linspace(3.0, 1.4, len(shown))):
            t, values = run.t, values_of(run)
            axes.plot(*(envelope(t, values) if log else (t, values)), color=colour, ls=dash, lw=width)
        over_time(axes, symbol if per is None else f"{symbol} [{unit_of(shown, per)}]")
        in_decades(axes) if log else from_zero(axes)
    for column in grid.T:
        label_time_below(list(column))
    foot_legend(lower, theme, [grid[0, 0]], PAGE, list(named))
    return figure
