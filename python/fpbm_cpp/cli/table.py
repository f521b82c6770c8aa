"""Figures of motions as text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import click
import numpy as np
from numpy.typing import NDArray

from .._types import Array
from ..joint_text import joint_labels, joint_units
from ..run import Run

WIDTH = 100


def columns(*rows: Sequence[str]) -> str:
    """Rows of cells as aligned columns, the first to the left; rows may be shorter than the first."""
    whole = [[*row, *[""] * (len(rows[0]) - len(row))] for row in rows]
    widths = [max(map(len, column)) for column in zip(*whole)]
    return "\n".join(
        "  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in whole
    )


def number(value: float) -> str:
    """As many digits as one reads."""
    return f"{value:.1e}" if 0.0 < abs(value) < 1e-3 else f"{value:.4g}"


def summary(run: Run) -> str:
    """A motion's key figures, with where and when they are reached, and how it ended."""
    rows = list(_figures(run)) if len(run.t) else []
    name_width, value_width, unit_width = (max((len(row[i]) for row in rows), default=6) for i in range(3))
    lines = [f"{n:{name_width}}  {v:>{value_width}} {u:{unit_width}}  {w}".rstrip() for n, v, u, w in rows]
    indent = " " * (name_width + 2)
    text = f"{'status':{name_width}}  {' '.join(str(run.status).split())}"
    return "\n".join([*lines, click.wrap_text(text, WIDTH, subsequent_indent=indent)])


def _figures(run: Run) -> Iterator[tuple[str, str, str, str]]:
    """Name, value, unit and remark."""
    m = run.positions.shape[1]
    yield _worst(run, "largest tip error", np.linalg.norm(run.error[:, :m], axis=1), "m")
    if run.task == "pose":
        yield _worst(run, "largest turn error", np.linalg.norm(run.error[:, m:], axis=1), "rad")
    for name, values, per in (("velocity", run.qd, "/s"), ("acceleration", run.qdd, "/s^2")):
        size = np.abs(values)
        k, i = np.unravel_index(size.argmax(), size.shape)
        names, units = joint_labels(run.arm), joint_units(run.arm)
        yield f"peak joint {name}", number(size[k, i]), units[i] + per, f"{names[i]} at {run.t[k]:.3g} s"
        i = size[-1].argmax()
        yield f"final joint {name}", number(size[-1, i]), units[i] + per, names[i]
    yield _worst(run, "least manipulability", run.manipulability(), "", least=True)
    if run.scale is not None:
        yield _worst(run, "least task scale", run.scale, "", least=True)
    if run.saturated is not None:
        held = _named(run, run.saturated)
        yield "joints on a bound", str(len(held)), "", ", ".join(held)
    elif beyond := _named(run, _beyond(run)):
        yield "joints beyond a bound", str(len(beyond)), "", f"{', '.join(beyond)}: --limits keeps them"


def _beyond(run: Run) -> NDArray[np.bool_]:
    """Which joints are beyond a bound of the arm's, at each sample."""
    limits = run.arm.limits
    return np.asarray(
        (run.q < limits.lower)
        | (run.q > limits.upper)
        | (np.abs(run.qd) > limits.velocity)
        | (np.abs(run.qdd) > limits.acceleration)
    )


def _named(run: Run, flags: NDArray[np.bool_]) -> list[str]:
    """The joints that are flagged at any sample."""
    return [name for name, flag in zip(joint_labels(run.arm), np.any(flags, axis=0).tolist()) if flag]


def _worst(run: Run, name: str, values: Array, unit: str, least: bool = False) -> tuple[str, str, str, str]:
    k = values.argmin() if least else values.argmax()
    return name, number(values[k]), unit, f"at {run.t[k]:.3g} s"
