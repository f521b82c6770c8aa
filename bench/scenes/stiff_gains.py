"""Gains near the tick rate in a stack of two levels: the tip is to stand still, a lower level meets its limits.

The tip's task can be done whole at every tick. The lower level is a posture whose velocity oscillates faster than the
accelerations allow. The constructor of Tracker accepts k1 up to 2.785/h.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from planar_hexagon import SCENE
from pointing import DT

import fpbm_cpp as fp

GAINS = (100.0, 500.0, 900.0, 1000.0, 1050.0, 1100.0, 1500.0, 2000.0, 2700.0)  # k1 [1/s]
TICKS = 4000


def tip_speed_and_scales(k1: float) -> tuple[float, float, float]:
    """Largest tip speed [m/s], least and mean scale of the first level, in the last second."""
    arm = SCENE.arm
    stack = fp.Stack(
        fp.PositionTask(name="tip", rows=SCENE.rows, k1=k1, k2=0), fp.PostureTask(name="posture", k1=100, k2=0)
    )
    scheme = fp.Balanced(0.0, np.ones(4))
    tracker = fp.Tracker(arm, scheme, SCENE.q0, stack=stack, limits=SCENE.limits, dt=DT, null_damping=0)
    speeds, scales = [], []
    for i in range(TICKS):
        swing = 0.5 * np.cos(40 * i * DT) * np.array([1, -1, 1, -1])
        tick = tracker.tick({"tip": (tracker.tip["tip"], np.zeros(3)), "posture": (tracker.q, swing)})
        speeds.append(np.linalg.norm(arm.jacobian(tick.q) @ tick.qd))
        scales.append(tick.scale)
    return float(np.max(speeds[-1000:])), float(np.min(scales[-1000:])), float(np.mean(scales[-1000:]))


def run() -> Iterator[str]:
    yield "| k1 h | tip speed, most [m/s] | scale of the first level: least, mean |"
    yield "|---:|---:|---:|"
    for k1 in GAINS:
        speed, least, mean = tip_speed_and_scales(k1)
        yield f"| {k1 * DT:.2f} | {speed:.1e} | {least:.3f}, {mean:.3f} |"


if __name__ == "__main__":
    print(*run(), sep="\n")
