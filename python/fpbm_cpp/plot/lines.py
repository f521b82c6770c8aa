"""Lines over time, one for each column of an array."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.ticker import LogLocator, NullLocator

from .._types import Array
from .theme import LINE, Theme

SPANS = 400
LEAST = float(np.finfo(float).eps)


def draw_lines(axes: Any, theme: Theme, t: Array, values: Array, names: Sequence[str], label: str) -> None:
    """Draw one line for each column."""
    for column, name, (colour, dash) in zip(values.T, names, theme.styles()):
        axes.plot(t, column, color=colour, ls=dash, lw=LINE, label=name)
    over_time(axes, label)
    axes.locator_params(axis="y", nbins=5)


def over_time(axes: Any, label: str) -> None:
    """Label the axes; time fills the x axis from end to end."""
    axes.set(xlabel="time [s]", ylabel=label)
    axes.margins(x=0.0)


def label_time_below(column: Sequence[Any]) -> None:
    """Label time on the last of these panels, which stand one below the other, and align their y labels."""
    for axes in column[:-1]:
        axes.tick_params(labelbottom=False)
        axes.set_xlabel("")
    for axes in column[:1]:
        axes.figure.align_ylabels(column)


def from_zero(axes: Any) -> None:
    """Start the y axis at zero."""
    axes.set_ylim(0.0, 1.05 * axes.get_ylim()[1])
    axes.locator_params(axis="y", nbins=4)


def in_decades(axes: Any) -> None:
    """Make the y axis logarithmic, from one power of ten to another."""
    drawn = [line.get_ydata() for line in axes.get_lines() if len(line.get_ydata())]
    least, most = (float(end([end(values) for values in drawn])) if drawn else 1.0 for end in (np.min, np.max))
    lower, upper = np.floor(np.log10(least)), np.ceil(np.log10(most))
    axes.set_yscale("log")
    axes.set_ylim(10.0**lower, 10.0 ** max(upper, lower + 1.0))
    axes.yaxis.set_major_locator(LogLocator(numticks=5))
    axes.yaxis.set_minor_locator(NullLocator())


def envelope(t: Array, values: Array) -> tuple[Array, Array]:
    """The largest value in each of SPANS intervals: an error's trend without the noise of round-off."""
    values = np.maximum(values, LEAST)
    if len(t) <= SPANS:
        return t, values
    first = np.linspace(0, len(t), SPANS, endpoint=False).astype(int)
    return np.linspace(t[0], t[-1], SPANS), np.maximum.reduceat(values, first)
