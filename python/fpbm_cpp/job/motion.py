"""A job made real: read, its blanks filled, its arm, path and scheme built, ready to run."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path as FilePath
from typing import Any

import numpy as np
import tomlkit
from tomlkit.exceptions import TOMLKitError

from .._core import check_sweep
from .._types import Array
from ..arms import Arm, JointLimits
from ..errors import wrong
from ..io import write_whole
from ..motion.run import Run
from ..motion.simulation import simulate, track
from ..paths import Path
from ..schemes import Scheme
from ..table import to_table
from .fill import filled, taken
from .sections import SECTIONS, JobError, RunOptions, Table, in_order, job_errors, make, require_sound


@dataclass(frozen=True)
class Motion:
    """A motion to be run."""

    job: Table  # What was asked for, with every blank filled.
    taken: list[str]  # What was filled in, as in 'k1 = 10'.
    arm: Arm
    path: Path
    scheme: Scheme
    options: RunOptions
    limits: JointLimits | None  # None where they are not kept.

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
    full = {section: in_order(section, full[section]) for section in SECTIONS if section in full}
    path, scheme, options = (make(section, full[section], arm) for section in ("path", "scheme", "run"))
    limits = make("limits", job["limits"], arm) if "limits" in job else None
    if limits is not None and "acceleration" not in job["limits"]:
        bounded = np.isfinite([limits.lower, limits.upper, limits.velocity]).any(axis=0)
        if np.any(bounded & np.isinf(limits.acceleration)):
            missing = ": is missing, and this arm has no acceleration bounds: 10 (rad/s^2) is usual"
            raise JobError(wrong("limits.acceleration", None, missing))
    motion = Motion(full, list(taken(job, full)), arm, path, scheme, options, limits)
    with job_errors():
        try:
            check_sweep(arm, path, [scheme], options.q0, options.dt, options.hold, options.task)
        except ValueError:
            motion.run()  # Refuses the same, by the names that a job has for it.
            raise
    return motion


def read_job(file: str | os.PathLike[str]) -> Table:
    """What a TOML file says, as yet unchecked. Raises JobError where it is no TOML, or OSError.

    Files that it names are seen from its folder.
    """
    try:
        table: Table = tomlkit.parse(FilePath(file).read_bytes()).unwrap()
    except (TOMLKitError, UnicodeDecodeError) as error:
        raise JobError(wrong("", None, f"no TOML: {error}")) from None
    arm = table.get("arm")
    if isinstance(arm, dict) and isinstance(arm.get("file"), str):
        arm["file"] = os.path.normpath(FilePath(file).parent / arm["file"])
    return table


def write_job(job: Table, file: str | os.PathLike[str]) -> None:
    """Write a job that is sound to a file, whole or not at all; read_job reads it back. Raises OSError."""
    place = FilePath(file).resolve()
    table = {section: in_order(section, job[section]) for section in SECTIONS if section in job}
    if "file" in table["arm"]:
        try:
            table["arm"]["file"] = FilePath(os.path.relpath(table["arm"]["file"], place.parent)).as_posix()
        except ValueError:  # On another drive.
            table["arm"]["file"] = str(FilePath(table["arm"]["file"]).resolve())
    write_whole(place, f"# fpbm-cpp track --job {place.name}\n\n{tomlkit.dumps(table)}".encode())
