"""OpenSoT's inverse kinematics of a Panda: random starts and goals; levels: position of link 8, posture.

Source: github.com/ADVRHumanoids/OpenSoT (9b81dca4). Parameters: examples/cpp/panda_ik.cpp: gains 0.1 and 0.01 in a step
of 10 ms, postural reference 0, bounds on positions and velocities, success if the position error is at most 1 mm within
1000 steps. Results: docs/source/data/panda_ik_stats_2_LEVELS_*.mat: number_of_success of total_runs, and iterations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from panda_by_qp import solve as solve_by_qp

import fpbm_cpp as fp

Array = NDArray[np.float64]

PANDA = fp.SerialArm.preset("panda")
LIMITS = PANDA.limits
WITHIN = 1e-3  # [m]
SECONDS = 10.0
PUBLISHED = {  # Front end and back end: successes, runs, median of the iterations of the 30 runs that are logged.
    "iHQP, OSQP": (34, 42, 87.5),
    "iHQP, eiQuadProg": (36, 42, 87.5),
    "iHQP, proxQP": (39, 42, 92.5),
    "iHQP, qpOASES": (38, 42, 87.5),
    "iHQP, qpSWIFT": (35, 42, 99.5),
    "nHQP, OSQP, eiQuadProg, qpOASES": (30, 35, 99.0),
    "nHQP, proxQP": (30, 35, 89.5),
    "nHQP, qpSWIFT": (30, 35, 101.5),
    "HCOD": (30, 33, 84.5),
}


class Found(NamedTuple):
    q: Array  # (steps + 1, 7)
    scales: Array  # (steps, levels); empty for the QP.
    dt: float
    solved: bool

    @property
    def time(self) -> float:
        return (len(self.q) - 1) * self.dt


def problem(number: int) -> tuple[Array, Array]:
    """A start and the position of a goal."""
    rng = np.random.default_rng([8, number])
    start, goal = rng.uniform(LIMITS.lower, LIMITS.upper, (2, 7))
    return start, PANDA.forward(goal)[:3, 3]


def solve(start: Array, goal: Array, scheme: fp.Scheme, limits: fp.JointLimits, dt: float, error_bound: float) -> Found:
    """At acceleration level, the gains give critical damping: k1 = 2 k, k2 = k^2."""
    tip = fp.PositionTask(name="tip", k=10, k1=20, k2=100)
    posture = fp.PostureTask(np.zeros(7), name="posture", k=1, k1=2, k2=1)
    stack = fp.Stack(tip, posture)
    tracker = fp.Tracker(PANDA, scheme, start, stack=stack, limits=limits, dt=dt, error_bound=error_bound)
    q, solved = [start], False
    scales: list[Array] = []
    while len(scales) * dt < SECONDS and not solved:
        tick = tracker.tick({"tip": goal})
        q.append(tick.q)
        assert tick.scales is not None
        scales.append(tick.scales)
        solved = bool(np.linalg.norm(PANDA.forward(tick.q)[:3, 3] - goal) <= WITHIN)
    return Found(np.array(q), np.array(scales), dt, solved)


def by_velocity(start: Array, goal: Array) -> Found:
    """OpenSoT's gains, bounds and step; the feedback has no bound on the error."""
    limits = fp.JointLimits(
        lower=LIMITS.lower, upper=LIMITS.upper, velocity=LIMITS.velocity, acceleration=np.full(7, np.inf)
    )
    return solve(start, goal, fp.MVN(), limits, 0.01, 1e3)


def by_acceleration(start: Array, goal: Array) -> Found:
    """Within the maker's bounds on acceleration and jerk, 1 kHz, with the Tracker's defaults."""
    return solve(start, goal, fp.Balanced(0.0, np.ones(7)), LIMITS, 1e-3, 0.1)


def by_qp(start: Array, goal: Array) -> Found:
    q, solved = solve_by_qp(PANDA, LIMITS, start, goal, WITHIN, round(SECONDS / 0.01), 0.01)
    return Found(q, np.zeros((0, 2)), 0.01, solved)


METHODS: dict[str, Callable[[Array, Array], Found]] = {
    "`Tracker`, velocity level, 10 ms": by_velocity,
    "`Tracker`, acceleration level, 1 ms": by_acceleration,
    "OpenSoT's law by SciPy, 10 ms": by_qp,
}


def excess(found: Found, level: int) -> float:
    """Largest excess over a bound, by differences of q: positions [rad], otherwise relative to the bound."""
    if level == 0:
        return float(np.maximum(LIMITS.lower - found.q, found.q - LIMITS.upper).max())
    if len(found.q) <= level:
        return -1.0
    bound = LIMITS.velocity if level == 1 else LIMITS.acceleration
    return float((np.abs(np.diff(found.q, level, axis=0)) / found.dt**level / bound).max() - 1)


def off_line(found: Found) -> float:
    """Largest distance of the tip from the straight line between start and end, relative to its length."""
    p = np.array([PANDA.forward(q)[:3, 3] for q in found.q[:: max(1, len(found.q) // 100)]])
    line = (p[-1] - p[0]) / np.linalg.norm(p[-1] - p[0])
    return float(np.linalg.norm(np.cross(p - p[0], line), axis=1).max() / np.linalg.norm(p[-1] - p[0]))


class Row(NamedTuple):
    method: str
    solved: NDArray[np.bool_]
    times: Array  # Times of the solved problems [s].
    text: str


def rows(problems: int) -> Iterator[Row]:
    for method, solver in METHODS.items():
        solved, times, lines, beyond, scales = [], [], [], np.full(3, -np.inf), []
        for i in range(problems):
            found = solver(*problem(i))
            solved.append(found.solved)
            beyond = np.maximum(beyond, [excess(found, level) for level in range(3)])
            if found.solved:
                times.append(found.time)
                if len(found.q) > 2:
                    lines.append(off_line(found))
                if len(found.scales):
                    scales.append(found.scales.mean(axis=0))
        if method != "`Tracker`, acceleration level, 1 ms":
            beyond[2] = np.nan  # No bound on acceleration.
        median, most = np.median(times), np.max(times)
        mean = ", ".join(f"{x:.3f}" for x in np.mean(scales, axis=0)) if scales else ""
        cells = " | ".join("" if np.isnan(x) else "none" if x <= 0 else f"{x:.1e}" for x in beyond)
        numbers = f"{np.mean(solved):.1%} | {median:.2f} | {most:.2f} | {np.median(lines):.3f} | {mean} | {cells}"
        yield Row(method, np.array(solved), np.array(times), f"| {method} | {numbers} |")


def published() -> Iterator[str]:
    yield "| OpenSoT, two levels | successes | runs | success rate | median time [s] |"
    yield "|---|---:|---:|---:|---:|"
    for name, (successes, runs, iterations) in PUBLISHED.items():
        yield f"| {name} | {successes} | {runs} | {successes / runs:.1%} | {iterations * 0.01:.3f} |"
