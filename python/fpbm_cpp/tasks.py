"""Tasks of a robot, and stacks of task levels in strict priority."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import KW_ONLY
from typing import Any, ClassVar

import numpy as np

from ._core import Task as CoreTask
from ._types import ArrayField, OptionalArrayField
from .errors import not_one_of, require, wrong
from .parameter import NOT_NEGATIVE, Data, Parameter, data, library_class, parameter

__all__ = ["AxisTask", "CenterOfMassTask", "OrientationTask", "PoseTask", "PositionTask", "PostureTask"]
__all__ += ["RelativePoseTask", "Stack", "Task"]

POSITION = ("x", "y", "z")
ROTATION = ("rx", "ry", "rz")
FRAME = (
    "'tip' of an arm, a frame of a Robot, 'base', or a joint's name, for the frame of the link that the joint moves."
)
REFERENCE = "Frame that replaces the base frame for the point, the rows and the path of the task."
TARGET = "Target if no path or reference is given; default: the start."
OFFSET = Parameter(default=None, shape="(4, 4)", unit="m", help="Pose of the task's frame relative to `frame`.")
ROWS = "Selected rows of the task, out of x, y, z, rx, ry, rz; None: all."
AXES = Parameter(
    default="base", usual="base", choices=("base", "frame"), help="The rows are along the axes of this frame."
)


@data
class Task(Data, CoreTask):
    """Base class of the tasks of a stack. A subclass of a task has the meaning of its parent.

    At acceleration level, the error of a task obeys e'' + k1 e' + k2 e = 0; at velocity level, e' + k e = 0.
    """

    kind: ClassVar[str]
    _: KW_ONLY
    name: str = parameter("Name in references and errors; if empty, the kind.", default="")
    k1: float = parameter("Feedback gain on velocity.", NOT_NEGATIVE, default=10.0, unit="1/s")
    k2: float = parameter("Feedback gain on position.", NOT_NEGATIVE, default=25.0, unit="1/s^2")
    k: float = parameter("Feedback gain at velocity level.", NOT_NEGATIVE, default=5.0, unit="1/s")

    def _finish(self) -> None:
        meaning = library_class(type(self))
        if meaning not in TASKS.values():
            names = ", ".join(each.__name__ for each in TASKS.values())
            raise TypeError(f"{type(self).__name__}: is not a task: must be derived from one of {names}")
        CoreTask.__init__(self, meaning.kind)
        if not self.name:
            object.__setattr__(self, "name", meaning.kind)


@data
class FrameTask(Task):
    """A task of a frame."""

    frame: str = parameter(FRAME, default="tip")
    _: KW_ONLY
    x: OptionalArrayField = parameter(TARGET, default=None, shape="(3,) or (3, 3) or (4, 4)", unit="m")
    offset: OptionalArrayField = parameter(like=OFFSET, default=None)
    reference_frame: str | None = parameter(REFERENCE, default=None)
    point_shape: ClassVar[tuple[int, ...]] = (3,)

    def _finish(self) -> None:
        super()._finish()
        if self.x is not None and self.x.shape != self.point_shape:
            raise wrong("x", self.x, f" has shape {self.x.shape}: must have {self.point_shape}")


def check_rows(rows: Sequence[str] | None, all_rows: tuple[str, ...]) -> tuple[str, ...] | None:
    """Selected rows as a tuple. Raises ParameterError unless the rows are different rows of the task."""
    if rows is None:
        return None
    if isinstance(rows, str) or not isinstance(rows, Iterable) or not tuple(rows):
        raise wrong("rows", rows, f" = {rows!r:.80}: must be some of {', '.join(all_rows)}")
    for i, row in enumerate(rows := tuple(rows)):
        if row not in all_rows:
            raise not_one_of("rows", row, all_rows)
        if row in rows[:i]:
            raise wrong("rows", rows, f" has {row!r} twice: must have each row once")
    return rows


@data
class RowsTask(FrameTask):
    """A task of a frame that selects rows."""

    all_rows: ClassVar[tuple[str, ...]]
    _: KW_ONLY
    rows: Sequence[str] | None = parameter(ROWS, default=None)
    axes: str = parameter(like=AXES, default="base")

    def _finish(self) -> None:
        super()._finish()
        object.__setattr__(self, "rows", check_rows(self.rows, self.all_rows))


@data
class PositionTask(RowsTask):
    """The position of a frame's origin, or some of its coordinates. Point: shape (3,) [m]."""

    kind = "position"
    all_rows = POSITION


@data
class OrientationTask(RowsTask):
    """The orientation of a frame, or some of its rotations. Point: shape (3, 3)."""

    kind = "orientation"
    all_rows = ROTATION
    point_shape = (3, 3)


@data
class PoseTask(RowsTask):
    """The pose of a frame, or some of its rows. Point: shape (4, 4) [m].

    With axes='frame', rows=('x', 'y', 'z', 'rx', 'ry') leave the rotation about the frame's z axis free.
    """

    kind = "pose"
    all_rows = POSITION + ROTATION
    point_shape = (4, 4)


@data
class RelativePoseTask(PoseTask):
    """The pose of a frame in another frame of the robot, as in a grasp with two hands. Point: shape (4, 4) [m].

    With reference_frame=, a PositionTask, OrientationTask or AxisTask is also relative to that frame.
    """

    kind = "relative_pose"
    reference_frame: str | None = parameter(REFERENCE, default=None)

    def _finish(self) -> None:
        super()._finish()
        if self.reference_frame is None:
            raise wrong("reference_frame", None, " = None: must be a frame of the robot")


@data
class CenterOfMassTask(Task):
    """The position of the robot's centre of mass, or some of its coordinates. Point: shape (3,) [m]."""

    kind = "center_of_mass"
    _: KW_ONLY
    x: OptionalArrayField = parameter(TARGET, default=None, shape="(3,)", unit="m")
    rows: Sequence[str] | None = parameter(ROWS, default=None)

    def _finish(self) -> None:
        super()._finish()
        object.__setattr__(self, "rows", check_rows(self.rows, POSITION))


@data
class AxisTask(FrameTask):
    """Direction of an axis of a frame: 2 rows. The rotation about the axis is free. Point: shape (3,)."""

    kind = "axis"
    axis: ArrayField | str = parameter(
        "Axis in the frame, 'x', 'y', 'z' or a vector; its length is ignored.", default=(0, 0, 1), shape="(3,)"
    )

    def __post_init__(self) -> None:
        if isinstance(self.axis, str):
            if self.axis not in POSITION:
                raise not_one_of("axis", self.axis, POSITION)
            object.__setattr__(self, "axis", [float(row == self.axis) for row in POSITION])
        super().__post_init__()

    def _finish(self) -> None:
        super()._finish()
        if not np.any(self.axis):
            raise wrong("axis", self.axis, " = 0: must be a nonzero vector")


@data
class PostureTask(Task):
    """Positions of all joints or of some joints. Point: shape (joints,) [rad]."""

    kind = "posture"
    q: OptionalArrayField = parameter(TARGET, default=None, shape="(n,)", unit="rad")
    _: KW_ONLY
    joints: Sequence[str] | None = parameter("Names of the joints; None: all.", default=None)

    def _finish(self) -> None:
        super()._finish()
        if self.joints is None:
            return
        given = (self.joints,) if isinstance(self.joints, str) or not isinstance(self.joints, Iterable) else self.joints
        names = tuple(given)
        if not names or not all(isinstance(name, str) for name in names) or len(set(names)) < len(names):
            raise wrong("joints", self.joints, f" = {self.joints!r:.80}: must be names of joints, each once")
        object.__setattr__(self, "joints", names)


# Classes of tasks, by the kind in a table.
TASKS: dict[str, type[Task]] = {
    each.kind: each
    for each in (PositionTask, OrientationTask, PoseTask, AxisTask, RelativePoseTask, CenterOfMassTask, PostureTask)
}


class Stack:
    """Tasks on levels in strict priority: a lower level acts in the null space of the higher levels.

    Each argument is a level: a task, or a list of tasks with equal priority. There are at most 4 levels, each with at
    most two tasks of frames and one PostureTask. Raises ParameterError if a level is empty or two tasks share a name.
    """

    levels: tuple[tuple[Task, ...], ...]
    tasks: tuple[Task, ...]  #: All tasks, higher levels first.

    def __init__(self, *levels: Task | Sequence[Task]) -> None:
        made = tuple(tuple(level) if isinstance(level, (list, tuple)) else (level,) for level in levels)
        if not made:
            raise wrong("levels", levels, ": must have at least one level")
        names: list[str] = []
        for k, level in enumerate(made):
            if not level:
                raise wrong(f"levels[{k}]", level, " is empty: must have a task")
            for task in level:
                require(f"levels[{k}]", task, Task, "a task, or a sequence of tasks")
                if task.name in names:
                    raise wrong(
                        f"levels[{k}]", task, f" has a second task with the name {task.name!r}: give another name="
                    )
                names.append(task.name)
        self.levels = made
        self.tasks = tuple(task for level in made for task in level)

    def error_sizes(self, dof: int) -> list[int]:
        """Number of entries in the error of each task, for dof joints."""
        sizes = {"pose": 6, "relative_pose": 6, "posture": dof}
        return [len(getattr(task, "joints", None) or ()) or sizes.get(task.kind, 3) for task in self.tasks]

    def follower(self, name: str | None = None) -> PositionTask | PoseTask:
        """Task that follows a path: the task of that name, or the only position or pose. Raises ParameterError."""
        able = [task for task in self.tasks if isinstance(task, (PositionTask, PoseTask))]
        found = [task for task in able if name in (None, task.name)]
        if len(found) == 1:
            return found[0]
        if name is None and found:
            raise wrong("task", None, f": several tasks follow paths: must be one of {', '.join(t.name for t in able)}")
        what = f" = {name!r}" if name is not None else ""
        raise wrong("task", name, f"{what}: must be the name of a position or a pose of the stack to follow a path")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Stack) and other.levels == self.levels

    def __hash__(self) -> int:
        return hash(self.levels)

    def __repr__(self) -> str:
        return f"Stack({', '.join(repr(level[0] if len(level) == 1 else list(level)) for level in self.levels)})"

    def __reduce__(self) -> tuple[Any, ...]:
        return Stack, self.levels
