"""Motions with the longest known ticks, and the times of these ticks on this machine if Python calls them.

bench/search_worst.cpp found the motions with the largest number of executed basic blocks. worst_motions.txt has the
numbers that define each motion. bench/worst.hpp explains these numbers and reads the same file.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Iterator
from dataclasses import replace
from importlib import resources
from typing import Any, NamedTuple

import numpy as np

from ._core import Tracker, rotation
from ._types import Array
from .arms import SerialArm
from .schemes import FPBM, Balanced
from .tasks import PoseTask, PositionTask, PostureTask, Stack

PHASES, NUMBERS = 6, 13
FAR, TURN, FAST = 0.8, 1.5, 1.5  # Largest displacement [m], rotation [rad] and rates [m/s, rad/s] along each axis.
SHORTEST, LONGEST = 10, 160  # Least and largest number of ticks of a phase.
DT = 1e-3
PASSES = 3  # Largest number of passes of a saturation per joint.


class Times(NamedTuple):
    """Tick times of a case [us], each the least of several runs, and the bound on the saturation passes of a tick."""

    case: str
    free: float
    median: float
    most: float  # p99.9
    worst: float
    passes: int


def motions() -> dict[str, Array]:
    """Numbers of the cases with one arm and no clearance; bench/worst.cpp also has a clearance and two arms."""
    text = (resources.files(__package__) / "worst_motions.txt").read_text(encoding="utf-8")
    lines = [line.split() for line in text.splitlines()]
    return {
        name: np.array([float(each) for each in numbers])
        for name, _, *numbers in lines
        if name.startswith("panda/") and not name.endswith("_clear")
    }


def tracker(case: str, numbers: Array) -> Tracker:
    """Tracker of a case, at the start of the motion with these numbers."""
    panda = SerialArm.preset("panda")
    limits = panda.limits if case.endswith(("_jerk", "_levels")) else replace(panda.limits, jerk=None)
    middle = (limits.upper + limits.lower) / 2
    q0 = middle + 0.95 * numbers[: panda.dof] * (limits.upper - middle)
    if case.endswith("_levels"):
        elbow = panda.joint_names[3]
        stack = Stack([PoseTask(name="tip")], [PositionTask(elbow, name="elbow")], PostureTask(q0))
        balanced = Balanced(0, np.ones(panda.dof), null_damping=2)
        return Tracker(panda, balanced, q0, stack=stack, limits=limits)
    scheme = FPBM(0.6, np.arange(1.0, panda.dof + 1), k1=20, k2=100, null_damping=2)
    return Tracker(panda, scheme, q0, task="pose" if "/pose" in case else "position", limits=limits)


def _references(case: str, tip: Any, numbers: Array) -> Iterator[tuple[Any, ...]]:
    """Arguments of Tracker.tick(), tick by tick."""
    start = tip["tip"] if isinstance(tip, dict) else tip
    for phase in numbers.reshape(PHASES, NUMBERS):
        displacement, turned, rates = FAR * phase[:3], TURN * phase[3:6], FAST * phase[6:12]
        for k in range(SHORTEST + int((phase[12] + 1) / 2 * (LONGEST - SHORTEST))):
            moved = displacement + k * DT * rates[:3]
            if "/position" in case:
                yield start + moved, rates[:3]
                continue
            pose = np.array(start)
            pose[:3, 3] += moved
            pose[:3, :3] = rotation(turned + k * DT * rates[3:]) @ pose[:3, :3]
            levels = {"tip": (pose, rates), "elbow": tip["elbow"] - displacement / 2} if isinstance(tip, dict) else None
            yield (pose, rates) if levels is None else (levels,)


def tick_times(case: str, numbers: Array, runs: int) -> Array:
    """Least time of each tick of a motion over the runs [us], to exclude interruptions by the machine."""
    least: Array = np.empty(0)
    for _ in range(runs):
        loop = tracker(case, numbers)
        times = []
        for arguments in _references(case, loop.tip, numbers[loop.q.size :]):
            begin = time.perf_counter_ns()
            loop.tick(*arguments)
            times.append(time.perf_counter_ns() - begin)
        least = np.minimum(least, times) if least.size else np.array(times, dtype=float)
    return least / 1e3


def free_motion(joints: int) -> Array:
    """Numbers of a motion with a slow target: 1.5 cm/s and 0.015 rad/s along and about each axis."""
    numbers = np.zeros(joints + PHASES * NUMBERS)
    numbers[joints + 6 : joints + 12] = 0.01
    numbers[joints + 12] = 1.0
    return numbers


def measure(runs: int) -> Iterator[Times]:
    """Tick times of each case."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        for case, numbers in motions().items():
            joints = numbers.size - PHASES * NUMBERS
            free = tick_times(case, free_motion(joints), runs)[LONGEST - 1]
            times = tick_times(case, numbers, runs)
            most = PASSES * joints * (6 if case.endswith("_levels") else 2 if case.endswith("_jerk") else 1)
            yield Times(case, free, np.median(times), np.quantile(times, 0.999), times.max(), most)
    finally:
        if enabled:
            gc.enable()
