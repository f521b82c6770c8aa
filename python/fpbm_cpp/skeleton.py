"""What is shown of an arm: positions and axes of base, joints and tip, and what the joints are called."""

import numpy as np

from ._core import rotation
from ._types import Array
from .arms import Arm, PlanarArm, SerialArm


def joint_labels(arm: Arm) -> list[str]:
    """Names of the joints for people to read; in the plane, where they have none, their numbers."""
    return list(arm.joint_names) if isinstance(arm, SerialArm) else [f"joint {i}" for i in range(1, arm.dof + 1)]


def joint_units(arm: Arm) -> list[str]:
    """Unit of each joint's position."""
    if not isinstance(arm, SerialArm):
        return ["rad"] * arm.dof
    return ["m" if joint.type == "prismatic" else "rad" for joint in arm.joints if joint.mimic is None]


def joint_points(arm: Arm, q: Array) -> Array:
    """Positions of base, joints and tip [m] in postures q, shape (..., n).

    Shape (..., n + 1, 2) of planar arms, whose base is a joint, (..., k + 2, 3) of k joints, mimic joints included.
    """
    if isinstance(arm, PlanarArm):
        heading = np.cumsum(q, axis=-1)
        links = arm.lengths[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
        return np.cumsum(np.concatenate([np.zeros_like(links[..., :1, :]), links], axis=-2), axis=-2)
    assert isinstance(arm, SerialArm)
    return _forward_pass(arm, q)[0]


def joint_axes(arm: Arm, q: Array) -> Array:
    """Unit vectors along the joints' axes in postures q, shape (..., n, 3), or (..., k, 3) with mimic joints."""
    if isinstance(arm, PlanarArm):
        return np.broadcast_to([0.0, 0.0, 1.0], (*q.shape, 3))
    assert isinstance(arm, SerialArm)
    return _forward_pass(arm, q)[1]


def tip_axes(arm: Arm, q: Array) -> Array:
    """Axes of the tip in posture q, shape (n,), as columns: shape (2, 2) in the plane, (3, 3) in space."""
    return rotation([0.0, 0.0, q.sum()])[:2, :2] if isinstance(arm, PlanarArm) else arm.forward(q)[:3, :3]


def link_frames(arm: Arm, q: Array) -> Array:
    """Frames of base and links in posture q, shape (n,): each that of its joint after its motion, as a Capsule's link.

    Shape (n + 1, 4, 4), or (k + 1, 4, 4) of k joints, mimic joints included.
    """
    if isinstance(arm, PlanarArm):
        turns = np.array([rotation([0.0, 0.0, angle]) for angle in np.cumsum(q)])
        points = np.pad(joint_points(arm, q)[:-1], [(0, 0), (0, 1)])
    else:
        assert isinstance(arm, SerialArm)
        points, _, turns = _forward_pass(arm, q)
        points = points[1:-1]
    frames = np.tile(np.eye(4), (len(turns) + 1, 1, 1))
    frames[1:, :3, :3], frames[1:, :3, 3] = turns, points
    return frames


def _forward_pass(arm: SerialArm, q: Array) -> tuple[Array, Array, Array]:
    """Positions of base, joints and tip; axes of the joints, and rotations after their motion."""
    p = np.zeros((*q.shape[:-1], 3))
    R = np.broadcast_to(np.eye(3), (*p.shape, 3))
    points, axes, turns = [p], [], []
    for joint, position in zip(arm.joints, _positions(arm, q)):
        p, R = p + R @ joint.placement[:3, 3], R @ joint.placement[:3, :3]
        axis = joint.axis / np.linalg.norm(joint.axis)
        axes.append(R @ axis)
        if joint.type == "prismatic":
            p = p + position[..., None] * axes[-1]
        else:
            R = R @ _rotations(axis, position)
        points.append(p)
        turns.append(R)
    return np.stack([*points, p + R @ arm.tip[:3, 3]], axis=-2), np.stack(axes, axis=-2), np.stack(turns, axis=-3)


def _positions(arm: SerialArm, q: Array) -> list[Array]:
    """Position of each joint of the chain, mimic joints included."""
    mimics = [joint.mimic for joint in arm.joints]
    driven = (i for i, mimic in enumerate(mimics) if mimic is None)
    own = {i: q[..., column] for column, i in enumerate(driven)}
    return [own[i] if mimic is None else mimic[1] * own[mimic[0]] + mimic[2] for i, mimic in enumerate(mimics)]


def _rotations(axis: Array, angle: Array) -> Array:
    """Rotation matrices about a unit axis (Rodrigues' formula)."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = np.sin(angle)[..., None, None], np.cos(angle)[..., None, None]
    return np.asarray(np.eye(3) + sine * K + (1.0 - cosine) * (K @ K))
