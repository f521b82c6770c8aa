"""Figure of a tuning: what there was to choose from, how firm the choice is, and how it was come to."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..plot import OKABE_ITO

# Without matplotlib, the line before says what to install.
from matplotlib.axes import Axes  # isort: skip
from matplotlib.figure import Figure  # isort: skip

if TYPE_CHECKING:
    from .result import Tuning
    from .trials import Trials


@dataclass(frozen=True)
class Colours:
    """Of the paper, the ink, what stands back, and what stands out."""

    paper: str
    ink: str
    faint: str
    line: str
    other: str
    best: str


LIGHT = Colours("white", "black", "0.8", OKABE_ITO[0], OKABE_ITO[1], OKABE_ITO[5])
DARK = Colours("#14161a", "0.92", "0.35", OKABE_ITO[4], OKABE_ITO[1], OKABE_ITO[5])


def plot_tuning(tuning: Tuning, *, dark: bool = False) -> Figure:
    """The Pareto front with best and baseline, what a step of each parameter changes, and the best so far."""
    colours = DARK if dark else LIGHT
    figure = Figure(figsize=(15.4, 5.6), dpi=150, layout="constrained", facecolor=colours.paper)
    grid = figure.subplots(1, 3, width_ratios=[1.15, 1.0, 1.0])
    panels = (("Pareto front", _front), ("Sensitivity", _sensitivity), ("Convergence", _convergence))
    for letter, axes, (heading, draw) in zip("abc", grid, panels):
        draw(axes, tuning, colours)
        _dress(axes, f"({letter}) {heading}", colours)
    title = f"{tuning.objective} of {tuning.arm!r} along {tuning.path!r}"
    wrapped = "\n".join(textwrap.wrap(title, 120, max_lines=2, placeholder=" …"))
    figure.suptitle(wrapped, fontsize=16, color=colours.ink)
    return figure


def _front(axes: Axes, tuning: Tuning, colours: Colours) -> None:
    """All feasible trials, those that none beats, the best and the baseline."""
    trials, front = tuning.trials, tuning.front
    best, baseline = trials[[trials.best()]], trials[:1]
    axes.plot(*_pair(trials[trials.feasible]), ".", color=colours.faint, ms=5, label="tried")
    axes.plot(*_pair(front), "o-", color=colours.line, lw=1.6, ms=4.5, drawstyle="steps-post", label="front")
    axes.plot(*_pair(baseline), "s", color=colours.ink, ms=9, label="baseline")
    axes.plot(*_pair(best), "*", color=colours.best, mec=colours.paper, mew=0.6, ms=19, label="best", zorder=3)
    shown = np.concatenate([_pair(front), _pair(baseline), _pair(best)], axis=1)
    low, high = np.nanmin(shown, axis=1), np.nanmax(shown, axis=1)
    margin = 0.12 * np.where(high > low, high - low, np.abs(high))
    axes.set(xlim=(low[0] - margin[0], high[0] + margin[0]), ylim=(low[1] - margin[1], high[1] + margin[1]))
    axes.set(xlabel="peak velocity [rad/s]", ylabel="peak acceleration [rad/s²]")
    _legend(axes, colours)


def _sensitivity(axes: Axes, tuning: Tuning, colours: Colours) -> None:
    """What one step of each parameter adds to the objective."""
    names = list(tuning.sensitivity)
    for side, colour, label in ((0, colours.line, "−10 % (alpha −0.05)"), (1, colours.other, "+10 % (alpha +0.05)")):
        steps = np.array([tuning.sensitivity[name][side] for name in names])
        where = np.arange(len(names)) + (side - 0.5) * 0.36
        axes.barh(where, np.where(np.isfinite(steps), steps, 0.0), 0.34, color=colour, label=label)
        for y in where[np.isinf(steps)]:
            axes.text(0.0, y, " infeasible", va="center", fontsize=9, color=colours.ink)
    axes.axvline(0.0, color=colours.ink, lw=0.8)
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set_xlabel(f"change of {_label(tuning)}")
    axes.ticklabel_format(axis="x", scilimits=(-2, 3), useMathText=True)
    if names:
        _legend(axes, colours)


def _convergence(axes: Axes, tuning: Tuning, colours: Colours) -> None:
    """The best value so far, over the trials."""
    trials = tuning.trials
    best = np.minimum.accumulate(np.where(trials.feasible, trials.value, np.inf))
    best[np.isinf(best)] = np.nan
    axes.plot(
        np.arange(1, len(best) + 1), best, drawstyle="steps-post", color=colours.line, lw=2.0, label="best so far"
    )
    if np.isfinite(tuning.baseline_value):
        axes.axhline(tuning.baseline_value, color=colours.ink, lw=1.2, ls="--", label="baseline")
    _legend(axes, colours)
    axes.set(xlabel="schemes tried", ylabel=f"least {_label(tuning)}", xlim=(1, max(2, len(best))))


def _legend(axes: Axes, colours: Colours) -> None:
    """Legend in one row below the axes, where nothing is drawn."""
    axes.legend(
        loc="upper center",
        bbox_to_anchor=(0.5, -0.12),
        ncols=len(axes.get_legend_handles_labels()[1]),
        frameon=False,
        fontsize=11,
        columnspacing=1.2,
        handlelength=1.6,
        labelcolor=colours.ink,
    )


def _pair(trials: Trials) -> np.ndarray:
    return np.array([trials.peak_velocity, trials.peak_acceleration])


def _label(tuning: Tuning) -> str:
    return tuning.objective.replace("_", " ") + (f" [{tuning.unit}]" if tuning.unit else "")


def _dress(axes: Axes, heading: str, colours: Colours) -> None:
    """Heading, grid, text sizes and colours."""
    axes.set_title(heading, loc="left", fontsize=13, fontweight="bold", color=colours.ink)
    axes.set_facecolor(colours.paper)
    axes.grid(color=colours.ink, alpha=0.12, lw=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=11, colors=colours.ink)
    for axis in (axes.xaxis, axes.yaxis):
        axis.label.set(size=11.5, color=colours.ink)
        axis.get_offset_text().set(size=10, color=colours.ink)
    axes.spines[:].set_color(colours.ink)
    axes.spines[["top", "right"]].set_visible(False)
