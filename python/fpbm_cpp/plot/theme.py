"""The style of all figures: colours, dashes, and sizes for a column of a paper."""

from collections.abc import Iterator, Sequence
from io import BytesIO
from itertools import cycle
from typing import Any, NamedTuple

from matplotlib.colors import Colormap, LinearSegmentedColormap
from matplotlib.figure import Figure

# Okabe and Ito's colours, which colour-blind readers can distinguish. Lines on white do not use
# the last colour, yellow.
OKABE_ITO = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#000000", "#F0E442")
DASHES = ("-", "--", ":", "-.")

TEXT = 9.0  # [pt]
COLUMN, PAGE = 3.5, 64 / 9  # Width of one column of a journal, and of nearly two columns [in].
TITLE_ROW = 0.17  # Height of a line of the title [in].
DPI = 270  # A page is 1920 pixels wide.
SHOWN_DPI = 110  # Pixels per inch in a notebook.
LINE = 1.4  # [pt]


class Theme(NamedTuple):
    """Colours of a figure: background, text, the parts of the arm, lines, and postures from the first to the last."""

    paper: str = "#FFFFFF"
    ink: str = "#000000"
    soft: str = "#555555"
    grid: str = "#E3E3E3"
    pane: str = "#F7F7F7"
    tip: str = "#D55E00"
    axes: tuple[str, str, str] = ("#D55E00", "#009E73", "#0072B2")
    lines: tuple[str, ...] = OKABE_ITO[:7]
    fade: Colormap = LinearSegmentedColormap.from_list("fade", ["#C9DDF0", "#5BA3D0", "#08306B"])

    def styles(self) -> Iterator[tuple[str, str]]:
        """Colour and dash of each line: 28 pairs. Successive lines differ in colour and dash, also in grey print."""
        return zip(cycle(self.lines), cycle(DASHES))


LIGHT = Theme()
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


class Sheet(Figure):
    """A figure that a notebook shows without %matplotlib; with %matplotlib inline, it is still shown once."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        png = BytesIO()
        self.savefig(png, format="png", dpi=2 * SHOWN_DPI)
        width, height = (round(SHOWN_DPI * float(side)) for side in self.get_size_inches())
        return png.getvalue(), {"width": width, "height": height}


def sheet(width: float, heights: Sequence[float], title: str, theme: Theme) -> tuple[Figure, list[Any]]:
    """An empty figure, and its parts from top to bottom, with these heights [in]."""
    head = TITLE_ROW * (title.count("\n") + 1) if title else 0.0
    figure = Sheet((width, head + sum(heights)), dpi=DPI, layout="constrained", facecolor=theme.paper)
    figure.suptitle(title, fontsize=TEXT + 1, color=theme.ink)
    return figure, list(figure.subfigures(len(heights), 1, squeeze=False, height_ratios=heights)[:, 0])


def dress(axes: Any, theme: Theme, heading: str) -> None:
    """Set background, heading, grid and text sizes; call this first."""
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
