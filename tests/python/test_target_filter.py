"""The filter of targets from Python: compared with Ruckig's minimum time, for a stream, and for invalid messages."""

from __future__ import annotations

import numpy as np
import pytest

import fpbm_cpp as fp

DT = 1e-3
LINEAR = {"velocity": 0.5, "acceleration": 3.0, "jerk": 100.0}
ANGULAR = {"angular_velocity": 1.5, "angular_acceleration": 8.0, "angular_jerk": 300.0}


def moved(target_filter, ticks):
    """x, xd and xdd at the start of each tick, and at the end."""
    states = [(target_filter.x, target_filter.xd, target_filter.xdd)]
    for _ in range(ticks):
        target_filter.advance()
        states.append((target_filter.x, target_filter.xd, target_filter.xdd))
    return (np.array(column) for column in zip(*states))


def assert_within(x, xd, xdd, *, velocity, acceleration, jerk):
    """Bounds on each column, jerk by differences of the acceleration and by third differences of the position."""
    assert np.abs(xd).max() <= velocity * (1 + 1e-12)
    assert np.abs(xdd).max() <= acceleration * (1 + 1e-12)
    assert np.abs(np.diff(xdd, axis=0)).max(initial=0) <= jerk * DT * (1 + 1e-9)
    # Tolerances: the last step to the target, a millionth of the displacement in a tick, and the round-off error.
    size = np.abs(x).max()
    assert np.abs(np.diff(x, 3, axis=0)).max(initial=0) <= jerk * DT**3 * (1 + 1e-5) + 8e-16 * size


def shortest(ruckig, x, xd, xdd, target, bounds):
    """Duration of Ruckig's motion to a target at rest [s]."""
    problem = ruckig.InputParameter(1)
    problem.current_position, problem.current_velocity, problem.current_acceleration = [x], [xd], [xdd]
    problem.target_position, problem.target_velocity, problem.target_acceleration = [target], [0.0], [0.0]
    problem.max_velocity, problem.max_acceleration, problem.max_jerk = (
        [value * (1 + 1e-9)] for value in bounds.values()
    )
    motion = ruckig.Trajectory(1)
    assert ruckig.Ruckig(1).calculate(problem, motion) == ruckig.Result.Working
    return motion.duration


def arrivals(x, xd, xdd, target):
    """The tick from which each column is at rest on the target, up to the last digit of the coordinates."""
    away = (np.abs(x - target) > 4e-16) | (xd != 0) | (xdd != 0)
    assert not away[-1].any()
    return np.where(away.any(axis=0), len(away) - np.argmax(away[::-1], axis=0), 0)


@pytest.mark.parametrize("seed", range(10))
def test_duration_exceeds_ruckig_s_by_at_most_one_tick(seed):
    """1,000 targets per seed: one half from rest, without overshoot, and the other half during another motion."""
    ruckig = pytest.importorskip("ruckig", reason="Ruckig (PyPI: ruckig) is not installed")
    rng = np.random.default_rng(seed)
    late = []

    def go_to(target):
        start = (target_filter.x, target_filter.xd, target_filter.xdd)
        least = [shortest(ruckig, *axis, bounds) for axis in zip(*start, target)]
        assert target_filter.push(target)
        motion = list(moved(target_filter, int(np.ceil(max(least) / DT)) + 3))
        assert_within(*motion, **bounds)
        late.extend(arrivals(*motion, target) - np.array(least) / DT)
        return motion[0]

    while len(late) < 1000:
        acceleration = rng.uniform(2, 30)
        jerk = acceleration * 10 ** rng.uniform(0.8, 2.7)
        bounds = {"velocity": rng.uniform(0.5, 3), "acceleration": acceleration, "jerk": jerk}
        x0 = rng.uniform(-1, 1, 3)
        target_filter = fp.TargetFilter(x0, **bounds, dt=DT)

        def near(x):
            return x + rng.choice([-1, 1], 3) * 10 ** rng.uniform(-5, -0.3, 3)

        target = near(x0)
        x = go_to(target)
        assert np.all((x - target) * np.sign(target - x0) <= 4e-16)
        target_filter.push(near(target))
        assert_within(*moved(target_filter, rng.integers(210, 500)), **bounds)
        go_to(near(target))
    print(f"after Ruckig: {min(late):.4f} to {max(late):.4f} ticks")
    assert max(late) <= 1.01
    assert min(late) >= -0.01


@pytest.mark.parametrize("learnt", [False, True])
def test_does_not_lag_behind_a_stream(learnt):
    """Targets at 30 Hz, up to 20 ms late, one in ten lost. After the last target, the filter stops."""
    rng = np.random.default_rng(7)
    stamps = np.arange(0, 5, 1 / 30)
    delays = rng.uniform(0, 0.02, stamps.size)
    delays[0] = 0  # Then the estimated offset of the clock is correct from the start.
    kept = (rng.random(stamps.size) > 0.1) | (stamps == 0)
    seen = sorted(zip((stamps + delays)[kept], stamps[kept]))
    velocity = np.array([0.45, -0.2, 0.03])
    epoch = 1000.0 if learnt else 0.0
    target_filter = fp.TargetFilter(np.zeros(3), **LINEAR, dt=DT, start=None if learnt else 0.0)
    states = []
    for tick in range(7000):
        while seen and seen[0][0] <= tick * DT:
            _, stamp = seen.pop(0)
            assert target_filter.push(velocity * stamp, epoch + stamp)
        states.append((target_filter.x, target_filter.xd, target_filter.xdd))
        target_filter.advance()
    x, xd, xdd = (np.array(column) for column in zip(*states))
    assert_within(x, xd, xdd, **LINEAR)
    settled = slice(2500, 4900)
    lag = np.abs(x - DT * np.arange(7000)[:, None] * velocity)[settled]
    assert np.all(lag <= np.abs(velocity) * DT)
    assert np.abs(xdd[settled]).max() < 0.01
    stopping = 0.45 / LINEAR["acceleration"] + LINEAR["acceleration"] / LINEAR["jerk"]
    rest = int((stamps[kept][-1] + 0.2 + stopping) / DT) + 3
    assert np.all(xd[rest:] == 0)
    assert np.ptp(x[rest:], axis=0).max() == 0
    assert np.all(np.diff(x, axis=0)[4900:] * velocity >= 0)


def test_invalid_messages_have_no_effect():
    rng = np.random.default_rng(8)
    target_filter = fp.TargetFilter(np.zeros(2), **LINEAR)
    assert target_filter.push([0.1, 0.0], 1.0)
    assert not target_filter.push([0.2, 0.0], 1.0)
    assert not target_filter.push([0.2, 0.0], 0.9)
    assert not target_filter.push([0.2, np.nan], 1.1)
    assert not target_filter.push([0.2, 0.0], np.inf)
    assert not target_filter.push_twist([np.inf, 0.0])
    states = []
    for tick in range(5000):
        if tick % 20 == 0:
            target_filter.push(rng.choice([1, 1e3, 1e6]) * rng.normal(size=2), 1 + DT * (tick + rng.normal()))
        states.append((target_filter.x, target_filter.xd, target_filter.xdd))
        target_filter.advance()
    assert_within(*(np.array(column) for column in zip(*states)), **LINEAR)
    target_filter.reset([0.3, 0.1])
    assert target_filter.push([0.0, 0.1], 0.5)  # The offset of the clock is estimated again.
    x, xd, _ = moved(target_filter, 2000)
    np.testing.assert_array_equal(x[-1], [0.0, 0.1])
    np.testing.assert_array_equal(xd[-1], 0)


@pytest.mark.parametrize(("bounds", "longest"), [((1.5, 8.0, 300.0), 1.15), ((3.0, 3.0, 10.0), 1.4)])
def test_orientations_end_at_rest_without_chatter(bounds, longest):
    """Orientations end slightly later than the largest angle alone. The acceleration does not oscillate more often."""
    rng = np.random.default_rng(9)
    angular = dict(zip(ANGULAR, bounds))
    ratios = []
    for _ in range(50):
        turn = rng.uniform(-1.8, 1.8, 3)
        target = np.eye(4)
        target[:3, :3] = fp.rotation(turn)
        target_filter = fp.TargetFilter(np.eye(4), **LINEAR, **angular)
        assert target_filter.push(target)
        x, xd, xdd = moved(target_filter, 5000)
        assert np.abs(xd).max() <= bounds[0] * (1 + 1e-12)
        assert np.abs(xdd).max() <= bounds[1] * (1 + 1e-12)
        assert np.abs(np.diff(xdd, axis=0)).max() <= bounds[2] * DT * (1 + 1e-9)
        # The acceleration rises and falls twice for the motion of the axis, and twice more by the other axes.
        assert np.abs(np.diff(xdd, axis=0)).sum(axis=0).max() < 16 * bounds[1]
        away = (x != target).any(axis=(1, 2)) | (xd != 0).any(axis=1) | (xdd != 0).any(axis=1)
        assert not away[-1]
        alone = fp.TargetFilter(np.zeros(3), **dict(zip(LINEAR, bounds)))
        alone.push(fp.rotation_vector(target[:3, :3]))
        single = moved(alone, 5000)
        ratios.append((np.flatnonzero(away)[-1] + 1) / arrivals(*single, fp.rotation_vector(target[:3, :3])).max())
    print(f"ratio to the time of the largest angle: mean {np.mean(ratios):.3f}, largest {max(ratios):.3f}")
    assert max(ratios) < longest


def test_a_planar_pose_turns_in_the_shorter_direction():
    target_filter = fp.TargetFilter([0, 0, 3], **LINEAR, **ANGULAR, task="pose")
    assert target_filter.push([0.1, 0, -3])
    x, xd, _ = moved(target_filter, 2000)
    assert np.all(xd[:, 2] >= 0)
    np.testing.assert_allclose(x[-1], [0.1, 0, 2 * np.pi - 3], rtol=0, atol=1e-15)


def test_a_twist_holds_until_the_timeout():
    target_filter = fp.TargetFilter(np.eye(4), **LINEAR, **ANGULAR, timeout=0.1)
    twist = [0.2, 0, 0, 0, 0, -0.4]
    for stamp in np.arange(0, 1, 0.02):
        assert target_filter.push_twist(twist, stamp)
        for _ in range(20):
            target_filter.advance()
    np.testing.assert_array_equal(target_filter.xd, twist)
    x, xd, _ = moved(target_filter, 500)
    np.testing.assert_array_equal(xd[75], twist)
    np.testing.assert_array_equal(xd[-1], 0)
    single = x[-1][0, 3] - x[0][0, 3]
    assert single == pytest.approx(0.2 * (0.08 + (0.2 / 3 + 3 / 100) / 2), abs=0.2 * DT * 1.01)


def test_the_speed_reduces_the_bounds_on_velocity():
    """Also in the middle of a motion: the deceleration and the return to full speed keep all bounds."""
    start, target = np.eye(4), np.eye(4)
    target[:3, 3], target[:3, :3] = [1.0, -0.8, 0.5], fp.rotation([2.0, 0, 0])
    target_filter = fp.TargetFilter(start, **LINEAR, **ANGULAR)
    assert target_filter.speed == 1
    target_filter.push(target)
    seen = [tuple(moved(target_filter, 500))]
    for fraction, angular in [(0.2, 0.3), (1.0, 1.5)]:
        target_filter.set_speed(fraction)
        assert target_filter.speed == fraction
        seen.append(tuple(moved(target_filter, 400)))
        fastest = np.abs(seen[-1][1][-1])
        assert fastest[:3].max() == pytest.approx(fraction * LINEAR["velocity"], rel=1e-12)
        assert fastest[3:].max() == pytest.approx(angular, rel=1e-12)
    seen.append(tuple(moved(target_filter, 5000)))
    x, xd, xdd = (np.concatenate([states[:-1] for states in column]) for column in zip(*seen))
    assert_within(x[:, :3, 3], xd[:, :3], xdd[:, :3], **LINEAR)
    assert np.abs(xdd[:, 3:]).max() <= ANGULAR["angular_acceleration"] * (1 + 1e-12)
    assert np.abs(np.diff(xdd[:, 3:], axis=0)).max() <= ANGULAR["angular_jerk"] * DT * (1 + 1e-9)
    np.testing.assert_array_equal(x[-1], target)
    for wrong in (0.0, -0.5, 1.01, np.nan, np.inf):
        with pytest.raises(fp.ParameterError, match=r"fraction = .*: must be in \(0, 1\]"):
            target_filter.set_speed(wrong)
    assert target_filter.speed == 1


def test_a_tracker_follows_the_filter(arm, q0):
    scheme = fp.FPBM(0.6, np.ones(4), 10, 25, null_damping=2)
    tracker = fp.Tracker(arm, scheme, q0)
    target_filter = fp.TargetFilter(tracker.tip, **LINEAR)
    target = tracker.tip + np.array([-0.2, 0.1])
    target_filter.push(target)
    worst = max(np.abs(tracker.tick(target_filter).error).max() for _ in range(2000))
    assert worst < 1e-7  # The jerk of the filter jumps.
    np.testing.assert_allclose(tracker.tip, target, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(target_filter.x, target)
    with pytest.raises(fp.ParameterError, match="another task"):
        tracker.tick(fp.TargetFilter(np.zeros(3), **LINEAR))
    with pytest.raises(fp.ParameterError, match=r"filter's dt = 0.002: must be the tracker's dt = 0.001"):
        tracker.tick(fp.TargetFilter(np.zeros(2), **LINEAR, dt=2e-3))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"velocity": 0.0}, "velocity = 0: must be positive and finite"),
        ({"jerk": np.nan}, "jerk = nan: must be positive and finite"),
        ({"dt": -1e-3}, "dt = -0.001: must be positive and finite"),
        ({"timeout": np.inf}, "timeout = inf: must be positive and finite"),
        ({"start": np.nan}, "start = nan: must be finite"),
        ({"x0": [0, 0, np.nan]}, r"x0\[2\] = nan: must be finite"),
        ({"x0": np.eye(4)}, "angular_velocity: must be given, since the task has angles"),
        ({"task": "pose"}, "angular_velocity: must be given, since the task has angles"),
        ({"task": "turn"}, "task = 'turn': must be 'position' or 'pose'"),
        ({"x0": [0, 0]}, None),
    ],
)
def test_invalid_numbers_are_rejected_by_name(change, message):
    arguments = {"x0": [0, 0, 0], **LINEAR} | change
    if message is None:
        fp.TargetFilter(**arguments)
        return
    with pytest.raises(fp.ParameterError, match=message):
        fp.TargetFilter(**arguments)


def test_invalid_shapes_are_rejected():
    target_filter = fp.TargetFilter([0, 0, 0], **LINEAR)
    with pytest.raises(fp.ParameterError, match="x has 2 entries: must have 3"):
        target_filter.push([0, 0])
    with pytest.raises(fp.ParameterError, match="v has 6 entries: must have 3"):
        target_filter.push_twist(np.zeros(6))
    pose = fp.TargetFilter(np.eye(4), **LINEAR, **ANGULAR)
    with pytest.raises(fp.ParameterError, match=r"x: must have shape \(4, 4\), got \(3, 3\)"):
        pose.push(np.eye(3))
    assert not pose.push(2 * np.eye(4))
    assert not pose.push(np.diag([1, 1, -1, 1]))
