"""Panels of the tip's error: its norm on a logarithmic axis, or its components."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from .._types import Array
from ..motion.run import Run
from .legends import head_legend
from .lines import draw_lines, envelope, in_decades, over_time
from .theme import LIGHT, LINE, Theme


def tip_error_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Norm of the position error and, where the task is a pose, of the orientation error, on a logarithmic axis."""
    parts = {"[m]": run.position_error, "[rad]": run.orientation_error}
    for (name, rows), (colour, dash) in zip(parts.items(), theme.styles()):
        if rows.shape[1]:
            axes.plot(*envelope(run.t, np.linalg.norm(rows, axis=1)), color=colour, ls=dash, lw=LINE, label=name)
    over_time(axes, r"$\|e\|$" if run.task == "pose" else r"$\|e\|$ [m]")
    in_decades(axes)
    if run.task == "pose":
        head_legend(axes, theme)


def error_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Position error along each axis, in units of a power of ten."""
    _components(axes, theme, run.t, run.position_error, ["x", "y", "z"], "m")


def orientation_error_panel(axes: Any, run: Run, theme: Theme = LIGHT) -> None:
    """Orientation error about each axis, in units of a power of ten."""
    error = run.orientation_error
    names = ["angle"] if error.shape[1] == 1 else ["about x", "y", "z"]
    _components(axes, theme, run.t, error, names, "rad")


def _components(axes: Any, theme: Theme, t: Array, error: Array, names: Sequence[str], unit: str) -> None:
    largest = float(np.abs(error).max(initial=0.0))
    exponent = int(np.floor(np.log10(largest))) if largest > 0.0 else 0
    scale = f"[$10^{{{exponent}}}$ {unit}]" if exponent else f"[{unit}]"
    draw_lines(axes, theme, t, error / 10.0**exponent, names, f"error {scale}")
    head_legend(axes, theme)
