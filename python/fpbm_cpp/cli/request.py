"""What the command line asks for: a job's file, with the options over it."""

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

from .._core import PRESETS
from ..errors import not_one_of
from ..job import JobError, Motion, prepare, read_job
from ..job.sections import FREE, SECTIONS, Table, known
from .options import JobOption, job_options
from .plain import WIDTH, Plain, file_errors, file_option


def motion_command(short_help: str, examples: str, *, kind: bool = True) -> Callable[[Callable[..., None]], Plain]:
    """A command with ARM, --job, --save-job and the options of a job, all or without the kind of scheme.

    The function gets the request in place of these, and its name is the command's.
    """

    def make(function: Callable[..., None]) -> Plain:
        ours = list(job_options(kind=kind))

        @click.argument("arm", required=False, metavar="ARM")
        @file_option("--job", help="TOML file with what options do not say.")
        @file_option("--save-job", help="Write the job to a TOML file, with all that was taken by default.")
        @functools.wraps(function)
        def call(arm: str | None, job: Path | None, save_job: Path | None, **options: Any) -> None:
            values = {option: options.pop(str(option.name)) for option in ours}
            function(Request(arm, job, save_job, values), **options)

        epilog = "\b\nExamples:" + examples.replace("\n    ", "\n  ")
        command = click.command(function.__name__, short_help=short_help, cls=Plain, epilog=epilog)(call)
        command.params += ours
        return command

    return make


class Request:
    """A job's table, and what the command line calls its keys: what the file says, with the options over it."""

    def __init__(self, arm: str | None, file: Path | None, copy: Path | None, values: dict[JobOption, Any]) -> None:
        if arm is None and file is None:
            raise click.UsageError(f"Missing argument 'ARM': {', '.join(PRESETS)}, planar:1,1,1,1 or a URDF file.")
        self.file, self.copy = file, copy
        self.table = _read(file) if file else {}
        said = {f"{section}.{key}" for section, keys in self.table.items() if isinstance(keys, dict) for key in keys}
        if arm is not None:
            self.table["arm"] = _arm(arm)
        given = {option: value for option, value in values.items() if value is not None}
        for option in sorted(given, key=lambda each: each.key != "kind"):  # What something is, then what it has.
            self._put(option, given[option])
        names = {f"{option.section}.{option.key}": option for option in values}
        self.flags = {key: each.opts[0] for key, each in names.items() if each in given or key not in said}

    @property
    def scheme(self) -> str:
        """The kind of scheme that is asked for."""
        given = self.table.get("scheme")
        return str(given.get("kind")) if isinstance(given, dict) else FREE["scheme"]

    def motion(self, kind: str | None = None, *, at_rest: bool = False) -> Motion:
        """The motion; where a kind of scheme is named, under that one, with what options it has.

        at_rest: whether the command can only begin at rest.
        """
        table = self.table
        if kind is not None:
            given = table.get("scheme", {})
            scheme = _without_foreign("scheme", given, kind) if isinstance(given, dict) else {}
            table = {**table, "scheme": {**scheme, "kind": kind}}
        with self.plain(), file_errors("read"):
            motion = prepare(table)
        if at_rest and motion.options.qd0 is not None:
            command = click.get_current_context().info_name
            raise click.ClickException(f"{command} begins at rest: leave qd0 out, or use track")
        return motion

    def say(self, motion: Motion, *, scheme: bool = True) -> None:
        """Write the job where it is asked for; print what is run, and what was taken where nothing was said."""
        if self.copy is not None:
            with file_errors("write to", self.copy):
                motion.save(self.copy)
        click.echo(f"{motion.label}, {motion.scheme.kind}" if scheme else motion.label)
        if motion.taken:
            click.echo(click.wrap_text(f"by default: {', '.join(motion.taken)}", WIDTH, subsequent_indent="  "))
        click.echo()

    @contextmanager
    def plain(self) -> Iterator[None]:
        """Say what is wrong with the job as the command line calls it, a line each."""
        try:
            yield
        except JobError as error:
            where = f"{self.file}: " if self.file else ""
            lines = [self.flags.get(each.name, where + each.name) + each.problem for each in error.errors]
            raise click.ClickException("\nError: ".join(lines)) from None

    def _put(self, option: JobOption, value: Any) -> None:
        """Set one key of the table."""
        section, key = option.section, option.key
        if key == "keep":
            if value:
                self.table.setdefault("limits", {})
            else:
                self.table.pop("limits", None)
            return
        there = self.table.get(section)
        if isinstance(there, list) and key != "kind":
            many = f"there are {len(there)} {section}s in the file: change them there, or say --{section}"
            raise click.ClickException(f"{option.opts[0]}: {many}")
        if not isinstance(there, dict):
            there = {"kind": FREE[section]} if section in FREE else {}
        if key == "kind" and value in SECTIONS[section]:
            there = _without_foreign(section, there, value)
        self.table[section] = {**there, key: value}


def _read(file: Path) -> Table:
    try:
        with file_errors("read", file):
            return read_job(file)
    except JobError as error:
        raise click.ClickException(f"{file}: {error}") from None


def _arm(text: str) -> Table:
    """The table of an arm that is named in one word."""
    if text in PRESETS:
        return {"kind": "preset", "name": text}
    if text.startswith("planar:"):
        try:
            lengths = [float(length) for length in text[len("planar:") :].rstrip(",").split(",")]
        except ValueError:
            must = "must be planar: and lengths of links, as planar:1,1,1,1"
            raise click.ClickException(f"ARM = {text}: {must}") from None
        return {"kind": "planar", "lengths": lengths}
    if Path(text).suffix or Path(text).exists():
        return {"kind": "urdf", "file": text}
    raise click.ClickException(str(not_one_of("ARM", text, [*PRESETS, "planar:1,1,1,1", "a URDF file"])))


def _without_foreign(section: str, table: Table, kind: str) -> Table:
    """A table without the keys that only other kinds have."""
    foreign = {key for each in SECTIONS[section] for key in known(section, each)} - set(known(section, kind))
    return {key: value for key, value in table.items() if key not in foreign}
