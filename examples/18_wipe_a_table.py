"""A Panda on a mobile base wipes a table: the tip follows 3 m of strokes, and points down.

Velocity and acceleration of the base are bounded. The weights of the scheme determine how much the base moves: a joint
with a larger weight moves less. The URDF file is from the package example-robot-data.
"""

import sys
from importlib import metadata

import numpy as np

import fpbm_cpp as fp

try:
    ROBOTS = metadata.distribution("example-robot-data").locate_file("cmeel.prefix/share/example-robot-data/robots")
except metadata.PackageNotFoundError:
    sys.exit("this example needs a URDF file of example-robot-data: pip install example-robot-data")

robot = fp.Robot.from_urdf(f"{ROBOTS}/panda_description/urdf/panda.urdf", base="planar", tips=["panda_link8"])
arm = fp.SerialArm.preset("panda").limits
BASE = {"lower": [-np.inf] * 3, "upper": [np.inf] * 3, "velocity": [0.2, 0.2, 0.5], "acceleration": [0.3, 0.3, 0.6]}
limits = fp.JointLimits(**{bound: np.append(base, getattr(arm, bound)) for bound, base in BASE.items()})
q0 = np.array([0, 0, 0, 0, -0.3, 0, -2.2, 0, 2, 0.785])  # x, y [m], yaw, joints [rad]

there, back, on = fp.Line([0.35, 0, 0], 1.5), fp.Line([-0.35, 0, 0], 1.5), fp.Line([0, 0.15, 0], 1.2)  # [m], [s]
lap = there.then(on).then(back).then(on)
strokes = lap.then(lap).then(lap)
stack = fp.Stack(
    [
        fp.PositionTask("panda_link8", name="wipe", k1=40, k2=400),
        fp.AxisTask("panda_link8", x=[0, 0, -1], name="down", k1=40, k2=400),
    ]
)


def wipe(weight: float) -> tuple[np.ndarray, float, float]:
    """Joint positions at each tick, the largest error [m] and the largest tilt [rad] of the tip."""
    scheme = fp.Balanced(1, np.append(np.full(3, weight), np.ones(7)), null_damping=2)
    tracker = fp.Tracker(robot, scheme, q0, stack=stack, limits=limits)  # 1 kHz
    for _ in range(1500):  # Until the tip points down.
        tracker.tick({})
    path, q, error, tilt = tracker.follow(strokes, task="wipe"), [tracker.q], 0.0, 0.0
    while not path.done:
        tick = tracker.tick({"wipe": path})
        q.append(tick.q)
        error = max(error, np.linalg.norm(tick.errors["wipe"]))
        tilt = max(tilt, np.linalg.norm(tick.errors["down"]))
    return np.array(q), error, tilt


if __name__ == "__main__":
    for name, weight in {"light base": 0.05, "heavy base": 60.0}.items():
        q, error, tilt = wipe(weight)
        qd = 1e3 * np.diff(q, axis=0)
        qdd = 1e3 * np.diff(qd, axis=0)
        travel = np.linalg.norm(np.diff(q[:, :2], axis=0), axis=1).sum()
        print(
            f"{name}: tip off by at most {error:.0e} m, tilt {tilt:.0e} rad over 3 m; base travels {travel:.2f} m, ",
            end="",
        )
        print(f"at most {abs(qd[:, :2]).max():.3f} m/s and {abs(qdd[:, :2]).max():.3f} m/s^2 along an axis")
