"""The same targets for fpbm_cpp, Pink and Mink, on one Panda: `python bench/clearance.py peers`.

All libraries have the same capsules (from the URDF), pairs, margin, and bounds on joint positions and velocities, at
1000 ticks per second. In addition, fpbm_cpp keeps bounds on acceleration and jerk. Coal measures the distances of the
capsules in the motions of all libraries.

Pink and Mink have the gains of their own examples. Pink: kukas_self_collision.py, with the cost 50 of the frame, the
cost 1e-3 of the posture, the gain 20 of the barrier, and the gain 1 of the safe displacement. Mink: arm_ur5e.py, with
the cost 1, Levenberg-Marquardt damping 1, damping 1e-3, and the gain 0.85 of the limit, which includes shapes within
twice the margin. In Pink and Mink, the gain 1 of the frame requires the target within a tick. Rows with a gain of 0.02
have the gain of fpbm_cpp, 20/s. In a tick without a solution, the arm does not move.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib import metadata
from typing import NamedTuple

import numpy as np
from clearance_robots import MARGIN, Array, Robot, robot
from clearance_solvers import Mink, Pink, Scene

import fpbm_cpp as fp
from fpbm_cpp.obstacle import Obstacle

DT = 1e-3
K = 20.0
FAILED = (fp.Status.SINGULAR, fp.Status.STALLED)
READY = np.array([0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854])


class Scenario(NamedTuple):
    name: str
    obstacles: list[Obstacle]
    path: fp.Path
    hold: float
    slide: tuple[float, float] = (0.0, 0.0)  # Start and end of the motion along a wall whose normal is x [s].


class Motion(NamedTuple):
    q: Array
    tips: Array
    failed: int
    time: float  # Median processor time of a tick [µs].


# A function of x, xd and xdd for one tick. Returns the next posture, and whether the tick succeeded.
Step = Callable[[Array, Array, Array], tuple[Array, bool]]


def box(place: Array | list[float], half: list[float], name: str) -> fp.Cuboid:
    pose = np.eye(4)
    pose[:3, 3] = place
    return fp.Cuboid(pose, half, name=name)


def scenarios() -> list[Scenario]:
    down, aside, into, along = [0.15, 0.0, -0.45], [0.0, -0.15, 0.0], [0.13, 0.0, 0.0], [0.0, 0.35, 0.0]
    behind = [-0.75, 0.05, -0.25]

    def line(displacement: list[float], duration: float, back: bool = False) -> fp.Path:
        return fp.Line(-np.array(displacement) if back else displacement, duration, time_law="quintic")

    return [
        Scenario(
            "Motion into a table",
            [box([0.5, 0, 0.15], [0.3, 0.5, 0.1], "table")],
            line(down, 1.5).then(line(down, 1.5, True)),
            1.0,
        ),
        Scenario(
            "Motion along a wall",
            [box([0.55, 0, 0.5], [0.1, 0.8, 0.5], "wall")],
            line(aside, 1.0).then(line(into, 1.0)).then(line(along, 2.0)).then(line(into, 1.0, True)),
            1.0,
            slide=(2.2, 3.8),
        ),
        Scenario("Target behind the base of the arm", [], line(behind, 2.0).then(line(behind, 2.0, True)), 1.0),
    ]


def ours(scene: Scene, scheme: fp.Scheme, limits: fp.JointLimits, clearance: fp.Clearance | None) -> Step:
    tracker = fp.Tracker(scene.arm, scheme, READY, limits=limits, bounds=[clearance] if clearance else ())

    def step(x: Array, xd: Array, xdd: Array) -> tuple[Array, bool]:
        tick = tracker.tick(x, xd, xdd)
        return tick.q, tick.status not in FAILED

    return step


def moved(step: Step, arm: fp.SerialArm, scenario: Scenario) -> tuple[Motion, Array]:
    """The motion of a solver, and the reference positions of the tip."""
    start = arm.forward(READY)[:3, 3]
    ticks = round((scenario.path.duration + scenario.hold) / DT)
    q, references, times, failed = [READY], [start], [], 0
    for k in range(1, ticks + 1):
        x, xd, xdd = scenario.path.sample(min((k - 1) * DT, scenario.path.duration))
        if scenario.path.duration <= (k - 1) * DT:
            xd, xdd = 0 * xd, 0 * xdd
        begin = time.process_time_ns()
        now, found = step(start + x, xd, xdd)
        times.append((time.process_time_ns() - begin) / 1e3)
        failed += not found
        q.append(np.array(now))
        references.append(start + scenario.path.sample(min(k * DT, scenario.path.duration))[0])
    tips = np.array([arm.forward(each)[:3, 3] for each in q])
    return Motion(np.array(q), tips, failed, statistics.median(times)), np.array(references)


def row(name: str, motion: Motion, reference: Array, distances: Array, scenario: Scenario) -> list[str]:
    error = 1e3 * (reference - motion.tips)
    jerk = np.diff(motion.q, n=3, axis=0) / DT**3
    first, last = (round(t / DT) for t in scenario.slide)
    along = f"{np.sqrt((error[first:last, 1:] ** 2).sum(axis=1).mean()):.2f}" if last else ""
    return [
        name,
        f"{(distances < 0).sum()}",
        f"{1e3 * distances.min():.2f}",
        f"{np.sqrt((error**2).sum(axis=1).mean()):.1f}",
        f"{np.linalg.norm(error[-1]):.2f}",
        along,
        f"{np.sqrt((jerk**2).mean()):.0f}",
        f"{np.abs(np.diff(motion.q, n=2, axis=0)).max() / DT**2:.0f}",
        f"{motion.failed}",
        f"{motion.time:.0f}",
    ]


HEADS = [
    "", "ticks in contact", "nearest [mm]", "tip error, rms [mm]", "at the end [mm]", "along the wall [mm]",
    "jerk, rms [rad/s³]", "acceleration, most [rad/s²]", "ticks without an answer", "a tick [µs]",
]  # fmt: skip


def solvers(scene: Scene, made: Robot, clearance: fp.Clearance) -> dict[str, Callable[[], Step]]:
    """Functions that construct the solvers. Each solver is constructed immediately before its motion."""
    ones = np.ones(scene.arm.dof)
    fpbm = fp.FPBM(0.6, ones, 2 * K, K * K, null_damping=2.0)
    acceleration = made.limits.acceleration
    return {
        "fpbm_cpp, no clearance": lambda: ours(scene, fpbm, made.limits, None),
        "fpbm_cpp, FPBM": lambda: ours(scene, fpbm, made.limits, clearance),
        "fpbm_cpp, MVN": lambda: ours(scene, fp.MVN(k=K), made.limits, clearance),
        "Pink": lambda: Pink(scene, READY, DT).step,
        "Pink, gain 0.02": lambda: Pink(scene, READY, DT, gain=K * DT).step,
        "Pink, accelerations": lambda: Pink(scene, READY, DT, gain=K * DT, acceleration=acceleration).step,
        "Mink": lambda: Mink(scene, READY, DT).step,
        "Mink, gain 0.02": lambda: Mink(scene, READY, DT, gain=K * DT).step,
    }


def run() -> Iterator[str]:
    made = robot("panda")
    versions = {name: metadata.version(name) for name in ("pin-pink", "mink", "mujoco", "coal", "daqp")}
    yield "Versions: " + ", ".join(f"{name} {version}" for name, version in versions.items())
    for scenario in scenarios():
        clearance = replace(made.clearance, obstacles=scenario.obstacles)
        scene = Scene(made.arm, made.limits, clearance)
        yield from ("", f"{scenario.name} ({len(scene.pairs)} pairs, margin {1e3 * MARGIN:g} mm):", "")
        yield from ("| " + " | ".join(HEADS) + " |", "|---|" + "---:|" * (len(HEADS) - 1))
        for name, make in solvers(scene, made, clearance).items():
            motion, reference = moved(make(), made.arm, scenario)
            distances = np.array([scene.distance(q) for q in motion.q])
            yield "| " + " | ".join(row(name, motion, reference, distances, scenario)) + " |"
