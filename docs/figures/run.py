"""A Panda on a circle in the least time: draws run.png, the plots of a run whose tip stays on its path.

    python docs/figures/run.py [where to write the picture]

Needs the extra 'plot'.
"""

from __future__ import annotations

import sys
from pathlib import Path

import fpbm_cpp as fp


def main() -> None:
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "run.png"
    arm = fp.SerialArm.preset("panda")
    path = fp.Circle(0.15, 1.0).in_plane("yz")
    run = fp.fastest(arm, path, fp.MVN(), [0, -0.3, 0, -2.2, 0, 2, 0.785], task="pose")
    run.plot().savefig(target, dpi=140)


if __name__ == "__main__":
    main()
