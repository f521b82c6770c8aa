"""Figures of several motions on one job."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from matplotlib.colors import to_hex
from plot_runs import a_run, a_run_in_space, assert_tidy, luminance, panels

import fpbm_cpp as fp
from fpbm_cpp.plot import LIGHT, compare


def test_compare_poses() -> None:
    runs = {"with damping": a_run_in_space(), "held": a_run_in_space(hold=1.0)}
    figure = compare(runs, "one job")
    assert figure.get_suptitle() == "one job"
    drawn = panels(figure)
    velocity, acceleration, posture, error, orientation_error, manipulability = drawn.values()
    labels = [axes.get_ylabel().split("[")[-1] for axes in (velocity, acceleration, posture, error, orientation_error)]
    assert labels == ["rad/s, m/s]", "rad/s², m/s²]", "rad, m]", "m]", "rad]"]
    assert [axes.get_yscale() for axes in drawn.values()] == ["linear"] * 3 + ["log"] * 2 + ["linear"]
    for axes in drawn.values():
        assert [to_hex(line.get_color()).upper() for line in axes.lines] == list(LIGHT.lines[:2])
        assert all(np.isfinite(line.get_xydata()).all() for line in axes.lines)
    for i, run in enumerate(runs.values()):
        np.testing.assert_allclose(velocity.lines[i].get_ydata(), np.linalg.norm(run.qd, axis=1))
        np.testing.assert_allclose(acceleration.lines[i].get_ydata(), np.linalg.norm(run.qdd, axis=1))
        np.testing.assert_allclose(posture.lines[i].get_ydata(), np.linalg.norm(run.q - run.q[0], axis=1))
        np.testing.assert_array_equal(manipulability.lines[i].get_ydata(), run.manipulability())
        assert error.lines[i].get_ydata().max() == run.max_error()
        assert orientation_error.lines[i].get_ydata().max() == run.max_orientation_error()
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
    with pytest.raises(ValueError, match="runs: must hold at least one run"):
        compare([])


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("run", [a_run, a_run_in_space], ids=lambda run: run.__name__)
def test_comparisons_are_tidy(run: Any, dark: bool) -> None:
    runs = {f"a name of some length, {i}": run() for i in range(4)}
    figure = compare(runs, "A heading that says what was compared with what", dark=dark)
    assert_tidy(figure)
    assert (luminance(figure.get_facecolor()) < 0.02) == dark


def test_axes_are_labelled() -> None:
    figure = compare([a_run_in_space()])
    figure.draw_without_rendering()
    drawn = panels(figure).values()
    assert [bool(axes.get_xlabel()) for axes in drawn] == [False, False, True, False, False, True]
    for axes in drawn:
        assert axes.get_ylabel()
        assert any(label.get_text() for label in axes.get_yticklabels())
