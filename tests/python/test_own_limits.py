"""Limits of the user: numbers, missing fields, and the messages that name what to type."""

from __future__ import annotations

import pickle
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
import pytest

import fpbm_cpp as fp
from fpbm_cpp import JointLimits  # The repr of limits.

pytest.importorskip("click")

from click.testing import CliRunner

from fpbm_cpp.cli import command

PANDA = fp.SerialArm.preset("panda")
FR3 = fp.SerialArm.preset("fr3")
Q0 = [0, -0.7854, 0, -2.3562, 0, 1.5708, 0.7854]
FIELDS = ("lower", "upper", "velocity", "acceleration", "jerk", "velocity_offset", "deceleration")


def without_acceleration(arm: fp.SerialArm) -> fp.SerialArm:
    return replace(arm, joints=[replace(joint, acceleration=inf, jerk=inf) for joint in arm.joints])


def test_missing_fields_are_the_fields_of_the_arm() -> None:
    limits = fp.JointLimits(acceleration=10, upper=np.full(7, 2.5)).of(FR3)
    np.testing.assert_array_equal(limits.acceleration, np.full(7, 10))
    np.testing.assert_array_equal(limits.upper, np.full(7, 2.5))
    for name in set(FIELDS) - {"acceleration", "upper"}:
        np.testing.assert_array_equal(getattr(limits, name), getattr(FR3.limits, name))
    assert fp.JointLimits().of(FR3) == FR3.limits
    assert limits.of(FR3) == limits


def test_numbers_are_arrays_beside_an_array() -> None:
    limits = fp.JointLimits(lower=-1, upper=[1, 2], velocity=3, acceleration=4)
    np.testing.assert_array_equal([limits.lower, limits.velocity], [[-1, -1], [3, 3]])
    np.testing.assert_array_equal([limits.jerk, limits.velocity_offset], [[inf, inf], [0, 0]])
    with pytest.raises(ValueError, match="read-only"):
        limits.velocity[0] = 1


def test_complete_limits_have_no_other_bounds() -> None:
    """As before: if lower, upper, velocity and acceleration are given, the jerk of the arm does not apply."""
    limits = fp.JointLimits(lower=-1, upper=1, velocity=2, acceleration=3).of(FR3)
    assert np.isinf(limits.jerk).all()
    assert np.isinf(limits.deceleration).all()
    kept = fp.JointLimits(lower=-1, upper=1, velocity=2).of(FR3)
    np.testing.assert_array_equal(kept.jerk, FR3.limits.jerk)
    assert np.isinf(replace(PANDA.limits, jerk=None).jerk).all()


def test_replace_changes_fields() -> None:
    limits = PANDA.limits.replace(acceleration=10, velocity=np.full(7, 1.5))
    np.testing.assert_array_equal([limits.acceleration, limits.velocity], [np.full(7, 10), np.full(7, 1.5)])
    np.testing.assert_array_equal(limits.jerk, PANDA.limits.jerk)
    assert fp.JointLimits(velocity=1).replace(jerk=5) == fp.JointLimits(velocity=1, jerk=5)


@pytest.mark.parametrize(
    "limits", [fp.JointLimits(), fp.JointLimits(acceleration=10), fp.JointLimits(velocity=[1, 2], jerk=inf)]
)
def test_partial_limits_are_data(limits: JointLimits) -> None:
    assert eval(repr(limits), {"JointLimits": JointLimits, "inf": inf}) == limits
    assert pickle.loads(pickle.dumps(limits)) == limits
    assert hash(replace(limits)) == hash(limits)


def test_wrong_lengths_are_named() -> None:
    with pytest.raises(fp.ParameterError, match=r"^velocity has 3 entries: must have 2, one per joint$"):
        fp.JointLimits(lower=[0, 0], velocity=[1, 2, 3])
    with pytest.raises(fp.ParameterError, match=r"^limits has 3 entries: must have 7, one per joint$"):
        fp.Tracker(PANDA, fp.MVN(), Q0, limits=fp.JointLimits(velocity=[1, 2, 3]))
    with pytest.raises(fp.ParameterError, match="must be real numbers"):
        fp.JointLimits(velocity=[[1]])


@pytest.mark.parametrize("scheme", [fp.MVN(k=5), fp.FPBM(0.6, np.ones(7), 20, 100, null_damping=2)])
def test_partial_limits_equal_the_complete_limits(scheme: fp.Scheme) -> None:
    """Everything that accepts limits gives the same motion, to the last bit."""
    part = fp.JointLimits(velocity=0.3, acceleration=2)
    whole = part.of(PANDA)
    path = fp.Line([0.1, 0.05, -0.1], 0.5)
    for function in (
        lambda limits: fp.track(PANDA, path, scheme, Q0, limits=limits).q,
        lambda limits: fp.track(PANDA, path, scheme, Q0, limits=limits).limits.velocity,
        lambda limits: fp.sweep(PANDA, path, scheme, Q0, limits=limits, motions=True).motions[0, 0].q,
        lambda limits: ticks(fp.Tracker(PANDA, scheme, Q0, limits=limits)),
    ):
        np.testing.assert_array_equal(function(part), function(whole))
    run = fp.track(PANDA, path, scheme, Q0, limits=part)
    assert np.abs(run.qd).max() <= 0.3
    assert not run.status or run.limits == whole


def ticks(tracker: fp.Tracker) -> np.ndarray:
    goal = tracker.tip + np.array([0.1, 0, -0.1])
    return np.array([tracker.tick(goal).q for _ in range(200)])


def test_robots_have_partial_limits() -> None:
    robot = fp.Robot.preset("two_pandas")
    stack = fp.Stack(fp.PositionTask("left_tip"))
    scheme = fp.Balanced(0, np.ones(14), null_damping=2)
    tracker = fp.Tracker(robot, scheme, 2 * Q0, stack=stack, limits=fp.JointLimits(velocity=0.2))
    goal = tracker.tip["position"] + [0.2, 0, 0]
    assert max(np.abs(tracker.tick({"position": goal}).qd).max() for _ in range(500)) <= 0.2


# Missing accelerations

ADVICE = "give limits=fp.JointLimits(acceleration=10), in rad/s^2 or m/s^2"


def test_missing_accelerations_say_what_to_type() -> None:
    arm = without_acceleration(PANDA)
    scheme = fp.FPBM(0.6, np.ones(7), 20, 100, null_damping=2)
    path = fp.Circle(0.05, 1.0).in_plane("yz")
    for call in (
        lambda **more: fp.Tracker(arm, scheme, Q0, **more),
        lambda **more: fp.track(arm, path, scheme, Q0, **more),
        lambda **more: fp.sweep(arm, path, scheme, Q0, **{"limits": arm.limits, **more}),
    ):
        with pytest.raises(fp.ParameterError) as caught:
            call()
        assert str(caught.value).endswith(
            f"limits.acceleration[0] = inf: must be finite if the joint position or velocity is bounded: {ADVICE}"
        )
        advised = eval(ADVICE.removeprefix("give limits=").partition(", in")[0], {"fp": fp})
        call(limits=advised)
        call(limits=arm.limits.replace(acceleration=10))
    fp.Tracker(arm, fp.MVN(), Q0)  # At velocity level, no bound on acceleration is needed.


def test_missing_fields_of_a_limiter_are_named() -> None:
    with pytest.raises(fp.ParameterError, match=r"^limits.lower is missing: give limits.of\(arm\)$"):
        fp.Limiter(fp.JointLimits(acceleration=10), 1e-3)
    fp.Limiter(fp.JointLimits(acceleration=10).of(PANDA), 1e-3)


# Arms with fewer than six joints

SO101 = fp.SerialArm.preset("so101")
BENT = [0.1, -0.4, 0.5, 0.6, 0.2]


@pytest.mark.parametrize(
    "call",
    [
        lambda: fp.Tracker(SO101, fp.MVN(), BENT, task="pose"),
        lambda: fp.track(SO101, fp.Circle(0.02, 1.0).in_plane("yz"), fp.MVN(), BENT, task="pose"),
        lambda: fp.MVN().resolve(SO101, BENT, np.zeros(5), np.eye(4), np.zeros(6), task="pose"),
    ],
)
def test_a_pose_of_five_joints_names_what_to_use(call) -> None:
    with pytest.raises(fp.ParameterError) as caught:
        call()
    assert str(caught.value) == (
        "task: has 6 rows, and the arm has 5 joints: must not have more rows than joints: "
        "give task='position' or stack=fp.Stack(fp.PositionTask(), fp.AxisTask())"
    )


def test_position_and_axis_are_reached_by_five_joints() -> None:
    rng = np.random.default_rng(0)
    scheme = fp.Balanced(0, np.ones(5), null_damping=2)
    for _ in range(10):
        stack = fp.Stack(fp.PositionTask(), fp.AxisTask())
        tracker = fp.Tracker(SO101, scheme, BENT, stack=stack, dt=0.005)
        goal = SO101.forward(BENT + rng.uniform(-0.15, 0.15, 5))
        for _ in range(3000):
            tick = tracker.tick({"position": goal[:3, 3], "axis": goal[:3, 2]})
        assert np.abs(tick.errors["position"]).max() < 1e-6
        assert np.abs(tick.errors["axis"]).max() < 1e-6


def run_command(*arguments: object) -> tuple[int, str]:
    result = CliRunner().invoke(command, [str(each) for each in arguments])
    return result.exit_code, result.output


def test_the_command_line_selects_position_and_axis(tmp_path: Path) -> None:
    code, text = run_command(
        "track", "so101", "--radius", "0.02", "--limits", "--out", tmp_path, "--save-job", tmp_path / "job.toml"
    )
    assert code == 0, text
    assert "tasks position and axis" in " ".join(text.split())
    run = fp.load(tmp_path / "run.npz")
    assert [task.kind for task in run.stack.tasks] == ["position", "axis"]
    assert run.error_norms()[0].max() < 1e-4
    assert run_command("track", "--job", tmp_path / "job.toml")[0] == 0
    code, text = run_command("track", "so101", "--radius", "0.02", "--task", "position")
    assert code == 0
    assert "axis" not in text
    assert "tasks" not in run_command("track", "ur5e", "--radius", "0.02")[1]
    code, text = run_command("track", "so101", "--task", "pose")
    assert code == 1
    assert "give task='position'" in text


def test_gains_of_the_command_line_are_those_of_both_tasks(tmp_path: Path) -> None:
    code, text = run_command(
        "track", "so101", "--radius", "0.02", "--k1", "12", "--k2", "30", "--save-job", tmp_path / "job.toml"
    )
    assert code == 0, text
    assert (tmp_path / "job.toml").read_text().count("k1 = 12") == 2


# A header with own limits


def test_a_header_has_own_limits(tmp_path: Path) -> None:
    urdf = tmp_path / "arm.urdf"
    limit = '<limit lower="-1" upper="2" velocity="0"/>'
    joints = "".join(
        f'<joint name="j{i}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/>{limit}</joint>'
        for i in range(2)
    )
    urdf.write_text(
        f'<robot name="r">{"".join(f"<link name={chr(34)}l{i}{chr(34)}/>" for i in range(3))}{joints}</robot>'
    )
    given = ("--limit-acceleration", "10,20", "--limit-velocity", "2")
    code, text = run_command("export-header", urdf, "--tip", "l2", "-o", "-", *given)
    assert code == 0, text
    assert "bounds = {-1.0, 2.0, 2.0, 10.0};" in text
    assert "bounds = {-1.0, 2.0, 2.0, 20.0};" in text
    assert "arm.urdf, tip l2, --limit-velocity 2, --limit-acceleration 10,20. Do not edit." in text
    code, tree = run_command("export-header", urdf, "-o", "-", *given)
    assert code == 0, tree
    assert "bounds = {-1.0, 2.0, 2.0, 20.0};" in tree
    code, text = run_command("export-header", "panda", "-o", "-", "--limit-acceleration", "4", "--limit-jerk", "inf")
    assert code == 0, text
    assert text.count(", 4.0};") == 7
    code, text = run_command("export-header", "two_pandas", "-o", "-", "--limit-acceleration", "4")
    assert text.count(", 4.0, ") == 14
    code, text = run_command("export-header", "panda", "-o", "-", "--limit-acceleration", "4,5")
    assert (code, text) == (1, "Error: acceleration has 2 entries: must have 7, one per joint\n")
    code, text = run_command("export-header", "panda", "-o", "-", "--limit-acceleration", "fast")
    assert code == 1
    assert "acceleration = 'fast': must be real numbers" in text
