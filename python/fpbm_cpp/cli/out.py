"""What commands write: into one folder, each file whole or not at all."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .._files import write_whole
from .plain import writing_to

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Folder:
    """A folder that is made for the first file at the latest, and knows what was written."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.written: list[str] = []

    def made(self) -> Folder:
        """The folder, made at once, before work that would be lost."""
        with writing_to(self.path):
            self.path.mkdir(parents=True, exist_ok=True)
        return self

    def write(self, name: str, write: Callable[[Path], Any]) -> None:
        """Whatever write(file) writes."""
        with writing_to(self.path / name):
            self.path.mkdir(parents=True, exist_ok=True)
            try:
                write(self.path / name)
            except ValueError as error:  # A motion without a sample is no animation.
                raise click.ClickException(f"cannot write {name}: {error}") from None
        self.written.append(name)

    def figure(self, name: str, figure: Figure) -> None:
        """A figure as a picture."""
        picture = io.BytesIO()
        figure.savefig(picture, format="png")
        self.write(name, lambda file: write_whole(file.resolve(), picture.getvalue()))

    def text(self, name: str, text: str) -> None:
        """A text."""
        self.write(name, lambda file: write_whole(file.resolve(), text.encode()))

    def say(self) -> None:
        """Print what was written."""
        click.echo(f"\nWritten to {self.path}: {', '.join(self.written)}")


def out_option(*, dark: bool = True) -> Callable[[Any], Any]:
    """Give a command --out and, where it draws, --dark."""

    def add(function: Any) -> Any:
        if dark:
            function = click.option("--dark", is_flag=True, help="Pictures on a dark ground.")(function)
        return click.option(
            "--out",
            metavar="DIR",
            type=click.Path(path_type=Path),
            help="Folder to write to, made where missing; other files in it are left alone.",
        )(function)

    return add
