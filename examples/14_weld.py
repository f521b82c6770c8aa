"""A UR5e welds along a circle: the torch points down, and its rotation about its axis is free."""

import numpy as np

import fpbm_cpp as fp

arm = fp.SerialArm.preset("ur5e")
q0 = np.array([0.0, -1.2, 1.8, -2.2, -1.5, 0.3])  # [rad]
torch = [
    fp.PositionTask("tip", name="seam", k1=20, k2=100),
    fp.AxisTask("tip", name="torch", k1=20, k2=100),
]
stack = fp.Stack(torch, fp.PostureTask(q0, k1=4, k2=4))  # Position and axis on one level (5 rows), then the posture.
tracker = fp.Tracker(arm, fp.Balanced(0.6, np.ones(6), null_damping=2), q0, stack=stack)

for _ in range(3000):
    tracker.tick({"torch": [0, 0, -1]})
turned = np.linalg.norm(tracker.tip["torch"] - [0, 0, -1])

seam = tracker.follow(fp.Circle(0.1, 8.0).in_plane("xy"), task="seam")
start, error, spin = tracker.frame("torch"), 0.0, 0.0
while not seam.done:
    tick = tracker.tick({"seam": seam})
    error = max(error, np.linalg.norm(tick.errors["seam"]), np.linalg.norm(tick.errors["torch"]))
    spin = max(spin, np.arccos(np.clip(start[:3, 0] @ tracker.frame("torch")[:3, 0], -1, 1)))
print(f"torch {turned:.0e} from straight down before the seam; ", end="")
print(f"errors at most {error:.0e} m and rad along the seam; the torch turns by {spin:.2f} rad: {tick.status.name}")
