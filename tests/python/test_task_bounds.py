"""Bounds on coordinates of tasks from Python: they hold for any task, scheme and robot, and report errors."""

import pickle

import numpy as np
import pytest

import fpbm_cpp as fp
from fpbm_cpp.skeleton import link_frames

DT = 1e-3
# Schemes for this number of joints, with gains, or without gains for a stack, whose tasks have them.
SCHEMES = {
    "velocity": lambda n, gain: fp.WMVN(np.ones(n), k=5 * gain),
    "acceleration": lambda n, gain: fp.FPBM(0.6, np.ones(n), 10 * gain, 25 * gain),
}
ARMS = ["panda", "ur5e", "gen3", "planar"]


def arm_of(name):
    """An arm, its limits, and a posture far from all limits."""
    if name == "planar":
        limits = fp.JointLimits(lower=[-3.0] * 4, upper=[3.0] * 4, velocity=[2.0] * 4, acceleration=[10.0] * 4)
        return fp.PlanarArm([0.4, 0.3, 0.3, 0.2]), limits, np.array([0.3, 0.6, 0.9, -0.8])
    arm = fp.SerialArm.preset(name)
    middle = (arm.limits.lower.clip(-2) + arm.limits.upper.clip(max=2)) / 2
    return arm, arm.limits, middle + 0.2 * np.arange(arm.dof) % 0.7


def pose_of(arm, q):
    if isinstance(arm, fp.PlanarArm):
        angle = q.sum()
        pose = np.eye(4)
        pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        pose[:2, 3] = arm.forward(q)
        return pose
    return arm.forward(q)


@pytest.mark.parametrize("dt", [DT, 4e-3, 2e-2])
@pytest.mark.parametrize("stacked", [False, True])
@pytest.mark.parametrize("level", SCHEMES)
@pytest.mark.parametrize("name", ARMS)
def test_walls_and_cones_hold(name, level, stacked, dt):
    """For targets beyond the walls, with one task and with levels of tasks, also of a link before the tip."""
    arm, limits, q0 = arm_of(name)
    rng = np.random.default_rng(ARMS.index(name))
    link = arm.dof - 1
    elbow, tip = link_frames(arm, q0)[link][:3, 3], pose_of(arm, q0)
    axis = tip[:3, 0]
    bounds = (
        fp.TaskBounds(fp.PositionTask(name="tip"), tip[:3, 3] - 0.05, tip[:3, 3] + 0.08),
        fp.TaskBounds(
            fp.PositionTask(arm.joint_names[link - 1], rows=("x", "y"), name="elbow"), upper=elbow[:2] + 0.03
        ),
        fp.TaskBounds(fp.AxisTask(axis=(1, 0, 0), x=axis), upper=0.3),
    )
    how = {"stack": fp.Stack(fp.PositionTask(name="tip"), fp.PostureTask(k1=4, k2=4))} if stacked else {}
    tracker = fp.Tracker(arm, SCHEMES[level](arm.dof, not stacked), q0, limits=limits, bounds=bounds, dt=dt, **how)
    met = 0
    for k in range(round(4 / dt)):
        if k % round(0.5 / dt) == 0:
            target = tip[:3, 3] + rng.uniform(-0.4, 0.4, 3) * (1, 1, name != "planar")
            target = target if stacked or name != "planar" else target[:2]
        tick = tracker.tick({"tip": target} if stacked else target)
        met += tick.status is fp.Status.BLOCKED
        now = pose_of(arm, tick.q)
        assert np.all(now[:3, 3] >= tip[:3, 3] - 0.05 - 1e-9)
        assert np.all(now[:3, 3] <= tip[:3, 3] + 0.08 + 1e-9)
        assert np.all(link_frames(arm, tick.q)[link][:2, 3] <= elbow[:2] + 0.03 + 1e-9)
        assert np.arccos(min(axis @ now[:3, 0], 1.0)) <= 0.3 + 1e-7
        assert np.all(tick.q >= limits.lower - 1e-9)
        assert np.all(tick.q <= limits.upper + 1e-9)
    assert met > 0.1 / dt


@pytest.mark.parametrize("dt", [DT, 4e-3, 2e-2])
@pytest.mark.parametrize("level", SCHEMES)
def test_walls_and_cones_hold_while_an_obstacle_presses_the_arm(level, dt):
    """A plate that moves down presses the tip of an arm at rest toward a wall, and its axis toward a cone."""
    shapes = fp.Clearance.preset("panda")
    for seed in range(4):
        arm, _, _ = arm_of("panda")
        q0 = np.array([0, -0.2, 0, -2.4, 0, 2.2, 0.785]) + np.random.default_rng(seed).uniform(-0.15, 0.15, 7)
        tip = arm.forward(q0)

        def plate(below, tip=tip):
            pose = np.eye(4)
            pose[:3, 3] = tip[:3, 3] + [0, 0, 0.35 - below]
            return fp.Cuboid(pose, half=[0.12, 0.12, 0.01], name="plate")

        bounds = (
            fp.TaskBounds(fp.PositionTask(rows=("z",)), lower=tip[2, 3] - 0.02),
            fp.TaskBounds(fp.AxisTask(x=tip[:3, 2]), upper=0.02),
        )
        clearance = fp.Clearance(shapes.capsules, [plate(0)], margin=0.01, allowed=shapes.allowed)
        kept = [clearance, bounds[seed % 2]]
        tracker = fp.Tracker(arm, SCHEMES[level](7, 1), q0, bounds=kept, dt=dt, task="pose")
        for k in range(round(2 / dt)):
            tracker.move("plate", plate(0.3 * dt * k), velocity=[0, 0, -0.3])
            now = arm.forward(tracker.tick(tip).q)
            assert seed % 2 == 1 or now[2, 3] >= tip[2, 3] - 0.02 - 1e-9
            assert seed % 2 == 0 or np.arccos(min(tip[:3, 2] @ now[:3, 2], 1.0)) <= 0.02 + 1e-7


def test_a_run_keeps_its_bounds():
    arm, _, q0 = arm_of("panda")
    bounds = (fp.TaskBounds(fp.PositionTask(rows=("z",)), lower=arm.forward(q0)[2, 3] - 0.1, deceleration=0.5),)
    run = fp.track(arm, fp.Line([0, 0, -0.3], 2.0), SCHEMES["acceleration"](7, 1), q0, bounds=bounds, hold=4.0)
    z = np.array([arm.forward(q)[2, 3] for q in run.q])
    assert z.min() >= bounds[0].lower - 1e-9
    assert z.min() <= bounds[0].lower + 1e-3
    speed = np.gradient(z, DT)
    assert np.all(speed**2 / 2 <= 0.5 * (z - bounds[0].lower) + 1e-5)
    assert run.status.code is fp.Status.STALLED  # The target is beyond the wall.
    assert run.replay() == run
    assert pickle.loads(pickle.dumps(bounds)) == bounds


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fp.TaskBounds(fp.PostureTask(), 1), "must be a PositionTask or an AxisTask"),
        (lambda: fp.TaskBounds(fp.AxisTask(), upper=1), "task.x: must be given: the bounded angle"),
        (lambda: fp.TaskBounds(fp.AxisTask(x=[0, 0, 1]), -0.1), r"lower = -0.1: must be an angle from 0 to pi"),
        (lambda: fp.TaskBounds(fp.PositionTask(rows=("x",)), [1, 2], 3), "lower has 2 entries: must have 1"),
        (lambda: fp.TaskBounds(fp.PositionTask(), 1, [2, 3, 0]), r"lower\[2\] = 1: must be below upper"),
        (lambda: fp.TaskBounds(fp.PositionTask(axes="frame"), 1), "task.axes = 'frame': must be 'base'"),
        (lambda: fp.TaskBounds(fp.PositionTask(reference_frame="base"), 1), "task.reference_frame: must be None"),
        (lambda: fp.TaskBounds(fp.PositionTask(), velocity=0), "velocity = 0: must be positive"),
        (lambda: fp.TaskBounds(fp.PositionTask(), 1, deceleration=-1), "deceleration = -1: must be positive"),
        (
            lambda: tracker(fp.TaskBounds(fp.PositionTask("hand"), 1)),
            "frame = 'hand': must be a frame, or the joint of a link: 'base', 'tip'",
        ),
        (lambda: tracker(fp.TaskBounds(fp.PositionTask(), upper=0.1)), "is beyond the bound 'upper z of position'"),
        (lambda: tracker(3), "bounds: must be a Clearance, TaskBounds"),
    ],
)
def test_bad_bounds(make, words):
    with pytest.raises(fp.ParameterError, match=words):
        make()


def tracker(bounds):
    arm, _, q0 = arm_of("panda")
    return fp.Tracker(arm, fp.MVN(), q0, bounds=[bounds])
