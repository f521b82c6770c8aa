"""fpbm-cpp sweep."""

from __future__ import annotations

import csv
import io
import itertools
from pathlib import Path
from typing import Any

import click
import numpy as np

from .._core import Status, advice, message
from .._errors import SweepInterrupted
from ..job import write_job
from ..sweep_result import Sweep
from .common import WIDTH, motion_command, progress, require_plain, say_job
from .out import Folder, out_option
from .plain import Plain
from .request import make_request, save
from .table import columns, number
from .vary import VARY, Variation

FIGURES = (
    "time",
    "max_error",
    "max_orientation_error",
    "peak_velocity",
    "final_velocity",
    "peak_acceleration",
    "final_acceleration",
    "manipulability",
)


@click.command(
    "sweep",
    short_help="Many schemes from many starts, on all cores.",
    cls=Plain,
    epilog="""\b
Examples:
  fpbm-cpp sweep panda --vary alpha=0:1:6 --starts 20 --duration 2
  fpbm-cpp sweep planar:1,1,1,1 --radius 0.45 --vary alpha=0,0.6,1 --vary null-damping=0,2 --hold 5 --out grid""",
)
@motion_command()
@click.option(
    "--vary",
    multiple=True,
    type=VARY,
    metavar="OPTION=VALUES",
    help="Numbers for an option of the scheme: alpha=0,0.6,1, or alpha=0:1:11 for 11 of them. All combinations run.",
)
@click.option(
    "--starts", type=click.IntRange(1), default=1, show_default=True, help="How many starts: q0 and others near it."
)
@click.option(
    "--spread",
    type=click.FloatRange(0.0),
    default=0.05,
    show_default=True,
    help="Standard deviation of their joint positions [rad].",
)
@click.option(
    "--seed",
    type=click.IntRange(0),
    default=0,
    show_default=True,
    help="Of the starts: the same seed, the same starts.",
)
@click.option("--workers", type=click.IntRange(1), help="Threads; as many as there are processors unless given.")
@out_option(dark=False)
def sweep(
    arm: str | None,
    job: Path | None,
    save_job: Path | None,
    vary: tuple[Variation, ...],
    starts: int,
    spread: float,
    seed: int,
    workers: int | None,
    out: Path | None,
    **options: Any,
) -> None:
    """Move an arm along a path under many schemes from many starts, on all cores.

    Prints a row for each scheme: how many of its motions are complete, and the worst figure of those. With --out, the
    folder gets sweep.csv, a row for each motion, and job.toml. Ctrl-C keeps what is finished. ARM and the options are
    those of track.
    """
    request = make_request(arm, job, options)
    motion = request.motion()
    require_plain(motion, "sweep")
    keys = [variation.key for variation in vary]
    cases = list(itertools.product(*(variation.values for variation in vary)))
    with request.plain():
        schemes = [motion.scheme_with(dict(zip(keys, case))) for case in cases]
    run = motion.job.run
    q0s = motion.q0 + spread * np.random.default_rng(seed).normal(size=(starts, motion.arm.dof))
    q0s[0] = motion.q0
    save(motion, save_job)
    folder = Folder(out).made() if out is not None else None
    say_job(motion)

    from ..sweep import sweep as run_sweep

    interruption = None
    try:
        with progress("motions") as report:
            done = run_sweep(
                motion.arm,
                motion.path,
                schemes,
                q0s,
                run.dt,
                hold=run.hold,
                task=run.task,
                workers=workers,
                progress=report,
            )
    except SweepInterrupted as interrupted:
        done, interruption = interrupted.sweep, interrupted
    click.echo(_table(done, keys, cases))
    if folder is not None:
        folder.text("sweep.csv", _csv(done, keys, cases))
        folder.write("job.toml", lambda file: write_job(motion.job, file))
        folder.say()
    if interruption is not None:
        raise interruption
    if not done.ok.any():
        raise click.ClickException("no motion is complete")


def _table(done: Sweep, keys: list[str], cases: list[tuple[float, ...]]) -> str:
    """A row for each scheme, with the worst figure of its complete motions, and what became of others."""
    figures = {
        ("tip error", "m"): done.max_error,
        **({("turn error", "rad"): done.max_orientation_error} if done.task == "pose" else {}),
        ("peak qd", "rad/s"): done.peak_velocity,
        ("final qd", "rad/s"): done.final_velocity,
        ("peak qdd", "rad/s^2"): done.peak_acceleration,
        ("final qdd", "rad/s^2"): done.final_acceleration,
        ("manip.", "least"): -done.manipulability,
    }
    header = [*((key, "") for key in keys), ("complete", ""), *figures]
    rows = []
    for i, (case, ok) in enumerate(zip(cases, done.ok)):
        worst = [number(abs(values[i, ok].max())) for values in figures.values()] if ok.any() else []
        rows.append([*map(number, case), f"{ok.sum()} of {ok.size}", *worst])
    remarks = [
        click.wrap_text(f"{(done.status == code).sum()} of {done.status.size}: {message(code)}. {advice(code)}", WIDTH)
        for code in Status
        if code is not Status.OK and (done.status == code).any()
    ]
    return "\n".join([columns(*zip(*header), *rows), *([""] if remarks else []), *remarks])


def _csv(done: Sweep, keys: list[str], cases: list[tuple[float, ...]]) -> str:
    """A row for each motion that was run."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    joints = [f"q0_{name}" for name in done.arm.joint_names]
    rows.writerow([*keys, "start", *joints, "status", *FIGURES])
    for i, k in np.argwhere(done.done):
        figures = [repr(float(getattr(done, name)[i, k])) for name in FIGURES]
        rows.writerow([*cases[i], k, *map(repr, done.q0s[k].tolist()), done.status[i, k].name, *figures])
    return text.getvalue()
