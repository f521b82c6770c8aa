"""Arm-steps per second of fp.sweep, by the type of SIMD lanes and the number of threads.

The motions are the paper's circle, and a circle of a Panda with a pose task, without limits and within the limits of
the Panda. An arm-step is an RK4 step of 1 ms of one motion: four evaluations of the closed loop. The package selects
the lanes when it is imported. Therefore, each type of lanes has its own process. Rounds of the types alternate. "none"
is the code for every processor. This code is timed with fewer motions, because its motions per second do not depend on
their number.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import fpbm_cpp as fp
from fpbm_cpp import _core

WORKERS, ROUNDS, DT = (1, 2), 3, 1e-3
FEWER, FEWEST = 10, 64  # Divisor of the number of motions without lanes; smallest number, for an even load of threads.
PAPER = "planar4/position"
CHECKED, TOLERANCE = 32, 1e-9
SCATTER = 0.01  # Spread of the start postures [rad], with which every motion stays within the workspace.


class Case(NamedTuple):
    """Motions with one scheme along one path, from random start postures around q0."""

    arm: fp.Arm
    path: fp.Path
    scheme: fp.Scheme
    q0: NDArray[np.float64]
    task: str
    share: float  # Fraction of the number of motions.
    limits: fp.JointLimits | None = None


PANDA = Case(
    fp.SerialArm.preset("panda"),
    fp.Circle(0.15, 4.0).in_plane("yz"),
    fp.FPBM(0.6, np.arange(1.0, 8.0), 10.0, 25.0, null_damping=2.0),
    np.array([0, -0.3, 0, -2.2, 0, 2.0, 0.785]),
    "pose",
    0.2,
)
CASES = {
    PAPER: Case(
        fp.PlanarArm(np.ones(4)),
        fp.Circle(0.45, 10.0),
        fp.FPBM(0.6, np.arange(1.0, 5.0), 1.0, 1.0),
        np.pi / np.array([12, 12, 15, 15]),
        "position",
        1.0,
    ),
    "panda/pose": PANDA,
    "panda/pose/limited": PANDA._replace(share=0.1, limits=PANDA.arm.limits),
}


def kinds() -> list[str]:
    """A list with "none", then the types of lanes that this processor and this build of the package have."""
    return ["none", *(kind for kind in _core.processor_kinds()[::-1] if find_spec(f"fpbm_cpp._lanes_{kind}"))]


def measure(motions: int) -> list[dict[str, Any]]:
    """Durations of each case with each number of workers in this process [s], and some of the results."""
    rows = []
    for name, case in CASES.items():
        count = max(FEWEST, round(case.share * motions))
        starts = case.q0 + np.random.default_rng(0).normal(0, SCATTER, (count, len(case.q0)))
        for workers in WORKERS:
            begin = time.perf_counter()
            sweep = fp.sweep(
                case.arm, case.path, case.scheme, starts, DT, task=case.task, limits=case.limits, workers=workers
            )
            seconds = time.perf_counter() - begin
            if not sweep.ok.all():
                raise SystemExit(f"{name}: {(~sweep.ok).sum()} of {count} motions stopped early")
            row = {"name": name, "workers": workers, "motions": count, "seconds": seconds}
            rows.append({**row, "answers": sweep.peak_velocity[0, :CHECKED].tolist()})
    return rows


def measured_in(kind: str, motions: int) -> list[dict[str, Any]]:
    """Results of measure() in a process with this type of lanes."""
    command = [sys.executable, __file__, "--measure", "--motions", str(motions)]
    run = subprocess.run(command, env={**os.environ, "FPBM_LANES": kind}, stdout=subprocess.PIPE, check=False)
    if run.returncode != 0:
        raise SystemExit(f"sweeps in lanes {kind} failed")
    rows: list[dict[str, Any]] = json.loads(run.stdout)
    return [{**row, "lanes": kind} for row in rows]


def table(runs: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The best round of each row, with the ratio of its rate to the rate of one thread without lanes."""
    best: dict[tuple[str, str, int], dict[str, Any]] = {}
    for run in runs:
        key = run["name"], run["lanes"], run["workers"]
        expected = best.setdefault((run["name"], "none", 1), run)["answers"]
        common = min(len(expected), len(run["answers"]))
        if not np.allclose(run["answers"][:common], expected[:common], rtol=TOLERANCE, atol=0.0):
            raise SystemExit(f"{run['name']}: results in lanes {run['lanes']} differ from results without lanes")
        best[key] = min(best.get(key, run), run, key=lambda run: float(run["seconds"]))
    rows: list[dict[str, Any]] = []
    for (name, kind, workers), run in sorted(best.items(), key=lambda item: list(CASES).index(item[0][0])):
        rate = run["motions"] * round(CASES[name].path.duration / DT) / run["seconds"]
        row = {"name": name, "lanes": kind, "workers": workers, "motions": run["motions"], "per_second": rate}
        scalar = next((row["per_second"] for row in rows if row["name"] == name), rate)  # The first row with this name.
        rows.append({**row, "ratio": rate / scalar})
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, help="also write the rates to this JSON file")
    parser.add_argument("--motions", type=int, default=10_000, help="on the paper's circle; the Panda has fewer")
    parser.add_argument("--measure", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.measure:
        print(json.dumps(measure(options.motions)))
        return

    runs = []
    for _ in range(ROUNDS):
        for kind in kinds():
            runs += measured_in(kind, options.motions // FEWER if kind == "none" else options.motions)
    rows = table(runs)
    print(f"{'sweep':20}{'lanes':>8}{'threads':>9}{'motions':>9}{'arm-steps/s':>14}{'ratio':>8}")
    for row in rows:
        where = f"{row['name']:20}{row['lanes']:>8}{row['workers']:9}{row['motions']:9}"
        print(f"{where}{row['per_second'] / 1e6:12.2f} M{row['ratio']:8.2f}")
    best = max(row["ratio"] for row in rows if row["name"] == PAPER)
    print(f"the paper's circle, largest ratio to one thread without lanes: {best:.1f} (required: 10)")
    if options.out:
        options.out.write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
