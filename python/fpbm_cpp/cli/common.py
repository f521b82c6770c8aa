"""What all commands that move an arm have in common: where the job comes from, and what is said of it."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Callable

import click

from ..job import Motion
from .options import job_options

WIDTH = 100


def motion_command(*, kind: bool = True) -> Callable[[Any], Any]:
    """Give a command ARM, --job, --save-job and the options of a job: all, or without the kind of scheme."""

    def add(function: Any) -> Any:
        function = job_options(kind=kind)(function)
        for decorate in (
            click.option("--save-job", **_file("Write the job to a TOML file, with all that was taken by default.")),
            click.option("--job", **_file("TOML file with what options do not say.")),
            click.argument("arm", required=False, metavar="ARM"),
        ):
            function = decorate(function)
        return function

    return add


def _file(text: str) -> dict[str, Any]:
    return {"metavar": "FILE", "type": click.Path(path_type=Path), "help": text}


def say_job(motion: Motion, *, scheme: bool = True) -> None:
    """Print what is run, and what was taken where nothing was said."""
    job = motion.job
    parts = [job.arm.label, " then ".join(piece.kind for piece in job.path), *([job.scheme.kind] if scheme else [])]
    click.echo(", ".join(parts))
    if motion.taken:
        click.echo(click.wrap_text(f"by default: {', '.join(motion.taken)}", WIDTH, subsequent_indent="  "))
    click.echo()


def require_plain(motion: Motion, command: str) -> None:
    """Refuse what a command that only simulates would have to ignore."""
    if motion.limits is not None:
        raise click.ClickException(f"{command} does not keep joint limits: say --no-limits, or use track")
    if motion.job.run.qd0 is not None:
        raise click.ClickException(f"{command} begins at rest: leave qd0 out, or use track")


@contextmanager
def progress(label: str) -> Iterator[Callable[[int, int], object]]:
    """A function to call with (done, total): how far it is, on one line of the screen, where somebody looks."""
    watched = sys.stderr.isatty()

    def report(done: int, total: int) -> None:
        if watched:
            click.echo(f"\r{label}: {done} of {total}", nl=False, err=True)

    try:
        yield report
    finally:
        if watched:
            click.echo("\r\033[K", nl=False, err=True)
