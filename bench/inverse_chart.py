"""Problems of inverse kinematics solved within a time: `python bench/inverse_chart.py` draws inverse_peers.png.

`python bench/inverse_peers.py --write` measures the times.
"""

from __future__ import annotations

import json
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from fpbm_cpp.plot import OKABE_ITO

FILE = Path(__file__).parent / "results" / "inverse_peers.json"
ARMS = {"panda": "Panda, 7 joints", "ur5e": "UR5e, 6 joints"}
TICKS = {10: "10 µs", 100: "100 µs", 1e3: "1 ms", 1e4: "10 ms", 1e5: "100 ms"}
# Rows of inverse_peers.py, with labels and styles.
SHOWN = {
    "fpbm_cpp": ("fpbm_cpp", OKABE_ITO[5], "-"),
    "EAIK": ("EAIK, closed form", OKABE_ITO[2], "--"),
    "ssik, nearest answer": ("ssik, closed form", OKABE_ITO[4], "--"),
    "Robotics Toolbox, ik_LM": ("Robotics Toolbox", OKABE_ITO[0], "-"),
    "KDL, LMA": ("KDL, with restarts", OKABE_ITO[1], "-"),
    "OptIK": ("OptIK", OKABE_ITO[3], "-"),
    "roboplan, SimpleIk": ("roboplan", OKABE_ITO[2], "-"),
    "TRAC-IK, 1 core": ("TRAC-IK", OKABE_ITO[6], "-"),
    "Pinocchio, loop in Python": ("Pinocchio, loop in Python", OKABE_ITO[0], ":"),
    "IKPy": ("IKPy", OKABE_ITO[6], ":"),
}


def draw() -> None:
    arms = json.loads(FILE.read_text())["arms"]
    figure, axes = plt.subplots(1, len(ARMS), figsize=(10, 4), sharex=True, sharey=True, layout="constrained")
    handles = {}
    for axis, (arm, title) in zip(axes, ARMS.items()):
        for name, (label, colour, dashes) in SHOWN.items():
            if name in arms[arm]:
                curve = arms[arm][name]
                times, share = curve["percentiles"], curve["solved"] * np.arange(101)
                width = 2.5 if name == "fpbm_cpp" else 1.3
                (handles[label],) = axis.plot(times, share, color=colour, ls=dashes, lw=width)
        axis.set(title=title, xlabel="time of a call", xscale="log", ylim=(0, 101))
        axis.set_xticks(list(TICKS), list(TICKS.values()))
        axis.spines[["top", "right"]].set_visible(False)
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("problems solved [%]")
    order = [label for label, _, _ in SHOWN.values() if label in handles]
    figure.legend([handles[label] for label in order], order, loc="outside right center", frameon=False)
    figure.savefig(FILE.with_suffix(".png"), dpi=100)
    plt.close(figure)


if __name__ == "__main__":
    draw()
