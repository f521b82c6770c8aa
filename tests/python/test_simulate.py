"""Whole motions from Python: equal to a plain NumPy rollout, with clear error messages."""

import threading

import numpy as np
import pytest
import textbook

import fpbm_cpp as fp

W = [1, 2, 3, 4]


@pytest.fixture(scope="module")
def run(arm, circle, q0):
    return fp.simulate(arm, circle, fp.FPBM(0.6, W, 1, 1), q0)


def numpy_rollout(lengths, path, weights, alpha, k1, k2, q0, steps):
    """RK4 on the textbook law."""
    anchor = textbook.forward(lengths, q0)

    def f(t, state):
        q, qd = state
        x, xd, xdd = path.sample(min(t, path.duration))
        J, Jd = textbook.jacobian(lengths, q), textbook.jacobian_dot(lengths, q, qd)
        e = anchor + x - textbook.forward(lengths, q)
        b = xdd - Jd @ qd + k1 * (xd - J @ qd) + k2 * e
        return np.array([qd, textbook.acceleration(alpha, J, Jd, np.diag(weights), b, xd, np.zeros(len(q)))])

    state, h = np.array([q0, np.zeros(len(q0))]), path.duration / steps
    for i in range(steps):
        a = f(i * h, state)
        b = f(i * h + h / 2, state + h / 2 * a)
        c = f(i * h + h / 2, state + h / 2 * b)
        d = f(i * h + h, state + h * c)
        state = state + h / 6 * (a + 2 * b + 2 * c + d)
    return state


@pytest.mark.parametrize("n", [2, 4, 9, 12])
def test_steps_equal_those_of_numpy(n):
    rng = np.random.default_rng(n)
    lengths, weights, q0 = rng.uniform(0.5, 1, n), rng.uniform(1, 4, n), rng.uniform(1.0, 1.4, n)
    path = fp.Circle(0.1, 2.0)
    run = fp.simulate(fp.PlanarArm(lengths), path, fp.FPBM(0.6, weights, 1, 1), q0, dt=0.02)
    q, qd = numpy_rollout(lengths, path, weights, 0.6, 1, 1, q0, 100)
    np.testing.assert_allclose(run.q[-1], q, atol=1e-11)
    np.testing.assert_allclose(run.qd[-1], qd, atol=1e-11)


@pytest.mark.parametrize(("scheme", "dt"), [(fp.MAN(), 5e-3), (fp.FPBM(0.6, [1, 2, 3, 4], 1, 1), 2e-2)])
def test_a_step_that_is_too_long_is_reported(arm, scheme, dt):
    """The motion passes a nearly singular posture. The final error is an integration error only."""
    path, q0 = fp.Circle(1.05, 1.0), [0.3, 0.6, 0.6, 0.6]
    run = fp.simulate(arm, path, scheme, q0, dt=dt)
    assert run.status.code is fp.Status.COARSE
    assert run.status
    assert run.max_error() > 0.01
    assert f"ended, t = 1 s; the tip was up to {run.max_error():.3g} m from its path" in str(run.status)
    assert "at times, the steps are too long" in str(run.status)
    assert "Shorten dt." in str(run.status)
    fine = fp.simulate(arm, path, scheme, q0, dt=dt / 10)
    assert fine.status.code is fp.Status.OK
    assert fine.max_error() < 1e-5
    sweep = fp.sweep(arm, path, [scheme], [q0] * 20, dt=dt)
    assert (sweep.status == fp.Status.COARSE).all()
    assert (sweep.max_error == run.max_error()).all()


def test_a_run_holds_consistent_arrays(run, arm, circle, q0):
    assert run.status.ok
    assert bool(run.status)
    assert run.status.code is fp.Status.OK
    assert run.t.shape == (10001,)
    assert run.t[-1] == 10.0
    assert run.q.shape == run.qd.shape == run.qdd.shape == (10001, 4)
    assert run.x.shape == run.x_ref.shape == run.error.shape == (10001, 2)
    np.testing.assert_array_equal(run.q[0], q0)
    np.testing.assert_allclose(run.x[1234], arm.forward(run.q[1234]), atol=1e-15)
    np.testing.assert_array_equal(run.error, run.x_ref - run.x)
    np.testing.assert_allclose(run.x_ref[0] + circle.sample(3.0)[0], run.x_ref[3000], atol=1e-15)
    np.testing.assert_allclose(np.gradient(run.q, run.t, axis=0)[1:-1], run.qd[1:-1], atol=1e-6)
    np.testing.assert_allclose(np.gradient(run.qd, run.t, axis=0)[1:-1], run.qdd[1:-1], atol=1e-6)
    assert run.max_error() < 1e-12
    assert "10001 samples" in repr(run)
    assert "FPBM(alpha=0.6" in repr(run)


def test_velocity_and_acceleration_level_give_the_same_motion(arm, circle, q0):
    """Theorem 1: (7) differentiated is (9)."""
    velocity = fp.simulate(arm, circle, fp.WMVN(W), q0)
    acceleration = fp.simulate(arm, circle, fp.WMVNAcceleration(W), q0)
    np.testing.assert_allclose(velocity.q, acceleration.q, atol=1e-9)
    np.testing.assert_allclose(velocity.qd, acceleration.qd, atol=1e-9)
    np.testing.assert_allclose(velocity.qdd[1:-1], acceleration.qdd[1:-1], atol=1e-5)


def test_hold_settles_with_null_damping_only(arm, circle, q0):
    kwargs = {"q0": q0, "hold": 30.0}
    settled = fp.simulate(arm, circle, fp.FPBM(0.6, W, 1, 1, null_damping=2), **kwargs)
    drifting = fp.simulate(arm, circle, fp.FPBM(0.6, W, 1, 1), **kwargs)
    assert settled.t[-1] == 40.0
    assert np.abs(settled.qd[-1]).max() < 1e-6
    assert np.abs(drifting.qd[-1]).max() > 1e-3
    assert np.abs(drifting.q[-1] - drifting.q[10000]).max() > 0.5
    assert settled.max_error() < 1e-12
    assert drifting.max_error() < 1e-12


def test_initial_velocity(arm, q0):
    path = fp.Line([-0.3, -0.1], 1.0, time_law="constant_speed")
    qd0 = np.linalg.pinv(arm.jacobian(q0)) @ [-0.3, -0.1]
    assert fp.simulate(arm, path, fp.MAN(), q0, qd0=qd0).max_error() < 1e-12


@pytest.mark.parametrize(
    "scheme",
    [fp.MVN(), fp.WMVN(W, k=5), fp.MAN(), fp.WMVNAcceleration(W), fp.Balanced(0.5, W), fp.FPBM(0.6, W, 1, 1)],
    ids=repr,
)
def test_unreachable_path_stops_and_keeps_the_completed_part(arm, q0, scheme):
    path = fp.Line([5, 0], 5.0, time_law="quintic")
    with pytest.raises(fp.ResolutionError, match=r"stopped after t = .* at q = .*Keep the path inside") as caught:
        fp.simulate(arm, path, scheme, q0)
    kept = caught.value.run
    assert kept.status.code is caught.value.status
    assert not kept.status
    assert 0 < kept.status.time < 5.0
    assert kept.status.time == kept.t[-1]
    for array in (kept.q, kept.qd, kept.qdd, kept.x, kept.error):
        assert len(array) == len(kept.t)
        assert np.isfinite(array).all()
    assert kept.max_error() < 1e-3
    assert np.linalg.norm(kept.x_ref[-1]) > 3.9
    again = fp.simulate(arm, path, scheme, q0, partial=True)
    np.testing.assert_array_equal(again.q, kept.q)


def test_a_singular_start_has_no_samples(arm, circle):
    run = fp.simulate(arm, circle, fp.MAN(), np.zeros(4), partial=True)
    assert len(run.t) == 0
    assert run.status.code is fp.Status.SINGULAR
    assert run.max_error() == 0
    assert "stopped after t = 0 s" in str(run.status)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"dt": 0}, "dt = 0: must be positive and finite"),
        ({"dt": -1e-3}, "dt = -0.001: must be positive"),
        ({"dt": np.nan}, "dt = nan"),
        ({"dt": 0.003}, r"dt = 0.003: must be a divisor of duration = 10; the nearest is 0.0030003"),
        ({"dt": 20}, "dt = 20: must be a divisor of duration = 10; the nearest is 10"),
        ({"dt": 1e-10}, "dt = 1e-10: must be larger"),
        ({"hold": -1}, "hold = -1"),
        ({"hold": 0.0005}, "dt = 0.001: must be a divisor of hold"),
        ({"q0": [0, 0, 0]}, "q0 has 3 entries: must have 4"),
        ({"q0": [0, 0, 0, np.inf]}, r"q0\[3\] = inf: must be finite"),
        ({"qd0": [0, 0]}, "qd0 has 2 entries: must have 4"),
        ({"task": "speed"}, "task = 'speed': must be 'position' or 'pose'"),
        ({"path": fp.Line([1, 2, 3], 1.0)}, "path: is in space, and the arm is planar: must be a planar path"),
        ({"path": fp.Line([1, 2], 1.0).with_rotation(0.5)}, "path: rotates the tip, which needs task='pose'"),
        ({"path": fp.Line([1, 2, 3], 1.0).with_rotation([0, 0, 1]), "task": "pose"}, "must be a planar path"),
        ({"scheme": fp.WMVN([1, 2, 3])}, "weights has 3 entries: must have 4"),
        ({"scheme": fp.MAN(c=[0, 0])}, "c has 2 entries: must have 4"),
    ],
)
def test_bad_arguments(arm, circle, q0, change, words):
    arguments = {"path": circle, "scheme": fp.MAN(), "q0": q0} | change
    with pytest.raises(ValueError, match=words):
        fp.simulate(arm, **arguments)


def test_other_threads_run_during_a_simulation(arm, circle, q0):
    """The interpreter's lock is released: two simultaneous simulations finish and agree with a single simulation."""
    scheme = fp.FPBM(0.6, W, 1, 1)
    runs = [None, None]

    def work(i):
        runs[i] = fp.simulate(arm, circle, scheme, q0, hold=10.0)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    np.testing.assert_array_equal(runs[0].q, runs[1].q)


PANDA = fp.SerialArm.preset("panda")
READY = [0, -0.3, 0, -2.2, 0, 2.0, 0.785]


def test_a_pose_task_in_space():
    path = fp.Circle(0.1, 4.0).in_plane("yz").with_rotation([0.2, 0, 0.5])
    scheme = fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=2)
    run = fp.simulate(PANDA, path, scheme, READY, task="pose", hold=1.0)
    assert run.x.shape == run.x_ref.shape == (5001, 4, 4)
    assert run.error.shape == (5001, 6)
    assert run.positions.shape == (5001, 3)
    assert run.max_error() < 1e-9
    assert run.max_orientation_error() < 1e-9
    assert run.task == "pose"
    np.testing.assert_allclose(run.x[777], PANDA.forward(run.q[777]), atol=1e-14)
    np.testing.assert_allclose(run.x_ref[4000, :3, :3], fp.rotation([0.2, 0, 0.5]) @ run.x_ref[0, :3, :3], atol=1e-14)
    J = PANDA.jacobian(run.q[3], task="pose")
    np.testing.assert_allclose(run.manipulability()[3], np.sqrt(np.linalg.det(J @ J.T)), rtol=1e-12)


def test_a_position_task_leaves_the_orientation_free():
    run = fp.simulate(PANDA, fp.Circle(0.1, 4.0), fp.MVN(), READY)
    assert run.x.shape == (4001, 3)
    assert run.max_error() < 1e-9
    assert run.max_orientation_error() == 0.0
    assert np.abs(run.x[:, 2] - run.x[0, 2]).max() < 1e-12  # A path of the plane lies in the xy plane.


def test_fixed_and_run_time_sizes_agree():
    """Two joints at rest, which make the chain longer than any fixed size, do not change the other joints."""
    still = fp.Joint("prismatic", axis=[1, 0, 0])
    longer = fp.SerialArm.from_joints([still, still, *PANDA.joints], PANDA.tip)
    path = fp.Line([0.1, 0.1, -0.1], 1.0)
    here = fp.simulate(PANDA, path, fp.WMVN(np.ones(7)), READY, task="pose")
    there = fp.simulate(longer, path, fp.WMVN([1e12, 1e12, *np.ones(7)]), [0, 0, *READY], task="pose")
    np.testing.assert_allclose(there.q[:, 2:], here.q, atol=1e-9)


def test_a_planar_pose():
    arm = fp.PlanarArm([1, 1, 1, 1])
    run = fp.simulate(arm, fp.Circle(0.2, 3.0), fp.MVN(), [0.3, 0.9, 0.9, 0.5], task="pose")
    assert run.x.shape == (3001, 3)
    assert run.positions.shape == (3001, 2)
    assert np.abs(run.q.sum(axis=1) - 2.6).max() < 1e-12
    assert run.max_error() < 1e-9
    assert run.max_orientation_error() < 1e-12
