"""fpbm-cpp compare."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click
import numpy as np

from .._core import Status
from ..job import write_job
from ..job.explain import one_of
from ..run import Run
from .common import WIDTH, motion_command, say_job
from .out import Folder, out_option
from .plain import Plain
from .request import KINDS, make_request, save
from .table import columns, number


@click.command(
    "compare",
    short_help="Several schemes on one path, side by side.",
    cls=Plain,
    epilog="""\b
Examples:
  fpbm-cpp compare panda --hold 5
  fpbm-cpp compare planar:1,1,1,1 --radius 0.45 --weights 1,2,3,4 --schemes mvn,man,fpbm --out circle
  fpbm-cpp compare --job job.toml --null-damping 0""",
)
@motion_command(kind=False)
@click.option(
    "--schemes", metavar="NAMES", help=f"Which, between commas; all unless given: {', '.join(KINDS['scheme'])}."
)
@out_option()
def compare(
    arm: str | None,
    job: Path | None,
    save_job: Path | None,
    schemes: str | None,
    out: Path | None,
    dark: bool,
    **options: Any,
) -> None:
    """Move an arm along a path under several schemes, side by side.

    Each scheme takes those of the options that it has. ARM and the options are those of track.

    Prints a row of figures for each scheme: the largest errors of the tip, peak and final joint velocities and
    accelerations, the least manipulability, and how it ended. With --out, the folder gets compare.png, a saved run for
    each scheme, and job.toml.
    """
    kinds = [name.strip() for name in schemes.split(",")] if schemes else list(KINDS["scheme"])
    for kind in kinds:
        if kind not in KINDS["scheme"]:
            raise click.ClickException("--schemes" + one_of(kind, list(KINDS["scheme"])))
    request = make_request(arm, job, options)
    motions = {kind: request.motion(kind) for kind in kinds}
    with request.plain():
        runs = {kind: motion.run() for kind, motion in motions.items()}
    chosen = motions.get(request.scheme, motions[kinds[-1]])  # Has every option that any of them has, as a rule.
    save(chosen, save_job)
    say_job(chosen, scheme=False)
    click.echo(_table(runs))
    if out is not None:
        from ..plot import compare as figure

        folder = Folder(out)
        folder.figure("compare.png", figure(runs, dark=dark))
        for kind, run in runs.items():
            folder.write(f"{kind}.npz", run.save)
        folder.write("job.toml", lambda file: write_job(chosen.job, file))
        folder.say()
    if not any(run.status for run in runs.values()):
        raise click.ClickException("no motion is complete")


def _table(runs: Mapping[str, Run]) -> str:
    """A row for each run, and below what else there is to say of it."""
    header = [
        ("scheme", ""),
        ("tip error", "m"),
        *([("turn error", "rad")] if any(run.task == "pose" for run in runs.values()) else ()),
        ("peak qd", "rad/s"),
        ("final qd", "rad/s"),
        ("peak qdd", "rad/s^2"),
        ("final qdd", "rad/s^2"),
        ("manip.", "least"),
        ("complete", ""),
    ]
    rows = [_row(kind, run) for kind, run in runs.items()]
    remarks: dict[str, list[str]] = {}
    for kind, run in runs.items():
        if run.status.code is not Status.OK:
            remarks.setdefault(" ".join(str(run.status).split()), []).append(kind)
    lines = [
        click.wrap_text(f"{', '.join(kinds)}: {remark}", WIDTH, subsequent_indent="  ")
        for remark, kinds in remarks.items()
    ]
    return "\n".join([columns(*zip(*header), *rows), *([""] if lines else []), *lines])


def _row(kind: str, run: Run) -> list[str]:
    if not len(run.t):
        return [kind]
    figures = [run.max_error(), *([run.max_orientation_error()] if run.task == "pose" else [])]
    for values in (run.qd, run.qdd):
        figures += [float(np.abs(values).max()), float(np.abs(values[-1]).max())]
    figures.append(float(run.manipulability().min()))
    return [kind, *map(number, figures), "yes" if run.status else f"to {run.status.time:.3g} s"]
