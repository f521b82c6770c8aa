"""The upper body of a humanoid, a Unitree G1 of 17 joints, reaches forward, lifts and turns with both hands.

Both hands are on the first level. The waist bends as far as the targets require. With the centre of mass of the robot
on the second level, the arms move more and the waist less. The URDF file is from the package example-robot-data.
"""

import sys
from importlib import metadata

import numpy as np

import fpbm_cpp as fp

try:
    ROBOTS = metadata.distribution("example-robot-data").locate_file("cmeel.prefix/share/example-robot-data/robots")
except metadata.PackageNotFoundError:
    sys.exit("this example needs a URDF file of example-robot-data: pip install example-robot-data")

HANDS = {"left": 1, "right": -1}  # Signs of the y coordinates of the hands.
LINKS = {hand: f"{hand}_wrist_yaw_link" for hand in HANDS}
PLACES = {"forward": (0.3, 0.05, 0), "lifted": (0.3, 0.2, 0), "turned": (0.3, 0.2, 0.6)}  # x, z [m], yaw [rad]
HALF = 0.16  # Half of the distance between the hands [m].

robot = fp.Robot.from_urdf(
    f"{ROBOTS}/g1_description/urdf/g1_29dof_rev_1_0.urdf", base="fixed", tips=LINKS.values()
)  # The legs are fixed.
limits = fp.JointLimits(
    lower=robot.limits.lower,
    upper=robot.limits.upper,
    velocity=np.full(robot.dof, 3.0),  # [rad/s]
    acceleration=np.full(robot.dof, 20.0),  # [rad/s²]; the URDF file has no bounds on acceleration.
)
q0 = np.zeros(robot.dof)
waist = [robot.joint_names.index(f"waist_{axis}_joint") for axis in ("yaw", "roll", "pitch")]


def goals(x: float, z: float, yaw: float) -> dict[str, np.ndarray]:
    """Poses of both hands at a place in front of the pelvis, rotated about the vertical axis."""
    c, s = np.cos(yaw), np.sin(yaw)
    turned = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    poses = {}
    for hand, side in HANDS.items():
        at = np.eye(4)
        at[:3, 3] = x, side * HALF, z
        poses[hand] = turned @ at
    return poses


def reach(*levels: fp.CenterOfMassTask) -> list[np.ndarray]:
    """Print errors, waist and centre of mass at each place. Return the joint positions at each tick."""
    hands = [fp.PoseTask(LINKS[hand], name=hand, k1=20, k2=100) for hand in HANDS]
    stack = fp.Stack(hands, *levels, fp.PostureTask(q0, k1=4, k2=4))
    tracker = fp.Tracker(robot, fp.Balanced(0, np.ones(robot.dof), null_damping=2), q0, stack=stack, limits=limits)
    q = [tracker.q]
    for place, at in PLACES.items():
        for _ in range(3000):  # three seconds
            tick = tracker.tick(goals(*at))
            q.append(tick.q)
        off = max(np.linalg.norm(tick.errors[hand]) for hand in HANDS)
        moved = np.linalg.norm((robot.center_of_mass(tick.q) - robot.center_of_mass(q0))[:2])
        angles = ", ".join(f"{angle:5.2f}" for angle in tick.q[waist] + 0.0)
        print(f"  {place:8} hands off by {off:.0e} m and rad; waist {angles} rad; centre of mass {moved:.3f} m away")
    return q


if __name__ == "__main__":
    print("hands, posture:")
    reach()
    print("hands, centre of mass, posture:")
    reach(fp.CenterOfMassTask(rows=("x", "y")))
