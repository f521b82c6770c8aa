"""The naive forwarders: each posture is sent to the robot as received, held or interpolated, for bench/streams.py."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from streams_checks import Libfranka
from streams_robots import machine
from streams_shield import Shield
from streams_sources import WIFI_RATE, Array, Message, Task, hostile, policy, postures, steady, wifi

import fpbm_cpp as fp


def forward(q0: Array, messages: Iterator[Message], seconds: float, *, linear: bool, rate: float, dt: float) -> Array:
    """Postures at each tick: of the newest sound chunk, held or interpolated linearly between its postures.

    A single posture is held, or interpolated from the last command within a period of the stream. A chunk that is not
    finite or of a wrong size is discarded, which a forwarder may not even do.
    """
    t = dt * np.arange(round(seconds / dt))
    q = np.tile(q0, (len(t), 1))
    sent = 0
    known = (np.zeros(1), q0[None])  # Times and postures of the newest chunk.

    def send(until: int) -> None:
        nonlocal sent
        if until <= sent:
            return
        now, (times, postures) = t[sent:until], known
        if linear:
            q[sent:until] = np.transpose([np.interp(now, times, joint) for joint in postures.T])
        else:
            q[sent:until] = postures[np.clip(np.searchsorted(times, now + 1e-12, side="right") - 1, 0, None)]
        sent = until

    for message in messages:
        send(min(len(t), int(np.ceil(message.comes / dt))))
        if message.comes >= seconds:
            break
        if not message.sound(len(q0)):
            continue
        if message.period:
            known = message.stamp + message.period * np.arange(len(message.postures)), message.postures
        elif linear:
            last = q[max(sent - 1, 0)]
            known = message.comes + np.array([0.0, 1.0 / rate]), np.array([last, message.postures[0]])
        else:
            known = np.array([message.comes]), message.postures
    send(len(t))
    return q


def streams(
    limits: fp.JointLimits, home: Array, rng: np.random.Generator
) -> dict[str, tuple[Iterator[Message], float]]:
    """Streams and the rate of their postures [Hz]."""
    task = Task(limits, home, rng)
    return {
        "chunks at 30 Hz, steady": (steady(task, 1 / 30), 30.0),
        "postures at 50 Hz, steady": (postures(task, 1 / 50), 50.0),
        "policy, chunks continue": (policy(task, rng, jump=False, stalls=False), 30.0),
        "policy, jumps of 20 to 70 mrad": (policy(task, rng, stalls=False), 30.0),
        "policy, jumps and stalls": (policy(task, rng), 30.0),
        "hostile": (hostile(task, rng, limits), 30.0),
        "teleoperation at 72 Hz, Wi-Fi": (wifi(task, rng), WIFI_RATE),
    }


def forwarders(seed: int, seconds: float, number: int) -> list[tuple[str, str, float, bool]]:
    """Rows of stream, forwarder, motion time until an abort [s], and whether the motion was aborted."""
    libfranka, fr3 = Libfranka(), machine("fr3")
    home = fr3.home
    found = []
    for stream in streams(libfranka.limits, home, np.random.default_rng(0)):

        def messages(stream: str = stream) -> tuple[Iterator[Message], float]:
            return streams(libfranka.limits, home, np.random.default_rng([seed, number, 4]))[stream]

        motions = {}
        for name, linear in {"held": False, "linear": True}.items():
            given, rate = messages()
            motions[name] = forward(home, given, seconds, linear=linear, rate=rate, dt=1e-3)
        for name, tracked in {"JointStream": False, "Tracker": True}.items():
            shield = Shield(fr3.arm, home, messages()[0], limits=libfranka.limits, dt=1e-3, tracked=tracked)
            motions[name] = np.vstack([home, shield.block(round(seconds / 1e-3))])
        for name, q in motions.items():
            abort = libfranka.first_abort(q)
            found.append((stream, name, seconds if abort is None else 1e-3 * abort, abort is not None))
    return found
