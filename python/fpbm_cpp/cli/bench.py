"""fpbm-cpp bench."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable
from typing import NamedTuple

import click
import numpy as np

from .._core import __version__
from ..arms import Arm, PlanarArm, SerialArm
from ..job.fill import filled
from ..job.ready import READY
from ..motion.lanes import LANES
from ..motion.simulation import simulate
from ..motion.sweeping import sweep
from ..parameter import parameters
from ..paths import Circle, Path
from ..schemes import SCHEMES, Scheme
from ..table import from_table
from .figures import columns
from .plain import WIDTH, Plain

STEPS = 1000  # Of a motion: a circle in 1 s at 1 kHz.
STAGES = 4  # RK4 evaluates a scheme so often in a step.
PROCESSORS = os.cpu_count() or 1
MOTIONS = 4 * PROCESSORS * LANES  # Of a sweep.
HOW = (
    "Microseconds an evaluation of a scheme: the median time of fp.simulate() for a circle of 1 s at 1 kHz, by the "
    "4000 evaluations that RK4 makes there. An evaluation is kinematics, reference and scheme; integrating and "
    "recording are in it. Below, motions of the same kind that fp.sweep() ran in a second with FPBM, "
    f"{MOTIONS} at a time, on all processors."
)


class Case(NamedTuple):
    """An arm, its path, and what its tip keeps to."""

    name: str
    arm: Arm
    path: Path
    task: str
    q0: list[float]


@click.command("bench", short_help="Time this machine.", cls=Plain, epilog="Example: fpbm-cpp bench --seconds 1")
@click.option("--seconds", type=click.FloatRange(0.01, 60.0), default=0.2, help="How long each is timed.")
def bench(seconds: float) -> None:
    """Time this machine: what a scheme costs an evaluation, and how many motions a second a sweep runs.

    As called from Python, on whatever else the machine has to do. The source's bench folder times single steps in C++,
    and other libraries.
    """
    panda, circle = SerialArm.preset("panda"), Circle(0.1, 1.0)
    cases = [
        Case("4 links, position", PlanarArm([1, 1, 1, 1]), circle, "position", [0.4] * 4),
        Case("Panda, position", panda, circle.in_plane("yz"), "position", READY["panda"]),
        Case("Panda, pose", panda, circle.in_plane("yz"), "pose", READY["panda"]),
    ]
    schemes = [[_scheme(kind, case.arm) for kind in SCHEMES] for case in cases]
    lanes = f"{LANES} lanes" if LANES > 1 else "no lanes"
    machine = f"{platform.system()} {platform.machine()}, {PROCESSORS} processors, {lanes}"
    click.echo(f"fpbm_cpp {__version__}, Python {platform.python_version()}, NumPy {np.__version__}, {machine}")
    click.echo(f"{click.wrap_text(HOW, WIDTH)}\n")
    rows = [
        [
            type(row[0]).__name__,
            *(f"{1e6 * _evaluation(case, scheme, seconds):.3f}" for case, scheme in zip(cases, row)),
        ]
        for row in zip(*schemes)
    ]
    rate = ["motions a second", *(f"{_rate(case, row[-1], seconds):.0f}" for case, row in zip(cases, schemes))]
    click.echo(columns(["", *(case.name for case in cases)], *rows, [""], rate))


def _scheme(kind: str, arm: Arm) -> Scheme:
    """The scheme that jobs take, with weights that differ."""
    weights = {"weights": range(1, arm.dof + 1)} if "weights" in parameters(SCHEMES[kind]) else {}
    full = filled({"scheme": {"kind": kind, **weights}}, None)
    return from_table(full["scheme"])  # type: ignore[no-any-return]


def _evaluation(case: Case, scheme: Scheme, seconds: float) -> float:
    """Median time of one evaluation [s]."""
    return _median(lambda: simulate(*case[1:3], scheme, case.q0, task=case.task), seconds) / (STEPS * STAGES)


def _rate(case: Case, scheme: Scheme, seconds: float) -> float:
    """Motions a second."""
    q0s = case.q0 + np.random.default_rng(0).normal(0.0, 0.02, (MOTIONS, len(case.q0)))
    return MOTIONS / _median(lambda: sweep(*case[1:3], scheme, q0s, task=case.task), seconds)


def _median(run: Callable[[], object], seconds: float) -> float:
    """Median time of a run, of as many as there is time for, three at least, after one that does not count [s]."""
    run()
    times: list[float] = []
    while len(times) < 3 or sum(times) < seconds:
        begin = time.perf_counter()
        run()
        times.append(time.perf_counter() - begin)
    return float(np.median(times))
