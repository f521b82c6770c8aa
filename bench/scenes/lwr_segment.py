"""A KUKA LWR 4 whose tip moves along a segment and back.

Source: github.com/ValerioSpagnoli/Multi-task-SNS-at-velocity-and-acceleration-level (c0a3701). Parameters:
Robot/KUKA_LWR4, Simulation/Simulations/Simulation_KUKA.m. Results: Simulation/Results/KUKA_LBR_IV/*/Plots/table.png.
"""

from __future__ import annotations

import numpy as np
from compare import Case
from lower_levels import Damping
from pointing import Scene

import fpbm_cpp as fp

TURN = np.pi / 2
TABLE = np.array(
    [
        [0, TURN, 0.3105, 0],
        [0, -TURN, 0, 0],
        [0, -TURN, 0.4, 0],
        [0, TURN, 0, 0],
        [0, TURN, 0.39, 0],
        [0, -TURN, 0, 0],
        [0, 0, 0.078, 0],
    ]
)
RANGE = np.deg2rad([170, 120, 170, 120, 170, 120, 170])
LIMITS = fp.JointLimits(
    lower=-RANGE,
    upper=RANGE,
    velocity=np.deg2rad([100, 110, 100, 130, 130, 180, 180]),
    acceleration=np.deg2rad([300] * 7),
)
Q0 = np.deg2rad([0, 45, 45, 45, 0, 0, 0])
START = Scene(TABLE, LIMITS, Q0, np.zeros((0, 3)), 0, 0).origins(Q0[None])[0, -1]
SCENE = Scene(TABLE, LIMITS, Q0, vertices=np.array([START, START + np.array([0.1, 0.3, -0.2]), START]), kp=2.0, kd=0.05)
INNER = 4  # The elbow.
CASES = (
    Case("tip", (), {"time": 4.64, "direction": 0.0012, "speed": 0.1581, "place": (-0.1817, 0.1512, 0.6)}),
    Case(
        "tip / damping",
        (Damping(),),
        {"time": 4.706, "direction": 0.0017, "speed": 0.1558, "place": (-0.3004, 0.0716, 0.5579)},
    ),
)
