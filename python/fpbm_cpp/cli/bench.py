"""fpbm-cpp bench."""

import os
import platform
import time
from collections.abc import Callable

import click
import numpy as np

from .._core import __version__
from ..job import Motion, prepare
from ..job.sections import Table
from ..motion.lanes import LANES
from ..motion.sweeping import sweep
from ..schemes import SCHEMES
from .figures import columns
from .plain import WIDTH, Plain

EVALUATIONS = 4000  # Of a scheme, by RK4, on a path of 1 s at 1 kHz.
PROCESSORS = os.cpu_count() or 1
MOTIONS = 4 * PROCESSORS * LANES  # Of a sweep.
HOW = (
    "Microseconds an evaluation of a scheme: the median time of fp.simulate() for a circle of 1 s at 1 kHz, by the "
    f"{EVALUATIONS} evaluations that RK4 makes there. An evaluation is kinematics, reference and scheme; integrating "
    "and recording are in it. Below, motions of the same kind that fp.sweep() ran in a second with FPBM, "
    f"{MOTIONS} at a time, on all processors."
)
PLANAR, PANDA = {"kind": "planar", "lengths": [1.0] * 4}, {"kind": "preset", "name": "panda"}
CASES: dict[str, Table] = {
    "4 links, position": {"arm": PLANAR},
    "Panda, position": {"arm": PANDA},
    "Panda, pose": {"arm": PANDA, "run": {"task": "pose"}},
}


@click.command("bench", short_help="Time this machine.", cls=Plain, epilog="Example: fpbm-cpp bench --seconds 1")
@click.option("--seconds", type=click.FloatRange(0.01, 60.0), default=0.2, help="How long each is timed.")
def bench(seconds: float) -> None:
    """Time this machine: what a scheme costs an evaluation, and how many motions a second a sweep runs.

    As called from Python, on whatever else the machine has to do. The source's bench folder times single steps in C++,
    and other libraries.
    """
    lanes = f"{LANES} lanes" if LANES > 1 else "no lanes"
    machine = f"{platform.system()} {platform.machine()}, {PROCESSORS} processors, {lanes}"
    click.echo(f"fpbm_cpp {__version__}, Python {platform.python_version()}, NumPy {np.__version__}, {machine}")
    click.echo(f"{click.wrap_text(HOW, WIDTH)}\n")
    rows = []
    for kind, scheme in SCHEMES.items():
        times = [_median(_motion(case, kind).run, seconds) / EVALUATIONS for case in CASES]
        rows.append([scheme.__name__, *(f"{1e6 * each:.3f}" for each in times)])
    rates = [f"{_rate(_motion(case, 'fpbm'), seconds):.0f}" for case in CASES]
    click.echo(columns(["", *CASES], *rows, [""], ["motions a second", *rates]))


def _motion(case: str, kind: str) -> Motion:
    return prepare({**CASES[case], "path": {"kind": "circle", "duration": 1.0}, "scheme": {"kind": kind}})


def _rate(motion: Motion, seconds: float) -> float:
    """Motions a second."""
    q0s = motion.q0 + np.random.default_rng(0).normal(0.0, 0.02, (MOTIONS, motion.arm.dof))
    return MOTIONS / _median(lambda: sweep(motion.arm, motion.path, motion.scheme, q0s, **motion.keywords), seconds)


def _median(run: Callable[[], object], seconds: float) -> float:
    """Median time of a run, of as many as there is time for, three at least, after one that does not count [s]."""
    run()
    times: list[float] = []
    while len(times) < 3 or sum(times) < seconds:
        begin = time.perf_counter()
        run()
        times.append(time.perf_counter() - begin)
    return float(np.median(times))
