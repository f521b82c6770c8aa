"""Commands that report an error in one line, and write each file completely or not at all."""

import io
import signal
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .._core import PRESETS
from ..arms import SerialArm
from ..files import write_whole
from ..joints import JointLimits, limited

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH = 100
PLACE = click.Path(path_type=Path)  # A file or a folder.
Writer = Callable[[Path], Any]

OUT = "Output folder, created if missing; other files in it are not changed."
WORKERS = "Number of threads; default: number of processors."
out_option = click.option("--out", type=PLACE, metavar="DIR", help=OUT)
workers_option = click.option("--workers", type=click.IntRange(1), help=WORKERS)
dark_option = click.option("--dark", is_flag=True, help="Figures on a dark background.")


class Plain(click.Command):
    """Lists the options by topic, prints a warning or an error as one line, and exits with status 130 after Ctrl-C."""

    def invoke(self, context: click.Context) -> Any:
        try:
            with warnings.catch_warnings():
                warnings.showwarning = lambda message, *_, **__: click.echo(f"Warning: {message}", err=True)
                return super().invoke(context)
        except KeyboardInterrupt as interrupted:
            click.echo(str(interrupted) or "interrupted; nothing was written", err=True)
            context.exit(130)
        except ImportError as error:
            text = str(error)
            if "pip install" not in text:
                if not error.name or error.name.startswith("fpbm_cpp"):
                    raise
                text = f'{self.name} needs {error.name}: pip install "fpbm_cpp[cli]"'
            raise click.ClickException(text) from None

    def format_options(self, context: click.Context, formatter: click.HelpFormatter) -> None:
        groups: dict[str, list[tuple[str, str]]] = {}
        for option in self.get_params(context):
            record = option.get_help_record(context) if isinstance(option, click.Option) else None
            if record:
                groups.setdefault(getattr(option, "heading", "Options"), []).append(record)
        for heading, records in groups.items():
            with formatter.section(heading):
                formatter.write_dl(records)


@contextmanager
def file_errors(doing: str, place: Path | None = None) -> Iterator[None]:
    """Report in one line that a place (default: the place in the error) cannot be read or written."""
    try:
        yield
    except OSError as error:
        if error.strerror is None:
            raise click.ClickException(str(error)) from None
        reason = "it is a file: give a folder" if isinstance(error, FileExistsError) else error.strerror
        where = place or error.filename2 or error.filename
        raise click.ClickException(f"cannot {doing} {where}: {reason}") from None


def refuse_links(preset: Path, *links: str | None) -> None:
    if any(links):
        raise click.UsageError(
            f"{preset} is a preset, from its base to its flange: --tip and --base are for URDF files."
        )


def read_arm(arm: Path, tip: str | None, base: str | None, limits: JointLimits | None = None) -> SerialArm:
    """The arm of a preset or of a URDF file; the limits replace its own bounds."""
    if str(arm) in PRESETS:
        refuse_links(arm, tip, base)
        preset = SerialArm.preset(str(arm))
        return replace(preset, joints=limited(preset.joints, limits))
    if tip is None:
        raise click.UsageError("a URDF file needs --tip LINK.")
    with file_errors("read", arm):
        return SerialArm.from_urdf(arm, tip, base, limits=limits)


def make_folder(out: Path) -> None:
    """Make a folder. Call this before long work whose results would be lost without a folder."""
    with file_errors("write to", out):
        out.mkdir(parents=True, exist_ok=True)


def write_files(out: Path, files: dict[str, Writer]) -> None:
    """Write files to a folder, each by the function for its name, and print the names."""
    make_folder(out)
    for name, write in files.items():
        with file_errors("write to", out / name):
            try:
                write(out / name)
            except ValueError as error:  # A motion without a sample has no animation.
                raise click.ClickException(f"cannot write {name}: {error}") from None
    click.echo(f"\nWritten to {out}: {', '.join(files)}")


def content(content: bytes) -> Writer:
    return lambda file: write_whole(file.resolve(), content)


def picture(figure: "Figure") -> Writer:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    return content(buffer.getvalue())


@contextmanager
def progress(label: str) -> Iterator[Callable[[int, int], object]]:
    """A function of (done, total) that prints on one line, if standard error is a terminal."""
    if not sys.stderr.isatty():
        yield lambda done, total: None
        return
    try:
        yield lambda done, total: click.echo(f"\r{label}: {done} of {total}", nl=False, err=True)
    finally:
        click.echo("\r\033[K", nl=False, err=True)


def import_viser() -> None:
    """Import viser with Ctrl-C delayed: trimesh treats the interrupt as a missing optional module and continues."""
    held: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: held.append(number))
    try:
        with suppress(ImportError):
            import_module("viser.extras")
    finally:
        signal.signal(signal.SIGINT, before)
    if held:
        raise KeyboardInterrupt
