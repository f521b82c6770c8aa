"""Robots, and long motions with hostile streams, for bench/streams.py."""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from clearance_robots import Check, robot
from streams_checks import KINDS, Differences, Libfranka
from streams_shield import Shield
from streams_sources import Array, Task, hostile

import fpbm_cpp as fp
from fpbm_cpp.job.motion import READY

NAMES = ("panda", "fr3", "ur5e", "openarm", "so101")
GUARDED = ("panda", "iiwa14")
TICKS = (1e-3, 2e-3, 4e-3)
BLENDS = (0.0, 0.1)  # Option of a stream [s].
BLOCK = 10_000  # Ticks between two checks.
BETWEEN = 0.02  # Time between two checks of meshes [s].
HOME = {"openarm": [0.3, 0.3, 0.0, 1.0, 0.0, 0.0, 0.0]}  # [rad]


class Machine(NamedTuple):
    arm: fp.SerialArm
    limits: fp.JointLimits
    home: Array


def machine(name: str) -> Machine:
    """A preset. Without bounds on jerk, the acceleration changes from zero to its bound in at least 20 ms."""
    arm = fp.SerialArm.preset(name)
    limits = arm.limits
    if not np.isfinite(limits.jerk).all():
        limits = replace(limits, jerk=50.0 * limits.acceleration)
    return Machine(arm, limits, np.array(HOME.get(name) or READY[name]))


class Scene(NamedTuple):
    machine: Machine
    clearance: fp.Clearance
    meshes: Check


@functools.cache
def scene(name: str) -> Scene:
    """A robot from its URDF file, at a table with a post."""
    made = robot(name)
    table = fp.HalfSpace([0, 0, 1], 0.0, name="table")
    post = fp.Capsule(0, [0.45, 0.4, 0.0], [0.45, 0.4, 0.9], 0.05, name="post")
    clearance = replace(made.clearance, obstacles=[table, post])
    return Scene(Machine(made.arm, made.limits, np.array(READY[name])), clearance, made.meshes.among([table, post]))


class Ride(NamedTuple):
    """A motion with a hostile stream. The excesses are relative to the bounds."""

    name: str
    ticks: int
    received: int
    accepted: int
    raised: int
    position: float
    velocity: float
    acceleration: float
    jerk: float
    distance: float  # Smallest distance of a pair beyond the margin [m]; infinity without a clearance.
    contacts: int  # Postures in which meshes are in contact, by Coal.


def ride(seed: int, count: int, guarded: bool, number: int) -> Ride:
    """The motion with a number, until a number of chunks has arrived."""
    rng = np.random.default_rng([seed, number])
    names = GUARDED if guarded else NAMES
    name = names[number % len(names)]
    dt, blend = float(rng.choice(TICKS)), float(rng.choice(BLENDS))
    made, bounds = (scene(name).machine, [scene(name).clearance]) if guarded else (machine(name), [])
    task = Task(made.limits, made.home, rng, fraction=rng.uniform(0.1, 1.0))
    messages = hostile(task, rng, made.limits)
    shield = Shield(
        made.arm, made.home, messages, limits=made.limits, dt=dt, tracked=guarded, bounds=bounds, blend=blend
    )
    check, contacts = Differences(made.home, made.limits, dt), 0
    while shield.received < count:
        q = shield.block(BLOCK)
        check.add(q)
        if guarded:
            contacts += sum(scene(name).meshes.meets(each) for each in q[:: round(BETWEEN / dt)])
    excess = (check.excess[kind] for kind in KINDS)
    beyond = shield.distance - bounds[0].margin if guarded else np.inf
    return Ride(name, shield.ticks, shield.received, shield.accepted, shield.raised, *excess, beyond, contacts)


class Hours(NamedTuple):
    ticks: int
    received: int
    conditions: tuple[str, ...]  # Violated conditions of libfranka, one entry for each block.


def franka_hours(seed: int, hours: float, number: int) -> Hours:
    """An FR3 with a hostile stream at 1 kHz, with and without a tracker, checked by the conditions of libfranka."""
    libfranka = Libfranka()
    rng = np.random.default_rng([seed, number, 2])
    made = machine("fr3")
    task = Task(libfranka.limits, made.home, rng, fraction=0.5)
    messages = hostile(task, rng, libfranka.limits)
    shield = Shield(made.arm, made.home, messages, limits=libfranka.limits, dt=1e-3, tracked=number % 2 == 1)
    last, broken = np.tile(made.home, (3, 1)), []
    while shield.ticks < hours * 3.6e6:
        q = np.vstack([last, shield.block(6 * BLOCK)])
        broken += sorted(libfranka.violated(q))
        last = q[-3:]
    return Hours(shield.ticks, shield.received, tuple(broken))
