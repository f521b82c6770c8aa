"""What is drawn of a run: a posture at any time, and its figures at some hundred instants."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .._core import PlanarArm
from .._types import Array
from ..run import Run
from ..serial_arm import SerialArm
from .space import in_space

FRAMES = 500


@dataclass(frozen=True)
class Film:
    """A run as it is shown; one that stopped before its first sample is a single posture.

    Attributes
    ----------
    run : Run
        What is shown.
    t : numpy.ndarray, shape (N,)
        Times of its samples [s], one at least.
    q, qd, qdd : numpy.ndarray, shape (N, n)
        Joint motion there.
    frames : numpy.ndarray of int, shape (F,)
        The samples that lines and charts are drawn through.
    """

    run: Run

    @cached_property
    def t(self) -> Array:
        return self.run.t if len(self.run.t) else np.zeros(1)

    @cached_property
    def q(self) -> Array:
        return self.run.q if len(self.run.q) else self.run.status.q[None]

    @cached_property
    def qd(self) -> Array:
        return self.run.qd if len(self.run.qd) else np.zeros_like(self.q)

    @cached_property
    def qdd(self) -> Array:
        return self.run.qdd if len(self.run.qdd) else np.zeros_like(self.q)

    @cached_property
    def frames(self) -> Array:
        return np.unique(np.linspace(0, len(self.t) - 1, FRAMES).round().astype(int))

    @cached_property
    def tip(self) -> Array:
        """Tip positions at the frames [m], shape (F, 3)."""
        return in_space(self.run.positions[self.frames]) if len(self.run.t) else self.pose(0)[None, :3, 3]

    @cached_property
    def target(self) -> Array:
        """Where the tip was to be at the frames [m], shape (F, 3)."""
        return in_space(self.run.reference_positions[self.frames]) if len(self.run.t) else self.tip

    @cached_property
    def tip_error(self) -> Array:
        """Distance of the tip from its target at every sample [m]."""
        return self._norms(slice(None, self.run.positions.shape[1]))

    @cached_property
    def orientation_error(self) -> Array:
        """Angle from its orientation to that wanted at every sample [rad], 0 where the task leaves it free."""
        return self._norms(slice(self.run.positions.shape[1], None))

    @cached_property
    def manipulability(self) -> Array:
        """sqrt(det(J J')) at the frames (Yoshikawa, 1985)."""
        J: Array = np.array([self.run.arm.jacobian(q, task=self.run.task) for q in self.q[self.frames]])
        w: Array = np.sqrt(np.maximum(np.linalg.det(J @ J.transpose(0, 2, 1)), 0.0))
        return w

    def at(self, time: float) -> int:
        """The sample nearest to a time."""
        return int(np.abs(self.t - time).argmin())

    def frame(self, sample: int) -> int:
        """The last of the frames that is not after a sample."""
        return int(np.searchsorted(self.frames, sample, side="right")) - 1

    def pose(self, sample: int) -> Array:
        """The tip's frame at a sample, shape (4, 4)."""
        arm, q = self.run.arm, self.q[sample]
        if not isinstance(arm, PlanarArm):
            assert isinstance(arm, SerialArm)
            return arm.forward(q)
        turn = q.sum()
        frame = np.eye(4)
        frame[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
        frame[:2, 3] = arm.forward(q)
        return frame

    def _norms(self, rows: slice) -> Array:
        norms: Array = np.linalg.norm(self.run.error[:, rows], axis=1)
        return norms if len(norms) else np.zeros(1)
