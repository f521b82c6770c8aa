"""fpbm-cpp reproduce."""

import os
import time
from pathlib import Path

import click

from .plain import WIDTH, Plain, file_errors, file_option


@click.command(
    "reproduce",
    short_help="Reproduce the FPBM paper.",
    cls=Plain,
    epilog="Example: fpbm-cpp reproduce --out reproduction",
)
@file_option(
    "--out",
    metavar="DIR",
    default="reproduction",
    help="Directory to write to, made where missing; other files in it are left alone.",
)
def reproduce(out: Path) -> None:
    """Reproduce the FPBM paper: figures, tables, errata and claims.

    Runs the paper's 18 motions, compares them with the printed numbers and with an independent solution, and writes
    Figs. 1 to 8 (fig1.png, fig1.pdf and so on) and report.md. Takes about a quarter of a minute. Exits with 1 where a
    motion differs from the independent solution by more than 1e-9.
    """
    start = time.perf_counter()
    try:
        from .. import reproduce as paper

        with file_errors("write to"):
            done = paper.reproduce(out, say=lambda step: click.echo(f"{step} ...", err=True))
    except KeyboardInterrupt:
        raise KeyboardInterrupt("interrupted; every file written so far is whole") from None
    for table in done.tables:
        click.echo(f"\n{table.text()}")
    click.echo("\nClaims, with the numbers in report.md")
    for i, claim in enumerate(done.claims, 1):
        click.echo(f"{i}. {claim.statement}: {claim.verdict}")
    for line in done.summary:
        click.echo("\n" + click.wrap_text(line, width=WIDTH))
    click.echo(f"\n{len(done.files)} files in {out}{os.sep}, {time.perf_counter() - start:.0f} s")
    if not done.agrees:
        raise click.ClickException("a motion differs from the independent solution by more than 1e-9")
