"""What commands write: into one folder, each file whole or not at all."""

import io
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..io.write_whole import write_whole
from .plain import file_errors, file_option

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Writer = Callable[[Path], Any]

out_option = file_option(
    "--out", metavar="DIR", help="Folder to write to, made where missing; other files in it are left alone."
)
dark_option = click.option("--dark", is_flag=True, help="Pictures on a dark ground.")


def make_folder(out: Path) -> None:
    """Make a folder, at once where work would be lost otherwise."""
    with file_errors("write to", out):
        out.mkdir(parents=True, exist_ok=True)


def write_files(out: Path, files: dict[str, Writer]) -> None:
    """Write to a folder what each name's function writes to the file that it is given, and say so."""
    for name, write in files.items():
        with file_errors("write to", out / name):
            out.mkdir(parents=True, exist_ok=True)
            try:
                write(out / name)
            except ValueError as error:  # A motion without a sample has no animation.
                raise click.ClickException(f"cannot write {name}: {error}") from None
    click.echo(f"\nWritten to {out}: {', '.join(files)}")


def content(content: str | bytes) -> Writer:
    """Write this."""
    return lambda file: write_whole(file.resolve(), content.encode() if isinstance(content, str) else content)


def picture(figure: "Figure") -> Writer:
    """Write a figure as PNG."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    return content(buffer.getvalue())
