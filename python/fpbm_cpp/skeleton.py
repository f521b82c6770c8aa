"""Where the base, the joints and the tip of an arm are: what it takes to draw one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ._core import PlanarArm
from .serial_arm import SerialArm

if TYPE_CHECKING:
    from ._core import Arm
    from ._types import Array


def joint_points(arm: Arm, q: Array) -> Array:
    """Points [m] that draw an arm in postures q, shape (..., n).

    Base, joints and tip: shape (..., n + 1, 2) for a planar arm, whose first joint is its base, and (..., k + 2, 3) for
    a serial arm of k joints, those that follow another included.
    """
    if isinstance(arm, PlanarArm):
        return _planar(arm, q)
    assert isinstance(arm, SerialArm)
    return _serial(arm, q)


def tip_axes(arm: Arm, q: Array) -> Array:
    """Axes of the tip in posture q, shape (n,), as columns: shape (2, 2) in the plane, (3, 3) in space."""
    if isinstance(arm, PlanarArm):
        sine, cosine = np.sin(q.sum()), np.cos(q.sum())
        return np.array([[cosine, -sine], [sine, cosine]])
    assert isinstance(arm, SerialArm)
    return np.asarray(arm.forward(q)[:3, :3])


def _planar(arm: PlanarArm, q: Array) -> Array:
    heading = np.cumsum(q, axis=-1)
    links = arm.lengths[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    return np.cumsum(np.concatenate([np.zeros_like(links[..., :1, :]), links], axis=-2), axis=-2)


def _serial(arm: SerialArm, q: Array) -> Array:
    p = np.zeros((*q.shape[:-1], 3))
    R = np.broadcast_to(np.eye(3), (*p.shape, 3))
    points = [p]
    for joint, position in zip(arm.joints, _positions(arm, q)):
        placement = np.asarray(joint.placement, dtype=float)
        p, R = p + R @ placement[:3, 3], R @ placement[:3, :3]
        axis = np.asarray(joint.axis, dtype=float)
        axis = axis / np.linalg.norm(axis)
        if joint.type == "prismatic":
            p = p + position[..., None] * (R @ axis)
        else:
            R = R @ _turns(axis, position)
        points.append(p)
    return np.stack([*points, p + R @ arm.tip[:3, 3]], axis=-2)


def _positions(arm: SerialArm, q: Array) -> list[Array]:
    """Position of each joint of the chain, those that follow another included."""
    driven = [i for i, joint in enumerate(arm.joints) if joint.mimic is None]
    own = {i: q[..., column] for column, i in enumerate(driven)}
    followed = ((i, joint.mimic) for i, joint in enumerate(arm.joints))
    return [own[i] if mimic is None else mimic[1] * own[mimic[0]] + mimic[2] for i, mimic in followed]


def _turns(axis: Array, angle: Array) -> Array:
    """Rotations about a unit axis (Rodrigues)."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = np.sin(angle)[..., None, None], np.cos(angle)[..., None, None]
    return np.asarray(np.eye(3) + sine * K + (1.0 - cosine) * (K @ K))
