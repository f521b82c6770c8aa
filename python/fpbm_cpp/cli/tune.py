"""fpbm-cpp tune."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import click

from ..job import write_job
from .common import motion_command, progress, require_plain, say_job
from .out import Folder, out_option
from .plain import Plain
from .request import make_request, save


@click.command(
    "tune",
    short_help="Find the parameters of FPBM that suit best.",
    cls=Plain,
    epilog="""\b
Examples:
  fpbm-cpp tune planar:1,1,1,1 --radius 0.45
  fpbm-cpp tune panda --task pose --objective peak_acceleration --trials 200 --out tuned
  fpbm-cpp track --job tuned/job.toml""",
)
@motion_command(kind=False)
@click.option(
    "--objective",
    default="peak_velocity",
    show_default=True,
    help="What is to be small: peak_velocity, peak_acceleration, final_velocity, energy or limit_distance.",
)
@click.option("--trials", type=click.IntRange(1), help="How many schemes to try.")
@click.option(
    "--seed",
    type=click.IntRange(0),
    default=0,
    show_default=True,
    help="Of the search: the same seed, the same answer.",
)
@click.option("--workers", type=click.IntRange(1), help="Threads; as many as there are processors unless given.")
@out_option()
def tune(
    arm: str | None,
    job: Path | None,
    save_job: Path | None,
    objective: str,
    trials: int | None,
    seed: int,
    workers: int | None,
    out: Path | None,
    dark: bool,
    **options: Any,
) -> None:
    """Find the parameters of FPBM that suit an arm and a path best.

    ARM and the options are those of track; what is found is compared with the FPBM that they ask for.
    With --out, the folder gets tune.png and job.toml, the job with the scheme that was found. Ctrl-C keeps the best so
    far.
    """
    import fpbm_cpp as fp

    request = make_request(arm, job, options)
    motion = request.motion("fpbm")
    require_plain(motion, "tune")
    save(motion, save_job)
    folder = Folder(out).made() if out is not None else None
    say_job(motion)
    extra: dict[str, Any] = {} if trials is None else {"trials": trials}
    run, interruption = motion.job.run, None
    try:
        with progress("trying schemes") as report:
            found = fp.tune(
                motion.arm,
                motion.path,
                motion.q0,
                objective,
                dt=run.dt,
                hold=run.hold,
                task=run.task,
                baseline=cast(fp.FPBM, motion.scheme),
                seed=seed,
                workers=workers,
                progress=report,
                **extra,
            )
    except (ValueError, RuntimeError) as error:  # The latter where nothing that was tried keeps to the path.
        raise click.ClickException(str(error)) from None
    except fp.TuneInterrupted as interrupted:
        if interrupted.tuning is None:
            raise
        found, interruption = interrupted.tuning, interrupted
    click.echo(str(found))
    if folder is not None:
        best = motion.job.with_scheme(found.parameters)
        folder.figure("tune.png", found.plot(dark=dark))
        folder.write("job.toml", lambda file: write_job(best, file))
        folder.say()
    if interruption is not None:
        raise interruption
