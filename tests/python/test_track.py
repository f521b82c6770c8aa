"""Whole motions within the joints' limits: equal to simulate() if the limits are inactive, and within the limits."""

from __future__ import annotations

import copy
import pickle
import re
import signal
import threading
from dataclasses import replace
from inspect import signature

import numpy as np
import pytest

import fpbm_cpp as fp

W = [1, 2, 3, 4]
PANDA = fp.SerialArm.preset("panda")
BENT = np.array([0.0, -0.3, 0.0, -1.8, 0.0, 1.6, 0.8])
SMOOTH = fp.Circle(0.2, 2.0, time_law="quintic")
TIGHT = fp.JointLimits(lower=[-3] * 4, upper=[3] * 4, velocity=[0.1] * 4, acceleration=[1] * 4)

FREE = {
    "planar, acceleration level": (fp.PlanarArm([1, 1, 1, 1]), SMOOTH, fp.FPBM(0.6, W, 10, 25), "position"),
    "planar, velocity level": (fp.PlanarArm([1, 1, 1, 1]), SMOOTH, fp.WMVN(W, k=5), "position"),
    "planar pose held": (fp.PlanarArm([1, 1, 1, 1]), SMOOTH, fp.MVN(k=5), "pose"),
    "planar pose turned": (fp.PlanarArm([1, 1, 1, 1]), SMOOTH.with_rotation(0.4), fp.MVN(k=5), "pose"),
    "space, path of the plane": (PANDA, fp.Circle(0.1, 2.0, time_law="quintic"), fp.MVN(k=5), "position"),
    "space, pose held": (PANDA, fp.Line([0, 0.1, 0.1], 2.0, time_law="quintic"), fp.MVN(k=5), "pose"),
    "space, pose turned": (
        PANDA,
        fp.Circle(0.1, 2.0, time_law="quintic").in_plane("yz").with_rotation([0.2, 0, 0.5]),
        fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=2),
        "pose",
    ),
}


@pytest.mark.parametrize("case", FREE)
def test_without_limits_track_follows_simulate(case):
    """Up to the error of a tick, which is not a step of RK4: terms of dt squared, and of dt in the null space."""
    arm, path, scheme, task = FREE[case]
    start = BENT if arm is PANDA else [0.3, 0.9, 0.9, 0.5]
    none = np.full(arm.dof, np.inf)
    bounds = fp.JointLimits(lower=-none, upper=none, velocity=none, acceleration=none)
    here = fp.track(arm, path, scheme, start, task=task, hold=0.5, limits=bounds, null_damping=0)
    there = fp.simulate(arm, path, scheme, start, task=task, hold=0.5)
    assert here.status.code is fp.Status.OK
    for name in ("t", "q", "qd", "x", "x_ref", "error"):
        assert getattr(here, name).shape == getattr(there, name).shape
    np.testing.assert_array_equal(here.t, there.t)
    # At velocity level, the velocity of a state is the velocity of the previous tick.
    tolerance = 1e-3 if scheme.level == "acceleration" else 1e-3 * np.abs(there.qdd).max()
    np.testing.assert_allclose(here.q, there.q, rtol=0, atol=5e-4)
    np.testing.assert_allclose(here.qd, there.qd, rtol=0, atol=tolerance)
    np.testing.assert_allclose(here.x_ref, there.x_ref, atol=1e-12)
    np.testing.assert_allclose(here.x, there.x, rtol=0, atol=2e-7)
    assert here.max_error() < 2e-7
    assert here.max_orientation_error() < 2e-7
    assert (here.scale == 1).all()
    assert not here.saturated.any()


def test_a_sample_is_the_state_before_its_tick(q0):
    """Sample k is the tracker's state before tick k, and the status of tick k."""
    arm, scheme = fp.PlanarArm([1, 1, 1, 1]), fp.FPBM(0.6, W, 10, 25, null_damping=2)
    run = fp.track(arm, fp.Circle(0.45, 2.0), scheme, q0, dt=0.01, hold=0.1, limits=TIGHT, error_bound=0.05)
    tracker = fp.Tracker(arm, scheme, q0, dt=0.01, limits=TIGHT, error_bound=0.05)
    follower = tracker.follow(fp.Circle(0.45, 2.0))
    assert len(run.t) == 211
    for k in range(len(run.t)):
        np.testing.assert_array_equal(run.q[k], tracker.q)
        np.testing.assert_array_equal(run.qd[k], tracker.qd)
        tick = tracker.tick(follower)
        np.testing.assert_array_equal(run.qdd[k], tick.qdd)
        np.testing.assert_array_equal(run.error[k], tick.error)
        np.testing.assert_array_equal(run.saturated[k], tick.saturated)
        assert run.scale[k] == tick.scale
    np.testing.assert_allclose(run.x[77], arm.forward(run.q[77]), atol=1e-15)
    np.testing.assert_allclose(run.error, run.x_ref - run.x, atol=1e-14)
    np.testing.assert_allclose(np.diff(run.qd, axis=0), 0.01 * run.qdd[:-1], atol=1e-12)


def test_limits_are_kept_and_reported(q0):
    arm, scheme = fp.PlanarArm([1, 1, 1, 1]), fp.FPBM(0.6, W, 10, 25, null_damping=2)
    run = fp.track(arm, fp.Circle(0.45, 5.0), scheme, q0, hold=1.0, limits=TIGHT)
    assert run.status.code is fp.Status.SLOWED
    assert run.status.ok
    assert "slow the path" in str(run.status)
    assert np.abs(run.qd).max() <= 0.1 + 1e-12
    assert np.abs(run.qdd).max() <= 1 + 1e-9
    assert 0 <= run.scale.min() < 0.2
    assert run.saturated.any(axis=0).all()
    assert run.saturated.dtype == bool
    free = fp.simulate(arm, fp.Circle(0.45, 5.0), scheme, q0)
    assert np.abs(free.qd).max() > 0.2


def test_a_singular_posture_is_crossed():
    """Stretched out, where simulate() stops immediately."""
    arm = fp.PlanarArm([1, 1, 1, 1])
    assert fp.track(arm, SMOOTH, fp.MAN(), np.zeros(4)).status.code is fp.Status.DAMPED
    stuck = fp.track(arm, SMOOTH, fp.MAN(), np.zeros(4), singular_radius=0)
    assert stuck.status.code is fp.Status.SINGULAR
    assert not stuck.status
    assert (stuck.scale == 0).all()
    assert (stuck.qd == 0).all()


def test_options_reproduce_the_run(q0):
    arm, scheme = fp.PlanarArm([1, 1, 1, 1]), fp.FPBM(0.6, W, 10, 25)
    given = {
        "dt": 0.01,
        "hold": 0.5,
        "qd0": [0.01, 0.0, 0.0, 0.0],
        "limits": TIGHT,
        "error_bound": 0.05,
        "integral_gain": 1.0,
        "integral_bound": 0.5,
        "stall_time": 0.3,
        "singular_radius": 0.03,
        "singular_brake": 5.0,
        "null_damping": 3.0,
        "bounds": (
            fp.Clearance([fp.Capsule(4, [0, 0, 0], [1, 0, 0], 0.1)], [fp.HalfSpace([0, 1, 0], -3)]),
            fp.TaskBounds(fp.PositionTask(rows=("x",)), upper=5),
        ),
        "recover_start": False,
        "keep_path": False,
        "reserve": 0.05,
        "stack": None,
    }
    run = fp.track(arm, SMOOTH, scheme, q0, **given)
    assert run.options == given
    assert given.keys() | {"task"} == {name for name in signature(fp.track).parameters} - {
        "arm",
        "path",
        "scheme",
        "q0",
    }
    assert fp.track(arm, SMOOTH, scheme, q0, **run.options) == run
    others = {
        "error_bound": 0.01,
        "integral_gain": 2.0,
        "singular_radius": 0.5,
        "null_damping": 0.0,
        "qd0": np.zeros(4),
    }
    for name, other in others.items():
        assert fp.track(arm, SMOOTH, scheme, q0, **{**given, name: other}) != run, name


@pytest.mark.parametrize("function", [fp.track, fp.sweep], ids=["track", "sweep"])
def test_defaults_equal_those_of_the_tracker(function):
    defaults = dict(re.findall(r"(\w+): [^,]*? = ([\d.]+)", fp.Tracker.__init__.__doc__))
    own = {name: parameter.default for name, parameter in signature(function).parameters.items()}
    del defaults["measured_delay"]  # Neither function resolves measured states.
    assert {
        "dt",
        "error_bound",
        "integral_gain",
        "integral_bound",
        "stall_time",
        "singular_radius",
        "singular_brake",
        "null_damping",
    } <= defaults.keys()
    assert {name: float(value) for name, value in defaults.items()} == {name: own[name] for name in defaults}


def test_pickle_keeps_the_limits(q0):
    run = fp.track(fp.PlanarArm([1, 1, 1, 1]), SMOOTH, fp.MVN(), q0, dt=0.01, limits=TIGHT)
    for other in (pickle.loads(pickle.dumps(run)), copy.deepcopy(run)):
        assert other == run
        assert repr(other.options["limits"]) == repr(TIGHT)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"dt": 0}, "dt = 0: must be positive and finite"),
        ({"dt": 0.3}, "dt = 0.3: must be a divisor of duration = 2; the nearest is"),
        ({"dt": 1e-10}, "dt = 1e-10: must be larger"),
        ({"hold": -1}, "hold = -1"),
        ({"q0": [0, 0, 0]}, "q0 has 3 entries: must have 4"),
        ({"q0": [0, 0, 0, np.inf]}, r"q0\[3\] = inf: must be finite"),
        ({"q0": [4, 0, 0, 0], "limits": TIGHT}, r"q0\[0\] = 4: must be within"),
        ({"qd0": [0, 0]}, "qd0 has 2 entries: must have 4"),
        ({"task": "speed"}, "task = 'speed': must be 'position' or 'pose'"),
        ({"path": fp.Line([1, 2, 3], 1.0)}, "path: is in space, and the arm is planar: must be a planar path"),
        ({"scheme": fp.WMVN([1, 2, 3])}, "weights has 3 entries: must have 4"),
        ({"error_bound": -1}, "error_bound = -1: must be positive"),
        ({"integral_gain": -1}, "integral_gain = -1"),
        ({"singular_radius": 2}, "singular_radius = 2"),
        ({"null_damping": -1}, "null_damping = -1"),
        ({"scheme": fp.FPBM(0.6, W, 500, 25), "dt": 0.01}, "k1 = 500: must be at most 27.* at a tick of 0.01 s"),
        ({"limits": fp.SerialArm.preset("panda").limits}, "limits has 7 entries"),
    ],
)
def test_bad_arguments(arm, q0, change, words):
    with pytest.raises(ValueError, match=words):
        fp.track(arm, **{"path": SMOOTH, "scheme": fp.MAN(), "q0": q0, **change})


def test_a_missing_limit_is_named():
    arm = replace(PANDA, joints=[replace(joint, acceleration=np.inf) for joint in PANDA.joints])
    with pytest.raises(ValueError, match=r"limits.acceleration\[0\] = inf: must be finite"):
        fp.track(arm, SMOOTH.in_plane("xy"), fp.MAN(), BENT)


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_ends_a_motion(arm, q0):
    timer = threading.Timer(0.2, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        fp.track(arm, fp.Circle(0.2, 1000.0), fp.FPBM(0.6, W, 10, 25), q0)
    timer.join()
