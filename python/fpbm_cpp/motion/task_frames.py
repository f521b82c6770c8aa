"""Frames of tasks along a motion: positions for figures, and Jacobians."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._types import Array
from ..robots import Robot
from ..skeleton import frames_of, task_frames
from ..tasks import FrameTask, PoseTask

if TYPE_CHECKING:
    from .run import Run


def tracks(run: Run) -> list[tuple[Array, Array]]:
    """For each path of a run: positions of the task's frame and of its reference in the base frame [m], (N, 2 or 3)."""
    found = [(run.positions, run.reference_positions)]
    frames = run.frames
    for name in run.paths:
        if name != run.task:
            p = frames[name][:, :3, 3]
            found.append((p, p + _in_base(run, name, run.errors[name][:, :3])))
    if run.path_task.reference_frame is not None:
        p = frames[run.task][:, :3, 3]
        found[0] = p, p + _in_base(run, run.task, run.position_error)
    return found


def _in_base(run: Run, name: str, vectors: Array) -> Array:
    """Vectors of shape (N, 3) from the axes of a task's points to the axes of the base frame."""
    assert run.stack is not None
    reference = run.stack.follower(name).reference_frame
    if reference is None:
        return vectors
    return np.asarray(np.einsum("kij,kj->ki", frames_of(run.arm, run.q, reference)[:, :3, :3], vectors))


def task_jacobians(robot: Robot, q: Array, task: FrameTask) -> Array:
    """Jacobian of a task relative to its reference frame, along the axes of the base frame, shape (N, m, n).

    m is 6 for a PoseTask, otherwise 3, for the position.
    """
    p = task_frames(robot, q, task)[:, :3, 3]
    J = _jacobians_at(robot, q, task.frame, p)
    if task.reference_frame is not None:
        J -= _jacobians_at(robot, q, task.reference_frame, p)
    return J if isinstance(task, PoseTask) else J[:, :3]


def _jacobians_at(robot: Robot, q: Array, frame: str, p: Array) -> Array:
    """Jacobian of the points p, shape (N, 3) [m], that move with a frame."""
    J = np.array([robot.jacobian(posture, frame) for posture in q]).reshape(-1, 6, robot.dof)
    lever = p - frames_of(robot, q, frame)[:, :3, 3]
    J[:, :3] += np.cross(J[:, 3:], lever[:, :, None], axis=1)
    return J
