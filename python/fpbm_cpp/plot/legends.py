"""Legends: in the line of a heading, beside one panel, or below all panels."""

from collections.abc import Sequence
from math import ceil
from typing import Any

from .theme import TEXT, Theme

FOOT_ROW = 0.19  # Height of a row of the legend below all panels [in].


def head_legend(axes: Any, theme: Theme, handles: Sequence[Any] | None = None) -> None:
    """Legend of a few lines, right of the heading."""
    place = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderpad": 0.2}
    _legend(axes, theme, handles=handles or axes.get_lines(), ncols=9, handlelength=1.5, **place)


def side_legend(axes: Any, theme: Theme) -> None:
    """Legend of many lines, right of the axes."""
    handles, names = axes.get_legend_handles_labels()
    anchor = (1.02, 1.0)
    _legend(axes, theme, handles=handles, loc="upper left", bbox_to_anchor=anchor, ncols=1 + (len(names) - 1) // 8)


def foot_legend(part: Any, theme: Theme, panels: Sequence[Any], width: float, names: Sequence[str] = ()) -> None:
    """One legend for all panels, in place of their own."""
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
    """Number of entries in a row: as many as the longest name allows in this width [in], and equal in all rows."""
    room = max(1, int(width / (0.5 + 0.072 * max(map(len, names)))))
    return ceil(len(names) / ceil(len(names) / room))


def _legend(part: Any, theme: Theme, **options: Any) -> None:
    defaults = {"handlelength": 2.2, "handletextpad": 0.5, "columnspacing": 1.0, "borderaxespad": 0.0}
    part.legend(**{**defaults, **options}, frameon=False, fontsize=TEXT, labelcolor=theme.ink)
