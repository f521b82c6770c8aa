"""fpbm-cpp tune."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ..errors import TuneInterrupted
from ..job import write_job
from .out import Folder, dark_option, out_option
from .plain import progress
from .request import Request, motion_command, workers_option


@motion_command(
    "Find the parameters of FPBM that suit best.",
    """
    fpbm-cpp tune planar:1,1,1,1 --radius 0.45
    fpbm-cpp tune panda --task pose --objective peak_acceleration --trials 200 --out tuned
    fpbm-cpp track --job tuned/job.toml""",
    kind=False,
)
@click.option(
    "--objective",
    default="peak_velocity",
    help="What is to be small: peak_velocity, peak_acceleration, final_velocity, energy or limit_distance.",
)
@click.option("--trials", type=click.IntRange(1), help="How many schemes to try.")
@click.option("--seed", type=click.IntRange(0), default=0, help="Of the search: the same seed, the same answer.")
@workers_option
@out_option
@dark_option
def tune(
    request: Request,
    objective: str,
    trials: int | None,
    seed: int,
    workers: int | None,
    out: Path | None,
    dark: bool,
) -> None:
    """Find the parameters of FPBM that suit an arm and a path best.

    ARM and the options are those of track; what is found is compared with the FPBM that they ask for.
    With --out, the folder gets tune.png and job.toml, the job with the scheme that was found. Ctrl-C keeps the best so
    far.
    """
    from ..tuning import tune as search

    motion = request.motion("fpbm", at_rest=True)
    folder = Folder(out).made() if out is not None else None
    request.say(motion)
    options: dict[str, Any] = {"seed": seed, "workers": workers, **({} if trials is None else {"trials": trials})}
    interruption = None
    try:
        with progress("trying schemes") as report:
            found = search(
                motion.arm,
                motion.path,
                motion.q0,
                objective,
                baseline=motion.scheme,
                progress=report,
                **motion.keywords,
                **options,
            )
    except (ValueError, RuntimeError) as error:  # The latter where nothing that was tried keeps to the path.
        raise click.ClickException(str(error)) from None
    except TuneInterrupted as interrupted:
        if interrupted.tuning is None:
            raise
        found, interruption = interrupted.tuning, interrupted
    click.echo(str(found))
    if folder is not None:
        best = {**motion.job, "scheme": {**motion.job["scheme"], **found.parameters}}
        folder.figure("tune.png", found.plot(dark=dark))
        folder.write("job.toml", lambda file: write_job(best, file))
        folder.say()
    if interruption is not None:
        raise interruption
