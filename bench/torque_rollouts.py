"""Random motions within bounds on torque, for bench/torque.py."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from torque_robots import NAMES, Array, Machine, machine

import fpbm_cpp as fp

SECONDS = 3.0
TICKS = (1e-3, 2e-3, 4e-3)
MOST_STOP = 20.0  # A stop that lasts longer than this time does not end [s].
SHORT = 0.05  # Ratios of durations are of stops that last at least this time with full deceleration [s].
WITHOUT = 5  # One of WITHOUT motions is repeated without bounds on torque.


class Motion(NamedTuple):
    """A random motion. The figures of excess are the largest of the motion."""

    name: str
    jerk: bool
    clear: bool
    ticks: int
    ends: float  # Excess of the torques at the start and at the end of each tick [Nm].
    ends_at_rest: float  # The same, only of ticks at rest; -inf if there are none [Nm].
    middle: float  # In the middle of each tick [Nm].
    change_within: float  # Largest excess in the middle beyond the larger of both ends [Nm].
    position: float  # [rad]
    velocity: float  # Relative to the bound, as the next two.
    acceleration: float
    jerks: float
    distance: float  # Smallest distance of a pair beyond the margin [m].
    unanswered: int  # Ticks that raise an error, or whose result is not finite.
    blocked: int  # Ticks that continue the planned stop because the bounds refuse every other motion.
    blocked_at_rest: int  # The same, only of an arm at rest.
    stops: int  # Planned stops that were replayed until rest.
    unstopped: int  # Stops that did not end.
    longest_stop: float  # [s]
    longest_ratio: float  # Largest ratio of the duration of a stop to the duration with full deceleration.
    change: float  # Largest change of the acceleration from tick to tick, relative to the bound on acceleration.
    free_change: float  # The same without bounds on torque; NaN if not measured.
    free_ends: float  # Excess of the torques without bounds on torque; NaN if not measured [Nm].


class Draw(NamedTuple):
    """A robot with bounds, and the start of a motion."""

    made: Machine
    limits: fp.JointLimits
    dt: float
    fraction: float
    start: Array
    bounds: list[Any]
    kind: str  # Kind of the targets: 'pose', 'position' or 'posture'.


def held_posture(made: Machine, share: float, rng: np.random.Generator, most: int = 300) -> Array | None:
    """A random posture that a share of the efforts can hold; None if no posture is found."""
    effort = share * made.arm.limits.effort - made.friction
    low, high = np.maximum(made.limits.lower, -2.9), np.minimum(made.limits.upper, 2.9)
    for _ in range(most):
        q = low + (high - low) * rng.uniform(0.02, 0.98, made.arm.dof)
        if not made.holds(q, effort):
            continue
        near = made.clearance.nearest(made.arm, q) if made.clearance else None
        if near is None or near.distance > 0.012:
            return q
    return None


def draw(name: str, rng: np.random.Generator) -> Draw:
    while True:
        fraction = rng.uniform(0.4, 0.8)
        made = machine(name, rng.choice([0.0, rng.uniform(0.0, 3.0), 3.0]))
        start = held_posture(made, 0.97 * fraction, rng)
        if start is not None:
            break
    given = made.limits
    jerk = given.jerk if np.all(np.isfinite(given.jerk)) else 500.0 * given.acceleration
    if rng.random() < 0.3:
        jerk = given.acceleration / rng.uniform(0.01, 0.1)
    limits = replace(given, jerk=jerk if rng.random() < 0.5 else np.full(made.arm.dof, np.inf))
    bounds: list[Any] = [fp.TorqueBounds(fraction=fraction)]
    if made.clearance is not None and rng.random() < 0.5:
        bounds.append(made.clearance)
    kind = str(rng.choice(["pose", "position", "posture"]))
    return Draw(made, limits, float(rng.choice(TICKS)), fraction, start, bounds, kind)


def tracker_of(given: Draw, bounds: list[Any]) -> tuple[fp.Tracker, Callable[[Array], Any]]:
    """A tracker, and the argument of its tick for a target posture."""
    arm, tips = given.made.arm, given.made.tips
    n = arm.dof
    options: dict[str, Any] = {"dt": given.dt, "limits": given.limits, "bounds": bounds, "stall_time": np.inf}
    options["error_bound"] = 0.5  # Faster than the default.
    scheme = fp.FPBM(0.6, np.ones(n), 0.0, 0.0, null_damping=2.0)  # Of a stack, whose tasks have gains.
    if given.kind == "posture":
        stack = fp.Stack(fp.PostureTask(given.start, name="posture", k1=12.0, k2=36.0))
        return fp.Tracker(arm, scheme, given.start, stack=stack, **options), lambda q: {"posture": q}
    if isinstance(arm, fp.SerialArm):
        scheme = replace(scheme, k1=20.0, k2=100.0)
        tracker = fp.Tracker(arm, scheme, given.start, task=given.kind, **options)
        return tracker, (lambda q: arm.forward(q) if given.kind == "pose" else arm.forward(q)[:3, 3])
    task = fp.PoseTask if given.kind == "pose" else fp.PositionTask
    hands = [task(tip, name=tip, k1=20.0, k2=100.0) for tip in tips]
    stack = fp.Stack(hands, fp.PostureTask(given.start, name="posture", k1=6.0, k2=9.0))

    def targets(q: Array) -> Any:
        poses = {tip: arm.forward(q, tip) for tip in tips}
        return {tip: pose if given.kind == "pose" else pose[:3, 3] for tip, pose in poses.items()} | {"posture": q}

    return fp.Tracker(arm, scheme, given.start, stack=stack, **options), targets


class Record:
    """The commanded motion of a tracker, tick by tick."""

    def __init__(self, tracker: fp.Tracker, margin: float) -> None:
        self.tracker, self.margin = tracker, margin
        self.q, self.qd = [tracker.q], [tracker.qd]
        self.distance, self.blocked, self.blocked_at_rest, self.unanswered = np.inf, 0, 0, 0

    def tick(self, target: Any) -> None:
        try:
            tick = self.tracker.tick(target)
        except Exception:
            self.unanswered += 1
            return
        blocked = tick.status == fp.Status.BLOCKED
        self.blocked += blocked
        self.blocked_at_rest += blocked and not np.any(self.qd[-1])
        self.q.append(tick.q)
        self.qd.append(tick.qd)
        self.unanswered += not (np.isfinite(tick.q).all() and np.isfinite(tick.qd).all())
        if tick.nearest is not None:
            self.distance = min(self.distance, tick.nearest.distance - self.margin)


class Stops(NamedTuple):
    """Stops of a motion; see Motion."""

    stops: int
    unstopped: int
    longest_stop: float
    longest_ratio: float


def ride(given: Draw, bounds: list[Any], rng: np.random.Generator) -> tuple[Record, Stops]:
    """A motion whose targets jump, with stops."""
    tracker, target_of = tracker_of(given, bounds)
    clearance = next((each for each in bounds if isinstance(each, fp.Clearance)), None)
    record = Record(tracker, clearance.margin if clearance else 0.0)
    target = target_of(given.start)
    found = Stops(0, 0, 0.0, 0.0)
    while len(record.q) * given.dt < SECONDS and not record.unanswered:
        q = held_posture(given.made, 0.9 * given.fraction, rng, most=50)
        target = target if q is None else target_of(q)
        for _ in range(int(rng.uniform(0.1, 1.2) / given.dt)):
            record.tick(target)
        if rng.random() < 0.5:
            continue
        tracker.stop()  # The stored stop, tick by tick.
        if rng.random() < 0.3:
            for _ in range(int(rng.integers(1, 60))):
                record.tick(target)
        else:
            begin, full = len(record.q), float(np.max(np.abs(record.qd[-1]) / given.limits.acceleration))
            left = int(MOST_STOP / given.dt)
            while left and np.any(record.qd[-1] != 0.0) and not record.unanswered:
                record.tick(target)
                left -= 1
            lasted = given.dt * (len(record.q) - begin)
            ended = not np.any(record.qd[-1] != 0.0)
            ratio = max(found.longest_ratio, lasted / full if full > SHORT else 0.0)
            found = Stops(found.stops + 1, found.unstopped + (not ended), max(found.longest_stop, lasted), ratio)
        tracker.resume()
    return record, found


class Excess(NamedTuple):
    """Largest excesses of the torques of a motion over their bounds [Nm]; see Motion."""

    ends: float
    ends_at_rest: float
    middle: float
    change_within: float


def torque_excess(given: Draw, record: Record) -> Excess:
    made, h = given.made, given.dt
    bound = given.fraction * made.arm.limits.effort - made.friction
    q, qd = np.array(record.q), np.array(record.qd)
    found = Excess(-np.inf, -np.inf, -np.inf, -np.inf)
    for k, u in enumerate(np.diff(qd, axis=0) / h):
        states = (q[k], qd[k]), (q[k + 1], qd[k + 1]), (q[k] + h / 2 * (qd[k] + h / 4 * u), qd[k] + h / 2 * u)
        start, end, middle = (np.abs(made.torques(*state, u)) - bound for state in states)
        ends = np.maximum(start, end)
        at_rest = -np.inf if np.any(np.abs(qd[k]) > 1e-12) or np.any(u) else np.max(ends)
        found = Excess(*map(max, found, (np.max(ends), at_rest, np.max(middle), np.max(middle - ends))))
    return Excess(*map(float, found))


def motion(seed: int, number: int) -> Motion:
    """The motion with a number."""
    name = NAMES[number % len(NAMES)]
    rng = np.random.default_rng([seed, number])
    given = draw(name, rng)
    rides = np.random.default_rng([seed, number, 1])
    record, stops = ride(given, given.bounds, rides)
    h, limits = given.dt, given.limits
    q, qd = np.array(record.q), np.array(record.qd)
    acceleration = np.diff(qd, axis=0, prepend=0 * qd[:1]) / h
    step = q[1:] - q[:-1] - h / 2 * (qd[1:] + qd[:-1])  # 0 for a constant acceleration.
    jerks = np.diff(acceleration, axis=0) / h / limits.jerk
    free_change = free_ends = np.nan
    if number // len(NAMES) % WITHOUT == 0:
        free, _ = ride(given, given.bounds[1:], np.random.default_rng([seed, number, 1]))
        free_qd = np.array(free.qd)
        change = np.diff(np.diff(free_qd, axis=0, prepend=0 * free_qd[:1]) / h, axis=0)
        free_change = float(np.max(np.abs(change) / limits.acceleration))
        free_ends = torque_excess(given, free).ends
    return Motion(
        name,
        bool(np.isfinite(limits.jerk).all()),
        len(given.bounds) > 1,
        len(q) - 1,
        *torque_excess(given, record),
        float(np.max([q - limits.upper, limits.lower - q])),
        float(np.max(np.abs(qd) / limits.velocity)) - 1.0,
        float(np.max(np.abs(acceleration) / limits.acceleration)) - 1.0 + 1e9 * bool(np.max(np.abs(step)) > 1e-12),
        float(np.max(np.abs(jerks))) - 1.0,
        record.distance,
        record.unanswered,
        record.blocked,
        record.blocked_at_rest,
        *stops,
        float(np.max(np.abs(np.diff(acceleration, axis=0)) / limits.acceleration)),
        free_change,
        free_ends,
    )
