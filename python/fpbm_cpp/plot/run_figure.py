"""Figure of one motion: its panels, laid out on a column or a page."""

import re
import textwrap
from collections.abc import Mapping, Sequence
from math import ceil
from typing import Any

from matplotlib.figure import Figure

from ..motion.run import Run
from .joints import joint_names
from .legends import foot_height, foot_legend
from .lines import label_time_below
from .panels import PANELS, Panel, choose
from .theme import COLUMN, PAGE, TITLE_ROW, Theme, dress, sheet, theme_of

ROW, SLIDE = 1.45, 4.0  # [in]


def plot_run(
    run: Run, title: str | None = None, panels: str | Sequence[str] | None = None, *, dark: bool = False
) -> Figure:
    """Figure of a run, as far as it went: the arm on the left, the first panels beside it, the others below it.

    Its text is 9 points high. It is two columns of a paper wide, or one column where there are few panels and no arm.
    Raises ValueError if a panel is unknown or given twice, or no panel is left.

    Parameters
    ----------
    run : Run
        The motion.
    title : str, optional
        Title of the figure; by default the scheme and the path.
    panels : sequence of str, optional
        Names from PANELS; by default all but the components of the error. Panels that the run has no data for are left
        out: 'scale' and 'saturation' without joint limits, 'axis_orientation_errors' where the task is a position.
    dark : bool
        Dark background.
    """
    names = choose(run, panels)
    if title is None:
        title = _title(run, 85 if len(_columns(names)[0]) > 1 else 42)
    return lay_out(run, title, {name: PANELS[name] for name in names}, theme_of(dark), lettered=len(names) > 1)[0]


def _title(run: Run, width: int) -> str:
    """Scheme and path, in lines of so many characters, and when the motion stopped if it stopped early."""
    scheme, path = (re.sub(r"\d+\.\d{5,}", _short, repr(part)) for part in (run.scheme, run.path))
    whole = f"{scheme} along {path}"
    lines = [whole] if len(whole) <= width else [scheme, f"along {path}"]
    if not run.status:
        lines.append(f"stopped after t = {run.status.time:g} s")
    return "\n".join(row for line in lines for row in textwrap.wrap(line, width, max_lines=2, placeholder=" …"))


def _short(number: re.Match[str]) -> str:
    return f"{float(number[0]):.4g}"


def lay_out(
    run: Run, title: str, panels: Mapping[str, Panel], theme: Theme, lettered: bool
) -> tuple[Figure, dict[str, Any]]:
    """Figure of these panels, and the axes of each."""
    columns, rows = _columns(list(panels))
    width = PAGE if len(columns) > 1 else COLUMN
    foot = foot_height(joint_names(run.arm) if any(panel.of_joints for panel in panels.values()) else [], width)
    # Up to three panels beside the arm fill a slide of 16:9.
    slide = SLIDE - foot - (TITLE_ROW * (title.count("\n") + 1) if title else 0.0)
    body = slide if "arm" in panels and rows <= 3 else ROW * rows + 0.25
    figure, (upper, *lower) = sheet(width, [body, foot] if foot else [body], title, theme)
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
    """The panels of each column, and the number of rows; the arm takes the rows that its column has left."""
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
