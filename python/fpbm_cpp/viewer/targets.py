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
        self._tasks = {each.name: each for each in self.tasks}
        self._filters = self._given_filters(given)
        self._x: dict[str, Array] = dict(self._by_name(tip))
        self._heard = dict.fromkeys(self._x, 0.0)  # Time of each target.
        for each in self.tasks:
            if each.kind in FILTERED and each.name not in self._filters:
                linear = {"velocity": length, "acceleration": 5.0 * length, "jerk": 100.0 * length}
                start = self._x[each.name]
                self._filters[each.name] = TargetFilter(start, **linear, **ANGULAR, task=each.kind, dt=dt)

    @property
    def x(self) -> Any:
        """The newest targets [m, rad]."""
        return self._plain({name: x.copy() for name, x in self._x.items()})

    @property
    def references(self) -> Any:
        """References for a tracker."""
        return self._plain({**self._x, **self._filters})

    @property
    def speed(self) -> float | None:
        """Smallest fraction of their bounds on velocity that the filters use; None without a filter."""
        return min((each.speed for each in self._filters.values()), default=None)

    def set_speed(self, fraction: float) -> None:
        """Reduce the bounds of all filters on velocity to a fraction in (0, 1]. Raises ParameterError."""
        for each in self._filters.values():
            each.set_speed(fraction)

    def of(self, task: str) -> Array:
        """The newest target of the task of that name. Raises ParameterError."""
        return self._x[self._known(task).name].copy()

    def restart(self, tip: Any, now: float) -> None:
        """Restart at rest at the points of the tasks, with the targets of their construction."""
        self._x = dict(self._by_name(tip))
        self._heard = dict.fromkeys(self._x, now)
        for name, task in self._tasks.items():
            if name in self._filters:
                self._filters[name].reset(self._x[name])
            own = getattr(task, "q" if isinstance(task, PostureTask) else "x")
            if own is not None:
                self.push(name, own, now, 0.0)

    def repeat(self, now: float, stamp: float) -> None:
        """Repeat targets without events, so that the filters detect that these targets are at rest."""
        for name, heard in self._heard.items():
            if now - heard >= REPEAT:
                self.push(name, self._x[name], now, stamp)

    def push(self, name: str | None, x: ArrayLike, now: float, stamp: float) -> bool:
        """Set a target of a task, with its stamp on the clock of the ticks. Returns whether the target is accepted."""
        task, x = self._known(name), np.array(x, dtype=float)
        taken = self._filters[task.name].push(x, stamp) if task.name in self._filters else self._is_sound(task, x)
        if taken:
            self._x[task.name], self._heard[task.name] = x, now
        return taken

    def _known(self, name: str | None) -> Task:
        name = TIP if name is None and self._alone else name
        if name not in self._tasks:
            raise not_one_of("task", name, self._tasks)
        return self._tasks[name]

    def _is_sound(self, task: Task, x: Array) -> bool:
        shape = self._x[task.name].shape
        if x.shape != shape:
            raise wrong(task.name, x, f" has shape {x.shape}: must have {shape}")
        if task.kind == "orientation":
            return bool(np.abs(x @ x.T - np.eye(3)).max() < ROUND_OFF and np.linalg.det(x) > 0.0)
        return bool(np.isfinite(x).all() and (task.kind != "axis" or x.any()))

    def _given_filters(self, given: Any) -> dict[str, TargetFilter]:
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
