"""Each panel shows the numbers of the run."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from plot_runs import a_run, a_run_in_space, a_run_within_limits, panels

import fpbm_cpp as fp
from fpbm_cpp import plot
from fpbm_cpp.plot import LIGHT, PANELS


def drawn(run: fp.Run, name: str) -> Any:
    axes = Figure().add_subplot()
    PANELS[name].draw(axes, run, LIGHT)
    return axes


def own_lines(axes: Any) -> list[Any]:
    return [line for line in axes.lines if "bound" not in line.get_label()]


def bounds(axes: Any) -> list[tuple[float, str]]:
    return [
        (line.get_ydata()[0], to_hex(line.get_color()).upper()) for line in axes.lines if "bound" in line.get_label()
    ]


@pytest.mark.parametrize(
    ("name", "array", "label"),
    [
        ("positions", "q", "$q$ [rad{}]"),
        ("velocities", "qd", r"$\dot q$ [rad/s{}]"),
        ("accelerations", "qdd", r"$\ddot q$ [rad/s²{}]"),
    ],
)
def test_joints(name: str, array: str, label: str) -> None:
    for run, slides in ((a_run(), ""), (a_run_in_space(), label[label.index("rad") + 3 : label.index("{")])):
        axes = drawn(run, name)
        unit = f", m{slides}" if run.arm.dof == 8 else ""
        assert axes.get_ylabel() == label.format(unit)
        assert axes.get_xlabel() == "time [s]"
        np.testing.assert_array_equal(np.transpose([line.get_ydata() for line in own_lines(axes)]), getattr(run, array))
    names = [text.get_text() for text in axes.get_legend().get_texts() if text.get_text() != "bound"]
    assert names == ["rail (prismatic)", *run.arm.joint_names[1:]]


def test_bounds_are_drawn_near_a_joint() -> None:
    run = a_run_within_limits()
    limits = run.options["limits"]
    (near,) = bounds(drawn(run, "positions"))
    assert near == (limits.lower[0], LIGHT.lines[0])  # In the joint's colour. The other bounds are far away.
    assert {abs(value) for value, _ in bounds(drawn(run, "velocities"))} == {limits.velocity[0]}
    assert bounds(drawn(run, "accelerations")) == []  # The bounds are infinite.


def test_common_bounds_of_joints_have_the_ink_colour() -> None:
    run, infinite = a_run(), np.full(4, np.inf)
    upper = np.full(4, run.q.max())
    limits = fp.JointLimits(lower=upper - 100.0, upper=upper, velocity=infinite, acceleration=infinite)
    assert bounds(drawn(replace(run, options={"limits": limits}), "positions")) == [(upper[0], LIGHT.ink)]


@pytest.mark.parametrize("run", [a_run, a_run_in_space], ids=lambda run: run.__name__)
def test_tip_error_is_its_size_on_a_logarithmic_axis(run: Any) -> None:
    run = run()
    axes = drawn(run, "error")
    assert axes.get_yscale() == "log"
    largest = [line.get_ydata().max() for line in axes.lines]
    assert largest == ([run.max_error(), run.max_orientation_error()] if run.task == "pose" else [run.max_error()])
    assert axes.get_ylim()[0] <= min(line.get_ydata().min() for line in axes.lines)
    assert axes.get_ylim()[1] >= max(largest)
    assert np.log10(axes.get_ylim()) == pytest.approx(np.round(np.log10(axes.get_ylim())), abs=1e-9)


def test_long_errors_are_drawn_by_their_envelope() -> None:
    run = a_run(dt=0.001)
    (line,) = drawn(run, "error").lines
    assert len(line.get_xdata()) == 400
    assert line.get_xdata()[-1] == 2.0
    assert line.get_ydata().max() == run.max_error()


@pytest.mark.parametrize(
    ("name", "rows", "unit"), [("axis_errors", slice(3), "m"), ("axis_orientation_errors", slice(3, 6), "rad")]
)
def test_errors_per_axis_are_in_a_power_of_ten(name: str, rows: slice, unit: str) -> None:
    run = a_run_in_space()
    axes = drawn(run, name)
    assert axes.get_ylabel().endswith(f" {unit}]")
    exponent = int(axes.get_ylabel().split("{")[1].split("}")[0])
    shown = np.transpose([line.get_ydata() for line in axes.lines])
    assert 1 <= np.abs(shown).max() < 10
    np.testing.assert_allclose(shown * 10.0**exponent, run.error[:, rows])


def test_manipulability_and_least_singular_value() -> None:
    run = a_run_in_space()
    axes = drawn(run, "manipulability")
    right = next(other for other in axes.figure.axes if other is not axes)
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), run.manipulability())
    least = [np.linalg.svd(run.arm.jacobian(q, task="pose"))[1].min() for q in run.q]
    np.testing.assert_allclose(right.lines[0].get_ydata(), least, rtol=1e-12)
    assert axes.get_ylim()[0] == right.get_ylim()[0] == 0


def test_null_space_velocity() -> None:
    run = a_run_in_space()
    expected = []
    for q, qd in zip(run.q, run.qd):
        J = run.arm.jacobian(q, task="pose")
        expected.append(np.linalg.norm((np.eye(8) - np.linalg.pinv(J) @ J) @ qd))
    assert max(expected) > 1e-3
    np.testing.assert_allclose(drawn(run, "null_space").lines[0].get_ydata(), expected, atol=1e-12)


def test_minimum_norm_velocities_have_no_null_space_component() -> None:
    run = fp.simulate(fp.PlanarArm([1, 1, 1]), fp.Line([-0.3, 0.1], 1.0), fp.MVN(), [0.3, 0.4, 0.5], dt=0.01)
    np.testing.assert_allclose(plot.null_space_velocities(run), 0.0, atol=1e-14)


def test_a_singular_posture_keeps_its_null_space_velocity() -> None:
    run = a_run()
    outstretched = replace(run, q=np.zeros((1, 4)), qd=np.array([[1.0, 0.0, 0.0, -1.0]]))
    J = run.arm.jacobian(np.zeros(4))[1:]  # The first row is zero.
    expected = np.linalg.norm(outstretched.qd[0] - np.linalg.pinv(J) @ J @ outstretched.qd[0])
    assert plot.null_space_velocities(outstretched)[0] == pytest.approx(expected)


def test_scale() -> None:
    run = a_run_within_limits()
    axes = drawn(run, "scale")
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), run.scale)
    assert axes.get_ylim()[0] == 0


def test_clearance_and_its_margin() -> None:
    run = a_run_within_limits()
    axes = drawn(run, "clearance")
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), run.clearance)
    assert set(axes.lines[1].get_ydata()) == {run.options["bounds"][0].margin}
    assert axes.get_ylim()[0] == 0
    assert drawn(replace(run, clearance=run.clearance - 0.1), "clearance").get_ylim()[0] < 0


def test_saturation_has_a_bar_for_each_time_on_a_bound() -> None:
    run = a_run_within_limits()
    bars = [
        path.get_extents() for collection in drawn(run, "saturation").collections for path in collection.get_paths()
    ]
    assert [(bar.x0, bar.x1) for bar in bars] == [pytest.approx((0.5, 1.0)), pytest.approx((2.0, 2.0))]
    assert all(bar.y0 < 2 < bar.y1 for bar in bars)


def test_arm_in_space() -> None:
    run = a_run_in_space()
    arm = panels(run.plot(panels=["arm"]))["Arm"]
    assert (arm.get_xlabel(), arm.get_ylabel(), arm.get_zlabel()) == ("x [m]", "y [m]", "z [m]")
    extent = np.diff([arm.get_xlim(), arm.get_ylim(), arm.get_zlim()])[:, 0]
    np.testing.assert_allclose(arm.get_box_aspect() / extent, arm.get_box_aspect()[0] / extent[0])


def test_arm_in_the_plane() -> None:
    run = a_run(task="pose")
    arm = panels(run.plot(panels=["arm"]))["Arm"]
    assert arm.get_aspect() == 1
    tip = next(line for line in arm.lines if line.get_label() == "tip")
    np.testing.assert_array_equal(tip.get_xydata(), run.x[:, :2])
    postures = [line.get_xydata() for line in arm.lines if len(line.get_xdata()) == 5]
    np.testing.assert_array_equal(postures[0], plot.joint_points(run.arm, run.q[0]))
    np.testing.assert_array_equal(postures[-1], plot.joint_points(run.arm, run.q[-1]))
    assert len(postures) == 11
