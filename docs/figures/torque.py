"""Least torque on the paper's robot and on a Panda: draws torque.png and prints its numbers.

    python docs/figures/torque.py [where to write the picture]

The paper's robot has uniform links of 1 kg and moves in a horizontal plane. The Panda has the inertias of its preset.
Its flange follows a circle: its position, and then its pose. Motions are simulated without limits. A motion stops if
the joints move too fast for the step of 1 ms.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import fpbm_cpp as fp
from fpbm_cpp.plot import OKABE_ITO

CIRCLES = 10  # Length of the long motions.


@dataclass
class Robot:
    """An arm, its circle, and the schemes of the figure."""

    title: str
    arm: fp.PlanarArm | fp.SerialArm
    q0: list[float]
    path: fp.Path
    schemes: dict[str, fp.Scheme]
    task: str = "position"

    def run(self, scheme: fp.Scheme, circles: int = 1) -> tuple[fp.Run, np.ndarray]:
        """A motion, and the torques of its joints [Nm]."""
        path = self.path
        for _ in range(circles - 1):
            path = path.then(self.path)
        run = fp.simulate(self.arm, path, scheme, self.q0, task=self.task, partial=True)
        return run, self.arm.inverse_dynamics(run.q, run.qd, run.qdd)


def least_torque(damping: float, alpha: float = 0.0, k1: float = 1.0, k2: float = 1.0) -> fp.Scheme:
    return fp.MinimumTorque(alpha=alpha, k1=k1, k2=k2, null_damping=damping)


def paper() -> Robot:
    arm = fp.PlanarArm([1, 1, 1, 1], masses=[1, 1, 1, 1])
    schemes = {f"least torque, kₙ = {kn}": least_torque(kn) for kn in (0, 1, 2, 5, 10)}
    schemes |= {f"balance, α = 0.6, kₙ = {kn}": least_torque(kn, 0.6) for kn in (0, 2)}
    schemes |= {"least energy": fp.MinimumEnergy(k=1), "FPBM, kₙ = 2": fp.FPBM(0.6, [1, 2, 3, 4], 1, 1, null_damping=2)}
    q0 = [np.pi / 12, np.pi / 12, np.pi / 15, np.pi / 15]
    return Robot("The paper's robot, circle of 0.45 m in 10 s", arm, q0, fp.Circle(0.45, 10.0), schemes)


def panda(task: str) -> Robot:
    arm, weights = fp.SerialArm.preset("panda"), [8, 8, 4, 4, 2, 1, 1]
    schemes = {f"least torque, kₙ = {kn}": least_torque(kn, 0, 10, 25) for kn in (0, 2, 10, 50)}
    schemes |= {f"balance, α = 0.8, kₙ = {kn}": least_torque(kn, 0.8, 10, 25) for kn in (0, 10)}
    schemes |= {"least energy": fp.MinimumEnergy(k=5), "FPBM, kₙ = 2": fp.FPBM(0.6, weights, 10, 25, null_damping=2)}
    q0 = [0, -0.3, 0, -2.2, 0, 2, 0.785]
    path = fp.Circle(0.1, 5.0, time_law="quintic").in_plane("yz")
    return Robot(f"A Panda, {task}, circle of 0.1 m in 5 s", arm, q0, path, schemes, task)


SHOWN = {  # Least torque without and with damping, the balance, least energy, FPBM.
    "least torque, kₙ = 0": OKABE_ITO[5],
    "least torque, kₙ = 10": OKABE_ITO[0],
    "balance, α = 0.6, kₙ = 2": OKABE_ITO[2],
    "balance, α = 0.8, kₙ = 10": OKABE_ITO[2],
    "least energy": OKABE_ITO[4],
    "FPBM, kₙ = 2": "0.4",
}


def report(robot: Robot, axes: list[plt.Axes]) -> None:
    print(f"{robot.title}: peak q̇ [rad/s], peak τ [Nm], root mean square of |τ| [Nm]")
    print(f"  {'':26}{'one circle':>30}{f'{CIRCLES} circles':>36}")
    for name, scheme in robot.schemes.items():
        cells = []
        for circles in (1, CIRCLES):
            run, torque = robot.run(scheme, circles)
            stopped = "" if run.status else f", stops at {run.t[-1]:.2f} s"
            rms = np.sqrt(np.mean(np.sum(torque**2, axis=1)))
            cells.append(f"{np.abs(run.qd).max():8.2f}{np.abs(torque).max():8.1f}{rms:8.2f}{stopped:20}")
            if circles == 1 and name in SHOWN:
                for axis, value in zip(axes, (run.qd, torque)):
                    most = np.abs(value).max(axis=1)
                    axis.plot(run.t, most, label=name, color=SHOWN[name], lw=1.4)
                    if stopped:
                        axis.plot(run.t[-1], most[-1], "x", color=SHOWN[name], ms=7, mew=2)
        print(f"  {name:26}{''.join(cells)}".rstrip())


def main() -> None:
    out = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent / "torque.png")
    figure, axes = plt.subplots(2, 2, figsize=(10, 6), sharex="col", layout="constrained")
    for column, robot in enumerate((paper(), panda("position"))):
        report(robot, list(axes[:, column]))
        axes[0, column].set_title(robot.title, fontsize=10)
        axes[0, column].legend(fontsize=8)
        axes[1, column].set_xlabel("time [s]")
        for axis in axes[:, column]:
            axis.set_yscale("log")
            axis.grid(alpha=0.25, lw=0.5)
    axes[0, 0].set_ylabel("largest joint speed [rad/s]")
    axes[1, 0].set_ylabel("largest torque [Nm]")
    for axis in axes[0]:
        axis.set_ylim(0.02, 300)
    axes[1, 0].set_ylim(0.3, 1000)
    axes[1, 1].set_ylim(10, 300)
    figure.savefig(out, dpi=150)
    report(panda("pose"), [])


if __name__ == "__main__":
    main()
