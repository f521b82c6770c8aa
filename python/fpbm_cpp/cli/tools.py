"""Other commands: bench, reproduce, export-header, export-capsules, completion."""

import json
import os
import platform
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
import numpy as np
from click.shell_completion import get_completion_class

from .._core import PRESETS, ROBOT_PRESETS, __version__
from ..capsule import Capsule
from ..clearance import Clearance
from ..files import write_whole
from ..io.header import SCALARS
from ..job import Motion, prepare
from ..job.sections import Table
from ..joints import JointLimits, limited
from ..motion._lanes import LANES
from ..motion.comparison import columns
from ..motion.sweeping import sweep
from ..parameter import parameters
from ..robots import Robot
from ..schemes import WITHOUT_DYNAMICS
from ..urdf.capsules import capsules_of, read_joints
from ..worst import measure
from .plain import OUT, PLACE, WIDTH, Plain, file_errors, read_arm, refuse_links
from .request import limit_options

EVALUATIONS = 4000  # Evaluations of a scheme by RK4 on a path of 1 s at 1 kHz.
PROCESSORS = os.cpu_count() or 1
MOTIONS = 4 * PROCESSORS * LANES  # Motions of a sweep.
HOW = (
    "Microseconds per evaluation of a scheme: the median time of fp.simulate() for a circle of 1 s at 1 kHz, divided "
    f"by the {EVALUATIONS} evaluations of RK4. The time includes kinematics, reference, scheme, integration and "
    "recording. Last row: motions of the same kind per second of fp.sweep() with FPBM, "
    f"{MOTIONS} at a time, on all processors."
)
HOW_WORST = (
    "Microseconds per tick of fp.Tracker, called from Python: a tick without active limits, and ticks of the motion "
    "with the longest tick that a search has found. Each time is the least of several runs. Passes: bound on the "
    "saturation passes in a tick. bench/worst.cpp in the source measures these motions in C++, and also a clearance "
    "and two arms."
)
HEADER = "Header file to write; - is the standard output."
PARAMETERS = "Parameter file to write; - is the standard output."
ROUNDING = 2e-6  # Added to the radius of a capsule whose ends are rounded to 1e-6 [m].
PLANAR, PANDA = {"kind": "planar", "lengths": [1.0] * 4}, {"kind": "preset", "name": "panda"}
CASES: dict[str, Table] = {
    "4 links, position": {"arm": PLANAR},
    "Panda, position": {"arm": PANDA},
    "Panda, pose": {"arm": PANDA, "run": {"task": "pose"}},
}


def tool(short_help: str, example: str) -> Callable[[Callable[..., None]], click.Command]:
    """A command with an example of how to call it."""
    return click.command(cls=Plain, short_help=short_help, epilog=f"Example: fpbm-cpp {example}")


@tool("Measure this machine.", "bench --seconds 1")
@click.option("--seconds", type=click.FloatRange(0.01, 60.0), default=0.2, help="Time for each measurement [s].")
@click.option("--worst", is_flag=True, help="Measure the longest ticks that a search has found.")
@click.option("--runs", type=click.IntRange(1, 1000), default=20, help="Number of runs of each motion, with --worst.")
def bench(seconds: float, worst: bool, runs: int) -> None:
    """Measure this machine: the time of an evaluation of each scheme, and the motions per second of a sweep.

    The calls are from Python, under the present load of the machine. The bench folder of the source measures single
    steps in C++, and other libraries.
    """
    if worst:
        click.echo(f"{click.wrap_text(HOW_WORST, WIDTH)}\n")
        rows = [[each.case, *(f"{time:.1f}" for time in each[1:5]), str(each.passes)] for each in measure(runs)]
        return click.echo(columns(["", "free", "median", "p99.9", "worst", "passes"], *rows))
    lanes = f"{LANES} lanes" if LANES > 1 else "no lanes"
    machine = f"{platform.system()} {platform.machine()}, {PROCESSORS} processors, {lanes}"
    click.echo(f"fpbm_cpp {__version__}, Python {platform.python_version()}, NumPy {np.__version__}, {machine}")
    click.echo(f"{click.wrap_text(HOW, WIDTH)}\n")
    rows = []
    for kind, scheme in WITHOUT_DYNAMICS.items():
        times = [_median(_motion(case, kind).run, seconds) / EVALUATIONS for case in CASES]
        rows.append([scheme.__name__, *(f"{1e6 * each:.3f}" for each in times)])
    rates = [f"{_rate(_motion(case, 'fpbm'), seconds):.0f}" for case in CASES]
    click.echo(columns(["", *CASES], *rows, [""], ["motions per second", *rates]))


def _motion(case: str, kind: str) -> Motion:
    return prepare({**CASES[case], "path": {"kind": "circle", "duration": 1.0}, "scheme": {"kind": kind}})


def _rate(motion: Motion, seconds: float) -> float:
    q0s = motion.q0 + np.random.default_rng(0).normal(0.0, 0.02, (MOTIONS, motion.arm.dof))
    return MOTIONS / _median(lambda: sweep(*motion.of_one_arm(), motion.scheme, q0s, **motion.keywords), seconds)


def _median(run: Callable[[], object], seconds: float) -> float:
    """Median time of a run [s], over as many runs as the seconds allow, at least three, after one run to warm up."""
    run()
    times: list[float] = []
    while len(times) < 3 or sum(times) < seconds:
        begin = time.perf_counter()
        run()
        times.append(time.perf_counter() - begin)
    return float(np.median(times))


@tool("Reproduce the FPBM paper.", "reproduce --out reproduction")
@click.option("--out", type=PLACE, metavar="DIR", default="reproduction", help=OUT)
def reproduce(out: Path) -> None:
    """Reproduce the FPBM paper: figures, tables, errata and claims.

    Runs the paper's 18 motions, compares them with the printed numbers and with an independent solution, and writes
    Figs. 1 to 8 (fig1.png, fig1.pdf and so on) and report.md. Takes about 15 seconds. The exit status is 1 if a motion
    differs from the independent solution by more than 1e-9.
    """
    start = time.perf_counter()
    try:
        from .. import reproduce as paper

        with file_errors("write to"):
            done = paper.reproduce(out, say=lambda step: click.echo(f"{step} ...", err=True))
    except KeyboardInterrupt:
        raise KeyboardInterrupt("interrupted; every written file is complete") from None
    for table in done.tables:
        click.echo(f"\n{table.text()}")
    click.echo("\nClaims, with the numbers in report.md")
    for i, claim in enumerate(done.claims, 1):
        click.echo(f"{i}. {claim.statement}: {claim.verdict}")
    for line in done.summary:
        click.echo("\n" + click.wrap_text(line, width=WIDTH))
    click.echo(f"\n{len(done.files)} files in {out}{os.sep}, {time.perf_counter() - start:.0f} s")
    if not done.agrees:
        raise click.ClickException("a motion differs from the independent solution by more than 1e-9: see report.md")


@tool("Write an arm or a robot as a C++ header.", "export-header my_arm.urdf --tip tool -o my_arm.hpp")
@click.argument("arm", metavar="ARM", type=PLACE)
@click.option("--tip", metavar="LINK", multiple=True, help="Tip link: one for an arm, several for a robot.")
@click.option("--base", metavar="LINK", help="Base link of an arm, default: the root; for a robot: fixed or planar.")
@click.option("-o", "--out", type=PLACE, metavar="FILE.hpp", required=True, help=HEADER)
@click.option("--name", metavar="NAMESPACE", help="C++ namespace; default: from the file name of the header.")
@click.option(
    "--capsules", is_flag=True, help="Add capsules that contain the links' collision geometry; for an arm only."
)
@click.option("--scalar", type=click.Choice(SCALARS), default="double", help="Type of all numbers.")
def export_header(
    arm: Path,
    tip: tuple[str, ...],
    base: str | None,
    out: Path,
    name: str | None,
    capsules: bool,
    scalar: str,
    **bounds: Any,
) -> None:
    """Write a URDF file, or a preset such as panda or two_pandas, as a C++ header.

    With one --tip, the header constructs the arm from base to tip. With several --tip, the header constructs the robot:
    the tree of the joints that move the tips, with these links as frames. Without --tip, the robot has all joints and
    links of the file. A program with the header reads no file. The options for limits replace bounds of the file or
    the preset: URDF files have no bounds on acceleration.
    """
    from ..io.header import export_header, export_tree, namespace_of

    is_robot = str(arm) in ROBOT_PRESETS or (str(arm) not in PRESETS and len(tip) != 1)
    if is_robot and capsules:
        raise click.UsageError("--capsules are for an arm only: give one --tip.")
    try:
        name = name or namespace_of((arm if str(out) == "-" else out).stem)
        given = {key.removeprefix("limits__"): value for key, value in bounds.items() if value is not None}
        limits = JointLimits(**given) if given else None
        how: dict[str, Any] = {"name": name, "source": _source(arm, tip, base, given), "scalar": scalar}
        if is_robot:
            header = export_tree(_robot(arm, tip, base, limits), **how)
        else:
            exported = read_arm(arm, tip[0] if tip else None, base, limits)
            shapes = _capsules(arm, tip, base, limits) if capsules else None
            header = export_header(exported.joints, exported.tip, capsules=shapes, **how)
    except ValueError as error:
        raise click.ClickException(str(error)) from None
    _write(out, header)


export_header.params += limit_options()


def _write(out: Path, text: str) -> None:
    if str(out) == "-":
        click.echo(text, nl=False)
        return
    with file_errors("write to", out):
        write_whole(out.resolve(), text.encode())


@tool("Write capsules as ROS 2 parameters.", "export-capsules my_arm.urdf --tip tool -o capsules.yaml")
@click.argument("urdf", metavar="URDF", type=PLACE)
@click.option("--tip", metavar="LINK", multiple=True, required=True, help="Tip link; several for a robot.")
@click.option("--base", metavar="LINK", help="Base link, default: the root.")
@click.option("--srdf", type=PLACE, metavar="FILE", help="SRDF file of MoveIt, whose disabled pairs may meet.")
@click.option("-o", "--out", type=PLACE, metavar="FILE.yaml", required=True, help=PARAMETERS)
def export_capsules(urdf: Path, tip: tuple[str, ...], base: str | None, srdf: Path | None, out: Path) -> None:
    """Write capsules that contain the collision geometry of a URDF file, as parameters of the ROS 2 controller.

    Give the file of robot_description, the tip or the frames of the tasks, and base_frame of the controller. Each
    capsule is in the frame of its link.
    """
    one, several = (tip[0], None) if len(tip) == 1 else (None, tip)
    try:
        with file_errors("read"):
            places = read_joints(urdf, one, base, tips=several)[1]
            clearance = Clearance.from_urdf(urdf, one, base, tips=several, srdf=srdf)
    except ValueError as error:
        raise click.ClickException(str(error)) from None
    rows = []
    for each in clearance.capsules:
        in_link = np.linalg.inv(places[each.name][1])
        ends = [in_link[:3, :3] @ end + in_link[:3, 3] for end in (each.a, each.b)]
        rows.append(", ".join(f"{x:.6f}" for x in (*np.ravel(ends), each.radius + ROUNDING)))
    numbers = ",\n                 ".join(rows)
    links = json.dumps([each.name for each in clearance.capsules])
    pairs = json.dumps([name for pair in clearance.allowed for name in pair])
    allowed = f"      allowed: {pairs}\n" if clearance.allowed else ""  # ROS rejects empty lists.
    _write(
        out,
        f"# Written by fpbm-cpp export-capsules from {urdf.name}. Each capsule: both ends and the radius [m].\n"
        f"/**:\n  ros__parameters:\n    clearance:\n      links: {links}\n"
        f"      capsules: [{numbers}]\n{allowed}",
    )


def _source(place: Path, tips: Sequence[str], base: str | None, limits: Mapping[str, Any]) -> str:
    """Source of the joints, for a comment."""
    said = [f"preset {place}" if str(place) in (*PRESETS, *ROBOT_PRESETS) else place.name]
    said += [f"base {base}"] if base else []
    said += [f"tip{'s' * (len(tips) > 1)} {', '.join(tips)}"] if tips else []
    for key in parameters(JointLimits):
        if key in limits:
            said.append(f"--limit-{key.replace('_', '-')} {','.join(f'{x:g}' for x in np.ravel(limits[key]))}")
    return ", ".join(said)


def _capsules(arm: Path, tip: Sequence[str], base: str | None, limits: JointLimits | None) -> Sequence[Capsule]:
    if str(arm) in PRESETS:
        return Clearance.preset(str(arm)).capsules
    with file_errors("read", arm):
        return capsules_of(arm, tip[0], base, limits=limits)


def _robot(urdf: Path, tips: Sequence[str], base: str | None, limits: JointLimits | None) -> Robot:
    """The robot of a preset or a file; the frames are the tips, by default all links."""
    if str(urdf) in ROBOT_PRESETS:
        refuse_links(urdf, *tips, base)
        robot = Robot.preset(str(urdf))
        changed = limited([each.joint for each in robot.joints], limits)
        return replace(robot, joints=[replace(each, joint=joint) for each, joint in zip(robot.joints, changed)])
    with file_errors("read", urdf):
        robot = Robot.from_urdf(urdf, base=base, tips=tips or None, limits=limits)
    return replace(robot, named_frames=[frame for frame in robot.named_frames if not tips or frame.name in tips])


@click.command(
    "completion",
    short_help="Print the completion script of a shell.",
    epilog="""\b
Examples:
  eval "$(fpbm-cpp completion bash)"      # in ~/.bashrc
  eval "$(fpbm-cpp completion zsh)"       # in ~/.zshrc
  fpbm-cpp completion fish > ~/.config/fish/completions/fpbm-cpp.fish""",
)
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
@click.pass_context
def completion(context: click.Context, shell: str) -> None:
    """Print a script that makes a shell complete the commands and options of fpbm-cpp."""
    kind = get_completion_class(shell)
    assert kind is not None
    click.echo(kind(context.find_root().command, {}, "fpbm-cpp", "_FPBM_CPP_COMPLETE").source())
