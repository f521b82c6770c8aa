"""The tracker through the real libfranka, against a simulated robot with libfranka's protocol.

The simulated robot follows every command. Therefore the commands are checked here, by libfranka's own conditions.
"""

from __future__ import annotations

import importlib
import os
import sys
import xml.etree.ElementTree as ET
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fpbm_cpp as fp

franka = pytest.importorskip("pylibfranka", reason="pylibfranka cannot be imported", exc_type=ImportError)
franky_sim = pytest.importorskip("franky_sim", reason="franky-sim cannot be imported", exc_type=ImportError)
sys.path.insert(0, str(Path(__file__).parents[2] / "examples"))  # As Python does for a program in this folder.
example = importlib.import_module("11_franka")

PATH = fp.Circle(0.05, 2.0, time_law="quintic").in_plane("xy")
STREAM = 3.5  # [s]
START = [0, -0.785, 0, -2.356, 0, 1.571, 0.785]

# libfranka 0.15, include/franka/rate_limiting.h: kLimitEps, kMaxJointAcceleration, kMaxJointJerk, kMaxTorqueRate.
EPS = 1e-3
ACCELERATION = 10.0 - EPS
JERK = 5000.0 - EPS
TORQUE_RATE = 1000.0 - EPS
ROUNDING = 1 + 1e-8  # Rounding of third differences.


def joint_limits(element: str, attribute: str) -> np.ndarray:
    """Limits of the seven joints in the URDF that the robot serves to libfranka."""
    joints = [joint for joint in ET.fromstring(franky_sim.FR3_URDF).iter("joint") if joint.get("type") == "revolute"]
    values = np.array([float(joint.find(element).attrib[attribute]) for joint in joints])
    assert values.shape == (7,)
    return values


def derivative(t: np.ndarray, q: np.ndarray, order: int) -> np.ndarray:
    """Divided differences: without lost cycles, equal to the finite differences in libfranka.

    Across lost cycles, each divided difference is a mean of finite differences. Therefore, the bounds on finite
    differences hold for divided differences.
    """
    for k in range(1, order + 1):
        q = k * np.diff(q, axis=0) / (t[k:] - t[:-k])[:, None]
    return q


def violated_conditions(t: np.ndarray, q: np.ndarray) -> set[str]:
    """The conditions that commands q [rad] at times t [s] violate.

    Velocity: libfranka 0.21, joint_velocity_limits.h, with the position-based limits of the robot's URDF, at the
    previous commanded position. The other conditions: limitRate() in src/rate_limiting.cpp, whose clamps are conditions
    here.
    """
    lower, upper, fastest = (joint_limits("limit", name) for name in ("lower", "upper", "velocity"))
    offset = joint_limits("position_based_velocity_limits", "velocity_offset")
    deceleration = joint_limits("position_based_velocity_limits", "deceleration_limit")

    def speed_limit(distance: np.ndarray) -> np.ndarray:
        root = np.sqrt(np.maximum(0, 2 * deceleration * distance))
        return np.minimum(fastest, np.maximum(0, root - offset)) - EPS

    v, a, j = (derivative(t, q, order) for order in (1, 2, 3))
    up, down = speed_limit(upper - q[:-1]), -speed_limit(q[:-1] - lower)
    steepest = JERK / ACCELERATION
    broken = {
        "position": (q < lower) | (q > upper),
        "velocity": (v > up) | (v < down),
        "acceleration": abs(a) > ACCELERATION * ROUNDING,
        "approach": (a > steepest * (up[1:] - v[:-1])) | (a < steepest * (down[1:] - v[:-1])),
        "jerk": abs(j) > JERK * ROUNDING,
    }
    return {name for name, where in broken.items() if where.any()}


def violated_torque_conditions(torque: np.ndarray) -> set[str]:
    """The conditions that the torques of consecutive commands [Nm] violate: limitRate() from zero, and the efforts."""
    change = np.diff(torque, axis=0, prepend=np.zeros((1, 7)))
    broken = {
        "effort": abs(torque) > joint_limits("limit", "effort"),
        "rate": abs(change) > example.DT * TORQUE_RATE * ROUNDING,
    }
    return {name for name, where in broken.items() if where.any()}


def from_rest_to_rest(ticks: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and positions, with three samples at rest before and after."""
    before, after = np.arange(-3, 0), ticks[-1] + np.arange(1, 4)
    return 1e-3 * np.r_[before, ticks, after], np.r_[[q[0]] * 3, q, [q[-1]] * 3]


@pytest.fixture(scope="module", autouse=True)
def schedule():
    """libfranka gives its thread the highest priority; later tests have normal priority."""
    before = os.sched_getscheduler(0), os.sched_getparam(0)
    yield
    os.sched_setscheduler(0, *before)


def drive_robot(stream=STREAM, torques=False):
    """A whole motion, and the joints' positions after it."""
    with ExitStack() as stack:
        try:
            address = stack.enter_context(example.simulator())
        except RuntimeError as error:
            pytest.skip(str(error))
        robot = franka.Robot(address, franka.RealtimeConfig.kIgnore)
        return example.move(robot, PATH, stream, torques=torques), np.array(robot.read_once().q)


@pytest.fixture(scope="module")
def drive():
    return drive_robot()


@pytest.fixture(scope="module")
def motion(drive):
    return drive[0]


@pytest.fixture(scope="module")
def by_torques():
    return drive_robot(4.0, torques=True)[0]


def commands(motion) -> tuple[np.ndarray, np.ndarray]:
    """The commands, and the millisecond of the robot in which each was sent."""
    return np.rint(1e3 * (np.array(motion.time) - motion.time[0])), np.array(motion.q)[motion.sent]


def test_libfranka_rejects_no_command(motion):
    assert violated_conditions(*from_rest_to_rest(*commands(motion))) == set()
    assert violated_conditions(*from_rest_to_rest(np.arange(len(motion.q)), np.array(motion.q))) == set()
    shares = motion.shares()
    assert max(shares.values()) <= ROUNDING
    assert shares["velocity"] > 0.1  # The arm moved.
    assert shares["jerk"] < 0.2  # Unfiltered targets would exceed the bound.


def test_libfranka_rejects_no_torque(by_torques):
    torque = np.array(by_torques.torque)
    assert len(torque) >= 6000 or by_torques.missed()
    assert violated_torque_conditions(torque) == set()
    arm = example.ARM.with_payload(0.73, com=(-0.01, 0, 0.03))  # The hand, without its inertia.
    assert np.all(abs(torque + arm.gravity(np.array(by_torques.measured))) < joint_limits("limit", "effort"))
    assert violated_conditions(*from_rest_to_rest(np.arange(len(by_torques.q)), np.array(by_torques.q))) == set()


def test_the_torques_move_the_arm(by_torques):
    if by_torques.missed():
        pytest.skip(f"no command in {by_torques.missed()} milliseconds: the arm moved on its own")
    off = abs(np.array(by_torques.q)[by_torques.sent] - by_torques.measured)
    assert np.ptp(by_torques.measured, axis=0).max() > 0.2
    assert np.quantile(off, 0.99, axis=0)[:4].max() < 5e-3  # 9 mrad without feed-forward.
    assert off.max() < 0.02


def test_the_robot_received_the_recorded_torques(by_torques):
    sent = {tuple(np.float32(torque).tolist()) for torque in by_torques.torque}
    unknown = [desired for desired in by_torques.desired if tuple(desired) not in sent]
    assert len(unknown) < len(sent) / 2


@pytest.mark.parametrize(("jerk", "least", "most"), [(250.0, 0.1, 0.7), (5000.0, 7.0, 12.0)])
def test_libfranka_rejects_no_feed_forward(monkeypatch, jerk, least, most):
    """6,000 cycles with targets that jump, by the feed-forward torques only."""
    monkeypatch.setattr(example, "TORQUE_LIMITS", replace(example.TORQUE_LIMITS, jerk=np.full(7, jerk)))
    arm = example.ARM.with_payload(0.73, com=(-0.01, 0, 0.03))
    tracker = example.tracker_of(arm, START, torques=True)
    start, random = tracker.tip, np.random.default_rng(4)
    torque = []
    for k in range(6000):
        if k % 700 == 0:
            target = start.copy()
            target[:3, 3] += random.uniform(-0.2, 0.2, 3)
        gravity = arm.gravity(tracker.q)
        torque.append(tracker.tick(target).torque - gravity)
    assert violated_torque_conditions(np.array(torque)) == ({"rate"} if least > 1 else set())
    assert least < abs(np.diff(torque, axis=0)).max() < most  # [Nm]


@pytest.mark.parametrize(("change", "conditions"), [(0.99, set()), (1.01, {"rate"}), (12.1, {"rate", "effort"})])
def test_faults_of_torques_are_detected(change, conditions):
    torque = np.zeros((10, 7))
    torque[5:, 4] = change
    assert violated_torque_conditions(torque) == conditions


def limits_with_margin() -> fp.JointLimits:
    """With a margin of A^2/(2 J) for the condition "approach": A^2/(2 J) is the velocity in which A fades to zero."""
    margin = EPS + ACCELERATION**2 / (2 * JERK)
    return replace(
        example.LIMITS,
        lower=joint_limits("limit", "lower"),
        upper=joint_limits("limit", "upper"),
        velocity=joint_limits("limit", "velocity") - margin,
        velocity_offset=joint_limits("position_based_velocity_limits", "velocity_offset") + margin,
        deceleration=joint_limits("position_based_velocity_limits", "deceleration_limit"),
    )


def test_libfranka_rejects_no_kept_path():
    """An operator changes the speed of a tracker along kept paths, pauses and resumes."""
    limits = limits_with_margin()
    random = np.random.default_rng(1)
    cycles = 0
    while cycles < 6000:
        points = np.cumsum(np.vstack([np.zeros(3), random.normal(0, 0.12, (5, 3))]), axis=0)
        tracker = fp.Tracker(example.ARM, fp.MVN(k=5), START, limits=limits, singular_radius=0.0)
        try:
            follower = tracker.follow(fp.Waypoints(points), keep_path=True)
        except fp.ParameterError:
            continue  # The path leaves the workspace, or a joint its range.
        q = [tracker.q]
        while not follower.done:
            if len(q) % 200 == 0:
                follower.set_speed(random.uniform(0.1, 1.0))
                (follower.pause if len(q) % 1000 == 400 else follower.resume)()
            tick = tracker.tick(follower)
            assert np.abs(tick.error).max() < 1e-6
            q.append(tick.q)
        assert violated_conditions(*from_rest_to_rest(np.arange(len(q)), np.array(q))) == set()
        cycles += len(q)


def test_libfranka_rejects_no_fastest_motion():
    limits = limits_with_margin()
    random = np.random.default_rng(1)
    cycles, peak = 0, 0.0
    while cycles < 6000:
        points = np.cumsum(np.vstack([np.zeros(3), random.normal(0, 0.12, (5, 3))]), axis=0)
        try:
            run = fp.fastest(example.ARM, fp.Waypoints(points, duration=1), fp.MVN(), START, limits=limits)
        except fp.ParameterError:
            continue  # The path leaves the workspace, or a joint its range.
        assert violated_conditions(*from_rest_to_rest(np.arange(len(run.q)), run.q)) == set()
        cycles += len(run.q)
        peak = max(peak, run.bound_ratios()["velocity"].max())
    assert peak > 0.99


def test_a_tick_is_the_robots_millisecond(motion):
    assert commands(motion)[0].tolist() == motion.sent


def step(q: np.ndarray) -> None:
    q[500:, 2] += 1e-4


def spike(q: np.ndarray) -> None:
    q[500, 2] += 2.5e-6


def beyond(q: np.ndarray) -> None:
    q[:, 3] += -0.1 - q[:, 3].max()


def fast_approach(q: np.ndarray) -> None:
    """From rest to rest in 1 s, at most at 2.7 rad/s."""
    s = np.linspace(0, 1, 1001)
    q[:1001, 0] += 1.44 * s**3 * (10 - 15 * s + 6 * s**2)
    q[1001:, 0] += 1.44


@pytest.mark.parametrize(
    ("fault", "conditions"),
    [
        (step, {"acceleration", "jerk"}),
        (spike, {"jerk"}),
        (beyond, {"position", "velocity", "approach"}),
        (fast_approach, {"velocity", "approach"}),
    ],
)
def test_faults_are_detected(motion, fault, conditions):
    q = np.tile(motion.q[0], (1500, 1))
    assert violated_conditions(*from_rest_to_rest(np.arange(1500), q)) == set()
    fault(q)
    assert violated_conditions(*from_rest_to_rest(np.arange(1500), q)) == conditions


@pytest.mark.parametrize(("distance", "conditions"), [(0.30, set()), (0.20, {"velocity", "approach"})])
def test_the_velocity_bound_decreases_near_the_end_of_the_range(motion, distance, conditions):
    """Joint 2 may have 0.9 rad/s up to (0.9 + 0.25)^2 / 5.17 rad = 0.256 rad before the end of its range."""
    q = np.tile(motion.q[0], (50, 1))
    t = 1e-3 * np.arange(50)
    q[:, 1] = joint_limits("limit", "upper")[1] - distance + 0.9 * (t - t[-1])
    assert violated_conditions(t, q) == conditions


def test_lost_cycles_do_not_hide_a_fault(motion):
    q = np.array(motion.q)
    ticks = np.arange(len(q))
    kept = np.random.default_rng(1).random(len(ticks)) > 0.2
    kept[499:502] = True
    assert violated_conditions(*from_rest_to_rest(ticks[kept], q[kept])) == set()
    step(q)
    assert violated_conditions(*from_rest_to_rest(ticks[kept], q[kept])) >= {"acceleration", "jerk"}


def test_the_robot_received_the_recorded_commands(motion):
    """The next state from the robot contains each command, as a float."""
    sent_commands = {tuple(np.float32(q).tolist()) for q in commands(motion)[1]}
    unknown = [desired for desired in motion.desired if tuple(desired) not in sent_commands]
    assert all(desired == motion.desired[0] for desired in unknown)  # Before the first command.
    assert len(unknown) < len(sent_commands) / 2


def test_the_tip_is_on_the_circle(motion):
    start = example.ARM.forward(motion.q[0])
    for k in range(round(PATH.duration / example.DT)):
        displacement = PATH.sample(k * example.DT)[0]
        off = example.ARM.forward(motion.q[k]) - start
        np.testing.assert_allclose(off[:3, 3], displacement, atol=1e-6)
        np.testing.assert_allclose(off[:3, :3], 0, atol=1e-6)


def test_targets_are_delayed_reordered_and_lost():
    targets = example.stream(np.eye(4), STREAM)
    stamps = np.array([target.stamp for target in targets])
    assert 0.6 < len(targets) / (30 * STREAM) < 0.9
    assert (np.diff([target.comes for target in targets]) >= 0).all()
    assert (np.diff(stamps) < 0).any()  # Some targets arrive in another order.
    assert np.diff(stamps).max() > 0.35


def test_the_targets_are_reached(drive):
    motion, q = drive
    start = example.ARM.forward(motion.q[round(PATH.duration / example.DT)])
    off = example.ARM.forward(motion.q[-1]) - example.hand(start, STREAM)
    np.testing.assert_allclose(off, 0, atol=1e-3)
    np.testing.assert_allclose(q, motion.q[-1], atol=0.02)  # The simulated robot lags by 0.1 s.


class Interrupted:
    """A Ctrl-C after a number of cycles."""

    def __init__(self, cycles: int) -> None:
        self.left = cycles

    def is_set(self) -> bool:
        self.left -= 1
        return self.left < 0


@pytest.mark.parametrize("torques", [False, True])
def test_ctrl_c_stops_within_bounds(monkeypatch, torques):
    monkeypatch.setattr(example, "interrupted", Interrupted(700))  # In the midst of the circle.
    motion = drive_robot(torques=torques)[0]
    assert len(motion.q) < 1500
    assert violated_torque_conditions(np.reshape(motion.torque, (-1, 7))) == set()
    assert violated_conditions(*from_rest_to_rest(np.arange(len(motion.q)), np.array(motion.q))) == set()


def test_a_robot_without_response_raises():
    """The wait is not endless: the simulator ends during the motion or earlier."""
    with pytest.raises(RuntimeError), example.simulator(lifetime=3) as address:
        example.move(franka.Robot(address, franka.RealtimeConfig.kIgnore))
