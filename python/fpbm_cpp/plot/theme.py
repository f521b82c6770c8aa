"""The one look of all figures: colours, dashes and sizes of a paper's column, on white or on black."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import cycle
from typing import Any

from matplotlib.colors import Colormap, LinearSegmentedColormap

# Okabe and Ito's colours, told apart by colour-blind readers. Yellow is last, and no line's on white.
OKABE_ITO = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#000000", "#F0E442")
DASHES = ("-", "--", ":", "-.")

TEXT = 9.0  # [pt]
COLUMN, PAGE = 3.5, 64 / 9  # Width of one column of a journal and, nearly, of two [in].
DPI = 270  # A page is 1920 pixels wide.
LINE = 1.4  # [pt]


@dataclass(frozen=True)
class Theme:
    """What figures are drawn in: colours by what they are for, and of lines and of postures in turn."""

    paper: str
    ink: str
    soft: str
    grid: str
    pane: str
    tip: str
    axes: tuple[str, str, str]
    lines: tuple[str, ...]
    fade: Colormap

    def styles(self) -> Iterator[tuple[str, str]]:
        """Colour and dash of each line in turn: 28 that differ, neighbours in both, for readers of greyscale."""
        return zip(cycle(self.lines), cycle(DASHES))


LIGHT = Theme(
    paper="#FFFFFF",
    ink="#000000",
    soft="#555555",
    grid="#E3E3E3",
    pane="#F7F7F7",
    tip="#D55E00",
    axes=("#D55E00", "#009E73", "#0072B2"),
    lines=OKABE_ITO[:7],
    fade=LinearSegmentedColormap.from_list("fade", ["#C9DDF0", "#5BA3D0", "#08306B"]),
)
DARK = Theme(
    paper="#14171A",
    ink="#ECECEC",
    soft="#A6ACB2",
    grid="#30353A",
    pane="#1B1F23",
    tip="#FF7F32",
    axes=("#FF7F32", "#1FC796", "#4AA3E8"),
    lines=("#4AA3E8", "#E69F00", "#1FC796", "#E08FBD", "#9AD8FF", "#E8601C", "#ECECEC"),
    fade=LinearSegmentedColormap.from_list("fade in the dark", ["#24384A", "#3F7FB0", "#CFE8FF"]),
)


def theme_of(dark: bool) -> Theme:
    """The theme of a figure on black, or on white."""
    return DARK if dark else LIGHT


def dress(axes: Any, theme: Theme, heading: str) -> None:
    """Background, heading, grid and sizes of text, before anything is drawn."""
    axes.set_facecolor(theme.paper)
    axes.set_title(heading, loc="left", fontsize=TEXT, fontweight="bold", color=theme.ink, pad=4.0)
    axes.tick_params(labelsize=TEXT, colors=theme.ink, length=2.5, pad=2.5)
    for axis in (axes.xaxis, axes.yaxis):
        axis.label.set(size=TEXT, color=theme.ink)
        axis.labelpad = 2.5
        axis.offsetText.set(size=TEXT, color=theme.ink)
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set(color=theme.ink, linewidth=0.7)
    axes.grid(color=theme.grid, lw=0.6)
    axes.set_axisbelow(True)
