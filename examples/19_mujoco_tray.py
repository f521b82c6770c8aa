"""Two Pandas in MuJoCo carry a tray along a circle: the motion of 16_carry_a_tray by computed torque.

Every millisecond, the tracker computes positions, velocities and accelerations of the joints. The torques are

    tau = M(q) (qdd_r + K_d (qd_r - qd) + K_p (q_r - q)) + h(q, qd).

In the controller's model, every mass and inertia is 2 % too large, and there is no friction. The simulation has no
contact between hands and tray: the error of the relative pose is the displacement that a grasp must tolerate.
"""

from __future__ import annotations

import sys

import numpy as np
from panda_mjcf import panda, panda_mjcf

import fpbm_cpp as fp

try:
    import mujoco
except ModuleNotFoundError:
    sys.exit("this example needs MuJoCo: pip install mujoco")

START = np.array([0.3, -0.6, 0, -2.4, 0, 1.8, 0.785, -0.3, -0.6, 0, -2.4, 0, 1.8, 0.785])  # [rad]
STIFFNESS, DAMPING = 1e4, 200.0  # K_p [1/s²], K_d [1/s]
DT = 1e-3  # A tick of the controller [s].
STEPS = 4  # Simulation steps per tick.


def beside(y: float) -> np.ndarray:
    """Pose of a base at this distance [m] from the middle."""
    pose = np.eye(4)
    pose[1, 3] = y
    return pose


PLACEMENTS = {"right": beside(-0.4), "left": beside(0.4)}
ROBOT = fp.Robot.from_arms(dict.fromkeys(PLACEMENTS, panda(inertia_error=0.02)), PLACEMENTS)


def relative_error(data: mujoco.MjData, grasp: np.ndarray) -> tuple[float, float]:
    """Distance [m] and angle [rad] of the left hand from its pose in the grasp."""
    poses = []
    for hand in PLACEMENTS:
        site = data.site(f"{hand}_tip")
        poses.append(np.vstack([np.column_stack([site.xmat.reshape(3, 3), site.xpos]), [0, 0, 0, 1]]))
    off = np.linalg.inv(np.linalg.inv(poses[0]) @ poses[1]) @ grasp
    return float(np.linalg.norm(off[:3, 3])), float(np.arccos(np.clip((np.trace(off[:3, :3]) - 1) / 2, -1, 1)))


def simulate(duration: float = 6.0, hold: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Errors of the relative pose [m], [rad], and distances of the right hand from the path [m], at each tick."""
    stack = fp.Stack(
        fp.RelativePoseTask("left_tip", "right_tip", name="grasp", k1=500, k2=62_500),
        fp.PoseTask("right_tip", name="tray", k1=40, k2=400),
        fp.PostureTask(START, k1=4, k2=4),
    )
    tracker = fp.Tracker(ROBOT, fp.Balanced(0, np.ones(14), null_damping=2), START, stack=stack, dt=DT)
    circle = fp.Circle(0.1, duration).in_plane("yz")  # radius [m]
    path, origin = tracker.follow(circle, task="tray"), ROBOT.forward(START, "right_tip")[:3, 3]
    grasp = np.linalg.inv(ROBOT.forward(START, "right_tip")) @ ROBOT.forward(START, "left_tip")

    arms = mujoco.MjModel.from_xml_string(panda_mjcf(placements=PLACEMENTS, timestep=DT / STEPS))
    world = mujoco.MjData(arms)
    world.qpos[:] = START
    relative, tracking = [], []
    for t in DT * np.arange(1, round((duration + hold) / DT) + 1):
        tick = tracker.tick({"tray": path})
        qdd = tick.qdd + DAMPING * (tick.qd - world.qvel) + STIFFNESS * (tick.q - world.qpos)
        world.ctrl[:] = ROBOT.inverse_dynamics(world.qpos, world.qvel, qdd)  # MuJoCo limits the torques.
        mujoco.mj_step(arms, world, STEPS)
        mujoco.mj_kinematics(arms, world)
        relative.append(relative_error(world, grasp))
        tracking.append(np.linalg.norm(world.site("right_tip").xpos - origin - circle.sample(min(t, duration))[0]))
    return np.array(relative), np.array(tracking)


if __name__ == "__main__":
    relative, tracking = simulate()
    rms = np.sqrt(np.mean(relative**2, axis=0))
    print(f"relative pose of the hands off by {1e3 * rms[0]:.2f} mm and {1e3 * rms[1]:.2f} mrad rms, ", end="")
    print(f"at most {1e3 * relative[:, 0].max():.2f} mm; tray off its path by {1e3 * tracking.max():.2f} mm at most")
