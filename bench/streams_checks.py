"""Checks of joint postures by differences, and the conditions of libfranka, for bench/streams.py."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from streams_sources import Array

import fpbm_cpp as fp

KINDS = ("position", "velocity", "acceleration", "jerk")


class Differences:
    """Largest excess over each bound, by differences of successive postures, relative to the bound.

    Positions are relative to the range of the joint. The first posture is at rest.
    """

    def __init__(self, q0: Array, limits: fp.JointLimits, dt: float) -> None:
        self.last, self.limits, self.dt = np.tile(q0, (3, 1)), limits, dt
        self.excess = dict.fromkeys(KINDS, -1.0)

    def add(self, q: Array) -> None:
        q = np.vstack([self.last, q])
        limits, self.last = self.limits, q[-3:]
        if not np.isfinite(q).all():
            self.excess = dict.fromkeys(self.excess, np.inf)
            return
        off = np.maximum(q - limits.upper, limits.lower - q) / (limits.upper - limits.lower)
        found = {"position": float(np.max(off))}
        for order, name in enumerate(KINDS[1:], 1):
            bound = getattr(limits, name)
            found[name] = float(np.max(np.abs(np.diff(q, order, axis=0)) / self.dt**order / bound)) - 1.0
        self.excess = {name: max(found[name], each) for name, each in self.excess.items()}


class Libfranka:
    """The conditions of libfranka, as tests/python/test_franka.py has them, and the limits that keep them."""

    def __init__(self) -> None:
        root = Path(__file__).resolve().parents[1]
        sys.path[:0] = [str(root / "tests/python"), str(root / "examples")]
        import test_franka  # Needs pylibfranka, franky-sim and pytest.

        self.limits: fp.JointLimits = test_franka.limits_with_margin()
        self._conditions: Any = test_franka.violated_conditions

    def violated(self, q: Array) -> set[str]:
        """Conditions that postures violate, one posture in each millisecond."""
        if not np.isfinite(q).all():
            return {"finite"}
        with np.errstate(over="ignore", invalid="ignore"):  # Forwarded postures of any magnitude.
            return self._conditions(1e-3 * np.arange(len(q)), q)

    def first_abort(self, q: Array) -> int | None:
        """Number of postures that the robot executes from rest before a condition is violated; None if all."""
        q = np.vstack([np.tile(q[0], (3, 1)), q])
        low, high = 3, len(q)
        if not self.violated(q):
            return None
        while low + 1 < high:
            middle = (low + high) // 2
            low, high = (low, middle) if self.violated(q[:middle]) else (middle, high)
        return high - 4
