"""Paths without a duration: as fast as possible where the tip stays on the path, and refused by all other functions."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import fpbm_cpp as fp
from fpbm_cpp.table import EVERY_PATH, from_table, to_table

PANDA = fp.SerialArm.preset("panda")
PLANAR = fp.PlanarArm([1, 1, 1, 1])
READY = [0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785]
NO_DURATION = "path: has no duration: give a duration, or use fastest\\(\\), or keep_path=True"
CORNERS = np.array([[0, 0, 0], [0.1, 0, 0], [0.1, 0.05, 0], [0.1, 0.05, 0.1]])
POSES = np.tile(np.eye(4), (3, 1, 1))
POSES[:, :3, 3] = CORNERS[1:]
POSES[1, :3, :3] = fp.rotation([0, 0.2, 0])

# Paths of every kind, from the duration of each shape.
IN_THE_PLANE: dict[str, Any] = {
    "circle": lambda t: fp.Circle(0.1, t),
    "lissajous": lambda t: fp.Lissajous((0.1, 0.05), t, time_law="constant_speed"),
    "tricuspid": lambda t: fp.Tricuspid(0.03, t),
    "line": lambda t: fp.Line([0.1, 0.1], t),
    "polyline": lambda t: fp.Polyline(CORNERS[:3, :2], t, blend=0.01),
    "waypoints": lambda t: fp.Waypoints(CORNERS[:3, :2], duration=t),
    "turned": lambda t: fp.Circle(0.1, t).with_rotation(0.2),
    "sequence": lambda t: fp.Circle(0.05, t).then(fp.Line([0.1, 0], t)),
}
IN_SPACE: dict[str, Any] = {
    "circle in space": lambda t: fp.Circle(0.1, t).in_plane("yz"),
    "line in space": lambda t: fp.Line([0.05, 0.1, 0.05], t),
    "polyline in space": lambda t: fp.Polyline(CORNERS, t),
    "polyline through poses": lambda t: fp.Polyline(POSES, t, blend=0.01),
    "waypoints through poses": lambda t: fp.Waypoints(POSES, duration=t),
    "turned in space": lambda t: fp.Tricuspid(0.03, t).in_plane("yz").with_rotation([0, 0.1, 0.1]),
    "sequence in a plane": lambda t: fp.Line([0.1, 0], t).then(fp.Line([0, 0.1], t)).in_plane("yz"),
    "sequence in space": lambda t: fp.Line([0.1, 0, 0], t).then(fp.Circle(0.05, t).in_plane("xz")),
}


@pytest.fixture(params=[*IN_THE_PLANE, *IN_SPACE])
def name(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture
def paths(name: str) -> tuple[fp.Path, fp.Path]:
    """A path without a duration, and the path with a duration."""
    make = {**IN_THE_PLANE, **IN_SPACE}[name]
    return make(None), make(3.0)


@pytest.fixture
def arm(name: str) -> Any:
    return PLANAR if name in IN_THE_PLANE else PANDA


@pytest.fixture
def how(name: str) -> dict[str, Any]:
    """Arguments of a motion of the arm along the path."""
    task = "pose" if "turned" in name or "poses" in name else "position"
    limits = None
    if name in IN_THE_PLANE:
        limits = fp.JointLimits(lower=[-3] * 4, upper=[3] * 4, velocity=[2] * 4, acceleration=[10] * 4, jerk=[200] * 4)
    q0 = [0.4, 0.5, 0.6, 0.3] if name in IN_THE_PLANE else READY
    return {"scheme": fp.MVN(), "q0": q0, "task": task, "limits": limits}


def test_a_path_without_a_duration_is_data(paths):
    path, timed = paths
    assert path.duration is None
    assert path != timed
    assert "duration" not in repr(path)
    for again in (
        eval(repr(path), vars(fp)),
        pickle.loads(pickle.dumps(path)),
        replace(path),
        from_table(to_table(path), EVERY_PATH),
    ):
        assert type(again) is type(path)
        assert again == path
        assert hash(again) == hash(path)
        assert again.duration is None


def test_a_duration_can_be_added():
    path = fp.Circle(0.1)
    assert path == fp.Circle(0.1, None)
    assert replace(path, duration=2.0) == fp.Circle(0.1, 2.0)
    assert replace(fp.Circle(0.1, 2.0), duration=None) == path
    waypoints = fp.Waypoints(CORNERS)
    assert replace(waypoints, velocity=0.1) == fp.Waypoints(CORNERS, velocity=0.1)
    assert replace(waypoints, times=[0, 1, 2, 3]).duration == 3.0
    assert fp.Waypoints(CORNERS, velocity=0.1).duration == replace(fp.Waypoints(CORNERS, velocity=0.1)).duration


def test_the_least_time_needs_no_duration(paths, arm, how):
    path, timed = paths
    run = fp.fastest(arm, path, **how)
    assert run.path == path
    assert run.max_error() < 1e-6
    of_timed = fp.fastest(arm, timed, **how)
    np.testing.assert_allclose(run.t[-1], of_timed.t[-1], atol=1.1e-3)


def test_a_tracker_lasts_the_least_time_and_the_reserve(paths, arm, how, tmp_path):
    path, _ = paths
    least = fp.fastest(arm, path, **how).t[-1]
    for reserve in (0.05, 0.3):
        run = fp.track(arm, path, **how, keep_path=True, reserve=reserve, hold=0.1)
        assert run.status.code is fp.Status.OK
        assert run.path == path
        assert run.max_error() < 1e-6
        assert run.max_orientation_error() < 1e-6
        np.testing.assert_allclose(run.t[-1] - 0.1, (1 + reserve) * least, atol=2.1e-3)
    run.save(tmp_path / "run.npz")
    loaded = fp.load(tmp_path / "run.npz")
    assert loaded == run
    assert loaded.path == path
    assert loaded.replay() == run


def test_a_constant_speed_needs_no_duration(paths, arm, how):
    at, expected = (each.at_speed(0.1, acceleration=0.5, jerk=20) for each in paths)
    assert at.duration == expected.duration
    assert eval(repr(at), vars(fp)) == at
    assert from_table(to_table(at), EVERY_PATH) == at
    for t in np.linspace(0, at.duration, 23):
        for given, wanted in zip(at.sample(t), expected.sample(t)):
            np.testing.assert_allclose(given, wanted, atol=1e-8)
    assert fp.track(arm, at, **how).t[-1] == pytest.approx(at.duration)


def test_other_functions_need_a_duration(paths, arm, how):
    path, _ = paths
    scheme, q0, task = how["scheme"], how["q0"], how["task"]
    for call in (
        lambda: path.sample(0.0),
        lambda: fp.simulate(arm, path, scheme, q0, task=task),
        lambda: fp.track(arm, path, **how),
        lambda: fp.sweep(arm, path, scheme, q0, task=task),
        lambda: fp.tune(arm, path, q0, task=task, trials=1),
        lambda: fp.start_posture(arm, path, scheme, x0=arm.forward(q0), task=task),
        lambda: fp.Tracker(arm, **how).follow(path),
    ):
        with pytest.raises(fp.ParameterError, match=NO_DURATION) as caught:
            call()
        assert caught.value.name == "path"


def test_a_stack_of_paths_without_durations():
    robot = fp.Robot.preset("two_pandas")
    q0 = [*READY, *READY]
    stack = fp.Stack([fp.PoseTask("left_tip", name="left", k=5), fp.PoseTask("right_tip", name="right", k=5)])
    paths = {"left": fp.Circle(0.1).in_plane("yz"), "right": fp.Line((0.0, 0.05, 0.1))}
    least = fp.fastest(robot, paths, fp.MVN(), q0, stack=stack)
    run = fp.track(robot, paths, fp.MVN(), q0, stack=stack, keep_path=True)
    np.testing.assert_allclose(run.t[-1], 1.05 * least.t[-1], atol=2.1e-3)
    assert max(np.abs(each).max() for each in run.errors.values()) < 1e-5
    assert run.replay() == run
    with pytest.raises(fp.ParameterError, match=NO_DURATION):
        fp.simulate(robot, paths, fp.MVN(), q0, stack=stack)
    with pytest.raises(fp.ParameterError, match=NO_DURATION):
        fp.Tracker(robot, fp.MVN(), q0, stack=stack).follow(paths["left"], task="left")
    mixed = {**paths, "right": fp.Line((0.0, 0.05, 0.1), 1.0)}
    for function in (fp.fastest, lambda *given, **options: fp.track(*given, keep_path=True, **options)):
        with pytest.raises(fp.ParameterError, match=r"path\['left'\]: has no duration, but another path has"):
            function(robot, mixed, fp.MVN(), q0, stack=stack)


def test_a_sequence_has_all_durations_or_none():
    line, slow = fp.Line([0.1, 0, 0]), fp.Line([0, 0.1, 0], 2.0)
    for paths, wrong in (((line, slow), 0), ((slow, line, slow), 1), ((slow.at_speed(1, acceleration=1), line), 1)):
        with pytest.raises(fp.ParameterError, match=rf"paths\[{wrong}\]: has no duration, but another path has"):
            fp.Sequence(paths)
    assert slow.then(line.at_speed(0.1, acceleration=0.5)).duration == pytest.approx(2.0 + 1.2)


def test_a_motion_in_the_null_space_is_planned_for_the_duration_of_the_motion():
    """A plan for another duration has other postures, at which the joints may be too slow."""
    scheme = fp.MVN(k=5, joint_centring=3.0)
    run = fp.track(PANDA, fp.Circle(0.15).in_plane("yz"), scheme, READY, keep_path=True)
    assert run.scale.min() == 1.0  # The clock is slow at the start, where the null-space motion begins with a velocity.
    assert run.max_error() < 1e-6


def test_a_kept_path_at_a_constant_speed_keeps_its_speed():
    for path in (
        fp.Circle(0.1, 1.0).in_plane("yz"),
        fp.Circle(0.1).in_plane("yz"),
        fp.Waypoints(CORNERS, times=[0, 1, 2, 4]),
        fp.Waypoints(CORNERS, velocity=1.0),
        fp.Line([0.1, 0, 0], 1.0).then(fp.Line([0, 0, 0.1], 3.0)),
    ):
        at = path.at_speed(0.05, acceleration=0.5)
        run = fp.track(PANDA, at, fp.MVN(k=5), READY, keep_path=True)
        assert 0.95 * at.duration < run.t[-1] <= at.duration  # The joints bound the ramps.
        assert np.linalg.norm(np.diff(run.x, axis=0), axis=1).max() / 1e-3 <= 0.05 * (1 + 1e-6)
        assert run.max_error() < 1e-6


def test_a_subclass_without_a_duration():
    class Ring(fp.Circle):
        def __init__(self) -> None:
            super().__init__(0.1)

    path = Ring().in_plane("yz")
    assert path.duration is None
    run = fp.fastest(PANDA, path, fp.MVN(), READY)
    assert run.t[-1] == fp.fastest(PANDA, fp.Circle(0.1).in_plane("yz"), fp.MVN(), READY).t[-1]
