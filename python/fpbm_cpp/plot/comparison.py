"""Figure of several motions, with one line for each."""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from .._types import Array
from ..motion.run import Run
from .joints import unit_of
from .legends import foot_height, foot_legend
from .lines import envelope, from_zero, in_decades, label_time_below, over_time
from .theme import PAGE, dress, sheet, theme_of

ROW = 1.75  # [in]


class Quantity(NamedTuple):
    """What a panel shows: the norm of each row of an array of the run."""

    heading: str
    rows: Callable[[Run], Array]
    symbol: str
    per: str | None = None  # A quantity of the joints, whose unit is the joints' and this.
    log: bool = False


VELOCITIES = Quantity("Joint velocities", lambda run: run.qd, r"$\|\dot q\|$", "/s")
ACCELERATIONS = Quantity("Joint accelerations", lambda run: run.qdd, r"$\|\ddot q\|$", "/s²")
MANIPULABILITY = Quantity("Manipulability", lambda run: run.manipulability()[:, None], "√det(JJᵀ)")
TIP_ERROR = Quantity("Tip error", lambda run: run.position_error, r"$\|e\|$ [m]", log=True)
POSITION_TASK = (VELOCITIES, ACCELERATIONS, TIP_ERROR, MANIPULABILITY)
POSE_TASK = (
    VELOCITIES,
    ACCELERATIONS,
    Quantity("Distance from the first posture", lambda run: run.q - run.q[:1], r"$\|q - q(0)\|$", ""),
    TIP_ERROR._replace(heading="Position error"),
    Quantity("Orientation error", lambda run: run.orientation_error, r"$\|e\|$ [rad]", log=True),
    MANIPULABILITY,
)


def compare(runs: Sequence[Run] | Mapping[str, Run], title: str = "", *, dark: bool = False) -> Figure:
    """Figure of several runs, with one line for each.

    Its panels show joint velocities, joint accelerations, tip error and manipulability over time; where the task is a
    pose, also the orientation error and the distance of the joints from where they began. Raises ValueError if there is
    no run.

    Parameters
    ----------
    runs : sequence of Run, or mapping of str to Run
        The motions; without names they are named after their schemes.
    title : str
        Title of the figure.
    dark : bool
        Dark background.
    """
    named = dict(runs) if isinstance(runs, Mapping) else _named(runs)
    if not named:
        raise ValueError("runs: must hold at least one run")
    theme, shown = theme_of(dark), list(named.values())
    quantities = POSE_TASK if any(run.task == "pose" for run in shown) else POSITION_TASK
    rows = len(quantities) // 2
    figure, (upper, lower) = sheet(PAGE, [ROW * rows, foot_height(list(named), PAGE)], title, theme)
    grid = upper.subplots(rows, 2)
    for letter, axes, (heading, rows_of, symbol, per, log) in zip("abcdef", grid.T.flat, quantities):
        dress(axes, theme, f"({letter}) {heading}")
        # The first line is widest, so that lines which coincide are all seen.
        for run, (colour, dash), width in zip(shown, theme.styles(), np.linspace(3.0, 1.4, len(shown))):
            t, norms = run.t, np.linalg.norm(rows_of(run), axis=1)
            axes.plot(*(envelope(t, norms) if log else (t, norms)), color=colour, ls=dash, lw=width)
        over_time(axes, symbol if per is None else f"{symbol} [{unit_of(shown, per)}]")
        in_decades(axes) if log else from_zero(axes)
    for column in grid.T:
        label_time_below(list(column))
    foot_legend(lower, theme, [grid[0, 0]], PAGE, list(named))
    return figure


def _named(runs: Sequence[Run]) -> dict[str, Run]:
    """Runs by the names of their schemes, numbered where several have the same name."""
    names = [type(run.scheme).__name__ for run in runs]
    return {
        name if names.count(name) == 1 else f"{name} {names[: i + 1].count(name)}": run
        for i, (name, run) in enumerate(zip(names, runs))
    }
