"""Paths and schemes go through pickle as what they are, and copies of what they were made from."""

import copy
import pickle

import numpy as np
import pytest

import fpbm_cpp as fp

PANDA = fp.SerialArm.preset("panda")
READY = np.array([0, -0.3, 0, -2.2, 0, 2.0, 0.785])
POSES = np.tile(np.eye(4), (3, 1, 1))
POSES[1:, 0, 3] = 0.1, 0.3
POSES[1, :3, :3] = fp.rotation([0, 0.5, 0])

PATHS = {
    "circle": fp.Circle(0.45, 8.0, time_law="quintic"),
    "lissajous": fp.Lissajous((0.4, 1 / 3), 8.0, frequencies=(3, 2), phase=0.7),
    "lissajous, one amplitude": fp.Lissajous(0.4, 8.0),
    "tricuspid": fp.Tricuspid(0.1 + 0.2, 8.0, time_law="constant_speed"),
    "line": fp.Line([0.5, -1.0], 8.0),
    "line in space": fp.Line([0.5, -1.0, 1 / 7], 8.0, time_law="quintic"),
    "waypoints, timed": fp.Waypoints([[0, 0], [0.1, 0.2], [1 / 3, 0]], times=[0, 1.0, 2.5]),
    "waypoints, lasting": fp.Waypoints(np.eye(3), duration=4.0),
    "waypoints, within": fp.Waypoints(POSES, speed=0.2, acceleration=1.0, angular_velocity=2.0, angular_acceleration=3.0),
    "in a plane": fp.Circle(0.45, 8.0).in_plane("yz"),
    "in any plane": fp.Circle(0.45, 8.0).in_plane([[0, 1, 1], [1, 0, 0]]),
    "turned in the plane": fp.Circle(0.45, 8.0).with_rotation(0.3),
    "turned": fp.Line([0, 1, 2], 2.0).with_rotation(np.array([0.1, 0.2, 1 / 3]), time_law="sin_squared"),
    "one after another": fp.Line([1, 0], 1.0).then(fp.Line([0, 1, 2], 2.0)),
    "many after another": fp.Circle(0.1, 1.0).then(
        fp.Line([0, 1, 2], 2.0).then(fp.Line([0, 0, 1], 1.0).with_rotation([0, 0, 1]))
    ),
}


def again(thing):
    return pickle.loads(pickle.dumps(thing))


def expect_same_path(path, other):
    assert type(other) is type(path)
    assert repr(other) == repr(path)
    assert other.duration == path.duration
    for t in np.linspace(-0.1, path.duration + 0.1, 57):
        for here, there in zip(path.sample(t), other.sample(t)):
            assert here.tobytes() == there.tobytes()


@pytest.mark.parametrize("name", PATHS)
def test_paths(name):
    expect_same_path(PATHS[name], again(PATHS[name]))
    expect_same_path(PATHS[name], again(again(PATHS[name])))
    expect_same_path(PATHS[name], copy.deepcopy(PATHS[name]))


def options(n):
    return {
        "rest_posture": np.full(n, 1 / 3),
        "null_stiffness": 1.0,
        "c": np.full(n, 0.1),
        "joint_centring": 0.2,
        "manipulability_gain": 0.3,
        "singular_radius": 0.02,
        "singular_brake": 5.0,
    }


ELBOW = fp.SecondTask(fp.SerialArm.from_joints(PANDA.joints[:4]), [0.1, 0.2, 0.6], k1=5, k2=1 / 3)
W = np.diag(np.linspace(1, 2, 7)) + 0.1
SCHEMES = {
    "MVN": fp.MVN(),
    "MVN with all": fp.MVN(k=5.0, **options(7), second_task=ELBOW),
    "WMVN": fp.WMVN(np.linspace(1, 2, 7), k=1 / 3),
    "WMVN, dense": fp.WMVN(W, **options(7)),
    "MAN": fp.MAN(),
    "MAN with all": fp.MAN(null_damping=2.0, **options(7), second_task=fp.Gaze([0, 0.1, -1], k1=3)),
    "WMVNAcceleration": fp.WMVNAcceleration(W.tolist(), null_damping=1.0),
    "Balanced": fp.Balanced(0.4, W),
    "FPBM": fp.FPBM(1 / 3, np.linspace(1, 2, 7), 10.0, k2=25.0),
    "FPBM with all": fp.FPBM(0.6, W, k1=10, k2=25, null_damping=2, **options(7), second_task=ELBOW),
}


@pytest.mark.parametrize("name", SCHEMES)
def test_schemes(name):
    scheme, other = SCHEMES[name], again(SCHEMES[name])
    assert type(other) is type(scheme)
    assert repr(other) == repr(scheme)
    assert other.level == scheme.level
    path = fp.Circle(0.05, 0.5).in_plane("yz")
    here = fp.simulate(PANDA, path, scheme, READY, dt=0.01)
    for copied in (other, again(other), copy.deepcopy(scheme)):
        there = fp.simulate(PANDA, path, copied, READY, dt=0.01)
        assert here.q.tobytes() == there.q.tobytes()
        assert here.qdd.tobytes() == there.qdd.tobytes()


def test_second_tasks():
    assert repr(again(ELBOW)) == repr(ELBOW)
    gaze = fp.Gaze([0, 0, -1], k1=3)
    assert repr(again(gaze)) == repr(gaze)
    flat = fp.SecondTask(fp.PlanarArm([1, 1]), [0.5, 1.5])
    assert repr(again(flat)) == repr(flat)


def test_what_was_given_may_change_afterwards():
    points, weights, turn = np.eye(3), np.ones(4), np.array([0.1, 0.2, 0.3])
    path = fp.Waypoints(points, duration=1.0).with_rotation(turn)
    scheme = fp.WMVN(weights)
    x = path.sample(0.5)[0]
    points[:], weights[:], turn[:] = 7.0, -1.0, np.nan
    np.testing.assert_array_equal(again(path).sample(0.5)[0], x)
    assert repr(again(scheme)) == "WMVN(weights=[1, 1, 1, 1])"


def test_arms_of_second_tasks_may_go():
    arm = fp.SerialArm.from_joints(PANDA.joints[:4])
    task = fp.SecondTask(arm, [0.1, 0.2, 0.6])
    del arm
    assert repr(again(fp.MVN(second_task=task))) == repr(fp.MVN(second_task=task))
