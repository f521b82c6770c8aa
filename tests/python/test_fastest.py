"""Motions in the least time: on the path, within every bound by differences, and repeatable."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from near_singular import POINTS, STARTS, limits_of

import fpbm_cpp as fp

PANDA = fp.SerialArm.preset("panda")
BENT = np.array([0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785])
CIRCLE = fp.Circle(0.15, 2.0).in_plane("yz")
MVN = fp.MVN()


def ratios(run: fp.Run) -> list[float]:
    """Largest ratios of velocity, acceleration and jerk to their bounds, by differences of positions at rest around."""
    limits, step = run.limits, run.options["dt"]
    q = np.vstack([run.q[:1]] * 3 + [run.q] + [run.q[-1:]] * 3)
    bounds = (limits.velocity, limits.acceleration, np.inf if limits.jerk is None else limits.jerk)
    return [float(np.max(np.abs(np.diff(q, k, axis=0)) / step**k / bound)) for k, bound in enumerate(bounds, 1)]


def assert_kept(run: fp.Run) -> None:
    assert run.status.code is fp.Status.OK
    assert max(ratios(run)) <= 1 + 1e-9
    assert np.abs(run.error).max() < 1e-6
    np.testing.assert_allclose(np.diff(run.t), run.options["dt"], rtol=1e-9)
    assert np.all((run.q >= run.limits.lower) & (run.q <= run.limits.upper))


@pytest.mark.parametrize("name", ["panda", "fr3", "iiwa14", "gen3", "ur5e", "ur10e", "xarm7"])
def test_random_paths_are_kept_within_all_bounds(name):
    arm = fp.SerialArm.preset(name)
    random = np.random.default_rng(2)
    low, high = np.maximum(arm.limits.lower, -2.5), np.minimum(arm.limits.upper, 2.5)
    kept = 0
    for _ in range(40):
        q0 = low + (high - low) * random.uniform(0.3, 0.7, arm.dof)
        points = np.cumsum(np.vstack([np.zeros(3), random.normal(0, 0.05, (random.integers(2, 6), 3))]), axis=0)
        try:
            run = fp.fastest(arm, fp.Waypoints(points, duration=1), MVN, q0, task="pose" if arm.dof > 6 else "position")
        except fp.ParameterError as error:
            if "followed to the fraction" not in str(error) and "leaves the range" not in str(error):
                raise
            continue
        assert_kept(run)
        assert max(ratios(run)) > 0.95
        kept += 1
        if kept == 3:
            return
    pytest.fail("too few paths could be followed")


def test_a_path_past_a_singular_posture_is_kept():
    """With a joint path of 9,600 intervals, the tip leaves this path by 2.0e-6."""
    arm = fp.SerialArm.preset("gen3")
    path = fp.Waypoints(POINTS["gen3"], duration=1)
    assert_kept(fp.fastest(arm, path, MVN, STARTS["gen3"], task="pose", limits=limits_of(arm, "gen3")))


def test_a_path_that_the_joint_path_does_not_resolve_is_rejected():
    """The motion of a joint path of 9,600 intervals left this path by 1.3e-5, and a tracker by 1.4 mm."""
    arm = fp.SerialArm.preset("xarm7")
    path = fp.Waypoints(POINTS["xarm7"], duration=1)
    with pytest.raises(fp.ParameterError, match=r"followed to the fraction 0\.169\d* only"):
        fp.fastest(arm, path, MVN, STARTS["xarm7"], task="pose", limits=limits_of(arm, "xarm7"))
    tracker = fp.Tracker(arm, fp.MVN(k=5), STARTS["xarm7"], task="pose", limits=limits_of(arm, "xarm7"))
    with pytest.raises(fp.ParameterError, match=r"followed to the fraction 0\.169\d* only"):
        tracker.follow(path, keep_path=True)


def test_the_circle_that_a_tracker_leaves_is_kept():
    """A tracker leaves this circle in 1.5 s by centimetres. Without bounds on jerk, the least time is 1.19 s."""
    run = fp.fastest(PANDA, CIRCLE, MVN, BENT, task="pose")
    assert_kept(run)
    assert 1.185 <= run.t[-1] <= 1.2
    assert run.saturated is not None
    assert run.saturated.any(axis=1).mean() > 0.9
    tracked = fp.track(PANDA, fp.Circle(0.15, 1.5, time_law="quintic").in_plane("yz"), MVN, BENT, task="pose")
    assert tracked.max_error() > 0.01


@pytest.mark.parametrize("duration", [2.0, 1.5, 1.2, 1.0, 0.5])
def test_a_tracker_keeps_the_circle(duration):
    """With keep_path, the motion takes 1.05 of the least time, or the time of a slower path."""
    least = fp.fastest(PANDA, CIRCLE, MVN, BENT, task="pose").t[-1]
    run = fp.track(PANDA, circle_of(duration), fp.MVN(k=5), BENT, task="pose", hold=0.1, keep_path=True)
    assert run.status.code is fp.Status.OK
    assert run.scale is not None
    assert run.scale.min() == 1.0
    assert np.abs(run.error).max() < 1e-6
    assert max(ratios(run)) <= 1 + 1e-9
    np.testing.assert_allclose(run.t[-1] - 0.1, max(duration, 1.05 * least), atol=2e-3)


def circle_of(duration: float) -> fp.Path:
    return fp.Circle(0.15, duration).in_plane("yz")


@pytest.mark.parametrize("name", ["panda", "fr3", "iiwa14", "gen3", "ur5e", "xarm7"])
def test_a_tracker_keeps_random_paths(name):
    arm = fp.SerialArm.preset(name)
    random = np.random.default_rng(5)
    low, high = np.maximum(arm.limits.lower, -2.5), np.minimum(arm.limits.upper, 2.5)
    kept = 0
    while kept < 4:
        q0 = low + (high - low) * random.uniform(0.3, 0.7, arm.dof)
        points = np.cumsum(np.vstack([np.zeros(3), random.normal(0, 0.05, (random.integers(2, 6), 3))]), axis=0)
        task = "pose" if arm.dof > 6 else "position"
        try:
            least = fp.fastest(arm, fp.Waypoints(points, duration=1), MVN, q0, task=task)
        except fp.ParameterError:
            continue
        fast = fp.Waypoints(points, duration=float(least.t[-1]) / 2)
        run = fp.track(arm, fast, fp.MVN(k=5), q0, task=task, hold=0.1, keep_path=True)
        assert np.abs(run.error).max() < 1e-5
        assert max(ratios(run)) <= 1 + 1e-9
        assert run.replay() == run
        kept += 1


def test_two_arms_keep_their_paths():
    robot = fp.Robot.preset("two_pandas")
    q0 = np.concatenate([BENT, BENT])
    stack = fp.Stack([fp.PoseTask("left_tip", name="left", k=5), fp.PoseTask("right_tip", name="right", k=5)])
    paths = {"left": fp.Circle(0.1, 0.3).in_plane("yz"), "right": fp.Line((0.0, 0.05, 0.1), 0.2)}
    run = fp.track(robot, paths, MVN, q0, stack=stack, keep_path=True, hold=0.1)
    assert max(np.abs(each).max() for each in run.errors.values()) < 1e-5
    assert max(ratios(run)) <= 1 + 1e-9


def test_a_kept_path_needs_a_path_that_can_be_followed_from_rest():
    for wrong in (-0.1, np.nan, np.inf):
        with pytest.raises(fp.ParameterError, match="reserve = "):
            fp.track(PANDA, CIRCLE, MVN, BENT, task="pose", keep_path=True, reserve=wrong)
    with pytest.raises(fp.ParameterError, match="qd0: must be zero"):
        fp.track(PANDA, CIRCLE, MVN, BENT, task="pose", keep_path=True, qd0=np.full(7, 0.01))
    with pytest.raises(fp.ParameterError, match=r"followed to the fraction 0\.\d+ only"):
        fp.track(PANDA, fp.Circle(0.6, 1.0).in_plane("yz"), MVN, BENT, task="pose", keep_path=True)


@pytest.mark.parametrize("dt", [1e-3, 4e-3, 1 / 500, 0.01])
def test_the_motion_lasts_a_multiple_of_the_step(dt):
    run = fp.fastest(PANDA, CIRCLE, MVN, BENT, task="pose", dt=dt)
    assert_kept(run)
    np.testing.assert_allclose(run.t[-1] / dt, len(run.t) - 1, rtol=1e-12)


def test_only_the_geometry_of_a_path_counts():
    times = [
        fp.fastest(PANDA, path.in_plane("yz"), MVN, BENT).t[-1]
        for path in (fp.Circle(0.1, 1.0), fp.Circle(0.1, 7.0), fp.Circle(0.1, 3.0, time_law="constant_speed"))
    ]
    np.testing.assert_allclose(times, times[0], atol=1.1e-3)


def test_bounds_on_the_tip_and_on_a_frame():
    run = fp.fastest(PANDA, CIRCLE, MVN, BENT, task="pose", tip_speed=0.3, tip_acceleration=1.0)
    assert_kept(run)
    x = run.positions
    assert 0.29 < np.linalg.norm(np.diff(x, axis=0), axis=1).max() / 1e-3 <= 0.3 + 1e-9
    assert 0.98 < np.linalg.norm(np.diff(x, 2, axis=0), axis=1).max() / 1e-6 <= 1 + 1e-6
    slow = fp.TaskBounds(fp.PositionTask(), velocity=0.3)
    run = fp.fastest(PANDA, CIRCLE, MVN, BENT, task="pose", bounds=[slow])
    assert_kept(run)
    assert 0.29 < np.linalg.norm(np.diff(run.positions, axis=0), axis=1).max() / 1e-3 <= 0.3 + 1e-9


def test_a_sequence_stops_between_its_paths():
    path = fp.Line((0.1, 0, 0), 1.0).then(fp.Line((0, 0.1, 0), 1.0))
    run = fp.fastest(PANDA, path, MVN, BENT)
    assert_kept(run)
    corner = np.argmin(np.linalg.norm(run.x - (run.x[0] + [0.1, 0, 0]), axis=1))
    assert np.abs(run.qd[corner - 1 : corner + 2]).max() < 0.05


def test_two_arms_share_one_clock():
    robot = fp.Robot.preset("two_pandas")
    q0 = np.concatenate([BENT, BENT])
    stack = fp.Stack([fp.PoseTask("left_tip", name="left"), fp.PoseTask("right_tip", name="right")])
    paths = {"left": fp.Circle(0.1, 1.0).in_plane("yz"), "right": fp.Line((0.0, 0.05, 0.1), 1.0)}
    run = fp.fastest(robot, paths, MVN, q0, stack=stack)
    assert_kept(run)
    assert max(np.abs(each).max() for each in run.errors.values()) < 1e-6
    alone = fp.fastest(robot, {"left": paths["left"]}, MVN, q0, stack=stack)
    assert alone.t[-1] <= run.t[-1] + 1e-3


def test_a_run_is_saved_replayed_and_drawn(tmp_path):
    run = fp.fastest(PANDA, CIRCLE, MVN, BENT, task="pose", tip_speed=0.5)
    assert run.replay() == run
    run.save(tmp_path / "run.npz")
    again = fp.load(tmp_path / "run.npz")
    assert again == run
    assert again.replay() == run
    run.to_csv(tmp_path / "run.csv")
    assert len((tmp_path / "run.csv").read_text().splitlines()) == len(run.t) + 1
    pytest.importorskip("matplotlib")
    run.plot().savefig(tmp_path / "run.png")


def test_what_has_no_answer_is_refused_with_the_place():
    def refused(text: str, *args, **options):
        with pytest.raises(fp.ParameterError, match=text):
            fp.fastest(PANDA, *args, BENT, **{"task": "pose", **options})

    refused("velocity level", CIRCLE, fp.MAN())
    refused(r"fraction 0\.\d+ only, q = ", fp.Circle(0.6, 1.0).in_plane("yz"), MVN)
    refused("has no length", fp.Line((0, 0, 0), 1.0), MVN)
    refused("tip_speed = -1", CIRCLE, MVN, tip_speed=-1)
    refused("dt = 0", CIRCLE, MVN, dt=0)
    refused(
        "path at the fraction .*lower y", CIRCLE, MVN, bounds=[fp.TaskBounds(fp.PositionTask(rows=("y",)), lower=-0.2)]
    )
    narrow = replace(PANDA.limits, upper=[2.8, 1.7, 2.8, -2.19, 2.8, 3.7, 2.8])
    refused("leaves the range of joint 3", CIRCLE, MVN, limits=narrow)
    open_ended = replace(PANDA.limits, acceleration=np.inf, jerk=None)
    refused("limits.acceleration", CIRCLE, MVN, limits=open_ended)


def tip_speeds(run: fp.Run) -> list[float]:
    """Speeds of the tip at the start and at the end."""
    return [float(np.linalg.norm((np.asarray(run.arm.jacobian(run.q[k])) @ run.qd[k])[:3])) for k in (0, -1)]


@pytest.mark.parametrize("speeds", [(0.2, 0.0), (0.0, 0.3), (0.1, 0.4)])
@pytest.mark.parametrize(
    "path", [CIRCLE, fp.Polyline([[0, 0, 0], [0, 0.2, 0], [0, 0.2, 0.2]], blend=0.05), fp.Line((0, 0.2, 0.1))]
)
def test_the_tip_has_the_given_speeds_at_the_ends(path, speeds):
    run = fp.fastest(PANDA, path, MVN, BENT, task="pose", start_speed=speeds[0], end_speed=speeds[1])
    np.testing.assert_allclose(tip_speeds(run), speeds, atol=1e-6)
    assert np.abs(run.error).max() < 1e-6
    for order, bound in enumerate((run.limits.velocity, run.limits.acceleration, run.limits.jerk), 1):
        assert np.max(np.abs(np.diff(run.q, order, axis=0)) / 1e-3**order / bound) <= 1 + 1e-9
    assert run.t[-1] < fp.fastest(PANDA, path, MVN, BENT, task="pose").t[-1]
    assert run.replay() == run


def test_a_path_can_be_passed_at_a_constant_speed():
    run = fp.fastest(PANDA, CIRCLE, MVN, BENT, task="pose", tip_speed=0.25, start_speed=0.25, end_speed=0.25)
    speeds = np.linalg.norm(np.diff(run.positions, axis=0), axis=1) / 1e-3
    np.testing.assert_allclose(speeds, 0.25, rtol=2e-3)
    assert speeds.max() <= 0.25 + 1e-9


def test_a_sequence_stops_between_its_paths_and_moves_at_its_ends():
    path = fp.Line((0.1, 0, 0), 1.0).then(fp.Line((0, 0.1, 0), 1.0))
    run = fp.fastest(PANDA, path, MVN, BENT, start_speed=0.2, end_speed=0.1)
    np.testing.assert_allclose(tip_speeds(run), (0.2, 0.1), atol=1e-6)
    corner = np.argmin(np.linalg.norm(run.x - (run.x[0] + [0.1, 0, 0]), axis=1))
    assert np.abs(run.qd[corner - 1 : corner + 2]).max() < 0.05
    assert np.abs(run.error).max() < 1e-6


def test_speeds_at_the_ends_belong_to_the_task_of_a_stack():
    stack = fp.Stack([fp.PoseTask(name="tip")])
    run = fp.fastest(PANDA, {"tip": CIRCLE}, MVN, BENT, stack=stack, start_speed=0.2, end_speed=0.1)
    np.testing.assert_allclose(tip_speeds(run), (0.2, 0.1), atol=1e-6)
    assert max(np.abs(each).max() for each in run.errors.values()) < 1e-6
    moving = fp.Stack([fp.PoseTask(name="tip")], [fp.PostureTask(BENT + 0.1)])
    with pytest.raises(fp.ParameterError, match="near a singular posture or in the null space"):
        fp.fastest(PANDA, {"tip": CIRCLE}, MVN, BENT, stack=moving, start_speed=0.2)
    robot = fp.Robot.preset("two_pandas")
    both = fp.Stack([fp.PoseTask("left_tip", name="left"), fp.PoseTask("right_tip", name="right")])
    paths = {"left": CIRCLE, "right": fp.Line((0.0, 0.05, 0.1), 1.0)}
    with pytest.raises(fp.ParameterError, match=r"start_speed.*must be zero for paths of several tasks"):
        fp.fastest(robot, paths, MVN, np.concatenate([BENT, BENT]), stack=both, end_speed=0.1)


def test_speeds_at_the_ends_that_have_no_answer_are_refused():
    def refused(text: str, path: fp.Path = CIRCLE, **options: float):
        with pytest.raises(fp.ParameterError, match=text):
            fp.fastest(PANDA, path, MVN, BENT, task="pose", **options)

    refused("start_speed = -1: must be finite and not negative", start_speed=-1)
    refused("end_speed = inf: must be finite and not negative", end_speed=np.inf)
    refused("start_speed = nan", start_speed=np.nan)
    refused("end_speed = 1e-06: must be 0, or at least 1e-05", end_speed=1e-6)
    refused(r"start_speed = 4: must be at most 0\.\d+, by the bounds on velocities", start_speed=4)
    refused(r"end_speed = 0\.3: must be at most 0\.2", end_speed=0.3, tip_speed=0.2)
    short = fp.Line((0, 0.01, 0))
    refused(r"start_speed = 0\.6: must be lower, for example 0\.\d+", short, start_speed=0.6)
    refused(r"start_speed = 0\.01 and end_speed = 0\.7: .* for example", short, start_speed=0.01, end_speed=0.7)
    corner = fp.Waypoints([[0, 0, 0], [0, 0.1, 0], [0, 0.1, 0.1]])
    refused("no bounded curvature at its end", corner, end_speed=0.1)
    refused("no bounded curvature at its start", fp.Tricuspid(0.05).in_plane("yz"), start_speed=0.1)
    turn = fp.Line((0, 0, 0), 1.0).with_rotation([0, 0, 0.5])
    refused("has no length: must move the tip in position", turn, start_speed=0.1)
    with pytest.raises(TypeError):
        fp.fastest(PANDA, CIRCLE, MVN, BENT, start_speed=None)
