"""A posture to start from, where none is given."""

from __future__ import annotations

import numpy as np

from .._core import Arm, PlanarArm
from .._types import Array
from .arms import AnyArm, Preset

# The hand points down, from the makers' ready postures: Franka's, 30° -90° 60° of the iiwa 14, Kinova's home [rad].
READY = {
    "panda": [0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854],
    "iiwa14": [0.0, 0.5236, 0.0, -1.5708, 0.0, 1.0472, 0.0],
    "gen3": [0.0, 0.2618, 3.1416, -2.2689, 0.0, 0.9599, 1.5708],
}

# How far each joint of an unknown arm is bent, of a list that is tried in turn [rad]; at most a quarter of its range.
BEND = 0.5
CALM = 0.05  # The least of J's singular values over the largest, in a posture that will do.


def ready(section: AnyArm, arm: Arm, task: str) -> list[float]:
    """Joint positions that are not singular [rad].

    A preset's own; in the plane, a quarter of a turn from the first link to the last, in even bends; else the middle of
    the limits, or zero where there are none, bent as far as it takes.
    """
    if isinstance(section, Preset):
        return READY[section.name]
    posture = np.full(arm.dof, np.pi / 2 / (arm.dof - 1)) if isinstance(arm, PlanarArm) else _bent(arm, task)
    return [round(float(position), 4) for position in posture]


def _bent(arm: Arm, task: str) -> Array:
    """The first posture around the middle of the limits that is far enough from a singular one, or else the best."""
    lower, upper = arm.limits.lower, arm.limits.upper
    bounded = np.isfinite(lower) & np.isfinite(upper)
    middle = np.clip(0.0, lower, upper)
    middle[bounded] = (lower[bounded] + upper[bounded]) / 2
    room = np.minimum(BEND, (upper - lower) / 4)
    one: Array = np.ones(arm.dof)
    signs = [0 * one, one, -one]
    for period in (1, 2, 3):
        alternating = np.where(np.arange(arm.dof) // period % 2, -one, one)
        signs += [alternating, -alternating]
    postures = [middle + sign * room for sign in signs]
    return next(
        (q for q in postures if _calmness(arm, q, task) > CALM), max(postures, key=lambda q: _calmness(arm, q, task))
    )


def _calmness(arm: Arm, q: Array, task: str) -> float:
    values = np.linalg.svd(arm.jacobian(q, task=task), compute_uv=False)
    return float(values[-1] / values[0]) if values[0] > 0.0 else 0.0
