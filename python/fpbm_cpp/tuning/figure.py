"""Figure of a tuning: Pareto front, sensitivity and convergence."""

import textwrap
from typing import Any

import numpy as np

from .._types import Array
from ..plot.theme import DARK, LIGHT, OKABE_ITO, Theme, dress, sheet

# Without matplotlib, the line before raises ImportError with the extra to install.
from matplotlib.figure import Figure  # isort: skip

SIZE = 12.6, 4.25  # [in]
BEST = OKABE_ITO[5]


def plot_tuning(tuning: Any, *, dark: bool = False) -> Figure:
    """The Pareto front with best and baseline, the change of the objective per step, and the best value so far."""
    theme = DARK if dark else LIGHT
    title = f"{tuning.objective} of {tuning.arm} along {tuning.path!r}"
    wrapped = "\n".join(textwrap.wrap(title, 120, max_lines=2, placeholder=" …"))
    figure, (part,) = sheet(SIZE[0], [SIZE[1]], wrapped, theme)
    panels = (("Pareto front", _front), ("Sensitivity", _sensitivity), ("Convergence", _convergence))
    for letter, axes, (heading, draw) in zip("abc", part.subplots(1, 3, width_ratios=[1.15, 1.0, 1.0]), panels):
        dress(axes, theme, f"({letter}) {heading}")
        draw(axes, tuning, theme)
    return figure


def _front(axes: Any, tuning: Any, theme: Theme) -> None:
    trials, front = tuning.trials, tuning.front
    best, baseline = trials[[trials.best()]], trials[:1]
    axes.plot(*_pair(trials[trials.feasible]), ".", color=theme.soft, alpha=0.6, mew=0, ms=5, label="tried")
    axes.plot(*_pair(front), "o-", color=theme.lines[0], lw=1.4, ms=4, drawstyle="steps-post", label="front")
    axes.plot(*_pair(baseline), "s", color=theme.ink, ms=7, label="baseline")
    axes.plot(*_pair(best), "*", color=BEST, mec=theme.paper, mew=0.6, ms=15, label="best", zorder=3)
    shown = np.concatenate([_pair(front), _pair(baseline), _pair(best)], axis=1)
    low, high = np.nanmin(shown, axis=1), np.nanmax(shown, axis=1)
    margin = 0.12 * np.where(high > low, high - low, np.abs(high))
    axes.set(xlim=(low[0] - margin[0], high[0] + margin[0]), ylim=(low[1] - margin[1], high[1] + margin[1]))
    axes.set(xlabel="peak velocity [rad/s]", ylabel="peak acceleration [rad/s²]")
    _legend(axes, theme)


def _sensitivity(axes: Any, tuning: Any, theme: Theme) -> None:
    names = list(tuning.sensitivity)
    for side, label in ((0, "−10 % (alpha −0.05)"), (1, "+10 % (alpha +0.05)")):
        steps = np.array([tuning.sensitivity[name][side] for name in names])
        where = np.arange(len(names)) + (side - 0.5) * 0.36
        axes.barh(where, np.where(np.isfinite(steps), steps, 0.0), 0.34, color=theme.lines[side], label=label)
        for y in where[np.isinf(steps)]:
            axes.text(0.0, y, " infeasible", va="center", fontsize=9, color=theme.ink)
    axes.axvline(0.0, color=theme.ink, lw=0.8)
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set_xlabel(f"change of {_label(tuning)}")
    axes.ticklabel_format(axis="x", scilimits=(-2, 3), useMathText=True)
    if names:
        _legend(axes, theme)


def _convergence(axes: Any, tuning: Any, theme: Theme) -> None:
    best = np.fmin.accumulate(tuning.trials.scores())
    axes.plot(np.arange(1, len(best) + 1), best, drawstyle="steps-post", color=theme.lines[0], label="best so far")
    if np.isfinite(tuning.baseline_value):
        axes.axhline(tuning.baseline_value, color=theme.ink, lw=1.0, ls="--", label="baseline")
    _legend(axes, theme)
    axes.set(xlabel="schemes tried", ylabel=f"least {_label(tuning)}", xlim=(1, max(2, len(best))))


def _legend(axes: Any, theme: Theme) -> None:
    """Legend in one row below the axes."""
    columns = len(axes.get_legend_handles_labels()[1])
    place = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.12), "ncols": columns, "frameon": False}
    axes.legend(**place, fontsize=9, columnspacing=1.2, handlelength=1.6, labelcolor=theme.ink)


def _pair(trials: Any) -> Array:
    return np.array([trials.peak_velocity, trials.peak_acceleration])


def _label(tuning: Any) -> str:
    unit = f" [{tuning.unit}]" if tuning.unit else ""
    return f"{tuning.objective.replace('_', ' ')}{unit}"
