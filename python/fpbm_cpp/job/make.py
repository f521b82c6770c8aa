"""What a job's sections stand for, and what is wrong with them."""

from collections.abc import Iterator
from contextlib import contextmanager
from math import inf
from typing import Any

from ..arms import Arm
from ..errors import ParameterError, suggestion
from ..table import from_table, problems
from .sections import SECTIONS, Table, known

# The section of a key that the library names without one.
OWNERS = {
    key: section
    for section in ("arm", "path", "limits", "scheme", "run")
    for kind in SECTIONS[section]
    for key in known(section, kind)
}


class JobError(ValueError):
    """A job that cannot be run, and everything that is wrong with it.

    Attributes
    ----------
    errors : tuple of ParameterError
        One at least, named by their keys: 'path.radius'.
    """

    def __init__(self, *errors: ParameterError) -> None:
        super().__init__("\n".join(map(str, errors)))
        self.errors = errors


@contextmanager
def job_errors() -> Iterator[None]:
    """Say by a job's keys what the library refuses: raise JobError for ParameterError."""
    try:
        yield
    except ParameterError as error:
        named = error.name.partition(".")[0] in SECTIONS
        raise JobError(error if named else error.within(OWNERS.get(error.name, "run"))) from None


def require_sound(job: Table) -> None:
    """Raise JobError with all keys and values that are wrong, whatever is made of them."""
    wrong: list[ParameterError] = []
    for key in job:
        if key not in SECTIONS:
            text = f"{key}: a job has no such key: must be one of {', '.join(SECTIONS)}{suggestion(key, SECTIONS)}"
            wrong.append(ParameterError(key, None, job[key], text))
    if "arm" not in job:
        wrong.append(ParameterError("arm", None, None, "arm: is missing"))
    for section in SECTIONS:
        if section in job:
            wrong += problems(_whole(section, job[section]), SECTIONS[section], section, usual=True)
    if wrong:
        raise JobError(*wrong)


def make(section: str, said: Table, arm: Arm | None = None) -> Any:
    """What a section stands for, for this arm. Raises JobError."""
    with job_errors():
        return from_table(_whole(section, said, arm), SECTIONS[section], section, arm=arm)


def _whole(section: str, said: Any, arm: Arm | None = None) -> Any:
    """A section as the library's tables are: with its only kind, and limits of all joints, the arm's unless said."""
    if not isinstance(said, dict):
        return said
    if said.get("kind") == "urdf":
        return {"tip": "", **said}  # Which is refused with what links there are.
    if section == "limits":
        own = {name: getattr(arm.limits, name).tolist() if arm else [inf] for name in known(section)}
        every = {
            key: [value] * (arm.dof if arm else 1) for key, value in said.items() if isinstance(value, (int, float))
        }
        said = {**own, **said, **every}
    if section == "scheme" and "weights" in known(section, said.get("kind")):
        return {"weights": [1.0], **said}  # Which are filled in for the arm.
    return {"kind": section, **said} if section in SECTIONS[section] else said
