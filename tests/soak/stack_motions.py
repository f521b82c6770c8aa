"""Random motions of random stacks, on all cores: bounds by finite differences of q, and rest.

    python tests/soak/stack_motions.py [--motions 10000] [--rests 1000] [--seed 0]

A motion has targets that jump, conflict and are unreachable, on one to four levels that are switched and reordered
meanwhile; at its end stop() brings the arm to rest. A rest has targets that do not change for 40 s. Fails if a motion
exceeds a bound by more than 1e-9 or does not stop, or if more than 1 % of the rests move after 40 s. Third differences
of q are printed only: round-off dominates them. The jerk is checked by second differences of commanded velocities.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from multiprocessing import Pool
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import fpbm_cpp as fp

Array = NDArray[np.float64]
DT = 1e-3
PRESETS = ("panda", "fr3", "iiwa14", "gen3", "ur5e", "ur10e")
AXES = ("x", "y", "z", "rx", "ry", "rz")


class Start(NamedTuple):
    arm: fp.SerialArm | fp.PlanarArm
    limits: fp.JointLimits
    stack: fp.Stack
    tracker: fp.Tracker


def arm_and_limits(rng: np.random.Generator) -> tuple[fp.SerialArm | fp.PlanarArm, fp.JointLimits]:
    """A preset, or a planar arm of 3 to 7 links; half of all have bounds on jerk."""
    kind = rng.integers(len(PRESETS) + 1)
    if kind == len(PRESETS):
        n = int(rng.integers(3, 8))
        arm: fp.SerialArm | fp.PlanarArm = fp.PlanarArm(rng.uniform(0.15, 0.4, n))
        lower, upper = -rng.uniform(1, 3, n), rng.uniform(1, 3, n)
        velocity, acceleration = rng.uniform(1, 4, n), rng.uniform(5, 20, n)
    else:
        arm = fp.SerialArm.preset(PRESETS[kind])
        given = arm.limits
        lower, upper = given.lower.clip(-3), given.upper.clip(max=3)
        velocity, acceleration = given.velocity.clip(max=3), given.acceleration.clip(max=20)
    jerk = acceleration * rng.uniform(30, 300) if rng.random() < 0.5 else None
    return arm, fp.JointLimits(lower=lower, upper=upper, velocity=velocity, acceleration=acceleration, jerk=jerk)


def some(rng: np.random.Generator, rows: tuple[str, ...]) -> list[str]:
    """At least one of these rows."""
    return [str(row) for row in rng.choice(rows, rng.integers(1, len(rows) + 1), replace=False)]


def frame_task(rng: np.random.Generator, frames: list[str], planar: bool, name: str) -> Any:
    frame = str(rng.choice(frames))
    axes = str(rng.choice(["base", "frame"]))
    if planar:
        return fp.PositionTask(frame, rows=some(rng, AXES[:2]), name=name)
    kind = rng.integers(4)
    if kind == 0:
        return fp.AxisTask(frame, rng.normal(size=3), name=name)
    if kind == 1:
        return fp.PositionTask(frame, rows=some(rng, AXES[:3]), axes=axes, name=name)
    if kind == 2:
        return fp.OrientationTask(frame, rows=some(rng, AXES[3:]), axes=axes, name=name)
    return fp.PoseTask(frame, rows=some(rng, AXES), axes=axes, name=name)


def random_stack(rng: np.random.Generator, arm: fp.SerialArm | fp.PlanarArm) -> fp.Stack:
    """One to four levels with at most as many rows as the arm has joints; two of three end with a posture."""
    planar = isinstance(arm, fp.PlanarArm)
    frames = ["tip", *arm.joint_names[1:]]
    levels: list[list[Any]] = []
    for k in range(rng.integers(1, 5)):
        tasks = [frame_task(rng, frames, planar, f"{k}.{i}") for i in range(1 if planar else rng.integers(1, 3))]
        levels.append(tasks if sum(rows(task) for task in tasks) <= arm.dof else tasks[:1])
    if len(levels) > 1 and rng.random() < 0.67:
        levels[-1] = [fp.PostureTask()]
    return fp.Stack(*levels)


def rows(task: Any) -> int:
    return 2 if isinstance(task, fp.AxisTask) else len(task.rows)


def start(rng: np.random.Generator) -> Start:
    """Start of a motion: in a third of the motions, a joint is on its bound."""
    arm, limits = arm_and_limits(rng)
    q0 = limits.lower + rng.uniform(0.15, 0.85, arm.dof) * (limits.upper - limits.lower)
    if rng.random() < 1 / 3:
        i = rng.integers(arm.dof)
        q0[i] = limits.upper[i]
    stack = random_stack(rng, arm)
    weights = rng.uniform(0.5, 4.0, arm.dof)
    scheme = fp.Balanced(rng.uniform(), weights, null_damping=2) if rng.random() < 0.5 else fp.WMVN(weights)
    return Start(arm, limits, stack, fp.Tracker(arm, scheme, q0, stack=stack, limits=limits))


def targets(rng: np.random.Generator, begun: Start, size: float) -> dict[str, Any]:
    found: dict[str, Any] = {}
    in_plane = (1, 1, 0) if isinstance(begun.arm, fp.PlanarArm) else (1, 1, 1)
    for task, x in zip(begun.stack.tasks, begun.tracker.tip.values(), strict=True):
        by = rng.uniform(-size, size, 3) * in_plane
        if isinstance(task, fp.PositionTask):
            found[task.name] = x + by
        elif isinstance(task, fp.AxisTask):
            found[task.name] = rng.normal(size=3)
        elif isinstance(task, fp.OrientationTask):
            found[task.name] = x @ fp.rotation(by)
        elif isinstance(task, fp.PoseTask):
            found[task.name] = np.array(x)
            found[task.name][:3, :3] = x[:3, :3] @ fp.rotation(rng.uniform(-size, size, 3))
            found[task.name][:3, 3] += by
        else:
            found[task.name] = x + rng.uniform(-size, size, begun.arm.dof)
    return found


def excess(limits: fp.JointLimits, q: Array, qd: Array) -> list[float]:
    """Largest excess over the bounds: positions [rad]; velocities, accelerations and jerks as shares.

    All are differences of q. Accelerations and jerks are also differences of the commanded velocities, which lose fewer
    digits.
    """
    by_q = [np.diff(q, k, axis=0) / DT**k for k in (1, 2, 3)]
    by_qd = [np.diff(qd, k, axis=0) / DT**k for k in (1, 2)]
    bounds = [limits.velocity, limits.acceleration, limits.jerk]
    shares = [
        float((np.abs(found) / bound).max() - 1) for found, bound in zip(by_q + by_qd, bounds + bounds[1:], strict=True)
    ]
    return [float(max((limits.lower - q).max(), (q - limits.upper).max())), *shares]


def motion(seed: int) -> tuple[list[float], float, bool]:
    """Excess over the bounds, the speed after stop(), and whether the stack has several levels."""
    rng = np.random.default_rng(seed)
    begun = start(rng)
    tracker, levels = begun.tracker, len(begun.stack.levels)
    on = [True] * levels
    q, qd = [tracker.q, tracker.q], [np.zeros(begun.arm.dof)] * 3
    for _ in range(6):
        if levels > 1:
            level = int(rng.integers(1, levels))
            on[level] = bool(rng.integers(2))
            tracker.enable(level, on[level])
            order = [int(k) for k in rng.permutation(levels)]
            if on[order[0]] and rng.random() < 0.5:
                tracker.reorder(order)
                on = [on[k] for k in order]
        references = targets(rng, begun, rng.uniform(0.1, 1.5))
        for _ in range(int(rng.integers(150, 600))):
            tick = tracker.tick(references)
            q.append(tick.q)
            qd.append(tick.qd)
            references = {}
    tracker.stop()
    for _ in range(3000):
        tick = tracker.tick({})
        q.append(tick.q)
        qd.append(tick.qd)
    return excess(begun.limits, np.array([q[0], *q]), np.array(qd)), float(np.abs(tick.qd).max()), levels > 1


def rest(seed: int) -> float:
    """Largest speed in the last of 40 s [rad/s]."""
    rng = np.random.default_rng(seed)
    begun = start(rng)
    references = targets(rng, begun, 1.2)
    speed = 0.0
    for k in range(40000):
        tick = begun.tracker.tick(references)
        references = {}
        if k >= 39000:
            speed = max(speed, float(np.abs(tick.qd).max()))
    return speed


def run(pool: Any, work: Callable[[int], Any], seeds: range, what: str) -> list[Any]:
    results = []
    for result in pool.imap(work, seeds, chunksize=5):
        results.append(result)
        if len(results) % max(len(seeds) // 20, 1) == 0:
            print(f"{len(results)} of {len(seeds)} {what}", file=sys.stderr, flush=True)
    return results


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--motions", type=int, default=10000)
    parser.add_argument("--rests", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    sound = True
    with Pool() as pool:
        if given.motions:
            found = run(pool, motion, range(given.seed, given.seed + given.motions), "motions")
            for several, stacks in ((True, "several levels"), (False, "one level")):
                mine = [(k, each) for k, (each, _, levels) in enumerate(found) if levels == several]
                print(f"{len(mine)} motions of {stacks}, largest excess (shares of the bounds, but for q):")
                for what, name in enumerate(("q [rad]", "Δq", "Δ²q", "Δ³q", "Δq̇", "Δ²q̇")):
                    value, k = max((each[what], k) for k, each in mine)
                    print(f"  {name}: {value:.1e} (seed {given.seed + k})")
                    sound &= value < 1e-9 or name == "Δ³q"
            moving = [given.seed + k for k, (_, speed, _) in enumerate(found) if speed > 1e-9]
            print(f"not at rest 3 s after stop(): {len(moving)} {moving[:10]}")
            sound &= not moving
        if given.rests:
            speeds = np.array(run(pool, rest, range(given.seed, given.seed + given.rests), "rests"))
            moving = [given.seed + int(k) for k in np.flatnonzero(speeds > 1e-3)]
            print(f"{given.rests} rests: {len(moving)} faster than 1e-3 rad/s after 40 s {moving}")
            sound &= len(moving) <= 0.01 * given.rests
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
