"""A Panda on a circle that is too fast for its joint limits: draws run.png, the plots of a run within limits.

    python docs/figures/run.py [where to write the picture]

Needs the extra 'plot'.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import fpbm_cpp as fp


def main() -> None:
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "run.png"
    arm = fp.SerialArm.preset("panda")
    path = fp.Circle(0.15, 1.8, time_law="quintic").in_plane("yz")
    scheme = fp.FPBM(0.6, np.ones(7), k1=10, k2=25, null_damping=2)
    run = fp.track(arm, path, scheme, [0, -0.3, 0, -2.2, 0, 2, 0.785], task="pose", hold=1.0)
    run.plot().savefig(target, dpi=140)


if __name__ == "__main__":
    main()
