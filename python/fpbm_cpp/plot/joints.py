"""Panels of the joints: positions, velocities and accelerations, with the bounds that they come near."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from .._types import Array
from ..arms import Arm
from ..motion.run import Run
from ..skeleton import joint_labels, joint_units
from .legends import side_legend
from .lines import draw_lines
from .theme import LIGHT, Theme

NEAR = 0.1  # Of the distance between a joint's bounds.


def position_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Joint positions, and the bounds that a joint comes near."""
    _joint_lines(axes, theme, run, run.q, r"$q$", "", run.limits.lower, run.limits.upper)


def velocity_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Joint velocities, and the bounds that a joint comes near."""
    bound = run.limits.velocity
    _joint_lines(axes, theme, run, run.qd, r"$\dot q$", "/s", -bound, bound)


def acceleration_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Joint accelerations, and the bounds that a joint comes near."""
    bound = run.limits.acceleration
    _joint_lines(axes, theme, run, run.qdd, r"$\ddot q$", "/s²", -bound, bound)


def joint_names(arm: Arm) -> list[str]:
    """The joints' names for a legend; prismatic joints are marked where there are revolute ones too."""
    units = joint_units(arm)
    return [
        f"{name} (slides)" if unit == "m" and "rad" in units else name for name, unit in zip(joint_labels(arm), units)
    ]


def unit_of(runs: Sequence[Run], per: str) -> str:
    """Unit of a quantity of all joints: 'rad/s', or 'rad/s, m/s' where some are prismatic."""
    units = sorted({unit for run in runs for unit in joint_units(run.arm)}, reverse=True)
    return ", ".join(unit + per for unit in units)


def _joint_lines(
    axes: Any, theme: Theme, run: Run, values: Array, symbol: str, per: str, lower: Array, upper: Array
) -> None:
    draw_lines(axes, theme, run.t, values, joint_names(run.arm), f"{symbol} [{unit_of([run], per)}]")
    if len(values):
        _draw_bounds(axes, theme, values, lower, upper)
    side_legend(axes, theme)


def _draw_bounds(axes: Any, theme: Theme, values: Array, lower: Array, upper: Array) -> None:
    """A line at each bound that a joint comes near, in that joint's colour, or in ink where several share the bound."""
    span = np.where(np.isfinite(upper - lower), upper - lower, 1.0)
    colours = [colour for (colour, _), _ in zip(theme.styles(), lower)]
    label = "bound"
    for bounds, distance in ((lower, values.min(axis=0) - lower), (upper, upper - values.max(axis=0))):
        near = distance < NEAR * span
        for bound in np.unique(bounds[near]):
            owners = np.flatnonzero(near & (bounds == bound))
            colour = colours[owners[0]] if len(owners) == 1 else theme.ink
            axes.axhline(bound, color=colour, lw=0.8, ls=(0, (1, 1)), label=label, zorder=1.5)
            label = "_bound"
