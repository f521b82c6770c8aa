"""Two paths of `python bench/fastest.py --count 170` past singular postures, rounded to 1e-4.

At the peak of the joint velocities, the least singular value of J is 1.4e-3 (xarm7) and 4.2e-3 (gen3). The peak lasts
1e-4 (xarm7) and 1e-3 (gen3) of the path.
"""

from __future__ import annotations

import numpy as np

import fpbm_cpp as fp

STARTS = {
    "xarm7": (-1.3838, -0.3641, -0.7307, 0.4374, -1.2657, 0.4429, 1.3076),
    "gen3": (1.4908, -0.4511, -1.3402, -0.8677, -1.0866, 0.8823, -0.6354),
}
POINTS = {
    "xarm7": (
        (0.0, 0.0, 0.0),
        (-0.0717, -0.0679, -0.1039),
        (-0.1161, 0.0744, -0.1116),
        (-0.1186, 0.0798, -0.0655),
        (-0.0234, 0.0631, -0.001),
        (0.225, -0.1381, -0.0254),
    ),
    "gen3": (
        (0.0, 0.0, 0.0),
        (-0.0636, -0.0346, -0.0364),
        (0.0096, -0.1833, -0.1382),
        (-0.2335, -0.2109, -0.1832),
    ),
}
JERKS = {"xarm7": 1000.0, "gen3": 200.0}  # The makers publish none [rad/s³].


def limits_of(arm: fp.SerialArm, name: str) -> fp.JointLimits:
    given = arm.limits
    return fp.JointLimits(
        lower=given.lower,
        upper=given.upper,
        velocity=given.velocity,
        acceleration=given.acceleration,
        jerk=np.full(arm.dof, JERKS[name]),
    )
