"""A job made real: its blanks filled, its arm, path and scheme built, ready to run."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import _core
from .._core import Arm, JointLimits, Path, PlanarArm, Scheme
from .._types import Array
from ..run import Run
from .complaint import within
from .model import Job
from .paths import AnyPath
from .ready import ready
from .section import Section


@dataclass(frozen=True)
class Motion:
    """A motion to be run.

    Attributes
    ----------
    job : Job
        What was asked for, with every blank filled.
    taken : list of str
        What was filled in, as in 'k1 = 10'.
    arm, path, scheme, limits
        What moves, along what, how, and within what; limits is None where they are not kept.
    """

    job: Job
    taken: list[str]
    arm: Arm
    path: Path
    scheme: Scheme
    limits: JointLimits | None

    @property
    def q0(self) -> Array:
        """Joint positions at the start [rad]."""
        return np.array(self.job.run.q0, dtype=float)

    def scheme_with(self, options: dict[str, Any]) -> Scheme:
        """Its scheme with other options."""
        job = self.job.with_scheme(options)
        with within(job.sections(), "scheme"):
            return job.scheme.build(self.arm)

    def run(self) -> Run:
        """The motion: simulate()'s or, where limits are kept, track()'s; as far as it goes where it must stop early."""
        run = self.job.run
        options: dict[str, Any] = {"dt": run.dt, "hold": run.hold, "qd0": run.qd0, "task": run.task}
        with within(self.job.sections(), "run"):
            if self.limits is None:
                from ..simulate import simulate

                return simulate(self.arm, self.path, self.scheme, self.q0, partial=True, **options)
            from ..track import track

            return track(self.arm, self.path, self.scheme, self.q0, limits=self.limits, **options)


def prepare(job: Job) -> Motion:
    """Build what a job asks for. Raises JobError where the library refuses it, OSError where a file cannot be read."""
    sections = job.sections()
    with within(sections, "arm"):
        arm = job.arm.build()
    full = _filled(job, arm)
    pieces = []
    for name, piece in zip((name for name in sections if name.startswith("path")), full.path):
        with within(sections, name):
            pieces.append(piece.build())
    with within(sections, "scheme"):
        scheme = full.scheme.build(arm)
    with within(sections, "limits"):
        limits = None if full.limits is None else full.limits.build(arm)
    path, run = functools.reduce(Path.then, pieces), full.run
    with within(sections, "run"):
        _core.check_sweep(arm, path, [scheme], np.array(run.q0), run.dt, run.hold, run.task)
    return Motion(full, list(_taken(job, full)), arm, path, scheme, limits)


def _filled(job: Job, arm: Arm) -> Job:
    """The job with what depends on the arm filled in."""
    with within(job.sections(), "run"):
        posture = ready(job.arm, arm, job.run.task) if job.run.q0 is None else job.run.q0
    scheme = job.scheme
    if getattr(scheme, "weights", ()) is None:
        scheme = scheme.model_copy(update={"weights": [1.0] * arm.dof})
    return job.model_copy(
        update={
            "path": [_laid(piece, arm) for piece in job.path],
            "scheme": scheme,
            "run": job.run.model_copy(update={"q0": posture}),
        }
    )


def _laid(piece: AnyPath, arm: Arm) -> AnyPath:
    """A path of the plane laid before an arm in space."""
    if isinstance(arm, PlanarArm) or not piece.flat or piece.in_plane is not None:
        return piece
    return piece.model_copy(update={"in_plane": "yz"})


def _taken(job: Job, full: Job) -> Iterator[str]:
    """What the full job has and the job did not say, but for what is off."""
    sections: list[tuple[Section, Section]] = [
        *zip(job.path, full.path),
        (job.scheme, full.scheme),
        (job.run, full.run),
    ]
    for said, filled in sections:
        for key, value in filled.given().items():
            if key not in said.model_fields_set and value:
                yield f"{key} = {_text(value)}"


def _text(value: Any) -> str:
    if isinstance(value, list):
        if len(value) > 1 and all(entry == value[0] for entry in value):
            return f"{_text(value[0])} for each"
        return f"[{', '.join(map(_text, value))}]"
    return f"{value:g}" if isinstance(value, float) else str(value)
