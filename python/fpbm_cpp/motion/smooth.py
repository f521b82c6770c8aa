"""Paths whose time laws begin and end with zero velocity and acceleration."""

from __future__ import annotations

from dataclasses import replace

from ..paths import AtSpeed, Circle, InPlane, Line, Lissajous, Path, Polyline, Sequence, Tricuspid, WithRotation
from .run_data import Paths


def smooth_all(path: Paths) -> Paths:
    return smooth(path) if isinstance(path, Path) else {name: smooth(each) for name, each in path.items()}


def smooth(path: Path) -> Path:
    """The path with time laws that begin and end with zero velocity and acceleration; the geometry is equal."""
    if isinstance(path, Sequence):
        return replace(path, paths=tuple(smooth(each) for each in path.paths))
    if isinstance(path, InPlane):
        return replace(path, path=smooth(path.path))
    if isinstance(path, WithRotation):
        return replace(path, path=smooth(path.path), time_law="quintic")
    if isinstance(path, AtSpeed):
        return smooth(path.path)
    if isinstance(path, (Circle, Lissajous, Tricuspid, Line, Polyline)):
        return replace(path, time_law="quintic")
    return path
