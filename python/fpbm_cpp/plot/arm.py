"""Panel of the arm: postures at equal intervals of time, in the plane or in space, and the tip's path."""

from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import MaxNLocator, MultipleLocator

from .._types import Array
from ..arms import Arm
from ..motion.run import Run
from ..skeleton import joint_points, tip_axes
from .lines import head_legend
from .theme import LIGHT, TEXT, Theme

SNAPSHOTS = 11
ROUND = {"solid_capstyle": "round"}
LINK = {"lw": 1.8, "marker": "o", "ms": 3.8, "mew": 0.5, **ROUND}


def arm_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Postures at equal intervals of time, the tip's path and its target, and the tip's axes at the end.

    An arm in space needs axes made with projection='3d', a planar arm plain ones.
    """
    t, q = (run.t, run.q) if len(run.t) else (np.zeros(1), run.status.q[None])
    time = Normalize(0.0, float(t[-1]) or 1.0)
    shown = np.unique(np.linspace(0, len(t) - 1, SNAPSHOTS).round().astype(int))
    for i, points in zip(shown, joint_points(run.arm, q[shown])):
        axes.plot(*points.T, color=theme.fade(time(t[i])), mec=theme.paper, **LINK)
    draw_base(axes, run.arm, q[-1], theme)
    tip = axes.plot(*run.positions.T, color=theme.tip, lw=2.4, label="tip")
    target = draw_target(axes, run, theme)
    last = joint_points(run.arm, q[-1])
    length = 0.12 * np.ptp(last, axis=0).max()
    for axis, colour in zip(tip_axes(run.arm, q[-1]).T, theme.axes):
        axes.plot(*np.stack([last[-1], last[-1] + length * axis]).T, color=colour, lw=1.6, zorder=3, **ROUND)
    frame_arm(axes, theme)
    pad = 0.13 if axes.name == "3d" else 0.02
    times = ScalarMappable(time, theme.fade)
    bar = axes.figure.colorbar(times, ax=axes, location="bottom", aspect=45, fraction=0.06, pad=pad)
    bar.set_label("time of the posture [s]", size=TEXT, color=theme.ink, labelpad=2.0)
    bar.ax.tick_params(labelsize=TEXT, colors=theme.ink, length=2.5, pad=2.5)
    bar.outline.set(edgecolor=theme.ink, linewidth=0.7)
    head_legend(axes, theme, [*tip, *target])


def draw_base(axes: Any, arm: Arm, q: Array, theme: Theme) -> None:
    """Draw the arm's base: a square in the plane, a circle in space."""
    if axes.name != "3d":
        axes.plot(0.0, 0.0, "s", color=theme.soft, ms=8, zorder=4)
        axes.plot(0.0, 0.0, "o", color=theme.paper, ms=3, zorder=4)
        return
    radius = 0.06 * np.ptp(joint_points(arm, q), axis=0).max()
    angle = np.linspace(0.0, 2 * np.pi, 33)
    axes.plot(radius * np.cos(angle), radius * np.sin(angle), 0.0 * angle, color=theme.soft, lw=1.6)


def draw_target(axes: Any, run: Run, theme: Theme) -> list[Any]:
    return list(axes.plot(*run.reference_positions.T, color=theme.ink, lw=0.9, ls=(0, (2, 2)), label="target"))


def frame_arm(axes: Any, theme: Theme) -> None:
    """Give all axes one scale and one distance between ticks, once all is drawn."""
    space = axes.name == "3d"
    ends = np.array([axes.get_xlim(), axes.get_ylim(), *([axes.get_zlim()] if space else [])])
    reach = np.ptp(ends, axis=1)
    step = MaxNLocator(5, steps=[1, 2, 5, 10]).tick_values(0.0, reach.max())[1]
    every = [axes.xaxis, axes.yaxis, *([axes.zaxis] if space else [])]
    for name, axis in zip("xyz", every):
        axis.set_major_locator(MultipleLocator(step))
        axis.set_label_text(f"{name} [m]", size=TEXT, color=theme.ink)
    if not space:
        axes.set_aspect("equal", adjustable="datalim")
        return
    reach = np.maximum(reach, reach.max() / 2)
    lower, upper = ends.mean(axis=1) + np.multiply.outer([-0.5, 0.5], reach)
    axes.set(xlim=(lower[0], upper[0]), ylim=(lower[1], upper[1]), zlim=(lower[2], upper[2]))
    axes.set_box_aspect(tuple(reach), zoom=1.2)
    axes.set_anchor("W")
    axes.view_init(elev=20, azim=-55)
    axes.tick_params(pad=-3.0)
    for axis, least, most in zip(every, lower + 0.08 * reach, upper - 0.08 * reach):
        axis.set_ticks(step * np.arange(np.ceil(least / step), np.floor(most / step) + 1))  # No tick in a corner.
        axis.set_pane_color(theme.pane)
        axis.line.set_color(theme.ink)
        axis._axinfo["grid"].update(color=theme.grid, linewidth=0.6)  # Axes in space offer no other way.
        axis.labelpad = -5.0
