"""A Panda on a circle from eleven start postures: MAN (alpha = 0) to WMVN (alpha = 1), undamped and damped."""

import numpy as np

import fpbm_cpp as fp

arm = fp.SerialArm.preset("panda")
path = fp.Circle(0.15, 4.0).in_plane("yz")  # [m], [s]
cases = [(damping, alpha) for damping in (0.0, 2.0) for alpha in (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)]
schemes = [fp.FPBM(alpha, np.ones(7), k1=10, k2=25, null_damping=damping) for damping, alpha in cases]
starts = np.tile([0, -0.3, 0, -2.2, 0, 2.0, 0.785], (11, 1))  # [rad]
starts[:, 2] = np.linspace(-0.5, 0.5, 11)

# Twelve schemes from eleven starts, on all cores. Each row shows the worst values over the starts of a scheme.
sweep = fp.sweep(arm, path, schemes, starts, hold=1.0, task="pose")
print("damping  alpha  complete  error [m]  peak qd [rad/s]  final qd [rad/s]  manipulability")
for i, (damping, alpha) in enumerate(cases):
    complete, error, peak = sweep.ok[i].sum(), sweep.max_error[i].max(), sweep.peak_velocity[i].max()
    final, least = sweep.final_velocity[i].max(), sweep.manipulability[i].min()
    print(f"{damping:7.1f}  {alpha:5.1f}  {complete:8d}  {error:9.0e}  {peak:15.3f}  {final:16.4f}  {least:14.4f}")
