"""Points and axes with which an arm is drawn."""

from __future__ import annotations

import numpy as np
import pytest

import fpbm_cpp as fp
from fpbm_cpp.skeleton import frames_of, joint_points, joints_of, link_frames


def test_joint_points() -> None:
    arm, q = fp.PlanarArm([1.0, 0.5, 0.25]), np.array([[0.1, 0.2, 0.3], [1.0, -2.0, 0.5]])
    points = joint_points(arm, q)
    assert points.shape == (2, 4, 2)
    np.testing.assert_array_equal(points[:, 0], 0)
    np.testing.assert_allclose(points[:, -1], [arm.forward(row) for row in q], atol=1e-15)


def test_joint_points_of_a_planar_arm_in_space() -> None:
    lengths, q = np.array([1.0, 0.5, 0.25]), np.array([[0.1, 0.2, 0.3], [1.0, -2.0, 0.5]])
    embedded = fp.SerialArm.from_dh([(length, 0, 0, 0) for length in lengths], "classic")
    points = joint_points(embedded, q)
    assert points.shape == (2, 5, 3)
    np.testing.assert_array_equal(points[:, 0], 0)  # The base, where the first joint is.
    np.testing.assert_allclose(points[:, 1:, :2], joint_points(fp.PlanarArm(lengths), q), atol=1e-15)
    np.testing.assert_allclose(points[..., 2], 0, atol=1e-15)


def some_arms() -> dict[str, fp.SerialArm]:
    rng = np.random.default_rng(5)

    def frame() -> np.ndarray:
        result = np.eye(4)
        result[:3, :3], result[:3, 3] = fp.rotation(rng.uniform(-1, 1, 3)), rng.uniform(-0.5, 0.5, 3)
        return result

    def joint(kind: str, **options: object) -> fp.Joint:
        return fp.Joint(kind, frame(), rng.uniform(-2, 2, 3), **options)

    kinds = ["prismatic", "revolute", "continuous", "prismatic", "revolute"]
    followed = [joint("revolute"), joint("prismatic", mimic=(2, 0.5, 0.1)), joint("revolute"), joint("prismatic")]
    return {
        **{name: fp.SerialArm.preset(name) for name in fp.arms.PRESETS},
        "mixed": fp.SerialArm([joint(kind) for kind in kinds], frame()),
        "followers": fp.SerialArm([*followed, joint("revolute", mimic=(0, -1.0, 0.2))], frame()),
    }


@pytest.mark.parametrize("name", some_arms())
def test_joint_points_end_at_the_tip(name: str) -> None:
    arm = some_arms()[name]
    q = np.random.default_rng(6).uniform(-1.5, 1.5, (2, 3, arm.dof))
    points = joint_points(arm, q)
    assert points.shape == (2, 3, len(arm.joints) + 2, 3)
    tips = [[arm.forward(posture)[:3, 3] for posture in row] for row in q]
    np.testing.assert_allclose(points[..., -1, :], tips, atol=1e-14)
    for i in range(len(arm.joints)):
        if all(joint.mimic is None for joint in arm.joints[: i + 1]):
            here = fp.SerialArm(arm.joints[: i + 1])
            np.testing.assert_allclose(points[0, 0, i + 1], here.forward(q[0, 0, : i + 1])[:3, 3], atol=1e-14)


def joint_axes(arm: fp.SerialArm | fp.PlanarArm, q: np.ndarray) -> np.ndarray:
    """Along each joint, by the frame of the link that it moves."""
    axes = np.array([joint.axis / np.linalg.norm(joint.axis) for joint in joints_of(arm)])
    return np.einsum("...ij,...j->...i", link_frames(arm, q)[..., 1:, :3, :3], axes)


@pytest.mark.parametrize("name", ["panda", "mixed"])
def test_joint_axes_move_the_tip(name: str) -> None:
    arm = some_arms()[name]
    q = np.random.default_rng(8).uniform(-1.5, 1.5, arm.dof)
    axes, points = joint_axes(arm, q), joint_points(arm, q)
    slides = np.array([joint.type == "prismatic" for joint in arm.joints])[:, None]
    swept = np.where(slides, axes, np.cross(axes, points[-1] - points[1:-1]))
    np.testing.assert_allclose(swept.T, arm.jacobian(q), atol=1e-14)


def test_joint_axes_of_a_planar_arm() -> None:
    assert joint_axes(fp.PlanarArm([1.0, 0.5]), np.zeros((3, 2))).tolist() == [[[0.0, 0.0, 1.0]] * 2] * 3


@pytest.mark.parametrize("name", some_arms())
def test_tip_axes_equal_the_rotation_of_the_tip(name: str) -> None:
    arm = some_arms()[name]
    q = np.random.default_rng(7).uniform(-1.5, 1.5, arm.dof)
    np.testing.assert_allclose(frames_of(arm, q, "tip"), arm.forward(q), atol=1e-14)


def test_tip_axes_of_a_planar_arm_continue_its_last_link() -> None:
    arm, q = fp.PlanarArm([1.0, 0.5, 0.25]), np.array([0.1, -2.0, 0.5])
    R = frames_of(arm, q, "tip")[:2, :2]
    *_, before, tip = joint_points(arm, q)
    np.testing.assert_allclose(R[:, 0], (tip - before) / 0.25, atol=1e-15)
    np.testing.assert_allclose(R.T @ R, np.eye(2), atol=1e-15)
    assert np.linalg.det(R) == pytest.approx(1.0)
