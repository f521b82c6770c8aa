"""A job made real: its blanks filled, its arm, path and scheme built, ready to run."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .._core import check_sweep
from .._types import Array
from ..arms import Arm, JointLimits
from ..errors import ParameterError
from ..motion.run import Run
from ..motion.simulation import simulate, track
from ..paths import Path
from ..schemes import Scheme
from ..table import to_table
from .file import write_job
from .fill import filled, taken
from .make import JobError, job_errors, make, require_sound
from .sections import SECTIONS, RunOptions, Table, in_order


@dataclass(frozen=True)
class Motion:
    """A motion to be run.

    Attributes
    ----------
    job : dict
        What was asked for, with every blank filled.
    taken : list of str
        What was filled in, as in 'k1 = 10'.
    arm, path, scheme, limits
        What moves, along what, how, and within what; limits is None where they are not kept.
    options : RunOptions
        From where, and how it is run.
    """

    job: Table
    taken: list[str]
    arm: Arm
    path: Path
    scheme: Scheme
    options: RunOptions
    limits: JointLimits | None

    @property
    def q0(self) -> Array:
        """Joint positions at the start [rad]."""
        assert self.options.q0 is not None
        return self.options.q0

    @property
    def label(self) -> str:
        """What to call the arm and the path."""
        arm, path = self.job["arm"], self.job["path"]
        name = arm.get("name") or arm.get("file") or f"arm of {self.arm.dof} joints"
        return f"{name}, {' then '.join(each['kind'] for each in (path if isinstance(path, list) else [path]))}"

    @property
    def keywords(self) -> dict[str, Any]:
        """The keyword arguments of sweep() and tune() that say how it is run."""
        options = self.options
        return {"dt": options.dt, "hold": options.hold, "task": options.task, "limits": self.limits}

    def with_scheme(self, options: Mapping[str, Any]) -> Motion:
        """The motion with other options of its scheme. Raises JobError."""
        scheme = {**self.job["scheme"], **{key: to_table(value) for key, value in options.items()}}
        return replace(self, job={**self.job, "scheme": scheme}, scheme=make("scheme", scheme, self.arm))

    def save(self, file: str | os.PathLike[str]) -> None:
        """Write the job to a file, whole or not at all. Raises OSError."""
        write_job(self.job, file)

    def run(self) -> Run:
        """The motion: simulate()'s or, where limits are kept, track()'s; as far as it goes where it must stop early."""
        keywords = {**self.keywords, "qd0": self.options.qd0}
        with job_errors():
            if self.limits is not None:
                return track(self.arm, self.path, self.scheme, self.q0, **keywords)
            del keywords["limits"]
            return simulate(self.arm, self.path, self.scheme, self.q0, partial=True, **keywords)


def prepare(job: Table) -> Motion:
    """Build what a job asks for.

    Raises JobError with everything that is wrong with it, OSError where a file that it names cannot be read.
    """
    require_sound(job)
    arm = make("arm", job["arm"])
    full = filled(job, arm)
    path, scheme, options = (make(section, full[section], arm) for section in ("path", "scheme", "run"))
    limits = make("limits", job["limits"], arm) if "limits" in job else None
    if limits is not None and "acceleration" not in job["limits"]:
        bounded = np.isfinite([limits.lower, limits.upper, limits.velocity]).any(axis=0)
        if np.any(bounded & np.isinf(limits.acceleration)):
            text = "limits.acceleration: is missing, and this arm has no acceleration bounds: 10 (rad/s^2) is usual"
            raise JobError(ParameterError("limits.acceleration", None, None, text))
    motion = Motion({}, [], arm, path, scheme, options, limits)
    with job_errors():
        try:
            check_sweep(arm, path, [scheme], options.q0, options.dt, options.hold, options.task)
        except ValueError:
            motion.run()  # Refuses the same, by the names that a job has for it.
            raise
    whole = {section: in_order(section, full[section]) for section in SECTIONS if section in full}
    return replace(motion, job=whole, taken=list(taken(job, whole)))
