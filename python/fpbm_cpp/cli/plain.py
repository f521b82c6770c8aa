"""Commands that say in one plain line what went wrong, and never with a traceback."""

from __future__ import annotations

import importlib
import signal
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import click


class Plain(click.Command):
    """A command whose options are listed by what they are about; Ctrl-C ends it with 130, a missing extra with 1.

    Warnings are one line, too.
    """

    def invoke(self, context: click.Context) -> Any:
        try:
            with warnings.catch_warnings():
                warnings.showwarning = _say_warning
                return super().invoke(context)
        except KeyboardInterrupt as interrupted:
            click.echo(str(interrupted) or "interrupted; nothing was written", err=True)
            context.exit(130)
        except ImportError as error:
            if "pip install" not in str(error):
                raise
            raise click.ClickException(str(error)) from None

    def format_options(self, context: click.Context, formatter: click.HelpFormatter) -> None:
        groups: dict[str, list[tuple[str, str]]] = {}
        for option in self.get_params(context):
            record = option.get_help_record(context) if isinstance(option, click.Option) else None
            if record:
                groups.setdefault(getattr(option, "heading", "Options"), []).append(record)
        for heading, records in groups.items():
            with formatter.section(heading):
                formatter.write_dl(records)


def _say_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: Any = None,
    line: str | None = None,
) -> None:
    click.echo(f"Warning: {message}", err=True)


def import_undisturbed(*names: str) -> None:
    """Import libraries where they are there, and hold Ctrl-C back meanwhile.

    Both URDF and viewer come with trimesh, which takes one on the way for a part that is not installed, and goes on.
    """
    held: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: held.append(number))
    try:
        for name in names:
            with suppress(ImportError):
                importlib.import_module(name)
    finally:
        signal.signal(signal.SIGINT, before)
    if held:
        raise KeyboardInterrupt


class Complaints(click.ClickException):
    """Several things that are wrong, one line each."""

    def __init__(self, lines: list[str]) -> None:
        super().__init__("\n".join(lines))
        self.lines = lines

    def show(self, file: Any = None) -> None:
        for line in self.lines:
            click.echo(f"Error: {line}", file=file, err=file is None)


def cannot_write(place: object, error: OSError) -> click.ClickException:
    """That a place cannot be written to, and why."""
    if error.strerror is None:
        return click.ClickException(str(error))
    reason = "it is a file" if isinstance(error, FileExistsError) else error.strerror
    return click.ClickException(f"cannot write to {place}: {reason}")


@contextmanager
def writing_to(place: Path) -> Iterator[None]:
    """Say plainly that a place cannot be written to."""
    try:
        yield
    except OSError as error:
        raise cannot_write(place, error) from None
