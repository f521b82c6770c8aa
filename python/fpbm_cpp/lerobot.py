"""Robots of LeRobot that execute every action within the bounds of their joints.

SafeRobot needs no import of LeRobot: each robot with the methods of `lerobot.robots.Robot` is accepted.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from math import ceil, floor, pi
from typing import Any

import numpy as np

from ._core import JointStream, Tick, Tracker
from ._types import Array
from .arms import Arm
from .bounds import Bound, bounds_of
from .errors import ParameterError, wrong
from .joints import JointLimits
from .robots import Robot
from .schemes import FPBM
from .tasks import PostureTask, Stack

__all__ = ["SafeRobot"]

SUFFIX = ".pos"  # End of the keys of joints in actions of LeRobot.
PAUSE = 0.1  # Longest motion between two steps [s]. In a longer pause of the loop, the robot holds its last command.
ROUNDING = 1e-6  # Fraction of a tick.
# Longest tick of a tracker [s]. With ticks of 10 ms, arms at the margin of a clearance do not return to the stream
# (test_two_arms_keep_their_clearance), and the deviation from the stream is up to 0.5 rad
# (test_a_tracker_follows_the_stream).
TICK = 0.001
SHARE = 0.95  # Accelerations and jerks of a stream, relative to the limits of the tracker that follows the stream.
K1, K2 = 40.0, 400.0  # Gains of the tracker, with critical damping [1/s, 1/s^2].


class _Units:
    """Conversion of the actions of joints, of a robot of LeRobot, to radians and back.

    An action of value v is the angle `scale * (v - zero)`.
    """

    def __init__(self, robot: Any, names: Sequence[str], given: str | None) -> None:
        if given not in (None, "radians", "degrees"):
            raise wrong("units", given, f" = {given!r}: must be 'radians', 'degrees' or None")
        fixed = {"radians": 1.0, "degrees": pi / 180}
        pairs = [(fixed[given], 0.0) if given else _normalisation(*_motor(robot, name)) for name in names]
        columns = np.array(pairs).T
        self.scale: Array = columns[0]
        self.zero: Array = columns[1]

    def radians(self, values: Array) -> Array:
        return self.scale * (values - self.zero)

    def values(self, q: Array) -> Array:
        return q / self.scale + self.zero


def _motor(robot: Any, name: str) -> tuple[Any, str]:
    """Motor bus of a joint, and the name of its motor. Robots with two arms have left_arm and right_arm."""
    words = name.split("_")
    for k in range(1, len(words)):
        arm = getattr(robot, "_".join([*words[:k], "arm"]), None)
        if arm is not None:
            return getattr(arm, "bus", None), "_".join(words[k:])
    return getattr(robot, "bus", None), name


def _normalisation(bus: Any, joint: str) -> tuple[float, float]:
    """Scale and zero of a motor as `MotorsBus` of LeRobot defines its values; zero is the middle of the range."""
    if bus is None:
        raise wrong("units", None, " = None: the robot has no motor bus: must be 'radians' or 'degrees'")
    motor = bus.motors[joint]
    mode = str(getattr(motor.norm_mode, "value", motor.norm_mode))
    if mode == "degrees":
        return pi / 180, 0.0
    given = bus.calibration[joint]
    span = 2 * pi * (given.range_max - given.range_min) / (bus.model_resolution_table[motor.model] - 1)
    centre, width = {"range_m100_100": (0.0, 200.0), "range_0_100": (50.0, 100.0)}[mode]
    return span / width, centre


class _Part:
    """An arm of the robot: the keys of its joints, its stream, and the source of its postures."""

    def __init__(
        self,
        robot: Any,
        prefix: str,
        arm: Arm | Robot,
        units: str | None,
        seen: Mapping[str, Any],
        bounds: Sequence[Bound],
        *,
        limits: JointLimits | None,
        dt: float,
        **options: Any,
    ) -> None:
        names = [f"{prefix}{name}" for name in arm.joint_names]
        self.keys = [f"{name}{SUFFIX}" for name in names]
        missing = [key for key in self.keys if key not in seen]
        if missing:
            raise wrong("arms", arm, f": {missing[0]!r} is not in the observation: must be one of {sorted(seen)}")
        self.units = _Units(robot, names, units)
        q0 = self.units.radians(np.array([float(seen[key]) for key in self.keys]))
        self._ticks = max(1, ceil(dt / TICK - ROUNDING)) if bounds else 1
        dt /= self._ticks
        self.source: JointStream | Tracker  # Its q is the posture for the robot.
        self._tick: Callable[[], Tick | None]
        if bounds:
            limits = arm.limits if limits is None else limits.of(arm)
            slower = limits.replace(acceleration=SHARE * limits.acceleration, jerk=SHARE * limits.jerk)
            self.stream = JointStream(arm, q0, limits=slower, dt=dt, start=0.0, **options)
            scheme, stack = FPBM(0.6, np.ones(arm.dof), 0.0, 0.0), Stack(PostureTask(k1=K1, k2=K2))
            # Without recovery, an arm that is blocked moves only if the stream moves.
            self.source = Tracker(arm, scheme, q0, stack=stack, limits=limits, dt=dt, bounds=bounds, recovery=False)
            self._tick = partial(self.source.tick, self.stream)
        else:
            self.source = self.stream = JointStream(arm, q0, limits=limits, dt=dt, start=0.0, **options)
            self._tick = self.stream.advance

    def advance(self) -> Tick | None:
        """Advance by dt. Returns the last tick of the tracker, or None without bounds."""
        for _ in range(self._ticks):
            tick = self._tick()
        return tick


class SafeRobot:
    """A robot of LeRobot, whose actions become motions within the bounds on velocity, acceleration and jerk.

    robot is a connected follower. arms is the arm of the robot, or for several arms a mapping from the prefix of the
    keys to the arm: {"left_": arm, "right_": arm}. The names of the joints are the names of the motors. Keys of other
    motors, such as a gripper, are sent without a change. units is 'radians' or 'degrees', or None for the units of the
    motor bus, with its calibration. limits replaces the limits of each arm. dt, timeout, delay and blend are as for
    JointStream: for single actions, a delay of the period of the loop makes the motion smooth. For chunks of a noisy
    policy, a blend of 0.2 s makes the corrections gentle.

    bounds are a Clearance, TaskBounds and TorqueBounds, as for Tracker. A tracker then follows the stream, and the
    posture of the tracker is sent. If a bound does not admit the motion, the arm slows down or stops, and returns to
    the stream when the bounds admit the motion. `tick` is the last Tick of the tracker: while a bound stops the arm,
    `tick.status` is BLOCKED or STALLED, and `tick.nearest` is the nearest pair of shapes. For a clearance between
    several arms, give one Robot with the joints of all arms.

    Actions that are not finite, of a wrong shape, out of order or far out of range are rejected: `rejected` is the
    number of these actions and chunks, and `problem` is the cause of the last rejection.

    A SafeRobot has all attributes of the robot, so that loops of LeRobot accept a SafeRobot instead of the robot. No
    thread is started.
    """

    def __init__(
        self,
        robot: Any,
        arms: Arm | Robot | Mapping[str, Arm | Robot],
        *,
        dt: float = 0.01,
        units: str | None = None,
        limits: JointLimits | None = None,
        timeout: float = 0.2,
        delay: float = 0.0,
        blend: float = 0.0,
        bounds: Iterable[Bound] = (),
    ) -> None:
        given = arms if isinstance(arms, Mapping) else {"": arms}
        bounds = bounds_of(bounds)
        if bounds and len(given) > 1:
            arms_given = ", ".join(map(repr, given))
            raise wrong("bounds", bounds, f": arms are {arms_given}: must be one arm: join the arms by Robot.from_arms")
        seen = robot.get_observation()
        self.robot, self.dt = robot, dt
        self.rejected = 0  # Number of rejected actions and chunks.
        self.problem = ""  # Cause of the last rejection.
        self.tick: Tick | None = None  # Last tick of the tracker; None before the first tick and without bounds.
        options: dict[str, Any] = {"limits": limits, "dt": dt, "timeout": timeout, "delay": delay, "blend": blend}
        self._parts = [_Part(robot, prefix, arm, units, seen, bounds, **options) for prefix, arm in given.items()]
        of_arms = {key for part in self._parts for key in part.keys}
        self._keys = list(robot.action_features)
        self._others = [key for key in self._keys if key not in of_arms]
        self._waiting: list[tuple[float, list[float]]] = []  # Times and actions of other motors.
        self._sent: dict[str, float] = {key: float(seen[key]) for key in self._others if key in seen}
        self._origin: float | None = None  # Time of the start by the clock of the caller [s].
        self._ticks = 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self.__dict__["robot"], name)

    @property
    def streams(self) -> list[JointStream]:
        """The stream of each arm: the reference, its velocity, and the age of the newest action."""
        return [part.stream for part in self._parts]

    def get_observation(self) -> Any:
        return self.robot.get_observation()

    def send_action(self, action: Mapping[str, Any]) -> dict[str, float]:
        """Move toward an action, at the time of the call. Returns the action that was sent to the robot."""
        return self.step(action, time.monotonic())

    def step(
        self,
        action: Mapping[str, Any] | Sequence[Mapping[str, Any]] | Array | None,
        now: float,
        *,
        period: float | None = None,
        stamp: float | None = None,
    ) -> dict[str, float]:
        """Send the reference of the time now to the robot, and return the sent action.

        action is a new action, a new chunk of actions, or None. A chunk is a sequence of actions, or an array whose
        columns are in the order of `robot.action_features`. period is the time between the actions of a chunk. stamp
        is the time of the observation, and of the first action; by default, now.
        """
        if self._origin is None:
            self._origin = now - self.dt
        due = floor((now - self._origin) / self.dt + ROUNDING) - self._ticks
        most = max(1, round(PAUSE / self.dt))
        if due > most:
            self._origin += (due - most) * self.dt
            due = most
        if action is not None:
            self._push(action, (now if stamp is None else stamp) - self._origin, period)
        for _ in range(due):
            for part in self._parts:
                self.tick = part.advance()
            self._ticks += 1
        return dict(self.robot.send_action(self._action()))

    def _push(self, action: Any, stamp: float, period: float | None) -> None:
        single = isinstance(action, Mapping)
        if not single and period is None:
            raise wrong("period", period, " = None: a chunk needs the time between its actions [s]")
        table = self._table([action] if single else action)
        problem = self._problem(table, period, stamp, single)
        if problem:
            self.rejected, self.problem = self.rejected + 1, problem
            return
        rows = table[:, [self._keys.index(key) for key in self._others]].tolist()
        self._waiting = [(stamp + k * (period or 0.0), row) for k, row in enumerate(rows)]

    def _problem(self, table: Array, period: float | None, stamp: float, single: bool) -> str:
        """Gives the actions to the streams. Returns the cause of a rejection; empty if all streams accept."""
        if table.shape[1:] != (len(self._keys),) or not len(table):
            return f"shape {table.shape}: must be (k, {len(self._keys)})"
        if not np.isfinite(table).all():
            return "a number is not finite"
        for part in self._parts:
            q = part.units.radians(table[:, [self._keys.index(key) for key in part.keys]])
            try:
                if single:
                    taken = part.stream.push(q[0], stamp=stamp)
                else:
                    taken = part.stream.push_chunk(q, period=period, stamp=stamp)
            except ParameterError as error:  # Far out of the range of a joint, as in other units.
                return str(error)
            if not taken:
                return "the stamp is not newer than the last stamp, or from the future"
        return ""

    def _table(self, actions: Any) -> Array:
        """Actions as rows, in the order of the keys; an empty table if the rows differ in length."""
        if len(actions) and isinstance(actions[0], Mapping):
            missing = [key for each in actions for key in self._keys if key not in each]
            if missing:
                raise wrong("action", actions, f": has no {missing[0]!r}: must have the keys {self._keys}")
            actions = [[float(each[key]) for key in self._keys] for each in actions]
        try:
            return np.asarray(actions, dtype=float)
        except ValueError:
            return np.empty((0, 0))

    def _action(self) -> dict[str, float]:
        """Action of the present tick."""
        now = self._ticks * self.dt + ROUNDING * self.dt
        while self._waiting and self._waiting[0][0] <= now:
            self._sent = dict(zip(self._others, self._waiting.pop(0)[1]))
        action = dict(self._sent)
        for part in self._parts:
            action.update(zip(part.keys, part.units.values(np.asarray(part.source.q)).tolist()))
        return {key: action[key] for key in self._keys if key in action}
