"""A Panda carries a cup. The levels are: cup upright, position of the tip, height of the elbow, posture.

Joint limits slow the lower levels, and the cup stays upright.
"""

import numpy as np

import fpbm_cpp as fp

arm = fp.SerialArm.preset("panda")
q0 = [0, -0.3, 0, -2.2, 0, 2, 0.785]  # [rad]
stack = fp.Stack(
    fp.AxisTask("tip", name="upright"),
    fp.PositionTask("tip", name="place"),
    fp.PositionTask("panda_joint4", rows=("z",), name="elbow"),
    fp.PostureTask(q0, k1=4, k2=4),
)
tracker = fp.Tracker(arm, fp.Balanced(0.6, np.ones(7), null_damping=2), q0, stack=stack)  # 1 kHz

goal = tracker.tip["place"] + [0.2, 0.3, -0.1]  # [m]
tilt, slowed = 0.0, 0
for _ in range(8000):
    tick = tracker.tick({"place": goal})  # The other tasks keep their targets.
    tilt = max(tilt, np.linalg.norm(tick.errors["upright"]))
    slowed += min(tick.scales[1:]) < 1
off = {name: np.linalg.norm(error) for name, error in tick.errors.items()}
print(f"tilt at most {tilt:.0e} rad; a lower level slowed in {slowed} ticks; ", end="")
print(f"place off by {off['place']:.0e} m, elbow by {off['elbow']:.3f} m")
