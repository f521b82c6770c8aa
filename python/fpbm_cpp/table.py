"""Arms, paths, schemes and limits as plain tables of numbers and text, for TOML, JSON and run files; and back.

    {"kind": "fpbm", "alpha": 0.6, "weights": [1, 2, 3, 4], "k1": 10.0, "k2": 25.0}

A table has the kind and the parameters of its thing, by their names. A path's also say how it is laid and rotated:
in_plane, with_rotation, rotation_time_law. Several paths, one after another, are a list of tables.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from .arms import ARMS, Arm, Joint, JointLimits, SerialArm
from .errors import ParameterError, not_one_of, suggestion
from .parameter import Data, Parameter, parameters
from .paths import PATH_OPTIONS, PATHS, InPlane, Path, WithRotation
from .paths import Sequence as PathSequence
from .schemes import SCHEMES, SECOND_TASKS, SecondTask

Makers = Mapping[str, Callable[..., Any]]
EVERY_PATH: Makers = {**PATHS, PathSequence.kind: PathSequence}
KINDS: Makers = {**ARMS, **EVERY_PATH, **SCHEMES, **SECOND_TASKS, JointLimits.kind: JointLimits}

# What stands in tables that are in others, by its key.
WITHIN: dict[str, Makers] = {"arm": ARMS, "second_task": SECOND_TASKS}


def to_table(thing: Any) -> Any:
    """A thing of this package as a table, or a number, text or array as it stands in one. Raises TypeError for others."""
    if isinstance(thing, InPlane):
        return {**to_table(thing.path), "in_plane": to_table(thing.plane)}
    if isinstance(thing, WithRotation):
        rotation = {"with_rotation": to_table(thing.rotation), "rotation_time_law": thing.time_law}
        return {**to_table(thing.path), **rotation}
    if isinstance(thing, Data):
        kind = {"kind": thing.kind} if hasattr(thing, "kind") else {}
        values = {name: value for name, value in thing._values().items() if not _is_absent(value)}
        return {**kind, **{name: to_table(value) for name, value in values.items()}}
    if isinstance(thing, (np.ndarray, np.generic)):
        return thing.tolist()
    if isinstance(thing, (list, tuple)):
        return [to_table(item) for item in thing]
    if thing is None or isinstance(thing, (bool, int, float, str)):
        return thing
    raise TypeError(f"{thing!r:.80}: must be a thing of this package, numbers or text")


def from_table(
    table: Any, kinds: Makers = KINDS, name: str = "", *, arm: Arm | None = None, problems: list[ParameterError] | None = None
) -> Any:
    """The thing that a table stands for.

    Parameters
    ----------
    table
        The table, or a list of those of paths.
    kinds : mapping
        What may stand there: ARMS, PATHS, SCHEMES or SECOND_TASKS, say; anything unless given.
    name : str
        What errors call the table.
    arm : Arm, optional
        Of which second tasks may say the first `joints`, in place of an arm of their own.
    problems : list, optional
        Takes all that is wrong; the result is None then.

    Raises
    ------
    ParameterError
        Where something is wrong, unless there is a list for it.
    OSError
        Where a file that the table names cannot be read.
    """
    found: list[ParameterError] = []
    thing = _Reader(arm, found).read(table, kinds, name)
    if problems is not None:
        problems.extend(found)
    elif found:
        raise found[0]
    return None if found else thing


class _Reader:
    """Makes things of tables, and notes what is wrong with them."""

    def __init__(self, arm: Arm | None, problems: list[ParameterError]) -> None:
        self.arm, self.problems = arm, problems

    def read(self, table: Any, kinds: Makers, name: str) -> Any:
        if isinstance(table, Data):
            return table
        if isinstance(table, (list, tuple)) and kinds.keys() >= PATHS.keys():
            return self._paths(table, kinds, name)
        if not isinstance(table, Mapping):
            return self.make(table, dict, name)
        key, kind = f"{name}.kind".lstrip("."), table.get("kind")
        if kind is None:
            return self._wrong(key, None, f": is missing: must be one of {', '.join(kinds)}")
        if kind not in kinds:
            return self.problems.append(not_one_of(key, kind, kinds))
        return self.make(table, kinds[kind], name)

    def make(self, table: Mapping[str, Any], maker: Callable[..., Any], name: str) -> Any:
        """What a maker makes of a table's values; None where something is wrong with them."""
        if isinstance(table, Data):
            return table
        if not isinstance(table, Mapping):
            return self._wrong(name, table, f" = {table!r:.60}: must be a table")
        wrong, known = len(self.problems), keys(maker, joints=self.arm is not None)
        values = {}
        for key, value in table.items():
            where = f"{name}.{key}".lstrip(".")
            if key in known:
                values[key] = self._value(value, known[key], maker, where)
            elif key != "kind":
                what = f": {table.get('kind', name)} has no such key: must be one of {', '.join(known)}"
                self._wrong(where, value, what + suggestion(key, known))
        for key, parameter in known.items():
            if parameter.required and key not in table:
                self._wrong(f"{name}.{key}".lstrip("."), None, ": is missing")
        if len(self.problems) > wrong:
            return None
        return self._checked(lambda: self._made(maker, values), name)

    def _made(self, maker: Callable[..., Any], values: dict[str, Any]) -> Any:
        if maker is SecondTask and self.arm is not None:
            values["arm"] = self.arm.first(values.pop("joints"))
        plane, rotation, law = (values.pop(key, None) for key in PATH_OPTIONS)
        thing = maker(**values)
        if plane is not None:
            thing = thing.in_plane(plane)
        return thing if rotation is None else thing.with_rotation(rotation, time_law=law or "quintic")

    def _value(self, value: Any, parameter: Parameter, maker: Callable[..., Any], name: str) -> Any:
        key = parameter.name
        if key in WITHIN:
            return self.read(value, WITHIN[key], name)
        if maker is SerialArm and key == "joints":
            return self._each(value, name, lambda table, where: self.make(table, Joint, where))
        if maker is PathSequence and key == "paths":
            return self._each(value, name, lambda table, where: self.read(table, EVERY_PATH, where))
        return self._checked(lambda: parameter.check(value), name.rpartition(".")[0])

    def _each(self, tables: Any, name: str, read: Callable[[Any, str], Any]) -> Any:
        if not isinstance(tables, (list, tuple)):
            return self._wrong(name, tables, f" = {tables!r:.60}: must be a list")
        return tuple(read(table, f"{name}[{i}]") for i, table in enumerate(tables))

    def _paths(self, tables: Sequence[Any], kinds: Makers, name: str) -> Any:
        if not tables:
            return self._wrong(name, tables, " = []: must be one at least")
        if len(tables) == 1:
            return self.read(tables[0], kinds, name)
        wrong = len(self.problems)
        paths = self._each(tables, name, lambda table, where: self.read(table, kinds, where))
        return None if len(self.problems) > wrong else self._checked(lambda: PathSequence(paths), name)

    def _checked(self, make: Callable[[], Any], name: str) -> Any:
        """What make() gives; where it refuses, a problem of the table of this name."""
        try:
            return make()
        except ParameterError as error:
            self.problems.append(error.within(name) if name else error)
        except ValueError as error:
            self._wrong(name, None, f": {error}")
        return None

    def _wrong(self, name: str, value: object, what: str) -> None:
        self.problems.append(ParameterError(name, None, value, name + what))


def keys(maker: Callable[..., Any], *, joints: bool = False) -> dict[str, Parameter]:
    """The keys of a maker's table, but for its kind.

    joints: whether second tasks name the first joints of an arm that is known, in place of an arm of their own.
    """
    known = dict(parameters(maker))
    if maker is SecondTask and joints:
        del known["arm"]
        return {"joints": Parameter("joints", int, help="How many of the arm's joints."), **known}
    return {**known, **PATH_OPTIONS} if maker in EVERY_PATH.values() else known


def _is_absent(value: Any) -> bool:
    """Whether a table does without it: nothing, or a bound that there is not."""
    return value is None or (isinstance(value, float) and math.isinf(value))
