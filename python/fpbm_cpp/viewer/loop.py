"""The loop of a servo without its page: targets in, ticks out, in real time."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._core import Status, TargetFilter, Tick, Tracker
from .._types import Array
from ..arms import Arm
from ..bounds import Bound, bounds_of, clearance_among, largest_torques
from ..clearance import Clearance
from ..joints import JointLimits, limits_of
from ..robots import Robot
from ..schemes import Scheme
from ..skeleton import frames_of, length
from ..tasks import Stack, Task
from .obstacles import Obstacles
from .targets import Targets

SECONDS = 10.0  # Time of the strip.
POINTS = 200  # Points of a curve of the strip.
MOST = 0.1  # Largest simulated time per call [s]; the remaining elapsed time is dropped.
POSTURES = 64  # Number of postures from which change_posture() selects one.
FAR = 0.5  # Least difference of a joint in another posture [rad or m].
SAID = 0.25  # status is the worst status of the last SAID seconds, because a tick is too short to read.


class Strip:
    """Speed, acceleration, jerk and torque of the joint closest to a bound, relative to the bound, and the task scale.

    shares has a row for each quantity and a column for each tick of the last ten seconds, shape (5, N); 0 without a
    bound. A stack has a scale for each level, shape (4 + levels, N). The jerk of a tick is the difference of its mean
    acceleration from the mean acceleration of the previous tick, divided by the length of a tick. The torque is the
    torque of inverse dynamics at the end of the tick. An arm without masses or efforts has no row for torques.
    """

    def __init__(
        self, arm: Arm | Robot, limits: JointLimits, dt: float, bounds: Sequence[Bound] = (), levels: int = 1
    ) -> None:
        self._arm, self._dt, self._count = arm, dt, 0
        self._bounds = np.array([limits.velocity, limits.acceleration, limits.jerk], dtype=float)
        torques = largest_torques(arm, limits, bounds)
        if arm.has_dynamics and np.isfinite(torques).any():
            self._bounds = np.vstack([self._bounds, torques])
        self._before = np.zeros(arm.dof)
        self._width = max(round(SECONDS / dt / POINTS), 1)
        self.shares: Array = np.empty((len(self._bounds) + levels, 0))

    def add(self, ticks: Sequence[Tick]) -> None:
        """Add consecutive ticks, at least one."""
        q, qd, qdd = (np.array([getattr(tick, name) for tick in ticks]) for name in ("q", "qd", "qdd"))
        jerk = np.diff(qdd, axis=0, prepend=self._before[None]) / self._dt
        motions = [qd, qdd, jerk]
        if len(self._bounds) > len(motions):
            motions.append(self._arm.inverse_dynamics(q, qd, qdd))
        shares = [(np.abs(each) / bound).max(axis=1) for each, bound in zip(motions, self._bounds)]
        scales = np.array([tick.scale if tick.scales is None else tick.scales for tick in ticks])
        new = np.vstack([*shares, scales.reshape(len(ticks), -1).T])
        self._before, self._count = qdd[-1], self._count + len(ticks)
        self.shares = np.hstack([self.shares, new])[:, -(POINTS + 1) * self._width :]

    @property
    def bounded(self) -> tuple[bool, ...]:
        """Whether any joint has a bound on speed, acceleration, jerk and, if there is a row, torque."""
        return tuple(np.isfinite(self._bounds).any(axis=1).tolist())

    def curves(self) -> tuple[Array, Array]:
        """Times [s], shape (POINTS,), and the worst of the interval that ends at each time, shape (rows, POINTS).

        An interval always has the same ticks, so a peak keeps its height while the chart scrolls. NaN before the start.
        """
        end = self.shares.shape[1] - self._count % self._width
        there = self.shares[:, :end][:, -POINTS * self._width :]
        there = np.pad(there, [(0, 0), (POINTS * self._width - there.shape[1], 0)], constant_values=np.nan)
        stretches = there.reshape(-1, POINTS, self._width)
        bounds = len(self._bounds)
        worst = np.vstack([stretches[:bounds].max(axis=2), stretches[bounds:].min(axis=2)])
        times: Array = (self._count // self._width + np.arange(1.0 - POINTS, 1.0)) * self._width * self._dt
        return times, worst


class ServoLoop:
    """An arm that follows targets within its limits: ticks of a Tracker with TargetFilters.

    advance() runs the ticks that are due on the clock. If the machine is too slow, fewer ticks run: simulated time is
    then behind the clock, and the bounds are unchanged. Calls may come from any thread.

    A stack replaces task. Each position and pose of the stack has a filter; targets of other tasks are references
    without a filter. The first target of a task is its own x or q, or its start.

    targets and the default filters are as for servo(), all other parameters as for Tracker.

    Raises ValueError as Tracker does, and if a filter is for another task or tick.
    """

    def __init__(
        self,
        arm: Arm | Robot,
        scheme: Scheme,
        q0: ArrayLike,
        *,
        task: str = "position",
        stack: Stack | None = None,
        dt: float = 1e-3,
        limits: JointLimits | None = None,
        targets: TargetFilter | Mapping[str, TargetFilter] | None = None,
        bounds: Sequence[Bound] = (),
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.arm, self.stack, self.dt = arm, stack, dt
        self.limits = limits_of(arm, limits) or arm.limits
        self._how: dict[str, Any] = {"task": task, "stack": stack, "limits": self.limits}
        self._scheme, self._clock, self._lock = scheme, clock, threading.RLock()
        self._q0 = np.array(q0, dtype=float)
        bounds = bounds_of(bounds)
        self._obstacles = Obstacles(clearance_among(bounds), dt)
        self._others = tuple(each for each in bounds if not isinstance(each, Clearance))
        self._tracker = self._new_tracker(scheme, self._q0)  # Rejects an invalid task or stack.
        self._targets = Targets(task, stack, self._tracker.tip, targets, length(arm, self._q0), dt)
        self.tasks: Sequence[Task] = self._targets.tasks
        self._tracker.tick(self._targets.references)  # Rejects an invalid filter.
        self._said: deque[Status] = deque(maxlen=max(round(SAID / dt), 1))
        self.tick: Tick | None = None  # The last tick.
        self._seen: list[Array] = []  # Postures before each change.
        self._last: float = 0.0  # Time of the last ticks.
        self.restart()

    def push(self, x: ArrayLike, task: str | None = None) -> bool:
        """Set a target [m, rad]; for a stack, of the task with that name. Returns whether the target is accepted.

        A target is rejected if a number is not finite, R is not a rotation, or a direction is zero.
        """
        with self._lock:
            now = self._clock()
            return self._targets.push(task, x, now, self._stamp(now))

    def advance(self) -> list[Tick]:
        """Run the ticks that are due."""
        with self._lock:
            now = self._clock()
            self._targets.repeat(now, self._stamp(now))
            self._owed += min(now - self._last, MOST)
            self._last = now
            due = int(self._owed / self.dt)
            self._owed -= due * self.dt
            self.time += due * self.dt
            ticks = []
            for _ in range(due):
                self._obstacles.step(self._tracker)
                ticks.append(self._tracker.tick(self._targets.references))
            if ticks:
                self.tick = ticks[-1]
                self._said.extend(tick.status for tick in ticks)
                self.strip.add(ticks)
            return ticks

    def drag(self, name: str, displacement: ArrayLike) -> None:
        """Move an obstacle to this displacement from its given place [m], with limited velocity and acceleration."""
        with self._lock:
            self._obstacles.drag(name, np.array(displacement, dtype=float))

    @property
    def speed(self) -> float | None:
        """Smallest fraction of their bounds on velocity that the filters use; None without a filter."""
        return self._targets.speed

    def set_speed(self, fraction: float) -> None:
        """Reduce the bounds of all filters on velocity to a fraction in (0, 1]. Raises ParameterError."""
        with self._lock:
            self._targets.set_speed(fraction)

    def stop(self) -> None:
        """Bring every joint to rest as fast as the limits allow."""
        with self._lock:
            self.stopped = True
            self._tracker.stop()

    def resume(self) -> None:
        """Follow the target again."""
        with self._lock:
            self.stopped = False
            self._tracker.resume()

    def restart(self) -> None:
        """Restart at rest at the start of the arm, with the first targets, and obstacles at their given places."""
        with self._lock:
            self._obstacles.restart()
            self._tracker = self._new_tracker(self._scheme, self._q0)
            self.stopped = False
            self.tick = None
            self._seen = []
            self._said.clear()
            levels = 1 if self.stack is None else len(self.stack.levels)
            self.strip: Strip = Strip(self.arm, self.limits, self.dt, self.bounds, levels)
            self.time: float = 0.0  # Simulated time [s].
            self._owed: float = 0.0  # Elapsed time that no tick has simulated [s], less than a tick.
            self._last = self._clock()
            self._targets.restart(self._tracker.tip, self._last)

    def change_posture(self) -> bool:
        """Put the arm at rest into another posture with the same points of all tasks; the nearest that is new.

        Returns whether another posture was found. After the last one, the first posture is next.
        """
        with self._lock:
            points, here = self._tracker.tip, self._tracker.q
            found = self.arm.inverse_all(points, here, POSTURES, bounds=self.bounds, **self._how)
            far = [each.q for each in found if self._is_far(each.q, [here])]
            unseen = [q for q in far if self._is_far(q, self._seen)]
            if not far:
                return False
            self._seen = [*self._seen, here] if unseen else [here]
            self._tracker = self._new_tracker(self._scheme, (unseen or far)[0])
            self._said.clear()
            if self.stopped:
                self._tracker.stop()
            return True

    @property
    def scheme(self) -> Scheme:
        """The scheme. Assign another scheme to continue with it from the present state; ValueError if it is invalid."""
        return self._scheme

    @scheme.setter
    def scheme(self, scheme: Scheme) -> None:
        with self._lock:
            now = self._tracker
            self._tracker = self._new_tracker(scheme, now.q, qd0=now.qd, qdd0=now.qdd)
            self._scheme = scheme
            if self.stopped:
                self._tracker.stop()

    @property
    def clearance(self) -> Clearance | None:
        """The clearance, with its obstacles at their present places."""
        return self._obstacles.clearance

    @property
    def q(self) -> Array:
        """Joint positions [rad]."""
        return self._tracker.q

    @property
    def tip(self) -> Any:
        """The tip, in the shape of targets [m, rad]; for a stack, the point of each task by name."""
        return self._tracker.tip

    @property
    def target(self) -> Any:
        """The newest target; for a stack, the target of each task by name."""
        return self._targets.x

    def target_of(self, task: str) -> Array:
        """The newest target of the task of that name."""
        return self._targets.of(task)

    def frame(self, task: str) -> Array:
        """The frame of the task of that name, shape (4, 4); for an axis, z is its direction."""
        return frames_of(self.arm, self.q, "tip") if self.stack is None else self._tracker.frame(task)

    @property
    def status(self) -> Status:
        """The worst status of the last quarter of a second."""
        with self._lock:
            return max(self._said, key=lambda status: status.value, default=Status.OK)

    @property
    def bounds(self) -> tuple[Bound, ...]:
        """The bounds, with the obstacles at their present places."""
        return self._others if self.clearance is None else (self.clearance, *self._others)

    def _new_tracker(self, scheme: Scheme, q0: Array, **state: Any) -> Tracker:
        return Tracker(self.arm, scheme, q0, dt=self.dt, bounds=self.bounds, **self._how, **state)

    def _is_far(self, q: Array, others: Sequence[Array]) -> bool:
        """Whether a posture differs from others by more than whole turns of joints."""
        turns = self.limits.upper - self.limits.lower >= 2 * np.pi
        for other in others:
            difference = np.abs(q - other)
            wrapped = np.abs(difference - 2 * np.pi * np.round(difference / (2 * np.pi)))
            if np.max(np.where(turns, wrapped, difference)) <= FAR:
                return False
        return True

    def _stamp(self, now: float) -> float:
        """Time on the clock of the ticks, without the time that a slow machine drops."""
        return self.time + self._owed + min(now - self._last, MOST)
