"""Key figures of motions as text."""

from collections.abc import Iterator

import click
import numpy as np

from .._types import Array
from ..motion.run import Run
from ..motion.task_errors import error_parts
from ..shown import number
from ..skeleton import joint_labels, joint_units
from .plain import WIDTH


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
    ratios = run.bound_ratios().get("torque", np.zeros((1, 1)))
    if ratios.any():
        k, i = np.unravel_index(ratios.argmax(), ratios.shape)
        yield "largest torque / bound", number(ratios[k, i]), "", f"{names[i]} at {run.t[k]:.3g} s"
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
