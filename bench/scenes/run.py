"""Published scenes of several tasks in strict priority: runs all, and writes results/scenes.md and its figures.

python bench/scenes/run.py [--problems 1000] [--folder bench/results]
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import beyond_bounds
import compare
import lwr_hexagon
import lwr_segment
import numpy as np
import panda_problems
import planar_hexagon
from figures import draw_panda, draw_planar, draw_segment

import fpbm_cpp as fp

RESULTS = Path(__file__).parent.parent / "results"


def planar(folder: Path) -> Iterator[str]:
    scene, cases = planar_hexagon.SCENE, planar_hexagon.CASES
    found = compare.outcomes(scene, cases, planar_hexagon.INNER)
    draw_planar(folder / "scenes_planar.png", scene, cases, found)
    yield "## Planar hexagon\n"
    yield from compare.table(cases, found, len(scene.vertices), "link 1")
    yield "\n![Tip, directional error and scale of the planar arm](scenes_planar.png)\n"
    yield from compare.scale_table(found)
    yield f"\nForward kinematics by NumPy and by the library agree to {compare.agreement(scene, found):.1e} m."


def segment(folder: Path) -> Iterator[str]:
    scene, cases = lwr_segment.SCENE, lwr_segment.CASES
    found = compare.outcomes(scene, cases, lwr_segment.INNER)
    draw_segment(folder / "scenes_segment.png", scene, cases, found)
    yield "## KUKA LWR, segment\n"
    yield from compare.table(cases, found, len(scene.vertices), "elbow")
    yield "\n![Distance from the line, directional error and scale of the KUKA LWR](scenes_segment.png)\n"
    yield from compare.scale_table(found)
    yield f"\nForward kinematics by NumPy and by the library agree to {compare.agreement(scene, found):.1e} m."


def hexagon() -> Iterator[str]:
    yield "## KUKA LWR, hexagon of the paper\n"
    yield from lwr_hexagon.run()


def panda(folder: Path, problems: int) -> Iterator[str]:
    yield f"## Panda, {problems} problems\n"
    yield (
        "| method | success rate | median time [s] | longest [s] | off the line / its length, median "
        "| mean scale of each level | q [rad] | q̇ by Δq, relative | q̈ by Δ²q, relative |"
    )
    yield "|---|---:|---:|---:|---:|---:|---:|---:|---:|"
    rows = []
    for row in panda_problems.rows(problems):
        rows.append(row)
        yield row.text
    draw_panda(folder / "scenes_panda.png", rows)
    velocity, acceleration, qp = (row.solved for row in rows)
    yield "\n![Problems solved over time](scenes_panda.png)\n"
    yield f"Problems that no method solves: {np.sum(~velocity & ~acceleration & ~qp)}."
    for name, solved in (("velocity", velocity), ("acceleration", acceleration)):
        yield (
            f"Solved by SciPy and not by the Tracker at {name} level: {np.sum(qp & ~solved)}; "
            f"by the Tracker and not by SciPy: {np.sum(solved & ~qp)}."
        )
    yield ""
    yield from panda_problems.published()


def falls_short() -> Iterator[str]:
    yield "## A desired velocity beyond the bounds\n"
    yield from beyond_bounds.run()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--problems", type=int, default=1000, help="of the Panda")
    parser.add_argument("--folder", type=Path, default=RESULTS, help="folder of scenes.md and the figures")
    options = parser.parse_args()
    folder: Path = options.folder
    lines = [f"# Published scenes\n\nBy `python bench/scenes/run.py`, fpbm_cpp {fp.__version__}. See docs/scenes.md.\n"]
    parts = (planar(folder), segment(folder), hexagon(), panda(folder, options.problems), falls_short())
    for part in parts:
        for line in part:
            print(line, flush=True)
            lines.append(line)
        lines.append("")
    (folder / "scenes.md").write_text("\n".join(lines).rstrip() + "\n")


if __name__ == "__main__":
    main()
