"""Bounds on task coordinates: walls for a point of the robot, a cone for an axis, a speed."""

from __future__ import annotations

from dataclasses import KW_ONLY
from math import inf, pi
from typing import ClassVar

import numpy as np

from ._types import OptionalArrayField
from .errors import require, wrong
from .parameter import POSITIVE, Data, Parameter, data, parameter
from .tasks import POSITION, AxisTask, PositionTask

RANGE = Parameter(shape="() or (m,)", infinite=True, unit="m, rad")


@data
class TaskBounds(Data):
    """Bounds on the coordinates of a task.

    For a PositionTask, lower and upper are positions along the axes of the base frame, one entry for each row. For an
    AxisTask, lower and upper are the least and the largest angle between the axis and the task's x: a cone about x.

    lower and upper hold at every tick: a tick is executed only if the robot can stop within these bounds from the end
    of the tick. velocity and deceleration hold as far as the joint limits and the other bounds admit.

    Raises ParameterError if the task has another type, a bound is out of range, or lower is not below upper.
    """

    kind: ClassVar[str] = "bounds"
    task: PositionTask | AxisTask = parameter("Task whose coordinates are bounded; its gains are ignored.")
    lower: OptionalArrayField = parameter("Lower bounds; default: none.", RANGE, default=None)
    upper: OptionalArrayField = parameter("Upper bounds; default: none.", RANGE, default=None)
    _: KW_ONLY
    velocity: float = parameter(
        "Largest speed: norm of the velocity of the task's rows, or of the axis.",
        POSITIVE,
        default=inf,
        infinite=True,
        unit="m/s, rad/s",
    )
    deceleration: float = parameter(
        "Largest deceleration toward lower and upper; for an axis, of the cosine of the angle. Default: no bound.",
        POSITIVE,
        default=inf,
        infinite=True,
        unit="m/s^2, 1/s^2",
    )

    def _finish(self) -> None:
        task = self.task
        require("task", task, (PositionTask, AxisTask), "a PositionTask or an AxisTask")
        if isinstance(task, PositionTask):
            if task.axes != "base":
                raise wrong("task.axes", task.axes, f" = {task.axes!r}: must be 'base', the axes of the bounds")
        elif task.x is None:
            raise wrong("task.x", None, ": must be given: the bounded angle is measured from this direction")
        if task.reference_frame is not None:
            raise wrong("task.reference_frame", task.reference_frame, ": must be None: bounds are in the base frame")
        rows = tuple(task.rows or POSITION) if isinstance(task, PositionTask) else ("angle",)
        lower, upper = self._values_of("lower", -inf, len(rows)), self._values_of("upper", inf, len(rows))
        for i, (low, high) in enumerate(zip(lower, upper)):
            if not low < high:
                raise wrong("lower", low, f"[{i}] = {low:g}: must be below upper")
        if isinstance(task, AxisTask) and self.lower is not None and not 0.0 <= lower[0] < pi:
            raise wrong("lower", self.lower, f" = {lower[0]:g}: must be an angle from 0 to pi")
        by_row = dict(zip(rows, zip(lower, upper)))
        corners = [by_row.get(row, (-inf, inf)) for row in POSITION]
        vars(self).update(
            selected=[row in rows for row in POSITION],
            lower_corner=[low for low, _ in corners],
            upper_corner=[high for _, high in corners],
            least_angle=max(lower[0], 0.0),
            largest_angle=upper[0],
        )

    # Read by the compiled part.
    selected: ClassVar[list[bool]]  #: Whether x, y and z are rows of the task.
    lower_corner: ClassVar[list[float]]  #: Lower bounds of x, y and z [m].
    upper_corner: ClassVar[list[float]]  #: Upper bounds of x, y and z [m].
    least_angle: ClassVar[float]  #: Least angle of an axis [rad].
    largest_angle: ClassVar[float]  #: Largest angle of an axis [rad]; infinite if there is no bound.

    def _values_of(self, name: str, missing: float, rows: int) -> list[float]:
        """One bound for each row."""
        given = getattr(self, name)
        values = np.full(rows, missing) if given is None else np.atleast_1d(given)
        if values.shape not in ((rows,), (1,)):
            raise wrong(name, values, f" has {len(values)} entries: must have {rows}, one for each row")
        return [float(value) for value in np.broadcast_to(values, (rows,))]
