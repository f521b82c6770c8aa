"""The hexagon of Flacco, De Luca and Khatib (IROS 2012) with the KUKA LWR 4 of lwr_segment.py.

The paper gives centre, radius, start, gains and bounds, but not the lengths of the model. With the lengths of
lwr_segment.py, one vertex is unreachable within the joint ranges. Therefore, table I of the paper cannot be compared.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from lwr_segment import LIMITS, Q0, TABLE
from pointing import Array, Scene, pursue
from resolved import by_saturate, by_tracker

CENTRE, RADIUS = np.array([0.1, 0.35, 0.6235]), 0.2  # [m]
STARTS, ROUNDS = 40, 300
SECONDS = 10.0


def vertices() -> Array:
    angles = np.pi / 2 - np.arange(13) * np.pi / 3
    return CENTRE + RADIUS * np.column_stack([np.zeros(13), np.cos(angles), np.sin(angles)])


SCENE = Scene(TABLE, LIMITS, Q0, vertices(), kp=10.0, kd=0.1)


def least_distance(point: Array) -> float:
    """Smallest distance of the tip from a point [m]: damped least squares, then gradient steps, from random starts."""
    arm, rng, least = SCENE.arm, np.random.default_rng(0), np.inf
    for _ in range(STARTS):
        q = rng.uniform(LIMITS.lower, LIMITS.upper)
        for i in range(ROUNDS):
            error, J = point - arm.forward(q)[:3, 3], arm.jacobian(q)
            change = J.T @ np.linalg.solve(J @ J.T + 1e-3 * np.eye(3), error) if i < ROUNDS // 2 else 2 * J.T @ error
            q = np.clip(q + change, LIMITS.lower, LIMITS.upper)
        least = min(least, float(np.linalg.norm(point - arm.forward(q)[:3, 3])))
    return least


def run() -> Iterator[str]:
    yield "| vertex [m] | least distance of the tip within the joints' ranges [mm] |"
    yield "|---|---:|"
    for point in SCENE.vertices[:6]:
        yield f"| {', '.join(f'{x:.4f}' for x in point)} | {1e3 * least_distance(point):.2f} |"
    yield ""
    yield f"Vertices reached within {SECONDS:.0f} s, of 13:"
    for name, step in (("`Tracker`, k1 = 1/T", by_tracker(SCENE, (), 1e3)), ("`fp.saturate`", by_saturate(SCENE, ()))):
        yield f"- {name}: {pursue(SCENE, step, SECONDS).reached}"


if __name__ == "__main__":
    print(*run(), sep="\n")
