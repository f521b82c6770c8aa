"""Two Pandas carry a tray along a circle. The levels are: grasp, pose of the tray, posture.

At the end, the target of the tray jumps. The joint limits slow the tray, and the grasp holds.
"""

import numpy as np

import fpbm_cpp as fp

robot = fp.Robot.preset("two_pandas")
right, left = [0.3, -0.6, 0, -2.4, 0, 1.8, 0.785], [-0.3, -0.6, 0, -2.4, 0, 1.8, 0.785]
q0 = np.array(right + left)  # [rad]
stack = fp.Stack(
    fp.RelativePoseTask("left_tip", "right_tip", name="grasp", k1=500, k2=62_500),
    fp.PoseTask("right_tip", name="tray", k1=40, k2=400),
    fp.PostureTask(q0, k1=4, k2=4),
)
tracker = fp.Tracker(robot, fp.Balanced(0, np.ones(14), null_damping=2), q0, stack=stack)  # 1 kHz

path = tracker.follow(fp.Circle(0.1, 6.0).in_plane("yz"), task="tray")  # radius [m], duration [s]
grasp, tray, travel = 0.0, 0.0, np.zeros(14)
while not path.done:
    tick = tracker.tick({"tray": path})
    grasp = max(grasp, np.linalg.norm(tick.errors["grasp"]))
    tray = max(tray, np.linalg.norm(tick.errors["tray"]))
    travel = np.maximum(travel, abs(tick.q - q0))
print(f"circle: grasp off by at most {grasp:.0e} m and rad, tray by {tray:.0e}; ", end="")
print(f"joints travel by {travel[:7].max():.2f} rad (right) and {travel[7:].max():.2f} rad (left)")

goal = tracker.tip["tray"].copy()
goal[:3, 3] += [0.05, -0.1, 0.15]  # [m]
grasp, slowed = 0.0, 0
for _ in range(3000):
    tick = tracker.tick({"tray": goal})
    grasp = max(grasp, np.linalg.norm(tick.errors["grasp"]))
    slowed += tick.scales[1] < 1
print(f"jump: the tray slowed in {slowed} ticks, off by {np.linalg.norm(tick.errors['tray']):.0e} at the end; ", end="")
print(f"grasp off by at most {grasp:.0e}")
