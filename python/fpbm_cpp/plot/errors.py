"""Panels of the tip's error: its size on a logarithmic axis, or axis by axis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .legends import head_legend
from .lines import draw_lines, envelope, in_decades, over_time
from .theme import LIGHT, LINE, Theme

if TYPE_CHECKING:
    from .._types import Array
    from ..run import Run


def tip_error_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """How far the tip is from its reference, and how far turned where the task is a pose, on a logarithmic axis."""
    parts = {"[m]": _linear(run), "[rad]": _angular(run)}
    for (name, rows), (colour, dash) in zip(parts.items(), theme.styles()):
        if rows.shape[1]:
            axes.plot(*envelope(run.t, np.linalg.norm(rows, axis=1)), color=colour, ls=dash, lw=LINE, label=name)
    over_time(axes, r"$\|e\|$" if run.task == "pose" else r"$\|e\|$ [m]")
    in_decades(axes)
    if run.task == "pose":
        head_legend(axes, theme)


def error_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Tip error per axis, in the power of ten that suits it."""
    _per_axis(axes, theme, run.t, _linear(run), ["x", "y", "z"], "m")


def turn_error_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Error of the tip's orientation, about each axis, in the power of ten that suits it."""
    angular = _angular(run)
    names = ["angle"] if angular.shape[1] == 1 else ["about x", "y", "z"]
    _per_axis(axes, theme, run.t, angular, names, "rad")


def _linear(run: Run) -> Array:
    return run.error[:, : run.positions.shape[1]]


def _angular(run: Run) -> Array:
    return run.error[:, run.positions.shape[1] :]


def _per_axis(axes: Any, theme: Theme, t: Array, error: Array, names: Sequence[str], unit: str) -> None:
    largest = float(np.abs(error).max(initial=0.0))
    exponent = int(np.floor(np.log10(largest))) if largest > 0.0 else 0
    scale = f"[$10^{{{exponent}}}$ {unit}]" if exponent else f"[{unit}]"
    draw_lines(axes, theme, t, error / 10.0**exponent, names, f"error {scale}")
    head_legend(axes, theme)
