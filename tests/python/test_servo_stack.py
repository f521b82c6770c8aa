"""The loop behind the handles of a stack: each target moves its own task, and higher levels and limits are kept."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_servo_loop import FRAME, PANDA, PLANAR, READY, Clock, bounds, fpbm, kept, moved, play

import fpbm_cpp as fp
from fpbm_cpp.viewer.frames import distances, frame_of, point_of
from fpbm_cpp.viewer.loop import ServoLoop

WEIGHTS = np.ones(7)
OTHER = np.add(READY, [0.4, 0.1, -0.3, 0.1, 0.2, -0.2, 0.3])


def cup(**place):
    """Axis, place, height of the elbow, posture."""
    return fp.Stack(
        fp.AxisTask(name="upright"),
        fp.PositionTask(name="place", **place),
        fp.PositionTask("panda_joint4", rows=("z",), name="elbow"),
        fp.PostureTask(k1=4, k2=4),
    )


def a_loop(stack=None, scheme=None, **how):
    clock = Clock()
    scheme = scheme or fp.Balanced(0.6, WEIGHTS, null_damping=2)
    return ServoLoop(PANDA, scheme, READY, clock=clock, stack=stack or cup(), **how), clock


def largest(ticks, task):
    return max(np.abs(tick.errors[task]).max() for tick in ticks)


def test_a_target_moves_its_own_task():
    loop, clock = a_loop()
    start = loop.target
    assert {*start} == {*loop.tip} == {"upright", "place", "elbow", "posture"}
    goal = moved(start["place"], [-0.1, 0.2, 0.1])
    assert loop.push(goal, "place")
    ticks = play(loop, clock, 6)
    np.testing.assert_allclose(loop.tip["place"], goal, atol=1e-5)
    assert largest(ticks, "upright") < 1e-5
    assert largest(ticks, "place") > 1e-3  # The filter does not know the joint limits.
    np.testing.assert_array_equal(loop.target["place"], goal)
    for name in ("upright", "elbow", "posture"):
        np.testing.assert_array_equal(loop.target[name], start[name])
    higher = moved(loop.tip["elbow"], [0.0, 0.0, -0.03])
    loop.push(higher, "elbow")
    ticks += play(loop, clock, 6)
    np.testing.assert_allclose(loop.tip["elbow"][2], higher[2], atol=1e-4)
    assert largest(ticks[-5000:], "place") < 1e-4
    tilted = fp.rotation([0.2, -0.1, 0.0]) @ start["upright"]
    loop.push(3 * tilted, "upright")  # The length of the axis does not matter.
    ticks += play(loop, clock, 6)
    np.testing.assert_allclose(loop.tip["upright"], tilted, atol=1e-5)
    np.testing.assert_allclose(loop.tip["place"], goal, atol=1e-4)
    kept(loop, READY, ticks)


def test_orientations_and_poses_have_targets():
    for task in (fp.OrientationTask(name="turn"), fp.PoseTask(name="turn")):
        loop, clock = a_loop(fp.Stack(task, fp.PostureTask()))
        goal = loop.target["turn"]
        goal[:3, :3] = fp.rotation([0.1, 0.2, -0.3]) @ goal[:3, :3]
        assert loop.push(goal, "turn")
        play(loop, clock, 6)
        np.testing.assert_allclose(loop.tip["turn"], goal, atol=1e-5)
        np.testing.assert_allclose(loop.frame("turn")[:3, :3], goal[:3, :3], atol=1e-5)


@settings(max_examples=15, deadline=None)
@given(data=st.data())
def test_limits_are_kept_for_any_handle_jump(data):
    loop, clock = a_loop()
    start, ticks = loop.target, []
    schemes = [fp.MVN(), fp.MAN(null_damping=1), fp.FPBM(0.6, WEIGHTS, 0, 0), fp.Balanced(0.2, WEIGHTS)]
    unit = st.lists(st.floats(-1, 1), min_size=3, max_size=3).map(np.array)
    for _ in range(data.draw(st.integers(3, 8))):
        for name in data.draw(st.sets(st.sampled_from(["place", "elbow", "upright"]))):
            loop.push(start[name] + data.draw(st.sampled_from([0.1, 0.5, 5.0])) * data.draw(unit), name)
        action = data.draw(st.sampled_from(["", "", "stop", "resume", "scheme"]))
        if action == "scheme":
            loop.scheme = data.draw(st.sampled_from(schemes))
        elif action:
            getattr(loop, action)()
        ticks += play(loop, clock, 0.6, data.draw(st.sampled_from([0.0005, 0.01, FRAME, 0.1])))
    kept(loop, READY, ticks)
    assert ((loop.strip.shares[4:] >= 0) & (loop.strip.shares[4:] <= 1)).all()


def test_one_level_moves_as_the_loop_of_that_task():
    clock = Clock()
    alone = ServoLoop(PANDA, fpbm(7), READY, clock=clock)
    loop, other = a_loop(fp.Stack(fp.PositionTask(name="place")))
    for displacement in ([0.1, 0.5, 0.0], [-0.2, 0.1, 0.1]):
        alone.push(moved(alone.target, displacement))
        loop.push(moved(loop.target["place"], displacement), "place")
        play(alone, clock, 0.7)
        play(loop, other, 0.7)
        np.testing.assert_allclose(loop.q, alone.q, atol=1e-9)
    np.testing.assert_allclose(loop.strip.shares, alone.strip.shares, atol=1e-6)


def test_the_strip_has_the_scale_of_each_level():
    loop, clock = a_loop()
    loop.push(moved(loop.target["place"], [0.0, 0.6, 0.0]), "place")
    ticks = play(loop, clock, 2)
    scales = np.array([tick.scales for tick in ticks])
    np.testing.assert_array_equal(loop.strip.shares[4:], scales.T)
    assert scales.min() < 0.9
    _, worst = loop.strip.curves()
    there = worst[:, ~np.isnan(worst[0])]
    assert there.shape[0] == 4 + 4
    np.testing.assert_array_equal(there[4:].min(axis=1), scales.min(axis=0))


def test_each_task_starts_at_its_own_target():
    """Also after a restart, which resets the handles."""
    away = moved(PANDA.forward(READY)[:3, 3], [0.0, 0.15, 0.0])
    loop, clock = a_loop(fp.Stack(fp.PositionTask(x=away, name="place"), fp.PostureTask(OTHER, k1=4, k2=4)))
    for _ in range(2):
        assert (loop.tick, loop.time) == (None, 0.0)
        np.testing.assert_array_equal(loop.target["place"], away)
        np.testing.assert_array_equal(loop.target["posture"], OTHER)
        ticks = play(loop, clock, 8)
        kept(loop, READY, ticks)
        np.testing.assert_allclose(loop.tip["place"], away, atol=1e-5)
        assert np.linalg.norm(loop.q - OTHER) < 0.7 * np.linalg.norm(READY - OTHER)
        loop.push(moved(away, [0.1]), "place")
        loop.push(READY, "posture")
        loop.stop()
        play(loop, clock, 0.5)
        loop.restart()
    assert not loop.stopped
    assert loop.strip.shares.shape == (6, 0)


def test_another_scheme_keeps_the_targets():
    loop, clock = a_loop()
    goals = {
        "upright": fp.rotation([0.2, 0.0, 0.0]) @ loop.target["upright"],
        "place": moved(loop.target["place"], [0.0, 0.2, 0.1]),
        "posture": np.array(OTHER),
    }
    for name, x in goals.items():
        loop.push(x, name)
    q0, ticks = loop.q, play(loop, clock, 0.3)
    for scheme in (fp.MAN(null_damping=1), fp.MVN(), fp.Balanced(0.9, WEIGHTS)):
        loop.scheme = scheme
        for name, x in goals.items():
            np.testing.assert_array_equal(loop.target[name], x)
        ticks += play(loop, clock, 3)
        np.testing.assert_allclose(ticks[-1].errors["posture"] + loop.q, OTHER, atol=1e-3)
    np.testing.assert_allclose(loop.tip["upright"], goals["upright"], atol=1e-4)
    np.testing.assert_allclose(loop.tip["place"], goals["place"], atol=1e-4)
    kept(loop, q0, ticks)


def test_a_target_filter_bounds_the_speed_of_its_task():
    tip = PANDA.forward(READY)[:3, 3]
    slow = fp.TargetFilter(tip, velocity=0.02, acceleration=1, jerk=10)
    loop, clock = a_loop(targets={"place": slow})
    loop.push(moved(tip, [0.1]), "place")
    before = loop.tip["place"]
    for _ in range(30):
        play(loop, clock, FRAME)
        assert np.abs(loop.tip["place"] - before).max() / FRAME < 0.022
        before = loop.tip["place"]


def test_invalid_arguments_are_rejected():
    tip = PANDA.forward(READY)[:3, 3]
    plain, late = (fp.TargetFilter(tip, velocity=1, acceleration=1, jerk=1, dt=dt) for dt in (1e-3, 2e-3))
    for how, words in [
        ({"stack": 3}, "stack: must be a Stack"),
        ({"targets": plain}, "targets: must be a dictionary of filters"),
        ({"targets": {"plaec": plain}}, "targets = 'plaec': must be one of place, elbow; did you mean 'place'"),
        ({"targets": {"upright": plain}}, "targets = 'upright': must be one of place, elbow"),
        ({"targets": {"place": late}}, "filter's dt"),
        ({"targets": {"place": 3}}, "place"),
        ({"stack": fp.Stack(fp.PoseTask()), "targets": {"pose": plain}}, "is for another task than 'pose'"),
        ({"scheme": fp.FPBM(0.6, WEIGHTS, 10, 25)}, "k1 = 10: must be 0"),
    ]:
        with pytest.raises(ValueError, match=words):
            a_loop(**how)
    loop, clock = a_loop(fp.Stack(fp.OrientationTask(name="turn"), fp.AxisTask(name="axis"), fp.PostureTask()))
    before = {name: x.copy() for name, x in loop.target.items()}
    for name in (None, "trun", "tip"):
        with pytest.raises(fp.ParameterError, match=f"task = {name!r}: must be one of turn, axis, posture"):
            loop.push(np.eye(3), name)
    for name, x in (("turn", np.eye(4)), ("axis", [0, 0, 0, 1]), ("posture", [0, 0])):
        with pytest.raises(fp.ParameterError, match=f"{name} has shape"):
            loop.push(x, name)
    mirror = np.diag([1, 1, -1.0])
    lies = [("turn", 2 * np.eye(3)), ("turn", mirror), ("turn", np.nan * mirror), ("axis", [0, 0, 0])]
    for name, x in (*lies, ("axis", [np.inf, 0, 0]), ("posture", np.full(7, np.nan))):
        assert not loop.push(x, name)
    loop.target["axis"][:] = 5  # A copy.
    with pytest.raises(ValueError, match="k1 = 10: must be 0"):
        loop.scheme = fp.FPBM(0.6, WEIGHTS, 10, 25)
    for name, x in before.items():
        np.testing.assert_array_equal(loop.target[name], x)
    play(loop, clock, 1)
    np.testing.assert_allclose(loop.q, READY, atol=1e-9)


def test_a_stack_of_an_arm_in_the_plane():
    stack = fp.Stack(fp.PositionTask(name="tip"), fp.OrientationTask("joint_2", name="turn"))
    clock = Clock()
    loop = ServoLoop(PLANAR, fp.MVN(), [0.3, 0.4, 0.5, 0.6], stack=stack, limits=bounds(), clock=clock)
    goal = moved(loop.target["tip"], [-0.3, 0.4])
    turned = fp.rotation([0, 0, 0.2]) @ loop.target["turn"]
    loop.push(goal, "tip")
    loop.push(turned, "turn")
    play(loop, clock, 8)
    np.testing.assert_allclose(loop.tip["tip"], goal, atol=1e-4)
    np.testing.assert_allclose(loop.tip["turn"], turned, atol=1e-4)


# Points as frames


def a_pose(turn, place):
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = fp.rotation(turn), place
    return pose


THREE = st.lists(st.floats(-1, 1), min_size=3, max_size=3)
POSE = st.builds(a_pose, THREE, THREE)


@given(POSE)
def test_a_frame_of_a_point_gives_that_point(pose):
    R, p = pose[:3, :3], pose[:3, 3]
    angle = np.array([*p[:2], 0.7])
    points = [(fp.PositionTask(), p), (fp.PositionTask(), p[:2]), (fp.OrientationTask(), R), (fp.AxisTask(), R[:, 2])]
    for task, x in (*points, (fp.PoseTask(), pose), (fp.PoseTask(), angle)):
        np.testing.assert_allclose(point_of(task, frame_of(task, x), x.shape), x, atol=1e-12)
    np.testing.assert_allclose(frame_of(fp.AxisTask(), np.array([0, 0, -2.0]))[:3, 2], [0, 0, -1], atol=1e-12)


@given(POSE, POSE)
def test_distances_equal_the_errors_of_the_tasks(pose, now):
    """As large as the error in the rows that the task selects."""
    linear, turn = pose[:3, 3] - now[:3, 3], fp.rotation_vector(pose[:3, :3] @ now[:3, :3].T)
    size, seen = np.linalg.norm, now[:3, :3].T
    expected = [
        (fp.PositionTask(), {"m": size(linear)}),
        (fp.PositionTask(rows=("z",)), {"m": abs(linear[2])}),
        (fp.PositionTask(rows=("x", "y"), axes="frame"), {"m": size((seen @ linear)[:2])}),
        (fp.OrientationTask(rows=("ry",), axes="frame"), {"rad": abs((seen @ turn)[1])}),
        (fp.PoseTask(), {"m": size(linear), "rad": size(turn)}),
        (fp.PoseTask(rows=("x", "rz")), {"m": abs(linear[0]), "rad": abs(turn[2])}),
        (fp.PoseTask(rows=("x", "y", "z")), {"m": size(linear)}),
        (fp.AxisTask(), {"rad": np.arccos(np.clip(pose[:3, 2] @ now[:3, 2], -1, 1))}),
    ]
    for task, sizes in expected:
        found = distances(task, pose, now)
        assert found.keys() == sizes.keys()
        for unit, value in sizes.items():
            assert found[unit] == pytest.approx(value, abs=1e-7)


def test_bounds_of_tasks_hold_while_a_target_is_dragged() -> None:
    arm, q0 = fp.SerialArm.preset("panda"), [0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785]
    y = arm.forward(q0)[1, 3] + 0.1
    now = 0.0
    wall = fp.TaskBounds(fp.PositionTask(rows=("y",)), upper=y)
    loop = ServoLoop(arm, fp.FPBM(0.6, np.ones(7), 10, 25), q0, bounds=[wall], clock=lambda: now)
    most = -np.inf
    for _ in range(100):
        now += 0.02
        loop.push(arm.forward(q0)[:3, 3] + [0, 0.3, 0])
        most = max(most, *(arm.forward(tick.q)[1, 3] for tick in loop.advance()))
    assert y - 1e-3 < most <= y + 1e-9
    assert loop.status is fp.Status.BLOCKED
