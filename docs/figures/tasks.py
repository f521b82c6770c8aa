"""A Panda carries a cup along a wall that its elbow avoids: draws tasks.gif.

python docs/figures/tasks.py [where to write the film]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import fpbm_cpp as fp
from fpbm_cpp.plot import animate
from fpbm_cpp.skeleton import link_frames

Q0 = [0, -0.3, 0, -2.2, 0, 2, 0.785]
WALL = 0.06  # [m]


def main(file: Path) -> None:
    arm = fp.SerialArm.preset("panda")
    stack = fp.Stack(
        fp.AxisTask(x=[0, 0, -1], name="upright"),
        fp.PositionTask(name="place"),
        fp.PostureTask(Q0, k1=4, k2=4),
    )
    wall = fp.TaskBounds(fp.PositionTask("panda_joint4", rows=("y",), name="elbow"), upper=WALL, deceleration=1)
    path = fp.Line([0.05, 0.35, 0.1], 2.5).then(fp.Line([-0.05, -0.7, -0.1], 3.5))
    scheme = fp.Balanced(0.6, np.ones(7), null_damping=2)
    run = fp.track(arm, path, scheme, Q0, stack=stack, task="place", bounds=[wall], hold=1.5)
    elbow = max(link_frames(arm, q)[4][1, 3] for q in run.q)
    tilt, place = (np.linalg.norm(run.errors[name], axis=1) for name in ("upright", "place"))
    print(f"y of the elbow: at most {elbow:.6f} m, bound {WALL} m; tilt after 2 s: at most {tilt[2000:].max():.0e} rad")
    print(f"error of the place: at most {place.max():.2f} m, at the end {place[-1]:.0e} m")
    animate(run, file, fps=12.5, panels=["task_errors", "scale"], dpi=90)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent.parent / "tasks.gif")
