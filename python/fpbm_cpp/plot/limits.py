"""Panels of a motion within joint limits: the task scale, and the joints that were on a bound."""

from math import ceil
from typing import Any

import numpy as np

from ..motion.run import Run
from .lines import over_time
from .theme import LIGHT, LINE, Theme


def scale_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Task scale: the share of the commanded motion that the limits allowed, from 0 to 1."""
    assert run.scale is not None
    axes.plot(run.t, run.scale, color=theme.lines[0], lw=LINE)
    axes.fill_between(run.t, run.scale, color=theme.lines[0], alpha=0.15, lw=0)
    over_time(axes, "task scale")
    axes.set(ylim=(0.0, 1.05), yticks=(0.0, 0.5, 1.0))


def saturation_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """A bar for each time that a joint was on a bound."""
    assert run.saturated is not None
    n = run.arm.dof
    ends = np.append(run.t, run.t[-1:])
    for joint, on, (colour, _) in zip(range(1, n + 1), run.saturated.T, theme.styles()):
        edges = np.flatnonzero(np.diff(on, prepend=False, append=False))
        spans = [(ends[a], ends[b] - ends[a]) for a, b in zip(edges[::2], edges[1::2])]
        axes.broken_barh(spans, (joint - 0.4, 0.8), color=colour, lw=0)
    over_time(axes, "joint")
    axes.set(ylim=(n + 0.6, 0.4), yticks=range(1, n + 1, ceil(n / 8)))
    axes.grid(False, axis="y")
    axes.set_xlim(*(run.t[[0, -1]] if len(run.t) > 1 else (0.0, 1.0)))
