"""Figure of several motions on one job."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from .joints import unit_of
from .legends import foot_legend, foot_rows
from .lines import envelope, from_zero, in_decades, label_time_below, over_time
from .theme import DPI, PAGE, TEXT, Theme, dress, theme_of

if TYPE_CHECKING:
    from .._types import Array
    from ..run import Run

ROW, FOOT_ROW, TITLE_ROW = 1.75, 0.19, 0.2  # [in]


def compare(runs: Sequence[Run] | Mapping[str, Run], title: str = "", *, dark: bool = False) -> Figure:
    """Figure of several schemes on one job, one line each.

    Joint velocities, joint accelerations, tip error and manipulability over time; where the tip has a pose to keep, its
    orientation error and how far the joints are from where they began, too.

    Parameters
    ----------
    runs : sequence of Run, or mapping of str to Run
        The motions, named after their schemes unless names are given.
    title : str
        Heading of the figure.
    dark : bool
        On black instead of white.

    Raises
    ------
    ValueError
        Where there is no run.
    """
    named = dict(runs) if isinstance(runs, Mapping) else _named(runs)
    if not named:
        raise ValueError("runs: must hold one at least")
    theme = theme_of(dark)
    panels = COMPARISON_OF_POSES if any(run.task == "pose" for run in named.values()) else COMPARISON
    rows = len(panels) // 2
    head, body, foot = TITLE_ROW if title else 0.0, ROW * rows, FOOT_ROW * foot_rows(list(named), PAGE)
    figure = Figure((PAGE, head + body + foot), dpi=DPI, layout="constrained", facecolor=theme.paper)
    figure.suptitle(title, fontsize=TEXT + 1, color=theme.ink)
    upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=[body, foot])[:, 0]
    grid = upper.subplots(rows, 2)
    for letter, axes, (heading, draw) in zip("abcdef", grid.T.flat, panels):
        dress(axes, theme, f"({letter}) {heading}")
        draw(axes, theme, list(named.values()))
    for column in grid.T:
        label_time_below(list(column))
    foot_legend(lower, theme, [grid[0, 0]], PAGE, list(named))
    return figure


def _velocities(axes: Any, theme: Theme, runs: Sequence[Run]) -> None:
    _norms(axes, theme, runs, [run.qd for run in runs], rf"$\|\dot q\|$ [{unit_of(runs, '/s')}]")


def _accelerations(axes: Any, theme: Theme, runs: Sequence[Run]) -> None:
    _norms(axes, theme, runs, [run.qdd for run in runs], rf"$\|\ddot q\|$ [{unit_of(runs, '/s²')}]")


def _postures(axes: Any, theme: Theme, runs: Sequence[Run]) -> None:
    _norms(axes, theme, runs, [run.q - run.q[:1] for run in runs], rf"$\|q - q(0)\|$ [{unit_of(runs, '')}]")


def _manipulabilities(axes: Any, theme: Theme, runs: Sequence[Run]) -> None:
    _norms(axes, theme, runs, [run.manipulability()[:, None] for run in runs], "√det(JJᵀ)")


def _errors(axes: Any, theme: Theme, runs: Sequence[Run]) -> None:
    rows = [run.error[:, : run.positions.shape[1]] for run in runs]
    _norms(axes, theme, runs, rows, r"$\|e\|$ [m]", log=True)


def _turn_errors(axes: Any, theme: Theme, runs: Sequence[Run]) -> None:
    rows = [run.error[:, run.positions.shape[1] :] for run in runs]
    _norms(axes, theme, runs, rows, r"$\|e\|$ [rad]", log=True)


COMPARISON: tuple[tuple[str, Callable[[Any, Theme, Sequence[Run]], None]], ...] = (
    ("Joint velocities", _velocities),
    ("Joint accelerations", _accelerations),
    ("Tip error", _errors),
    ("Manipulability", _manipulabilities),
)
COMPARISON_OF_POSES = (
    *COMPARISON[:2],
    ("Distance from the first posture", _postures),
    ("Position error", _errors),
    ("Orientation error", _turn_errors),
    COMPARISON[3],
)


def _norms(
    axes: Any, theme: Theme, runs: Sequence[Run], values: Sequence[Array], label: str, log: bool = False
) -> None:
    """One line over time for the norm of each run's rows."""
    # From wide to narrow, so that lines which coincide show side by side.
    for run, rows, (colour, dash), width in zip(runs, values, theme.styles(), np.linspace(3.0, 1.4, len(runs))):
        t, norms = run.t, np.linalg.norm(rows, axis=1)
        axes.plot(*(envelope(t, norms) if log else (t, norms)), color=colour, ls=dash, lw=width)
    over_time(axes, label)
    in_decades(axes) if log else from_zero(axes)


def _named(runs: Sequence[Run]) -> dict[str, Run]:
    """Runs by the names of their schemes, numbered where several have one name."""
    names = [type(run.scheme).__name__ for run in runs]
    return {
        name if names.count(name) == 1 else f"{name} {names[: i + 1].count(name)}": run
        for i, (name, run) in enumerate(zip(names, runs))
    }
