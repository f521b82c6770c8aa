"""A Panda whose target jumps, with and without bounds J = 50 A on jerk: draws jerk.png and prints its numbers.

    python docs/figures/jerk.py [where to write the picture]

Accelerations and jerks are differences of the commanded positions, as a robot's controller computes them.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import fpbm_cpp as fp
from fpbm_cpp.plot import LIGHT, OKABE_ITO

DT = 1e-3  # [s]
EVERY = 1.5  # [s]
BOUNDS = {"velocity": 0.5, "acceleration": 1.5, "jerk": 15.0}
BOUNDS |= {f"angular_{name}": bound for name, bound in BOUNDS.items()}
READY = np.array([0.0, -0.3, 0.0, -2.0, 0.0, 1.8, 0.8])
JUMPS = np.array([[0.15, 0.0, 0.0], [0.0, 0.2, -0.1], [-0.15, -0.2, 0.1]])  # [m]
PANDA = fp.SerialArm.preset("panda")
GENTLE = 50.0 * PANDA.limits.acceleration  # [rad/s³], a tenth of the manufacturer's bound


def run(jerk: np.ndarray, filtered: bool) -> np.ndarray:
    """Joint positions, tick by tick."""
    limits = replace(PANDA.limits, jerk=jerk)
    scheme = fp.FPBM(0.6, np.ones(7), k1=20, k2=100, null_damping=2)
    tracker = fp.Tracker(PANDA, scheme, READY, dt=DT, task="pose", limits=limits)
    start = PANDA.forward(READY)
    targets = fp.TargetFilter(start, dt=DT, timeout=0.1, **BOUNDS)
    rows = [READY]
    for jump in np.cumsum(JUMPS, axis=0):
        target = start.copy()
        target[:3, 3] += jump
        targets.push(target)
        rows += [(tracker.tick(targets) if filtered else tracker.tick(target)).q for _ in range(round(EVERY / DT))]
    return np.array(rows)


def off_line(p: np.ndarray) -> float:
    """Largest distance of the tip from the lines between the targets [m]."""
    steps = round(EVERY / DT)
    start = PANDA.forward(READY)[:3, 3]
    worst = 0.0
    for i, (jump, end) in enumerate(zip(JUMPS, np.cumsum(JUMPS, axis=0), strict=True)):
        displacement = p[i * steps : (i + 1) * steps] - (start + end - jump)
        along = np.outer(displacement @ jump, jump) / (jump @ jump)
        worst = max(worst, float(np.linalg.norm(displacement - along, axis=1).max()))
    return worst


def settled(p: np.ndarray) -> float:
    """Longest time from a jump until the tip stays within 1 mm of its target [s]."""
    steps = round(EVERY / DT)
    goals = PANDA.forward(READY)[:3, 3] + np.cumsum(JUMPS, axis=0)
    parts = [np.linalg.norm(p[1 + i * steps : 1 + (i + 1) * steps] - goal, axis=1) for i, goal in enumerate(goals)]
    return float(max(np.flatnonzero(part > 1e-3)[-1] + 1 for part in parts)) * DT


def main() -> None:
    out = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent / "jerk.png")
    treatments = {
        "no bounds on jerk": run(np.full(7, np.inf), False),
        "bounds on jerk": run(GENTLE, False),
        "bounds on jerk, target filtered": run(GENTLE, True),
    }
    figure, axes = plt.subplots(3, 3, figsize=(11, 6.5), sharex=True, sharey="row", layout="constrained")
    print(f"{'':34}{'acceleration':>14}{'jerk':>10}{'off the line':>14}{'within 1 mm':>14}")
    for column, (name, q) in enumerate(treatments.items()):
        t = np.arange(len(q)) * DT
        at_rest = np.vstack([READY, READY, q])
        p = np.array([PANDA.forward(row)[:3, 3] for row in q])
        acceleration = np.abs(np.diff(at_rest[1:], 2, axis=0) / DT**2 / PANDA.limits.acceleration).max(axis=1)
        jerk = np.abs(np.diff(at_rest, 3, axis=0) / DT**3 / GENTLE).max(axis=1)
        print(
            f"{name:34}{acceleration.max():>12.3f} A{jerk.max():>8.3f} J"
            f"{1e3 * off_line(p):>11.2f} mm{settled(p):>12.2f} s"
        )
        for each, axis_name, (colour, dash) in zip((p - p[0]).T, "xyz", LIGHT.styles()):
            axes[0, column].plot(t, each, color=colour, ls=dash, label=axis_name)
        axes[1, column].plot(t[1:], acceleration, color=OKABE_ITO[0], lw=1.0)
        axes[2, column].plot(t[1:], jerk, color=OKABE_ITO[0], lw=1.0)
        axes[0, column].set_title(name)
        axes[2, column].set(yscale="log", ylim=(1e-3, 20), xlabel="time [s]")
        for axis in axes[1:, column]:
            axis.axhline(1.0, color="black", linewidth=0.8, linestyle="--", label="bound")
    for axis, label in zip(axes[:, 0], ("tip [m]", "largest |q̈| / A", "largest jerk / J"), strict=True):
        axis.set_ylabel(label)
    axes[0, 0].set_ylim(bottom=-0.17)  # For the legend below the curves.
    axes[0, 0].legend(loc="lower left", frameon=False, ncols=3)
    axes[1, 1].legend(loc="upper right", bbox_to_anchor=(1.0, 0.97), frameon=False)
    for axis in axes.flat:
        axis.spines[["top", "right"]].set_visible(False)
        axis.grid(alpha=0.3)
    figure.savefig(out, dpi=110)


if __name__ == "__main__":
    main()
