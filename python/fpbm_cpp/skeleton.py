"""Geometry of a robot for display: positions and axes of base, joints and tips; frames; names of the joints."""

import numpy as np

from ._types import Array
from .arms import Arm, Joint, PlanarArm, SerialArm
from .errors import not_one_of
from .robots import Robot
from .tasks import FrameTask

HINGE = Joint()  # A joint of a planar arm, which rotates about z.


def joints_of(arm: Arm | Robot) -> list[Joint]:
    """The joints, including mimic joints; for a planar arm, only types and axes are meaningful."""
    if isinstance(arm, Robot):
        return [each.joint for each in arm.joints]
    return list(arm.joints) if isinstance(arm, SerialArm) else [HINGE] * arm.dof


def joint_labels(arm: Arm | Robot) -> list[str]:
    """Names of the joints for display; the joints of a planar arm have no names and are numbered."""
    return [f"joint {i}" for i in range(1, arm.dof + 1)] if isinstance(arm, PlanarArm) else list(arm.joint_names)


def joint_units(arm: Arm | Robot) -> list[str]:
    """Unit of each joint position."""
    return ["m" if joint.type == "prismatic" else "rad" for joint in joints_of(arm) if joint.mimic is None]


def joint_points(arm: Arm | Robot, q: Array) -> Array:
    """Positions of base, joints and tip [m] in postures q, shape (..., n): a line along the links.

    Shape (..., n + 1, 2) for planar arms, whose base is a joint; (..., k + 2, 3) for k joints, including mimic joints.
    For a Robot, branch after branch: NaN precedes a branch that does not start at the end of the previous branch. A
    link that carries no joint ends at its frames.
    """
    if isinstance(arm, PlanarArm):
        heading = np.cumsum(q, axis=-1)
        links = arm.lengths[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
        return np.cumsum(np.concatenate([np.zeros_like(links[..., :1, :]), links], axis=-2), axis=-2)
    points, turns = _forward_pass(arm, q)
    tips = [
        (points[..., link, :] + turns[..., link, :, :] @ offset[:3, 3])[..., None, :] for link, offset in _ends(arm)
    ]
    nowhere = np.full_like(points[..., :1, :], np.nan)
    return np.concatenate([points, *tips, nowhere], axis=-2)[..., _line(arm), :]


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
    if isinstance(arm, PlanarArm):
        points = np.zeros((*q.shape[:-1], arm.dof + 1, 3))
        points[..., 1:, :2] = joint_points(arm, q)[..., :-1, :]
        heading = np.concatenate([np.zeros_like(q[..., :1]), np.cumsum(q, axis=-1)], axis=-1)
        turns = _rotations(np.array([0.0, 0.0, 1.0]), heading)
    else:
        points, turns = _forward_pass(arm, q)
    frames = np.tile(np.eye(4), (*points.shape[:-1], 1, 1))
    frames[..., :3, :3], frames[..., :3, 3] = turns, points
    return frames


def task_frames(arm: Arm | Robot, q: Array, task: FrameTask) -> Array:
    """The frame of a task in postures q, shape (..., n), in the base frame: shape (..., 4, 4)."""
    frames = frames_of(arm, q, task.frame)
    return frames if task.offset is None else np.asarray(frames @ task.offset)


def frames_of(arm: Arm | Robot, q: Array, name: str) -> Array:
    """Frame of that name, as in tasks, shape (..., 4, 4). Raises ParameterError if the frame does not exist."""
    names = arm.joint_names if isinstance(arm, PlanarArm) else [joint.name for joint in joints_of(arm)]
    places = {"base": (0, np.eye(4))} | {name: (i, np.eye(4)) for i, name in enumerate(names, 1)}
    if isinstance(arm, Robot):
        places |= {each.name: (each.link, each.offset) for each in arm.named_frames}
    else:
        tip = np.eye(4)
        if isinstance(arm, PlanarArm):
            tip[0, 3] = arm.lengths[-1]
        places["tip"] = len(places) - 1, arm.tip if isinstance(arm, SerialArm) else tip
    if name not in places:
        raise not_one_of("frame", name, places)
    link, offset = places[name]
    return np.asarray(link_frames(arm, q)[..., link, :, :] @ offset)


def _parents(arm: Arm | Robot) -> list[int]:
    """Numbers of the parent links of the joints."""
    return [each.parent for each in arm.joints] if isinstance(arm, Robot) else list(range(len(joints_of(arm))))


def _ends(arm: Arm | Robot) -> list[tuple[int, Array]]:
    """Links and the frames on them that are drawn beyond the last joints."""
    if isinstance(arm, SerialArm):
        return [(len(arm.joints), arm.tip)]
    carrying = _parents(arm)
    frames = arm.named_frames if isinstance(arm, Robot) else ()
    return [(each.link, each.offset) for each in frames if each.link not in carrying and each.offset[:3, 3].any()]


def _line(arm: Arm | Robot) -> list[int]:
    """Base (0), links and ends by number, in the order of a line along them; -1 is a break of the line."""
    parents, ends, line = _parents(arm), _ends(arm), [0]
    for link, parent in enumerate(parents, 1):
        tips = [len(parents) + i for i, (other, _) in enumerate(ends, 1) if other == link]
        for a, b in [(parent, link), *((link, tip) for tip in tips)]:
            line += [b] if line[-1] == a else [-1, a, b]
    return line


def _forward_pass(arm: Arm | Robot, q: Array) -> tuple[Array, Array]:
    """Positions of base and joints, and rotations of base and links after the joints' motion."""
    p = np.zeros((*q.shape[:-1], 3))
    points, turns = [p], [np.broadcast_to(np.eye(3), (*p.shape, 3))]
    joints = joints_of(arm)
    for joint, parent, position in zip(joints, _parents(arm), _positions(joints, q)):
        p, R = points[parent], turns[parent]
        p, R = p + R @ joint.placement[:3, 3], R @ joint.placement[:3, :3]
        axis = joint.axis / np.linalg.norm(joint.axis)
        if joint.type == "prismatic":
            p = p + position[..., None] * (R @ axis)
        else:
            R = R @ _rotations(axis, position)
        points.append(p)
        turns.append(R)
    return np.stack(points, axis=-2), np.stack(turns, axis=-3)


def _positions(joints: list[Joint], q: Array) -> list[Array]:
    """Position of each joint, including mimic joints."""
    mimics = [joint.mimic for joint in joints]
    driven = (i for i, mimic in enumerate(mimics) if mimic is None)
    own = {i: q[..., column] for column, i in enumerate(driven)}
    return [own[i] if mimic is None else mimic[1] * own[mimic[0]] + mimic[2] for i, mimic in enumerate(mimics)]


def _rotations(axis: Array, angle: Array) -> Array:
    """Rotation matrices about a unit axis (Rodrigues' formula)."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = np.sin(angle)[..., None, None], np.cos(angle)[..., None, None]
    return np.asarray(np.eye(3) + sine * K + (1.0 - cosine) * (K @ K))
