"""Two methods to resolve the levels of a scene: a Tracker with a Stack, and fp.saturate with the scale of SNS."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from lower_levels import Level
from pointing import DT, Array, Scene, Step

import fpbm_cpp as fp


def by_tracker(scene: Scene, lower: Sequence[Level], k1: float) -> Step:
    """Each task's acceleration is k1 (desired velocity - velocity); k1 = 1/T is equation (16)."""
    stack = fp.Stack(fp.PositionTask(name="tip", rows=scene.rows, k1=k1, k2=0), *(level.task(k1) for level in lower))
    scheme = fp.Balanced(0.0, np.ones(len(scene.q0)))
    tracker = fp.Tracker(scene.arm, scheme, scene.q0, stack=stack, limits=scene.limits, dt=DT, null_damping=0)

    def step(q: Array, qd: Array, velocity: Array) -> tuple[Array, Array, Array]:
        references = {"tip": (tracker.tip["tip"], velocity)}
        references |= {level.name: level.reference(q, qd) for level in lower}
        tick = tracker.tick(references)
        assert tick.scales is not None
        return tick.q, tick.qd, tick.scales

    return step


def by_saturate(scene: Scene, lower: Sequence[Level]) -> Step:
    """J qdd + Jd qd = s xdd with the largest s of each level, the scale of SNS: s is a further joint from 0 to 1."""
    arm, limits, n, rows = scene.arm, scene.limits, len(scene.q0), len(scene.rows)
    count = 1 + len(lower)

    def step(q: Array, qd: Array, velocity: Array) -> tuple[Array, Array, Array]:
        J = arm.jacobian(q)
        tip = J[:rows], (arm.jacobian_dot(q, qd) @ qd)[:rows], (velocity - J @ qd)[:rows] / DT
        levels: list[tuple[Array, Array]] = []
        higher = np.zeros((0, n))
        for i, (jacobian, drift, acceleration) in enumerate([tip, *(level.rows(q, qd) for level in lower)]):
            free, scale = attainable(jacobian, higher), np.eye(count)[i]
            levels.append((np.hstack([free @ jacobian, -np.outer(free @ acceleration, scale)]), -free @ drift))
            levels.append((np.r_[np.zeros(n), scale][None], np.ones(1)))
            higher = np.vstack([higher, jacobian])
        lower_bound, upper_bound = viable(limits, q, qd)
        found = fp.saturate(levels, lower=np.r_[lower_bound, np.zeros(count)], upper=np.r_[upper_bound, np.ones(count)])
        u = found.u[:n]
        return q + DT * qd + DT**2 / 2 * u, qd + DT * u, found.u[n:]

    return step


def attainable(jacobian: Array, higher: Array) -> Array:
    """Rows of a level in the null space of the higher levels, selected as by the pseudoinverse of SNS."""
    null_space = np.eye(jacobian.shape[1]) - np.linalg.pinv(higher) @ higher
    left, sigma, _ = np.linalg.svd(jacobian @ null_space, full_matrices=False)
    return left.T[sigma > 1e-6]


def viable(limits: fp.JointLimits, q: Array, qd: Array) -> tuple[Array, Array]:
    """Accelerations of a tick after which each joint can still stop within its range (docs/limits.md)."""

    def to_stop(distance: Array, speed: Array) -> Array:
        slack = 2 * distance - DT * speed
        return (slack / (np.sqrt(DT**2 + np.abs(slack) / limits.acceleration) + DT) - speed) / DT

    upper = np.minimum.reduce([limits.acceleration, (limits.velocity - qd) / DT, to_stop(limits.upper - q, qd)])
    lower = np.maximum.reduce([-limits.acceleration, -(limits.velocity + qd) / DT, -to_stop(q - limits.lower, -qd)])
    return np.minimum(lower, upper), upper
