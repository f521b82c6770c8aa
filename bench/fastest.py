"""Motions in the least time on random paths: `python bench/fastest.py [--count 30]` prints tables.

For each preset arm, the paths are splines through 4 to 8 random points from random postures, under MVN with a constant
orientation (position tasks with 6 joints). Paths that leave the workspace or the range of a joint are drawn again.

1. Kept: largest ratios of velocities, accelerations and jerks, by differences at 1 kHz, to their bounds, largest
   distance from the path, and processor time of fp.fastest() per second of motion.
2. TOPP-RA (`pip install toppra`) on the same joint paths and bounds: without bounds on jerk, and the duration with
   bounds on jerk relative to the duration of TOPP-RA, which has no bounds on jerk.
3. Trackers with keep_path, on paths that last half of the least duration: the largest errors.
4. Weights: the duration under WMVN with the weights 1/A^2, A the bounds on acceleration, relative to MVN.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import defaultdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

import fpbm_cpp as fp

ARMS = ("panda", "fr3", "iiwa14", "gen3", "ur5e", "xarm7")
JERK = {"iiwa14": 500.0, "gen3": 200.0, "ur5e": 200.0, "xarm7": 1000.0}  # Arms whose makers publish no bound [rad/s^3].
DT = 1e-3

Array = NDArray[np.float64]


def limits_of(arm: fp.SerialArm, name: str, jerk: bool) -> fp.JointLimits:
    given = arm.limits
    most = np.full(arm.dof, JERK[name]) if name in JERK else given.jerk
    return fp.JointLimits(
        lower=given.lower,
        upper=given.upper,
        velocity=given.velocity,
        acceleration=given.acceleration,
        jerk=most if jerk else np.full(arm.dof, np.inf),
    )


def random_run(arm: fp.SerialArm, limits: fp.JointLimits, random: np.random.Generator) -> tuple[fp.Run, float]:
    """A motion along a random path, and the processor time of fp.fastest() [s]."""
    low, high = np.maximum(limits.lower, -2.8), np.minimum(limits.upper, 2.8)
    while True:
        q0 = low + (high - low) * random.uniform(0.2, 0.8, arm.dof)
        steps = random.normal(0.0, 0.08, (random.integers(3, 8), 3))
        path = fp.Waypoints(np.vstack([np.zeros(3), np.cumsum(steps, axis=0)]), duration=1.0)
        begin = time.process_time()
        try:
            run = fp.fastest(arm, path, fp.MVN(), q0, dt=DT, task="pose" if arm.dof > 6 else "position", limits=limits)
        except fp.ParameterError:
            continue
        return run, time.process_time() - begin


def ratios(run: fp.Run) -> list[float]:
    """Largest ratios of velocities, accelerations and jerks to their bounds, from rest to rest."""
    q = np.vstack([run.q[:1]] * 3 + [run.q] + [run.q[-1:]] * 3)
    bounds = (run.limits.velocity, run.limits.acceleration, run.limits.jerk)
    return [float(np.max(np.abs(np.diff(q, k, axis=0)) / DT**k / bound)) for k, bound in enumerate(bounds, 1)]


def toppra_duration(run: fp.Run) -> float:
    """Duration of TOPP-RA along the joint path of a run, within its bounds on velocity and acceleration [s]."""
    import toppra
    from toppra.algorithm import TOPPRA
    from toppra.constraint import JointAccelerationConstraint, JointVelocityConstraint

    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(run.q, axis=0), axis=1))])
    even = np.linspace(0.0, length[-1], 601)
    nodes = np.array([np.interp(even, length, q) for q in run.q.T]).T
    path = toppra.SplineInterpolator(even, nodes)
    velocity, acceleration = run.limits.velocity, run.limits.acceleration
    bounds = [
        JointVelocityConstraint(np.stack([-velocity, velocity], axis=1)),
        JointAccelerationConstraint(np.stack([-acceleration, acceleration], axis=1)),
    ]
    solver = TOPPRA(bounds, path, gridpoints=even, solver_wrapper="seidel")
    solver.compute_parameterization(0.0, 0.0)
    sd = solver.problem_data.sd_vec
    return float(np.sum(2.0 * np.diff(even) / (sd[1:] + sd[:-1])))


def duration_with_weights(run: fp.Run, weights: Array) -> float:
    """Duration of the motion under WMVN [s]; NaN if WMVN does not follow the path within the ranges."""
    try:
        again = fp.fastest(
            run.arm, run.path, fp.WMVN(weights / weights.min()), run.q0, dt=DT, task=run.task, limits=run.limits
        )
    except fp.ParameterError:
        return float("nan")
    return float(again.t[-1])


def error_of_tracker(run: fp.Run) -> float:
    """Largest error [m, rad] of a tracker that keeps the path, which lasts half of the least duration."""
    assert isinstance(run.path, fp.Waypoints)
    path = fp.Waypoints(run.path.points, duration=float(run.t[-1]) / 2)
    kept = fp.track(run.arm, path, fp.MVN(k=5.0), run.q0, task=run.task, limits=run.limits, keep_path=True)
    return float(np.abs(kept.error).max())


def print_table(headings: list[str], rows: list[list[Any]]) -> None:
    print("| " + " | ".join(headings) + " |\n|" + "---|" * len(headings))
    for row in rows:
        print("| " + " | ".join(str(each) for each in row) + " |")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=30, help="paths for each arm")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    worst: dict[str, list[list[float]]] = defaultdict(list)
    against: dict[str, list[list[float]]] = defaultdict(list)
    tracked: list[float] = []
    for name in ARMS:
        random = np.random.default_rng(given.seed)
        arm = fp.SerialArm.preset(name)
        bounded, free = limits_of(arm, name, True), limits_of(arm, name, False)
        for _ in range(given.count):
            run, seconds = random_run(arm, bounded, random)
            worst[name].append([*ratios(run), np.abs(run.error).max(), 1e3 * seconds, run.t[-1]])
            loose = fp.fastest(arm, run.path, run.scheme, run.q0, dt=DT, task=run.task, limits=free)
            reference = toppra_duration(loose)
            tracked.append(error_of_tracker(run))
            weighted = duration_with_weights(run, 1.0 / bounded.acceleration**2)
            against[name].append([loose.t[-1] / reference, run.t[-1] / reference, weighted / run.t[-1]])
    rows = []
    for name, found in worst.items():
        v, a, j, off, ms, duration = np.array(found).T
        kept = (f"{each.max():.9f}" for each in (v, a, j))
        times = f"{np.median(ms):.0f}, {ms.max():.0f}"
        rows.append([name, *kept, f"{off.max():.1e}", times, f"{duration.mean():.2f}"])
    head = ["arm", "velocity", "acceleration", "jerk", "off the path [m, rad]", "planning: median, longest [ms]"]
    print_table([*head, "mean duration [s]"], rows)
    print()
    rows = []
    for name, pairs in against.items():
        *peers, weighted = np.array(pairs).T
        rows.append([name, *(f"{np.median(x):.3f}, {x.max():.3f}" for x in peers), f"{np.nanmedian(weighted):.3f}"])
    head = ["arm", "without jerk bounds / TOPP-RA: median, largest", "with jerk bounds / TOPP-RA without"]
    print_table([*head, "weights / MVN: median"], rows)
    errors = np.array(tracked)
    inside = np.count_nonzero(errors < 1e-5)
    print(f"\ntrackers with keep_path: {inside} of {len(errors)} within 1e-5 m and rad, largest {errors.max():.1e}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
