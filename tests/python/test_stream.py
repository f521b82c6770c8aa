"""Streams of postures and poses from Python: chunks, single points, trackers with bounds, and bad input."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import fpbm_cpp as fp

DT = 1e-3
Q0 = np.array([0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785])


@pytest.fixture(scope="module")
def panda():
    return fp.SerialArm.preset("panda")


def motion(seconds):
    """Postures of a smooth motion, one row for each time."""
    phase = np.pi * np.atleast_1d(seconds)[:, None] + 0.3 * np.arange(7)
    return Q0 + 0.2 * (np.cos(0.3 * np.arange(7)) - np.cos(phase))


def largest_shares(q, limits):
    """Largest velocity, acceleration and jerk of commands by differences, relative to their bounds."""
    bounds = (limits.velocity, limits.acceleration, limits.jerk)
    return [float(np.max(np.abs(np.diff(q, n, axis=0)) / DT**n / bounds[n - 1])) for n in (1, 2, 3)]


def chunk(random, q, t):
    """A chunk of a policy that was computed up to 0.3 s ago and is anchored up to 70 mrad from the reference q."""
    late = random.uniform(0.0, 0.3)
    count = int(random.integers(10, 50))
    postures = motion(t - late + 0.02 * np.arange(count))
    return {"postures": postures + random.uniform(-0.07, 0.07, 7), "stamp": t - late, "period": 0.02}


def test_chunks_with_all_faults_keep_the_bounds(panda):
    random = np.random.default_rng(1)
    stream = fp.JointStream(panda, Q0, start=0.0)
    commands, rejected = [], 0
    for tick in range(20_000):
        if random.uniform() < 0.01:
            given = chunk(random, stream.q, tick * DT)
            fault = random.uniform()
            if fault < 0.1:
                given["postures"][2, 3] = np.nan
            elif fault < 0.2:
                with pytest.raises(fp.ParameterError, match="must have shape"):
                    stream.push_chunk(given["postures"][:, :6], period=0.02)
                continue
            elif fault < 0.3:
                assert stream.push_chunk(**given) in (True, False)  # Then doubled.
            rejected += not stream.push_chunk(**given)
        stream.advance()
        commands.append(stream.q)
    assert rejected > 20
    assert max(largest_shares(np.array(commands), panda.limits)) <= 1 + 1e-6  # Round-off of third differences.
    assert np.all(np.array(commands) <= panda.limits.upper)
    assert np.all(np.array(commands) >= panda.limits.lower)


@pytest.mark.parametrize("jump", [0.02, 0.07, 0.5])
def test_a_jump_needs_ruckig_s_time(panda, jump):
    ruckig = pytest.importorskip("ruckig")
    limits = panda.limits
    problem = ruckig.InputParameter(7)
    problem.current_position, problem.current_velocity, problem.current_acceleration = Q0, np.zeros(7), np.zeros(7)
    problem.target_position, problem.target_velocity = Q0 + jump, np.zeros(7)
    problem.max_velocity, problem.max_acceleration, problem.max_jerk = limits.velocity, limits.acceleration, limits.jerk
    trajectory = ruckig.Trajectory(7)
    ruckig.Ruckig(7).calculate(problem, trajectory)
    stream = fp.JointStream(panda, Q0, start=0.0)
    assert stream.push_chunk([Q0 + jump], period=0.02, stamp=0.0)
    ticks = 0
    while np.any(stream.gap != 0.0):
        stream.advance()
        ticks += 1
    print(f"jump of {jump} rad: {ticks * DT:.3f} s, Ruckig {trajectory.duration:.3f} s")
    assert ticks * DT <= trajectory.duration + 2 * DT


def test_given_velocities_and_times(panda):
    stream = fp.JointStream(panda, Q0, start=0.0)
    times = np.cumsum(np.r_[0.0, np.random.default_rng(2).uniform(0.01, 0.05, 39)])
    velocities = 0.2 * np.pi * np.sin(np.pi * times[:, None] + 0.3 * np.arange(7))
    assert stream.push_chunk(motion(times), times=times, stamp=0.0, velocities=velocities)
    for _ in range(600):
        stream.advance()
    np.testing.assert_allclose(stream.q, motion(0.6)[0], atol=1e-6)
    assert stream.age == pytest.approx(0.6)
    with pytest.raises(fp.ParameterError, match=r"times\[1\] = 0: must be greater than times\[0\]"):
        stream.push_chunk(motion([0, 1]), times=[0, 0])
    with pytest.raises(fp.ParameterError, match=r"velocities: must have shape \(2, 7\), got \(2, 6\)"):
        stream.push_chunk(motion([0, 1]), period=0.02, velocities=np.zeros((2, 6)))
    with pytest.raises(fp.ParameterError, match="period or times must be given"):
        stream.push_chunk(motion([0, 1]))


def test_degrees_are_refused_and_the_motion_goes_on(panda):
    stream = fp.JointStream(panda, Q0, start=0.0)
    assert stream.push_chunk(motion(0.02 * np.arange(50)), period=0.02, stamp=0.0)
    with pytest.raises(fp.ParameterError, match=r"postures\[0\]\[1\] = -17.18.*range of panda_joint2.*radians"):
        stream.push_chunk(np.degrees(motion(0.02 * np.arange(50))), period=0.02, stamp=0.1)
    for _ in range(500):
        stream.advance()
    np.testing.assert_allclose(stream.q, motion(0.5)[0], atol=1e-6)


def test_a_tracker_keeps_a_clearance_and_torques(panda):
    """A policy that moves the arm through a table: with bounds, the arm stays above it."""
    limits = panda.limits
    reserve = replace(limits, acceleration=0.95 * limits.acceleration, jerk=0.95 * limits.jerk)
    table = fp.HalfSpace([0, 0, 1], 0.1, name="table")
    own = fp.Clearance.preset("panda")
    allowed = [*own.allowed, *(("table", f"panda_link{link}") for link in range(3))]  # The base stands on the table.
    clearance = replace(own, obstacles=[table], margin=0.02, allowed=allowed)
    stack = fp.Stack([fp.PostureTask(k1=40, k2=400)])
    scheme = fp.FPBM(0.6, np.ones(7), 0, 0)
    tracker = fp.Tracker(panda, scheme, Q0, stack=stack, bounds=[clearance, fp.TorqueBounds(fraction=0.9)])
    stream = fp.JointStream(panda, Q0, limits=reserve, start=0.0)
    down = Q0 + np.array([0.0, 1.3, 0.0, 0.6, 0.0, 0.0, 0.0])
    commands, nearest = [], np.inf
    for tick in range(4000):
        if tick % 400 == 0 and tick <= 2000:
            target = down if tick < 2000 else Q0
            share = np.linspace(0, 1, 50)[:, None] ** 2 * (3 - 2 * np.linspace(0, 1, 50)[:, None])
            stream.push_chunk(stream.q + share * (target - stream.q), period=0.02, stamp=tick * DT)
        state = tracker.tick(stream)
        commands.append(state.q)
        nearest = min(nearest, state.nearest.distance)
    assert nearest >= 0.02 - 1e-9
    assert max(largest_shares(np.array(commands), limits)) <= 1 + 1e-6
    np.testing.assert_allclose(commands[-1], Q0, atol=1e-3)


@pytest.mark.parametrize("level", ["velocity", "acceleration"])
@pytest.mark.parametrize("dt", [1e-3, 4e-3, 0.01])
@pytest.mark.parametrize("name", ["panda", "so101", "two_pandas"])
def test_a_tracker_follows_overlapping_chunks(name, dt, level):
    arm = fp.Robot.preset(name) if name == "two_pandas" else fp.SerialArm.preset(name)
    limits, n = arm.limits, arm.dof
    if not np.isfinite(limits.jerk).all():
        limits = replace(limits, jerk=50 * limits.acceleration)
    q0 = np.clip(np.resize(Q0, n), 0.8 * limits.lower, 0.8 * limits.upper)
    size = 0.02 * np.minimum(limits.acceleration, 10.0)

    def postures(seconds):
        return q0 + size * (1 - np.cos(2 * np.atleast_1d(seconds)[:, None] * (1 + np.arange(n) / n)))

    task = fp.PostureTask(k1=20, k2=100) if level == "acceleration" else fp.PostureTask(k1=20)
    scheme = fp.FPBM(0.6, np.ones(n), 0, 0) if level == "acceleration" else fp.MVN()
    tracker = fp.Tracker(arm, scheme, q0, stack=fp.Stack([task]), limits=limits, dt=dt)
    reserve = replace(limits, acceleration=0.95 * limits.acceleration, jerk=0.95 * limits.jerk)
    stream = fp.JointStream(arm, q0, limits=reserve, dt=dt, start=0.0)
    commands, error = [q0, q0, q0], 0.0
    for k in range(round(3 / dt)):
        if k % round(0.4 / dt) == 0:
            stamp = k * dt - 0.1
            assert stream.push_chunk(postures(stamp + 0.05 * np.arange(20)), period=0.05, stamp=stamp)
        commands.append(tracker.tick(stream).q)
        error = max(error, float(np.abs(commands[-1] - stream.q).max()))
    for order, bound in enumerate((limits.velocity, limits.acceleration, limits.jerk), 1):
        assert np.max(np.abs(np.diff(commands, order, axis=0)) / dt**order / bound) <= 1 + 1e-6
    assert error <= 1e-4
    np.testing.assert_allclose(commands[-1], postures(len(commands[3:]) * dt)[0], atol=3e-4)


def test_the_velocity_envelopes_of_an_fr3():
    """A posture beside the upper ends: the bounds on velocity decrease toward the ends."""
    arm = fp.SerialArm.preset("fr3")
    limits = arm.limits
    stream = fp.JointStream(arm, Q0, start=0.0)
    assert stream.push_chunk([limits.upper - 0.02], period=0.02)
    q, qd = [], []
    while np.any(stream.gap != 0.0):
        stream.advance()
        q.append(stream.q)
        qd.append(stream.qd)
    most = np.sqrt(2 * limits.deceleration * (limits.upper - np.array(q))) - limits.velocity_offset
    assert np.all(qd <= most + 1e-6)
    assert np.max(np.array(qd) / most) > 0.8
    assert len(q) < 8000


def test_a_blend_is_gentle(panda):
    """Chunks that are alternately 1 mrad apart."""
    largest = []
    for blend in (0.0, 0.2):
        stream = fp.JointStream(panda, Q0, blend=blend, start=0.0)
        accelerations = []
        for tick in range(3000):
            if tick % 400 == 0:
                postures = motion(tick * DT + 0.02 * np.arange(50)) + 1e-3 * (tick % 800 > 0)
                assert stream.push_chunk(postures, period=0.02, stamp=tick * DT)
            stream.advance()
            accelerations.append(stream.qdd)
        largest.append(np.abs(accelerations[1000:]).max())
    assert largest[0] > 5.0
    assert largest[1] < 1.1 * 0.2 * np.pi**2  # The acceleration of the motion.


def test_a_pose_stream_of_a_tracker(panda):
    stack = fp.Stack([fp.PoseTask(k1=20, k2=100, name="hand")])
    tracker = fp.Tracker(panda, fp.FPBM(0.6, np.ones(7), 0, 0), Q0, stack=stack)
    start = tracker.frame("hand")
    stream = fp.PoseStream(
        start, velocity=0.5, acceleration=3, jerk=100, angular_velocity=1.5, angular_acceleration=8, angular_jerk=300
    )
    poses = np.repeat(start[None], 50, axis=0)
    poses[:, 0, 3] += 0.1 * np.linspace(0, 1, 50)
    assert stream.push_chunk(poses, period=0.02)
    for _ in range(3000):
        tick = tracker.tick({"hand": stream})
    np.testing.assert_allclose(stream.x, poses[-1], atol=1e-12)
    assert np.abs(tick.error).max() < 1e-5
    with pytest.raises(fp.ParameterError, match="is for another task"):
        tracker.tick({"hand": fp.JointStream(panda, Q0)})
    tracker = fp.Tracker(panda, fp.FPBM(0.6, np.ones(7), 0, 0), Q0, stack=stack, dt=2e-3)
    with pytest.raises(fp.ParameterError, match="the tracker's dt"):
        tracker.tick({"hand": stream})


def test_bad_arguments(panda):
    with pytest.raises(fp.ParameterError, match=r"q0\[0\] = 4: must be from -2.8973 to 2.8973"):
        fp.JointStream(panda, np.full(7, 4.0))
    with pytest.raises(fp.ParameterError, match="delay = -1"):
        fp.JointStream(panda, Q0, delay=-1.0)
    with pytest.raises(fp.ParameterError, match="blend = -1"):
        fp.JointStream(panda, Q0, blend=-1.0)
    with pytest.raises(fp.ParameterError, match="dt = 0"):
        fp.JointStream(panda, Q0, dt=0.0)
    stream = fp.JointStream(panda, Q0)
    assert not stream.push(np.full(7, np.nan))
    with pytest.raises(fp.ParameterError, match=r"q: must have shape \(7,\), got \(6,\)"):
        stream.push(np.zeros(6))
    with pytest.raises(fp.ParameterError, match="fraction = 2"):
        stream.set_speed(2.0)
    tracker = fp.Tracker(panda, fp.FPBM(0.6, np.ones(7), 10, 25), Q0)
    with pytest.raises(fp.ParameterError, match="in a dictionary by task name, to a tracker of a stack"):
        tracker.tick(stream)
