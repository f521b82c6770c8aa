"""Geometry of a robot for display: positions and axes of base, joints and tips; frames; names of the joints."""

import numpy as np

from ._core import link_frames as core_link_frames
from ._core import named_frames
from ._types import Array
from .arms import Arm, PlanarArm, SerialArm
from .joints import Joint
from .robots import Robot
from .tasks import FrameTask, PoseTask


def joints_of(arm: Arm | Robot) -> list[Joint]:
    """The joints, including mimic joints."""
    return [each.joint for each in arm.joints] if isinstance(arm, Robot) else list(arm.joints)


def joint_labels(arm: Arm | Robot) -> list[str]:
    """Names of the joints for display; the joints of a planar arm have no names and are numbered."""
    return [f"joint {i}" for i in range(1, arm.dof + 1)] if isinstance(arm, PlanarArm) else list(arm.joint_names)


def joint_units(arm: Arm | Robot) -> list[str]:
    """Unit of each joint position."""
    return ["m" if joint.type == "prismatic" else "rad" for joint in joints_of(arm) if joint.mimic is None]


def torque_units(arm: Arm | Robot) -> list[str]:
    """Unit of the torque, or the force, of each drive."""
    return ["N" if unit == "m" else "Nm" for unit in joint_units(arm)]


def dry_friction(arm: Arm | Robot) -> Array:
    """Dry friction of each drive [Nm or N], with the joints that follow the drive, shape (n,)."""
    joints = joints_of(arm)
    dry = np.zeros(len(joints))
    for i, joint in enumerate(joints):
        leader, ratio, _ = joint.mimic or (i, 1.0, 0.0)
        dry[leader] += abs(ratio) * joint.friction
    return dry[[joint.mimic is None for joint in joints]]


def joint_points(arm: Arm | Robot, q: Array) -> Array:
    """Positions of base, joints and tip [m] in postures q, shape (..., n): a line along the links.

    Shape (..., n + 1, 2) for planar arms, whose base is a joint; (..., k + 2, 3) for k joints, including mimic joints.
    For a Robot, branch after branch: NaN precedes a branch that does not start at the end of the previous branch. A
    link that carries no joint ends at its frames.
    """
    frames = link_frames(arm, q)
    tips = [(frames[..., link, :, :] @ offset[:, 3])[..., None, :3] for link, offset in _ends(arm)]
    nowhere = np.full_like(frames[..., :1, :3, 3], np.nan)
    points = np.concatenate([frames[..., :3, 3], *tips, nowhere], axis=-2)
    return points[..., 1:-1, :2] if isinstance(arm, PlanarArm) else points[..., _line(arm), :]


def length(arm: Arm | Robot, q: Array) -> float:
    """Length of the links from the base to the farthest tip, along the joints, in posture q, shape (n,) [m]."""
    points, line = joint_points(arm, q), _line(arm)
    far = {line[0]: 0.0}
    for a, b, start, end in zip(line, line[1:], points, points[1:]):
        if -1 not in (a, b):
            far[b] = far[a] + float(np.linalg.norm(end - start))
    return max(far.values())


def link_frames(arm: Arm | Robot, q: Array) -> Array:
    """Frames of base and links in postures q, shape (..., n): for a link, the frame of its joint after the motion.

    Shape (..., n + 1, 4, 4), or (..., k + 1, 4, 4) for k joints, including mimic joints; numbered as Capsule.link.
    """
    frames = core_link_frames(arm, q.reshape(-1, arm.dof))
    return frames.reshape(*q.shape[:-1], *frames.shape[1:])


def task_frames(arm: Arm | Robot, q: Array, task: FrameTask) -> Array:
    """The frame of a task in postures q, shape (..., n), in the base frame: shape (..., 4, 4)."""
    frames = frames_of(arm, q, task.frame)
    return frames if task.offset is None else np.asarray(frames @ task.offset)


def frames_of(arm: Arm | Robot, q: Array, name: str) -> Array:
    """Frame of that name, as in tasks, shape (..., 4, 4). Raises ParameterError if the frame does not exist."""
    return named_frames(arm, q.reshape(-1, arm.dof), name).reshape(*q.shape[:-1], 4, 4)


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


def _parents(arm: Arm | Robot) -> list[int]:
    """Numbers of the parent links of the joints."""
    return [each.parent for each in arm.joints] if isinstance(arm, Robot) else list(range(len(joints_of(arm))))


def _ends(arm: Arm | Robot) -> list[tuple[int, Array]]:
    """Links and the frames on them that are drawn beyond the last joints."""
    if isinstance(arm, SerialArm):
        return [(len(arm.joints), arm.tip)]
    if isinstance(arm, Robot):
        carrying, frames = _parents(arm), arm.named_frames
        return [(each.link, each.offset) for each in frames if each.link not in carrying and each.offset[:3, 3].any()]
    assert isinstance(arm, PlanarArm)
    tip = np.eye(4)
    tip[0, 3] = arm.lengths[-1]
    return [(arm.dof, tip)]


def _line(arm: Arm | Robot) -> list[int]:
    """Base (0), links and ends by number, in the order of a line along them; -1 is a break of the line."""
    parents, ends, line = _parents(arm), _ends(arm), [0]
    for link, parent in enumerate(parents, 1):
        tips = [len(parents) + i for i, (other, _) in enumerate(ends, 1) if other == link]
        for a, b in [(parent, link), *((link, tip) for tip in tips)]:
            line += [b] if line[-1] == a else [-1, a, b]
    return line
