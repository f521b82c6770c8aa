"""What a command line asks for: a job's file, with the options over it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from ..job import Complaint, Job, JobError, Motion, prepare, read_table, write_job
from ..job.explain import one_of
from .options import PATHS, SCHEMES, JobOption, kind_of
from .plain import Complaints, import_undisturbed, writing_to

PRESETS = ("panda", "iiwa14", "gen3")
KINDS = {"path": {kind_of(each): each for each in PATHS}, "scheme": {kind_of(each): each for each in SCHEMES}}
FREE = {"path": "circle", "scheme": "fpbm"}  # What is taken where there is none.


@dataclass(frozen=True)
class Request:
    """A job's table, and where its keys come from.

    Attributes
    ----------
    table : dict
        What the file says, with the options over it.
    file : Path or None
        The file.
    flags : dict of str to str
        What the command line calls keys that the file does not say: 'path.radius' is '--radius'.
    """

    table: dict[str, Any]
    file: Path | None
    flags: Mapping[str, str]

    def motion(self, kind: str | None = None) -> Motion:
        """The motion; where a kind of scheme is named, under that one, with what options it has."""
        arm = self.table.get("arm")
        if isinstance(arm, dict) and arm.get("kind") == "urdf":
            import_undisturbed("yourdfpy")
        with self.plain():
            try:
                return prepare(Job.of(self.table if kind is None else {**self.table, "scheme": self._scheme(kind)}))
            except OSError as error:
                raise click.ClickException(f"cannot read {error.filename}: {error.strerror}") from None

    @property
    def scheme(self) -> str:
        """The kind of scheme that is asked for."""
        given = self.table.get("scheme")
        return str(given.get("kind")) if isinstance(given, dict) else FREE["scheme"]

    @contextmanager
    def plain(self) -> Iterator[None]:
        """Say what is wrong with the job as the command line calls it."""
        try:
            yield
        except JobError as error:
            raise Complaints([self._line(complaint) for complaint in error.complaints]) from None

    def _line(self, complaint: Complaint) -> str:
        where, what = complaint.where, complaint.what
        if where in self.flags:
            return self.flags[where] + what
        return f"{self.file}: {where}{what}" if self.file else where + what

    def _scheme(self, kind: str) -> dict[str, Any]:
        """The scheme's table for another kind: without the keys that only others have."""
        given = self.table.get("scheme", {})
        if not isinstance(given, dict):
            return {"kind": kind}
        foreign = {key for each in SCHEMES for key in each.model_fields} - set(KINDS["scheme"][kind].model_fields)
        return {**{key: value for key, value in given.items() if key not in foreign}, "kind": kind}


def make_request(arm: str | None, file: Path | None, options: Mapping[str, Any]) -> Request:
    """The request of a command's arguments: options by the names that they have in the command, as in path__radius."""
    names = {
        (option.section, option.key): option.opts[0]
        for option in click.get_current_context().command.params
        if isinstance(option, JobOption)
    }
    given = {key: options["__".join(key)] for key in names if options["__".join(key)] is not None}
    table = _read(file) if file else {}
    if arm is not None:
        table["arm"] = _arm(arm)
    elif file is None:
        raise click.UsageError(f"Missing argument 'ARM': {', '.join(PRESETS)}, planar:1,1,1,1 or a URDF file.")
    for key in sorted(given, key=lambda key: key[1] != "kind"):  # What something is comes before what it has.
        _put(table, *key, given[key], names[key])
    flags = {f"{section}.{key}": flag for (section, key), flag in names.items() if not file or (section, key) in given}
    return Request(table, file, flags)


def save(motion: Motion, file: Path | None) -> None:
    """Write a motion's job, with every blank filled, where a file is given."""
    if file is None:
        return
    with writing_to(file):
        write_job(motion.job, file)


def _read(file: Path) -> dict[str, Any]:
    try:
        return read_table(file)
    except OSError as error:
        raise click.ClickException(f"cannot read {file}: {error.strerror}") from None
    except JobError as error:
        raise click.ClickException(f"{file}: {error}") from None


def _arm(text: str) -> dict[str, Any]:
    """The table of an arm that is named in one word."""
    if text in PRESETS:
        return {"kind": "preset", "name": text}
    kind, colon, lengths = text.partition(":")
    if kind == "planar" and colon:
        numbers = re.split(r",(?!$)", lengths.rstrip(","))
        try:
            return {"kind": "planar", "lengths": [float(number) for number in numbers]}
        except ValueError:
            raise click.ClickException(
                f"ARM = {text}: must be planar: and lengths of links, as planar:1,1,1,1"
            ) from None
    if Path(text).suffix or Path(text).exists():
        return {"kind": "urdf", "file": text}
    raise click.ClickException("ARM" + one_of(text, [*PRESETS, "planar:1,1,1,1", "a URDF file"]))


def _put(table: dict[str, Any], section: str, key: str, value: Any, flag: str) -> None:
    """Set one key of the table."""
    if section == "limits" and key == "keep":
        if value:
            table.setdefault("limits", {})
        else:
            table.pop("limits", None)
        return
    there = table.get(section)
    if section in FREE:
        if isinstance(there, list) and key != "kind":
            raise click.ClickException(
                f"{flag}: there are {len(there)} paths in the file: change them there, or say --path"
            )
        if not isinstance(there, dict):
            there = {"kind": FREE[section]}
        if key == "kind":
            known = KINDS[section].get(value)
            there = {name: there[name] for name in there if known is None or name in known.model_fields}
    elif not isinstance(there, dict):
        there = {}
    table[section] = {**there, key: value}
