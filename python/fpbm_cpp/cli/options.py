"""Options made from the declarations of what a job may say: one for each key, by its name."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import click
import numpy as np

from ..job.sections import FREE, SECTIONS, known
from ..parameter import REQUIRED, Parameter

HEADINGS = {
    "arm": "Arm and start",
    "run": "Arm and start",
    "path": "Path",
    "scheme": "Scheme",
    "limits": "Joint limits",
}
METAVARS = {"tip": "LINK", "base": "LINK", "in_plane": "AXES"}
# What jobs take where nothing is given and the arm decides.
TAKEN = {"base": "the root", "q0": "a ready one", "qd0": "at rest", "in_plane": "yz in space", "weights": "ones"}


class Value(click.ParamType):  # type: ignore[type-arg]
    """A number, or several: '1,2; 3,4' has two rows. What is none stays text, which the job refuses."""

    name = "value"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Any:
        try:
            rows = [_row(row) for row in value.split(";")]
        except ValueError:
            return value
        return rows if len(rows) > 1 else rows[0]


def _row(text: str) -> Any:
    """Numbers between commas; one number where there is no comma."""
    numbers = [float(part) for part in text.split(",") if part.strip() or "," not in text]
    return numbers if "," in text else numbers[0]


class Word(click.Choice):  # type: ignore[type-arg]
    """One of a few words, which shells complete. The job says what is wrong with another."""

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Any:
        return value


class JobOption(click.Option):
    """An option for a key of a job, listed under what it is about."""

    def __init__(self, section: str, key: str, flag: str, **attributes: Any) -> None:
        super().__init__([flag, f"{section}__{key}"], default=None, **attributes)
        self.section, self.key, self.heading = section, key, HEADINGS[section]


def job_options(*, kind: bool) -> Iterator[JobOption]:
    """The options of a job: all, or without the kind of scheme."""
    urdf = known("arm", "urdf")
    yield _option("arm", "tip", replace(urdf["tip"], help="Link of a URDF file to move."))
    yield _option("arm", "base", replace(urdf["base"], help="Link of a URDF file that stays."))
    for key, declared in known("run").items():
        yield _option("run", key, declared)
    for section, usual in FREE.items():
        keys = {each: known(section, each) for each in (usual, *SECTIONS[section])}
        if kind or section != "scheme":
            words = Word(list(SECTIONS[section]))
            yield JobOption(section, "kind", f"--{section}", type=words, help=f"Which; {usual} unless given.")
        for key in dict.fromkeys(key for each in keys for key in keys[each] if key != "second_task"):
            having = [each for each in keys if key in keys[each]]
            yield _option(section, key, keys[having[0]][key], of=having if len(having) < 3 else [])
    text = "Keep them: the arm's, but for those below. Where it has no accelerations, give some: 10 rad/s^2 is usual."
    yield JobOption("limits", "keep", "--limits/--no-limits", help=text)
    for key, declared in known("limits").items():
        yield _option("limits", key, declared, prefix="limit-")


def _option(section: str, key: str, declared: Parameter, prefix: str = "", of: Sequence[str] = ()) -> JobOption:
    """The option for a key, of a few kinds only where these are named."""
    several = bool(declared.shape)
    kind: Any = Value() if several or declared.type in (float, int) else str
    kind = Word(declared.choices) if declared.choices and not several else kind
    metavar = None if isinstance(kind, Word) else METAVARS.get(key, "NUMBERS" if several else "NUMBER")
    usual = [] if declared.usual in (REQUIRED, None) else np.ravel(declared.usual).tolist()
    taken = TAKEN.get(key) or ",".join(f"{x:g}" if isinstance(x, float) else str(x) for x in usual)
    extra = "; ".join(filter(None, [declared.unit, f"default: {taken}" if taken else ""]))
    text = f"{', '.join(of)}: {declared.help}" if of else declared.help
    flag = f"--{prefix}{key.replace('_', '-')}"
    return JobOption(section, key, flag, type=kind, metavar=metavar, help=f"{text}  [{extra}]" if extra else text)
