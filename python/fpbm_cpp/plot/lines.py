"""Lines over time and their legends: beside a heading, beside a panel, or below all panels."""

from collections.abc import Sequence
from math import ceil
from typing import Any

import numpy as np
from matplotlib.ticker import LogLocator, NullLocator

from .._types import Array
from .theme import LINE, TEXT, Theme

FOOT_ROW = 0.19  # Height of a row of the legend below all panels [in].
TOP_ROW = 0.19  # Height of a row of a legend inside a panel, relative to the panel.
PANEL_WIDTH = 3.05  # Width of a panel [in].
SPANS = 400
LEAST = float(np.finfo(float).eps)


def draw_lines(axes: Any, theme: Theme, t: Array, values: Array, names: Sequence[str], label: str) -> None:
    for column, name, (colour, dash) in zip(values.T, names, theme.styles()):
        axes.plot(t, column, color=colour, ls=dash, lw=LINE, label=name)
    over_time(axes, label)
    axes.locator_params(axis="y", nbins=5)


def over_time(axes: Any, label: str) -> None:
    """Label the axes; the x axis has no margins."""
    axes.set(xlabel="time [s]", ylabel=label)
    axes.margins(x=0.0)


def label_time_below(column: Sequence[Any]) -> None:
    """Label time on the last panel of a column, and align the y labels."""
    for axes in column[:-1]:
        axes.tick_params(labelbottom=False)
        axes.set_xlabel("")
    for axes in column[:1]:
        axes.figure.align_ylabels(column)


def from_zero(axes: Any) -> None:
    axes.set_ylim(0.0, 1.05 * axes.get_ylim()[1])
    axes.locator_params(axis="y", nbins=4)


def in_decades(axes: Any) -> None:
    """Make the y axis logarithmic, with powers of ten at both ends."""
    drawn = [line.get_ydata() for line in axes.get_lines() if len(line.get_ydata())]
    least, most = (float(end([end(values) for values in drawn])) if drawn else 1.0 for end in (np.min, np.max))
    lower, upper = np.floor(np.log10(least)), np.ceil(np.log10(most))
    axes.set_yscale("log")
    axes.set_ylim(10.0**lower, 10.0 ** max(upper, lower + 1.0))
    axes.yaxis.set_major_locator(LogLocator(numticks=5))
    axes.yaxis.set_minor_locator(NullLocator())


def envelope(t: Array, values: Array) -> tuple[Array, Array]:
    """The largest value in each of SPANS intervals: the trend of an error without round-off noise."""
    values = np.maximum(values, LEAST)
    if len(t) <= SPANS:
        return t, values
    first = np.linspace(0, len(t), SPANS, endpoint=False).astype(int)
    return np.linspace(t[0], t[-1], SPANS), np.maximum.reduceat(values, first)


def head_legend(axes: Any, theme: Theme, handles: Sequence[Any] | None = None) -> None:
    """Legend of a few lines, to the right of the heading."""
    place = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderpad": 0.2}
    _legend(axes, theme, handles=handles or axes.get_lines(), ncols=9, handlelength=1.5, **place)


def top_legend(axes: Any, theme: Theme) -> None:
    """Legend of a few lines with long names, in the axes, higher than each line; the y axis gets longer."""
    names = axes.get_legend_handles_labels()[1]
    if not names:
        return
    across = _across(names, PANEL_WIDTH)
    room = min(TOP_ROW * ceil(len(names) / across) + 0.02, 0.7)
    scale = axes.yaxis.get_transform()
    low, high = scale.transform(np.array(axes.get_ylim()))
    axes.set_ylim(*scale.inverted().transform(np.array([low, low + (high - low) / (1.0 - room)])))
    _legend(axes, theme, loc="upper left", ncols=across, labelspacing=0.2, borderpad=0.2)


def side_legend(axes: Any, theme: Theme) -> None:
    """Legend of many lines, to the right of the axes."""
    handles, names = axes.get_legend_handles_labels()
    anchor = (1.02, 1.0)
    _legend(axes, theme, handles=handles, loc="upper left", bbox_to_anchor=anchor, ncols=1 + (len(names) - 1) // 8)


def foot_legend(part: Any, theme: Theme, panels: Sequence[Any], width: float, names: Sequence[str] = ()) -> None:
    """One legend for all panels, which replaces their own legends."""
    entries: dict[str, Any] = dict(zip(names, panels[0].get_lines()))
    for axes in panels:
        if axes.get_legend():
            axes.get_legend().remove()
            entries.update(zip(*reversed(axes.get_legend_handles_labels())))
    across = _across(list(entries), width)
    _legend(part, theme, handles=list(entries.values()), labels=list(entries), loc="center", ncols=across)


def foot_height(names: Sequence[str], width: float) -> float:
    """Height of a legend below all panels [in]."""
    return FOOT_ROW * ceil(len(names) / _across(names, width)) if names else 0.0


def _across(names: Sequence[str], width: float) -> int:
    """Number of entries in a row: as many as the longest name admits in this width [in], and equal in all rows."""
    room = max(1, int(width / (0.5 + 0.072 * max(map(len, names)))))
    return ceil(len(names) / ceil(len(names) / room))


def _legend(part: Any, theme: Theme, **options: Any) -> None:
    defaults = {"handlelength": 2.2, "handletextpad": 0.5, "columnspacing": 1.0, "borderaxespad": 0.0}
    part.legend(**{**defaults, **options}, frameon=False, fontsize=TEXT, labelcolor=theme.ink)
