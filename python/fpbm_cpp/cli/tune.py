"""fpbm-cpp tune."""

from pathlib import Path
from typing import cast

import click

from ..errors import TuneInterrupted
from ..schemes import FPBM
from ..tuning import tune as search
from ..tuning.objectives import MEASURES
from .options import Word
from .out import dark_option, make_folder, out_option, picture, write_files
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
@click.option("--objective", type=Word(list(MEASURES)), default="peak_velocity", help="What is to be small.")
@click.option("--trials", type=click.IntRange(1), default=1000, help="How many schemes to try.")
@click.option("--seed", type=click.IntRange(0), default=0, help="Of the search: the same seed, the same answer.")
@workers_option
@out_option
@dark_option
def tune(
    request: Request, objective: str, trials: int, seed: int, workers: int | None, out: Path | None, dark: bool
) -> None:
    """Find the parameters of FPBM that suit an arm and a path best.

    ARM and the options are those of track; what is found is compared with the FPBM that they ask for.
    With --out, the folder gets tune.png and job.toml, the job with the scheme that was found. Ctrl-C keeps the best so
    far.
    """
    motion = request.motion("fpbm", at_rest=True)
    if out is not None:
        make_folder(out)
    request.say(motion)
    interruption = None
    try:
        with progress("trying schemes") as report:
            found = search(
                motion.arm,
                motion.path,
                motion.q0,
                objective,
                baseline=cast(FPBM, motion.scheme),
                progress=report,
                **motion.keywords,
                trials=trials,
                seed=seed,
                workers=workers,
            )
    except (ValueError, RuntimeError) as error:  # The latter where nothing that was tried keeps to the path.
        raise click.ClickException(str(error)) from None
    except TuneInterrupted as interrupted:
        if interrupted.tuning is None:
            raise
        found, interruption = interrupted.tuning, interrupted
    click.echo(str(found))
    if out is not None:
        best = motion.with_scheme(found.parameters)
        write_files(out, {"tune.png": picture(found.plot(dark=dark)), "job.toml": best.save})
    if interruption is not None:
        raise interruption
