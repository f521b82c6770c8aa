"""Points and frames in space: of the tip, and of the targets of tasks."""

from collections.abc import Sequence

import numpy as np

from .._core import rotation, rotation_vector
from .._types import Array
from ..tasks import POSITION, ROTATION, AxisTask, RowsTask, Task
from ..urdf.place import frame_at


def in_space(points: Array) -> Array:
    """Points with three coordinates; z is 0 for points in the plane."""
    return np.pad(points, [(0, 0)] * (points.ndim - 1) + [(0, 3 - points.shape[-1])])


def frame_of(task: Task, x: Array) -> Array:
    """Frame of a task's point, shape (4, 4): z is the direction of an axis; undetermined coordinates are 0."""
    if task.kind == "position":
        return frame_at(in_space(x))
    if task.kind in ("orientation", "axis"):
        return frame_at(R=x if task.kind == "orientation" else z_to(x))
    return x.copy() if x.shape == (4, 4) else frame_at(in_space(x[:2]), rotation([0.0, 0.0, x[2]]))


def point_of(task: Task, frame: Array, shape: tuple[int, ...]) -> Array:
    """Point of a task from a frame, in the shape of the task's points."""
    if task.kind == "position":
        return frame[: shape[0], 3].copy()
    if task.kind == "orientation":
        return frame[:3, :3].copy()
    if task.kind == "axis":
        return frame[:3, 2].copy()
    return frame.copy() if shape == (4, 4) else np.array([*frame[:2, 3], np.arctan2(frame[1, 0], frame[0, 0])])


def distances(task: Task, target: Array, now: Array) -> dict[str, float]:
    """Distance of a task's frame from a target, by unit 'm', 'rad' or both, for the rows that the task selects."""
    R, linear = now[:3, :3], target[:3, 3] - now[:3, 3]
    if isinstance(task, AxisTask):
        a, b = now[:3, 2], target[:3, 2]
        return {"rad": float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))}
    angular = rotation_vector(target[:3, :3] @ R.T)
    if isinstance(task, RowsTask) and task.axes == "frame":
        linear, angular = R.T @ linear, R.T @ angular
    parts = ("m", selected(task, POSITION), linear), ("rad", selected(task, ROTATION), angular)
    return {unit: float(np.linalg.norm(rows * error)) for unit, rows, error in parts if rows.any()}


def selected(task: Task, rows: Sequence[str]) -> Array:
    """1 for each of these rows that a task selects, 0 for the other rows."""
    own = (task.all_rows if task.rows is None else task.rows) if isinstance(task, RowsTask) else ()
    return np.array([float(row in own) for row in rows])


def z_to(direction: Array) -> Array:
    """A rotation that turns the z axis to a direction, by the smallest angle."""
    x, y, z = direction / np.linalg.norm(direction)
    sine = float(np.hypot(x, y))
    axis = np.array([-y, x, 0.0]) / sine if sine > 1e-300 else np.array([1.0, 0.0, 0.0])
    return np.asarray(rotation(float(np.arctan2(sine, z)) * axis))
