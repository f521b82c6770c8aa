"""A Franka Research 3 at 1 kHz through libfranka: a circle, then targets at 30 Hz with irregular delays.

    python examples/11_franka.py                        with franky-sim, a simulated robot that this program starts
    python examples/11_franka.py --torques              by torques instead of joint positions
    python examples/11_franka.py --robot 172.16.0.2     with a real robot

The control loop of libfranka has a cycle of 1 ms and accepts joint positions or torques. The robot rejects positions
with a velocity, acceleration or jerk out of bounds, and torques that change by more than 1 Nm in a cycle. The tracker
keeps its commands within all bounds on positions. The torques are tick.torque without gravity, which the robot adds,
and a stiffness and a damping of the joints. TorqueBounds leave the feedback a tenth of the efforts. From late and
irregular poses with gaps, a TargetFilter computes a motion that the arm can follow. This program has never run on a
robot: start slowly, with the stop button at hand. Ctrl-C brings the arm to rest and ends the program.
"""

from __future__ import annotations

import argparse
import signal
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from threading import Event
from typing import NamedTuple

import numpy as np

import fpbm_cpp as fp

try:
    import pylibfranka as franka
except ImportError:
    sys.exit("this example needs libfranka: pip install pylibfranka franky-sim")

DT = 1e-3  # A tick, equal to the cycle of the robot [s].
ARM = fp.SerialArm.preset("fr3")
MARGIN = 1e-3  # Distance that libfranka's own limiter keeps from every bound (kLimitEps).
LIMITS = replace(
    ARM.limits,
    velocity=ARM.limits.velocity - MARGIN,
    acceleration=ARM.limits.acceleration - MARGIN,
    jerk=ARM.limits.jerk - MARGIN,
    velocity_offset=ARM.limits.velocity_offset + MARGIN,
)
# The jerk determines the change of the feed-forward torques in a cycle: less than 0.7 Nm, also if a target jumps. With
# 5000 rad/s^3, the change is more than 7 Nm (test_libfranka_rejects_no_feed_forward).
TORQUE_LIMITS = replace(LIMITS, jerk=np.full(7, 250.0))
TORQUE_STEP = DT * (1000 - MARGIN)  # Largest change of a torque in a cycle [Nm] (kMaxTorqueRate).
# Stiffness [Nm/rad] and damping [Nm s/rad] of libfranka's example joint_impedance_control.cpp.
STIFFNESS = np.array([600, 600, 600, 600, 250, 150, 50])
DAMPING = np.array([50, 50, 50, 50, 30, 25, 15])
WEIGHTS = [8, 8, 4, 4, 2, 1, 1]  # Larger near the base, where joints carry more.

CIRCLE = fp.Circle(0.08, 3.0, time_law="quintic").in_plane("xy")  # radius [m], duration [s]
TIP = {"velocity": 0.5, "acceleration": 1.5, "jerk": 30.0}  # Bounds of the filter on position [m, s].
TURN = {"angular_velocity": 1.0, "angular_acceleration": 3.0, "angular_jerk": 60.0}  # Bounds on orientation [rad, s].

interrupted = Event()


class Target(NamedTuple):
    """A pose [m], the time of its observation and the time of its arrival, from the start of the stream [s]."""

    comes: float
    stamp: float
    x: np.ndarray


def hand(start: np.ndarray, t: float) -> np.ndarray:
    """The pose of a moving hand: sideways, up and down and about the vertical axis for 3 s, then constant."""
    sideways, up = np.sin(np.pi * min(t, 3.0) / np.array([2.0, 1.5])) ** 2
    x = start.copy()
    x[:3, 3] += 0.0, 0.1 * sideways, 0.06 * up
    x[:3, :3] = fp.rotation([0, 0, 0.3 * sideways]) @ x[:3, :3]
    return x


def stream(start: np.ndarray, seconds: float, seed: int = 1) -> list[Target]:
    """Poses of the hand from a camera at 30 Hz, with a jitter of 10 ms and a delay of 5 to 40 ms.

    One pose in ten is lost, and there are no poses from 1.2 to 1.6 s.
    """
    rng = np.random.default_rng(seed)
    targets = []
    for t in np.arange(0, seconds, 1 / 30):
        stamp = max(0.0, t + rng.uniform(-0.01, 0.01))
        comes = stamp + rng.uniform(0.005, 0.04)
        if rng.random() > 0.1 and not 1.2 < stamp < 1.6:
            targets.append(Target(comes, stamp, hand(start, stamp)))
    return sorted(targets, key=lambda target: target.comes)


def ticks(tracker: fp.Tracker, path: fp.Path, targets: list[Target]) -> Iterator[fp.Tick]:
    """One tick per millisecond without end: along the path, toward the targets, and at rest at the last target."""
    follower = tracker.follow(path)
    while not follower.done:
        yield tracker.tick(follower)
    target_filter = fp.TargetFilter(tracker.tip, **TIP, **TURN)
    waiting = list(targets)
    t = 0.0
    while True:
        while waiting and waiting[0].comes <= t:
            target = waiting.pop(0)
            target_filter.push(target.x, target.stamp)
        yield tracker.tick(target_filter)
        t += DT


@dataclass
class Motion:
    """Joint positions of every tick [rad], indices, times and torques of the commands, and results."""

    q: list[np.ndarray]  # The first entry is the start posture.
    sent: list[int] = field(default_factory=list)  # Indices of the commands in q.
    time: list[float] = field(default_factory=list)  # Times of the commands by the robot's clock [s].
    desired: list[list[float]] = field(default_factory=list)  # Commands that the robot reported at these times.
    torque: list[np.ndarray] = field(default_factory=list)  # Commands without gravity [Nm], with --torques.
    measured: list[list[float]] = field(default_factory=list)  # Positions at these times [rad].
    error: list[np.ndarray] = field(default_factory=list)  # Tip errors relative to the path or the filter [m], [rad].
    statuses: Counter[str] = field(default_factory=Counter)

    def missed(self) -> int:
        """Number of milliseconds without a command."""
        return len(self.q) - len(self.sent)

    def shares(self) -> dict[str, float]:
        """Largest fraction of each limit over all joints, by finite differences of the positions, from rest to rest."""
        q = np.array([self.q[0]] * 3 + self.q + [self.q[-1]] * 3)
        middle, half = (LIMITS.upper + LIMITS.lower) / 2, (LIMITS.upper - LIMITS.lower) / 2
        used = {"position": abs(q - middle) / half}
        for order, name in enumerate(("velocity", "acceleration", "jerk"), 1):
            used[name] = abs(np.diff(q, order, axis=0)) / DT**order / getattr(LIMITS, name)
        if self.torque:
            used["torque"] = abs(np.array(self.torque)) / LIMITS.effort
            used["change of torque"] = abs(np.diff(self.torque, axis=0, prepend=np.zeros((1, 7)))) / TORQUE_STEP
        return {name: float(share.max()) for name, share in used.items()}


def loaded(state: franka.RobotState) -> fp.SerialArm:
    """The arm with the hand and the load that are configured in the robot."""
    inertia = np.reshape(state.I_total, (3, 3))  # Symmetric.
    return ARM.with_payload(state.m_total, com=state.F_x_Ctotal, inertia=inertia)


def tracker_of(arm: fp.SerialArm, start: np.ndarray, *, torques: bool) -> fp.Tracker:
    """A tracker from the start. With torques, a tenth of the efforts is for the feedback."""
    scheme = fp.FPBM(0.6, WEIGHTS, k1=20, k2=100, null_damping=4, rest_posture=start, null_stiffness=4)
    limits = TORQUE_LIMITS if torques else LIMITS
    bounds = [fp.TorqueBounds(fraction=0.9)] if torques else []
    return fp.Tracker(arm, scheme, start, task="pose", dt=DT, limits=limits, bounds=bounds)


def move(robot: franka.Robot, path: fp.Path = CIRCLE, seconds: float = 4.0, *, torques: bool = False) -> Motion:
    """Move along a path, then toward targets for some seconds, then stop. Raises the exceptions of libfranka."""
    state = robot.read_once()
    arm, start = loaded(state) if torques else ARM, np.array(state.q)
    tracker = tracker_of(arm, start, torques=torques)
    motion = Motion([start])
    feed_forward = torque = np.zeros(arm.dof)
    due = ticks(tracker, path, stream(tracker.tip, seconds))
    enough = (path.duration + seconds) / DT
    lost = stopping = finished = False

    if torques:
        control = robot.start_torque_control()
    else:
        control = robot.start_joint_position_control(franka.ControllerMode.JointImpedance)
    while not finished:
        # The tracker continues from its own command, which the robot follows, and does not use the measured state. The
        # first call has no tick. A call after lost packets has several ticks, because the robot continued to move.
        state, period = control.readOnce()
        for _ in range(round(period.to_sec() / DT)):
            tick = next(due)
            if torques:
                feed_forward = tick.torque - arm.gravity(motion.q[-1])  # The robot adds gravity.
            motion.q.append(tick.q)
            motion.error.append(tick.error)
            motion.statuses[tick.status.name] += 1
            lost = lost or fp.failed(tick.status)
        speed = abs(tracker.qd).max()
        if interrupted.is_set() or lost or (len(motion.q) > enough and speed < 1e-3):
            tracker.stop()
            stopping = True
        finished = stopping and speed < 1e-9
        if torques:
            feedback = STIFFNESS * (motion.q[-1] - state.q) + DAMPING * (tracker.qd - state.dq)
            # Only after lost packets, the change exceeds the largest change.
            torque = torque + np.clip(feed_forward + feedback - torque, -TORQUE_STEP, TORQUE_STEP)
            motion.torque.append(torque)
            command = franka.Torques(torque.tolist())
        else:
            command = franka.JointPositions(motion.q[-1].tolist())
        command.motion_finished = finished
        motion.sent.append(len(motion.q) - 1)
        motion.time.append(state.time.to_sec())
        motion.desired.append(state.tau_J_d if torques else state.q_d)
        motion.measured.append(state.q)
        control.writeOnce(command)
    return motion


SERVE = "import signal; signal.alarm({}); from franky_sim import run_server_main; run_server_main()"


@contextmanager
def simulator(lifetime: int = 120) -> Iterator[str]:
    """The address of a simulated robot on the loopback interface, a separate process that ends with the block.

    The process also ends after its lifetime [s], because libfranka may wait for a robot without a timeout.
    Raises RuntimeError if the process does not start.
    """
    command = [sys.executable, "-u", "-c", SERVE.format(lifetime), "--simulator", "mujoco"]
    # In a separate session, so that Ctrl-C stops the arm and not the simulator.
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True) as process:
        try:
            said = next((line for line in process.stdout or () if line.startswith("Connect")), None)
            if said is None:
                raise RuntimeError("franky-sim did not start: pip install franky-sim")
            yield said.split("'")[1]
        finally:
            process.kill()


def report(motion: Motion) -> None:
    tip = 1e3 * np.linalg.norm(np.array(motion.error)[:, :3], axis=1)
    shares = ", ".join(f"{name} {share:.3f}" for name, share in motion.shares().items())
    statuses = ", ".join(f"{count} {name}" for name, count in motion.statuses.items())
    print(f"{len(motion.q)} cycles, {motion.missed()} of them missed; ticks: {statuses}")
    print(f"largest tip error: {tip.max():.4f} mm")
    print(f"{len(motion.sent)} commands sent; largest fraction of each limit: {shares}")
    if motion.torque:
        off = np.array(motion.q)[motion.sent] - motion.measured
        print(f"joints off by at most {', '.join(f'{1e3 * largest:.1f}' for largest in abs(off).max(axis=0))} mrad")


def main() -> None:
    parser = argparse.ArgumentParser(description="A circle, then targets at irregular times, through libfranka.")
    parser.add_argument("--robot", metavar="ADDRESS", help="a real robot instead of a simulated robot")
    parser.add_argument("--torques", action="store_true", help="torques instead of joint positions")
    options = parser.parse_args()
    signal.signal(signal.SIGINT, lambda *_: interrupted.set())
    if options.robot is not None:
        report(move(franka.Robot(options.robot), torques=options.torques))
        return
    with simulator() as address:
        robot = franka.Robot(address, franka.RealtimeConfig.kIgnore)  # A simulation needs no real-time kernel.
        report(move(robot, torques=options.torques))


if __name__ == "__main__":
    try:
        main()
    except RuntimeError as error:  # From libfranka, or if the simulator does not start.
        sys.exit(str(error))
