"""Robots of LeRobot behind a SafeRobot: units, bounds, two arms, faults. The robots are stand-ins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import fpbm_cpp as fp
from fpbm_cpp.lerobot import SafeRobot

ARM = fp.SerialArm.preset("so101")
LIMITS = replace(ARM.limits, jerk=50 * ARM.limits.acceleration)
DT = 0.01  # [s]
MOTORS = [*ARM.joint_names, "gripper"]
RESOLUTION = 4096  # Positions of a turn of an STS3215.


@dataclass
class Calibration:
    """Fields of LeRobot's MotorCalibration."""

    range_min: int
    range_max: int
    drive_mode: int = 0


class Bus:
    """LeRobot's SerialMotorsBus, with its formula of the values of raw positions."""

    apply_drive_mode = True

    def __init__(self, modes: list[str]) -> None:
        self.model_resolution_table = {"sts3215": RESOLUTION}
        self.motors = {
            name: SimpleNamespace(model="sts3215", norm_mode=SimpleNamespace(value=mode))
            for name, mode in zip(MOTORS, modes)
        }
        self.calibration = {name: Calibration(900 + 20 * k, 3200, k % 2) for k, name in enumerate(MOTORS)}

    def normalize(self, name: str, raw: float) -> float:
        given, mode = self.calibration[name], self.motors[name].norm_mode.value
        fraction = (raw - given.range_min) / (given.range_max - given.range_min)
        if mode == "degrees":
            return (raw - (given.range_min + given.range_max) / 2) * 360 / (RESOLUTION - 1)
        if mode == "range_m100_100":
            return (100 - 200 * fraction) if given.drive_mode else (200 * fraction - 100)
        return 100 - 100 * fraction if given.drive_mode else 100 * fraction


class Follower:
    """LeRobot's SOFollower without motors: each command is executed immediately."""

    name = "so_follower"

    def __init__(
        self, modes: list[str] | None = None, prefixes: tuple[str, ...] = ("",), motors: Sequence[str] = MOTORS
    ) -> None:
        if modes:
            self.bus = Bus(modes)
        self.action_features = {f"{prefix}{name}.pos": float for prefix in prefixes for name in motors}
        self.position = dict.fromkeys(self.action_features, 0.0)
        self.sent: list[dict[str, float]] = []

    def get_observation(self) -> dict[str, Any]:
        return {**self.position, "camera": np.zeros((2, 2, 3))}

    def send_action(self, action: dict[str, float]) -> dict[str, float]:
        self.position.update(action)
        self.sent.append(dict(action))
        return action


def sent_joints(follower: Follower, prefix: str = "", names: Sequence[str] = ARM.joint_names) -> np.ndarray:
    return np.array([[each[f"{prefix}{name}.pos"] for name in names] for each in follower.sent])


def action_of(value: float, gripper: float = 0.0, prefix: str = "") -> dict[str, float]:
    return {f"{prefix}{name}.pos": gripper if name == "gripper" else value for name in MOTORS}


def assert_bounds_kept(q: np.ndarray, limits: fp.JointLimits = LIMITS) -> None:
    q = np.vstack([np.tile(q[0], (3, 1)), q])
    for order, name in enumerate(("velocity", "acceleration", "jerk"), 1):
        assert np.all(abs(np.diff(q, order, axis=0)) / DT**order <= getattr(limits, name) * (1 + 1e-9)), name


def safe_robot(follower: Follower, arms: Any = ARM, units: str | None = "radians", **options: Any) -> SafeRobot:
    return SafeRobot(follower, arms, units=units, **{"dt": DT, "limits": LIMITS, **options})


def test_a_jump_becomes_a_motion_within_the_bounds():
    follower = Follower()
    safe = safe_robot(follower)
    for k in range(150):
        safe.step(action_of(0.4 if k > 10 else 0.0), k * DT)
    q = sent_joints(follower)
    assert_bounds_kept(q)
    np.testing.assert_allclose(q[-1], 0.4, atol=1e-6)
    # The fastest motion with half of the bounds needs 0.65 s.
    assert np.all(q[11 + 65] > 0.399)


@pytest.mark.parametrize("modes", ["degrees", "range_m100_100", "range_0_100"])
def test_units_are_those_of_the_motor_bus(modes):
    follower = Follower([modes] * 6)
    raw = {name: 2100 + 40 * k for k, name in enumerate(MOTORS)}
    follower.position = {f"{name}.pos": follower.bus.normalize(name, raw[name]) for name in MOTORS}
    safe = safe_robot(follower, units=None)
    for k, name in enumerate(ARM.joint_names):
        given = follower.bus.calibration[name]
        turn = -1 if given.drive_mode and modes != "degrees" else 1  # LeRobot inverts normalised values only.
        angle = turn * (raw[name] - (given.range_min + given.range_max) / 2) * 2 * np.pi / (RESOLUTION - 1)
        assert safe.streams[0].q[k] == pytest.approx(angle, abs=1e-12)
    assert safe.step(None, 0.0) == pytest.approx(follower.position, abs=1e-9)


def test_degrees_are_given_and_sent():
    follower = Follower()
    safe = safe_robot(follower, units="degrees")
    for k in range(200):
        safe.step(action_of(20.0), k * DT)
    np.testing.assert_allclose(sent_joints(follower)[-1], 20.0, atol=1e-4)
    assert_bounds_kept(np.radians(sent_joints(follower)))


def test_other_motors_receive_their_actions_unchanged():
    follower = Follower()
    safe = safe_robot(follower)
    assert safe.step(action_of(0.1, gripper=73.0), 0.0)["gripper.pos"] == 73.0
    chunk = [action_of(0.1, gripper=float(k)) for k in range(10)]
    grips = [safe.step(chunk if k == 1 else None, k * DT, period=0.03)["gripper.pos"] for k in range(1, 40)]
    assert grips[0] == 0.0
    assert grips == sorted(grips)
    assert set(grips) == set(range(10))


def test_a_chunk_is_an_array_or_a_sequence_of_actions():
    columns = np.linspace(0, 0.3, 20)
    given = np.column_stack([columns] * 6)
    sent = []
    for chunk in (given, given.tolist(), [action_of(value, value) for value in columns]):
        follower = Follower()
        safe = safe_robot(follower)
        for k in range(100):
            safe.step(chunk if k == 5 else None, k * DT, period=1 / 30)
        sent.append(sent_joints(follower))
        assert_bounds_kept(sent[-1])
    assert safe.rejected == 0
    assert (sent[0] == sent[1]).all()
    assert (sent[0] == sent[2]).all()
    assert abs(sent[0][-1] - 0.3).max() < 1e-3


def test_two_arms_have_two_streams():
    follower = Follower(prefixes=("left_", "right_"))
    safe = safe_robot(follower, {"left_": ARM, "right_": ARM})
    for k in range(150):
        safe.step({**action_of(0.2, 5.0, "left_"), **action_of(-0.3, 7.0, "right_")}, k * DT)
    np.testing.assert_allclose(sent_joints(follower, "left_")[-1], 0.2, atol=1e-6)
    np.testing.assert_allclose(sent_joints(follower, "right_")[-1], -0.3, atol=1e-6)
    assert (follower.sent[-1]["left_gripper.pos"], follower.sent[-1]["right_gripper.pos"]) == (5.0, 7.0)
    for prefix in ("left_", "right_"):
        assert_bounds_kept(sent_joints(follower, prefix))


BOTH = {"left": ARM, "right": ARM}


@pytest.mark.parametrize("arms", [{"left_": ARM, "right_": ARM}, fp.Robot.from_arms(BOTH)], ids=["mapping", "Robot"])
def test_each_of_two_arms_has_a_motor_bus(arms):
    follower = Follower(prefixes=("left_", "right_"))
    for side, mode in {"left": "degrees", "right": "range_m100_100"}.items():
        setattr(follower, f"{side}_arm", SimpleNamespace(bus=Bus([mode] * 6)))
    follower.position = dict.fromkeys(follower.position, 10.0)
    safe = safe_robot(follower, arms, units=None, limits=None)
    left, right = np.concatenate([stream.q for stream in safe.streams]).reshape(2, 5)
    spans = [2300 - 20 * k for k in range(5)]
    np.testing.assert_allclose(left, np.radians(10.0), rtol=1e-12)
    np.testing.assert_allclose(right, 0.05 * 2 * np.pi * np.array(spans) / (RESOLUTION - 1), rtol=1e-12)


PANDAS, CLEARANCE = fp.Robot.preset("two_pandas"), fp.Clearance.preset("two_pandas")
READY = np.tile([0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785], 2)
INWARD = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
OUT = READY + np.tile([0.0, 0.6, 0.0, 0.6, 0.0, 0.0, 0.0], 2)


def distances(postures: Sequence[np.ndarray]) -> np.ndarray:
    return np.array([CLEARANCE.nearest(PANDAS, q).distance for q in postures])


def crossing(turn: float) -> tuple[np.ndarray, list[Any]]:
    """Sent postures and ticks for a policy that moves two arms through each other, and back."""
    follower = Follower(motors=PANDAS.joint_names)
    follower.position = dict(zip(follower.position, READY))
    safe = safe_robot(follower, PANDAS, limits=None, bounds=[CLEARANCE])
    stream, ticks = [], []
    for k in range(1200):
        safe.step(dict(zip(follower.position, OUT + turn * INWARD if 10 < k < 350 else READY)), k * DT)
        stream.append(safe.streams[0].q)
        ticks.append(safe.tick)
    sent = sent_joints(follower, names=PANDAS.joint_names)
    assert_bounds_kept(sent, PANDAS.limits)
    assert distances(stream).min() < -0.05
    assert distances(sent).min() >= CLEARANCE.margin
    return sent, ticks


def test_two_arms_keep_their_clearance():
    sent, ticks = crossing(0.8)
    assert {ticks[100].status, ticks[349].status} == {fp.Status.BLOCKED, fp.Status.STALLED}
    assert ticks[349].nearest.distance == pytest.approx(CLEARANCE.margin, abs=1e-4)
    assert ticks[-1].status is fp.Status.OK
    np.testing.assert_allclose(sent[-1], READY, atol=1e-6)


def test_arms_that_have_passed_each_other_stay_at_rest():
    """The straight line to the stream is blocked. The arms do not move on their own."""
    sent, ticks = crossing(1.4)
    assert abs(sent[-1] - READY).max() > 1.0
    assert ticks[-1].status in (fp.Status.BLOCKED, fp.Status.STALLED)
    np.testing.assert_allclose(sent[-200:], np.tile(sent[-1], (200, 1)), atol=1e-6)


@pytest.mark.parametrize("period", [DT, 1 / 30])
@pytest.mark.parametrize("jerk", [50 * LIMITS.acceleration, np.inf], ids=["jerk", "any-jerk"])
def test_a_tracker_follows_the_stream(period, jerk):
    """Chunks with jumps of up to 0.6 rad, within bounds that admit every motion."""
    random, motors = np.random.default_rng(0), np.arange(6)
    far = fp.TaskBounds(fp.PositionTask(), upper=10.0)
    follower = Follower()
    limits = replace(LIMITS, jerk=jerk)
    safe = safe_robot(follower, dt=period, limits=limits, bounds=[far])
    stream = []
    for k in range(round(20 / period)):
        times = k * period - 0.1 + 0.02 * np.arange(40)
        chunk = 0.5 * np.sin(times)[:, None] * np.cos(motors) + random.uniform(-0.3, 0.3, 6)
        jump = k and k % round(0.4 / period) == 0
        safe.step(chunk if jump else None, k * period, period=0.02, stamp=times[0] if jump else None)
        stream.append(safe.streams[0].q)
    assert safe.rejected == 0
    np.testing.assert_allclose(sent_joints(follower), stream, atol=2e-3)


def test_a_blend_makes_corrections_gentle():
    """Chunks of a smooth motion, each with another error of up to 1 mrad."""
    largest = {}
    for blend in (0.0, 0.2):
        random, follower = np.random.default_rng(0), Follower()
        safe = safe_robot(follower, blend=blend)
        for k in range(400):
            chunk = 0.2 * np.cos(0.5 * (k * DT + 0.02 * np.arange(40)))[:, None] + random.uniform(-1e-3, 1e-3, 6)
            safe.step(chunk if k % 20 == 0 else None, k * DT, period=0.02)
        q = sent_joints(follower)
        assert_bounds_kept(q)
        largest[blend] = abs(np.diff(q[150:], 2, axis=0)).max() / DT**2  # The motion to the first chunk ends before.
    assert largest[0.2] < 0.2 * largest[0.0]


NO_GRIPPER = np.column_stack([np.zeros((5, 5)), np.full(5, np.nan)])


@pytest.mark.parametrize(
    "fault",
    [np.full((5, 6), np.nan), NO_GRIPPER, np.zeros((5, 7)), np.zeros(6), np.empty((0, 6)), [[0.0] * 6, [0.0] * 5]],
)
def test_a_faulty_chunk_changes_nothing(fault):
    motions = []
    for faults in (False, True):
        follower = Follower()
        safe = safe_robot(follower)
        for k in range(60):
            safe.step(action_of(0.2) if k == 0 else fault if faults and k == 5 else None, k * DT, period=0.03)
        motions.append(sent_joints(follower))
        assert safe.rejected == int(faults)
    assert (motions[0] == motions[1]).all()


def test_other_units_are_a_named_problem():
    safe = safe_robot(Follower())
    safe.step(action_of(90.0), 0.0)
    assert safe.rejected == 1
    assert "are the units radians" in safe.problem
    safe.step(action_of(0.1), DT)
    safe.step(action_of(0.1), DT)
    assert safe.rejected == 2
    assert "stamp" in safe.problem


def test_a_pause_of_the_loop_is_not_a_motion():
    follower = Follower()
    safe = safe_robot(follower, timeout=10.0)
    chunk = np.linspace(0, 1.0, 200)[:, None] * np.ones(6)
    safe.step(chunk, 0.0, period=DT)
    for k in range(1, 60):
        safe.step(None, k * DT)
    safe.step(None, 60 * DT + 3.0)
    q = sent_joints(follower)
    assert abs(q[-1] - q[-2]).max() < 0.1 * LIMITS.velocity.max() + 1e-9
    assert abs(q[-1] - q[-2]).max() < 0.1


def test_a_safe_robot_replaces_the_robot_in_a_loop(monkeypatch):
    follower = Follower()
    safe = safe_robot(follower)
    assert safe.name == "so_follower"
    assert list(safe.action_features) == [f"{name}.pos" for name in MOTORS]
    now = 0.0
    monkeypatch.setattr("time.monotonic", lambda: now)
    for _ in range(60):
        now += 1 / 30
        sent = safe.send_action({key: 0.3 for key in safe.get_observation() if key != "camera"})
        assert sent == follower.sent[-1]
    np.testing.assert_allclose(sent_joints(follower)[-1], 0.3, atol=1e-6)


def test_wrong_arguments_are_named():
    with pytest.raises(fp.ParameterError, match=r"arms.*shoulder_pan\.pos"):
        safe_robot(Follower(prefixes=("left_",)))
    with pytest.raises(fp.ParameterError, match="units = None"):
        safe_robot(Follower(), units=None)
    with pytest.raises(fp.ParameterError, match="units = 'grad'"):
        safe_robot(Follower(), units="grad")
    with pytest.raises(
        fp.ParameterError, match="bounds: arms are 'left_', 'right_': must be one arm: join the arms by"
    ):
        safe_robot(Follower(prefixes=("left_", "right_")), {"left_": ARM, "right_": ARM}, bounds=[CLEARANCE])
    with pytest.raises(fp.ParameterError, match=r"dt = -0\.01"):
        safe_robot(Follower(), dt=-DT, bounds=[fp.TaskBounds(fp.PositionTask(), upper=10.0)])
    safe = safe_robot(Follower())
    with pytest.raises(fp.ParameterError, match="period"):
        safe.step(np.zeros((3, 6)), 0.0)
    with pytest.raises(fp.ParameterError, match=r"gripper\.pos"):
        safe.step({f"{name}.pos": 0.0 for name in ARM.joint_names}, 0.0)


def test_the_motor_bus_of_lerobot(tmp_path):
    """The units of a real SO101Follower that is not connected."""
    robots = pytest.importorskip("lerobot.robots.so_follower", reason="LeRobot is not installed", exc_type=ImportError)
    motors = pytest.importorskip("lerobot.motors")
    follower = robots.SO101Follower(
        robots.SO101FollowerConfig(port="none", calibration_dir=tmp_path, use_degrees=False)
    )
    follower.bus.calibration = {
        name: motors.MotorCalibration(k, 0, 0, 900 + 20 * k, 3200) for k, name in enumerate(follower.bus.motors, 1)
    }
    raw = {k: 2000 + 50 * k for k in range(1, 7)}
    values = {f"{follower.bus._id_to_name(k)}.pos": value for k, value in follower.bus._normalize(raw).items()}
    follower.get_observation = lambda: values
    follower.send_action = lambda action: action
    assert SafeRobot(follower, ARM).step(None, 0.0) == pytest.approx(values, abs=1e-9)
