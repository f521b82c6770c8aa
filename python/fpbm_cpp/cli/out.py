"""What commands write: into one folder, each file whole or not at all."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..io.write_whole import write_whole
from .plain import file_errors, file_option

if TYPE_CHECKING:
    from matplotlib.figure import Figure

out_option = file_option(
    "--out", metavar="DIR", help="Folder to write to, made where missing; other files in it are left alone."
)
dark_option = click.option("--dark", is_flag=True, help="Pictures on a dark ground.")


class Folder:
    """A folder that is made for the first file at the latest, and knows what was written."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.written: list[str] = []

    def made(self) -> Folder:
        """The folder, made at once, before work that would be lost."""
        with file_errors("write to", self.path):
            self.path.mkdir(parents=True, exist_ok=True)
        return self

    def write(self, name: str, write: Callable[[Path], Any]) -> None:
        """Whatever write(file) writes."""
        with file_errors("write to", self.path / name):
            self.path.mkdir(parents=True, exist_ok=True)
            try:
                write(self.path / name)
            except ValueError as error:  # A motion without a sample has no animation.
                raise click.ClickException(f"cannot write {name}: {error}") from None
        self.written.append(name)

    def figure(self, name: str, figure: Figure) -> None:
        """A figure as a picture."""
        picture = io.BytesIO()
        figure.savefig(picture, format="png")
        self.write(name, lambda file: write_whole(file.resolve(), picture.getvalue()))

    def say(self) -> None:
        """Print what was written."""
        click.echo(f"\nWritten to {self.path}: {', '.join(self.written)}")
