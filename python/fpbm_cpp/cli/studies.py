"""Commands that run many motions: sweep, tune."""

import csv
import io
import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import cast

import click
import numpy as np

from .._core import Status, advice, message
from ..motion.comparison import FIGURES, Row, figure_table
from ..motion.sweeping import Sweep, SweepInterrupted
from ..motion.sweeping import sweep as run_sweep
from ..schemes import FPBM
from ..shown import number
from ..tuning import TuneInterrupted, Tuning
from ..tuning import tune as search
from ..tuning.tuner import OBJECTIVES
from .plain import content, dark_option, make_folder, out_option, picture, progress, workers_option, write_files
from .request import Request, Word, motion_command

Cases = list[tuple[float, ...]]
VARY = "Values of a scheme option: alpha=0,0.6,1, or alpha=0:1:11 for 11 values. All combinations run."


@motion_command(
    "Run many schemes from many starts, on all cores.",
    """
    fpbm-cpp sweep panda --vary alpha=0:1:6 --starts 20 --duration 2
    fpbm-cpp sweep planar:1,1,1,1 --radius 0.45 --vary alpha=0,0.6,1 --vary null-damping=0,2 --hold 5 --out grid""",
)
@click.option("--vary", multiple=True, metavar="OPTION=VALUES", help=VARY)
@click.option("--starts", type=click.IntRange(1), default=1, help="Number of starts: q0 and random postures near q0.")
@click.option(
    "--spread", type=click.FloatRange(0.0), default=0.05, help="Standard deviation of the joint positions [rad]."
)
@click.option("--seed", type=click.IntRange(0), default=0, help="Random seed of the starts.")
@workers_option
@out_option
def sweep(
    request: Request, vary: Sequence[str], starts: int, spread: float, seed: int, workers: int | None, out: Path | None
) -> None:
    """Move an arm along a path under many schemes from many starts, on all cores.

    Prints a row for each scheme: the number of complete motions, and the worst figures of the complete motions. With
    --out, the folder gets sweep.csv, with a row for each motion, and job.toml. After Ctrl-C, the finished motions are
    kept. For ARM and the options, see track.
    """
    motion = request.motion(at_rest=True)
    with request.plain():
        arm, path = motion.of_one_arm()
    keys = [text.partition("=")[0].strip().replace("-", "_") for text in vary]
    cases = list(itertools.product(*map(_values, vary)))
    with request.plain():
        schemes = [motion.with_scheme(dict(zip(keys, case))).scheme for case in cases]
    q0s = motion.q0 + spread * np.random.default_rng(seed).normal(size=(starts, motion.arm.dof))
    q0s[0] = motion.q0
    if out is not None:
        make_folder(out)
    request.say(motion)

    def show(done: Sweep) -> None:
        click.echo(_table(done, keys, cases))
        if out is not None:
            write_files(out, {"sweep.csv": content(_csv(done, keys, cases).encode()), "job.toml": motion.save})

    try:
        with progress("motions") as report, request.plain():
            done = run_sweep(arm, path, schemes, q0s, workers=workers, progress=report, **motion.keywords)
    except SweepInterrupted as interrupted:
        show(interrupted.sweep)
        raise
    show(done)
    if not done.ok.any():
        raise click.ClickException("no motion is complete: the remarks above have the causes and remedies")


def _values(vary: str) -> list[float]:
    """The values in alpha=0,0.6,1 or alpha=0:1:11."""
    text = vary.partition("=")[2]
    try:
        if ":" not in text:
            return [float(number) for number in text.split(",")]
        first, last, count = text.split(":")
        return [float(value) for value in np.linspace(float(first), float(last), int(count))]
    except ValueError:
        raise click.ClickException(f"--vary {vary}: must have the form alpha=0,0.6,1 or alpha=0:1:11") from None


def _table(done: Sweep, keys: list[str], cases: Cases) -> str:
    """A row for each scheme, with the worst figures of its complete motions, and remarks on the other motions."""
    rows: list[Row] = []
    for i, (case, ok) in enumerate(zip(cases, done.ok)):
        figures = {name: getattr(done, name)[i, ok] for name in FIGURES if ok.any()}
        worst = {name: values.min() if name == "manipulability" else values.max() for name, values in figures.items()}
        rows.append(([number(value) for value in case], f"{ok.sum()} of {ok.size}", worst))
    remarks = [
        f"{(done.status == code).sum()} of {done.status.size}: {message(code)}. {advice(code)}"
        for code in Status
        if code is not Status.OK and (done.status == code).any()
    ]
    return figure_table(keys, done.task, rows, remarks)


def _csv(done: Sweep, keys: list[str], cases: Cases) -> str:
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    joints = [f"q0_{name}" for name in done.arm.joint_names]
    rows.writerow([*keys, "start", *joints, "status", "time", *FIGURES])
    for i, k in np.argwhere(done.done):
        figures = [repr(float(getattr(done, name)[i, k])) for name in ("time", *FIGURES)]
        rows.writerow([*cases[i], k, *map(repr, done.q0s[k].tolist()), done.status[i, k].name, *figures])
    return text.getvalue()


@motion_command(
    "Optimise the parameters of FPBM.",
    """
    fpbm-cpp tune planar:1,1,1,1 --radius 0.45
    fpbm-cpp tune panda --task pose --objective peak_acceleration --trials 200 --out tuned
    fpbm-cpp track --job tuned/job.toml""",
    kind=False,
)
@click.option("--objective", type=Word(list(OBJECTIVES)), default="peak_velocity", help="Objective to minimise.")
@click.option("--trials", type=click.IntRange(1), default=1000, help="Number of schemes to try.")
@click.option("--seed", type=click.IntRange(0), default=0, help="Random seed of the search.")
@workers_option
@out_option
@dark_option
def tune(
    request: Request, objective: str, trials: int, seed: int, workers: int | None, out: Path | None, dark: bool
) -> None:
    """Optimise the parameters of FPBM for an arm and a path.

    The baseline is FPBM with the given options. With --out, the folder gets tune.png and job.toml, the job with the
    best scheme. After Ctrl-C, the best scheme so far is kept. For ARM and the options, see track.
    """
    motion = request.motion("fpbm", at_rest=True)
    with request.plain():
        arm, path = motion.of_one_arm()
    if out is not None:
        make_folder(out)
    request.say(motion)

    def show(found: Tuning) -> None:
        click.echo(str(found))
        if out is not None:
            best = motion.with_scheme(found.parameters)
            write_files(out, {"tune.png": picture(found.plot(dark=dark)), "job.toml": best.save})

    how = {"baseline": cast(FPBM, motion.scheme), "trials": trials, "seed": seed, "workers": workers, **motion.keywords}
    try:
        with progress("trying schemes") as report:
            found = search(arm, path, motion.q0, objective, progress=report, **how)
    except (ValueError, RuntimeError) as error:  # RuntimeError: no trial is feasible.
        raise click.ClickException(str(error)) from None
    except TuneInterrupted as interrupted:
        if interrupted.tuning is not None:
            show(interrupted.tuning)
        raise
    show(found)
