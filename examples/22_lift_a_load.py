"""A Panda lifts 3 kg from the floor and carries the load past its base, at the edge of its torques."""

import numpy as np

import fpbm_cpp as fp

arm = fp.SerialArm.preset("panda").with_payload(3.0, com=(0, 0, 0.15))  # 3 kg, 0.15 m in front of the flange
q0 = [-0.319, 0.894, -0.141, -1.463, 0.154, 2.345, -0.516]  # [rad], far from the base, and the tool points down
lift = fp.Polyline([[0, 0, 0], [0, 0, 0.3], [0, 0.6, 0.3]], blend=0.1)  # [m]
scheme = fp.FPBM(0.6, np.ones(7), k1=40, k2=400, null_damping=10)

for name, bounds in {
    "no bounds": [],
    "bounds": [fp.TorqueBounds()],
    "80 % of the bounds": [fp.TorqueBounds(fraction=0.8)],
}.items():
    tracker = fp.Tracker(arm, scheme, q0, task="pose", singular_radius=0, bounds=bounds)  # 1 kHz
    follower = tracker.follow(lift, keep_path=True)
    ticks, share, error = 0, 0.0, 0.0
    while not follower.done:
        tick = tracker.tick(follower)
        ticks += 1
        share = max(share, np.max(abs(tick.torque) / arm.limits.effort))
        error = max(error, np.linalg.norm(tick.error[:3]))
    print(f"{name}: {ticks / 1000:.3f} s, largest torque {share:.3f} of the effort, {error:.0e} m from the path")
