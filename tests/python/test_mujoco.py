"""A Panda under computed torque in MuJoCo, with friction and masses that the controller does not know."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

import fpbm_cpp as fp

mujoco = pytest.importorskip("mujoco")
sys.path.insert(0, str(Path(__file__).parents[2] / "examples"))  # As for a script in this folder.
example = importlib.import_module("08_mujoco_panda")
panda_mjcf = importlib.import_module("panda_mjcf")
tray = importlib.import_module("19_mujoco_tray")
load = importlib.import_module("22_lift_a_load")

HOME = example.HOME


def model(arm=None, **options):
    compiled = mujoco.MjModel.from_xml_string(panda_mjcf.panda_mjcf(arm, **options))
    return compiled, mujoco.MjData(compiled)


def states(count: int):
    rng = np.random.default_rng(1)
    limits = example.ARM.limits
    for _ in range(count):
        yield rng.uniform(limits.lower, limits.upper), rng.uniform(-limits.velocity, limits.velocity)


def mass_matrix(compiled, data) -> np.ndarray:
    columns = np.zeros((compiled.nv, compiled.nv))
    for column, unit in zip(columns, np.eye(compiled.nv)):
        mujoco.mj_mulM(compiled, data, column, unit)
    return columns.T


def test_the_model_equals_the_arm():
    compiled, data = model()
    tip = data.site("tip")
    J = np.zeros((6, 7))
    for data.qpos[:], data.qvel[:] in states(1000):
        mujoco.mj_forward(compiled, data)
        T = example.ARM.forward(data.qpos)
        mujoco.mj_jacSite(compiled, data, J[:3], J[3:], tip.id)
        np.testing.assert_allclose(tip.xpos, T[:3, 3], rtol=0, atol=1e-9)
        np.testing.assert_allclose(tip.xmat.reshape(3, 3), T[:3, :3], rtol=0, atol=1e-9)
        np.testing.assert_allclose(J, example.ARM.jacobian(data.qpos, task="pose"), rtol=0, atol=1e-9)


@pytest.mark.parametrize("error", [0.0, 0.02])
def test_the_controllers_dynamics_are_mujocos_except_for_the_error(error):
    compiled, data = model(friction=0.0)
    arm = panda_mjcf.panda(error)
    assert 15 < compiled.body_mass.sum() < 18  # [kg]; the data sheet says about 18 with the base.
    for data.qpos[:], data.qvel[:] in states(100):
        mujoco.mj_forward(compiled, data)
        M = mass_matrix(compiled, data)
        assert np.linalg.eigvalsh(M)[0] > panda_mjcf.ARMATURE / 2
        np.testing.assert_allclose(arm.mass_matrix(data.qpos), (1 + error) * M, rtol=0, atol=1e-9)
        bias = (1 + error) * data.qfrc_bias
        np.testing.assert_allclose(arm.bias(data.qpos, data.qvel), bias, rtol=0, atol=1e-9)


def test_friction_holds_a_joint_up_to_its_torque():
    compiled, data = model()
    data.qpos[:] = HOME
    mujoco.mj_forward(compiled, data)
    for share in (0.9, 1.5):
        data.qpos[:], data.qvel[:] = HOME, 0
        for _ in range(400):  # 0.1 s under more torque than holds the arm
            mujoco.mj_forward(compiled, data)
            data.ctrl[:] = data.qfrc_bias + share * np.array(panda_mjcf.COULOMB) * np.eye(7)[4]
            mujoco.mj_step(compiled, data)
        assert (abs(data.qpos - HOME)[4] > 1e-4) == (share > 1)


@pytest.fixture(scope="module")
def motion():
    return example.simulate()


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def last(motion, name: str, rows: str, seconds: float = 0.5) -> np.ndarray:
    """The end of a phase."""
    values = motion.during(name, rows)
    per_tick = example.STEPS if rows in ("q", "qd") else 1
    return values[-round(seconds / example.DT) * per_tick :]


def test_the_tip_is_on_the_circle(motion):
    assert rms(motion.during("circle", "tip")) < 1e-3  # [m]
    assert last(motion, "hold", "tip").max() < 1e-4


def test_the_arm_settles_after_the_push(motion):
    joints = motion.during("push", "q")
    assert abs(joints - joints[0]).max() > 0.1  # The push displaced the arm.
    assert motion.settled() < 1.5  # [s]
    assert last(motion, "push", "tip").max() < 1e-4


def test_no_bound_is_exceeded_at_any_step(motion):
    position, velocity = motion.clearance()
    assert np.all(position > 0)
    assert np.all(velocity > 0)
    assert position.min() < 0.01  # Bounds were active.
    assert velocity.min() < 0.03
    assert np.all(abs(np.array(motion.torque)).max(axis=0) < panda_mjcf.TORQUE)


def test_torques_do_not_chatter(motion):
    change = np.diff(np.array(motion.torque), axis=0)
    reversal = np.where(change[1:] * change[:-1] < 0, np.minimum(abs(change[1:]), abs(change[:-1])), 0)
    assert (reversal.max(axis=1) > 0.5).sum() < 20  # [Nm], of 21,000 ticks


@pytest.mark.parametrize("name", ["too far", "too near"])
def test_unreachable_target_stops_the_arm(motion, name):
    tip = last(motion, name, "tip")
    assert tip.min() > 0.05  # The target is unreachable.
    assert np.ptp(tip) < 1e-4
    assert abs(last(motion, name, "qd")).max() < 0.03


def test_reachable_target_is_reached_again(motion):
    assert last(motion, "home", "tip", 1.0).max() < 1e-3
    assert abs(last(motion, "home", "qd")).max() < 0.01


def test_without_limits_bounds_are_exceeded():
    none = np.full(7, 1e3)
    limits = fp.JointLimits(lower=-none, upper=none, velocity=none, acceleration=none)
    position, velocity = example.simulate(limits=limits, end=11.0).clearance()
    assert position.min() < -0.5
    assert velocity.min() < -1


def test_without_the_integral_a_steady_state_error_remains():
    motion = example.simulate(integral={}, end=6.0)
    assert rms(motion.during("circle", "tip")) > 1e-3
    assert last(motion, "hold", "tip").min() > 5e-4


def test_a_mass_error_of_a_fifth_exceeds_the_tolerance():
    motion = example.simulate(inertia_error=-0.2, end=4.0)
    assert rms(motion.during("circle", "tip")) > 1e-3


def test_two_models_equal_the_robot():
    compiled, data = model(placements=tray.PLACEMENTS)
    names = [compiled.joint(i).name for i in range(compiled.njnt)]
    assert names == tray.ROBOT.joint_names
    rng = np.random.default_rng(2)
    for _ in range(100):
        data.qpos[:] = rng.uniform(tray.ROBOT.limits.lower, tray.ROBOT.limits.upper)
        mujoco.mj_kinematics(compiled, data)
        for hand in tray.PLACEMENTS:
            T = tray.ROBOT.forward(data.qpos, f"{hand}_tip")
            np.testing.assert_allclose(data.site(f"{hand}_tip").xpos, T[:3, 3], rtol=0, atol=1e-9)


def test_torque_control_keeps_a_grasp():
    relative, tracking = tray.simulate(duration=4.0, hold=0.5)
    rms = np.sqrt(np.mean(relative**2, axis=0))
    assert rms[0] < 2e-3  # [m]
    assert rms[1] < 2e-3  # [rad]
    assert tracking.max() < 5e-3  # [m]


@pytest.mark.parametrize(("case", "least", "most"), [("no bounds", 20e-3, 50e-3), ("bounds", 0.0, 1e-4)])
def test_motors_lift_a_load_along_the_path_within_bounds_on_torque(case, least, most):
    """Without friction: an error of the tip [m] is due to the bounds on the torques of the motors."""
    compiled, data = model(load.ARM, friction=0.0)
    q, qd, off = np.array(load.START), np.zeros(7), 0.0
    data.qpos[:] = q
    for tick in load.lift(load.CASES[case]):
        qdd = tick.qdd + 100 * (qd - data.qvel) + 2500 * (q - data.qpos)
        data.ctrl[:] = load.ARM.inverse_dynamics(data.qpos, data.qvel, qdd)
        mujoco.mj_step(compiled, data, 4)
        q, qd = tick.q, tick.qd
        off = max(off, np.linalg.norm((load.ARM.forward(data.qpos) - load.ARM.forward(q))[:3, 3]))
    assert least <= off < most
