"""fpbm-cpp view."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ..job.arms import Urdf
from .common import motion_command, say_job
from .plain import Plain, import_undisturbed
from .request import make_request, save


@click.command(
    "view",
    short_help="Show an arm on its path in the browser.",
    cls=Plain,
    epilog="""\b
Examples:
  fpbm-cpp view panda --task pose
  fpbm-cpp view my_arm.urdf --tip tool0 --path lissajous --port 9000
  fpbm-cpp view --job job.toml --no-browser""",
)
@motion_command()
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=8080,
    show_default=True,
    help="Port to serve at; 0 takes one that is free.",
)
@click.option("--browser/--no-browser", default=True, help="Open the page in the browser, or not.")
def view(arm: str | None, job: Path | None, save_job: Path | None, port: int, browser: bool, **options: Any) -> None:
    """Show an arm on its path in the browser, with the scheme and its gains at hand.

    A URDF file is shown with its meshes. Ctrl-C ends it. ARM and the options are those of track.
    """
    request = make_request(arm, job, options)
    motion = request.motion()
    with request.plain():
        run = motion.run()
    save(motion, save_job)
    say_job(motion)
    click.echo("Ctrl-C ends it.")
    shown = motion.job.arm
    try:
        import_undisturbed("viser", "viser.extras")
        run.view(urdf=shown.file if isinstance(shown, Urdf) else None, port=port, open_browser=browser)
    except OSError as error:
        raise click.ClickException(error.strerror or str(error)) from None
    except KeyboardInterrupt:
        return
