"""Another library and fpbm_cpp with the same stack of tasks, in a separate process (bench/stack_peers.py).

Each library moves its own Panda, tick by tick, with alternating calls. Prints JSON.
"""

from __future__ import annotations

import gc
import json
import sys
import time
from typing import Any, NamedTuple

import numpy as np
from stack_solvers import DT, GAIN, PEERS, POSTURE_GAIN, START, Array, Options, Panda, Solver, Targets, ours, panda

import fpbm_cpp as fp

TICKS = 20_000
BLOCK = 100  # Number of ticks for a ratio of times.
TOLERANCE = 5e-3  # Relative tolerance of the tip motion in a tick: other libraries move the tip along the tangent.


class Reference(NamedTuple):
    """Point, velocity and acceleration of the tip and of the elbow."""

    tip: Array
    twist: Array
    change: Array
    elbow: Array
    speed: Array
    gain: Array

    def of_tracker(self) -> dict[str, tuple[Array, Array, Array]]:
        return {"tip": (self.tip, self.twist, self.change), "elbow": (self.elbow, self.speed, self.gain)}


class Path:
    """Path of the tip: slow, then faster than the joints, then slow near the base, then slow again. The target jumps by
    5 cm every 1.5 s."""

    def __init__(self, arm: fp.SerialArm) -> None:
        self.start = np.asarray(arm.forward(START))
        self.elbow = elbow(arm, START)

    def __call__(self, t: float) -> Reference:
        rate = 3.0 if 5.0 < t < 10.0 else 1.0
        tip, twist, change = self.start.copy(), np.zeros(6), np.zeros(6)
        for i, (size, turns) in enumerate(((0.12, 0.9), (0.30, 0.7), (0.12, 1.3))):
            tip[i, 3] += size * np.sin(turns * rate * t)
            twist[i] = size * turns * rate * np.cos(turns * rate * t)
            change[i] = -size * (turns * rate) ** 2 * np.sin(turns * rate * t)
        tip[1, 3] += 0.05 if t % 3.0 > 1.5 else 0.0
        tip[0, 3] -= 0.25 if 10.0 < t < 15.0 else 0.0
        axis, turns = np.array([0.6, 0.8, 0.0]), 1.1 * rate
        tip[:3, :3] = fp.rotation(0.4 * np.sin(turns * t) * axis) @ tip[:3, :3]
        twist[3:] = 0.4 * turns * np.cos(turns * t) * axis
        change[3:] = -0.4 * turns**2 * np.sin(turns * t) * axis
        up = np.array([0.0, 0.0, 1.0])
        place = self.elbow + (0.04 * np.sin(0.5 * t) - 0.06) * up
        return Reference(tip, twist, change, place, 0.02 * np.cos(0.5 * t) * up, -0.01 * np.sin(0.5 * t) * up)


def elbow(arm: fp.SerialArm, q: Array) -> Array:
    pose = np.eye(4)
    for joint, angle in zip(arm.joints[:4], q[:4], strict=True):
        pose = pose @ np.asarray(joint.placement)
        pose[:3, :3] = pose[:3, :3] @ fp.rotation(np.array([0.0, 0.0, angle]))
    return pose[:3, 3]


def log(R: Array) -> Array:
    """Rotation vector of a rotation by less than half a turn."""
    axis = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
    sine = np.linalg.norm(axis)
    angle = np.arctan2(sine, (np.trace(R) - 1) / 2)
    return axis if sine < 1e-9 else axis * (angle / sine)


def difference(x: Array, y: Array) -> Array:
    return np.concatenate([x[:3, 3] - y[:3, 3], log(x[:3, :3] @ y[:3, :3].T)])


def displaced(pose: Array, change: Array) -> Array:
    result = pose.copy()
    result[:3, 3] += change[:3]
    result[:3, :3] = fp.rotation(change[3:]) @ pose[:3, :3]
    return result


def ahead(arm: fp.SerialArm, q: Array, now: Reference, after: Reference) -> Targets:
    """Targets after a tick of this library's law from q: errors decay with the gains, and references advance."""
    decay, slow = 1 - np.exp(-GAIN * DT), 1 - np.exp(-POSTURE_GAIN * DT)
    pose, place = np.asarray(arm.forward(q)), elbow(arm, q)
    change = decay * difference(now.tip, pose) + DT * now.twist
    step = decay * (now.elbow - place) + (after.elbow - now.elbow)
    return Targets(displaced(pose, change), place + step, q + slow * (START - q))


class Motion:
    """The motion of a Panda with a solver."""

    def __init__(self, robot: Panda) -> None:
        self.robot = robot
        self.q: list[Array] = [START]
        self.times: list[float] = []
        self.failed = 0

    def summary(self, path: Path) -> dict[str, Any]:
        q, limits = np.array(self.q), self.robot.limits
        qd = np.diff(q, axis=0, prepend=q[:1]) / DT
        qdd = np.diff(qd, axis=0) / DT
        tips = [np.asarray(self.robot.arm.forward(each)) for each in q]
        errors = np.array([difference(path(DT * k).tip, tip) for k, tip in enumerate(tips)])
        slow = int(4.9 / DT)
        return {
            "position": float(max((q - limits.upper).max(), (limits.lower - q).max(), 0.0)),
            "velocity": float(max((np.abs(qd) - limits.velocity).max(), 0.0)),
            "acceleration": float(max((np.abs(qdd) / limits.acceleration).max(), 0.0)),
            "over": int((np.abs(qdd) > np.asarray(limits.acceleration) + 1e-6).any(axis=1).sum()),
            "error": float(np.sqrt((errors[:, :3] ** 2).sum(axis=1).mean())),
            "rotation": float(np.sqrt((errors[:, 3:] ** 2).sum(axis=1).mean())),
            "slow": float(np.median(np.linalg.norm(errors[1000:slow, :3], axis=1))),
            "end": float(np.linalg.norm(errors[-1, :3])),
            "failed": self.failed,
            "p50": float(np.percentile(self.times, 50)),
            "p99.9": float(np.percentile(self.times, 99.9)),
            "least": float(blocks(self.times).min()),
        }


def blocks(times: list[float]) -> Array:
    return np.array(times).reshape(-1, BLOCK).mean(axis=1)


def run(robot: Panda, solver: Solver) -> tuple[list[dict[str, Any]], list[float]]:
    """Results of another library and of this library at both levels, and the ratios of times (other / this library)."""
    path = Path(robot.arm)
    trackers = [ours(robot, "velocity"), ours(robot, "acceleration")]
    motions = [Motion(robot) for _ in range(3)]
    limited = [0, 0]
    gc.disable()
    for k in range(TICKS):
        now = path(DT * k)
        targets = ahead(robot.arm, motions[0].q[-1], now, path(DT * (k + 1)))
        begin = time.perf_counter_ns()
        q, found = solver.step(targets)
        motions[0].times.append((time.perf_counter_ns() - begin) / 1e3)
        motions[0].q.append(np.array(q))
        motions[0].failed += not found
        for i, tracker in enumerate(trackers):
            references = now.of_tracker()
            begin = time.perf_counter_ns()
            tick = tracker.tick(references)
            motions[i + 1].times.append((time.perf_counter_ns() - begin) / 1e3)
            motions[i + 1].q.append(np.array(tick.q))
            limited[i] += bool(tick.scales[0] < 1)
    gc.enable()
    found = [motion.summary(path) for motion in motions]
    for each, count in zip(found[1:], limited, strict=True):
        each["slowed"] = count
    ratios = [float(np.median(blocks(motions[0].times) / blocks(motion.times))) for motion in motions[1:]]
    return found, ratios


def agreement(robot: Panda, name: str, options: Options) -> float:
    """Largest relative difference of the tip motion from fpbm_cpp in a tick without active bounds."""
    solver, path, worst = PEERS[name].make(robot, options), Path(robot.arm), 0.0
    tracker = ours(robot, "velocity")
    q = START
    for k in range(int(4.9 / DT)):
        now = path(DT * k)
        tick = tracker.tick(now.of_tracker())
        if k % 7 == 0 and min(tick.scales) == 1 and tick.status == fp.Status.OK:
            solver.reset(q)
            found = solver.step(ahead(robot.arm, q, now, path(DT * (k + 1))))[0]
            before, expected, tip = (np.asarray(robot.arm.forward(each)) for each in (q, tick.q, np.array(found)))
            change = np.linalg.norm(difference(expected, before))
            worst = max(worst, float(np.linalg.norm(difference(tip, expected)) / change))
        q = np.array(tick.q)
    return worst


def main() -> None:
    name = sys.argv[1]
    robot = panda()
    alone = agreement(robot, name, Options(lower=False, limits=False))
    whole = agreement(robot, name, Options(limits=False))
    if not alone < TOLERANCE:
        raise SystemExit(f"{name}: the motion of the tip differs by {alone:.1e}")
    solver = PEERS[name].make(robot, Options())
    rows, ratios = run(robot, solver)
    result = {"alone": alone, "whole": whole, "acceleration": solver.acceleration, "rows": rows, "ratios": ratios}
    print(json.dumps(result))


if __name__ == "__main__":
    main()
