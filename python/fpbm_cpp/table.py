"""Conversion of the package's objects to plain tables of numbers and text, for TOML, JSON and run files, and back.

    {"kind": "fpbm", "alpha": 0.6, "weights": [1, 2, 3, 4], "k1": 10.0, "k2": 25.0}

A table has the kind of its object and the parameters by name. The table of a path may also have in_plane,
with_rotation and rotation_time_law, and at_speed, at_acceleration and at_jerk for a constant speed. The
table of an arm may have a payload. Several paths, one
after another, are a list of tables; paths of several tasks are a table with a path, or a list of paths, for each task
name. A stack is a list of tables of tasks, each with its level, counted from 0.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from .arms import SerialArm
from .capsule import Capsule
from .clearance import CLEARANCES, Clearance
from .errors import ParameterError, not_one_of, suggestion, wrong
from .joints import Joint, JointLimits, NamedFrame, TreeJoint
from .mechanism import PAYLOAD, Payload
from .obstacle import OBSTACLES
from .parameter import REQUIRED, Data, Parameter, parameters
from .paths import PATH_OPTIONS, PATHS, AtSpeed, InPlane, WithRotation
from .paths import Sequence as PathSequence
from .robots import ROBOTS, Robot
from .schemes import SCHEMES
from .task_bounds import TaskBounds
from .tasks import TASKS, AxisTask, PositionTask, Stack, Task
from .torque_bounds import TorqueBounds

Makers = Mapping[str, Callable[..., Any]]
EVERY_PATH: Makers = {**PATHS, PathSequence.kind: PathSequence}
KINDS: Makers = {
    **ROBOTS,
    **EVERY_PATH,
    **SCHEMES,
    **TASKS,
    **OBSTACLES,
    JointLimits.kind: JointLimits,
    Clearance.kind: Clearance,
    TaskBounds.kind: TaskBounds,
    TorqueBounds.kind: TorqueBounds,
}

BOUNDS: Makers = {TaskBounds.kind: TaskBounds, TorqueBounds.kind: TorqueBounds}

# Tables within other tables, by their keys.
WITHIN: dict[Any, Any] = {
    (TorqueBounds, "lighter"): ROBOTS,
    (TaskBounds, "task"): {each.kind: each for each in (PositionTask, AxisTask)},
    (TreeJoint, "joint"): Joint,
    (AtSpeed, "path"): EVERY_PATH,
    **{(maker, PAYLOAD.name): Payload for maker in ROBOTS.values()},
}
LEVEL = Parameter(
    "level",
    int,
    low=0,
    whole=True,
    default=0,
    usual=0,
    help="Task level, counted from 0; level 0 has the highest priority.",
)
LISTS: dict[Any, Any] = {
    (SerialArm, "joints"): Joint,
    (Robot, "joints"): TreeJoint,
    (Robot, "named_frames"): NamedFrame,
    (PathSequence, "paths"): EVERY_PATH,
    (Clearance, "capsules"): {Capsule.kind: Capsule},
    **{(maker, "obstacles"): OBSTACLES for maker in CLEARANCES.values()},
}


def to_table(thing: Any) -> Any:
    """Table of an object of this package; numbers, text and arrays become plain data. TypeError for other objects.

    Infinity becomes the text 'inf', for JSON. None and missing bounds of joints are left out.
    """
    if isinstance(thing, InPlane):
        return {**to_table(thing.path), "in_plane": to_table(thing.plane)}
    if isinstance(thing, WithRotation):
        rotation = {"with_rotation": to_table(thing.rotation), "rotation_time_law": thing.time_law}
        return {**to_table(thing.path), **rotation}
    if isinstance(thing, Stack):
        return [{**to_table(task), "level": k} for k, level in enumerate(thing.levels) for task in level]
    if isinstance(thing, Data):
        kind = {"kind": thing.kind} if hasattr(thing, "kind") else {}
        values = {name: to_table(value) for name, value in thing._values().items()}
        return {**kind, **{name: value for name, value in values.items() if value not in (None, "inf", "-inf")}}
    if isinstance(thing, Mapping):
        return {name: to_table(value) for name, value in thing.items()}
    if isinstance(thing, (np.ndarray, np.generic)):
        return to_table(thing.tolist())
    if isinstance(thing, (list, tuple)):
        return [to_table(item) for item in thing]
    if isinstance(thing, float) and math.isinf(thing):
        return str(thing)
    if thing is None or isinstance(thing, (bool, int, float, str)):
        return thing
    raise TypeError(f"{thing!r:.80}: must be an object of this package, numbers or text")


def from_table(table: Any, kinds: Makers | type[Data] = KINDS, name: str = "") -> Any:
    """Object of a table, or of a list of tables of paths or of tasks; a table may also contain objects.

    kinds: the allowed kinds, for example ROBOTS, PATHS, SCHEMES or TASKS. name: name of the table in errors.

    Raises ParameterError for the first error, OSError if a file that the table names cannot be read.
    """
    reader = _Reader()
    thing = reader.read(table, kinds, name)
    for problem in reader.problems:
        raise problem
    return thing


def problems(table: Any, kinds: Makers, name: str = "", *, usual: bool = False) -> list[ParameterError]:
    """Errors in the keys and values of a table, found without its arm. usual: keys with usual values may be missing."""
    reader = _Reader(usual, make=False)
    reader.read(table, kinds, name)
    return reader.problems


def keys(maker: Callable[..., Any]) -> dict[str, Parameter]:
    """The keys of a table for a constructor, except kind."""
    known = dict(parameters(maker))
    if maker in TASKS.values():
        return {**known, "level": LEVEL}
    if maker in ROBOTS.values():
        return {**known, PAYLOAD.name: PAYLOAD}
    return {**known, **PATH_OPTIONS} if maker in EVERY_PATH.values() else known


def is_by_task(table: Any) -> bool:
    """Whether a table contains paths by task name, each a table or a list of tables."""
    if not isinstance(table, Mapping) or not table:
        return False
    pieces = [piece for path in table.values() for piece in (path if isinstance(path, (list, tuple)) else [path])]
    return all(isinstance(piece, Mapping) for piece in pieces)


def carrying(arm: Any, payload: Payload) -> Any:
    """The arm with a payload. Raises ParameterError."""
    try:
        return arm.with_payload(payload.mass, com=payload.com, inertia=payload.inertia, frame=payload.frame)
    except ParameterError as error:
        raise error.within(PAYLOAD.name) from None


class _Reader:
    """Constructs objects from tables, and records errors; after an error, the object is None."""

    def __init__(self, usual: bool = False, make: bool = True) -> None:
        self.usual, self.make = usual, make
        self.problems: list[ParameterError] = []

    def read(self, table: Any, kinds: Makers | type[Data], name: str) -> Any:
        """Object of a table, of a list of tables of paths, or of tables of paths by task name."""
        if isinstance(table, Data):
            return table
        if isinstance(table, (list, tuple)) and kinds is TASKS:
            return self._stack(table, name)
        if isinstance(table, (list, tuple)) and kinds is BOUNDS:
            return self._each(table, kinds, name)
        if isinstance(table, (list, tuple)) and kinds in (PATHS, EVERY_PATH, KINDS):
            if len(table) == 1:
                return self.read(table[0], kinds, name)
            if not table:
                return self._wrong(name, table, " = []: must have at least one path")
            paths = self._each(table, kinds, name)
            return None if None in paths else self._checked(lambda: PathSequence(paths), name)
        if kinds in (PATHS, EVERY_PATH) and is_by_task(table):
            return {task: self.read(path, kinds, f"{name}.{task}") for task, path in table.items()}
        if not isinstance(table, Mapping):
            return self._wrong(name, table, f" = {table!r:.60}: must be a table")
        if not isinstance(kinds, Mapping):
            return self._thing(table, kinds, name)
        key, kind = f"{name}.kind".lstrip("."), table.get("kind")
        if kind is None:
            return self._wrong(key, None, f": is missing: must be one of {', '.join(kinds)}")
        if kind not in tuple(kinds):
            return self.problems.append(not_one_of(key, kind, kinds))
        return self._thing(table, kinds[kind], name)

    def _thing(self, table: Mapping[str, Any], maker: Callable[..., Any], name: str) -> Any:
        before, known = len(self.problems), keys(maker)
        values, within = {}, f"{name}." if name else ""
        for key, value in table.items():
            if key in known:
                values[key] = self._value(value, known[key], maker, within + key)
            elif key != "kind":
                what = f": is not a key of {table.get('kind', name)}: must be one of {', '.join(known)}"
                self._wrong(within + key, value, what + suggestion(key, known))
        for key, parameter in known.items():
            if parameter.required and key not in table and not (self.usual and parameter.usual is not REQUIRED):
                self._wrong(within + key, None, ": is missing")
        if self.make and len(self.problems) == before:
            return self._checked(lambda: self._made(maker, values), name)

    def _made(self, maker: Callable[..., Any], values: dict[str, Any]) -> Any:
        values.pop("level", None)  # Read by _stack().
        payload = values.pop(PAYLOAD.name, None)
        plane, rotation, law, speed, acceleration, jerk = (values.pop(key, None) for key in PATH_OPTIONS)
        thing = maker(**values)
        if payload is not None:
            return carrying(thing, payload)
        if plane is not None:
            thing = thing.in_plane(plane)
        if rotation is not None:
            thing = thing.with_rotation(rotation, time_law=law or "quintic")
        if speed is None and acceleration is None and jerk is None:
            return thing
        for key, value in (("at_speed", speed), ("at_acceleration", acceleration)):
            if value is None:
                raise wrong(key, None, ": is missing: a constant speed needs at_speed and at_acceleration")
        return thing.at_speed(speed, acceleration=acceleration, jerk=jerk)

    def _value(self, value: Any, parameter: Parameter, maker: Callable[..., Any], name: str) -> Any:
        if (maker, parameter.name) in WITHIN:
            return self.read(value, WITHIN[maker, parameter.name], name)
        if (maker, parameter.name) in LISTS:
            return self._each(value, LISTS[maker, parameter.name], name)
        if parameter.infinite:
            value = _with_infinities(value)
        return self._checked(lambda: parameter.check(value), name.rpartition(".")[0])

    def _each(self, tables: Any, kinds: Any, name: str) -> Any:
        if not isinstance(tables, (list, tuple)):
            return self._wrong(name, tables, f" = {tables!r:.60}: must be a list")
        return tuple(self.read(table, kinds, f"{name}[{i}]") for i, table in enumerate(tables))

    def _stack(self, tables: Any, name: str) -> Any:
        """The stack of a list of tasks."""
        tasks = self._each(tables, TASKS, name)
        levels: dict[int, list[Task]] = {}
        for table, task in zip(tables, tasks):
            if isinstance(table, Mapping) and task is not None:
                levels.setdefault(LEVEL.check(table.get("level", 0)), []).append(task)
        for k in range(max(levels, default=0)):
            if k not in levels:
                return self._wrong(
                    f"{name}.level",
                    max(levels),
                    f" = {max(levels)}: level {k} has no task: number the levels from 0 without gaps",
                )
        return None if None in tasks else self._checked(lambda: Stack(*(levels[k] for k in sorted(levels))), name)

    def _checked(self, make: Callable[[], Any], name: str) -> Any:
        """Result of make(); an error of make() is recorded for the table of this name."""
        try:
            return make()
        except ParameterError as error:
            self.problems.append(error.within(name) if name else error)
        except (TypeError, ValueError) as error:
            self._wrong(name, None, f": {error}")

    def _wrong(self, name: str, value: object, problem: str) -> None:
        self.problems.append(wrong(name, value, problem))


def _with_infinities(value: Any) -> Any:
    if isinstance(value, (list, tuple)):
        return [_with_infinities(item) for item in value]
    return float(value) if value in ("inf", "-inf") else value
