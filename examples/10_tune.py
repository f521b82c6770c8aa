"""Tuning of alpha, W and damping of FPBM: for the paper's robot on its three paths, and for a Panda."""

import numpy as np

import fpbm_cpp as fp

# The paper's robot, start and paths. The baseline of tune() is the paper's alpha = 0.6 and W = diag(1, 2, 3, 4).
arm = fp.PlanarArm([1, 1, 1, 1])
q0 = np.pi / np.array([12, 12, 15, 15])  # [rad]
paths = {"circle": fp.Circle(0.45, 10.0), "Lissajous": fp.Lissajous(0.4, 10.0), "tricuspid": fp.Tricuspid(0.3, 10.0)}

row = "{:10} {:18} {:>8} {:>8} {:>6}   {:>5}  {:>22}  {:>7}".format
print(row("path", "tuned for", "paper", "tuned", "less", "alpha", "W", "damping"))
for name, path in paths.items():
    for objective in ("peak_velocity", "peak_acceleration"):
        tuning = fp.tune(arm, path, q0, objective, dt=0.01, trials=600)
        before, after, less = f"{tuning.baseline_value:.4f}", f"{tuning.value:.4f}", f"{tuning.improvement:.1%}"
        alpha, W, damping = (tuning.parameters[key] for key in ("alpha", "weights", "null_damping"))
        chosen = f"{alpha:.2f}", ", ".join(f"{w:.2f}" for w in W), f"{damping:.2f}"
        print(row(name, objective, before, after, less, *chosen))
        if (name, objective) == ("tricuspid", "peak_velocity"):
            tuning.plot().savefig("tuning.png")

# A Panda draws a circle, with four degrees of redundancy if the orientation is free, and one degree if the orientation
# is constant.
panda = fp.SerialArm.preset("panda")
ready = np.array([0, -0.3, 0, -2.2, 0, 2.0, 0.785])  # [rad]
circle = fp.Circle(0.15, 4.0).in_plane("yz")
first = fp.FPBM(0.6, np.ones(7), k1=10, k2=25, null_damping=2)
for task in ("position", "pose"):
    tuning = fp.tune(panda, circle, ready, dt=0.01, hold=1.0, task=task, baseline=first, trials=300)
    print(f"\n{task}: {tuning}")
