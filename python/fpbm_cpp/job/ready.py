"""A posture to start from, where none is given."""

from itertools import islice, product

import numpy as np

from .._types import Array
from ..arms import Arm, PlanarArm

# The hand points down, from the makers' ready postures: Franka's, 30° -90° 60° of the iiwa 14, Kinova's home [rad].
READY = {
    "panda": [0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854],
    "iiwa14": [0.0, 0.5236, 0.0, -1.5708, 0.0, 1.0472, 0.0],
    "gen3": [0.0, 0.2618, 3.1416, -2.2689, 0.0, 0.9599, 1.5708],
}

# How far joints of an unknown arm are bent, one way, the other or not at all [rad]; at most a quarter of their range.
BEND = 1.0
MOST = 3**7  # Postures that are looked at.
GOOD = 0.8  # Of what the best has, as far as singular postures are.


def ready(arm: Arm, task: str) -> list[float]:
    """Joint positions that are not singular [rad].

    In the plane, a quarter of a turn from the first link to the last, in even bends; else the middle of the limits, or
    zero where there are none, with as few joints bent as keep it far from singular postures.
    """
    posture = np.full(arm.dof, np.pi / 2 / (arm.dof - 1)) if isinstance(arm, PlanarArm) else _bent(arm, task)
    return [round(float(position), 4) for position in posture]


def _bent(arm: Arm, task: str) -> Array:
    """The posture of fewest bent joints that is about as far from singular ones as any."""
    lower, upper = arm.limits.lower, arm.limits.upper
    bounded = np.isfinite(lower) & np.isfinite(upper)
    middle = np.clip(0.0, lower, upper)
    middle[bounded] = (lower[bounded] + upper[bounded]) / 2
    room = np.minimum(BEND, (upper - lower) / 4)
    # The last joints change fastest: of long arms, those near the base stay as they are.
    bends = np.array(list(islice(product((0.0, 1.0, -1.0), repeat=arm.dof), MOST)))
    bends = bends[np.argsort(np.abs(bends).sum(axis=1), kind="stable")]
    jacobians = np.array([arm.jacobian(middle + bend * room, task=task) for bend in bends])
    sigma = np.linalg.svd(jacobians, compute_uv=False)
    inverse_condition = sigma[:, -1] / np.maximum(sigma[:, 0], np.finfo(float).tiny)
    good = inverse_condition >= GOOD * inverse_condition.max()
    return np.asarray(middle + bends[np.argmax(good)] * room)
