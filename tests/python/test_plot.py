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
from fpbm_cpp.plot import compose, joint_points


def a_run(joints: int = 4, **options: object) -> fp.Run:
    return fp.simulate(
        fp.PlanarArm(np.full(joints, 4 / joints)),
        fp.Circle(0.3, 2.0),
        fp.FPBM(0.5, np.arange(1, joints + 1), 1, 1, null_damping=1.0),
        np.full(joints, 1.5 / joints),
        **{"dt": 0.01, **options},
    )


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
