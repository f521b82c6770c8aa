"""Sections of a job: their keys, their errors, and the construction of their objects."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from math import inf
from typing import Any

from .._types import OptionalArrayField
from ..arms import Arm, SerialArm
from ..clearance import CLEARANCES, Clearance
from ..errors import ParameterError, suggestion, wrong
from ..joints import JointLimits
from ..mechanism import PAYLOAD, Payload
from ..parameter import NOT_NEGATIVE, POSITIVE, Data, Parameter, data, parameter
from ..paths import PATHS
from ..robots import ROBOTS, Robot
from ..schemes import SCHEMES
from ..table import BOUNDS, Makers, carrying, from_table, is_by_task, keys, problems
from ..tasks import TASKS

Table = dict[str, Any]


@data
class RunOptions(Data):
    """Options of a run."""

    task: str = parameter(
        "Task of the tip, position or pose; for a job with tasks, the name of the task that follows the path.",
        default="position",
    )
    q0: OptionalArrayField = parameter("Joint positions at the start.", default=None, shape="(n,)", unit="rad")
    qd0: OptionalArrayField = parameter("Joint velocities at the start.", default=None, shape="(n,)", unit="rad/s")
    dt: float = parameter("Time step.", POSITIVE, default=1e-3, unit="s")
    hold: float = parameter("Time at the end of the path.", NOT_NEGATIVE, default=0.0, unit="s")
    keep_path: bool = parameter(
        "Whether the tip stays on the path if the path is faster than the limits allow; keeps joint limits. Without a "
        "duration, the motion is as fast as possible.",
        default=False,
        usual=None,
    )
    reserve: float = parameter(
        "For keep_path: reserve of the duration, relative to the least duration.", NOT_NEGATIVE, default=0.05
    )


# Kinds of each section. run and limits have one kind each, which is not in the file.
SECTIONS: dict[str, Makers] = {
    "arm": ROBOTS,
    "path": PATHS,  # A list of tables is a sequence of paths. A table may have a path or a list for each task name.
    "scheme": SCHEMES,
    "task": TASKS,  # A list of tables: the tasks of a stack.
    "run": {"run": RunOptions},
    "limits": {JointLimits.kind: JointLimits},
    "bounds": BOUNDS,  # A list of tables: bounds of several tasks.
    "clearance": CLEARANCES,  # The kind depends on whether there are capsules.
}
FREE = {"path": "circle", "scheme": "fpbm"}  # The kind if the section is missing.


def known(section: str, kind: object = None) -> dict[str, Parameter]:
    """The keys of a section of this kind; none if the kind does not exist."""
    only = len(SECTIONS[section]) == 1
    maker = SECTIONS[section].get(section if only or kind is None else str(kind))
    return keys(maker) if maker else {}


# The section of each key, because errors of the library have keys without a section.
OWNERS = {
    key: section
    for section in ("clearance", "arm", "path", "limits", "scheme", "run")
    for kind in SECTIONS[section]
    for key in known(section, kind)
}


def with_kind(clearance: Table) -> Table:
    """A clearance with its kind: with capsules if there are any, otherwise from a URDF file."""
    return {"kind": Clearance.kind if "capsules" in clearance else "urdf", **clearance}


def in_order(section: str, said: Any) -> Any:
    """A section with its keys in the order of their declarations."""
    if isinstance(said, list):
        return [in_order(section, each) for each in said]
    if section == "path" and is_by_task(said):
        return {task: in_order(section, each) for task, each in said.items()}
    return {key: said[key] for key in ("kind", *known(section, said.get("kind"))) if key in said}


class JobError(ValueError):
    """A job that cannot be run. errors: all errors, by key, for example 'path.radius'."""

    def __init__(self, *errors: ParameterError) -> None:
        super().__init__("\n".join(map(str, errors)))
        self.errors = errors


@contextmanager
def job_errors() -> Iterator[None]:
    """Raise JobError, with the key of the job, instead of ParameterError."""
    try:
        yield
    except ParameterError as error:
        section, inside, _ = error.name.partition(".")
        # The key task without a section is run.task.
        named = section.partition("[")[0] in SECTIONS and bool(inside or section != "task")
        named |= error.name.startswith("joint '")  # A joint is not a key.
        raise JobError(error if named else error.within(OWNERS.get(error.name, "run"))) from None


def require_sound(job: Table) -> None:
    """Raise JobError with all wrong keys and values, before any object is constructed."""
    no_key = f": is not a key of a job: must be one of {', '.join(SECTIONS)}"
    errors = [wrong(key, job[key], no_key + suggestion(key, SECTIONS)) for key in job if key not in SECTIONS]
    if "arm" not in job:
        errors.append(wrong("arm", None, ": is missing"))
    for section in SECTIONS:
        if section in job:
            errors += problems(_whole(section, job[section]), SECTIONS[section], section, usual=True)
    if errors:
        raise JobError(*errors)


def make(section: str, said: Any, arm: Arm | Robot | None = None) -> Any:
    """Object of a section, for this arm. Raises JobError."""
    with job_errors():
        return from_table(_whole(section, said, arm), SECTIONS[section], section)


def arm_of(job: Table) -> Arm | Robot:
    """The arm of a job. The limits of a job replace bounds of a URDF file before the bounds are checked, unless the job
    has a clearance from a URDF file, whose joints must be the joints of the arm. Raises JobError.
    """
    said, limits = dict(job["arm"]), job.get("limits")
    kind = said.pop("kind")
    if not limits or kind not in ("urdf", "robot") or "file" in job.get("clearance", {}):
        arm: Arm | Robot = make("arm", job["arm"])
        return arm
    payload = said.pop(PAYLOAD.name, None)
    with job_errors():
        own = JointLimits(**limits)
        read = partial(SerialArm.from_urdf, tip=said.pop("tip", "")) if kind == "urdf" else Robot.from_urdf
        try:
            arm = read(said.pop("file"), **said, limits=own)
            if payload is not None:
                arm = carrying(arm, from_table(payload, Payload, PAYLOAD.name))
            return arm
        except ParameterError as error:
            raise error.within("arm") from None
        except ValueError as error:
            raise wrong("arm", None, f": {error}") from None


def _whole(section: str, said: Any, arm: Arm | Robot | None = None) -> Any:
    """A section as a table for from_table(): with its only kind, and limits of all joints, by default the arm's."""
    if section in ("task", "bounds") and isinstance(said, dict):
        said = [said]
    if section == "bounds" and isinstance(said, list):
        return [{"kind": section, **each} if isinstance(each, dict) else each for each in said]
    if not isinstance(said, dict):
        return said
    if section == "clearance":
        said = with_kind(said)
    if section == "arm" and said.get("kind") == "urdf":
        return {"tip": "", **said}  # An empty tip is rejected later, with a list of the links.
    if section == "limits":
        own = {name: getattr(arm.limits, name).tolist() if arm else [inf] for name in known(section)}
        joints = arm.dof if arm else 1
        every = {key: [value] * joints for key, value in said.items() if isinstance(value, (int, float))}
        said = {**own, **said, **every}
    if section == "scheme" and "weights" in known(section, said.get("kind")):
        return {"weights": [1.0], **said}  # A placeholder for the default of the arm.
    return {"kind": section, **said} if len(SECTIONS[section]) == 1 else said
