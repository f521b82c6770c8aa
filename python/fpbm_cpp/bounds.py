"""Bounds of a motion beyond the joint limits: a clearance, and bounds on task coordinates and on torques."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from .clearance import Clearance
from .errors import require
from .task_bounds import TaskBounds
from .torque_bounds import TorqueBounds

Bound = Clearance | TaskBounds | TorqueBounds


def bounds_of(given: Iterable[Bound]) -> tuple[Bound, ...]:
    """The bounds, which the compiled part checks. Raises ParameterError if the argument is not a sequence."""
    require("bounds", given, Iterable, "a Clearance, TaskBounds and TorqueBounds in a sequence")
    return tuple(given)


def clearance_among(bounds: Iterable[Bound]) -> Clearance | None:
    """The clearance among bounds, or None."""
    return next((each for each in bounds if isinstance(each, Clearance)), None)


def task_bounds_among(bounds: Iterable[Bound]) -> Sequence[TaskBounds]:
    return [each for each in bounds if isinstance(each, TaskBounds)]
