"""Jacobians of tasks along a motion."""

import numpy as np

from .._types import Array
from ..robots import Robot
from ..skeleton import frames_of, task_frames
from ..tasks import FrameTask, PoseTask


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
