"""The last ten seconds of a motion, relative to its bounds."""

from collections.abc import Sequence

import numpy as np

from .._core import Tick
from .._types import Array
from ..joints import JointLimits

SECONDS = 10.0
POINTS = 200  # Points of a curve.


class Strip:
    """Speed, acceleration and jerk of the joint closest to its bound, relative to this bound, and the task scale.

    shares has a row for each quantity and a column for each tick of the last ten seconds, shape (4, N); 0 without a
    bound. A stack has a scale for each level, shape (3 + levels, N). The jerk of a tick is the difference of its mean
    acceleration from the mean acceleration of the previous tick, divided by the length of a tick.
    """

    def __init__(self, limits: JointLimits, dt: float, levels: int = 1) -> None:
        self._dt, self._count = dt, 0
        self._bounds = np.array([limits.velocity, limits.acceleration, limits.jerk], dtype=float)
        self._before = np.zeros(len(limits.velocity))
        self._width = max(round(SECONDS / dt / POINTS), 1)
        self._shares = np.empty((3 + levels, 0))

    def add(self, ticks: Sequence[Tick]) -> None:
        """Add consecutive ticks, at least one."""
        qd, qdd = np.array([tick.qd for tick in ticks]), np.array([tick.qdd for tick in ticks])
        jerk = np.diff(qdd, axis=0, prepend=self._before[None]) / self._dt
        shares = [(np.abs(each) / bound).max(axis=1) for each, bound in zip((qd, qdd, jerk), self._bounds)]
        scales = np.array([tick.scale if tick.scales is None else tick.scales for tick in ticks])
        new = np.vstack([*shares, scales.reshape(len(ticks), -1).T])
        self._before, self._count = qdd[-1], self._count + len(ticks)
        self._shares = np.hstack([self._shares, new])[:, -(POINTS + 1) * self._width :]

    @property
    def shares(self) -> Array:
        return self._shares

    @property
    def bounded(self) -> tuple[bool, ...]:
        """Whether any joint has a bound on speed, acceleration, jerk."""
        return tuple(np.isfinite(self._bounds).any(axis=1).tolist())

    def curves(self) -> tuple[Array, Array]:
        """Times [s], shape (POINTS,), and the worst of the interval that ends at each time, shape (3 + levels, POINTS).

        An interval always has the same ticks, so a peak keeps its height while the chart scrolls. NaN before the start.
        """
        end = self._shares.shape[1] - self._count % self._width
        there = self._shares[:, :end][:, -POINTS * self._width :]
        there = np.pad(there, [(0, 0), (POINTS * self._width - there.shape[1], 0)], constant_values=np.nan)
        stretches = there.reshape(-1, POINTS, self._width)
        worst = np.vstack([stretches[:3].max(axis=2), stretches[3:].min(axis=2)])
        times: Array = (self._count // self._width + np.arange(1.0 - POINTS, 1.0)) * self._width * self._dt
        return times, worst
