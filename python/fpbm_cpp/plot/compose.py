"""Figure of one motion: the panels that are asked for, laid out on a column or a page."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping, Sequence
from math import ceil
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from .joints import joint_names
from .legends import foot_legend, foot_rows
from .lines import label_time_below
from .panels import PANELS, Panel, choose
from .theme import COLUMN, DPI, PAGE, TEXT, Theme, dress, theme_of

if TYPE_CHECKING:
    from ..run import Run

PAPER = ("arm", "axis_errors", "velocities", "accelerations")
ROW, FOOT_ROW, TITLE_ROW, SLIDE = 1.45, 0.19, 0.17, 4.0  # [in]


def compose(
    run: Run, title: str = "", panels: int | str | Sequence[str] | None = None, *, dark: bool = False
) -> Figure:
    """Figure of a run: the arm on the left, the first panels over time beside it, the rest below it.

    Sized for a paper, in text of 9 points: as wide as two columns, or as one where there are few panels and no arm.

    Parameters
    ----------
    run : Run
        The motion.
    title : str
        Heading of the figure.
    panels : sequence of str, optional
        Names from PANELS, all but the errors per axis unless given. Those that the run has nothing for are left out:
        'scale' and 'saturation' where no limits were kept, 'axis_turn_errors' where the task is no pose. A number
        stands for so many panels of the paper's figures.
    dark : bool
        On black instead of white.

    Raises
    ------
    ValueError
        Where a name is not in PANELS or stands twice, or no panel is left.
    """
    names = choose(run, PAPER[:panels] if isinstance(panels, int) else panels)
    return lay_out(run, title, {name: PANELS[name] for name in names}, theme_of(dark), lettered=len(names) > 1)[0]


def plot_run(run: Run, *, panels: str | Sequence[str] | None = None, dark: bool = False) -> Figure:
    """Figure of a whole run, as far as it went: compose() under a title that says what moved, how and along what."""
    columns, _ = _columns(choose(run, panels))
    scheme, path = (re.sub(r"\d+\.\d{5,}", _short, repr(part)) for part in (run.scheme, run.path))
    width = 85 if len(columns) > 1 else 42
    whole = f"{scheme} along {path}"
    lines = [whole] if len(whole) <= width else [scheme, f"along {path}"]
    if not run.status:
        lines.append(f"stopped after t = {run.status.time:g} s")
    title = [row for line in lines for row in textwrap.wrap(line, width, max_lines=2, placeholder=" …")]
    return compose(run, "\n".join(title), panels, dark=dark)


def _short(number: re.Match[str]) -> str:
    return f"{float(number[0]):.4g}"


def lay_out(
    run: Run, title: str, panels: Mapping[str, Panel], theme: Theme, lettered: bool
) -> tuple[Figure, dict[str, Any]]:
    """Figure of these panels, and the axes of each."""
    columns, rows = _columns(list(panels))
    width = PAGE if len(columns) > 1 else COLUMN
    joints = joint_names(run.arm) if any(panel.of_joints for panel in panels.values()) else []
    foot = FOOT_ROW * foot_rows(joints, width)
    head = TITLE_ROW * (title.count("\n") + 1) if title else 0.0
    # Up to three panels beside the arm fill a slide of 16:9.
    body = SLIDE - head - foot if "arm" in panels and rows <= 3 else ROW * rows + 0.25
    figure = Figure((width, head + body + foot), dpi=DPI, layout="constrained", facecolor=theme.paper)
    figure.suptitle(title, fontsize=TEXT + 1, color=theme.ink)
    heights = [body, foot] if joints else [body]
    upper, *lower = figure.subfigures(len(heights), 1, squeeze=False, height_ratios=heights)[:, 0]
    drawn = _grid(upper, columns, rows, space=run.positions.shape[1] == 3)
    for letter, (name, axes) in zip("abcdefghijkl", drawn.items()):
        dress(axes, theme, f"({letter}) {panels[name].heading}" if lettered else panels[name].heading)
        panels[name].draw(axes, run, theme)
    for column in columns:
        label_time_below([drawn[name] for name in column if name != "arm"])
    for part in lower:
        foot_legend(part, theme, [axes for name, axes in drawn.items() if panels[name].of_joints], width)
    return figure, drawn


def _columns(names: Sequence[str]) -> tuple[list[list[str]], int]:
    """What stands in each column, and how many rows there are: the arm takes those that nothing else needs."""
    rest = [name for name in names if name != "arm"]
    if "arm" in names:
        rows = ceil(len(rest) / 2) + 1
        columns = [["arm", *rest[rows:]], rest[:rows]]
    else:
        rows = len(rest) if len(rest) <= 3 else ceil(len(rest) / 2)
        columns = [rest[:rows], rest[rows:]]
    return [column for column in columns if column], rows


def _grid(part: Any, columns: Sequence[Sequence[str]], rows: int, space: bool) -> dict[str, Any]:
    """Axes of each panel."""
    drawn: dict[str, Any] = {}
    for side, column in zip(part.subfigures(1, len(columns), squeeze=False)[0], columns):
        heights = [rows - len(column) + 1 if name == "arm" else 1 for name in column]
        for name, cell in zip(column, side.add_gridspec(len(column), 1, height_ratios=heights)):
            drawn[name] = side.add_subplot(cell, projection="3d" if space and name == "arm" else None)
    return drawn
