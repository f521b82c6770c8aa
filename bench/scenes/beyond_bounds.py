"""A planar arm whose bounds on acceleration are too small for the desired change of the tip velocity.

Prints the angle between the tip acceleration by a Tracker and the velocity error, the task scale of the Tracker, and
the task scale of SNS in the same state, by fp.saturate. With SNS, the angle is 0.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from measures import angle
from planar_hexagon import SCENE
from pointing import DT, Array
from resolved import by_saturate

import fpbm_cpp as fp

GAINS = (3.0, 10.0, 30.0, 100.0, 300.0, 1000.0)  # k1 [1/s]
SHARES = (0.0, 0.1, 0.3, 0.6)  # Start velocities of the tip, as fractions of the desired velocity.
TICKS = (0, 5, 20, 60, 100)
DESIRED = np.array([0.4, -0.6, 0.0])  # [m/s], toward the first vertex.
ARM = SCENE.arm


def tracker(k1: float, qd0: Array) -> fp.Tracker:
    stack = fp.Stack(fp.PositionTask(name="tip", rows=SCENE.rows, k1=k1, k2=0))
    scheme = fp.Balanced(0.0, np.ones(4))
    return fp.Tracker(ARM, scheme, SCENE.q0, qd0=qd0, stack=stack, limits=SCENE.limits, dt=DT, null_damping=0)


def one_tick(tracker: fp.Tracker, k1: float) -> str:
    q, qd = tracker.q, tracker.qd
    velocity = ARM.jacobian(q) @ qd
    missing = DESIRED - velocity
    sns = by_saturate(SCENE, ())(q, qd, velocity + k1 * DT * missing)[2][0]
    tick = tracker.tick({"tip": (tracker.tip["tip"], DESIRED)})
    acceleration = ARM.jacobian(q) @ (tick.qd - qd) / DT + ARM.jacobian_dot(q, qd) @ qd
    degrees = np.degrees(angle(acceleration[None], missing[None])[0])
    return f"{degrees:.1f}°, {tick.scale:.2g} (SNS {sns:.2g})"


def run() -> Iterator[str]:
    yield "| k1 [1/s] | " + " | ".join(f"{share:.0%} of the velocity" for share in SHARES) + " |"
    yield "|---:|" + "---:|" * len(SHARES)
    inverse = np.linalg.pinv(ARM.jacobian(SCENE.q0))
    for k1 in GAINS:
        cells = [one_tick(tracker(k1, inverse @ (share * DESIRED)), k1) for share in SHARES]
        yield f"| {k1:.0f} | " + " | ".join(cells) + " |"
    yield "\nOne motion from rest:\n"
    yield "| k1 [1/s] | " + " | ".join(f"tick {i}" for i in TICKS) + " |"
    yield "|---:|" + "---:|" * len(TICKS)
    for k1 in GAINS:
        moving = tracker(k1, np.zeros(4))
        cells = [one_tick(moving, k1) for _ in range(TICKS[-1] + 1)]
        yield f"| {k1:.0f} | " + " | ".join(cells[i] for i in TICKS) + " |"


if __name__ == "__main__":
    print(*run(), sep="\n")
