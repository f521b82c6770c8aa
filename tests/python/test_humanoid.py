"""The upper body of a humanoid: targets of both hands, and the effect of a posture level on the motion of the hands."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import fpbm_cpp as fp
from fpbm_cpp._types import Array

cmeel = pytest.importorskip("cmeel")
URDF = (
    Path(cmeel.__file__).parents[1]
    / "cmeel.prefix/share/example-robot-data/robots/g1_description/urdf/g1_29dof_rev_1_0.urdf"
)
pytestmark = pytest.mark.skipif(not URDF.exists(), reason="needs example-robot-data")

HANDS = ("left", "right")
LINKS = {hand: f"{hand}_wrist_yaw_link" for hand in HANDS}
DOF = 17
TICK = 1e-3  # [s]

# Targets, allowed steps and tolerances of Isaac Lab's test of its controller by Pink: isaac-sim/IsaacLab, BSD-3-Clause,
# source/isaaclab/test/controllers/test_ik_configs/pink_ik_g1_test_configs.json. The left hand has position [m] and
# quaternion (w, x, y, z) in the world. The targets of the right hand are the mirror images. The robot's pelvis is at
# ROOT, a step takes 20 ms, and all joints start at zero.
ROOT = np.array([[0.0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0.75], [0, 0, 0, 1]])
STEP = 0.02  # [s]
STEPS_TO_SETTLE = 50
POSITION, ROTATION = 0.003, 0.017  # [m], [rad]
AHEAD = (0.7071, 0, 0, 0.7071)
TURNS = ((0.6946, 0.1325), (0.6533, 0.2706), (0.5848, 0.3975), (0.5, 0.5))
CASES = {  # Steps per motion, repeats, targets.
    "horizontal_movement": (15, 2, [(-0.18, 0.1, 0.8, *AHEAD), (-0.28, 0.1, 0.8, *AHEAD)]),
    "horizontal_small_movement": (15, 2, [(-0.18, 0.1, 0.8, *AHEAD), (-0.19, 0.1, 0.8, *AHEAD)]),
    "stay_still": (20, 4, [(-0.18, 0.1, 0.8, *AHEAD)] * 2),
    "vertical_movement": (30, 2, [(-0.18, 0.15, z, *AHEAD) for z in (0.8, 0.85, 0.9, 0.85)]),
    "forward_waist_bending_movement": (60, 2, [(-0.18, y, 0.8, *AHEAD) for y in (0.1, 0.2, 0.3)]),
    "rotation_movements": (
        25,
        2,
        [
            (-0.18, 0.1, 0.8, *AHEAD),
            *((-0.2, 0.11, 0.8, w, x, x, w) for w, x in TURNS),
            (-0.18, 0.1, 0.8, *AHEAD),
            *((-0.2, 0.11, 0.8, w, -x, -x, w) for w, x in TURNS),
        ],
    ),
}


@pytest.fixture(scope="module")
def robot() -> fp.Robot:
    return fp.Robot.from_urdf(URDF, base="fixed", tips=LINKS.values())


def targets(left: tuple[float, ...]) -> dict[str, Array]:
    """Poses of both hands in the pelvis."""
    x, y, z, *quaternion = left
    poses = {}
    for hand, side in zip(HANDS, (1, -1)):
        pose = np.eye(4)
        pose[:3, :3] = Rotation.from_quat(np.array(quaternion)[[1, 2, 3, 0]] * [side, side, 1, 1]).as_matrix()
        pose[:3, 3] = side * x, y, z
        poses[hand] = np.linalg.inv(ROOT) @ pose
    return poses


def both_hands(gains: dict[str, float]) -> list[fp.PoseTask]:
    return [fp.PoseTask(LINKS[hand], name=hand, **gains) for hand in HANDS]


def test_the_preset_equals_the_robot_of_its_file(robot: fp.Robot) -> None:
    preset = fp.Robot.preset("g1_upper_body")
    assert preset.joint_names == robot.joint_names
    for bound in ("lower", "upper", "velocity", "effort"):
        np.testing.assert_array_equal(getattr(preset.limits, bound), getattr(robot.limits, bound))
    assert preset.base_mass + sum(each.joint.mass for each in preset.joints) == pytest.approx(
        robot.base_mass + sum(each.joint.mass for each in robot.joints), abs=1e-5
    )
    rng = np.random.default_rng(3)
    for _ in range(20):
        q = rng.uniform(robot.limits.lower, robot.limits.upper)
        for link in LINKS.values():
            np.testing.assert_allclose(preset.forward(q, link), robot.forward(q, link), rtol=0, atol=1e-12)
        np.testing.assert_allclose(preset.center_of_mass(q), robot.center_of_mass(q), rtol=0, atol=2e-6)


@pytest.mark.parametrize("case", CASES)
def test_both_hands_reach_their_targets_in_the_allowed_steps(robot: fp.Robot, case: str) -> None:
    steps, repeat, left = CASES[case]
    stack = fp.Stack(both_hands({"k": 20}), fp.PostureTask(np.zeros(DOF), k=2))
    tracker = fp.Tracker(robot, fp.MVN(), np.zeros(DOF), stack=stack, dt=STEP, error_bound=2.0)
    worst, bend = np.zeros(2), 0.0
    for i in range(len(left) * repeat + 1):
        goals = targets(left[i % len(left)])
        for _ in range(steps if i else STEPS_TO_SETTLE):
            tick = tracker.tick(goals)
        bend = max(bend, abs(tick.q[robot.joint_names.index("waist_pitch_joint")]))
        for hand, goal in goals.items():
            off = robot.forward(tick.q, LINKS[hand]) @ np.linalg.inv(goal)
            position = np.linalg.norm(robot.forward(tick.q, LINKS[hand])[:3, 3] - goal[:3, 3])
            worst = np.maximum(worst, [position, Rotation.from_matrix(off[:3, :3]).magnitude()])
        assert np.all((robot.limits.lower <= tick.q) & (tick.q <= robot.limits.upper))
    print(f"{case}: off by {worst[0]:.1e} m and {worst[1]:.1e} rad at most, waist bent by up to {bend:.2f} rad")
    assert worst[0] < POSITION
    assert worst[1] < ROTATION
    if "waist" in case:
        assert bend > 0.3


def test_a_posture_does_not_move_the_hands(robot: fp.Robot) -> None:
    """Hand velocities of both laws for postures that are off by 0.1, 0.5 and 1.0 rad, in random states."""
    limits = fp.JointLimits(
        lower=robot.limits.lower,
        upper=robot.limits.upper,
        velocity=robot.limits.velocity,
        acceleration=np.full(DOF, 300.0),  # [rad/s²]
    )
    scheme = fp.Balanced(0, np.ones(DOF), null_damping=2)
    rng = np.random.default_rng(1)
    change, moved = 0.0, np.inf
    for _ in range(50):
        q, qd = rng.uniform(-0.4, 0.4, DOF), rng.uniform(-0.1, 0.1, DOF)
        q[[robot.joint_names.index(f"{hand}_elbow_joint") for hand in HANDS]] += 0.5
        J = np.vstack([robot.jacobian(q, LINKS[hand]) for hand in HANDS])
        goals = {hand: robot.forward(q, LINKS[hand]) for hand in HANDS}
        for pose in goals.values():
            pose[:3, 3] += rng.uniform(-0.05, 0.05, 3)
        hand_velocity = rng.uniform(-0.5, 0.5, 12)
        motions = []
        for offset in (0.0, 0.1, 0.5, 1.0):
            posture = np.full(DOF, offset)
            levels = [(J, hand_velocity), (np.eye(DOF), 2 * (posture - q))]
            velocity = fp.saturate(levels, -limits.velocity, limits.velocity).u
            stack = fp.Stack(both_hands({"k1": 40, "k2": 400}), fp.PostureTask(posture, k1=4, k2=4))
            tracker = fp.Tracker(robot, scheme, q, qd0=qd, stack=stack, dt=TICK, limits=limits, measured_delay=0)
            tick = tracker.resolve_measured(q, qd, goals)
            motions.append((velocity, tick.qdd * TICK))  # The change of velocity in a tick.
        for law in (0, 1):
            of_law = np.array([motion[law] for motion in motions])
            change = max(change, np.abs((of_law[1:] - of_law[0]) @ J.T).max())
            moved = min(moved, np.abs(of_law[3] - of_law[0]).max())
    print(f"hand velocities change by {change:.1e} m/s and rad/s at most, a joint's by {moved:.1e} rad/s at least")
    assert change < 1e-10
    assert moved > 1e-5
