"""fpbm-cpp sweep."""

from __future__ import annotations

import csv
import io
import itertools
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np

from .._core import Status, advice, message
from ..errors import SweepInterrupted
from ..io.write_whole import write_whole
from ..job import write_job
from ..motion.sweep_result import Sweep
from ..motion.sweeping import sweep as run_sweep
from .figures import figure_table, number
from .out import Folder, out_option
from .plain import progress
from .request import Request, motion_command, workers_option

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


class Variation(NamedTuple):
    """An option of a scheme, and the values that it takes."""

    key: str
    values: list[float]


class _Vary(click.ParamType):  # type: ignore[type-arg]
    """alpha=0,0.6,1, or alpha=0:1:11."""

    name = "variation"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Variation:
        key, _, text = value.partition("=")
        try:
            if ":" in text:
                first, last, count = text.split(":")
                values = np.linspace(float(first), float(last), int(count)).tolist()
            else:
                values = [float(number) for number in text.split(",")]
        except ValueError:
            raise click.ClickException(f"--vary {value}: must be as alpha=0,0.6,1 or alpha=0:1:11") from None
        return Variation(key.strip().replace("-", "_"), values)


@motion_command(
    "Many schemes from many starts, on all cores.",
    """
    fpbm-cpp sweep panda --vary alpha=0:1:6 --starts 20 --duration 2
    fpbm-cpp sweep planar:1,1,1,1 --radius 0.45 --vary alpha=0,0.6,1 --vary null-damping=0,2 --hold 5 --out grid""",
)
@click.option(
    "--vary",
    multiple=True,
    type=_Vary(),
    metavar="OPTION=VALUES",
    help="Numbers for an option of the scheme: alpha=0,0.6,1, or alpha=0:1:11 for 11 of them. All combinations run.",
)
@click.option("--starts", type=click.IntRange(1), default=1, help="How many starts: q0 and others near it.")
@click.option(
    "--spread",
    type=click.FloatRange(0.0),
    default=0.05,
    help="Standard deviation of their joint positions [rad].",
)
@click.option("--seed", type=click.IntRange(0), default=0, help="Of the starts: the same seed, the same starts.")
@workers_option
@out_option
def sweep(
    request: Request,
    vary: tuple[Variation, ...],
    starts: int,
    spread: float,
    seed: int,
    workers: int | None,
    out: Path | None,
) -> None:
    """Move an arm along a path under many schemes from many starts, on all cores.

    Prints a row for each scheme: how many of its motions are complete, and the worst figure of those. With --out, the
    folder gets sweep.csv, a row for each motion, and job.toml. Ctrl-C keeps what is finished. ARM and the options are
    those of track.
    """
    motion = request.motion(at_rest=True)
    keys = [variation.key for variation in vary]
    cases = list(itertools.product(*(variation.values for variation in vary)))
    with request.plain():
        schemes = [motion.scheme_with(dict(zip(keys, case))) for case in cases]
    q0s = motion.q0 + spread * np.random.default_rng(seed).normal(size=(starts, motion.arm.dof))
    q0s[0] = motion.q0
    folder = Folder(out).made() if out is not None else None
    request.say(motion)
    interruption = None
    try:
        with progress("motions") as report, request.plain():
            done = run_sweep(motion.arm, motion.path, schemes, q0s, workers=workers, progress=report, **motion.keywords)
    except SweepInterrupted as interrupted:
        done, interruption = interrupted.sweep, interrupted
    click.echo(_table(done, keys, cases))
    if folder is not None:
        text = _csv(done, keys, cases)
        folder.write("sweep.csv", lambda file: write_whole(file.resolve(), text.encode()))
        folder.write("job.toml", lambda file: write_job(motion.job, file))
        folder.say()
    if interruption is not None:
        raise interruption
    if not done.ok.any():
        raise click.ClickException("no motion is complete")


def _table(done: Sweep, keys: list[str], cases: list[tuple[float, ...]]) -> str:
    """A row for each scheme, with the worst figure of its complete motions, and what became of others."""
    figures = [
        done.max_error,
        *([done.max_orientation_error] if done.task == "pose" else []),
        done.peak_velocity,
        done.final_velocity,
        done.peak_acceleration,
        done.final_acceleration,
        -done.manipulability,
    ]
    rows = []
    for i, (case, ok) in enumerate(zip(cases, done.ok)):
        worst = [number(abs(values[i, ok].max())) for values in figures] if ok.any() else []
        rows.append([*map(number, case), f"{ok.sum()} of {ok.size}", *worst])
    remarks = [
        f"{(done.status == code).sum()} of {done.status.size}: {message(code)}. {advice(code)}"
        for code in Status
        if code is not Status.OK and (done.status == code).any()
    ]
    return figure_table([*keys, "complete"], done.task, rows, "", remarks)


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
