"""OpenSoT's law on two levels, by bounded least squares of SciPy: an independent solver for panda_problems.py.

Each step solves the least squares of the tip within the bounds, and then the least squares of the posture. In the
second problem, a weight of 1e6 keeps the result of the tip.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

import fpbm_cpp as fp

Array = NDArray[np.float64]

REGULARISATION, KEEPS = 1e-4, 1e3


def solve(
    arm: fp.Arm, limits: fp.JointLimits, start: Array, goal: Array, within: float, steps: int, dt: float
) -> tuple[Array, bool]:
    q, states = start, [start]
    for _ in range(steps):
        J, error = arm.jacobian(q), goal - arm.forward(q)[:3, 3]
        lower = np.maximum(np.minimum(limits.lower - q, 0), -dt * limits.velocity) - 1e-12
        upper = np.minimum(np.maximum(limits.upper - q, 0), dt * limits.velocity) + 1e-12
        tip = _least_squares([(1, J, 0.1 * error), (REGULARISATION, np.eye(7), np.zeros(7))], lower, upper)
        change = _least_squares([(KEEPS, J, J @ tip), (1, np.eye(7), -0.01 * q)], lower, upper)
        q = np.clip(q + change, limits.lower, limits.upper)
        states.append(q)
        if np.linalg.norm(arm.forward(q)[:3, 3] - goal) <= within:
            return np.array(states), True
    return np.array(states), False


def _least_squares(parts: list[tuple[float, Array, Array]], lower: Array, upper: Array) -> Array:
    A = np.vstack([weight * rows for weight, rows, _ in parts])
    b = np.concatenate([weight * right for weight, _, right in parts])
    found: Array = lsq_linear(A, b, (lower, upper), method="bvls").x
    return found
