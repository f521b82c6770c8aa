"""Postures for targets: random poses, all branches of a UR5e, and a Panda at a table."""

import numpy as np

import fpbm_cpp as fp

rng = np.random.default_rng(0)
panda = fp.SerialArm.preset("panda")
lower, upper = panda.limits.lower, panda.limits.upper  # [rad]
targets = np.array([panda.forward(rng.uniform(lower, upper)) for _ in range(1000)])
found = panda.inverse(targets, rng.uniform(lower, upper, (1000, 7)), starts=256)
print(f"{found.solved.sum()} of 1000 poses reached, largest error {found.error.max():.0e} m or rad")

ur5e = fp.SerialArm.preset("ur5e")
q = [0.3, -1.1, 1.4, -0.9, 1.2, 0.4]
print(f"{len(ur5e.inverse_all(ur5e.forward(q), q))} branches of a UR5e")

table = fp.HalfSpace([0, 0, 1], 0.0, name="table")
clearance = fp.Clearance.preset("panda", obstacles=[table])
inverse = fp.InverseKinematics(panda, bounds=[clearance])
target = np.array([[1, 0, 0, 0.5], [0, -1, 0, 0.2], [0, 0, -1, 0.15], [0, 0, 0, 1]])  # The flange points down.
posture = inverse.solve(target)
print(f"above the table: {posture.status.name}, least distance {clearance.nearest(panda, posture.q).distance:.3f} m")
target[2, 3] = -0.1
below = inverse.solve(target)
print(f"below the table: {below.status.name}, {below.error:.2f} m or rad away, after {below.starts} starts")
