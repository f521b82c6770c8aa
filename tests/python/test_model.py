"""Kinematics against plain NumPy and finite differences."""

import pickle

import numpy as np
import pytest
import textbook
from hypothesis import given
from hypothesis import strategies as st

import fpbm_cpp as fp

SIZES = [*range(2, 11), 11, 20, fp.MAX_DOF]


@st.composite
def states(draw):
    n = draw(st.sampled_from(SIZES))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    return rng.uniform(0.1, 2.0, n), rng.uniform(-np.pi, np.pi, n), rng.uniform(-3, 3, n)


@given(states())
def test_tip_and_jacobians_equal_the_textbook(state):
    lengths, q, qd = state
    arm = fp.PlanarArm(lengths)
    scale = lengths.sum() * (1 + np.abs(qd).sum())
    np.testing.assert_allclose(arm.forward(q), textbook.forward(lengths, q), atol=1e-14 * scale)
    np.testing.assert_allclose(arm.jacobian(q), textbook.jacobian(lengths, q), atol=1e-14 * scale)
    np.testing.assert_allclose(arm.jacobian_dot(q, qd), textbook.jacobian_dot(lengths, q, qd), atol=1e-14 * scale)


@given(states())
def test_jacobians_are_derivatives(state):
    lengths, q, qd = state
    arm = fp.PlanarArm(lengths)
    h = 1e-6
    scale = lengths.sum() * (1 + np.abs(qd).sum()) ** 2
    along = (arm.forward(q + h * qd) - arm.forward(q - h * qd)) / (2 * h)
    np.testing.assert_allclose(arm.jacobian(q) @ qd, along, atol=1e-8 * scale)
    change = (arm.jacobian(q + h * qd) - arm.jacobian(q - h * qd)) / (2 * h)
    np.testing.assert_allclose(arm.jacobian_dot(q, qd), change, atol=1e-8 * scale)


def test_an_arm_has_names_limits_and_repr(arm):
    assert arm.dof == 4
    assert repr(arm) == "PlanarArm(lengths=[1, 1, 1, 1])"
    assert arm.joint_names == ["joint_1", "joint_2", "joint_3", "joint_4"]
    assert np.all(arm.limits.upper == np.inf)
    assert arm.limits.lower.shape == (4,)
    assert pickle.loads(pickle.dumps(arm)) == arm
    assert hash(fp.PlanarArm([1, 1, 1, 1])) == hash(arm)
    assert arm != fp.PlanarArm([1, 1, 1, 2])


@pytest.mark.parametrize(
    ("lengths", "words"),
    [
        ([1, -0.5, 1], r"lengths\[1\] = -0.5: must be positive"),
        ([1, 0], r"lengths\[1\] = 0: must be positive"),
        ([np.nan, 1], r"lengths\[0\] = nan: must be positive"),
        ([1, np.inf], r"lengths\[1\] = inf: must be positive"),
        ([1], "lengths has 1 entries: must have 2 to 64"),
        (np.ones(65), "lengths has 65 entries"),
        ([[1, 1]], r"lengths = \[\[1, 1\]\]: must be real numbers of shape \(n,\)"),
        (["a", "b"], "lengths = .*: must be real numbers"),
        ([1, 2j], "lengths = .*: must be real numbers"),
        ([1, [2]], "lengths = .*: must be real numbers"),
        ([1, None], "lengths = .*: must be real numbers"),
        ([True, False], "lengths = .*: must be real numbers"),
        (None, "lengths = .*: must be real numbers"),
    ],
)
def test_bad_lengths(lengths, words):
    with pytest.raises(ValueError, match=words):
        fp.PlanarArm(lengths)


def test_bad_states(arm, q0):
    for call in (arm.forward, arm.jacobian):
        with pytest.raises(ValueError, match="q has 3 entries: must have 4, one per joint"):
            call(q0[:3])
        with pytest.raises(ValueError, match=r"q\[2\] = nan: must be finite"):
            call([0, 0, np.nan, 0])
    with pytest.raises(ValueError, match=r"qd\[0\] = inf: must be finite"):
        arm.jacobian_dot(q0, [np.inf, 0, 0, 0])
    with pytest.raises(ValueError, match="task = 'velocity': must be 'position' or 'pose'"):
        arm.jacobian(q0, task="velocity")


def test_a_planar_pose_has_the_angle_as_its_last_row(arm, q0):
    qd = np.arange(4.0)
    known = arm.kinematics(q0, qd, task="pose")
    np.testing.assert_allclose(known.tip, [*arm.forward(q0), q0.sum()], atol=1e-15)
    np.testing.assert_array_equal(known.J, [*arm.jacobian(q0), np.ones(4)])
    np.testing.assert_array_equal(known.Jd, [*arm.jacobian_dot(q0, qd), np.zeros(4)])
