"""Paths whose time laws begin and end with zero velocity and acceleration."""

from __future__ import annotations

from collections.abc import Mapping

from ..paths import (
    AtSpeed,
    Circle,
    InPlane,
    Line,
    Lissajous,
    Path,
    Polyline,
    Sequence,
    Tricuspid,
    WithRotation,
    are_timed,
)
from .run_data import Paths


def has_duration(path: Paths) -> bool:
    """Whether a path, or each of several paths, has a duration. Raises ParameterError if only some paths have one."""
    return are_timed({f"path[{name!r}]": each for name, each in by_task(path).items()})


def by_task(path: Paths) -> Mapping[str, Path]:
    """Paths by task name; the name of a single path is ''."""
    return path if isinstance(path, Mapping) else {"": path}


def smooth_all(path: Paths, duration: float = 1.0) -> Paths:
    """The smooth path or paths, with this duration [s] if they have none."""
    timed = has_duration(path)

    def whole(each: Path) -> Path:
        return smooth(each) if timed else smooth(each)._lasting(duration)

    return whole(path) if isinstance(path, Path) else {name: whole(each) for name, each in path.items()}


def smooth(path: Path) -> Path:
    """The path with time laws that begin and end with zero velocity and acceleration; the geometry is equal."""
    if isinstance(path, Sequence):
        return path._with(paths=[smooth(each) for each in path.paths])
    if isinstance(path, InPlane):
        return path._with(path=smooth(path.path))
    if isinstance(path, WithRotation):
        return path._with(path=smooth(path.path), time_law="quintic")
    if isinstance(path, AtSpeed):
        return smooth(path._lasting(path._duration() or 0.0))
    if isinstance(path, (Circle, Lissajous, Tricuspid, Line, Polyline)):
        return path._with(time_law="quintic")
    return path
