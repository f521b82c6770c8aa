"""Figures of any run."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from io import BytesIO

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from matplotlib.colors import to_hex
from matplotlib.figure import Figure

import fpbm_cpp as fp
from fpbm_cpp.plot import OKABE_ITO, compare, compose, joint_points


def a_run(joints: int = 4, **options: object) -> fp.Run:
    return fp.simulate(
        fp.PlanarArm(np.full(joints, 4 / joints)),
        fp.Circle(0.3, 2.0),
        fp.FPBM(0.5, np.arange(1, joints + 1), 1, 1, null_damping=1.0),
        np.full(joints, 1.5 / joints),
        **{"dt": 0.01, **options},
    )


def a_run_in_space(task: str = "pose", **options: object) -> fp.Run:
    """An arm on a rail, 8 joints of which one slides."""
    panda = fp.SerialArm.preset("panda")
    arm = fp.SerialArm([fp.Joint("prismatic", axis=(0, 1, 0), name="rail"), *panda.joints], panda.tip)
    q0 = [0.1, 0, -0.8, 0, -2.4, 0, 1.6, 0.8]
    scheme = fp.FPBM(0.5, np.arange(1, 9), 20, 100, null_damping=1.0)
    return fp.simulate(arm, fp.Circle(0.1, 2.0).in_plane("yz"), scheme, q0, task=task, **{"dt": 0.01, **options})


def panels(figure: Figure) -> dict[str, object]:
    return {axes.get_title(loc="left"): axes for axes in figure.axes if axes.get_title(loc="left")}


def test_panels_and_units() -> None:
    run = a_run()
    drawn = panels(run.plot())
    assert [title.split()[0] for title in drawn] == ["(a)", "(b)", "(c)", "(d)"]
    arm, error, velocity, acceleration = drawn.values()
    assert arm.get_xlabel() == "x [m]"
    assert arm.get_aspect() == 1
    assert "m]" in error.get_ylabel()
    assert velocity.get_ylabel() == "velocity [rad/s]"
    assert acceleration.get_ylabel() == "acceleration [rad/s²]"
    assert all(axes.get_xlabel() == "time [s]" for axes in (error, velocity, acceleration))
    for axes, values in ((velocity, run.qd), (acceleration, run.qdd)):
        np.testing.assert_array_equal(np.transpose([line.get_ydata() for line in axes.lines]), values)


def test_error_is_in_a_power_of_ten() -> None:
    run = a_run()
    error = list(panels(run.plot()).values())[1]
    exponent = int(error.get_ylabel().split("{")[1].split("}")[0])
    shown = np.transpose([line.get_ydata() for line in error.lines])
    assert 1 <= np.abs(shown).max() < 10
    np.testing.assert_allclose(shown * 10.0**exponent, run.error)


@pytest.mark.parametrize("joints", [3, 7, 20])
def test_legends_cover_no_axes(joints: int) -> None:
    figure = a_run(joints).plot()
    figure.draw_without_rendering()
    legends = [axes.get_legend() for axes in panels(figure).values()]
    assert [len(legend.get_texts()) for legend in legends] == [2, 2, joints, joints]
    inside = figure.bbox.padded(1)
    for legend in legends:
        box = legend.get_window_extent()
        assert inside.x0 <= box.x0 <= box.x1 <= inside.x1
        for axes in figure.axes:
            area = axes.get_window_extent()
            assert box.x0 >= area.x1 or box.x1 <= area.x0 or box.y0 >= area.y1 or box.y1 <= area.y0


def test_joints_can_be_told_apart() -> None:
    velocity = list(panels(a_run(20).plot()).values())[2]
    assert len({(to_hex(line.get_color()), line.get_linestyle()) for line in velocity.lines}) == 20


def test_three_panels() -> None:
    assert len(panels(compose(a_run(), "without accelerations", panels=3))) == 3


def test_velocity_level_scheme() -> None:
    run = fp.simulate(fp.PlanarArm([1, 1, 1]), fp.Line([-0.3, 0.1], 1.0), fp.MVN(), [0.3, 0.4, 0.5], dt=0.01)
    assert len(panels(run.plot())) == 4


def test_stopped_run_is_plotted_up_to_there() -> None:
    arm, path = fp.PlanarArm([1, 1, 1]), fp.Line([3.0, 0.0], 2.0)
    run = fp.simulate(arm, path, fp.MAN(), [0.3, 0.4, 0.5], dt=0.01, partial=True)
    assert not run.status
    figure = run.plot()
    assert f"stopped after t = {run.status.time:g} s" in figure.get_suptitle().replace("\n", " ")
    assert panels(figure)["(c) Joint velocities"].lines[0].get_xdata()[-1] == run.t[-1]


def test_run_that_never_started() -> None:
    run = fp.simulate(fp.PlanarArm([1, 1]), fp.Line([1, 0], 1.0), fp.MAN(), [0, 0], dt=0.01, partial=True)
    assert len(run.t) == 0
    run.plot().savefig(BytesIO(), format="png")


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
        **{name: fp.SerialArm.preset(name) for name in ("panda", "iiwa14", "gen3")},
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


def test_pose_in_space() -> None:
    run = a_run_in_space()
    drawn = panels(run.plot())
    arm, manipulability, error, turn_error, velocity, acceleration = drawn.values()
    assert [title[:3] for title in drawn] == ["(a)", "(b)", "(c)", "(d)", "(e)", "(f)"]
    assert (arm.get_xlabel(), arm.get_ylabel(), arm.get_zlabel()) == ("x [m]", "y [m]", "z [m]")
    reach = np.diff([arm.get_xlim(), arm.get_ylim(), arm.get_zlim()])[:, 0]
    np.testing.assert_allclose(arm.get_box_aspect() / reach, arm.get_box_aspect()[0] / reach[0])
    np.testing.assert_array_equal(manipulability.lines[0].get_ydata(), run.manipulability())
    assert manipulability.get_ylim()[0] == 0
    for axes, unit, rows in ((error, "m", slice(3)), (turn_error, "rad", slice(3, 6))):
        assert axes.get_ylabel().endswith(f" {unit}]")
        exponent = int(axes.get_ylabel().split("{")[1].split("}")[0])
        shown = np.transpose([line.get_ydata() for line in axes.lines])
        np.testing.assert_allclose(shown * 10.0**exponent, run.error[:, rows])
    for axes, values, per in ((velocity, run.qd, "/s"), (acceleration, run.qdd, "/s²")):
        assert axes.get_ylabel().endswith(f"[rad{per}, m{per}]")
        np.testing.assert_array_equal(np.transpose([line.get_ydata() for line in axes.lines]), values)
        names = [text.get_text() for text in axes.get_legend().get_texts()]
        assert names == [f"rail [m{per}]", *run.arm.joint_names[1:]]


def test_position_in_space() -> None:
    drawn = panels(a_run_in_space("position").plot())
    assert len(drawn) == 5
    assert not any("Orientation" in title for title in drawn)


def test_pose_in_the_plane() -> None:
    run = a_run(task="pose")
    drawn = panels(run.plot())
    arm, _, turn_error, *_ = drawn.values()
    assert len(drawn) == 5
    assert turn_error.get_ylabel().endswith("rad]")
    tip = next(line for line in arm.lines if line.get_label() == "tip")
    np.testing.assert_array_equal(tip.get_xydata(), run.x[:, :2])


@pytest.mark.parametrize("task", ["pose", "position"])
def test_legends_cover_no_axes_in_space(task: str) -> None:
    figure = a_run_in_space(task).plot()
    figure.draw_without_rendering()
    drawn = list(panels(figure).values())
    for legend in (axes.get_legend() for axes in drawn[2:]):
        box = legend.get_window_extent()
        assert figure.bbox.padded(1).containsx(box.x0)
        assert figure.bbox.padded(1).containsx(box.x1)
        for other in drawn[1:]:
            area = other.get_window_extent()
            assert box.x0 >= area.x1 or box.x1 <= area.x0 or box.y0 >= area.y1 or box.y1 <= area.y0


def test_run_in_space_that_never_started() -> None:
    arm = fp.SerialArm.preset("panda")
    run = fp.simulate(arm, fp.Line([0.1, 0, 0], 1.0), fp.MAN(), np.zeros(7), dt=0.01, task="pose", partial=True)
    assert len(run.t) == 0
    run.plot().savefig(BytesIO(), format="png")


def test_title_is_short_of_digits() -> None:
    scheme = fp.MAN(null_damping=np.pi / 4)
    run = fp.simulate(fp.PlanarArm([1, 1, 1]), fp.Line([-0.3, 0.1], 1.0), scheme, [0.3, 0.4, 0.5], dt=0.01)
    assert "null_damping=0.78539" in repr(scheme)
    assert "null_damping=0.7854)" in run.plot().get_suptitle()


def test_compare_poses() -> None:
    runs = {"with damping": a_run_in_space(), "held": a_run_in_space(hold=1.0)}
    figure = compare(runs, "one job")
    assert figure.get_suptitle() == "one job"
    drawn = panels(figure)
    velocity, acceleration, posture, error, turn_error, manipulability = drawn.values()
    labels = [axes.get_ylabel().split("[")[-1] for axes in (velocity, acceleration, posture, error, turn_error)]
    assert labels == ["rad/s, m/s]", "rad/s², m/s²]", "rad, m]", "m]", "rad]"]
    assert [axes.get_yscale() for axes in drawn.values()] == ["linear"] * 3 + ["log"] * 2 + ["linear"]
    for axes in drawn.values():
        assert [to_hex(line.get_color()).upper() for line in axes.lines] == list(OKABE_ITO[:2])
        assert all(np.isfinite(line.get_xydata()).all() for line in axes.lines)
    for i, run in enumerate(runs.values()):
        np.testing.assert_allclose(velocity.lines[i].get_ydata(), np.linalg.norm(run.qd, axis=1))
        np.testing.assert_allclose(acceleration.lines[i].get_ydata(), np.linalg.norm(run.qdd, axis=1))
        np.testing.assert_allclose(posture.lines[i].get_ydata(), np.linalg.norm(run.q - run.q[0], axis=1))
        np.testing.assert_array_equal(manipulability.lines[i].get_ydata(), run.manipulability())
        assert error.lines[i].get_ydata().max() == run.max_error()
        assert turn_error.lines[i].get_ydata().max() == run.max_turn_error()
    (legend,) = (legend for part in figure.subfigs for legend in part.legends)
    assert [text.get_text() for text in legend.get_texts()] == list(runs)


def test_compare_positions_by_the_names_of_their_schemes() -> None:
    mvn = fp.simulate(fp.PlanarArm([1, 1, 1]), fp.Line([-0.3, 0.1], 1.0), fp.MVN(), [0.3, 0.4, 0.5], dt=0.01)
    figure = compare([a_run(), mvn, a_run(dt=0.001)])
    assert len(panels(figure)) == 4
    (legend,) = (legend for part in figure.subfigs for legend in part.legends)
    assert [text.get_text() for text in legend.get_texts()] == ["FPBM 1", "MVN", "FPBM 2"]
    error = panels(figure)["(c) Tip error"]
    assert error.lines[2].get_xdata()[-1] == 2.0
    assert len(error.lines[2].get_xdata()) < 1000
    assert error.lines[2].get_ydata().max() == pytest.approx(a_run(dt=0.001).max_error())


def test_compare_nothing() -> None:
    with pytest.raises(ValueError, match="runs: must hold one at least"):
        compare([])


def test_threads_and_no_global_state() -> None:
    def drawn(_: int) -> bytes:
        file = BytesIO()
        run.plot().savefig(file, format="png", dpi=50)
        return file.getvalue()

    run = a_run()
    with ThreadPoolExecutor(2) as pool:
        first, second = pool.map(drawn, range(2))
    assert first == second
    assert "matplotlib.pyplot" not in sys.modules


def test_missing_matplotlib_is_said_plainly() -> None:
    program = "import sys; sys.modules['matplotlib'] = None\nimport fpbm_cpp.plot"
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert result.stderr.strip().endswith('ImportError: plotting needs matplotlib: pip install "fpbm_cpp[plot]"')
