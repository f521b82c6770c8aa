"""fpbm-cpp compare."""

from pathlib import Path

import click
import numpy as np

from .._core import Status
from ..errors import not_one_of
from ..motion.run import Run
from ..schemes import SCHEMES
from .figures import Row, figure_table
from .out import Writer, dark_option, out_option, picture, write_files
from .request import Request, motion_command


@motion_command(
    "Several schemes on one path, side by side.",
    """
    fpbm-cpp compare panda --hold 5
    fpbm-cpp compare planar:1,1,1,1 --radius 0.45 --weights 1,2,3,4 --schemes mvn,man,fpbm --out circle
    fpbm-cpp compare --job job.toml --null-damping 0""",
    kind=False,
)
@click.option("--schemes", metavar="NAMES", help=f"Which, between commas; all unless given: {', '.join(SCHEMES)}.")
@out_option
@dark_option
def compare(request: Request, schemes: str | None, out: Path | None, dark: bool) -> None:
    """Move an arm along a path under several schemes, side by side.

    Each scheme takes those of the options that it has. ARM and the options are those of track.

    Prints a row of figures for each scheme: the largest errors of the tip, peak and final joint velocities and
    accelerations, the least manipulability, and how it ended. With --out, the folder gets compare.png, a saved run for
    each scheme, and job.toml.
    """
    kinds = [name.strip() for name in schemes.split(",")] if schemes else list(SCHEMES)
    for kind in kinds:
        if kind not in SCHEMES:
            raise click.ClickException(str(not_one_of("--schemes", kind, SCHEMES)))
    motions = {kind: request.motion(kind) for kind in kinds}
    with request.plain():
        runs = {kind: motion.run() for kind, motion in motions.items()}
    chosen = motions.get(request.scheme, motions[kinds[-1]])  # Has every option that any of them has, as a rule.
    request.say(chosen, scheme=False)
    click.echo(_table(runs))
    if out is not None:
        from ..plot import compare as figure

        saved: dict[str, Writer] = {f"{kind}.npz": run.save for kind, run in runs.items()}
        write_files(out, {"compare.png": picture(figure(runs, dark=dark)), **saved, "job.toml": chosen.save})
    if not any(run.status for run in runs.values()):
        raise click.ClickException("no motion is complete")


def _table(runs: dict[str, Run]) -> str:
    """A row for each run, and below what else there is to say of it."""
    remarks: dict[str, list[str]] = {}
    for kind, run in runs.items():
        if run.status.code is not Status.OK:
            remarks.setdefault(" ".join(str(run.status).split()), []).append(kind)
    rows = [_row(kind, run) for kind, run in runs.items()]
    task = next(iter(runs.values())).task
    return figure_table(["scheme"], task, rows, [f"{', '.join(kinds)}: {text}" for text, kinds in remarks.items()])


def _row(kind: str, run: Run) -> Row:
    if not len(run.t):
        return [kind], "", {}
    speed, acceleration = np.abs(run.qd).max(axis=1), np.abs(run.qdd).max(axis=1)
    figures = {
        "max_error": run.max_error(),
        "max_orientation_error": run.max_orientation_error(),
        "peak_velocity": speed.max(),
        "final_velocity": speed[-1],
        "peak_acceleration": acceleration.max(),
        "final_acceleration": acceleration[-1],
        "manipulability": run.manipulability().min(),
    }
    return [kind], "yes" if run.status else f"to {run.status.time:.3g} s", figures
