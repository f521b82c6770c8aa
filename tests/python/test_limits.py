"""Bounds up to jerk: the limiter from Python, and Ruckig as an oracle for stops."""

import numpy as np
import pytest

import fpbm_cpp as fp

DT = 1e-3


def random_joints(rng, n):
    """Bounds whose jerk takes 3 ms to 0.3 s to bring an acceleration to its bound, and states of joints within them."""
    acceleration = rng.uniform(1, 30, n)
    jerk = acceleration * 10 ** rng.uniform(0.5, 2.5, n)
    limits = fp.JointLimits(
        lower=-rng.uniform(0.5, 3, n),
        upper=rng.uniform(0.5, 3, n),
        velocity=rng.uniform(0.3, 3, n),
        acceleration=acceleration,
        jerk=jerk,
    )
    qdd = rng.uniform(-1, 1, n) * np.minimum(acceleration, 0.99 * np.sqrt(2 * jerk * limits.velocity))
    slack = limits.velocity - qdd**2 / (2 * jerk)
    return limits, rng.uniform(-1, 1, n) * slack, qdd


def quickest_stop(ruckig, qd, qdd, acceleration, jerk):
    """Duration and distance of a stop, by Ruckig."""
    given = ruckig.InputParameter(1)
    given.control_interface = ruckig.ControlInterface.Velocity
    given.current_position, given.current_velocity, given.current_acceleration = [0.0], [qd], [qdd]
    given.target_velocity, given.target_acceleration = [0.0], [0.0]
    given.max_acceleration, given.max_jerk = [acceleration], [jerk]
    trajectory = ruckig.Trajectory(1)
    assert ruckig.Ruckig(1).calculate(given, trajectory) in (ruckig.Result.Working, ruckig.Result.Finished)
    extrema = trajectory.position_extrema[0]
    return trajectory.duration, extrema.min, extrema.max


def test_a_stop_lasts_at_most_a_tick_longer_than_that_of_ruckig():
    ruckig = pytest.importorskip("ruckig", reason="Ruckig is not installed")
    rng = np.random.default_rng(1)
    n, late, count = 32, [], 0
    for _ in range(320):
        limits, qd, qdd = random_joints(rng, n)
        free = fp.JointLimits(
            lower=np.full(n, -1e3),
            upper=np.full(n, 1e3),
            velocity=np.full(n, 1e3),
            acceleration=limits.acceleration,
            jerk=limits.jerk,
        )
        limiter = fp.Limiter(free, DT)
        least = [quickest_stop(ruckig, *state)[0] for state in zip(qd, qdd, limits.acceleration, limits.jerk)]
        q, ticks = np.zeros(n), np.zeros(n)
        for tick in range(1, 40000):
            qdd = limiter.brake(q, qd, last=qdd).u
            q, qd = q + DT * (qd + DT / 2 * qdd), qd + DT * qdd
            moving = (np.abs(qd) > 1e-12) | (np.abs(qdd) > 1e-9)
            ticks[moving] = tick + 1
            if not moving.any():
                break
        late.append(ticks - np.ceil(np.array(least) / DT))
        count += n
    print(f"{count} stops: at most {np.max(late):g} ticks longer than Ruckig's")
    assert np.max(late) <= 1


def test_states_are_accepted_if_ruckig_can_stop_them_with_slack():
    ruckig = pytest.importorskip("ruckig", reason="Ruckig is not installed")
    rng = np.random.default_rng(2)
    arm = fp.PlanarArm([0.5, 0.5])
    scheme = fp.MAN()
    stopped = rejected = 0
    for _ in range(10000):
        limits, qd, qdd = random_joints(rng, 2)
        q = rng.uniform(limits.lower, limits.upper)
        lowest, highest, slack = np.zeros(2), np.zeros(2), np.zeros(2)
        for i in range(2):
            _, low, high = quickest_stop(ruckig, qd[i], qdd[i], limits.acceleration[i], limits.jerk[i])
            lowest[i], highest[i] = q[i] + low - limits.lower[i], limits.upper[i] - q[i] - high
            fastest = max(abs(qd[i]), abs(qd[i] + qdd[i] * abs(qdd[i]) / (2 * limits.jerk[i])))
            slack[i] = 2 * limits.acceleration[i] / limits.jerk[i] * fastest
        try:
            fp.Tracker(arm, scheme, q, qd0=qd, qdd0=qdd, limits=limits)
            accepted = True
        except fp.ParameterError:
            accepted = False
        if np.any(np.minimum(lowest, highest) < -1e-9):
            assert not accepted
        elif np.all(np.minimum(lowest, highest) > slack):
            assert accepted
        stopped += 1
        rejected += not accepted and bool(np.all(np.minimum(lowest, highest) > 0))
    print(f"{stopped} states: {rejected} rejected that Ruckig can stop, each within the slack of the braking envelope")


def test_the_limiter_equals_that_of_the_tracker():
    rng = np.random.default_rng(3)
    arm = fp.SerialArm.preset("panda")
    q, qd, last = np.array([0.0, -0.3, 0.0, -1.8, 0.0, 1.6, 0.8]), np.zeros(7), np.zeros(7)
    limiter = fp.Limiter(arm.limits, DT)
    for _ in range(500):
        J = arm.jacobian(q, task="pose")
        desired = rng.uniform(-60, 60, 7)
        motion = limiter.motion(J, q, qd, desired, last=last)
        assert 0.0 <= motion.scale <= 1.0
        assert motion.saturated.shape == (7,)
        assert (np.abs(motion.u) <= arm.limits.acceleration * (1 + 1e-12)).all()
        assert (np.abs(motion.u - last) <= arm.limits.jerk * DT * (1 + 1e-12)).all()
        q, qd, last = q + DT * (qd + DT / 2 * motion.u), qd + DT * motion.u, motion.u
        assert (np.abs(qd) <= arm.limits.velocity + 1e-12).all()
        assert (q >= arm.limits.lower).all()
        assert (q <= arm.limits.upper).all()
    unhindered = limiter.motion(J, np.array([0.0, -0.3, 0.0, -1.8, 0.0, 1.6, 0.8]), np.zeros(7), np.full(7, 0.1))
    np.testing.assert_array_equal(unhindered.u, np.full(7, 0.1))
    assert unhindered.scale == 1.0


@pytest.mark.parametrize("level", ["acceleration", "velocity"])
def test_rows_are_kept_and_the_task_if_the_null_space_suffices(level):
    rng = np.random.default_rng(4)
    n = 7
    limits = fp.JointLimits(lower=[-3] * n, upper=[3] * n, velocity=[50] * n, acceleration=[1e5] * n)
    limiter, rest = fp.Limiter(limits, DT, level=level), np.zeros(n)
    missed = []
    for p in rng.integers(1, 4, 200):
        J, G, desired = rng.normal(size=(3, n)), rng.normal(size=(p, n)), rng.normal(size=n)
        b = G @ desired + rng.normal(size=p)
        free = limiter.motion(J, rest, rest, desired)
        there = np.maximum(b, 0.1)
        kept = limiter.motion(J, rest, rest, desired, rows=(G, there))
        assert (G @ kept.u <= there + 1e-9).all()
        if (G @ desired <= there).all():
            assert kept.u.tobytes() == free.u.tobytes()
        elif kept.scale == 1:
            missed.append(np.linalg.norm(J @ (kept.u - desired)) / np.linalg.norm(J @ desired))
    assert len(missed) > 50
    assert np.max(missed) < 5e-3  # Self-motion has a cost, so that it stays bounded if J and G are almost dependent.


def test_velocities_are_limited_too():
    limits = fp.JointLimits(lower=[-1, -1, -1], upper=[1, 1, 1], velocity=[1, 1, 1], acceleration=[5, 5, 5])
    limiter = fp.Limiter(limits, DT, level="velocity")
    motion = limiter.motion(np.ones((1, 3)), np.zeros(3), np.zeros(3), np.full(3, 2.0))
    np.testing.assert_allclose(motion.u, np.full(3, 0.005), rtol=1e-12)
    np.testing.assert_array_equal(limiter.brake(np.zeros(3), np.full(3, 0.5)).u, np.full(3, 0.495))


def with_rows(limits, G, b):
    return fp.Limiter(limits, DT).motion(np.ones((1, 2)), [0, 0], [0, 0], [1, 1], rows=(G, b))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda limits: fp.Limiter(limits, 0.0), "dt = 0: must be positive"),
        (lambda limits: fp.Limiter(limits, DT, level="torque"), "level = 'torque': must be 'acceleration' or"),
        (lambda limits: fp.Limiter(limits, DT).motion(np.ones((3, 2)), [0, 0], [0, 0], [1, 1]), "number of rows = 3"),
        (lambda limits: fp.Limiter(limits, DT).motion(np.ones((1, 3)), [0, 0], [0, 0], [1, 1]), "J: must have shape"),
        (lambda limits: fp.Limiter(limits, DT).brake([0], [0, 0]), "q has 1 entries"),
        (lambda limits: with_rows(limits, np.ones((1, 3)), [1]), r"rows\[0\]: must have shape \(1, 2\)"),
        (lambda limits: with_rows(limits, np.ones((2, 2)), [1]), r"rows\[1\]'s number of entries = 1: must be one for"),
        (lambda limits: with_rows(limits, np.ones((17, 2)), np.ones(17)), "number of rows = 17: must be at most 16"),
        (lambda limits: with_rows(limits, np.ones((1, 2)), [np.inf]), r"rows\[1\]\[0\] = inf: must be finite"),
    ],
)
def test_bad_calls(make, words):
    limits = fp.JointLimits(lower=[-1, -1], upper=[1, 1], velocity=[1, 1], acceleration=[5, 5], jerk=[50, 50])
    with pytest.raises(fp.ParameterError, match=words):
        make(limits)


def test_a_tracker_continues_from_the_state_of_another():
    arm = fp.SerialArm.preset("panda")
    scheme = fp.FPBM(0.6, np.ones(7), 20, 100, null_damping=2)
    first = fp.Tracker(arm, scheme, [0.0, -0.3, 0.0, -1.8, 0.0, 1.6, 0.8])
    target = first.tip + np.array([0.2, 0.1, -0.1])
    for _ in range(60):
        first.tick(target)
    second = fp.Tracker(arm, scheme, first.q, qd0=first.qd, qdd0=first.qdd)
    for _ in range(100):
        # A tracker also stores the change of the acceleration in the last tick, which is 0 at a start.
        np.testing.assert_allclose(first.tick(target).q, second.tick(target).q, rtol=0, atol=1e-7)
