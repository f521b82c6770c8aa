"""A Panda carries an upright cup to a target and back. A wall bounds the elbow, and the tip has at most 0.5 m/s."""

import numpy as np

import fpbm_cpp as fp

arm = fp.SerialArm.preset("panda")
q0 = [0, -0.3, 0, -2.2, 0, 2, 0.785]  # [rad]
stack = fp.Stack(fp.AxisTask(name="upright"), fp.PositionTask(name="place"), fp.PostureTask(q0, k1=4, k2=4))
bounds = (
    fp.TaskBounds(fp.PositionTask("panda_joint4", rows=("y",)), upper=0.04, deceleration=1),  # [m], [m/s^2]
    fp.TaskBounds(fp.PositionTask(), velocity=0.5),  # [m/s]
)
tracker = fp.Tracker(arm, fp.Balanced(0.6, np.ones(7), null_damping=2), q0, stack=stack, bounds=bounds)  # 1 kHz

start = tracker.tip["place"]
goals = [start + np.array([0.05, 0.35, 0.1]), start]  # [m]
tilt, blocked = 0.0, 0
for i in range(12000):
    tick = tracker.tick({"place": goals[i // 6000]})  # The other tasks keep their targets.
    tilt = max(tilt, np.linalg.norm(tick.errors["upright"]))
    blocked += min(tick.scales) < 1
    if i == 5999:
        off = np.linalg.norm(tick.errors["place"])
print(
    f"tilt at most {tilt:.0e} rad; levels slowed in {blocked} ticks; place off by {off:.2f} m behind the wall, ", end=""
)
print(f"by {np.linalg.norm(tick.errors['place']):.0e} m after the return")
