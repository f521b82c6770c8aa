"""Contacts in random motions with paths through a table, a shelf and a post: `python bench/clearance.py motions`."""

from __future__ import annotations

import multiprocessing
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from clearance_robots import NAMES, UP, Array, Check, Robot, robot

import fpbm_cpp as fp
from fpbm_cpp.obstacle import Obstacle

STRIDE = 10  # Number of samples from one check of the meshes to the next.
FREE = 20  # One of FREE motions is also executed without a clearance.
START = 0.001  # Smallest distance of a start posture beyond the margin [m].
NEAR = 0.02  # If the smallest distance of a motion beyond the margin is below NEAR [m], the motion counts as near.
CHUNK = 25
BOUNDS = ("position", "velocity", "acceleration", "jerk")

ROBOTS: dict[str, Robot] = {}  # Filled before the workers are forked, so that they share the robots.


class Motion(NamedTuple):
    ticks: int
    duration: float
    status: str
    distance: float  # Smallest distance of capsules beyond the margin [m].
    excess: tuple[float, ...]  # Excess over the joint bounds: of positions [rad], otherwise relative to the bound.
    checks: int  # Number of checks of the meshes.
    contacts: int  # Number of checks with a contact.
    apart: float  # Distance of the meshes in the posture with the smallest distance of capsules [m].
    free_contacts: int | None  # Number of checks with a contact in the motion without a clearance.


def turned(angle: float, place: Array) -> Array:
    """A frame that is rotated about z."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = fp.rotation([0, 0, angle]), place
    return pose


def world(rng: np.random.Generator, reach: float) -> list[Obstacle]:
    """A floor, and a table, a shelf and a post at random places around an arm."""

    def around(low: float, high: float) -> tuple[float, Array]:
        angle = rng.uniform(-np.pi, np.pi)
        return angle, rng.uniform(low, high) * reach * np.array([np.cos(angle), np.sin(angle), 0.0])

    angle, place = around(0.5, 0.8)
    top = rng.uniform(0.0, 0.35) * reach
    half = np.array([0.2 * reach, 0.45 * reach, 0.02])
    table = fp.Cuboid(turned(angle, place + (top - half[2]) * UP), half, name="table")
    angle, place = around(0.65, 0.95)
    low = rng.uniform(0.1, 0.4) * reach
    boards = [
        fp.Cuboid(turned(angle, place + z * UP), [0.18, 0.3, 0.01], name=name)
        for name, z in (("lower board", low), ("upper board", low + rng.uniform(0.3, 0.45)))
    ]
    _, foot = around(0.4, 0.8)
    height = rng.uniform(0.5, 1.2) * reach
    post = fp.Capsule(0, foot, foot + height * UP, rng.uniform(0.02, 0.06), name="post")
    floor = fp.HalfSpace([0, 0, 1], -0.08 * reach, name="floor")
    return [floor, table, *boards, post]


def schemes(n: int, rng: np.random.Generator) -> fp.Scheme:
    w = rng.uniform(0.5, 2.0, n)
    every = (
        fp.MVN(k=5),
        fp.WMVN(w, k=5),
        fp.MAN(),
        fp.Balanced(0.6, w),
        fp.FPBM(0.6, w, 10, 25, null_damping=2),
    )
    return every[rng.integers(len(every))]


def aims(rng: np.random.Generator, obstacles: list[Obstacle], tip: Array) -> Iterator[Array]:
    """Displacements of the tip to points behind obstacles or behind the arm's own base."""
    for _ in range(rng.integers(1, 4)):
        chosen = rng.integers(len(obstacles) + 1)
        if chosen == len(obstacles):
            through = np.array([0.0, 0.0, rng.uniform(0.1, 0.4)])
        else:
            obstacle = obstacles[chosen]
            if isinstance(obstacle, fp.HalfSpace):
                through = np.array([*tip[:2], obstacle.offset])
            elif isinstance(obstacle, fp.Cuboid):
                through = obstacle.pose[:3, :3] @ (rng.uniform(-0.8, 0.8, 3) * obstacle.half) + obstacle.pose[:3, 3]
            else:
                through = obstacle.a + rng.uniform(0.2, 0.9) * (obstacle.b - obstacle.a)
        yield rng.uniform(1.0, 1.6) * (through - tip)


def start(rng: np.random.Generator, arm: fp.SerialArm, limits: fp.JointLimits, clearance: fp.Clearance) -> Array | None:
    """A random posture that is farther than START from the margin of all shapes; None if no posture is found."""
    low, high = (np.clip(bound, -2.8, 2.8) for bound in (limits.lower, limits.upper))
    for q in rng.uniform(low, high, (3000, arm.dof)):
        nearest = clearance.nearest(arm, q)
        if nearest is not None and nearest.distance > clearance.margin + START:
            return q
    return None


def excess(run: fp.Run, limits: fp.JointLimits) -> tuple[float, ...]:
    """Excess of a motion over the joint bounds, by differences of positions and velocities."""
    h, still = run.options["dt"], np.zeros((1, run.q.shape[1]))
    velocity = np.vstack([run.qd, np.diff(run.q, axis=0) / h])
    acceleration = np.vstack([still, np.diff(run.qd, axis=0) / h])
    jerk = np.diff(acceleration, axis=0) / h
    rows = ((velocity, limits.velocity), (acceleration, limits.acceleration), (jerk, limits.jerk))
    outside = np.maximum(run.q - limits.upper, limits.lower - run.q).max()
    return (float(outside), *(float((np.abs(values) / bound).max() - 1.0) for values, bound in rows))


def contacts(check: Check, run: fp.Run) -> int:
    return sum(check.meets(q) for q in run.q[::STRIDE])


def motion(name: str, number: int) -> Motion | None:
    """The motion of an arm with a number; None if no start posture is found."""
    made = ROBOTS[name]
    rng = np.random.default_rng([17, NAMES.index(name), number])
    reach = float(sum(np.linalg.norm(joint.placement[:3, 3]) for joint in made.arm.joints[1:]))
    obstacles = world(rng, reach)
    clearance = replace(made.clearance, obstacles=obstacles)
    q0 = start(rng, made.arm, made.limits, clearance)
    if q0 is None:
        return None
    points = np.array(list(aims(rng, obstacles, made.arm.forward(q0)[:3, 3])))
    duration = round(rng.uniform(2.0, 4.0), 3)
    path = fp.Line(points[0], duration) if len(points) == 1 else fp.Waypoints(points, duration=duration)
    options: dict[str, Any] = {"task": str(rng.choice(["position", "pose"])), "limits": made.limits}
    scheme = schemes(made.arm.dof, rng)
    run = fp.track(made.arm, path, scheme, q0, bounds=[clearance], **options)
    assert run.clearance is not None
    check = made.meshes.among(obstacles)
    free = None
    if number % FREE == 0:
        free = contacts(check, fp.track(made.arm, path, scheme, q0, **options))
    return Motion(
        ticks=len(run.t) - 1,
        duration=float(run.t[-1]),
        status=run.status.code.name,
        distance=float(run.clearance.min()) - clearance.margin,
        excess=excess(run, made.limits),
        checks=len(run.q[::STRIDE]),
        contacts=contacts(check, run),
        apart=check.distance(run.q[run.clearance.argmin()]),
        free_contacts=free,
    )


def chunk(task: tuple[str, int, int]) -> list[tuple[str, int, Motion | None]]:
    name, first, last = task
    return [(name, number, motion(name, number)) for number in range(first, last)]


COLUMNS: dict[str, Callable[[list[Motion]], str]] = {
    "motions": lambda of: f"{len(of)}",
    "ticks": lambda of: f"{sum(m.ticks for m in of)}",
    "near": lambda of: f"{sum(m.distance < NEAR for m in of)}",
    "capsules below the margin by 1e-9": lambda of: f"{sum(m.distance < -1e-9 for m in of)}",
    "least distance - margin [m]": lambda of: f"{min(m.distance for m in of):.1e}",
    "checks of meshes": lambda of: f"{sum(m.checks for m in of)}",
    "checks with contact": lambda of: f"{sum(m.contacts for m in of)}",
    "meshes apart [mm]": lambda of: f"{1e3 * min(m.apart for m in of):.1f}",
    **{f"{bound}'s excess": lambda of, i=i: f"{max(m.excess[i] for m in of):.0e}" for i, bound in enumerate(BOUNDS)},
    "unguarded: motions": lambda of: f"{sum(m.free_contacts is not None for m in of)}",
    "with contacts": lambda of: f"{sum(bool(m.free_contacts) for m in of)}",
}


def report(done: dict[str, list[Motion]]) -> list[str]:
    """The table of results, with a column for each arm."""
    every = {**done, "all": [each for of in done.values() for each in of]}
    lines = ["| | " + " | ".join(every) + " |", "|---|" + "---:|" * len(every)]
    lines += [f"| {head} | " + " | ".join(cell(of) for of in every.values()) + " |" for head, cell in COLUMNS.items()]
    statuses = Counter(each.status for each in every["all"])
    return [*lines, "", "Statuses: " + ", ".join(f"{name} {count}" for name, count in statuses.most_common())]


def run(motions: int, workers: int, minutes: float) -> Iterator[str]:
    """Executes the same number of motions for each arm, until all motions are complete or the time is over."""
    for name in NAMES:
        ROBOTS[name] = robot(name)
    each = -(-motions // len(NAMES))
    tasks = [(name, i, min(i + CHUNK, each)) for i in range(0, each, CHUNK) for name in NAMES]
    done: dict[str, list[Motion]] = {name: [] for name in NAMES}
    bad, skipped, begin = [], 0, time.perf_counter()
    with multiprocessing.get_context("fork").Pool(workers) as pool:
        for result in pool.imap(chunk, tasks):
            for name, number, made in result:
                if made is None:
                    skipped += 1
                    continue
                done[name].append(made)
                if made.distance < -1e-9 or made.contacts or max(made.excess) > 1e-6:
                    bad.append((name, number, *made))
            if time.perf_counter() - begin > 60 * minutes:
                pool.terminate()
                break
    yield from report(done)
    yield f"Motions for which no start posture was found: {skipped}"
    yield from (f"broken: {each}" for each in bad)
