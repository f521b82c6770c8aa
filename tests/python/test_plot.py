"""Figures of any run: their panels, layout and legibility."""

from __future__ import annotations

import struct
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from io import BytesIO

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from matplotlib.colors import to_hex
from plot_runs import a_run, a_run_in_space, a_run_within_limits, a_stopped_run, assert_tidy, luminance, panels

import fpbm_cpp as fp
from fpbm_cpp.plot import DARK, LIGHT, OVERVIEW, PANELS, plot_run


def headings(run: fp.Run, *names: str) -> list[str]:
    return [title.split(") ")[-1] for title in panels(run.plot(panels=names or None))]


def test_overview() -> None:
    assert headings(a_run()) == [
        "Arm",
        "Manipulability",
        "Null-space velocity",
        "Tip error",
        "Joint positions",
        "Joint velocities",
        "Joint accelerations",
    ]


def test_overview_within_limits_shows_their_effects() -> None:
    new = set(headings(a_run_within_limits())) - set(headings(a_run()))
    assert new == {"Joints on a bound", "Task scale", "Clearance"}


def a_run_of_a_stack() -> fp.Run:
    arm, q0 = fp.SerialArm.preset("panda"), [0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785]
    stack = fp.Stack(fp.PoseTask(), fp.PositionTask("panda_joint4", rows=("z",), name="elbow"))
    path = fp.Line([0.1, 0.1, 0.0], 1.0)
    return fp.track(arm, path, fp.WMVN(np.ones(7)), q0, dt=0.01, stack=stack, task="pose")


def test_a_run_of_a_stack_has_its_tasks() -> None:
    assert set(headings(a_run_of_a_stack())) - set(headings(a_run_within_limits())) == {"Task errors"}
    (axes,) = panels(a_run_of_a_stack().plot(panels=["task_errors"])).values()
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels == ["pose [m]", "pose [rad]", "elbow [m]"]
    (axes,) = panels(a_run_of_a_stack().plot(panels=["scale"])).values()
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["pose", "elbow"]


@pytest.mark.parametrize("name", PANELS)
def test_each_panel_alone_is_as_wide_as_a_column(name: str) -> None:
    special = {"axis_orientation_errors": a_run_in_space, "task_errors": a_run_of_a_stack, "torques": a_run_in_space}
    run = special.get(name, a_run_within_limits)()
    figure = run.plot(panels=[name])
    assert list(panels(figure)) == [PANELS[name].heading]
    assert figure.get_figwidth() == 3.5


def test_panels_have_the_requested_order() -> None:
    assert headings(a_run(), "velocities", "error") == ["Joint velocities", "Tip error"]
    assert headings(a_run(), "velocities", "arm", "error") == ["Arm", "Joint velocities", "Tip error"]


def test_panels_without_data_are_omitted() -> None:
    assert headings(a_run(), "scale", "error", "saturation", "axis_orientation_errors") == ["Tip error"]


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["velocity"], "panels: 'velocity' must be one of arm, error, axis_errors, .*null_space$"),
        ("velocity", "panels: 'velocity' must be one of arm"),
        (["arm", "error", "arm"], "panels: 'arm' is given twice"),
        (["scale"], r"panels = \('scale',\): no data in this run: must have one of arm, error"),
        ([], r"panels = \(\): no data in this run"),
    ],
)
def test_invalid_panels_are_rejected(names: list[str], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        a_run().plot(panels=names)


def test_a_custom_title_is_shown() -> None:
    assert plot_run(a_run(), "two words", panels=["error"]).get_suptitle() == "two words"


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize(
    "run", [a_run, a_run_in_space, a_run_within_limits, a_stopped_run], ids=lambda run: run.__name__
)
def test_overviews_are_tidy(run: object, dark: bool) -> None:
    assert_tidy(run().plot(dark=dark))


@pytest.mark.parametrize("joints", [3, 7, 20])
def test_one_legend_for_all_joints(joints: int) -> None:
    figure = a_run(joints).plot(panels=("arm", "positions", "velocities", "accelerations"))
    assert_tidy(figure)
    (legend,) = (legend for part in figure.subfigs for legend in part.legends)
    assert [text.get_text() for text in legend.get_texts()] == [f"joint {i}" for i in range(1, joints + 1)]
    assert [axes.get_legend() for title, axes in panels(figure).items() if "Arm" not in title] == [None] * 3


def test_time_is_labelled_below_each_column_only() -> None:
    drawn = panels(a_run().plot())
    labels = {title.split(") ")[1]: axes.get_xlabel() for title, axes in drawn.items()}
    assert [title for title, label in labels.items() if label == "time [s]"] == [
        "Null-space velocity",
        "Joint accelerations",
    ]
    assert {axes.get_xlim() for title, axes in drawn.items() if "Arm" not in title} == {(0.0, 2.0)}


@pytest.mark.parametrize("theme", [LIGHT, DARK])
def test_lines_are_distinguishable_without_colours(theme: object) -> None:
    styles = [style for style, _ in zip(theme.styles(), range(28))]
    assert len(set(styles)) == 28
    first = styles[:7]
    for i, (colour, dash) in enumerate(first):
        for other, its in first[:i]:
            dark, light = sorted([luminance(colour), luminance(other)])
            assert dash != its or (light + 0.05) / (dark + 0.05) > 1.4


def test_dark_figures_have_dark_backgrounds() -> None:
    figure = a_run().plot(dark=True, panels=["velocities", "error"])
    assert luminance(figure.get_facecolor()) < 0.02
    (axes, _) = panels(figure).values()
    assert luminance(axes.get_facecolor()) < 0.02
    assert [to_hex(line.get_color()).upper() for line in axes.lines] == [colour.upper() for colour in DARK.lines[:4]]


def test_velocity_level_scheme() -> None:
    run = fp.simulate(fp.PlanarArm([1, 1, 1]), fp.Line([-0.3, 0.1], 1.0), fp.MVN(), [0.3, 0.4, 0.5], dt=0.01)
    assert len(panels(run.plot())) == 7


def test_stopped_run_is_plotted_up_to_its_stop() -> None:
    run = a_stopped_run()
    assert not run.status
    figure = run.plot()
    assert figure.get_suptitle().splitlines()[-1] == f"stopped after t = {run.status.time:g} s"
    assert panels(figure)["(f) Joint velocities"].lines[0].get_xdata()[-1] == run.t[-1]


@pytest.mark.parametrize("space", [False, True])
def test_run_without_samples_is_plotted(space: bool) -> None:
    arm = fp.SerialArm.preset("panda") if space else fp.PlanarArm([1, 1])
    path = fp.Line([1, 0, 0] if space else [1, 0], 1.0)
    task = "pose" if space else "position"
    run = fp.simulate(arm, path, fp.MAN(), np.zeros(arm.dof), dt=0.01, task=task, partial=True)
    assert len(run.t) == 0
    run.plot().savefig(BytesIO(), format="png")


def test_title_has_rounded_numbers() -> None:
    scheme = fp.MAN(null_damping=np.pi / 4)
    run = fp.simulate(fp.PlanarArm([1, 1, 1]), fp.Line([-0.3, 0.1], 1.0), scheme, [0.3, 0.4, 0.5], dt=0.01)
    assert "null_damping=0.78539" in repr(scheme)
    assert "null_damping=0.7854)" in run.plot(panels=["error"]).get_suptitle().replace("\n", " ")


def test_names_of_the_overview() -> None:
    assert set(PANELS) - set(OVERVIEW) == {"axis_errors", "axis_orientation_errors", "torques"}


def test_threads_and_no_global_state() -> None:
    def drawn(_: int) -> bytes:
        file = BytesIO()
        run.plot(panels=("arm", "error", "velocities"), dark=True).savefig(file, format="png", dpi=50)
        return file.getvalue()

    run = a_run()
    with ThreadPoolExecutor(2) as pool:
        first, second = pool.map(drawn, range(2))
    assert first == second
    assert "matplotlib.pyplot" not in sys.modules


def test_a_notebook_shows_a_figure_as_a_picture() -> None:
    figure = a_run().plot(panels=["error"])
    png, size = figure._repr_png_()
    width, height = struct.unpack(">II", png[16:24])
    assert abs(width - 2 * size["width"]) <= 2
    assert abs(height - 2 * size["height"]) <= 2


def test_a_notebook_shows_a_figure_once_with_and_without_matplotlib_inline() -> None:
    """A kernel displays the last value of a cell: one picture in each case."""
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    make = (
        "import fpbm_cpp as fp\n"
        "run = fp.simulate(fp.PlanarArm([1, 1, 1]), fp.Circle(0.1, 1.0), fp.MVN(), [0.3, 0.3, 0.3], dt=0.01)\n"
        "run.plot(panels=['error'])"
    )
    cells = [make, "%matplotlib inline", "run.plot(panels=['error'])", "run"]
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    try:
        nbclient.NotebookClient(book, timeout=120, kernel_name="python3").execute()
    except nbclient.exceptions.CellExecutionError:
        raise
    except Exception as unavailable:
        pytest.skip(f"no kernel: {unavailable}")
    first, _, second, run = (cell["outputs"] for cell in book["cells"])
    for outputs in (first, second):
        assert [("image/png" in each.get("data", {})) for each in outputs] == [True]
    assert "text/html" in run[0]["data"]


@pytest.mark.parametrize("name", ["positions", "velocities", "accelerations"])
def test_all_bounds_are_shown_on_request(name: str) -> None:
    run = a_run_in_space()
    without, bounded = (
        [line for line in run.plot(panels=[name], bounds=bounds).axes[0].lines if len(line.get_xdata()) == 2]
        for bounds in (False, True)
    )
    limits = run.limits
    low, high = {
        "positions": (limits.lower, limits.upper),
        "velocities": (-limits.velocity, limits.velocity),
        "accelerations": (-limits.acceleration, limits.acceleration),
    }[name]
    every = np.concatenate([np.unique(each[np.isfinite(each)]) for each in (low, high)])
    assert sorted(line.get_ydata()[0] for line in bounded) == pytest.approx(sorted(every))
    assert len(without) < len(bounded) or len(every) == len(without)


@pytest.mark.parametrize("name", ["velocities", "error"])
def test_one_panel_has_room_for_its_data(name: str) -> None:
    figure = a_run_in_space().plot(panels=[name])
    figure.draw_without_rendering()
    (axes,) = figure.axes
    inside = axes.get_window_extent().height / figure.dpi
    assert inside > 1.4


def test_the_legend_of_a_stack_is_above_its_lines() -> None:
    run = a_run_of_a_stack()
    figure = run.plot(panels=["task_errors", "scale"])
    figure.draw_without_rendering()
    for axes in figure.axes:
        legend = axes.get_legend().get_window_extent()
        for line in axes.get_lines():
            points = axes.transData.transform(np.column_stack(line.get_data()))
            points = points[np.isfinite(points).all(axis=1)]
            assert points[:, 1].max() < legend.y0, line.get_label()


def test_objects_have_short_forms() -> None:
    arm, q0 = fp.SerialArm.preset("panda"), np.array([0, -0.78, 0, -2.35, 0, 1.57, 0.78])
    tracker = fp.Tracker(arm, fp.MVN(), q0)
    follower = tracker.follow(fp.Line([0.1, 0, 0], 2.0))
    tick = tracker.tick(follower)
    filtered = fp.TargetFilter(np.zeros(3), velocity=1, acceleration=2, jerk=10)
    for each, start in (
        (tracker, "<Tracker of 7 joints: q = [0, -0.78,"),
        (tick, "<Tick: OK"),
        (filtered, "<TargetFilter: x at [0, 0, 0]"),
        (follower, "<PathFollower: on its path>"),
    ):
        assert repr(each).startswith(start)
        assert len(repr(each)) < 200
    sweep = fp.sweep(fp.PlanarArm([1, 1, 1]), fp.Circle(0.1, 1.0), [fp.MVN()], [[0.3] * 3], dt=0.01)
    for each in (arm, fp.PlanarArm([1, 1]), fp.Robot.preset("two_pandas"), sweep, a_run()):
        html = each._repr_html_()
        assert html.startswith("<table><caption>")
        assert html.count("<tr>") <= 20
        assert len(html) < 3000


def test_missing_matplotlib() -> None:
    program = "import sys; sys.modules['matplotlib'] = None\nimport fpbm_cpp.plot"
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert result.stderr.strip().endswith('ImportError: plotting needs matplotlib: pip install "fpbm_cpp[plot]"')
