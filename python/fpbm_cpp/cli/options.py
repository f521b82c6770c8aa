"""Options made from the sections of a job: one for each key, by its name."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, get_args

import click
from pydantic.fields import FieldInfo

from ..job.arms import Urdf
from ..job.model import Limits, RunOptions
from ..job.paths import AnyPath
from ..job.schemes import AnyScheme
from ..job.section import Section

PATHS: tuple[type[Section], ...] = get_args(get_args(AnyPath)[0])
SCHEMES: tuple[type[Section], ...] = get_args(get_args(AnyScheme)[0])

METAVARS = {"tip": "LINK", "base": "LINK", "in_plane": "AXES"}


def kind_of(model: type[Section]) -> str:
    """The kind that a section of this class has."""
    return str(get_args(model.model_fields["kind"].annotation)[0])


class Value(click.ParamType):  # type: ignore[type-arg]
    """A number, or several: '1,2; 3,4' has two rows. What is none stays text, which the job refuses."""

    name = "value"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Any:
        if not isinstance(value, str):
            return value
        try:
            rows = [_row(row) for row in value.split(";")]
        except ValueError:
            return value
        return rows if len(rows) > 1 else rows[0]


class Word(click.Choice):  # type: ignore[type-arg]
    """One of a few words, which shells complete. The job says what is wrong with another."""

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Any:
        return value


class JobOption(click.Option):
    """An option for a key of a job, listed under what it is about."""

    def __init__(self, section: str, key: str, flag: str, heading: str, **attributes: Any) -> None:
        super().__init__([flag, f"{section}__{key}"], **attributes)
        self.section, self.key, self.heading = section, key, heading


def job_options(*, kind: bool = True) -> Callable[[Any], Any]:
    """Give a command the options of a job: all, or without the kind of scheme."""

    def add(function: Any) -> Any:
        for option in reversed(list(_options(kind))):
            function.__click_params__ = [*getattr(function, "__click_params__", ()), option]
        return function

    return add


def _options(kind: bool) -> Iterator[click.Option]:
    for key in ("tip", "base"):
        yield _option("arm", key, Urdf.model_fields[key], "Arm and start")
    for key, field in RunOptions.model_fields.items():
        yield _option("run", key, field, "Arm and start")
    yield JobOption(
        "path",
        "kind",
        "--path",
        "Path",
        type=Word(list(map(kind_of, PATHS))),
        help="Shape of the path; circle unless given.",
    )
    for key, field in _keys(*PATHS):
        yield _option("path", key, field, "Path")
    if kind:
        words = Word(list(map(kind_of, SCHEMES)))
        yield JobOption("scheme", "kind", "--scheme", "Scheme", type=words, help="fpbm unless given.")
    for key, field in _keys(*reversed(SCHEMES)):
        yield _option("scheme", key, field, "Scheme")
    yield JobOption(
        "limits",
        "keep",
        "--limits/--no-limits",
        "Joint limits",
        default=None,
        help="Keep them; options below do so, too. URDF files have none of accelerations: give some.",
    )
    for key, field in Limits.model_fields.items():
        yield _option("limits", key, field, "Joint limits", prefix="limit-")


def _keys(*models: type[Section]) -> Iterator[tuple[str, FieldInfo]]:
    """The keys of all kinds that an option can say."""
    keys: dict[str, FieldInfo] = {}
    for model in models:
        for key in model.key_order():
            keys.setdefault(key, model.model_fields[key])
    yield from ((key, field) for key, field in keys.items() if key not in ("kind", "second_task"))


def _option(section: str, key: str, field: FieldInfo, heading: str, prefix: str = "") -> JobOption:
    text = field.description or ""
    if field.default is not None and not field.is_required():
        default = field.default if isinstance(field.default, list) else [field.default]
        text += f"  [default: {','.join(f'{x:g}' if isinstance(x, float) else str(x) for x in default)}]"
    words = [word for word in (*get_args(field.annotation), *_words(field.annotation)) if isinstance(word, str)]
    kind: Any = Word(words) if words else str if _is_text(field.annotation) else Value()
    plural = "" if {int, float} & {field.annotation, *get_args(field.annotation)} else "S"
    metavar = None if words else METAVARS.get(key, f"NUMBER{plural}")
    return JobOption(section, key, f"--{prefix}{key.replace('_', '-')}", heading, type=kind, metavar=metavar, help=text)


def _words(annotation: Any) -> list[str]:
    """The words of an optional Literal."""
    return [word for part in get_args(annotation) for word in get_args(part) if isinstance(word, str)]


def _is_text(annotation: Any) -> bool:
    return annotation is str or str in get_args(annotation)


def _row(text: str) -> Any:
    """Numbers between commas; one number where there is no comma."""
    numbers = [_number(part) for part in text.split(",") if part.strip() or "," not in text]
    return numbers if "," in text else numbers[0]


def _number(text: str) -> int | float:
    try:
        return int(text)
    except ValueError:
        return float(text)
