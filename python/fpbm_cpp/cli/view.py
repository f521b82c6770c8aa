"""fpbm-cpp view."""

import click

from .plain import import_undisturbed
from .request import Request, motion_command


@motion_command(
    "Show an arm on its path in the browser.",
    """
    fpbm-cpp view panda --task pose
    fpbm-cpp view my_arm.urdf --tip tool0 --path lissajous --port 9000
    fpbm-cpp view --job job.toml --no-browser""",
)
@click.option("--port", type=click.IntRange(0, 65535), default=8080, help="Port to serve at; 0 takes one that is free.")
@click.option("--browser/--no-browser", default=True, help="Open the page in the browser, or not.")
def view(request: Request, port: int, browser: bool) -> None:
    """Show an arm on its path in the browser, with the scheme and its gains at hand.

    A URDF file is shown with its meshes. Ctrl-C ends it. ARM and the options are those of track.
    """
    motion = request.motion()
    with request.plain():
        run = motion.run()
    try:
        request.say(motion)
        import_undisturbed("viser", "viser.extras")
        from ..viewer import Viewer

        Viewer(run, urdf=motion.job["arm"].get("file"), port=port, open_browser=browser).wait()
    except OSError as error:
        raise click.ClickException(error.strerror or str(error)) from None
    except KeyboardInterrupt:
        return
