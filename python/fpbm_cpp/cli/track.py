"""fpbm-cpp track."""

from pathlib import Path

import click

from ..motion.run import Run
from .figures import summary
from .out import Writer, dark_option, out_option, picture, write_files
from .request import Request, motion_command

EXTRAS = ("csv", "rosbag", "gif", "mp4")


@motion_command(
    "Move an arm along a path.",
    """
    fpbm-cpp track panda
    fpbm-cpp track planar:1,1,1,1 --radius 0.45 --weights 1,2,3,4 --k1 1 --k2 1 --out circle
    fpbm-cpp track iiwa14 --path lissajous --task pose --scheme man --save-job job.toml
    fpbm-cpp track --job job.toml --scheme fpbm --hold 5""",
)
@out_option
@dark_option
@click.option(
    "--also", multiple=True, type=click.Choice(EXTRAS), help="Write this to the folder, too; may be said again."
)
def track(request: Request, out: Path | None, dark: bool, also: tuple[str, ...]) -> None:
    """Move an arm along a path, and say how it went.

    ARM is panda, iiwa14 or gen3, planar: and lengths of links as in planar:1,1,1,1, or a URDF file with --tip.
    Everything else has a default, and what was taken is printed. Several numbers go between commas.

    With --out, the folder gets run.png, run.npz, which fpbm_cpp.load reads back, and job.toml, which says it all again.
    Exits with 1 where the motion must stop early; what was done until then is printed and written all the same.
    """
    if also and out is None:
        raise click.UsageError("--also needs --out DIR.")
    motion = request.motion()
    with request.plain():
        run = motion.run()
    request.say(motion)
    click.echo(summary(run))
    if out is not None:
        write_files(
            out,
            {
                "run.png": picture(run.plot(dark=dark)),
                **_also(run, also, dark),
                "run.npz": run.save,
                "job.toml": motion.save,
            },
        )
    if not run.status:
        raise click.ClickException("the motion is not complete")


def _also(run: Run, kinds: tuple[str, ...], dark: bool) -> dict[str, Writer]:
    """What is asked for besides."""
    from ..plot import animate

    writers: dict[str, Writer] = {"csv": run.to_csv, "rosbag": run.to_rosbag}
    names = {kind: kind if kind == "rosbag" else f"run.{kind}" for kind in kinds}
    return {name: writers.get(kind, lambda file: animate(run, file, dark=dark)) for kind, name in names.items()}
