"""A run prepared for drawing: samples and curves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .._core import Nearest
from .._types import Array
from ..clearance import Clearance
from ..motion.run import Run
from ..motion.task_errors import error_parts, tracks
from ..skeleton import task_frames
from ..tasks import PoseTask, PositionTask
from .frames import in_space, point_of

FRAMES = 500


class Playback:
    """A run prepared for drawing. If a run stopped before its first sample, its start is the only sample.

    Curves have F frames: some of the samples, or all. tracks has tip and target for each path at all samples, shape
    (N, 3) [m]; manipulability, shape (F,), is at the frames. errors has the norms of errors at all samples, shape (N,),
    and their units, by name.
    """

    def __init__(self, run: Run, clearance: Clearance | None = None) -> None:
        self.clearance = clearance
        self.run = run = run if len(run.t) else _at_start(run)
        self.frames = np.unique(np.linspace(0, len(run.t) - 1, FRAMES).round().astype(int))
        self.tracks = [(in_space(tip), in_space(target)) for tip, target in tracks(run)]
        self.manipulability = replace(run, q=run.q[self.frames]).manipulability()
        self.errors = _errors(run)
        found = (self.nearest(sample) for sample in self.frames)
        self.distances = np.array([each.distance for each in found if each is not None])

    def sample(self, time: float) -> int:
        """The sample nearest to a time."""
        return int(np.abs(self.run.t - time).argmin())

    def frame(self, sample: int) -> int:
        """Index of the last frame that is not after a sample."""
        return int(np.searchsorted(self.frames, sample, side="right")) - 1

    def nearest(self, sample: int) -> Nearest | None:
        """The nearest pair of shapes at a sample, if any pair is checked."""
        return None if self.clearance is None else self.clearance.nearest(self.run.arm, self.run.q[sample])

    def pose(self, sample: int) -> Array:
        """Frame of the tip at a sample, shape (4, 4); for a Robot, frame of the task that follows the first path."""
        return task_frames(self.run.arm, self.run.q[sample], self.run.tips[0])


def _errors(run: Run) -> dict[str, tuple[Array, str]]:
    """Norms of the errors of the tip; for a stack, of each task."""
    if run.stack is None:
        errors = {"tip error": (np.linalg.norm(run.position_error, axis=1), "m")}
        if run.kind == "pose":
            errors["orientation error"] = np.linalg.norm(run.orientation_error, axis=1), "rad"
        return errors
    kinds = {task.name: task.kind for task in run.stack.tasks}
    errors = {}
    for name, unit, values, _ in error_parts(run):
        part = ", orientation" if kinds[name] == "pose" and unit == "rad" else ""
        errors[f"error of {name}{part}"] = np.linalg.norm(values, axis=1), unit
    return errors


def _at_start(run: Run) -> Run:
    """The start of a run without samples as its only sample."""
    q = run.status.q[None]
    zero = np.zeros_like(q)
    start = replace(run, t=np.zeros(1), q=q, qd=zero, qdd=zero, error=np.zeros((1, run.error.shape[1])))
    x = point_of(
        PoseTask() if run.kind == "pose" else PositionTask(), task_frames(run.arm, q[0], run.tips[0]), run.x.shape[1:]
    )[None]
    start = replace(start, x=x, x_ref=x)
    return start if run.task_errors is None else replace(start, task_errors=np.zeros((1, run.task_errors.shape[1])))
