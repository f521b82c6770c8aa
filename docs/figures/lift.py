"""A Panda lifts 3 kg (examples/22_lift_a_load.py): draws lift.png, with the torques over time.

python docs/figures/lift.py [where to write the picture]
"""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from fpbm_cpp.plot import OKABE_ITO

DOCS = Path(__file__).parent.parent
sys.path.insert(0, str(DOCS.parent / "examples"))
example = importlib.import_module("22_lift_a_load")


def main() -> None:
    out = Path(sys.argv[1] if len(sys.argv) > 1 else DOCS / "lift.png")
    figure, axes = plt.subplots(figsize=(7, 3), layout="constrained")
    for (name, bounds), color in zip(example.CASES.items(), (OKABE_ITO[5], OKABE_ITO[0], OKABE_ITO[2])):
        torque = np.array([tick.torque for tick in example.lift(bounds)])
        share = np.max(np.abs(torque) / example.ARM.limits.effort, axis=1)
        axes.plot(1e-3 * np.arange(len(share)), share, label=name, color=color, lw=1.4)
    axes.axhline(1.0, color="0.5", lw=0.8, ls="--")
    axes.set(xlabel="time [s]", ylabel="largest torque / effort", xlim=(0, None))
    axes.grid(alpha=0.25, lw=0.5)
    axes.legend(fontsize=8)
    figure.savefig(out, dpi=120)


if __name__ == "__main__":
    main()
