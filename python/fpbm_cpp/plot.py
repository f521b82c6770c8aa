"""Figures of motions: one motion's arm, tip error and joint rates, as panels and composed; or several schemes compared.

Nothing here touches matplotlib.pyplot: figures are objects without global state, made as well without a display or in
several threads. Show one with IPython's display(run.plot()) or write it with run.plot().savefig("run.png").
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np

from .serial_arm import SerialArm
from .skeleton import joint_points

try:
    from matplotlib import colormaps
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, Normalize
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator, MultipleLocator
except ModuleNotFoundError as missing:
    raise ImportError('plotting needs matplotlib: pip install "fpbm_cpp[plot]"') from missing

if TYPE_CHECKING:
    from ._core import Arm
    from ._types import Array
    from .run import Run

# Okabe and Ito's colours, told apart by colour-blind readers; the second eight lines are dashed, and so on.
OKABE_ITO = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#000000", "#F0E442")
DASHES = ("-", "--", ":", "-.")
TIP, TARGET = "#D55E00", "#000000"
FADE = LinearSegmentedColormap.from_list("fade", colormaps["Blues"](np.linspace(0.25, 1.0, 64)))
SNAPSHOTS = 11
COLUMNS = 6  # Names in a row of a comparison's legend.
SPANS = 400


def arm_panel(axes: Any, run: Run) -> None:
    """Postures at equal intervals of time, fading into the past, with the tip's path on its target."""
    t, q = (run.t, run.q) if len(run.t) else (np.zeros(1), run.status.q[None])
    space = axes.name == "3d"
    time = Normalize(0.0, float(t[-1]) or 1.0)
    shown = np.unique(np.linspace(0, len(t) - 1, SNAPSHOTS).round().astype(int))
    for i, points in zip(shown, joint_points(run.arm, q[shown])):
        style = {"lw": 2.4, "ms": 5, "mec": "white", "mew": 0.6, "solid_capstyle": "round"}
        axes.plot(*points.T, "o-", color=FADE(time(t[i])), **style)
    axes.plot(*run.positions.T, color=TIP, lw=3, label="tip")
    axes.plot(*run.reference_positions.T, color=TARGET, lw=1.2, ls=(0, (2, 2)), label="target")
    axes.plot(*np.zeros((run.positions.shape[1], 1)), "s", color="0.25", ms=11, zorder=0)
    axes.set(xlabel="x [m]", ylabel="y [m]")
    if space:
        _in_space(axes)
    else:
        axes.set_aspect("equal", adjustable="datalim")
    bar = axes.figure.colorbar(ScalarMappable(time, FADE), ax=axes, location="bottom", aspect=40)
    bar.set_label("time of the posture [s]", size=11.5)
    bar.ax.tick_params(labelsize=11)
    corner, right, columns = ("upper right", 1.08, 1) if space else ("lower right", 1.0, 2)
    axes.legend(loc=corner, bbox_to_anchor=(right, 1.0), borderaxespad=0.1, frameon=False, fontsize=11, ncols=columns)


def error_panel(axes: Axes, run: Run) -> None:
    """Tip error per axis, in the power of ten that suits it."""
    linear = run.error[:, : run.positions.shape[1]]
    _error_lines(axes, run, linear, [f"{axis} axis" for axis in "xyz"], "m")


def turn_error_panel(axes: Axes, run: Run) -> None:
    """Error of the tip's orientation, about each axis, in the power of ten that suits it."""
    angular = run.error[:, run.positions.shape[1] :]
    names = ["angle"] if angular.shape[1] == 1 else [f"about {axis}" for axis in "xyz"]
    _error_lines(axes, run, angular, names, "rad")


def velocity_panel(axes: Axes, run: Run) -> None:
    """Joint velocities."""
    _joint_lines(axes, run, run.qd, "velocity", "/s")


def acceleration_panel(axes: Axes, run: Run) -> None:
    """Joint accelerations."""
    _joint_lines(axes, run, run.qdd, "acceleration", "/s²")


def manipulability_panel(axes: Axes, run: Run) -> None:
    """How far the posture is from a singular one."""
    axes.plot(run.t, run.manipulability(), color=OKABE_ITO[0], lw=1.7)
    axes.set(xlabel="time [s]", ylabel="√det(JJᵀ)")
    axes.margins(x=0.0)
    axes.set_ylim(0.0, 1.05 * axes.get_ylim()[1])
    axes.locator_params(axis="y", nbins=4)


Panel = tuple[str, Callable[[Any, "Run"], None]]
ARM: Panel = ("Arm and tip path", arm_panel)
ERROR: Panel = ("Tip error", error_panel)
TURN_ERROR: Panel = ("Orientation error", turn_error_panel)
RATES: tuple[Panel, ...] = (("Joint velocities", velocity_panel), ("Joint accelerations", acceleration_panel))
MANIPULABILITY: Panel = ("Manipulability", manipulability_panel)


def compose(run: Run, title: str, panels: int | None = None) -> Figure:
    """Figure of a run: the arm on the left, its quantities over time on the right; all panels or the first few.

    A pose has its orientation error besides, and an arm in space its manipulability.
    """
    flat = run.positions.shape[1] == 2
    on_left = (ARM,) if flat else (ARM, MANIPULABILITY)
    on_right = (ERROR, *((TURN_ERROR,) if run.task == "pose" else ()), *RATES)[: panels and panels - len(on_left)]
    figure = Figure(figsize=(12.8, max(7.2, 2.4 * len(on_right))), dpi=150, layout="constrained")
    left, right = figure.subfigures(1, 2, squeeze=False, width_ratios=[1.0, 1.15])[0]
    if flat:
        grid = [left.subplots()]
    else:
        cells = left.add_gridspec(2, 1, height_ratios=[4.0, 1.0])
        grid = [left.add_subplot(cells[0], projection="3d"), left.add_subplot(cells[1])]
    grid += list(right.subplots(len(on_right), 1))
    for name, axes, (heading, draw) in zip("abcdef", grid, on_left + on_right):
        draw(axes, run)
        _dress(axes, f"({name}) {heading}")
    figure.suptitle(title, fontsize=16)
    return figure


def plot_run(run: Run) -> Figure:
    """Figure of a whole run, as far as it went.

    Arm postures with tip path and target, tip error per axis [m] and [rad], joint velocities and accelerations.
    """
    title = f"{run.scheme!r} along {run.path!r}" + ("" if run.status else f", stopped after t = {run.status.time:g} s")
    title = re.sub(r"\d+\.\d{5,}", lambda number: f"{float(number[0]):.4g}", title)
    return compose(run, "\n".join(textwrap.wrap(title, 105, max_lines=3, placeholder=" …")))


def compare(runs: Sequence[Run] | Mapping[str, Run], title: str = "") -> Figure:
    """Figure of several schemes on one job, one line each.

    Joint velocities, joint accelerations, tip error and manipulability over time; where the tip has a pose to keep, its
    orientation error and how far the joints are from where they began, too.

    Parameters
    ----------
    runs : sequence of Run, or mapping of str to Run
        The motions, named after their schemes unless names are given.
    title : str
        Heading of the figure.

    Raises
    ------
    ValueError
        Where there is no run.
    """
    named = dict(runs) if isinstance(runs, Mapping) else _named(runs)
    if not named:
        raise ValueError("runs: must hold one at least")
    poses = any(run.task == "pose" for run in named.values())
    figure = Figure(figsize=(15.4 if poses else 12.8, 7.2), dpi=150, layout="constrained")
    top, below = figure.subfigures(2, 1, squeeze=False, height_ratios=[1 + (len(named) - 1) // COLUMNS, 16])[:, 0]
    grid = below.subplots(2, 3 if poses else 2).flat
    for name, axes, (heading, draw) in zip("abcdef", grid, COMPARISON_OF_POSES if poses else COMPARISON):
        draw(axes, list(named.values()))
        _dress(axes, f"({name}) {heading}")
    top.legend(axes.get_lines(), list(named), loc="center", frameon=False, fontsize=12.5, ncols=COLUMNS)
    figure.suptitle(title, fontsize=16)
    return figure


def _compare_velocities(axes: Axes, runs: Sequence[Run]) -> None:
    _compared(axes, runs, [run.qd for run in runs], rf"$\|\dot q\|$ [{_unit(runs, '/s')}]")


def _compare_accelerations(axes: Axes, runs: Sequence[Run]) -> None:
    _compared(axes, runs, [run.qdd for run in runs], rf"$\|\ddot q\|$ [{_unit(runs, '/s²')}]")


def _compare_postures(axes: Axes, runs: Sequence[Run]) -> None:
    _compared(axes, runs, [run.q - run.q[:1] for run in runs], rf"$\|q - q(0)\|$ [{_unit(runs, '')}]")


def _compare_manipulabilities(axes: Axes, runs: Sequence[Run]) -> None:
    _compared(axes, runs, [run.manipulability()[:, None] for run in runs], "√det(JJᵀ)")


def _compare_errors(axes: Axes, runs: Sequence[Run]) -> None:
    _compared(axes, runs, [run.error[:, : run.positions.shape[1]] for run in runs], "tip error [m]", log=True)


def _compare_turn_errors(axes: Axes, runs: Sequence[Run]) -> None:
    _compared(axes, runs, [run.error[:, run.positions.shape[1] :] for run in runs], "tip error [rad]", log=True)


COMPARISON: tuple[tuple[str, Callable[[Axes, Sequence[Run]], None]], ...] = (
    ("Joint velocities", _compare_velocities),
    ("Joint accelerations", _compare_accelerations),
    ("Tip error", _compare_errors),
    ("Manipulability", _compare_manipulabilities),
)
COMPARISON_OF_POSES = (
    *COMPARISON[:2],
    ("Distance from the first posture", _compare_postures),
    ("Position error", _compare_errors),
    ("Orientation error", _compare_turn_errors),
    COMPARISON[3],
)


def _compared(axes: Axes, runs: Sequence[Run], values: Sequence[Array], label: str, log: bool = False) -> None:
    """One line over time for the norm of each run's rows."""
    # From wide to narrow, so that lines which coincide show side by side.
    for run, rows, (colour, dash), width in zip(runs, values, _styles(), np.linspace(4.2, 2.0, len(runs))):
        t, norms = run.t, np.linalg.norm(rows, axis=1)
        if log:
            t, norms = _envelope(t, np.maximum(norms, np.finfo(float).eps))
        axes.plot(t, norms, color=colour, ls=dash, lw=width)
    axes.set_yscale("log" if log else "linear")
    if not log:
        axes.set_ylim(0.0, 1.05 * axes.get_ylim()[1])
        axes.locator_params(axis="y", nbins=5)
    axes.set(xlabel="time [s]", ylabel=label)
    axes.margins(x=0.0)


def _envelope(t: Array, values: Array) -> tuple[Array, Array]:
    """The largest value in each of SPANS spans of time: the course of an error without the noise of its round-off."""
    if len(t) <= SPANS:
        return t, values
    first = np.linspace(0, len(t), SPANS, endpoint=False).astype(int)
    return np.linspace(t[0], t[-1], SPANS), np.maximum.reduceat(values, first)


def _named(runs: Sequence[Run]) -> dict[str, Run]:
    """Runs by the names of their schemes, numbered where several have one name."""
    names = [type(run.scheme).__name__ for run in runs]
    return {
        name if names.count(name) == 1 else f"{name} {names[: i + 1].count(name)}": run
        for i, (name, run) in enumerate(zip(names, runs))
    }


def _in_space(axes: Any) -> None:
    """Axes of an arm in space: alike in all directions, light, seen from above and aside."""
    limits = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    reach = np.ptp(limits, axis=1)
    reach = np.maximum(reach, reach.max() / 2)
    lower, upper = limits.mean(axis=1) + np.multiply.outer([-0.5, 0.5], reach)
    axes.set(xlim=(lower[0], upper[0]), ylim=(lower[1], upper[1]), zlim=(lower[2], upper[2]), zlabel="z [m]")
    axes.set_box_aspect(tuple(reach))
    axes.view_init(elev=20, azim=-55)
    step = MaxNLocator(6, steps=[1, 2, 5, 10]).tick_values(0.0, reach.max())[1]
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_pane_color((0.97, 0.97, 0.97))
        axis.set_major_locator(MultipleLocator(step))
    axes.zaxis.label.set_size(11.5)


def _dress(axes: Any, heading: str) -> None:
    """Heading, grid and text sizes."""
    axes.set_title(heading, loc="left", fontsize=13, fontweight="bold")
    axes.grid(color="0.9", lw=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=11)
    axes.xaxis.label.set_size(11.5)
    axes.yaxis.label.set_size(11.5)
    axes.spines[["top", "right"]].set_visible(False)


def _error_lines(axes: Axes, run: Run, error: Array, names: Sequence[str], unit: str) -> None:
    """Tip error in the power of ten that suits it."""
    largest = float(np.abs(error).max(initial=0.0))
    exponent = int(np.floor(np.log10(largest))) if largest > 0.0 else 0
    scale = f"[$10^{{{exponent}}}$ {unit}]" if exponent else f"[{unit}]"
    _lines(axes, run, error / 10.0**exponent, names, f"tip error {scale}")


def _joint_lines(axes: Axes, run: Run, values: Array, quantity: str, per: str) -> None:
    """One line for each joint; units stand by the names where joints turn and slide."""
    units = _units(run.arm)
    arm = run.arm
    names = arm.joint_names if isinstance(arm, SerialArm) else [f"joint {i}" for i in range(1, arm.dof + 1)]
    if len(set(units)) > 1:
        names = [name if unit == "rad" else f"{name} [{unit}{per}]" for name, unit in zip(names, units)]
    _lines(axes, run, values, names, f"{quantity} [{_unit([run], per)}]")


def _lines(axes: Axes, run: Run, values: Array, names: Sequence[str], label: str) -> None:
    """One line over time for each column."""
    for column, name, (colour, dash) in zip(values.T, names, _styles()):
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


def _styles() -> Iterator[tuple[str, str]]:
    """Colours and dashes, in an order without end."""
    return ((colour, dash) for dash in cycle(DASHES) for colour in OKABE_ITO)


def _units(arm: Arm) -> list[str]:
    """What each joint's position is measured in."""
    if not isinstance(arm, SerialArm):
        return ["rad"] * arm.dof
    return ["m" if joint.type == "prismatic" else "rad" for joint in arm.joints if joint.mimic is None]


def _unit(runs: Sequence[Run], per: str) -> str:
    """Unit of all joints, or both."""
    units = sorted({unit for run in runs for unit in _units(run.arm)}, reverse=True)
    return ", ".join(unit + per for unit in units)
