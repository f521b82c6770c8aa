"""Serial arms from joints, tables and presets, and their representations."""

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fpbm_cpp as fp
from fpbm_cpp.arms import PRESETS

PANDA = fp.SerialArm.preset("panda")


def frame(turn, p):
    H = np.eye(4)
    H[:3, :3], H[:3, 3] = fp.rotation(turn), p
    return H


@given(st.integers(0, 2**32 - 1), st.sampled_from(["classic", "modified"]))
def test_dh_tables_are_products_of_transforms(seed, convention):
    rng = np.random.default_rng(seed)
    n = rng.integers(1, 10)
    table = rng.uniform(-1.5, 1.5, (n, 4))
    types = rng.choice(["revolute", "continuous", "prismatic"], n)
    base, tip = frame(rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3)), frame(rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3))
    q = rng.uniform(-2, 2, n)
    product = base
    for (a, alpha, d, theta), kind, position in zip(table, types, q):
        d, theta = (d + position, theta) if kind == "prismatic" else (d, theta + position)
        along_x, along_z = frame([alpha, 0, 0], [a, 0, 0]), frame([0, 0, theta], [0, 0, d])
        product = product @ (along_z @ along_x if convention == "classic" else along_x @ along_z)
    arm = fp.SerialArm.from_dh(table, convention, types=types, base=base, tip=tip)
    np.testing.assert_allclose(arm.forward(q), product @ tip, atol=1e-13)


@given(st.integers(0, 2**32 - 1))
def test_jacobians_are_derivatives(seed):
    rng = np.random.default_rng(seed)
    joints = [
        fp.Joint(kind, frame(rng.uniform(-2, 2, 3), rng.uniform(-0.5, 0.5, 3)), rng.uniform(-1, 1, 3))
        for kind in rng.choice(["revolute", "continuous", "prismatic"], rng.integers(1, 12))
    ]
    if len(joints) > 3:
        joints[2] = fp.Joint("revolute", axis=[1, 0, 0], mimic=(0, -1.5, 0.2))
    arm = fp.SerialArm(joints, frame([0.1, 0.2, 0.3], [0.1, 0, 0.2]))
    q, qd = rng.uniform(-2, 2, (2, arm.dof))
    h = 1e-6
    before, after = arm.forward(q - h * qd), arm.forward(q + h * qd)
    twist = [*(after - before)[:3, 3], *fp.rotation_vector(after[:3, :3] @ before[:3, :3].T)]
    J = arm.jacobian(q, task="pose")
    np.testing.assert_allclose(J @ qd, np.array(twist) / (2 * h), atol=1e-7)
    change = (arm.jacobian(q + h * qd, task="pose") - arm.jacobian(q - h * qd, task="pose")) / (2 * h)
    Jd = arm.jacobian_dot(q, qd, task="pose")
    np.testing.assert_allclose(Jd, change, atol=1e-6)
    np.testing.assert_array_equal(arm.jacobian(q), J[:3])
    np.testing.assert_array_equal(arm.jacobian_dot(q, qd), Jd[:3])


def test_an_arm_has_names_limits_and_repr():
    assert PANDA.dof == 7
    assert PANDA.joint_names[0] == "panda_joint1"
    assert str(PANDA) == "<SerialArm of 7 joints, panda_joint1 to panda_joint7>"
    assert np.all(PANDA.limits.lower < PANDA.limits.upper)
    assert PANDA.limits.acceleration.shape == (7,)
    again = pickle.loads(pickle.dumps(PANDA))
    assert again == PANDA
    assert hash(again) == hash(PANDA)
    assert fp.SerialArm.preset("iiwa14") != PANDA
    assert fp.SerialArm([fp.Joint(), fp.Joint()]).joint_names == ["joint_1", "joint_2"]


@pytest.mark.parametrize("task", ["position", "pose"])
@pytest.mark.parametrize("level", ["velocity", "acceleration"])
@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_runs_in_a_control_loop_with_default_limits(name, level, task):
    pytest.importorskip("tomlkit", reason="needs the command line's extras")
    from fpbm_cpp.job.motion import READY, ready

    arm = fp.SerialArm.preset(name)
    if arm.dof < 6 and task == "pose":
        pytest.skip("fewer joints than rows")
    q0 = READY.get(name) or ready(arm, task)
    limits, ones = arm.limits, np.ones(arm.dof)
    scheme = fp.WMVN(ones, k=10) if level == "velocity" else fp.FPBM(0.6, ones, 20, 100, null_damping=2)
    tracker = fp.Tracker(arm, scheme, q0, task=task)
    target = np.array(tracker.tip)
    position = target[:3, 3] if task == "pose" else target
    position += [0.02, -0.03, 0.01]
    for _ in range(1000):
        tick = tracker.tick(target)
        assert np.all((limits.lower - 1e-9 <= tick.q) & (tick.q <= limits.upper + 1e-9))
        assert np.all(np.abs(tick.qd) <= limits.velocity + 1e-9)
        assert np.all(np.abs(tick.qdd) <= limits.acceleration + 1e-9)
    assert np.linalg.norm(tick.error) < 1e-3


def test_followers_are_not_degrees_of_freedom():
    arm = fp.SerialArm([fp.Joint(name="a"), fp.Joint(name="b", mimic=(0, 2.0, 0.1)), fp.Joint(name="c", lower=-1)])
    assert arm.dof == 2
    assert arm.joint_names == ["a", "c"]
    np.testing.assert_array_equal(arm.limits.lower, [-np.inf, -1])
    np.testing.assert_allclose(fp.rotation_vector(arm.forward([0.2, 0.3])[:3, :3]), [0, 0, 0.2 + 0.5 + 0.3], atol=1e-15)


@given(st.integers(0, 2**32 - 1))
def test_followers_keep_their_bounds(seed):
    rng = np.random.default_rng(seed)
    middle = rng.uniform(-1, 1)
    joints = [fp.Joint(lower=middle - 1, upper=middle + 2, velocity=3, acceleration=4, name="leader")]
    for _ in range(rng.integers(1, 4)):
        ratio, offset = rng.choice([-1, 1]) * rng.uniform(0.1, 3), rng.uniform(-1, 1)
        low, high = ratio * middle + offset - rng.uniform(0.1, 3, 2) * [1, -1]
        joints.append(
            fp.Joint(lower=low, upper=high, velocity=rng.uniform(1, 5), acceleration=5, mimic=(0, ratio, offset))
        )
    limits = fp.SerialArm(joints).limits
    slack = []
    for joint in joints:
        _, ratio, offset = joint.mimic or (0, 1, 0)
        ends = sorted([ratio * limits.lower[0] + offset, ratio * limits.upper[0] + offset])
        slack.append([ends[0] - joint.lower, joint.upper - ends[1]])
        slack[-1] += [joint.velocity - abs(ratio) * limits.velocity[0]]
        slack[-1] += [joint.acceleration - abs(ratio) * limits.acceleration[0]]
    assert np.min(slack) > -1e-12
    np.testing.assert_allclose(np.min(slack, axis=0)[2:], 0, atol=1e-12)  # Not narrower than necessary.


def test_a_joint_without_range_is_named():
    joints = [fp.Joint(name="a", lower=0, upper=1), fp.Joint(name="b", lower=3, upper=4, mimic=(0, 2.0, 0.5))]
    with pytest.raises(ValueError, match=r"joint 'a'.lower = 1.25: must be below upper = 1 for its mimic joints"):
        fp.SerialArm(joints)


def test_bounds_of_a_table():
    arm = fp.SerialArm.from_dh(
        np.zeros((2, 4)),
        "modified",
        lower=[-1, -2],
        upper=[1, 2],
        velocity=[3, 4],
        acceleration=[5, 6],
        names=["a", "b"],
    )
    assert arm.joint_names == ["a", "b"]
    np.testing.assert_array_equal(arm.limits.lower, [-1, -2])
    np.testing.assert_array_equal(arm.limits.upper, [1, 2])
    np.testing.assert_array_equal(arm.limits.velocity, [3, 4])
    np.testing.assert_array_equal(arm.limits.acceleration, [5, 6])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fp.SerialArm([]), "joints has 0 entries: must have 1 to 64"),
        (lambda: fp.SerialArm([fp.Joint()] * 65), "joints has 65 entries: must have 1 to 64"),
        (
            lambda: fp.SerialArm([fp.Joint("helical")]),
            "type = 'helical': must be one of revolute, continuous, prismatic",
        ),
        (lambda: fp.SerialArm([fp.Joint(axis=[0, 0, 0])]), "axis is zero: must be a nonzero vector"),
        (lambda: fp.SerialArm([fp.Joint(axis=[0, 1])]), r"axis = \[0, 1\]: must be real numbers of shape \(3,\)"),
        (
            lambda: fp.SerialArm([fp.Joint(placement=np.eye(3))]),
            r"placement = .*: must be real numbers of shape \(4, 4\)",
        ),
        (lambda: fp.SerialArm([fp.Joint(placement=np.diag([1, 1, 3, 1]))]), "placement.R: must be a rotation matrix"),
        (lambda: fp.SerialArm([fp.Joint(lower=1, upper=-1)]), "lower = 1: must be below upper"),
        (lambda: fp.SerialArm([fp.Joint(lower=np.nan)]), "lower = nan: must be a number"),
        (lambda: fp.SerialArm([fp.Joint("continuous", lower=-1)]), "is continuous: must have no lower and no upper"),
        (lambda: fp.SerialArm([fp.Joint(velocity=0)]), "velocity = 0: must be positive"),
        (lambda: fp.SerialArm([fp.Joint(acceleration=-1)]), "acceleration = -1: must be positive"),
        (lambda: fp.SerialArm([fp.Joint(mimic=(0, 1.0, 0.0))]), "joints with a drive has 0 entries"),
        (lambda: fp.SerialArm([fp.Joint(), fp.Joint(mimic=(-1, 1.0, 0.0))]), r"mimic\[0\] = -1: must be the index"),
        (lambda: fp.SerialArm([fp.Joint(), fp.Joint(mimic=(5, 1.0, 0.0))]), "mimic.joint = 5: must be the index"),
        (lambda: fp.SerialArm([fp.Joint()], tip=np.zeros((4, 4))), "tip: must be a homogeneous matrix"),
        (
            lambda: fp.SerialArm.from_dh(np.zeros((2, 4)), "craig"),
            "convention = 'craig': must be 'classic' or 'modified'",
        ),
        (
            lambda: fp.SerialArm.from_dh(np.zeros((2, 3)), "classic"),
            r"table = .*: must be real numbers of shape \(n, 4\)",
        ),
        (lambda: fp.SerialArm.from_dh([[0, 0, 0, np.nan]], "classic"), r"table\[0, 3\] = nan: must be finite"),
        (lambda: fp.SerialArm.from_dh(np.zeros((2, 4)), "classic", lower=[1]), "lower has 1 entries: must have 2"),
        (
            lambda: fp.SerialArm.from_dh(np.zeros((2, 4)), "classic", types=["revolute"]),
            "types has 1 entries: must have 2",
        ),
        (lambda: fp.SerialArm.from_dh(np.zeros((1, 4)), "classic", types=["fixed"]), r"types\[0\] = 'fixed'"),
        (lambda: fp.SerialArm.preset("ur5"), "name = 'ur5': must be one of panda, fr3, iiwa14, gen3, ur5e, ur10e"),
        (lambda: PANDA.forward(np.zeros(6)), "q has 6 entries: must have 7"),
        (lambda: PANDA.jacobian(np.zeros(7), task="planar"), "task = 'planar': must be 'position' or 'pose'"),
    ],
)
def test_bad_arms(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_rotations_are_inverse_to_their_vectors():
    rng = np.random.default_rng(1)
    for r in rng.uniform(-1.8, 1.8, (50, 3)):
        np.testing.assert_allclose(fp.rotation_vector(fp.rotation(r)), r, atol=1e-14)
