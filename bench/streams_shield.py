"""Joint postures that a JointStream, or a tracker with a JointStream, computes from messages, for bench/streams.py."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from streams_sources import Array, Message

import fpbm_cpp as fp

SHARE = 0.95  # Accelerations and jerks of a stream, relative to the limits of the tracker that follows the stream.


class Shield:
    """Commands tick by tick, in blocks."""

    def __init__(
        self,
        arm: Any,
        q0: Array,
        messages: Iterator[Message],
        *,
        limits: fp.JointLimits,
        dt: float,
        tracked: bool = False,
        bounds: Sequence[Any] = (),
        **options: Any,
    ) -> None:
        """With `tracked`, a tracker follows the stream, within the bounds."""
        slower = replace(limits, acceleration=SHARE * limits.acceleration, jerk=SHARE * limits.jerk)
        given = slower if tracked else limits
        self.stream = fp.JointStream(arm, q0, limits=given, dt=dt, start=0.0, **options)
        self.messages, self.dt = messages, dt
        self.next = next(messages)
        self.ticks = self.received = self.accepted = self.raised = 0
        self.distance = np.inf  # Smallest distance of a pair [m].
        self.tracker = None
        if tracked:
            stack = fp.Stack(fp.PostureTask(q0, name="posture", k1=20.0, k2=100.0))
            scheme = fp.FPBM(0.6, np.ones(len(q0)), 0.0, 0.0)  # The tasks of a stack have the gains.
            self.tracker = fp.Tracker(arm, scheme, q0, stack=stack, limits=limits, dt=dt, bounds=list(bounds))

    def push(self, message: Message) -> None:
        self.received += 1
        try:
            if message.period:
                timing = {"period": message.period, "stamp": message.stamp}
                taken = self.stream.push_chunk(message.postures, velocities=message.velocities, **timing)
            else:
                taken = self.stream.push(message.postures[0], stamp=message.stamp)
        except (ValueError, IndexError):
            self.raised += 1  # A wrong shape, or far out of range.
            return
        self.accepted += taken

    def block(self, ticks: int) -> Array:
        """Postures after each of the next ticks."""
        q = np.empty((ticks, len(self.stream.q)))
        step = self.advance if self.tracker is None else self.tick
        k = 0
        while k < ticks:
            while self.next.comes <= self.ticks * self.dt:
                self.push(self.next)
                self.next = next(self.messages)
            due = max(1, min(ticks - k, int(np.ceil(self.next.comes / self.dt)) - self.ticks))
            step(q, k, k + due)
            k += due
            self.ticks += due
        return q

    def advance(self, q: Array, begin: int, end: int) -> None:
        stream = self.stream
        move: Callable[[], Any] = stream.advance
        for k in range(begin, end):
            move()
            q[k] = stream.q

    def tick(self, q: Array, begin: int, end: int) -> None:
        assert self.tracker is not None
        for k in range(begin, end):
            tick = self.tracker.tick(self.stream)
            q[k] = tick.q
            if tick.nearest is not None:
                self.distance = min(self.distance, tick.nearest.distance)
