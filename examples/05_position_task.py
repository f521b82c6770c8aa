"""A Kinova Gen3 draws a Lissajous figure with a free orientation of the tip, and returns to its start posture."""

from math import pi

import numpy as np

import fpbm_cpp as fp
from fpbm_cpp.plot import plot_run

arm = fp.SerialArm.preset("gen3")
home = np.array([0, 0.26, pi, -2.27, 0, 0.96, pi / 2])  # [rad]
path = fp.Lissajous((0.15, 0.1), 8.0, frequencies=(1, 2), phase=0.0, time_law="quintic").in_plane("yz")  # [m], [s]

# The task determines three of the seven degrees of freedom. Without a secondary motion, the arm ends in another
# posture, and the joints still move when the tip is at rest.
schemes = {
    "no secondary motion": fp.FPBM(0.6, np.ones(7), k1=20, k2=100),
    "rest posture": fp.FPBM(0.6, np.ones(7), k1=20, k2=100, null_damping=4, rest_posture=home, null_stiffness=4),
}
for name, scheme in schemes.items():
    run = fp.simulate(arm, path, scheme, home, hold=4.0)
    print(
        f"{name}: tip error {run.max_error():.0e} m; fastest joint {abs(run.qd).max():.3f} rad/s,"
        f" at the end {abs(run.qd[-1]).max():.0e} rad/s and {abs(run.q[-1] - home).max():.0e} rad from home"
    )

plot_run(run, "A Kinova Gen3 draws a Lissajous figure, with a rest posture").savefig("gen3_lissajous.png")
