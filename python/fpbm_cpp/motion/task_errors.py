"""Errors and paths of the tasks of a run, for tables and figures."""

from collections.abc import Iterator

import numpy as np

from .._types import Array
from ..skeleton import frames_of, joint_units
from .run_data import RunData


def error_parts(run: RunData) -> Iterator[tuple[str, str, Array, list[str]]]:
    """The errors of a stack's tasks in parts of one unit each: task, unit, values and names of the columns.

    Two parts for a pose; nothing for a run without a stack.
    """
    rows = ["x", "y", "z"]
    units = dict(zip(run.arm.joint_names, joint_units(run.arm)))
    for task in run.stack.tasks if run.stack is not None else ():
        error = run.errors[task.name]
        if task.kind == "posture":
            joints = list(getattr(task, "joints", None) or run.arm.joint_names)
            yield task.name, ", ".join(sorted({units[joint] for joint in joints}, reverse=True)), error, joints
        if task.kind in ("position", "pose", "relative_pose", "center_of_mass"):
            yield task.name, "m", error[:, :3], rows
        if task.kind in ("orientation", "axis", "pose", "relative_pose"):
            yield task.name, "rad", error[:, -3:], rows


def tracks(run: RunData) -> list[tuple[Array, Array]]:
    """For each path of a run: positions of the task's frame and of its reference in the base frame [m], (N, 2 or 3)."""
    found = [(run.positions, run.reference_positions)]
    frames = run.frames
    for name in run.paths:
        if name != run.task:
            p = frames[name][:, :3, 3]
            found.append((p, p + _in_base(run, name, run.errors[name][:, :3])))
    if run.path_task.reference_frame is not None:
        p = frames[run.task][:, :3, 3]
        found[0] = p, p + _in_base(run, run.task, run.position_error)
    return found


def _in_base(run: RunData, name: str, vectors: Array) -> Array:
    """Vectors of shape (N, 3) from the axes of a task's points to the axes of the base frame."""
    assert run.stack is not None
    reference = run.stack.follower(name).reference_frame
    if reference is None:
        return vectors
    return np.asarray(np.einsum("kij,kj->ki", frames_of(run.arm, run.q, reference)[:, :3, :3], vectors))
