"""Teleoperation over Wi-Fi, with the packets of axol#149, for bench/streams.py."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from streams_checks import Differences
from streams_robots import machine
from streams_shield import Shield
from streams_sources import Array, Task, wifi

DT = 1e-3
BEGIN = 2.0  # Start of the measurement, when the task moves [s].


class Freeze(NamedTuple):
    longest_gap: float  # Longest time between two arrivals [s].
    longest: float  # Longest time without a motion [s].
    beyond: float  # Longest time without a motion although a message has arrived since its start [s].


def freezes(task: Task, q: Array, arrivals: Array) -> Freeze:
    """Times in which an arm is at rest while its task moves, after the start of the measurement."""
    t = DT * np.arange(1, len(q))
    speed = np.abs(np.diff(q, axis=0)).max(axis=1) / DT
    own = np.abs(task(t + 1e-4) - task(t)).max(axis=1) / 1e-4
    still = (speed < 0.01 * np.median(own)) & (own > 0.1 * np.median(own)) & (t > BEGIN)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]])))
    longest = beyond = 0.0
    for begin, end in zip(edges[::2], edges[1::2]):
        longest = max(longest, DT * (end - begin))
        come = arrivals[(arrivals > t[begin]) & (arrivals <= t[end - 1])]
        beyond = max(beyond, t[end - 1] - come[0] if len(come) else 0.0)
    return Freeze(float(np.diff(arrivals[arrivals > BEGIN]).max()), longest, float(beyond))


def wifi_motion(seed: int, seconds: float, number: int) -> tuple[float, Freeze, dict[str, float]]:
    """The option delay, times at rest, and excesses over the bounds, of an OpenArm, two of which axol has."""
    made, delay = machine("openarm"), (0.0, 0.1)[number % 2]
    task = Task(made.limits, made.home, np.random.default_rng([seed, number, 5]))
    arrivals = []
    for message in wifi(task, np.random.default_rng([seed, number, 6])):
        arrivals.append(message.comes)
        if message.comes > seconds:
            break
    messages = wifi(task, np.random.default_rng([seed, number, 6]))
    shield = Shield(made.arm, made.home, messages, limits=made.limits, dt=DT, delay=delay)
    q = shield.block(round(seconds / DT))
    check = Differences(made.home, made.limits, DT)
    check.add(q)
    return delay, freezes(task, q, np.array(arrivals)), check.excess
