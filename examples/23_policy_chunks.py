"""A policy sends chunks of joint postures, late and with jumps, to an SO-101 and to a Panda.

Each chunk has 16 postures at 15 Hz, from the time of the observation. The inference takes 0.1 to 0.3 s, and once 1 s.
A new chunk continues elsewhere by 20 to 70 mrad, because the policy decodes each chunk from another state. One chunk
is not finite, one is for a robot with another number of joints, one arrives twice, and two arrive in the wrong order.
A forwarder interpolates the newest chunk linearly. A JointStream keeps the bounds.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

import fpbm_cpp as fp

PERIOD, HORIZON, EXECUTED = 1 / 15, 16, 8  # [s], postures, postures until the next observation
SECONDS = 10.0
READY = {
    "so101": [0.0, -0.35, 0.7, 1.2, 0.0],  # [rad]
    "panda": [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785],
}
TICKS = {"so101": 0.01, "panda": 0.001}  # Period of the commands [s].


class Chunk(NamedTuple):
    comes: float  # [s]
    stamp: float  # Time of the observation, and of the first posture [s].
    postures: np.ndarray


def policy(home: np.ndarray) -> list[Chunk]:
    """Chunks in the order of their arrival."""
    chunks, joint = [], np.arange(len(home))
    for number in range(round(SECONDS / (EXECUTED * PERIOD))):
        stamp = number * EXECUTED * PERIOD
        t = stamp + PERIOD * np.arange(HORIZON)
        motion = 0.3 * np.sin(1.2 * t)[:, None] ** 2 * np.cos(joint)
        jump = (0.045 + 0.025 * np.sin(3 * number + joint)) * (-1.0) ** (number + joint)
        inference = 1.0 if number == 9 else 0.2 + 0.1 * np.sin(5 * number)
        chunks.append(Chunk(stamp + inference, stamp, home + motion + jump))
    chunks[4].postures[3, 1] = np.nan
    chunks[6] = chunks[6]._replace(postures=chunks[6].postures[:, :-1])
    chunks.append(chunks[12])
    return sorted(chunks, key=lambda chunk: chunk.comes)


def motion(home: np.ndarray, dt: float, receive: Callable[[Chunk], object], command: Callable[[float], object]):
    """Commands at each tick, and the number of chunks for which `receive` returned True."""
    waiting, q, taken = policy(home), [home] * 3, 0
    for tick in range(1, round(SECONDS / dt)):
        while waiting and waiting[0].comes <= tick * dt:
            taken += bool(receive(waiting.pop(0)))
        q.append(np.array(command(tick * dt)))
    return np.array(q), taken


class Forwarder:
    """The newest finite chunk of the right size, interpolated linearly."""

    def __init__(self, home: np.ndarray) -> None:
        self.newest = Chunk(0.0, 0.0, home[None])

    def receive(self, chunk: Chunk) -> bool:
        sound = chunk.postures.shape[1] == self.newest.postures.shape[1] and bool(np.isfinite(chunk.postures).all())
        if sound:
            self.newest = chunk
        return sound

    def command(self, now: float) -> list[float]:
        times = self.newest.stamp + PERIOD * np.arange(len(self.newest.postures))
        return [np.interp(now, times, joint) for joint in self.newest.postures.T]


class Shield:
    """A JointStream of an arm."""

    def __init__(self, arm: fp.SerialArm, home: np.ndarray, limits: fp.JointLimits, dt: float) -> None:
        self.stream = fp.JointStream(arm, home, limits=limits, dt=dt, start=0.0)

    def receive(self, chunk: Chunk) -> bool:
        try:
            return self.stream.push_chunk(chunk.postures, period=PERIOD, stamp=chunk.stamp)
        except fp.ParameterError:  # A wrong shape, or a posture far out of range.
            return False

    def command(self, now: float) -> np.ndarray:
        self.stream.advance()
        return self.stream.q


if __name__ == "__main__":
    for name, ready in READY.items():
        arm, home, dt = fp.SerialArm.preset(name), np.array(ready), TICKS[name]
        limits = arm.limits
        if not np.isfinite(limits.jerk).all():
            limits = replace(limits, jerk=20 * limits.acceleration)
        for kind, loop in {"forwarder": Forwarder(home), "JointStream": Shield(arm, home, limits, dt)}.items():
            q, taken = motion(home, dt, loop.receive, loop.command)
            rates = {order: np.abs(np.diff(q, order, axis=0)) / dt**order for order in (1, 2, 3)}
            shares = [np.max(rates[1] / limits.velocity), np.max(rates[2] / limits.acceleration)]
            shares.append(np.max(rates[3] / limits.jerk))
            text = ", ".join(f"{share:.3g}" for share in shares)
            print(
                f"{name}, {kind}: {taken} of {len(policy(home))} chunks; velocity, acceleration, jerk / bound: {text}"
            )
