"""Time to rejoin a stream, compared with Ruckig, and delay and ripple of a steady stream, for bench/streams.py."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np
import ruckig
from streams_robots import machine
from streams_shield import Shield
from streams_sources import JUMP, STALL, Array, Task, postures, steady

import fpbm_cpp as fp

DT = 1e-3
REJOINED = 1e-6  # Distance from the stream [rad].
PERIOD = 1 / 30  # Time between the postures of a chunk to rejoin [s].
JITTER = 5e-3  # Added to a period, for the option delay [s].
# Steady streams, and whether the option delay is a period.
KINDS = {
    "chunks": (steady, False),
    "chunks with velocities": (partial(steady, velocities=True), False),
    "postures": (postures, False),
    "postures, delay of a period and 5 ms": (postures, True),
}


def least_time(limits: fp.JointLimits, off: Array, qd: Array, qdd: Array, v: Array) -> float:
    """Time of the slowest joint to a target with velocity v, by Ruckig in the frame of the target [s]."""
    longest = 0.0
    for joint in range(len(off)):
        given, trajectory = ruckig.InputParameter(1), ruckig.Trajectory(1)
        given.current_position, given.current_velocity = [off[joint]], [qd[joint] - v[joint]]
        given.current_acceleration = [qdd[joint]]
        given.target_position = given.target_velocity = [0.0]
        given.max_velocity = [limits.velocity[joint] - v[joint]]
        given.min_velocity = [-limits.velocity[joint] - v[joint]]
        given.max_acceleration, given.max_jerk = [limits.acceleration[joint]], [limits.jerk[joint]]
        assert ruckig.Ruckig(1).calculate(given, trajectory) in (ruckig.Result.Working, ruckig.Result.Finished)
        longest = max(longest, trajectory.duration)
    return longest


class Rejoin(NamedTuple):
    jump: bool  # After a jump, or else after a stall.
    ours: float  # [s]
    ruckig: float  # [s]


def rejoin(seed: int, number: int) -> Rejoin:
    """A jump of a moving stream, or a stall of a stream that moves on."""
    rng = np.random.default_rng([seed, number, 3])
    made = machine(("panda", "fr3")[number % 2])
    limits, n = made.limits, made.arm.dof
    stream = fp.JointStream(made.arm, made.home, limits=limits, dt=DT, start=0.0)
    v = rng.uniform(-0.1, 0.1, n) * limits.velocity
    times = PERIOD * np.arange(60)
    jump = bool(rng.random() < 0.5)
    ticks = int(rng.integers(500, 1000))
    now = DT * ticks
    if jump:
        target = made.home + rng.uniform(*JUMP, n) * rng.choice([-1, 1], n)
        stream.push_chunk(made.home + v * (times[:, None] - now), period=PERIOD, stamp=0.0)
    else:
        target = made.home + v * rng.uniform(0.2, STALL)
    for _ in range(ticks):
        stream.advance()
    state = np.array(stream.q), np.array(stream.qd), np.array(stream.qdd)
    stream.push_chunk(target + v * times[:, None], period=PERIOD, stamp=now)
    last = 0
    for k in range(1, 1500):
        stream.advance()
        if np.abs(stream.q - target - v * (k * DT)).max() > REJOINED:
            last = k
    return Rejoin(jump, DT * (last + 1), least_time(limits, state[0] - target, state[1], state[2], v))


class Quality(NamedTuple):
    rate: float  # [Hz]
    kind: str
    delay: float  # [s]
    ripple: float


def quality(seed: int, rate: float, kind: str, number: int) -> Quality:
    """Delay and ripple of a steady stream.

    The delay is the displacement in time with the least mean square of the distance from the task. The ripple is the
    root mean square of the deviation from the acceleration of the delayed task, relative to this acceleration.
    """
    rng = np.random.default_rng([seed, number, 7])
    made = machine("panda")
    task = Task(made.limits, made.home, rng)
    source, delayed = KINDS[kind]
    shield = Shield(
        made.arm,
        made.home,
        source(task, 1 / rate),
        limits=made.limits,
        dt=DT,
        delay=1 / rate + JITTER if delayed else 0.0,
        timeout=max(0.2, 3 / rate),
    )
    q = shield.block(20_000)[2000:]
    t = DT * np.arange(2001, 20_001)
    shifts = 1e-3 * np.arange(-20, 500)
    off = [float(np.mean((q[::10] - task(t[::10] - shift)) ** 2)) for shift in shifts]
    found = float(shifts[int(np.argmin(off))])
    own = np.diff(task(t - found), 2, axis=0) / DT**2
    ripple = np.diff(q, 2, axis=0) / DT**2 - own
    return Quality(rate, kind, found, float(np.sqrt(np.mean(ripple**2) / np.mean(own**2))))
