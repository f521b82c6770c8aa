"""Two Pandas hold a tray, by fpbm_cpp and other libraries: `python bench/grasp_peers.py [--motions 20]` prints a table.

The random object paths are from bench/grasp.cpp, and are faster than the arms. The bounds are from the preset.
The error of the relative pose is the largest error in each motion. The excess over the bounds is computed by
differences of positions. For velocities and accelerations, the excess is relative to the bound. Each library is
installed from PyPI into its own virtual environment. The output lists libraries that cannot be installed.

The other libraries minimise weighted squares. In Pink, Mink and roboplan, the cost of the relative pose is 100, and the
cost of the object is 1. In PlaCo, the relative pose is an equality. The libraries receive the pose of the object for
the end of the tick. With a gain of 1, the default, the libraries correct the whole error of the object in one tick.
With a gain of 0.02, the error decays at 20/s. fpbm_cpp also bounds accelerations and jerks.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
from stack_peers import HERE, Environment, call, table

PACKAGES = {"Pink": ("pin-pink", "daqp"), "Mink": ("mink", "daqp"), "PlaCo": ("placo",), "roboplan": ("roboplan",)}
# Name of the row, library, and arguments of grasp_worker.Options.
ROWS: list[tuple[str, str, list[Any]]] = [
    ("Pink", "Pink", [1]),
    ("Pink, gain 0.02", "Pink", [0.02]),
    ("Pink, gain 0.02, accelerations", "Pink", [0.02, True]),
    ("Mink", "Mink", [1]),
    ("Mink, gain 0.02", "Mink", [0.02]),
    ("PlaCo", "PlaCo", [1]),
    ("PlaCo, gain 0.02", "PlaCo", [0.02]),
    ("roboplan", "roboplan", [1]),
    ("roboplan, gain 0.02", "roboplan", [0.02]),
    ("roboplan, gain 0.02, accelerations", "roboplan", [0.02, True]),
]
HEADS = [
    "", "relative position [m]: median", "99 %", "largest", "rotation [rad]: median", "99 %", "largest",
    "object, rms [mm]", "excess of position [rad]", "velocity", "acceleration", "ticks without answer", "a tick [µs]",
]  # fmt: skip


def row(name: str, motions: list[dict[str, Any]]) -> list[str]:
    errors = np.array([each["grasp"] for each in motions])
    worst = np.array([each["excess"] for each in motions]).max(axis=0)
    return [
        name,
        *(f"{value:.1e}" for i in range(2) for value in (*np.percentile(errors[:, i], (50, 99)), errors[:, i].max())),
        f"{1e3 * np.mean([each['object'] for each in motions]):.0f}",
        *(f"{value:.1e}" for value in worst),
        f"{sum(each['failed'] for each in motions)}",
        f"{np.median([each['time'] for each in motions]):.0f}",
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--motions", type=int, default=20)
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    parser.add_argument("--work", type=Path, default=HERE.parent / "build" / "stack_peers", help="for installed peers")
    parser.add_argument("--skip", nargs="*", default=[], metavar="PEER")
    options = parser.parse_args()

    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1", "PYTHONWARNINGS": "ignore"}
    versions, missing = [], []

    def motions(python: Path, solver: str, given: list[Any]) -> list[dict[str, Any]]:
        seeds = (str(options.motions), str(options.first))
        printed = call(python, HERE / "grasp_worker.py", solver, *seeds, json.dumps(given), env=environment)
        return json.loads(printed.strip().split("\n")[-1])

    rows, environments = [], {}
    for name, packages in PACKAGES.items():
        if name in options.skip:
            continue
        try:
            environments[name] = Environment(options.work.resolve() / name.lower(), packages)
            versions.append(environments[name].versions(packages))
        except subprocess.SubprocessError as error:
            missing.append(f"{name}: {error}")
    ours = next(iter(environments.values())).python if environments else Path(sys.executable)
    rows.append(row("fpbm_cpp", motions(ours, "fpbm_cpp", [])))
    for name, solver, given in ROWS:
        if solver in environments:
            rows.append(row(name, motions(environments[solver].python, solver, given)))
            print(" | ".join(rows[-1]), flush=True)
    print(f"\n{options.motions} motions; {'; '.join(versions)}")
    print("\n".join([*(f"Missing: {each}" for each in missing), *table(HEADS, rows)]))


if __name__ == "__main__":
    main()
