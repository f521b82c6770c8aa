"""Tracker.follow(keep_path=True): the tip stays on the path while an operator changes the speed, within all bounds."""

import numpy as np
import pytest

import fpbm_cpp as fp

PANDA = fp.SerialArm.preset("panda")
BENT = [0, -0.3, 0, -2.2, 0, 2, 0.785]
CIRCLE = fp.Circle(0.15, 0.5).in_plane("yz")
MVN = fp.MVN(k=5)
LEVELS = pytest.mark.parametrize("level", ["velocity", "acceleration"])
DT = 1e-3
FAR = (0.0, 0.0, 5.0)


def scheme_of(level, dof=7):
    return MVN if level == "velocity" else fp.FPBM(0.6, np.linspace(2, 1, dof), k1=20, k2=100)


def tracker_of(arm=PANDA, q0=BENT, task="pose", scheme=MVN, **options):
    options = {"singular_radius": 0.0, "keep_first_level": True, **options}
    return fp.Tracker(arm, scheme, q0, task=task, **options)


def ride(tracker, follower, each_tick=lambda k: None, most=60_000):
    """Postures and largest error of a motion along a path."""
    q, error = [tracker.q], 0.0
    while not follower.done:
        each_tick(len(q) - 1)
        tick = tracker.tick(follower)
        q.append(tick.q)
        error = max(error, float(np.abs(tick.error).max()))
        assert len(q) < most
    return np.array(q), error


def largest_ratio(q, limits, dt=DT):
    q = np.vstack([q[:1]] * 3 + [q])
    bounds = [limits.velocity, limits.acceleration, limits.jerk]
    return max(np.max(np.abs(np.diff(q, k, axis=0)) / dt**k / b) for k, b in enumerate(bounds, 1) if b is not None)


def operator_of(random, tracker, follower):
    """Changes the speed, pauses, stops and resumes at random moments."""
    actions = [follower.pause, follower.resume, tracker.stop, tracker.resume]
    change = [100]

    def act(k):
        if k % 5000 == 4999:
            tracker.resume()
            follower.resume()
            tracker.set_speed(1.0)
            change[0] = k + 2000
        elif k >= change[0]:
            change[0] = k + int(random.integers(20, 500))
            which = int(random.integers(6))
            if which < 4:
                actions[which]()
            else:
                follower.set_speed(random.uniform(0.05, 1.0))

    return act


@LEVELS
@pytest.mark.parametrize("name", ["panda", "fr3", "iiwa14", "gen3", "ur5e", "xarm7"])
def test_an_operator_never_moves_the_tip_off_a_random_path(name, level):
    arm = fp.SerialArm.preset(name)
    jerk = np.full(arm.dof, 500.0) if arm.limits.jerk is None else np.minimum(arm.limits.jerk, 1e4)
    limits = fp.JointLimits(
        lower=arm.limits.lower,
        upper=arm.limits.upper,
        velocity=arm.limits.velocity,
        acceleration=arm.limits.acceleration,
        jerk=jerk,
    )
    random = np.random.default_rng(4)
    low, high = np.maximum(arm.limits.lower, -2.5), np.minimum(arm.limits.upper, 2.5)
    task = "pose" if arm.dof > 6 else "position"
    kept = 0
    while kept < 2:
        q0 = low + (high - low) * random.uniform(0.3, 0.7, arm.dof)
        points = np.cumsum(np.vstack([np.zeros(3), random.normal(0, 0.08, (random.integers(2, 6), 3))]), axis=0)
        tracker = tracker_of(arm, q0, task, scheme_of(level, arm.dof), limits=limits)
        try:
            follower = tracker.follow(fp.Waypoints(points), ramp=random.uniform(0.05, 0.5), keep_path=True)
        except fp.ParameterError:
            continue
        q, error = ride(tracker, follower, operator_of(random, tracker, follower))
        assert error < (1e-5 if level == "velocity" else 1e-4)
        assert largest_ratio(q, limits) <= 1 + 1e-9
        kept += 1


@LEVELS
def test_the_loop_and_track_move_the_arm_alike(level):
    run = fp.track(PANDA, CIRCLE, scheme_of(level), BENT, task="pose", keep_path=True)
    tracker = tracker_of(scheme=scheme_of(level))
    q, error = ride(tracker, tracker.follow(CIRCLE, keep_path=True))
    assert error < (1e-6 if level == "velocity" else 1e-5)
    assert run.t[-1] < 1.26
    np.testing.assert_allclose(q[: len(run.q)], run.q, atol=1e-12)
    assert abs(len(q) - len(run.q)) <= 1


@LEVELS
@pytest.mark.parametrize("dt", [5e-4, 2e-3, 4e-3])
@pytest.mark.parametrize("clear", [False, True])
def test_ticks_of_any_length_keep_the_path(level, dt, clear):
    bounds = [fp.Clearance.preset("panda")] if clear else []
    tracker = tracker_of(scheme=scheme_of(level), dt=dt, bounds=bounds)
    follower = tracker.follow(CIRCLE, keep_path=True)
    q, error = ride(tracker, follower, operator_of(np.random.default_rng(2), tracker, follower))
    assert error < (1e-5 if level == "velocity" else 1e-4)
    assert largest_ratio(q, PANDA.limits, dt) <= 1 + 1e-8


@LEVELS
def test_two_arms_have_one_clock(level):
    robot = fp.Robot.preset("two_pandas")
    stack = fp.Stack([fp.PoseTask("left_tip", name="left", k=5), fp.PoseTask("right_tip", name="right", k=5)])
    paths = {"left": fp.Circle(0.1).in_plane("yz"), "right": fp.Line((0.0, 0.05, 0.1))}
    random = np.random.default_rng(1)
    scheme = fp.MVN() if level == "velocity" else fp.MAN()
    if level == "acceleration":
        stack = fp.Stack([fp.PoseTask(f"{side}_tip", name=side, k1=20, k2=100) for side in ("left", "right")])
    for as_dictionary in (False, True):
        tracker = fp.Tracker(robot, scheme, [*BENT, *BENT], stack=stack, singular_radius=0.0, keep_first_level=True)
        follower = tracker.follow(paths, keep_path=True)
        act = operator_of(random, tracker, follower)
        q, error = [tracker.q], 0.0
        while not follower.done:
            act(len(q))
            tick = tracker.tick({"left": follower, "right": follower} if as_dictionary else follower)
            q.append(tick.q)
            error = max(error, *(float(np.abs(each).max()) for each in tick.errors.values()))
        assert error < (1e-5 if level == "velocity" else 1e-4)
        assert largest_ratio(np.array(q), robot.limits) <= 1 + 1e-9


def test_the_arm_waits_before_a_ball_and_continues():
    def ball(centre):
        return fp.Capsule(0, a=centre, b=centre, radius=0.05, name="ball")

    tracker = tracker_of(bounds=[fp.Clearance.preset("panda", obstacles=[ball(FAR)])])
    place = tracker.tip[:3, 3] + [0.0, 0.4, 0.0]
    follower = tracker.follow(fp.Line((0.0, 0.35, 0.0)), keep_path=True)
    still = []

    def move(k):
        if k in (50, 3000):
            tracker.move("ball", ball(place if k == 50 else FAR))
        if 100 < k < 3000:
            still.append(np.abs(tracker.qd).max() < 1e-5)

    q, error = ride(tracker, follower, move)
    assert sum(still) > 1000
    assert error < 1e-4
    assert largest_ratio(q, PANDA.limits) <= 1 + 1e-9


def test_a_path_at_a_speed_keeps_the_speed():
    path = fp.Circle(0.1).in_plane("yz").at_speed(0.125, acceleration=0.5)
    tracker = tracker_of()
    follower = tracker.follow(path, keep_path=True)
    tips = [tracker.tip[:3, 3]]
    while not follower.done:
        tick = tracker.tick(follower)
        assert np.abs(tick.error).max() < 1e-6
        tips.append(tracker.tip[:3, 3])
    speed = np.linalg.norm(np.diff(tips, axis=0), axis=1) / DT
    assert speed.max() <= 0.125 * (1 + 1e-6)
    assert np.mean(abs(speed / 0.125 - 1) < 0.01) > 0.95
    run = fp.track(PANDA, path, MVN, BENT, task="pose", keep_path=True)
    np.testing.assert_allclose(run.t[-1], len(speed) * DT, atol=2 * DT)


@pytest.mark.parametrize("options", [{"rest_posture": BENT, "null_stiffness": 3.0}, {"joint_centring": 1.0}])
@pytest.mark.parametrize("task", ["position", "pose"])
def test_a_motion_in_the_null_space_is_planned_for_the_duration_of_the_motion(task, options):
    run = fp.track(PANDA, CIRCLE, fp.MVN(k=5, **options), BENT, task=task, keep_path=True)
    assert run.max_error() < 1e-6


def test_the_speed_of_a_tracker_is_the_speed_of_its_sources():
    tracker = tracker_of()
    slow, targets = tracker.follow(fp.Circle(0.05, 2.0).in_plane("yz")), filter_at(tracker.tip)
    tracker.set_speed(0.25)
    tracker.tick(slow)
    tracker.tick(targets)
    assert (slow.speed, targets.speed) == (0.25, 0.25)
    for wrong in (0.0, -1.0, 1.5, np.nan):
        with pytest.raises(fp.ParameterError, match=r"fraction = .*: must be in \(0, 1\]"):
            tracker.set_speed(wrong)
    tracker.tick(slow)
    assert slow.speed == 0.25


def filter_at(x0):
    return fp.TargetFilter(
        x0,
        velocity=0.5,
        acceleration=1.0,
        jerk=10.0,
        angular_velocity=1.0,
        angular_acceleration=2.0,
        angular_jerk=20.0,
    )


def test_wrong_arguments():
    tracker = tracker_of()
    for wrong in (-0.1, np.nan, np.inf):
        with pytest.raises(fp.ParameterError, match="reserve = "):
            tracker.follow(CIRCLE, keep_path=True, reserve=wrong)
    with pytest.raises(fp.ParameterError, match="ramp = "):
        tracker.follow(CIRCLE, keep_path=True, ramp=0.0)
    with pytest.raises(fp.ParameterError, match=r"followed to the fraction 0\.\d+ only"):
        tracker.follow(fp.Circle(0.6).in_plane("yz"), keep_path=True)
    with pytest.raises(fp.ParameterError, match="has no duration"):
        tracker.follow(fp.Circle(0.1).in_plane("yz"))
    with pytest.raises(fp.ParameterError, match="has one task"):
        tracker.follow({"tip": CIRCLE}, keep_path=True)
    for _ in range(50):
        tracker.tick(tracker.tip + np.array([[0, 0, 0, 0.1], [0] * 4, [0] * 4, [0] * 4]))
    with pytest.raises(fp.ParameterError, match="qd0: must be zero with keep_path: stop the arm first"):
        tracker.follow(CIRCLE, keep_path=True)


def test_wrong_paths_of_a_stack():
    robot = fp.Robot.preset("two_pandas")
    stack = fp.Stack([fp.PoseTask("left_tip", name="left", k=5), fp.PoseTask("right_tip", name="right", k=5)])
    tracker = fp.Tracker(robot, fp.MVN(), [*BENT, *BENT], stack=stack)
    with pytest.raises(fp.ParameterError, match="at least one task"):
        tracker.follow({}, keep_path=True)
    with pytest.raises(fp.ParameterError, match="dictionary of paths by task name"):
        tracker.follow({"left": 3}, keep_path=True)
    with pytest.raises(fp.ParameterError, match="task = 'middle'"):
        tracker.follow({"middle": CIRCLE}, keep_path=True)
    at_speed = CIRCLE.at_speed(0.1, acceleration=1.0)
    with pytest.raises(fp.ParameterError, match="only the first path may have a speed"):
        tracker.follow({"left": CIRCLE, "right": at_speed}, keep_path=True)
    with pytest.raises(fp.ParameterError, match="only the path of the run's task may have a speed"):
        fp.track(robot, {"left": CIRCLE, "right": at_speed}, fp.MVN(), [*BENT, *BENT], stack=stack, keep_path=True)
