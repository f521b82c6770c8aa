"""Bounds of a motion beyond the joint limits: a clearance, and bounds on task coordinates and on torques."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ._types import Array
from .arms import Arm
from .clearance import Clearance
from .errors import require
from .joints import JointLimits
from .robots import Robot
from .skeleton import dry_friction
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


def torque_bounds_among(bounds: Iterable[Bound]) -> TorqueBounds | None:
    return next((each for each in bounds if isinstance(each, TorqueBounds)), None)


def largest_torques(arm: Arm | Robot, limits: JointLimits, bounds: Iterable[Bound]) -> Array:
    """Bounds on the torques of inverse dynamics [Nm or N], shape (n,): the bounds of TorqueBounds, or the efforts of
    the limits, minus the dry friction. Efforts below the dry friction, which TorqueBounds refuse, do not count.
    """
    given, most, dry = torque_bounds_among(bounds), limits.effort, dry_friction(arm)
    if given is not None:
        most = given.fraction * np.asarray(arm.limits.effort if given.effort is None else given.effort)
    return np.where(most > dry, most - dry, np.inf)
