"""The reference of a Panda passes through a post and into a table: motions without and with collision avoidance."""

import numpy as np

import fpbm_cpp as fp

around = [
    fp.HalfSpace([0, 0, 1], 0.2, name="table"),  # normal, offset [m]
    fp.Capsule(0, [0.6, 0, 0], [0.6, 0, 0.5], 0.05, "post"),  # ends, radius [m]
]
clearance = fp.Clearance.preset("panda", obstacles=around, margin=0.01)

arm = fp.SerialArm.preset("panda")
q0 = [0, -0.7854, 0, -2.3562, 0, 1.5708, 0.7854]  # [rad]
scheme = fp.FPBM(0.6, np.ones(7), k1=10, k2=25, null_damping=2)
line = fp.Line([0.3, 0.2, -0.4], 2.0)  # displacement [m], duration [s]

for name, kept in {"no clearance": [], "kept clear": [clearance]}.items():
    run = fp.track(arm, line, scheme, q0, bounds=kept, hold=1.0)
    nearest = min(clearance.nearest(arm, q).distance for q in run.q)
    error = np.linalg.norm(run.error[-1])
    print(f"{name}: nearest {nearest:.3f} m, at the end {error:.3f} m from the target: {run.status.code.name}")
