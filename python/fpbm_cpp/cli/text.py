"""Key figures of motions as text."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

import click
import numpy as np

from .._types import Array
from ..motion.run import Run
from ..motion.task_errors import error_parts
from ..skeleton import joint_labels, joint_units
from .plain import WIDTH

# Key figures of a sweep: column heading, unit, and the figure of a run.
FIGURES: dict[str, tuple[str, str, Callable[[Run], float]]] = {
    "max_error": ("tip error", "m", Run.max_error),
    "max_orientation_error": ("tip error", "rad", Run.max_orientation_error),
    "peak_velocity": ("peak qd", "rad/s", lambda run: np.abs(run.qd).max()),
    "final_velocity": ("final qd", "rad/s", lambda run: np.abs(run.qd[-1]).max()),
    "peak_acceleration": ("peak qdd", "rad/s^2", lambda run: np.abs(run.qdd).max()),
    "final_acceleration": ("final qdd", "rad/s^2", lambda run: np.abs(run.qdd[-1]).max()),
    "manipulability": ("manip.", "least", lambda run: run.manipulability().min()),
}
Row = tuple[Sequence[str], str, Mapping[str, float]]


def columns(*rows: Sequence[str]) -> str:
    """Rows of cells as aligned columns; the first column is left-aligned. Rows may be shorter than the first row."""
    whole = [[*row, *[""] * (len(rows[0]) - len(row))] for row in rows]
    widths = [max(map(len, column)) for column in zip(*whole)]
    lines = ("  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]) for row in whole)
    return "\n".join(line.rstrip() for line in lines)


def figure_table(names: Sequence[str], task: str, rows: Iterable[Row], remarks: Iterable[str]) -> str:
    """Table with a row for each scheme: named cells, complete motions, figures of the worst motion; remarks below."""
    shown = [name for name in FIGURES if task == "pose" or name != "max_orientation_error"]
    header = zip(*((name, "") for name in (*names, "complete")), *(FIGURES[name][:2] for name in shown))
    cells = [[*first, done, *(number(figures[name]) for name in shown if figures)] for first, done, figures in rows]
    lines = [click.wrap_text(remark, WIDTH, subsequent_indent="  ") for remark in remarks]
    return "\n".join([columns(*header, *cells), *([""] if lines else []), *lines])


def number(value: float) -> str:
    """A number with four significant digits, or two below 1e-3."""
    return f"{value:.1e}" if 0.0 < abs(value) < 1e-3 else f"{value:.4g}"


def summary(run: Run) -> str:
    """Key figures of a motion, each with its joint and its time, and the status."""
    rows = list(_figures(run)) if len(run.t) else []
    name_width, value_width, unit_width = (max((len(row[i]) for row in rows), default=6) for i in range(3))
    lines = [f"{n:{name_width}}  {v:>{value_width}} {u:{unit_width}}  {w}".rstrip() for n, v, u, w in rows]
    text = f"{'status':{name_width}}  {' '.join(str(run.status).split())}"
    return "\n".join([*lines, click.wrap_text(text, WIDTH, subsequent_indent=" " * (name_width + 2))])


def _figures(run: Run) -> Iterator[tuple[str, str, str, str]]:
    """Name, value, unit and remark."""
    names, units, limits = joint_labels(run.arm), joint_units(run.arm), run.arm.limits

    def at(k: np.intp, name: str, values: Array, unit: str = "") -> tuple[str, str, str, str]:
        return name, number(values[k]), unit, f"at {run.t[k]:.3g} s"

    position, orientation = run.error_norms()
    yield at(position.argmax(), "largest tip error", position, "m")
    if run.kind == "pose":
        yield at(orientation.argmax(), "largest orientation error", orientation, "rad")
    for name, values, per in (("velocity", run.qd, "/s"), ("acceleration", run.qdd, "/s^2")):
        size = np.abs(values)
        k, i = np.unravel_index(size.argmax(), size.shape)
        yield f"peak joint {name}", number(size[k, i]), units[i] + per, f"{names[i]} at {run.t[k]:.3g} s"
        i = size[-1].argmax()
        yield f"final joint {name}", number(size[-1, i]), units[i] + per, names[i]
    manipulability = run.manipulability()
    yield at(manipulability.argmin(), "least manipulability", manipulability)
    if run.scale is not None:
        yield at(run.scale.argmin(), "least task scale", run.scale)
    if run.stack is not None and run.scales is not None:
        for level, scale in zip(run.stack.levels[1:], run.scales[:, 1:].T):
            yield at(scale.argmin(), f"least scale of {', '.join(task.name for task in level)}", scale)
    for name, unit, values, _ in error_parts(run):
        yield f"final error of {name}", number(float(np.linalg.norm(values[-1]))), unit, ""
    if run.clearance is not None:
        yield at(run.clearance.argmin(), "least clearance", run.clearance, "m")
    outside = (run.q < limits.lower) | (run.q > limits.upper)
    too_fast = (np.abs(run.qd) > limits.velocity) | (np.abs(run.qdd) > limits.acceleration)
    flags = outside | too_fast if run.saturated is None else run.saturated
    joints = [name for name, flag in zip(names, np.any(flags, axis=0)) if flag]
    if run.saturated is not None:
        yield "joints on a bound", str(len(joints)), "", ", ".join(joints)
    elif joints:
        yield "joints beyond a bound", str(len(joints)), "", f"{', '.join(joints)}: --limits keeps the bounds"
