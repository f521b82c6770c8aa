"""What is wrong with a job, one plain line each: the key with its whole path, the value, and what it must be."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from .section import Section

# Keys that the library calls otherwise.
ALIASES = {"plane": "in_plane", "turn": "with_rotation", "q0s": "q0"}


@dataclass(frozen=True)
class Complaint:
    """One thing that is wrong: where, as in 'path.radius', and what, as in ' = -1: must be positive'."""

    where: str
    what: str


class JobError(ValueError):
    """A job that cannot be run, and everything that is wrong with it.

    Attributes
    ----------
    complaints : tuple of Complaint
        One at least.
    """

    def __init__(self, *complaints: Complaint) -> None:
        super().__init__("\n".join(complaint.where + complaint.what for complaint in complaints))
        self.complaints = complaints


@contextmanager
def within(sections: dict[str, Section], first: str) -> Iterator[None]:
    """Turn what the library says of an argument into what is wrong with a job's key.

    sections: a job's, by their names; the first of them to have a key of that name is the one, `first` before all.
    """
    try:
        yield
    except JobError:
        raise
    except ValueError as error:
        text = str(error).removeprefix("schemes[0]: ")  # A sweep numbers its schemes.
        name, part, rest = re.findall(r"^(\w*)((?:\.\w+)?)(.*)$", text, re.DOTALL)[0]
        if name in sections:
            raise JobError(Complaint(name + part, rest)) from None
        key = ALIASES.get(name, name)
        for section in (first, *sections):
            if key in type(sections[section]).model_fields:
                raise JobError(Complaint(f"{section}.{key}", part + rest)) from None
        raise JobError(Complaint(first, f": {text}")) from None
