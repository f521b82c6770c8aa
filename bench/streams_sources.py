"""Streams of joint postures for bench/streams.py: policies with chunks, teleoperation, and their faults.

The faults are those of reports: chunks that are decoded again from another state jump by 20 to 70 mrad (lerobot#4454,
lerobot#4580), inference of up to 0.8 s stalls the arm (openpi#393, axol#191), and packets arrive together after a gap
of the Wi-Fi (axol#149).
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import fpbm_cpp as fp

Array = NDArray[np.float64]

WIFI_RATE = 72.0  # Rate of a headset [Hz].
RAMP = 1.0  # Time in which a task starts from rest [s].
JUMP = (0.020, 0.070)  # Displacement of each joint where a chunk is decoded again [rad].
STALL = 0.8  # Longest additional inference [s].
FAULTS = ("nan", "infinite", "size", "dof", "doubled", "old", "future", "far", "empty")


class Message(NamedTuple):
    """A chunk of postures, or a single posture if the period is zero."""

    comes: float  # Time of arrival [s].
    stamp: float  # Time of the observation [s].
    postures: Any  # (k, n) [rad]; a faulty message may have other shapes.
    period: float  # [s]
    velocities: Array | None = None  # (k, n) [rad/s]

    def sound(self, dof: int) -> bool:
        """Whether a receiver without a library would forward the message."""
        q = np.asarray(self.postures)
        return q.ndim == 2 and q.shape[1] == dof and len(q) > 0 and bool(np.isfinite(q).all())


class Task:
    """A motion of the joints that a policy or an operator intends: two sines for each joint, from rest."""

    def __init__(self, limits: fp.JointLimits, q0: Array, rng: np.random.Generator, fraction: float = 0.3) -> None:
        n = len(q0)
        self.q0, self.w, self.phase = q0, rng.uniform(0.8, 3.0, (2, n)), rng.uniform(0, 2 * np.pi, (2, n))
        slack = 0.8 * np.minimum(q0 - limits.lower, limits.upper - q0)
        most = np.minimum(limits.velocity / 3.0, limits.acceleration / 9.0) * fraction / 2
        self.amplitude = np.minimum(most, slack / 4) * rng.uniform(0.5, 1.0, (2, n))

    def __call__(self, t: Any) -> Array:
        """Postures at times, (k, n)."""
        t = np.asarray(t, float)[:, None]
        ramp = np.clip(t / RAMP, 0.0, 1.0)
        moved = sum(a * (np.sin(w * t + p) - np.sin(p)) for a, w, p in zip(self.amplitude, self.w, self.phase))
        return self.q0 + ramp**3 * (10 - 15 * ramp + 6 * ramp**2) * moved


def steady(task: Task, period: float, *, velocities: bool = False) -> Iterator[Message]:
    """Chunks of 32 postures without a fault: each chunk arrives in the middle of the previous chunk, and continues it.

    With `velocities`, the chunks contain the velocities of the task.
    """
    for k in range(10**9):
        times = period * (16 * k + np.arange(32))
        rates = (task(times + 1e-5) - task(times - 1e-5)) / 2e-5 if velocities else None
        yield Message(times[0], times[0], task(times), period, rates)


def postures(task: Task, period: float) -> Iterator[Message]:
    """Single postures without a fault."""
    for k in range(10**9):
        yield Message(k * period, k * period, task([k * period]), 0.0)


def policy(task: Task, rng: np.random.Generator, *, jump: bool = True, stalls: bool = True) -> Iterator[Message]:
    """A policy that observes, computes, and sends a chunk of 16 to 50 postures, of which the arm executes a part.

    The chunk starts at the observation, and the arm moves on during the inference. Each chunk has another offset from
    the task (re-anchoring).
    """
    period = 1.0 / rng.uniform(5.0, 50.0)
    horizon = int(rng.integers(16, 51))
    stamp = 0.0
    while True:
        inference = rng.uniform(0.03, 0.15) + (rng.uniform(0.0, STALL) if stalls and rng.random() < 0.2 else 0.0)
        times = stamp + period * np.arange(horizon)
        offset = rng.uniform(*JUMP, len(task.q0)) * rng.choice([-1, 1], len(task.q0)) if jump and stamp else 0.0
        yield Message(stamp + inference, stamp, task(times) + offset, period)
        stamp += max(inference, period * rng.uniform(0.2, 1.0) * horizon)


def wifi(task: Task, rng: np.random.Generator) -> Iterator[Message]:
    """Teleoperation as in axol#149: 72 postures per second with the time of capture, over Wi-Fi.

    A gap of the Wi-Fi holds packets back, up to 0.3 s, and then delivers these packets together. The channel is
    unreliable: 2 % of the packets are lost, and some arrive out of order.
    """

    def sent() -> Iterator[Message]:
        opens = 0.0
        for k in range(10**9):
            stamp = k / WIFI_RATE
            if rng.random() < 0.02 and stamp > opens:
                opens = stamp + rng.uniform(0.05, 0.3)
            if rng.random() > 0.02 or not k:
                comes = max(stamp, opens) + rng.uniform(0.004, 0.020)
                yield Message(comes, stamp, task([stamp]), 0.0)

    return by_arrival(sent())


def hostile(task: Task, rng: np.random.Generator, limits: fp.JointLimits) -> Iterator[Message]:
    """Chunks of a policy, and after every fifth sound chunk a wrong one; some chunks change places."""
    span = limits.upper - limits.lower
    held: Message | None = None
    for message in policy(task, rng):
        given = message.postures
        if rng.random() < 0.1:  # Postures that the arm cannot follow, up to a tenth of a range out of range.
            wild = given + rng.normal(0, 0.3, given.shape) * span
            message = message._replace(postures=np.clip(wild, limits.lower - 0.099 * span, limits.upper + 0.099 * span))
        elif rng.random() < 0.1:
            message = message._replace(period=0.0, postures=given[:1])
        if held is not None:  # The older chunk arrives after the newer chunk.
            yield message
            message, held = held._replace(comes=message.comes), None
        elif rng.random() < 0.05:
            held = message
            continue
        yield message
        if rng.random() < 0.2:
            yield faulty(message, str(rng.choice(FAULTS)), rng)


def faulty(message: Message, fault: str, rng: np.random.Generator) -> Message:
    given, shift = np.array(message.postures), float(rng.uniform(0.2, 100.0))
    if fault in ("nan", "infinite"):
        given[rng.integers(len(given)), rng.integers(given.shape[1])] = np.nan if fault == "nan" else np.inf
    changed: dict[str, dict[str, Any]] = {
        "size": {"postures": given[:, 0]},
        "dof": {"postures": given[:, :-1]},
        "old": {"stamp": message.stamp - shift},
        "future": {"stamp": message.stamp + shift},
        "far": {"postures": 1e300 * given},
        "empty": {"postures": given[:0]},
    }
    return message._replace(**changed.get(fault, {"postures": given}))


def by_arrival(messages: Iterator[Message]) -> Iterator[Message]:
    """Messages in the order of their arrival. The stamps of the given messages increase."""
    waiting: list[tuple[float, int, Message]] = []
    for number, message in enumerate(messages):
        while waiting and waiting[0][0] <= message.stamp:
            yield heapq.heappop(waiting)[2]
        heapq.heappush(waiting, (message.comes, number, message))
