"""The errors of a stack's tasks, in parts of one unit each."""

from collections.abc import Iterator

from .._types import Array
from ..skeleton import joint_units
from .run import Run


def error_parts(run: Run) -> Iterator[tuple[str, str, Array, list[str]]]:
    """Task, unit, values and names of the columns: two parts for a pose; nothing for a run without a stack."""
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
