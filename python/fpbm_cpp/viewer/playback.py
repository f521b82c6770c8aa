"""A run prepared for drawing: the tip's frame at any sample, and curves through some hundred samples."""

from dataclasses import replace

import numpy as np

from .._types import Array
from ..motion.run import Run
from ..skeleton import joint_points, tip_axes

FRAMES = 500


class Playback:
    """A run prepared for drawing; one that stopped before its first sample has its start as the only sample.

    Curves are drawn through F frames: some of the samples, or all. The tip and its target, shape (F, 3) [m], and the
    manipulability, shape (F,), are those at the frames, the errors' norms those at all samples, shape (N,) [m], [rad].
    """

    def __init__(self, run: Run) -> None:
        self.run = run = run if len(run.t) else _at_start(run)
        self.frames = np.unique(np.linspace(0, len(run.t) - 1, FRAMES).round().astype(int))
        self.tip = in_space(run.positions[self.frames])
        self.target = in_space(run.reference_positions[self.frames])
        self.manipulability = replace(run, q=run.q[self.frames]).manipulability()
        self.tip_error, self.orientation_error = run.error_norms()

    def sample(self, time: float) -> int:
        """The sample nearest to a time."""
        return int(np.abs(self.run.t - time).argmin())

    def frame(self, sample: int) -> int:
        """Index of the last frame that is not after a sample."""
        return int(np.searchsorted(self.frames, sample, side="right")) - 1

    def pose(self, sample: int) -> Array:
        """The tip's frame at a sample, shape (4, 4)."""
        arm, q = self.run.arm, self.run.q[sample]
        R, p, pose = tip_axes(arm, q), joint_points(arm, q)[-1], np.eye(4)
        pose[: len(p), : len(p)], pose[: len(p), 3] = R, p
        return pose


def _at_start(run: Run) -> Run:
    """The start of a run without samples as its only sample."""
    q = run.status.q[None]
    zero = np.zeros_like(q)
    x = np.asarray(run.arm.kinematics(q[0], zero[0], task=run.task).tip)[None]
    error = np.zeros((1, len(run.arm.jacobian(q[0], task=run.task))))
    return replace(run, t=np.zeros(1), q=q, qd=zero, qdd=zero, x=x, x_ref=x, error=error)


def in_space(points: Array) -> Array:
    """Points with three coordinates; z is 0 for points in the plane."""
    return np.pad(points, [(0, 0)] * (points.ndim - 1) + [(0, 3 - points.shape[-1])])
