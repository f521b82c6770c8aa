"""A planar arm of four links whose tip cycles twice through a hexagon.

Source: github.com/ValerioSpagnoli/Multi-task-SNS-at-velocity-and-acceleration-level (c0a3701). Parameters:
Robot/Planar4R, Simulation/Simulations/Simulation_Planar4R.m. Results: Simulation/Results/Planar4R/*/Plots/table.png.
"""

from __future__ import annotations

import numpy as np
from compare import Case
from lower_levels import Damping, FirstLink
from pointing import Scene

import fpbm_cpp as fp

CORNERS = np.array([[0, 0.2], [0.1732, 0.1], [0.1732, -0.1], [0, -0.2], [-0.1732, -0.1], [-0.1732, 0.1]])
CENTRE = np.array([0.7, 0.0, 0.0])
SCENE = Scene(
    table=np.tile([0.25, 0.0, 0.0, 0.0], (4, 1)),
    limits=fp.JointLimits(
        lower=np.full(4, -2 * np.pi), upper=np.full(4, 2 * np.pi), velocity=[2, 2, 4, 4], acceleration=[2, 2, 4, 4]
    ),
    q0=np.array([0, np.pi / 2, -np.pi / 2, np.pi / 2]),
    vertices=CENTRE + np.pad(np.vstack([CORNERS, CORNERS, CORNERS[:1]]), ((0, 0), (0, 1))),
    kp=2.0,
    kd=0.05,
    rows=("x", "y"),
)
LINK, DAMPING = FirstLink(SCENE, np.array([0.25, 0, 0])), Damping()
INNER = 1  # The frame at the end of the first link.
CASES = (
    Case("tip", (), {"time": 27.211, "direction": 0.0073, "speed": 0.0563, "place": (0.2127, 0.0459)}),
    Case("tip / link 1", (LINK,), {"time": 26.254, "direction": 0.0212, "speed": 0.0108, "place": (0.2499, 7.7711e-4)}),
    Case(
        "tip / damping", (DAMPING,), {"time": 27.43, "direction": 0.0095, "speed": 0.0242, "place": (0.2406, -0.0012)}
    ),
    Case("tip / link 1 / damping", (LINK, DAMPING), None),
)
