"""Robots, and long motions with hostile streams, for bench/streams.py."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from streams_checks import KINDS, Differences, Libfranka
from streams_shield import Shield
from streams_sources import Array, Task, hostile

import fpbm_cpp as fp
from fpbm_cpp.job.motion import READY

NAMES = ("panda", "fr3", "ur5e", "openarm", "so101")
TICKS = (1e-3, 2e-3, 4e-3)
BLOCK = 10_000  # Ticks between two checks.
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
    exact_jerk: float  # The same without the rounding of the postures.
    distance: float  # Smallest distance of a pair beyond the margin [m]; infinity without a clearance.


def ride(seed: int, count: int, guarded: bool, number: int) -> Ride:
    """The motion with a number, until a number of chunks has arrived."""
    rng = np.random.default_rng([seed, number])
    names = ("panda", "fr3") if guarded else NAMES  # Presets with capsules.
    name = names[number % len(names)]
    made, dt = machine(name), float(rng.choice(TICKS))
    bounds: tuple[Any, ...] = ()
    if guarded:
        bounds = (fp.Clearance.preset(name, obstacles=[fp.HalfSpace([0, 0, 1], 0.0, name="table")]),)
    task = Task(made.limits, made.home, rng, fraction=rng.uniform(0.1, 1.0))
    messages = hostile(task, rng, made.limits)
    shield = Shield(made.arm, made.home, messages, limits=made.limits, dt=dt, tracked=guarded, bounds=bounds)
    check = Differences(made.home, made.limits, dt)
    while shield.received < count:
        check.add(shield.block(BLOCK))
    return Ride(
        name,
        shield.ticks,
        shield.received,
        shield.accepted,
        shield.raised,
        *(check.excess[kind] for kind in (*KINDS, "exact jerk")),
        shield.distance - bounds[0].margin if guarded else np.inf,
    )


class Hours(NamedTuple):
    ticks: int
    received: int
    conditions: tuple[str, ...]  # Violated conditions of libfranka, one entry for each block.


def franka_hours(seed: int, hours: float, number: int) -> Hours:
    """An FR3 with a hostile stream at 1 kHz, checked by the conditions of libfranka.

    A tracker keeps the bounds on velocity that depend on the position.
    """
    libfranka = Libfranka()
    rng = np.random.default_rng([seed, number, 2])
    made = machine("fr3")
    task = Task(libfranka.limits, made.home, rng, fraction=0.5)
    messages = hostile(task, rng, libfranka.limits)
    shield = Shield(made.arm, made.home, messages, limits=libfranka.limits, dt=1e-3, tracked=True)
    last, broken = np.tile(made.home, (3, 1)), []
    while shield.ticks < hours * 3.6e6:
        q = np.vstack([last, shield.block(6 * BLOCK)])
        broken += sorted(libfranka.violated(q))
        last = q[-3:]
    return Hours(shield.ticks, shield.received, tuple(broken))
