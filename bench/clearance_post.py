"""Contacts with a post that crosses the workspace of a Panda in MuJoCo: `python bench/clearance.py post`.

The target of the tip is constant. A computed-torque controller follows the positions and velocities of the tracker at
1 kHz. The post is vertical, and moves in a straight line at constant velocity through a point of the forearm or the
hand. No contact stops the post. The tracker receives the position and the velocity of the post in each tick. Posts
whose path is nearer to the first axis of the arm than COLUMN are omitted: the two links on this axis cannot move away.
"""

from __future__ import annotations

import math
import multiprocessing
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from clearance_robots import UP, Array, Robot, flat_urdf, robot

import fpbm_cpp as fp

DT = 1e-3
SPEEDS = (0.1, 0.25, 0.5)  # [m/s]
READY = np.array([0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854])
MARGIN = 0.02
RADIUS, HEIGHT = 0.04, 1.1
COLUMN = 0.25  # [m]
FAR = 0.95  # Distance of a post's start and end from its nearest point to the axis [m].
STIFFNESS, DAMPING = 2500.0, 100.0  # Feedback gains on position [1/s²] and velocity [1/s].

MADE: dict[str, Any] = {}  # Filled before the workers are forked, so that they share the entries.


class Crossing(NamedTuple):
    speed: float
    touched: int  # Number of ticks with a contact of the post and the arm.
    deepest: float  # Smallest distance in the contacts by MuJoCo [m]; 0 without a contact.
    distance: float  # Smallest distance between the capsules of the tracker, or from them to the post [m].
    lag: float  # Largest lag of the arm behind the tracker [rad].
    error: float  # Error of the tip at the end [m].


def model_of(name: str, capsule_radius: float) -> Any:
    """MuJoCo's model of an arm from its URDF file. Links have contacts with the post, but not with each other."""
    import mujoco

    with tempfile.TemporaryDirectory() as folder, flat_urdf(name) as urdf:
        text = urdf.read_text().replace(
            "<link", '<mujoco><compiler strippath="false" discardvisual="true" fusestatic="false"/></mujoco><link', 1
        )
        file = Path(folder) / "arm.urdf"
        file.write_text(text)
        spec = mujoco.MjSpec.from_file(str(file))
        spec.option.timestep = DT
        for geom in spec.geoms:
            geom.contype, geom.conaffinity = 1, 2
        body = spec.worldbody.add_body(name="post", mocap=True, pos=[9, 9, 0])
        body.add_geom(
            name="post",
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=[0, 0, 0, 0, 0, HEIGHT],
            size=[capsule_radius, 0, 0],
            contype=2,
            conaffinity=1,
        )
        return spec.compile()


def post_path(number: int) -> tuple[Array, Array]:
    """A random path of a post through the arm: the point nearest to the first axis, and the direction of the path."""
    arm = MADE["robot"].arm
    rng = np.random.default_rng([23, number])
    elbow, wrist = np.array([0.0, 0.0, 0.6]), arm.forward(READY)[:3, 3]
    while True:
        through = elbow + rng.uniform(0.4, 1.1) * (wrist - elbow) + rng.uniform(-0.05, 0.05, 3)
        angle = rng.uniform(-np.pi, np.pi)
        direction = np.array([np.cos(angle), np.sin(angle), 0.0])
        nearest = through * [1, 1, 0] - (through @ direction) * direction
        if np.linalg.norm(nearest) >= COLUMN:
            return nearest, direction


def crossing(task: tuple[float, int, bool]) -> Crossing:
    import mujoco

    speed, number, guarded = task
    made: Robot = MADE["robot"]
    nearest, direction = post_path(number)
    foot = nearest - FAR * direction

    def post(at: Array) -> fp.Capsule:
        return fp.Capsule(0, at, at + HEIGHT * UP, RADIUS, "post")

    clearance = replace(made.clearance, obstacles=[post(foot)], margin=MARGIN)
    scheme = fp.FPBM(0.6, np.ones(7), 20, 100, null_damping=2)
    # After the crossing, the tip returns.
    options = {"bounds": [clearance] if guarded else [], "stall_time": math.inf}
    tracker = fp.Tracker(made.arm, scheme, READY, limits=made.limits, **options)
    model, target = MADE["model"], tracker.tip
    data = mujoco.MjData(model)
    data.qpos[:7] = READY
    geom = model.geom("post").id
    mass = np.zeros((model.nv, model.nv))
    touched, deepest, distance, lag = 0, 0.0, np.inf, 0.0
    for k in range(round(2 * FAR / speed / DT)):
        at = foot + k * DT * speed * direction
        if guarded:
            tracker.move("post", post(at), speed * direction)
        tick = tracker.tick(target)
        if guarded:
            distance = min(distance, tick.nearest.distance)
        data.mocap_pos[0] = at
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        error = np.concatenate([tick.q, np.zeros(model.nv - 7)]) - data.qpos
        rate = np.concatenate([tick.qd, np.zeros(model.nv - 7)]) - data.qvel
        mujoco.mj_fullM(model, data, mass)
        forward = np.concatenate([tick.qdd, np.zeros(model.nv - 7)])
        data.qfrc_applied[:] = mass @ (forward + STIFFNESS * error + DAMPING * rate) + data.qfrc_bias
        mujoco.mj_step(model, data)
        depths = [c.dist for c in data.contact if geom in (c.geom1, c.geom2)]
        if depths and min(depths) < 0:
            touched += 1
            deepest = min(deepest, *depths)
        lag = max(lag, float(np.abs(data.qpos[:7] - tracker.q).max()))
    return Crossing(speed, touched, deepest, distance, lag, float(np.linalg.norm(target - tracker.tip)))


HEADS = [
    "post [m/s]", "crossings", "with contact, no clearance", "with contact", "ticks in contact", "deepest [mm]",
    "capsules, least [mm]", "under the margin", "lag, most [mrad]", "tip error at the end, median [mm]",
]  # fmt: skip


def row(speed: float, guarded: list[Crossing], free: list[Crossing]) -> list[str]:
    return [
        f"{speed:g}",
        f"{len(guarded)}",
        f"{sum(each.touched > 0 for each in free)}",
        f"{sum(each.touched > 0 for each in guarded)}",
        f"{sum(each.touched for each in guarded)}",
        f"{1e3 * min(each.deepest for each in guarded):.1f}",
        f"{1e3 * min(each.distance for each in guarded):.1f}",
        f"{sum(each.distance < MARGIN - 1e-9 for each in guarded)}",
        f"{1e3 * max(each.lag for each in guarded if not each.touched):.2f}",
        f"{1e3 * np.median([each.error for each in guarded]):.1f}",
    ]


def run(motions: int) -> Iterator[str]:
    MADE["robot"] = robot("panda")
    MADE["model"] = model_of("panda", RADIUS)
    yield from ("| " + " | ".join(HEADS) + " |", "|" + "---:|" * len(HEADS))
    tasks = [(speed, i, guarded) for speed in SPEEDS for guarded in (True, False) for i in range(motions)]
    with multiprocessing.get_context("fork").Pool(2) as pool:
        done = pool.map(crossing, tasks, chunksize=1)
    groups = [done[i : i + motions] for i in range(0, len(done), motions)]
    for speed, guarded, free in zip(SPEEDS, groups[::2], groups[1::2]):
        yield "| " + " | ".join(row(speed, guarded, free)) + " |"
    yield ""
    for (speed, number, guarded), each in zip(tasks, done):
        if guarded and each.touched:
            yield f"Post {number} at {speed} m/s touched: {each}"
