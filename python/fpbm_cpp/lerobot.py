"""Robots of LeRobot that execute every action within the bounds of their joints.

SafeRobot needs no import of LeRobot: each robot with the methods of `lerobot.robots.Robot` is accepted.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from math import floor, pi
from typing import Any

import numpy as np

from ._core import JointStream
from ._types import Array
from .arms import Arm
from .errors import ParameterError, wrong
from .joints import JointLimits
from .robots import Robot

__all__ = ["SafeRobot"]

SUFFIX = ".pos"  # End of the keys of joints in actions of LeRobot.
PAUSE = 0.1  # Longest motion between two steps [s]. In a longer pause of the loop, the robot holds its last command.
ROUNDING = 1e-6  # Fraction of a tick.


class _Units:
    """Conversion of the actions of joints, of a robot of LeRobot, to radians and back.

    An action of value v is the angle `scale * (v - zero)`.
    """

    def __init__(self, bus: Any, joints: Sequence[str], given: str | None) -> None:
        if given not in (None, "radians", "degrees"):
            raise wrong("units", given, f" = {given!r}: must be 'radians', 'degrees' or None")
        if given is None and bus is None:
            raise wrong("units", given, " = None: the robot has no motor bus: must be 'radians' or 'degrees'")
        fixed = {"radians": 1.0, "degrees": pi / 180}
        pairs = [(fixed[given], 0.0) if given else _normalisation(bus, joint) for joint in joints]
        columns = np.array(pairs).T
        self.scale: Array = columns[0]
        self.zero: Array = columns[1]

    def radians(self, values: Array) -> Array:
        return self.scale * (values - self.zero)

    def values(self, q: Array) -> Array:
        return q / self.scale + self.zero


def _normalisation(bus: Any, joint: str) -> tuple[float, float]:
    """Scale and zero of a motor as `MotorsBus` of LeRobot defines its values; zero is the middle of the range."""
    motor = bus.motors[joint]
    mode = str(getattr(motor.norm_mode, "value", motor.norm_mode))
    if mode == "degrees":
        return pi / 180, 0.0
    given = bus.calibration[joint]
    span = 2 * pi * (given.range_max - given.range_min) / (bus.model_resolution_table[motor.model] - 1)
    centre, width = {"range_m100_100": (0.0, 200.0), "range_0_100": (50.0, 100.0)}[mode]
    return span / width, centre


class _Part:
    """An arm of the robot: the keys of its joints, and its stream."""

    def __init__(
        self, robot: Any, prefix: str, arm: Arm | Robot, units: str | None, seen: Mapping[str, Any], **options: Any
    ) -> None:
        self.keys = [f"{prefix}{name}{SUFFIX}" for name in arm.joint_names]
        missing = [key for key in self.keys if key not in seen]
        if missing:
            raise wrong("arms", arm, f": {missing[0]!r} is not in the observation: must be one of {sorted(seen)}")
        owner = getattr(robot, f"{prefix}arm", robot)  # Robots with two arms have left_arm and right_arm.
        self.units = _Units(getattr(owner, "bus", None), arm.joint_names, units)
        q0 = self.units.radians(np.array([float(seen[key]) for key in self.keys]))
        self.stream = JointStream(arm, q0, start=0.0, **options)


class SafeRobot:
    """A robot of LeRobot, whose actions become motions within the bounds on velocity, acceleration and jerk.

    robot is a connected follower. arms is the arm of the robot, or for several arms a mapping from the prefix of the
    keys to the arm: {"left_": arm, "right_": arm}. The names of the joints are the names of the motors. Keys of other
    motors, such as a gripper, are sent without a change. units is 'radians' or 'degrees', or None for the units of the
    motor bus, with its calibration. limits replaces the limits of each arm. dt, timeout and delay are as for
    JointStream: for single actions, a delay of the period of the loop makes the motion smooth.

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
    ) -> None:
        given = arms if isinstance(arms, Mapping) else {"": arms}
        seen = robot.get_observation()
        self.robot, self.dt = robot, dt
        self.rejected = 0  # Number of rejected actions and chunks.
        self.problem = ""  # Cause of the last rejection.
        options = {"limits": limits, "dt": dt, "timeout": timeout, "delay": delay}
        self._parts = [_Part(robot, prefix, arm, units, seen, **options) for prefix, arm in given.items()]
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
                part.stream.advance()
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
            action.update(zip(part.keys, part.units.values(np.asarray(part.stream.q)).tolist()))
        return {key: action[key] for key in self._keys if key in action}
