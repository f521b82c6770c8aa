"""The loop behind a handle that is dragged: targets in, ticks out, at the pace of a clock, without a page."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from .._core import Status, TargetFilter, Tick, Tracker
from .._types import Array
from ..arms import Arm, JointLimits
from ..clearance import Clearance
from ..schemes import Scheme
from ..skeleton import joint_points
from .obstacles import Obstacles
from .strip import Strip

MOST = 0.1  # Simulated at once [s]: what the clock asks for beyond that is dropped.
REPEAT = 0.1  # A handle without news rests: its target is said again after this time [s].
SAID = 0.25  # The status is the worst of this time [s]; a tick is too short to read.


class ServoLoop:
    """An arm that follows targets as they come, within its limits: ticks of a Tracker behind a TargetFilter.

    advance() makes as many ticks as have passed on the clock. A machine that is too slow for them makes fewer:
    simulated time then falls behind the clock, and no bound changes. All calls may come from any thread.

    targets is a filter with bounds of one's own; unless given, the tip's bounds suit the length L of the arm: L per
    second, 5 L/s^2 and 100 L/s^3; 2 rad/s, 10 rad/s^2 and 200 rad/s^3. The other parameters are Tracker's.

    Raises ValueError as Tracker does, and where the filter is for another task or tick.
    """

    def __init__(
        self,
        arm: Arm,
        scheme: Scheme,
        q0: ArrayLike,
        *,
        task: str = "position",
        dt: float = 1e-3,
        limits: JointLimits | None = None,
        targets: TargetFilter | None = None,
        clearance: Clearance | None = None,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.arm, self.task, self.dt = arm, task, dt
        self.limits = arm.limits if limits is None else limits
        self._scheme, self._clock, self._lock = scheme, clock, threading.RLock()
        self._q0 = np.array(q0, dtype=float)
        self._obstacles = Obstacles(clearance, dt)
        self._tracker = self._new_tracker(scheme, self._q0)
        self._targets = self._usual_targets() if targets is None else targets
        self._tracker.tick(self._targets)  # Refuses a filter that does not suit.
        self._said: deque[Status] = deque(maxlen=max(round(SAID / dt), 1))
        self._tick: Tick | None = None
        self._heard: float = 0.0  # When the newest target came, and when the last ticks were made.
        self._last: float = 0.0
        self.restart()

    def push(self, x: ArrayLike) -> bool:
        """A target [m, rad], as TargetFilter.push takes it: whether it is taken."""
        with self._lock:
            now = self._clock()
            # On the ticks' clock, which leaves out what a slow machine drops.
            taken = self._targets.push(x, self._time + self._owed + min(now - self._last, MOST))
            if taken:
                self._target, self._heard = np.array(x, dtype=float), now
            return taken

    def advance(self) -> list[Tick]:
        """Make the ticks that are due."""
        with self._lock:
            now = self._clock()
            if now - self._heard >= REPEAT:
                self.push(self._target)
            self._owed += min(now - self._last, MOST)
            self._last = now
            due = int(self._owed / self.dt)
            self._owed -= due * self.dt
            self._time += due * self.dt
            ticks = [self._one_tick() for _ in range(due)]
            if ticks:
                self._tick = ticks[-1]
                self._said.extend(tick.status for tick in ticks)
                self.strip.add(ticks)
            return ticks

    def drag(self, name: str, way: ArrayLike) -> None:
        """Let an obstacle go to a place this far from where it was given [m], evenly."""
        with self._lock:
            self._obstacles.drag(name, np.array(way, dtype=float))

    def stop(self) -> None:
        """Bring every joint to rest as fast as the limits allow."""
        with self._lock:
            self._stopped = True
            self._tracker.stop()

    def resume(self) -> None:
        """Follow the target again."""
        with self._lock:
            self._stopped = False
            self._tracker.resume()

    def restart(self) -> None:
        """Begin anew, at rest where the arm began, with the target at its tip and obstacles where they were given."""
        with self._lock:
            self._obstacles.restart()
            self._tracker = self._new_tracker(self._scheme, self._q0)
            self._begin()

    @property
    def scheme(self) -> Scheme:
        """The scheme. Assign another one to go on with it from the present state; ValueError if it does not suit."""
        return self._scheme

    @scheme.setter
    def scheme(self, scheme: Scheme) -> None:
        with self._lock:
            now = self._tracker
            self._tracker = self._new_tracker(scheme, now.q, qd0=now.qd, qdd0=now.qdd)
            self._scheme = scheme
            if self._stopped:
                self._tracker.stop()

    @property
    def clearance(self) -> Clearance | None:
        """What the arm keeps clear of, where it is now."""
        return self._obstacles.clearance

    @property
    def q(self) -> Array:
        """Joint positions [rad]."""
        return self._tracker.q

    @property
    def tip(self) -> Array:
        """The tip, shaped as targets are [m, rad]."""
        tip: Array = self._tracker.tip
        return tip

    @property
    def target(self) -> Array:
        """The newest target."""
        return self._target

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._time

    @property
    def tick(self) -> Tick | None:
        """The last tick; None before the first."""
        return self._tick

    @property
    def status(self) -> Status:
        """The worst of the last ticks, of a quarter of a second."""
        with self._lock:
            return max(self._said, key=lambda status: status.value, default=Status.OK)

    @property
    def stopped(self) -> bool:
        """Whether stop() was called last, not resume()."""
        return self._stopped

    def _new_tracker(
        self, scheme: Scheme, q0: Array, *, qd0: Array | None = None, qdd0: Array | None = None
    ) -> Tracker:
        return Tracker(
            self.arm,
            scheme,
            q0,
            task=self.task,
            dt=self.dt,
            limits=self.limits,
            clearance=self._obstacles.clearance,
            qd0=qd0,
            qdd0=qdd0,
        )

    def _one_tick(self) -> Tick:
        self._obstacles.step(self._tracker)
        return self._tracker.tick(self._targets)

    def _begin(self) -> None:
        self._target = self._tracker.tip
        self._targets.reset(self._target)
        self._stopped = False
        self._tick = None
        self._said.clear()
        self.strip: Strip = Strip(self.limits, self.dt)
        self._time: float = 0.0
        self._owed: float = 0.0  # Time that has passed on the clock, and is less than a tick.
        self._heard = self._last = self._clock()

    def _usual_targets(self) -> TargetFilter:
        length = float(np.linalg.norm(np.diff(joint_points(self.arm, self._q0), axis=0), axis=1).sum())
        return TargetFilter(
            self._tracker.tip,
            velocity=length,
            acceleration=5.0 * length,
            jerk=100.0 * length,
            angular_velocity=2.0,
            angular_acceleration=10.0,
            angular_jerk=200.0,
            task=self.task,
            dt=self.dt,
        )
