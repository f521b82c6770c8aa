"""Inverse kinematics: postures for targets, within ranges and bounds."""

from __future__ import annotations

import threading
import time
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fpbm_cpp as fp
from fpbm_cpp._types import Array

PANDA = fp.SerialArm.preset("panda")
PRESETS = ("panda", "fr3", "iiwa14", "gen3", "ur5e", "ur10e", "xarm7", "openarm", "z1")
TURN = 2 * np.pi


def forward(arm: fp.SerialArm, q: Array) -> Array:
    """Pose of the tip, by the product of the frames of the joints."""
    pose = np.eye(4)
    for joint, position in zip(arm.joints, q):
        motion = np.eye(4)
        if joint.type == "prismatic":
            motion[:3, 3] = position * joint.axis / np.linalg.norm(joint.axis)
        else:
            motion[:3, :3] = fp.rotation(position * joint.axis / np.linalg.norm(joint.axis))
        pose = pose @ joint.placement @ motion
    return pose @ arm.tip


def distance(x: Array, y: Array) -> float:
    """Largest of distance [m] and angle [rad]."""
    turn = np.linalg.norm(fp.rotation_vector(x[:3, :3] @ y[:3, :3].T))
    return float(max(np.linalg.norm(x[:3, 3] - y[:3, 3]), turn))


def random_postures(arm: fp.Arm | fp.Robot, count: int, seed: int) -> Array:
    lower, upper = np.clip(arm.limits.lower, -np.pi, np.pi), np.clip(arm.limits.upper, -np.pi, np.pi)
    return np.random.default_rng(seed).uniform(lower, upper, (count, arm.dof))


@pytest.mark.parametrize("name", PRESETS)
def test_every_reachable_pose_is_found(name: str) -> None:
    arm = fp.SerialArm.preset(name)
    targets = np.array([arm.forward(q) for q in random_postures(arm, 300, 1)])
    found = arm.inverse(targets, random_postures(arm, 300, 2), starts=256)
    assert found.solved.all()
    assert found.status == [fp.Status.OK] * 300
    assert found.starts.max() <= 256
    for q, target, error in zip(found.q, targets, found.error):
        assert distance(forward(arm, q), target) <= 1e-6
        assert distance(forward(arm, q), target) == pytest.approx(error, abs=1e-9)
    assert (found.q >= arm.limits.lower).all()
    assert (found.q <= arm.limits.upper).all()


@given(st.integers(0, 10**6), st.sampled_from(PRESETS), st.sampled_from(["position", "pose"]))
def test_one_call_equals_a_batch(seed: int, name: str, task: Any) -> None:
    arm = fp.SerialArm.preset(name)
    q, start = random_postures(arm, 2, seed)
    target = arm.forward(q) if task == "pose" else arm.forward(q)[:3, 3]
    one = arm.inverse(target, start, task=task)
    many = arm.inverse(np.array([target, target]), start, task=task)
    assert (many.q == one.q).all()
    assert many.error[1] == one.error
    assert many.starts[0] == one.starts
    assert many.solved[0] == one.solved
    assert (fp.InverseKinematics(arm, task=task).solve(target, start).q == one.q).all()


@given(st.integers(0, 10**6), st.sampled_from(PRESETS))
def test_a_near_start_keeps_its_branch(seed: int, name: str) -> None:
    arm = fp.SerialArm.preset(name)
    (start,) = random_postures(arm, 1, seed)
    q = np.clip(start + np.random.default_rng(seed).uniform(-0.02, 0.02, arm.dof), arm.limits.lower, arm.limits.upper)
    found = arm.inverse(arm.forward(q), start)
    assert found.solved
    assert found.starts == 1


def test_the_middle_of_the_ranges_is_the_default_start() -> None:
    target = PANDA.forward([0.1, -0.3, 0.2, -2.2, 0.1, 2.0, 0.785])
    middle = (PANDA.limits.lower + PANDA.limits.upper) / 2
    assert (PANDA.inverse(target).q == PANDA.inverse(target, middle).q).all()


def test_a_target_out_of_reach_is_an_answer() -> None:
    found = PANDA.inverse([3.0, 0, 0.5], task="position")
    assert not found.solved
    assert found.status == fp.Status.NOT_FOUND
    assert found.starts == 64
    assert found.error == pytest.approx(np.linalg.norm(PANDA.forward(found.q)[:3, 3] - [3, 0, 0.5]))
    assert "not found" in repr(found)
    assert not fp.failed(found.status)


def test_the_seed_selects_the_starts() -> None:
    q, start = random_postures(PANDA, 2, 7)
    several = {tuple(PANDA.inverse(PANDA.forward(q), start, seed=seed).q) for seed in range(8)}
    assert len(several) > 1
    assert (PANDA.inverse(PANDA.forward(q), start).q == PANDA.inverse(PANDA.forward(q), start).q).all()


def test_all_postures_are_distinct_and_sorted_by_distance() -> None:
    arm = fp.SerialArm.preset("ur5e")
    q = np.array([0.3, -1.1, 1.4, -0.9, 1.2, 0.4])
    found = arm.inverse_all(arm.forward(q), q)
    assert len(found) == 8  # The branches of an arm with a spherical-like wrist.
    assert found[0].q == pytest.approx(q, abs=1e-5)
    lengths = [np.linalg.norm(each.q - q) for each in found]
    assert lengths == sorted(lengths)
    for each in found:
        assert distance(forward(arm, each.q), arm.forward(q)) <= 1e-6
    assert len(arm.inverse_all(arm.forward(q), q, 3)) == 3
    assert fp.InverseKinematics(arm).solve_all([[1, 0, 0, 9], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) == []


def volume(J: Array) -> float:
    """Manipulability by the singular values."""
    return float(np.prod(np.linalg.svd(J, compute_uv=False)))


def gap(limits: fp.JointLimits, q: Array) -> float:
    lower, upper = np.asarray(limits.lower), np.asarray(limits.upper)
    with np.errstate(invalid="ignore"):
        gaps = np.minimum(q - lower, upper - q) / (upper - lower)
    return float(np.min(gaps[np.isfinite(gaps)], initial=np.inf))


@pytest.mark.parametrize("name", ["panda", "gen3", "ur5e"])
@pytest.mark.parametrize("bounded", [False, True])
def test_postures_are_sorted_by_rank(name: str, bounded: bool) -> None:
    arm = fp.SerialArm.preset(name)
    clearance = fp.Clearance.preset(name, obstacles=[fp.HalfSpace([0, 0, 1], -0.2, name="floor")])
    (q,) = random_postures(arm, 1, 3) / 2
    values: dict[Any, Any] = {
        "distance": lambda each: np.linalg.norm(each - q),
        "manipulability": lambda each: -volume(arm.jacobian(each, task="pose")),
        "ranges": lambda each: -gap(arm.limits, each),
    }
    if bounded:
        values["clearance"] = lambda each: -clearance.nearest(arm, each).distance  # type: ignore[union-attr]
    inverse = fp.InverseKinematics(arm, bounds=[clearance] if bounded else [], starts=64)
    sets = []
    for rank, value in values.items():
        found = inverse.solve_all(arm.forward(q), q, 1000, rank=rank)
        expected = [value(each.q) for each in found]
        assert len(found) >= 2
        assert [abs(each.rank_value or 0) for each in found] == pytest.approx(np.abs(expected), rel=1e-9, abs=1e-12)
        assert expected == pytest.approx(sorted(expected), rel=1e-9, abs=1e-12)
        assert [tuple(each.q) for each in inverse.solve_all(arm.forward(q), q, 2, rank=rank)] == [
            tuple(each.q) for each in found[:2]
        ]
        sets.append({tuple(each.q) for each in found})
    assert all(each == sets[0] for each in sets)
    assert inverse.solve(arm.forward(q), q).rank_value is None


def test_manipulability_of_the_first_level() -> None:
    robot = fp.Robot.preset("two_pandas")
    tip = fp.PoseTask("right_tip", name="right")
    (q,) = random_postures(robot, 1, 5) / 2
    first = fp.PositionTask("left_tip", rows=("x", "z"), name="left")
    found = robot.inverse_all(
        {"left": robot.forward(q, "left_tip")[:3, 3]}, q, stack=fp.Stack([tip, first]), rank="manipulability", starts=32
    )
    rows = [0, 2]
    expected = [
        volume(np.vstack([robot.jacobian(each.q, "right_tip"), robot.jacobian(each.q, "left_tip")[rows]]))
        for each in found
    ]
    assert len(found) > 1
    assert [each.rank_value for each in found] == pytest.approx(expected)
    assert expected == sorted(expected, reverse=True)


def test_equal_ranks_are_sorted_by_distance() -> None:
    """Joints without two ends do not count: all postures have the same distance from the ends."""
    limits = fp.JointLimits(lower=[-3, -np.inf, -np.inf])
    inverse = fp.InverseKinematics(fp.PlanarArm([1, 0.8, 0.6]), task="position", limits=limits)
    found = inverse.solve_all([0.9, 0.7], [0.1, 0.2, 0.3], rank="ranges")
    assert len(found) > 2
    lengths = [np.linalg.norm(each.q - [0.1, 0.2, 0.3]) for each in found]
    assert {each.rank_value for each in found} == {np.inf}
    assert lengths == sorted(lengths)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"rank": "best"}, r"rank = 'best': must be 'distance', 'manipulability', 'ranges' or 'clearance'"),
        ({"count": 0}, "count = 0: must be at least 1"),
        ({"rank": "clearance"}, r"rank = 'clearance': needs a Clearance.*give bounds=\[fp.Clearance"),
        ({"rank": "clearance", "bounds": [fp.TaskBounds(fp.PositionTask(), upper=9.0)]}, "needs a Clearance"),
    ],
)
def test_wrong_ranks(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(fp.ParameterError, match=message):
        PANDA.inverse_all(np.eye(4), **arguments)


def test_a_planar_arm() -> None:
    arm = fp.PlanarArm([1, 0.8, 0.6, 0.4])
    q, start = np.random.default_rng(3).uniform(-2, 2, (2, 4))
    position = arm.forward(q)
    found = arm.inverse(position, start, task="position")
    assert found.solved
    assert arm.forward(found.q) == pytest.approx(position, abs=1e-6)
    pose = [*position, q.sum()]
    found = arm.inverse(pose, start)
    assert found.solved
    assert np.cos(found.q.sum() - q.sum()) == pytest.approx(1)


def test_other_ranges() -> None:
    q, start = random_postures(PANDA, 2, 9)
    lower, upper = np.minimum(q, q + 0.1) - 0.05, q + 0.05
    found = PANDA.inverse(PANDA.forward(q), start, limits=fp.JointLimits(lower=lower, upper=upper), starts=256)
    assert found.solved
    assert (found.q >= lower).all()
    assert (found.q <= upper).all()


def test_a_start_outside_the_ranges_is_moved_inside() -> None:
    target = PANDA.forward([0.1, -0.3, 0.2, -2.2, 0.1, 2.0, 0.785])
    found = PANDA.inverse(target, np.full(7, 9.0))
    assert found.solved
    assert (found.q <= PANDA.limits.upper).all()


def test_bounds_are_kept() -> None:
    clearance = fp.Clearance.preset("panda", obstacles=[fp.HalfSpace([0, 0, 1], 0.0, name="table")])
    wall = fp.TaskBounds(fp.PositionTask(), upper=[0.5, np.inf, np.inf])
    inverse = fp.InverseKinematics(PANDA, bounds=[clearance, wall], starts=256)
    found = 0
    for q in random_postures(PANDA, 150, 4):
        nearest = clearance.nearest(PANDA, q)
        if nearest is None or nearest.distance < clearance.margin or PANDA.forward(q)[0, 3] > 0.5:
            continue
        posture = inverse.solve(PANDA.forward(q))
        assert posture.solved
        found += 1
        assert clearance.nearest(PANDA, posture.q).distance >= clearance.margin  # type: ignore[union-attr]
        assert PANDA.forward(posture.q)[0, 3] <= 0.5
    assert found >= 30


def test_two_arms_reach_their_targets() -> None:
    robot = fp.Robot.preset("two_pandas")
    stack = fp.Stack([fp.PoseTask("right_tip", name="right"), fp.PoseTask("left_tip", name="left")])
    postures = random_postures(robot, 20, 5)
    targets = {side: np.array([robot.forward(q, f"{side}_tip") for q in postures]) for side in ("right", "left")}
    found = robot.inverse(targets, stack=stack, starts=256)
    assert found.solved.all()
    for q, right, left in zip(found.q, targets["right"], targets["left"]):
        assert distance(robot.forward(q, "right_tip"), right) <= 1e-6
        assert distance(robot.forward(q, "left_tip"), left) <= 1e-6


def test_a_task_without_a_target_keeps_its_point() -> None:
    robot = fp.Robot.preset("two_pandas")
    stack = fp.Stack([fp.PoseTask("right_tip", name="right"), fp.PoseTask("left_tip", name="left")])
    q, start = random_postures(robot, 2, 6)
    found = robot.inverse({"right": robot.forward(q, "right_tip")}, start, stack=stack, starts=256)
    assert found.solved
    assert distance(robot.forward(found.q, "left_tip"), robot.forward(start, "left_tip")) <= 1e-6


def test_a_posture_below_a_pose_is_approached() -> None:
    stack = fp.Stack(fp.PoseTask(), fp.PostureTask())
    q, start, rest = random_postures(PANDA, 3, 8)
    near = PANDA.inverse({"pose": PANDA.forward(q), "posture": q + 1e-3}, start, stack=stack, starts=256)
    far = PANDA.inverse({"pose": PANDA.forward(q), "posture": rest}, start, stack=stack, starts=256)
    assert near.solved
    assert far.solved
    assert np.linalg.norm(far.q - rest) <= np.linalg.norm(PANDA.inverse(PANDA.forward(q), start).q - rest)


def test_threads_share_a_solver() -> None:
    inverse = fp.InverseKinematics(PANDA, bounds=[fp.Clearance.preset("panda")])
    targets = [PANDA.forward(q) for q in random_postures(PANDA, 40, 10)]
    alone = [inverse.solve(target).q for target in targets]
    together: dict[int, Array] = {}

    def work(first: int) -> None:
        for i in range(first, len(targets), 4):
            together[i] = inverse.solve(targets[i]).q

    threads = [threading.Thread(target=work, args=(first,)) for first in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all((together[i] == alone[i]).all() for i in range(len(targets)))


def test_a_solver_is_made_once() -> None:
    target = PANDA.forward(np.zeros(7))
    stack = fp.Stack(fp.PoseTask())
    PANDA.inverse({"pose": target}, stack=stack)
    begin = time.process_time()
    for _ in range(100):
        PANDA.inverse({"pose": target}, stack=stack)
    again = time.process_time() - begin
    begin = time.process_time()
    for _ in range(100):
        fp.InverseKinematics(PANDA, stack=stack).solve({"pose": target})
    assert again < time.process_time() - begin


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"target": [1, 2]}, r"target: must have 2 dimensions"),
        ({"target": np.full((4, 4), np.nan)}, r"target\[0, 0\] = nan: must be finite"),
        ({"target": np.diag([1, 1, 1.1, 1])}, r"target.R's largest error of R'R = 0.21: must be at most 0.001"),
        ({"target": np.diag([1, 1, -1, 1])}, r"target.R: must be a rotation matrix"),
        ({"target": np.eye(4), "start": [0, 0]}, r"start has 2 entries"),
        ({"target": np.eye(4), "start": np.full(7, np.nan)}, r"start\[0\] = nan: must be finite"),
        ({"target": np.eye(4), "starts": 0}, r"starts = 0: must be at least 1"),
        ({"target": np.eye(4), "tolerance": -1}, r"tolerance = -1: must be positive"),
        ({"target": np.eye(4), "task": "twist"}, r"task = 'twist': must be 'position' or 'pose'"),
        ({"target": np.eye(4), "bounds": 3}, r"bounds: must be a Clearance, TaskBounds and TorqueBounds in a sequence"),
        ({"target": np.eye(4), "stack": fp.Stack(fp.PoseTask())}, r"target: must be a dictionary"),
        ({"target": {"elbow": np.eye(4)}, "stack": fp.Stack(fp.PoseTask())}, r"task = 'elbow': must be a task"),
        ({"target": np.zeros((3, 4, 4)) + np.eye(4), "start": np.zeros((2, 7))}, r"start's number of rows = 2"),
        ({"target": np.eye(4), "limits": fp.JointLimits(lower=3.0)}, r"limits.lower\[0\] = 3: must be at most upper"),
    ],
)
def test_wrong_arguments(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(fp.ParameterError, match=message):
        PANDA.inverse(**arguments)


def test_a_robot_needs_a_stack() -> None:
    with pytest.raises(fp.ParameterError, match="stack: must be given for a Robot"):
        fp.Robot.preset("two_pandas").inverse(np.eye(4))


def test_a_rotation_with_few_decimals_is_rounded() -> None:
    target = PANDA.forward([0.1, -0.3, 0.2, -2.2, 0.1, 2.0, 0.785])
    rough = np.round(target, 4)
    found = PANDA.inverse(rough)
    assert found.solved
    assert distance(PANDA.forward(found.q), target) <= 2e-4


def test_start_posture_follows_the_whole_path() -> None:
    path = fp.Circle(0.1, 5.0).in_plane("yz")
    found = fp.start_posture(PANDA, path, fp.MVN(k=5), x0=[0.5, 0, 0.4], count=8)
    assert found.run is not None
    assert found.q is not None
    assert not found.fails_at
    assert (found.run.q[0] == found.q).all()
    assert found.run.max_error() <= 1e-3
    assert PANDA.forward(found.q)[:3, 3] == pytest.approx([0.5, 0, 0.4], abs=1e-6)


def test_start_posture_tells_where_motions_leave_the_path() -> None:
    path = fp.Circle(0.15, 0.6).in_plane("yz")
    found = fp.start_posture(PANDA, path, fp.MVN(k=5), x0=[0.5, 0, 0.4], count=8)
    assert found.q is None
    assert found.run is None
    assert 1 <= len(found.fails_at) <= 3
    for each in found.fails_at:
        assert 0 < each.time < 0.6
        assert each.error > 1e-3
        assert "leaves the path at" in str(each)
    with pytest.raises(fp.ParameterError, match=r"x0.*no posture found; the nearest is"):
        fp.start_posture(PANDA, path, fp.MVN(k=5), x0=[3, 0, 0])


@pytest.mark.parametrize("n", [48, 62, 64])
def test_a_posture_of_many_joints_on_the_first_level_keeps_its_bounds(n: int) -> None:
    """The rows of the posture and of the walls together are more than the joints of the largest robot."""
    table = [(0.05, (-1) ** i * np.pi / 2, 0.02, 0.0) for i in range(n)]
    arm = fp.SerialArm.from_dh(table, "classic", lower=-2.5, upper=2.5)
    rest = np.full(n, 0.1)
    place = arm.forward(rest)[:3, 3]
    stack = fp.Stack(fp.PostureTask(name="rest"))
    for margin, solved in ((0.01, True), (-0.01, False)):
        wall = fp.TaskBounds(fp.PositionTask(), lower=place - margin)
        found = arm.inverse({"rest": rest}, rest + 0.05, stack=stack, bounds=[wall], starts=4)
        assert found.solved == solved
        assert not solved or np.abs(found.q - rest).max() < 1e-6


@pytest.mark.parametrize("name", PRESETS)
def test_a_half_turn_of_the_tip_is_a_motion(name: str) -> None:
    arm = fp.SerialArm.preset(name)
    q = (np.maximum(arm.limits.lower, -np.pi) + np.minimum(arm.limits.upper, np.pi)) / 2 + 0.1
    start = arm.forward(q)
    for axis in np.eye(3):
        target = start @ np.block([[2 * np.outer(axis, axis) - np.eye(3), np.zeros((3, 1))], [np.eye(4)[3:]]])
        found = arm.inverse(target, q, starts=512)
        assert found.solved == (distance(forward(arm, found.q), target) <= 1e-6)
