"""Commands that run a motion: track, fastest, compare, view, servo."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from ..errors import not_one_of
from ..job import Motion
from ..job.sections import job_errors
from ..motion.comparison import comparison
from ..motion.run import Run
from ..schemes import SCHEMES, WITHOUT_DYNAMICS
from .plain import Writer, dark_option, import_viser, out_option, picture, write_files
from .request import Request, motion_command
from .text import summary

port_option = click.option(
    "--port", type=click.IntRange(0, 65535), default=8080, help="Port of the page; 0 selects a free port."
)
browser_option = click.option("--browser/--no-browser", default=True, help="Whether to open the page in the browser.")
also_option = click.option(
    "--also",
    multiple=True,
    type=click.Choice(["csv", "rosbag", "gif", "mp4"]),
    help="Also write this file to the folder; can be repeated.",
)


@motion_command(
    "Move an arm along a path.",
    """
    fpbm-cpp track panda
    fpbm-cpp track planar:1,1,1,1 --radius 0.45 --weights 1,2,3,4 --k1 1 --k2 1 --out circle
    fpbm-cpp track iiwa14 --path lissajous --at-speed 0.1 --at-acceleration 0.5 --scheme man --save-job job.toml
    fpbm-cpp track two_pandas --task left_tip --task right_tip --radius 0.06 --keep-path
    fpbm-cpp track --job job.toml --scheme fpbm --hold 5""",
    clear=True,
    keep=True,
)
@out_option
@dark_option
@also_option
def track(request: Request, out: Path | None, dark: bool, also: tuple[str, ...]) -> None:
    """Move an arm along a path, and print key figures of the motion.

    ARM is panda, fr3, iiwa14, gen3, ur5e, ur10e, xarm7, so101, openarm or z1; planar: and the link lengths, as in
    planar:1,1,1,1; or a URDF file with --tip. ARM can also be a robot: two_pandas, or a URDF file with a --task for
    each frame that follows the path. An arm in space with 4 or 5 joints has a position task, and below it an axis task.
    All options have defaults, and the defaults in use are printed. Separate several numbers by commas.

    The arm keeps its joint limits, as in fpbm_cpp.track. With --no-limits, it moves by the scheme alone, as in
    fpbm_cpp.simulate. With --job, it keeps limits if the job has limits, or with --limits.

    With --keep-path, the tip stays on the path, as in fpbm_cpp.track(keep_path=True).

    With --out, the folder gets run.png, run.npz, which fpbm_cpp.load reads, and job.toml, which contains all options.
    If the motion stops early, the exit status is 1, and the motion before the stop is still printed and written.
    """
    _require_out(out, also)
    motion = request.motion(limited=request.file is None)
    with request.plain():
        run = motion.run()
    _report(request, motion, run, out, dark, also)


@motion_command(
    "Move an arm along a path in the least time.",
    """
    fpbm-cpp fastest panda --radius 0.15 --task pose
    fpbm-cpp fastest ur5e --path lissajous --tip-speed 0.25 --out fast
    fpbm-cpp fastest --job job.toml --scheme wmvn --weights 1,2,1,2,1,2,1""",
    clear=True,
)
@click.option("--tip-speed", type=float, metavar="NUMBER", help="Largest speed of the tip.  [m/s]")
@click.option("--tip-acceleration", type=float, metavar="NUMBER", help="Largest acceleration of the tip.  [m/s^2]")
@click.option("--start-speed", type=float, default=0.0, metavar="NUMBER", help="Speed of the tip at the start.  [m/s]")
@click.option("--end-speed", type=float, default=0.0, metavar="NUMBER", help="Speed of the tip at the end.  [m/s]")
@out_option
@dark_option
@also_option
def fastest(
    request: Request,
    tip_speed: float | None,
    tip_acceleration: float | None,
    start_speed: float,
    end_speed: float,
    out: Path | None,
    dark: bool,
    also: tuple[str, ...],
) -> None:
    """Move an arm along a path in the least time within its limits, and print key figures of the motion.

    The tip stays on the path, as in fpbm_cpp.fastest: the duration is a result. The duration, the time law, the
    constant speed, the hold and the reserve of a job have no effect. The scheme is at velocity level, by default mvn.
    For ARM and the options, see track. The written job.toml keeps the path.
    """
    _require_out(out, also)
    motion = request.motion(request.scheme_of_velocity, at_rest=True, limited=True, keep_path=True)
    with request.plain():
        run = motion.fastest(
            tip_speed=tip_speed, tip_acceleration=tip_acceleration, start_speed=start_speed, end_speed=end_speed
        )
    _report(request, motion, run, out, dark, also)


def _require_out(out: Path | None, also: tuple[str, ...]) -> None:
    if also and out is None:
        raise click.UsageError("--also needs --out DIR.")


def _report(request: Request, motion: Motion, run: Run, out: Path | None, dark: bool, also: tuple[str, ...]) -> None:
    """Print the key figures of a run, and write its files."""
    request.say(motion)
    click.echo(summary(run))
    if out is not None:
        from ..plot import animate

        files: dict[str, Writer] = {"run.png": picture(run.plot(dark=dark))}
        writers: dict[str, Writer] = {"csv": run.to_csv, "rosbag": run.to_rosbag}
        for kind in also:
            name = kind if kind == "rosbag" else f"run.{kind}"
            files[name] = writers.get(kind, lambda file: animate(run, file, dark=dark))
        write_files(out, {**files, "run.npz": run.save, "job.toml": motion.save})
    if not run.status:
        raise click.ClickException("the motion is not complete: the status above has the cause and a remedy")


@motion_command(
    "Compare several schemes on one path.",
    """
    fpbm-cpp compare panda --hold 5
    fpbm-cpp compare planar:1,1,1,1 --radius 0.45 --weights 1,2,3,4 --schemes mvn,man,fpbm --out circle
    fpbm-cpp compare --job job.toml --null-damping 0""",
    kind=False,
    clear=True,
    keep=True,
)
@click.option(
    "--schemes", metavar="NAMES", help=f"Schemes, separated by commas; default: {', '.join(WITHOUT_DYNAMICS)}."
)
@out_option
@dark_option
def compare(request: Request, schemes: str | None, out: Path | None, dark: bool) -> None:
    """Move an arm along a path under several schemes, and compare the motions.

    Each scheme uses the options that it has. For ARM and the options, see track.

    Prints a row of figures for each scheme: whether the motion is complete, the largest tip errors, peak and final
    joint velocities and accelerations, and the least manipulability. With --out, the folder gets compare.png, a saved
    run for each scheme, and job.toml.
    """
    kinds = [name.strip() for name in schemes.split(",")] if schemes else list(WITHOUT_DYNAMICS)
    for kind in kinds:
        if kind not in SCHEMES:
            raise click.ClickException(str(not_one_of("--schemes", kind, SCHEMES)))
    motions = {kind: request.motion(kind) for kind in kinds}
    with request.plain():
        runs = {kind: motion.run() for kind, motion in motions.items()}
    chosen = motions.get(request.scheme, motions[kinds[-1]])  # Usually, this motion has the options of all schemes.
    request.say(chosen, scheme=False)
    click.echo(str(comparison(runs)))
    if out is not None:
        from ..plot import compare as figure

        saved: dict[str, Writer] = {f"{kind}.npz": run.save for kind, run in runs.items()}
        write_files(out, {"compare.png": picture(figure(runs, dark=dark)), **saved, "job.toml": chosen.save})
    if not any(run.status for run in runs.values()):
        raise click.ClickException("no motion is complete: the remarks above have the causes and remedies")


@motion_command(
    "Show an arm on its path in the browser.",
    """
    fpbm-cpp view panda --task pose
    fpbm-cpp view my_arm.urdf --tip tool0 --path lissajous --port 9000
    fpbm-cpp view --job job.toml --no-browser""",
    clear=True,
    keep=True,
)
@port_option
@browser_option
def view(request: Request, port: int, browser: bool) -> None:
    """Show an arm on its path in the browser, with inputs for the scheme and its gains.

    The meshes of a URDF file are drawn. Ctrl-C ends the command. For ARM and the options, see track.
    """
    motion = request.motion()
    with request.plain():
        run = motion.run()
    with _served():
        request.say(motion)
        import_viser()
        from ..viewer import Viewer

        Viewer(run, urdf=motion.job["arm"].get("file"), port=port, open_browser=browser).wait()


@motion_command(
    "Drag an arm's tip in the browser.",
    """
    fpbm-cpp servo panda --task pose
    fpbm-cpp servo planar:1,1,1,1 --limit-velocity 2 --limit-acceleration 10 --limit-jerk 200
    fpbm-cpp servo my_arm.urdf --tip tool0 --limit-acceleration 10 --port 9000
    fpbm-cpp servo two_pandas --task left_tip --task right_tip
    fpbm-cpp servo my_arm.urdf --tip tool0 --clearance my_arm.urdf --srdf my_arm.srdf --job walls.toml""",
    path=False,
    clear=True,
)
@port_option
@browser_option
def servo(request: Request, port: int, browser: bool) -> None:
    """Drag a handle in the browser; the tip of the arm follows within the joint limits.

    The tracker runs 1000 ticks per second on this machine's clock. A chart shows how close the joints are to their
    bounds, and a sentence gives the reason if the arm does not reach the handle. The meshes of a URDF file and the
    shapes of the clearance are drawn; arrows move obstacles that are boxes or capsules. If a job has tasks, each task
    has a handle. For a robot, each --task gives a frame a handle and a pose task. Each level has two of these
    tasks, and a posture task is on the level below. Ctrl-C ends the command. For ARM and the options, see track; the
    path of a job is ignored.
    """
    motion = request.motion(at_rest=True, limited=True)
    with _served():
        request.say(motion, path=False)
        import_viser()
        from ..viewer import Servo

        with request.plain(), job_errors():
            page = Servo(
                motion.arm,
                motion.scheme,
                motion.q0,
                task=motion.options.task,
                stack=motion.stack,
                dt=motion.options.dt,
                limits=motion.limits,
                bounds=motion.bounds,
                urdf=motion.job["arm"].get("file"),
                port=port,
                open_browser=browser,
            )
        page.wait()


@contextmanager
def _served() -> Iterator[None]:
    """Report in one line that a page cannot be served; Ctrl-C ends the command without an error."""
    try:
        yield
    except OSError as error:
        raise click.ClickException(error.strerror or str(error)) from None
    except KeyboardInterrupt:
        return
