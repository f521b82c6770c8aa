"""Figures of a motion: the arm, its tip error, joint velocities and accelerations, as panels and composed.

Nothing here touches matplotlib.pyplot: figures are objects without global state, made as well without a display or in
several threads. Show one with IPython's display(run.plot()) or write it with run.plot().savefig("run.png").
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

try:
    from matplotlib import colormaps
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, Normalize
    from matplotlib.figure import Figure
except ModuleNotFoundError as missing:
    raise ImportError('plotting needs matplotlib: pip install "fpbm_cpp[plot]"') from missing

if TYPE_CHECKING:
    from ._core import PlanarArm
    from .run import Array, Run

# Okabe and Ito's colours, told apart by colour-blind readers; the second eight joints are dashed, and so on.
OKABE_ITO = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#000000", "#F0E442")
DASHES = ("-", "--", ":", "-.")
TIP, TARGET = "#D55E00", "#000000"
FADE = LinearSegmentedColormap.from_list("fade", colormaps["Blues"](np.linspace(0.25, 1.0, 64)))
SNAPSHOTS = 11


def joint_points(arm: PlanarArm, q: Array) -> Array:
    """Base, joints and tip [m], shape (..., n + 1, 2), of postures q [rad], shape (..., n)."""
    heading = np.cumsum(q, axis=-1)
    links = arm.lengths[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    return np.cumsum(np.concatenate([np.zeros_like(links[..., :1, :]), links], axis=-2), axis=-2)


def arm_panel(axes: Axes, run: Run) -> None:
    """Postures at equal intervals of time, fading into the past, with the tip's path on its target."""
    t, q = (run.t, run.q) if len(run.t) else (np.zeros(1), run.status.q[None])
    time = Normalize(0.0, float(t[-1]) or 1.0)
    for i in np.unique(np.linspace(0, len(t) - 1, SNAPSHOTS).round().astype(int)):
        x, y = joint_points(run.arm, q[i]).T
        axes.plot(x, y, "o-", color=FADE(time(t[i])), lw=2.4, ms=5, mec="white", mew=0.6, solid_capstyle="round")
    axes.plot(*run.x.T, color=TIP, lw=3, label="tip")
    axes.plot(*run.x_ref.T, color=TARGET, lw=1.2, ls=(0, (2, 2)), label="target")
    axes.plot(0, 0, "s", color="0.25", ms=11, zorder=0)
    axes.set(xlabel="x [m]", ylabel="y [m]")
    axes.set_aspect("equal", adjustable="datalim")
    bar = axes.figure.colorbar(ScalarMappable(time, FADE), ax=axes, location="bottom", aspect=40)
    bar.set_label("time of the posture [s]", size=11.5)
    bar.ax.tick_params(labelsize=11)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, frameon=False, fontsize=11, ncols=2)


def error_panel(axes: Axes, run: Run) -> None:
    """Tip error per axis, in the power of ten that suits it."""
    largest = float(np.abs(run.error).max(initial=0.0))
    exponent = int(np.floor(np.log10(largest))) if largest > 0.0 else 0
    unit = f"[$10^{{{exponent}}}$ m]" if exponent else "[m]"
    _lines(axes, run, run.error / 10.0**exponent, [f"{axis} axis" for axis in "xyz"], f"tip error {unit}")


def velocity_panel(axes: Axes, run: Run) -> None:
    """Joint velocities."""
    _lines(axes, run, run.qd, _joints(run), "velocity [rad/s]")


def acceleration_panel(axes: Axes, run: Run) -> None:
    """Joint accelerations."""
    _lines(axes, run, run.qdd, _joints(run), "acceleration [rad/s²]")


PANELS: tuple[tuple[str, Callable[[Axes, Run], None]], ...] = (
    ("Arm and tip path", arm_panel),
    ("Tip error", error_panel),
    ("Joint velocities", velocity_panel),
    ("Joint accelerations", acceleration_panel),
)


def compose(run: Run, title: str, panels: int = 4) -> Figure:
    """Figure of the first 3 or 4 panels: the arm on the left, its quantities over time on the right."""
    figure = Figure(figsize=(12.8, 7.2), dpi=150, layout="constrained")
    left, right = figure.subfigures(1, 2, squeeze=False, width_ratios=[1.0, 1.15])[0]
    grid = [left.subplots(), *right.subplots(panels - 1, 1)]
    for name, axes, (heading, draw) in zip("abcd", grid, PANELS):
        draw(axes, run)
        axes.set_title(f"({name}) {heading}", loc="left", fontsize=13, fontweight="bold")
        axes.grid(color="0.9", lw=0.6)
        axes.set_axisbelow(True)
        axes.tick_params(labelsize=11)
        axes.xaxis.label.set_size(11.5)
        axes.yaxis.label.set_size(11.5)
        axes.spines[["top", "right"]].set_visible(False)
    figure.suptitle(title, fontsize=16)
    return figure


def plot_run(run: Run) -> Figure:
    """Figure of a whole run, as far as it went.

    Arm postures with tip path and target, tip error per axis [m], joint velocities [rad/s] and accelerations [rad/s^2].
    """
    title = f"{run.scheme!r} along {run.path!r}" + ("" if run.status else f", stopped after t = {run.status.time:g} s")
    return compose(run, "\n".join(textwrap.wrap(title, 105, max_lines=3, placeholder=" …")))


def _lines(axes: Axes, run: Run, values: Array, names: Sequence[str], label: str) -> None:
    """One line over time for each column."""
    styles = ((colour, dash) for dash in cycle(DASHES) for colour in OKABE_ITO)
    for column, name, (colour, dash) in zip(values.T, names, styles):
        axes.plot(run.t, column, color=colour, ls=dash, lw=1.7, label=name)
    axes.set(xlabel="time [s]", ylabel=label)
    axes.margins(x=0.0)
    axes.locator_params(axis="y", nbins=5)
    _legend(axes)


def _legend(axes: Axes) -> None:
    """Legend outside the axes, right of them; small where there is much to name."""
    names = len(axes.get_lines())
    axes.legend(
        loc="upper left",
        bbox_to_anchor=(1.02, 1.0),
        borderaxespad=0.0,
        frameon=False,
        fontsize=11 if names < 8 else 8,
        ncols=1 + (names - 1) // 8,
        handlelength=1.4,
        columnspacing=0.8,
    )


def _joints(run: Run) -> list[str]:
    return [f"joint {i}" for i in range(1, run.arm.dof + 1)]
