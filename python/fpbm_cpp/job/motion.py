"""A job made real: its blanks filled, its arm, path and scheme built, ready to run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .._core import check_sweep
from .._types import Array
from ..arms import Arm, JointLimits
from ..errors import ParameterError, suggestion
from ..motion.run import Run
from ..motion.simulation import simulate
from ..motion.tracking import track
from ..parameter import parameters
from ..paths import Path
from ..schemes import Scheme
from ..table import from_table
from .errors import JobError, within
from .fill import filled, taken
from .sections import SECTIONS, RunOptions, Table, tidy


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
        said, path = self.job["arm"], self.job["path"]
        arm = {
            "preset": said.get("name"),
            "planar": f"planar arm of {self.arm.dof} links",
            "urdf": f"{said.get('file')} to {said.get('tip')}",
        }.get(said["kind"], f"arm of {self.arm.dof} joints")
        return f"{arm}, {' then '.join(each['kind'] for each in (path if isinstance(path, list) else [path]))}"

    @property
    def keywords(self) -> dict[str, Any]:
        """The keyword arguments of sweep() and tune() that say how it is run."""
        options = self.options
        return {"dt": options.dt, "hold": options.hold, "task": options.task, "limits": self.limits}

    def scheme_with(self, options: Mapping[str, Any]) -> Scheme:
        """Its scheme with other options. Raises JobError."""
        problems: list[ParameterError] = []
        scheme = _made("scheme", {**self.job["scheme"], **options}, problems, self.arm)
        if problems:
            raise JobError(*problems)
        return scheme  # type: ignore[no-any-return]

    def run(self) -> Run:
        """The motion: simulate()'s or, where limits are kept, track()'s; as far as it goes where it must stop early."""
        keywords = {**self.keywords, "qd0": self.options.qd0}
        with within(self.job, "run"):
            if self.limits is not None:
                return track(self.arm, self.path, self.scheme, self.q0, **keywords)
            del keywords["limits"]
            return simulate(self.arm, self.path, self.scheme, self.q0, partial=True, **keywords)


def prepare(job: Table) -> Motion:
    """Build what a job asks for.

    Raises JobError with everything that is wrong with it, OSError where a file that it names cannot be read.
    """
    problems: list[ParameterError] = []
    for key in job:
        if key not in SECTIONS:
            text = f"{key}: a job has no such key: must be one of {', '.join(SECTIONS)}{suggestion(key, SECTIONS)}"
            problems.append(ParameterError(key, None, job[key], text))
    if "arm" not in job:
        problems.append(ParameterError("arm", None, None, "arm: is missing"))
    arm = _made("arm", _with_tip(job["arm"]), problems) if "arm" in job else None
    full = filled(job, arm)
    path = _made("path", full["path"], problems)
    scheme = _made("scheme", full["scheme"], problems, arm)
    options = _made("run", full["run"], problems)
    limits = _limits(job["limits"], arm, problems) if "limits" in job else None
    if problems:
        raise JobError(*problems)
    with within(full, "run"):
        check_sweep(arm, path, [scheme], options.q0, options.dt, options.hold, options.task)
    tidied = {section: tidy(section, full[section]) for section in SECTIONS if section in full}
    return Motion(tidied, list(taken(job, tidied)), arm, path, scheme, options, limits)


def _made(section: str, said: Any, problems: list[ParameterError], arm: Arm | None = None) -> Any:
    """What a section stands for; None where it has problems."""
    kinds = SECTIONS[section]
    if section in kinds and isinstance(said, dict):  # Of one kind, which is not said.
        said = {"kind": section, **said}
    found: list[ParameterError] = []
    thing = from_table(said, kinds, section, arm=arm, problems=found)
    problems.extend(found)
    return thing


def _with_tip(arm: Any) -> Any:
    """An arm's table; a URDF file without a tip says what links there are."""
    return {"tip": "", **arm} if isinstance(arm, dict) and arm.get("kind") == "urdf" else arm


def _limits(said: Any, arm: Arm | None, problems: list[ParameterError]) -> JointLimits | None:
    """The arm's own limits but for what is said, of each joint or of all."""
    if not isinstance(said, dict):
        return _made("limits", said, problems)  # type: ignore[no-any-return]
    if arm is None:
        return None
    own = arm.limits
    whole = {name: getattr(own, name) for name in parameters(JointLimits)}
    for key, value in said.items():
        whole[key] = (
            np.full(arm.dof, value) if isinstance(value, (int, float)) and not isinstance(value, bool) else value
        )
    limits: JointLimits | None = _made("limits", whole, problems)
    bounded = limits is not None and np.isfinite([limits.lower, limits.upper, limits.velocity]).any(axis=0)
    if "acceleration" not in said and np.any(bounded & np.isinf(own.acceleration)):
        text = "limits.acceleration: is missing, and this arm has no acceleration bounds: 10 (rad/s^2) is usual"
        problems.append(ParameterError("limits.acceleration", None, None, text))
    return limits
