"""A Panda draws a circle twice with a constant orientation, then holds the tip: four schemes in one figure."""

from math import pi

import numpy as np

import fpbm_cpp as fp
from fpbm_cpp.plot import compare

arm = fp.SerialArm.preset("panda")
ready = np.array([0, -pi / 4, 0, -3 * pi / 4, 0, pi / 2, pi / 4])  # [rad], the hand points down
circle = fp.Circle(0.12, 3.0, time_law="quintic").in_plane("xy")  # radius [m], duration [s]
weights = [8, 8, 4, 4, 2, 1, 1]  # larger near the base, where joints carry more

schemes = {
    "MVN": fp.MVN(),
    "WMVN": fp.WMVN(weights),
    "MAN": fp.MAN(),
    "FPBM": fp.FPBM(0.6, weights, k1=20, k2=100, null_damping=4, rest_posture=ready, null_stiffness=4),
}
runs = {
    name: fp.simulate(arm, circle.then(circle), scheme, ready, hold=4.0, task="pose")
    for name, scheme in schemes.items()
}

# The task determines six of the seven degrees of freedom, so all peaks are similar, and only the motion of the elbow
# differs. With MVN and WMVN, the posture changes from circle to circle. With MAN, the elbow still moves when the tip is
# at rest, and the tip error grows. With FPBM, the tip error decays, and the arm stops in its start posture.
print("        peak    peak     final   tip error      least    from first")
print("        rad/s   rad/s²   rad/s   m      rad     manip.  posture, rad")
for name, run in runs.items():
    speed, acceleration, distance = (np.linalg.norm(rows, axis=1) for rows in (run.qd, run.qdd, run.q - ready))
    least = run.manipulability().min()
    print(
        f"{name:6} {speed.max():6.3f} {acceleration.max():8.3f} {speed[-1]:8.4f}"
        f"   {run.max_error():.0e}  {run.max_orientation_error():.0e} {least:8.4f} {distance[-1]:8.4f}"
    )

figure = compare(runs, "A Panda draws a horizontal circle twice in 6 s with its hand held level, then stands still")
figure.savefig("panda_circle.png")
