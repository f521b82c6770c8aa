"""The command line: fpbm-cpp, built on click."""

from __future__ import annotations

import os
import time
from pathlib import Path

import click

from ._core import __version__


@click.group(epilog="Example: fpbm-cpp reproduce --out reproduction")
@click.version_option(__version__, prog_name="fpbm-cpp")
def command() -> None:
    """Redundancy resolution for robot arms: MVN, WMVN, MAN and FPBM."""


@command.command("reproduce", epilog="Example: fpbm-cpp reproduce --out reproduction")
@click.option(
    "--out",
    metavar="DIR",
    type=click.Path(path_type=Path),
    default=Path("reproduction"),
    show_default=True,
    help="Directory to write to, made where missing; other files in it are left alone.",
)
@click.pass_context
def reproduce_command(context: click.Context, out: Path) -> None:
    """Reproduce the FPBM paper: figures, tables, errata and claims.

    Runs the paper's 18 motions, compares them with the printed numbers and with an independent solution, and writes
    Figs. 1 to 8 (fig1.png, fig1.pdf and so on) and report.md. Takes about a quarter of a minute. Exits with 1 where a
    motion differs from the independent solution by more than 1e-9.
    """
    start = time.perf_counter()
    try:
        from .reproduce import reproduce

        done = reproduce(out, say=lambda step: click.echo(f"{step} ...", err=True))
    except ImportError as error:
        if "matplotlib" not in str(error):
            raise
        raise click.ClickException('reproduce needs matplotlib: pip install "fpbm_cpp[cli]"') from None
    except OSError as error:
        where = error.filename2 or error.filename or out
        reason = "it is a file" if isinstance(error, FileExistsError) else error.strerror
        raise click.ClickException(f"cannot write to {where}: {reason}") from None
    except KeyboardInterrupt:
        click.echo("interrupted; every file written so far is whole", err=True)
        context.exit(130)
    for table in done.tables:
        click.echo(f"\n{table.text()}")
    click.echo("\nClaims, with the numbers in report.md")
    for i, claim in enumerate(done.claims, 1):
        click.echo(f"{i}. {claim.statement}: {claim.verdict}")
    for line in done.summary:
        click.echo("\n" + click.wrap_text(line, width=100))
    click.echo(f"\n{len(done.files)} files in {out}{os.sep}, {time.perf_counter() - start:.0f} s")
    if not done.agrees:
        raise click.ClickException("a motion differs from the independent solution by more than 1e-9")


@command.command("export-header", epilog="Example: fpbm-cpp export-header my_arm.urdf --tip tool -o my_arm.hpp")
@click.argument("urdf", metavar="ARM.urdf", type=click.Path(path_type=Path))
@click.option("--tip", metavar="LINK", required=True, help="Link to move.")
@click.option("--base", metavar="LINK", help="Link that stays; the root unless given.")
@click.option(
    "-o",
    "--out",
    metavar="FILE.hpp",
    type=click.Path(path_type=Path),
    required=True,
    help="Header to write, whole or not at all; - is the standard output.",
)
@click.option("--name", metavar="NAMESPACE", help="C++ namespace; after the header's file name unless given.")
def export_header_command(urdf: Path, tip: str, base: str | None, out: Path, name: str | None) -> None:
    """Write the arm of a URDF file as a C++ header.

    The header constructs the arm from base to tip, with neither parser nor file when the program runs.
    """
    from ._files import write_whole
    from .export_header import export_header, namespace_of
    from .urdf import read_urdf

    to_stdout = str(out) == "-"
    source = f"{urdf.name}, {f'base {base}, ' if base else ''}tip {tip}"
    try:
        joints, frame = read_urdf(urdf, tip, base)
        name = name or namespace_of((urdf if to_stdout else out).stem)
        header = export_header(joints, frame, name=name, source=source)
    except OSError as error:
        raise click.ClickException(f"cannot read {urdf}: {error.strerror}") from None
    except (ValueError, ImportError) as error:
        raise click.ClickException(str(error)) from None
    if to_stdout:
        click.echo(header, nl=False)
        return
    try:
        write_whole(out.resolve(), header.encode())
    except OSError as error:
        raise click.ClickException(f"cannot write to {out}: {error.strerror}") from None
