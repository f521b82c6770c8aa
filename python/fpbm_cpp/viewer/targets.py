"""The newest target of each task that a servo follows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._core import TargetFilter
from .._types import Array
from ..errors import not_one_of, wrong
from ..tasks import TASKS, PostureTask, Stack, Task

REPEAT = 0.1  # A handle without events is at rest: the target of this handle is repeated after this time [s].
FILTERED = ("position", "pose")  # Tasks with a filter for targets; targets of other tasks are references.
# Bounds of default filters.
ANGULAR = {"angular_velocity": 2.0, "angular_acceleration": 10.0, "angular_jerk": 200.0}
ROUND_OFF = 1e-8  # Tolerance of the entries of a rotation.
TIP = "tip"  # Name of the only task without a stack.


class Targets:
    """Targets of the tasks of a stack, or of the tip's only task; trackers and pages do not name the only task.

    given: a filter, or for a stack, filters by name. length: length of the arm [m], for the bounds of default filters.
    Raises ParameterError if a filter is not for a position or pose of the stack.
    """

    def __init__(self, task: str, stack: Stack | None, tip: Any, given: Any, length: float, dt: float) -> None:
        self._alone = stack is None
        self.tasks: Sequence[Task] = (TASKS[task](name=TIP),) if stack is None else stack.tasks
        filters = self._filters(given)
        starts = self._by_name(tip)
        for each in self.tasks:
            if each.kind in FILTERED and each.name not in filters:
                linear = {"velocity": length, "acceleration": 5.0 * length, "jerk": 100.0 * length}
                filters[each.name] = TargetFilter(starts[each.name], **linear, **ANGULAR, task=each.kind, dt=dt)
        self._targets = {each.name: Target(each, starts[each.name], filters.get(each.name)) for each in self.tasks}

    @property
    def x(self) -> Any:
        """The newest targets [m, rad]."""
        return self._plain({name: target.x.copy() for name, target in self._targets.items()})

    @property
    def references(self) -> Any:
        """References for a tracker."""
        return self._plain({name: target.reference for name, target in self._targets.items()})

    def of(self, task: str | None) -> Target:
        """The target of the task of that name. Raises ParameterError."""
        name = TIP if task is None and self._alone else task
        if name not in self._targets:
            raise not_one_of("task", name, self._targets)
        return self._targets[name]

    def restart(self, tip: Any, now: float) -> None:
        """Restart at rest at the points of the tasks, with the targets of their construction."""
        starts = self._by_name(tip)
        for name, target in self._targets.items():
            target.restart(starts[name], now)

    def repeat(self, now: float, stamp: float) -> None:
        """Repeat targets without events, so that the filters detect that these targets are at rest."""
        for target in self._targets.values():
            if now - target.heard >= REPEAT:
                target.push(target.x, now, stamp)

    def _filters(self, given: Any) -> dict[str, TargetFilter]:
        if given is None or self._alone:
            return {} if given is None else {TIP: given}
        if not isinstance(given, Mapping):
            raise wrong("targets", given, ": must be a dictionary of filters by task names of the stack")
        able = [task.name for task in self.tasks if task.kind in FILTERED]
        for name in given:
            if name not in able:
                raise not_one_of("targets", name, able)
        return dict(given)

    def _by_name(self, plain: Any) -> dict[str, Any]:
        return {TIP: plain} if self._alone else plain

    def _plain(self, by_name: dict[str, Any]) -> Any:
        return by_name[TIP] if self._alone else by_name


class Target:
    """The newest target of a task, and its reference."""

    def __init__(self, task: Task, start: Array, filtered: TargetFilter | None) -> None:
        self._task, self._filter = task, filtered
        self.x: Array = start
        self.heard: float = 0.0  # Time of the target.

    @property
    def reference(self) -> TargetFilter | Array:
        return self.x if self._filter is None else self._filter

    def restart(self, start: Array, now: float) -> None:
        self.x, self.heard = start, now
        if self._filter is not None:
            self._filter.reset(start)
        own = getattr(self._task, "q" if isinstance(self._task, PostureTask) else "x")
        if own is not None:
            self.push(own, now, 0.0)

    def push(self, x: ArrayLike, now: float, stamp: float) -> bool:
        """Set a target, with its stamp on the clock of the ticks. Returns whether the target is accepted."""
        x = np.array(x, dtype=float)
        taken = self._is_sound(x) if self._filter is None else self._filter.push(x, stamp)
        if taken:
            self.x, self.heard = x, now
        return taken

    def _is_sound(self, x: Array) -> bool:
        if x.shape != self.x.shape:
            raise wrong(self._task.name, x, f" has shape {x.shape}: must have {self.x.shape}")
        if self._task.kind == "orientation":
            return bool(np.abs(x @ x.T - np.eye(3)).max() < ROUND_OFF and np.linalg.det(x) > 0.0)
        return bool(np.isfinite(x).all() and (self._task.kind != "axis" or x.any()))
