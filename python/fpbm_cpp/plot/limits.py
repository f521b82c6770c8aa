"""Panels of a motion that was kept within limits: how much of the task they left, and which joints met a bound."""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np

from .lines import over_time
from .theme import LIGHT, LINE, Theme

if TYPE_CHECKING:
    from ..run import Run


def scale_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """How much of the task the limits left, from 0 to 1."""
    assert run.scale is not None
    axes.plot(run.t, run.scale, color=theme.lines[0], lw=LINE)
    axes.fill_between(run.t, run.scale, color=theme.lines[0], alpha=0.15, lw=0)
    over_time(axes, "task scale")
    axes.set(ylim=(0.0, 1.05), yticks=(0.0, 0.5, 1.0))


def saturation_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """When each joint was on a bound, as bars."""
    assert run.saturated is not None
    n = run.arm.dof
    ends = np.append(run.t, run.t[-1:])
    for joint, on, (colour, _) in zip(range(1, n + 1), run.saturated.T, theme.styles()):
        turns = np.flatnonzero(np.diff(on, prepend=False, append=False))
        spans = [(ends[a], ends[b] - ends[a]) for a, b in zip(turns[::2], turns[1::2])]
        axes.broken_barh(spans, (joint - 0.4, 0.8), color=colour, lw=0)
    over_time(axes, "joint")
    axes.set(ylim=(n + 0.6, 0.4), yticks=range(1, n + 1, ceil(n / 8)))
    axes.grid(False, axis="y")
    axes.set_xlim(*(run.t[[0, -1]] if len(run.t) > 1 else (0.0, 1.0)))
