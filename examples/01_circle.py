"""The paper's robot follows the paper's circle (Fig. 2): four unit links, FPBM, α = 0.6, W = diag(1, 2, 3, 4)."""

from math import pi

import fpbm_cpp as fp

arm = fp.PlanarArm([1.0, 1.0, 1.0, 1.0])  # lengths [m]
# As in the paper, without null_damping: the joints still move at the end. Other examples have null_damping.
scheme = fp.FPBM(0.6, [1.0, 2.0, 3.0, 4.0], 1.0, 1.0)  # alpha, the diagonal of W, k1, k2
path = fp.Circle(0.45, 10.0)  # radius [m], duration [s]
q0 = [pi / 12, pi / 12, pi / 15, pi / 15]

run = fp.simulate(arm, path, scheme, q0, dt=1e-3)

print("final joint velocities [rad/s]:", *(f"{velocity:.6f}" for velocity in run.qd[-1]))
print(f"largest tip error [m]: {abs(run.error).max():.1e}")
