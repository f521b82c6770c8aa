"""The viewer: it shows the run for every caller, and no action on the page breaks it."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from browser import eventually, opened
from hypothesis import given, settings
from hypothesis import strategies as st

import fpbm_cpp as fp

pytest.importorskip("viser")
pytest.importorskip("yourdfpy")

from viser.transforms import SO3

from fpbm_cpp.parameter import parameters
from fpbm_cpp.skeleton import joint_points
from fpbm_cpp.viewer import Viewer, controls
from fpbm_cpp.viewer import viewer as viewer_module
from fpbm_cpp.viewer.playback import FRAMES, Playback
from fpbm_cpp.viewer.scene import Links, Meshes, along

READY = np.array([0, -0.3, 0, -2.2, 0, 2.0, 0.785])
Q0 = np.pi / np.array([12, 12, 15, 15])
CLICK = SimpleNamespace(client="somebody", target=None)  # Attributes of the page's own events.


def fpbm(n=4, **options):
    return fp.FPBM(0.6, np.arange(1, n + 1), 10, 25, **options)


def a_run(scheme=None, path=None, q0=Q0, **how):
    """The paper's robot on a small circle."""
    arm, path = fp.PlanarArm([1, 1, 1, 1]), path or fp.Circle(0.2, 2.0)
    return fp.simulate(arm, path, scheme or fpbm(), q0, partial=True, **{"dt": 0.01, **how})


def a_viewer(scheme=None, **how):
    return Viewer(a_run(scheme, **how), port=0)


@pytest.fixture(scope="module")
def shared():
    with a_viewer(hold=1.0) as viewer:
        yield viewer


@pytest.fixture
def viewer(shared):
    shared.pause()
    shared.scheme = fpbm()
    shared.time = 0.0
    return shared


def readout(viewer):
    return viewer._readout._status.content + viewer._readout._table.content


def same(run, expected):
    for name in ("t", "q", "qd", "qdd", "x", "error"):
        assert getattr(run, name).tobytes() == getattr(expected, name).tobytes(), name


def test_the_shown_run_equals_the_simulation(viewer):
    arm, path, q0 = viewer.run.arm, viewer.run.path, viewer.run.q[0]
    for scheme in (fpbm(), fp.MVN(k=5), fp.WMVN([4, 3, 2, 1]), fp.MAN(), fp.Balanced(0.2, np.ones(4))):
        viewer.scheme = scheme
        expected = fp.simulate(arm, path, scheme, q0, dt=0.01, hold=1.0)
        same(viewer.run, expected)
        assert viewer.scheme is scheme
        assert f"{expected.max_error():.3g} m" in readout(viewer)
        assert f"{np.abs(expected.qd).max():.3g} rad/s" in readout(viewer)
        assert f"{expected.manipulability().min():.3g}" in readout(viewer)
        assert "complete, t = 3 s" in readout(viewer)
        drawn = viewer._chart._plot.data
        np.testing.assert_array_equal(np.transpose(drawn[1:-1]), expected.qd)


def test_the_arm_is_shown_at_the_selected_time(viewer):
    run = viewer.run
    for moment in (0.0, 0.5, 1.234, 3.0):
        viewer.time = moment
        sample = round(moment / 0.01)
        points = joint_points(run.arm, run.q[sample])
        joints = [joint.position[:2] for joint in viewer._scene._arm._joints]
        np.testing.assert_allclose(joints, points[:-1], atol=1e-6)
        np.testing.assert_allclose(viewer._scene._tip.position[:2], run.x[sample], atol=1e-6)
        np.testing.assert_allclose(viewer._scene._path.points[-1, 1, :2], run.x[sample], atol=1e-6)
        assert f"{np.abs(run.qd[sample]).max():.3g} rad/s" in readout(viewer)
        line = viewer._chart._plot.data[-1]
        at = viewer._chart._plot.data[0][~np.isnan(line)]
        assert abs(at - moment).min() < 0.02
    viewer.time = 99.0
    assert viewer.time == 3.0
    viewer.time = -1.0
    assert viewer.time == 0.0


LINKS = [fp.Capsule(i, [0, 0, 0], [1, 0, 0], 0.04, f"link {i}") for i in range(1, 5)]
AROUND = [fp.Capsule(0, [2.2, 0.2, -1], [2.2, 0.2, 1], 0.1, "post"), fp.HalfSpace([0, 1, 0], -1.5, name="wall")]
CLEARANCE = fp.Clearance(LINKS, AROUND)
WIDE = fp.JointLimits(lower=[-3] * 4, upper=[3] * 4, velocity=[2] * 4, acceleration=[10] * 4)


def test_the_clearance_is_drawn_and_reported():
    arm = fp.PlanarArm([1, 1, 1, 1])
    run = fp.track(arm, fp.Line([0, -2.5], 2.0), fpbm(), Q0, dt=0.01, limits=WIDE, bounds=[CLEARANCE])
    with Viewer(run, port=0) as viewer:
        shapes, label = viewer._scene._shapes, "distance of the nearest shapes"
        for moment in (0.0, 1.0, 2.0):
            viewer.time = moment
            sample = round(100 * moment)
            nearest = CLEARANCE.nearest(arm, run.q[sample])
            assert f"{nearest.distance:.3f} m ({' and '.join(nearest.pair)})" in readout(viewer)
            points = joint_points(arm, run.q[sample])
            for link, node in shapes._links.items():
                np.testing.assert_allclose(node.position[:2], points[link - 1], atol=1e-6)
                turned = SO3(node.wxyz).as_matrix() @ [1, 0, 0]
                np.testing.assert_allclose(turned[:2], points[link] - points[link - 1], atol=1e-6)
            ends = shapes._gap.points[0]
            assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(nearest.distance, abs=1e-6)
        assert f"{run.clearance.min():.3f} m" in readout(viewer)
        np.testing.assert_allclose(shapes._obstacles[0].position, [2.2, 0.2, 0], atol=1e-6)
        viewer._chart._quantity.value = label
        viewer._chart.show(viewer._playback)
        np.testing.assert_allclose(viewer._chart._plot.data[1], run.clearance[viewer._playback.frames], atol=1e-9)
        viewer._controls._limited.value = False  # Then, the arm hits the post, and the page reports the contact.
        viewer._on_change()
        assert viewer.run.clearance is None
        assert viewer._playback.distances.min() < 0
        assert "nearest shapes" in readout(viewer)


def a_stack_run(move=fp.simulate, **how):
    """The Panda's wrist on a line, with the pose of the tip on a lower level."""
    stack = fp.Stack(
        fp.PositionTask("panda_joint5", name="wrist"), fp.PoseTask(name="hand"), fp.PostureTask(name="home")
    )
    scheme, line = fp.Balanced(0.6, np.ones(7), null_damping=2), fp.Line([0.0, 0.1, 0.05], 1.0, time_law="quintic")
    return move(fp.SerialArm.preset("panda"), line, scheme, READY, dt=0.01, task="wrist", stack=stack, **how)


@pytest.mark.parametrize("move", [fp.simulate, fp.track])
def test_a_run_of_a_stack_is_shown(move):
    run = a_stack_run(move)
    with Viewer(run, port=0) as viewer:
        scene = viewer._scene
        for moment in (0.0, 0.6, 1.0):
            viewer.time = moment
            sample = round(100 * moment)
            np.testing.assert_allclose(scene._path.points[-1, 1], run.x[sample], atol=1e-6)
            np.testing.assert_allclose(scene._tip.position, run.arm.forward(run.q[sample])[:3, 3], atol=1e-6)
            errors = {name: np.linalg.norm(run.errors[name][sample]) for name in ("wrist", "home")}
            errors["hand"] = np.linalg.norm(run.errors["hand"][sample, :3])
            for name, unit in (("wrist", "m"), ("hand", "m"), ("home", "rad")):
                row = f"error of {name}</td>"
                assert row in readout(viewer)
                assert f"{errors[name]:.3g} {unit}" in readout(viewer).split(row)[1].split("</tr>")[0]
        np.testing.assert_allclose(scene._target.points[0, 0], run.x_ref[0], atol=1e-6)
        assert "tip error" not in readout(viewer)
        assert "error of hand, orientation" in viewer._chart._quantity.options
        viewer._chart._quantity.value = "error of home"
        viewer._chart.show(viewer._playback)
        assert viewer._chart._plot.title.endswith("rad]")
        sliders = viewer._controls._sliders
        viewer._controls._kind.value = "FPBM"  # The tasks have the gains.
        viewer._controls._on_update(SimpleNamespace(client="somebody", target=viewer._controls._kind))
        assert not sliders["k1"].visible
        assert viewer.run.scheme == fp.FPBM(0.6, np.ones(7), 0, 0, null_damping=2)
        assert (viewer.run.stack, viewer.run.task, viewer.run.scale is None) == (run.stack, "wrist", run.scale is None)
        np.testing.assert_allclose(viewer.run.q, run.q, atol=1e-6)  # The law of a balance without feedback.


def test_a_stack_run_without_samples_is_shown():
    run = a_stack_run()
    names = [name for name in run.arrays() if name != "q"]
    none = {name: getattr(run, name)[:0] for name in names}
    status = replace(run.status, code=fp.Status.SINGULAR, time=0.0, q=run.q[0])
    with Viewer(replace(run, q=run.q[:0], status=status, **none), port=0) as viewer:
        assert "stopped after t = 0 s" in readout(viewer)
        assert "error of hand, orientation" in readout(viewer)


def test_no_shapes_are_drawn_without_a_clearance(viewer):
    assert viewer._scene._shapes is None
    assert "nearest shapes" not in readout(viewer)
    assert "distance of the nearest shapes" not in viewer._chart._quantity.options


@given(st.integers(0, 10**6))
@settings(deadline=None, max_examples=200)
def test_the_line_is_as_long_as_the_distance_of_the_shapes(seed):
    rng = np.random.default_rng(seed)
    arm = fp.SerialArm.preset("panda")
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = fp.rotation(rng.normal(size=3)), rng.uniform(-0.8, 0.8, 3)
    around = [
        fp.HalfSpace(rng.normal(size=3), rng.uniform(-1.0, -0.3)),
        fp.Cuboid(pose, rng.uniform(0, 0.2, 3)),
        fp.Capsule(0, rng.uniform(-0.8, 0.8, 3), rng.uniform(-0.8, 0.8, 3), 0.05),
    ]
    hand = [
        fp.Capsule(7, [0, -0.1, 0.1], [0, 0.1, 0.1], 0.03, "hand"),
        fp.Capsule(7, [0, 0, 0.1], [0, 0, 0.2], 0.02, "hand"),
    ]
    clearance = fp.Clearance([fp.Capsule(2, [0, 0, 0], [0, -0.3, 0], 0.05), *hand], around)
    q = rng.uniform(-2.5, 2.5, 7)
    nearest = clearance.nearest(arm, q)
    ends = nearest.points
    if nearest.distance > 1e-6:
        assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(nearest.distance, abs=1e-9)


def test_the_page_chooses_schemes_and_gains(viewer):
    controls = viewer._controls
    controls._kind.value = "WMVN"
    controls._on_update(SimpleNamespace(client="somebody", target=controls._kind))
    assert repr(viewer.scheme) == repr(fp.WMVN([1, 2, 3, 4]))
    shown = [name for name, slider in controls._sliders.items() if slider.visible]
    assert shown == ["k"]
    assert controls._folder.visible
    controls._weights[2].value = 7.5
    controls._on_update(CLICK)
    assert repr(viewer.scheme) == repr(fp.WMVN([1, 2, 7.5, 4]))
    run = viewer.run
    controls._on_update(CLICK)  # Without a change.
    assert viewer.run is run
    controls._kind.value = "MAN"
    controls._on_update(SimpleNamespace(client="somebody", target=controls._kind))
    assert not controls._folder.visible
    controls._reset(fpbm())
    assert repr(viewer.scheme) == repr(fpbm())


def test_a_scheme_that_is_set_runs_once(viewer, monkeypatch):
    runs = []
    rerun = viewer_module.rerun
    monkeypatch.setattr(viewer_module, "rerun", lambda *given: runs.append(given) or rerun(*given))
    viewer.scheme = fp.Balanced(0.1, [1, 1, 2, 2])
    assert len(runs) == 1


def test_the_fastest_motion_stays_the_fastest_under_another_scheme():
    arm = fp.SerialArm.preset("panda")
    run = fp.fastest(arm, fp.Circle(0.1, 5.0).in_plane("yz"), fp.MVN(), [0, -0.3, 0, -2.2, 0, 2, 0.785], tip_speed=0.5)
    shown = viewer_module.Viewer(run, port=0, open_browser=False)
    try:
        assert shown.run is run
        shown.scheme = fp.WMVN([5, 1, 1, 1, 1, 1, 1])
        assert shown.run.function is fp.fastest
        assert shown.run.max_error() < 1e-6
        assert np.abs(shown.run.q - run.q).max() > 0.01
        with pytest.raises(ValueError, match="velocity level"):
            shown.scheme = fp.MAN()
    finally:
        shown.close()


def test_a_kept_path_without_a_duration_is_shown():
    arm, path = fp.SerialArm.preset("panda"), fp.Circle(0.1).in_plane("yz")
    run = fp.track(arm, path, fp.MVN(k=5), [0, -0.3, 0, -2.2, 0, 2, 0.785], keep_path=True)
    shown = viewer_module.Viewer(run, port=0, open_browser=False)
    try:
        shown.time = 100.0
        assert shown.time == pytest.approx(run.t[-1])
        shown.scheme = fp.WMVN([5, 1, 1, 1, 1, 1, 1], k=5)
        assert shown.run.path == path
        assert shown.run.max_error() < 1e-6
    finally:
        shown.close()


def test_gains_beyond_a_slider_extend_its_range(viewer):
    viewer.scheme = fp.FPBM(0.6, [0.01, 1, 1, 400], 300, 9000)
    sliders = viewer._controls._sliders
    assert sliders["k1"].max == sliders["k1"].value == 300
    assert viewer._controls._weights[0].min == 0.01
    assert repr(viewer._controls.scheme()) == repr(viewer.scheme)


@pytest.mark.parametrize(
    "scheme",
    [
        fp.MVN(k=3, rest_posture=np.zeros(4), null_stiffness=1),
        fp.WMVN(np.diag([1.0, 2, 3, 4]) + 0.1, k=2),
        fp.MAN(null_damping=1, c=[0, 1, 2, 3]),
        fp.WMVNAcceleration([1, 2, 3, 4], singular_radius=0.02),
        fp.Balanced(0.3, [1, 2, 3, 4], joint_centring=0.1),
        fp.FPBM(0.6, [1, 2, 3, 4], 10, 25, null_damping=2, rest_posture=np.ones(4), null_stiffness=1),
    ],
)
def test_schemes_keep_their_options(scheme):
    assert controls.changed(scheme, type(scheme), {}) == scheme
    values = {"alpha": 0.7, "weights": np.ones(4), "k1": 1.0, "k2": 2.0}
    for name, kind in controls.KINDS.items():
        other = controls.changed(scheme, kind, values)
        assert type(other).__name__ == name
        for option in parameters(fp.Scheme):
            np.testing.assert_array_equal(getattr(other, option), getattr(scheme, option))
        for value in values.keys() & parameters(kind).keys():
            np.testing.assert_array_equal(getattr(other, value), values[value])


def test_sliders_follow_the_declarations(viewer):
    sliders = viewer._controls._sliders
    assert list(sliders) == ["alpha", "k1", "k2", "null_damping", "k"]
    assert (sliders["alpha"].label, sliders["alpha"].max) == ("α", 1.0)
    assert (sliders["k2"].label, sliders["k2"].hint) == ("k₂", f"{parameters(fp.FPBM)['k2'].help} [1/s^2]")
    assert sliders["null_damping"].label == "null damping"


def test_a_dense_weight_matrix_is_kept(viewer):
    viewer.scheme = fp.WMVN(np.diag([1.0, 2, 3, 4]) + 0.1)
    assert not viewer._controls._folder.visible
    assert repr(viewer._controls.scheme()) == repr(viewer.scheme)


def test_a_motion_that_stops_early(viewer):
    out = fp.Line([5, 0], 5.0, time_law="quintic")
    with a_viewer(fp.MVN(), path=out) as viewer:
        assert not viewer.run.status
        assert 0 < viewer.run.status.time < 5
        assert f"stopped after t = {viewer.run.status.time:g} s: " in readout(viewer)
        viewer.time = 5.0
        assert viewer.time == viewer.run.status.time
        viewer.scheme = fp.MVN(singular_radius=0.02)
        viewer.time = 5.0
        assert viewer.time == viewer.run.t[-1]


@pytest.mark.parametrize("task", ["position", "pose"])
def test_a_motion_without_samples_is_shown(task):
    with a_viewer(fp.MVN(), q0=np.zeros(4), task=task) as viewer:
        assert len(viewer.run.t) == 0
        viewer.time = 1.0
        assert viewer.time == 0.0
        assert "stopped after t = 0 s" in readout(viewer)
        np.testing.assert_allclose(viewer._scene._tip.position, [4, 0, 0], atol=1e-6)


def test_invalid_settings_are_rejected_and_the_viewer_continues(viewer):
    run = viewer.run
    with pytest.raises(ValueError, match="weights has 3 entries"):
        viewer.scheme = fp.WMVN([1, 2, 3])
    assert viewer.run is run
    viewer._controls._sliders["alpha"].value = 1.5
    viewer._controls._on_update(CLICK)
    assert viewer.run is run
    assert "not run: alpha = 1.5" in readout(viewer)
    viewer._controls._sliders["alpha"].value = 0.5
    viewer._controls._on_update(CLICK)
    assert "complete" in readout(viewer)
    viewer._controls._sliders["alpha"].value = -1.0
    viewer._controls._on_update(CLICK)
    viewer._controls._sliders["alpha"].value = 0.5  # Back to the shown value.
    viewer._controls._on_update(CLICK)
    assert "complete" in readout(viewer)


def test_simultaneous_changes_are_safe(viewer):
    slider = viewer._controls._sliders["alpha"]

    def change(value):
        slider.value = value
        viewer._controls._on_update(CLICK)
        viewer.time = value

    threads = [threading.Thread(target=change, args=(value,)) for value in np.linspace(0, 1, 20)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert repr(viewer.scheme) == repr(viewer._controls.scheme())


def wait_until(check):
    """Waits until a check holds, as long as a busy machine may need."""
    end = time.monotonic() + 60
    while not check():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_playing(viewer):
    player = viewer._player
    viewer.play()
    wait_until(lambda: 0.0 < viewer.time < 3.0)
    viewer.pause()
    moment = viewer.time
    time.sleep(0.1)
    assert viewer.time == moment
    player._speed.value = "5 ×"
    viewer.time = 2.9
    viewer.play()
    wait_until(lambda: viewer.time < 2.9)  # From the start, again.
    assert player.playing
    player._loop.value = False
    wait_until(lambda: not player.playing)
    assert viewer.time == 3.0
    player._loop.value = True
    viewer.play()
    wait_until(lambda: viewer.time < 3.0)
    player._speed.value = "1 ×"


def test_quantities_over_time(viewer):
    chart = viewer._chart
    for quantity in chart._quantity.options:
        chart._quantity.value = quantity
        assert chart._plot.title.startswith(quantity)
        assert len(chart._plot.data) == len(chart._plot.series)
    assert "orientation error" not in chart._quantity.options
    chart._quantity.value = "tip error"
    power = chart._plot.title.split("10")[1].split(" m]")[0]
    exponent = int(power.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")))
    np.testing.assert_allclose(chart._plot.data[1].max() * 10.0**exponent, viewer.run.max_error(), rtol=1e-6)
    chart._quantity.value = "joint velocities"


def test_a_finished_run():
    panda = fp.SerialArm.preset("panda")
    arm = fp.SerialArm([fp.Joint("prismatic", axis=(0, 1, 0), name="rail"), *panda.joints], panda.tip)
    path = fp.Circle(0.05, 1.0).in_plane("yz")
    qd0 = np.full(8, 0.01)
    run = fp.simulate(arm, path, fpbm(8), [0.1, *READY], dt=0.01, hold=0.5, qd0=qd0, task="pose")
    with Viewer(run, port=0) as viewer:
        assert viewer.run is run
        assert "orientation error" in readout(viewer)
        assert "orientation error" in viewer._chart._quantity.options
        viewer.scheme = fp.MAN()
        same(viewer.run, fp.simulate(arm, path, fp.MAN(), [0.1, *READY], dt=0.01, hold=0.5, qd0=qd0, task="pose"))
        viewer._chart._quantity.value = "joint velocities"
        assert "[rad/s, m/s]" in viewer._chart._plot.title
        assert viewer.url in viewer._repr_html_()


def test_reported_text_is_escaped(viewer):
    viewer._readout.refuse("k1 < 0 & <b>")
    assert "k1 &lt; 0 &amp; &lt;b&gt;" in readout(viewer)


def test_limits_are_kept_on_request():
    arm, path = fp.SerialArm.preset("panda"), fp.Circle(0.05, 1.0).in_plane("yz")
    with Viewer(fp.simulate(arm, path, fpbm(7), READY, dt=0.01), port=0) as viewer:
        box = viewer._controls._limited
        assert box.visible
        assert viewer.run.scale is None
        box.value = True
        viewer._controls._on_update(CLICK)
        same(viewer.run, fp.track(arm, path, fpbm(7), READY, dt=0.01))
        viewer.scheme = fp.MVN()
        assert viewer.run.scale is not None
    with a_viewer() as viewer:  # An arm without limits.
        assert not viewer._controls._limited.visible


def test_the_limits_of_a_run_are_kept():
    wide = np.full(4, 9.0)
    limits = fp.JointLimits(lower=-wide, upper=wide, velocity=np.full(4, 0.1), acceleration=wide)
    run = fp.track(fp.PlanarArm([1, 1, 1, 1]), fp.Circle(0.2, 2.0), fpbm(), Q0, dt=0.01, limits=limits)
    with Viewer(run, port=0) as viewer:
        assert viewer._controls.limited
        viewer.scheme = fpbm(null_damping=2)
        same(viewer.run, fp.track(run.arm, run.path, viewer.scheme, Q0, dt=0.01, limits=limits))
        assert abs(viewer.run.qd).max() == pytest.approx(0.1, abs=1e-12)


def test_playback_of_a_long_run():
    run = a_run(path=fp.Circle(0.2, 10.0), dt=1e-3)
    playback = Playback(run)
    frames = playback.frames
    assert len(frames) == len(playback.manipulability) == FRAMES
    assert (frames[0], frames[-1]) == (0, 10000)
    np.testing.assert_array_equal(playback.manipulability, run.manipulability()[frames])
    for sample in (0, 1, 19, 20, 21, 5000, 9999, 10000):
        frame = playback.frame(sample)
        assert frames[frame] <= sample
        assert frame == FRAMES - 1 or sample < frames[frame + 1]
    assert playback.sample(1.2344) == 1234
    assert playback.sample(77.0) == 10000


@given(st.lists(st.floats(-1, 1), min_size=3, max_size=3).filter(lambda d: np.linalg.norm(d) > 1e-3))
def test_rotations_along_a_direction(direction):
    d = np.array(direction)
    np.testing.assert_allclose(SO3(along(d)).apply(np.array([0.0, 0, 1])), d / np.linalg.norm(d), atol=1e-6)


def test_rotation_upside_down():
    np.testing.assert_allclose(SO3(along(np.array([0.0, 0, -2]))).apply(np.array([0.0, 0, 1])), [0, 0, -1], atol=1e-12)


def with_mimic():
    """A rail, and a joint that mimics another by a half."""
    frame = np.eye(4)
    frame[:3, :3] = fp.rotation([0.3, -0.8, 0.4])
    frame[:3, 3] = [0.2, 0.1, 0.4]
    kinds = ["prismatic", "revolute", "continuous", "revolute", "revolute"]
    joints = [
        fp.Joint(kind, frame, (0.2, 1, 0.1 * i), mimic=(1, 0.5, 0.1) if i == 3 else None)
        for i, kind in enumerate(kinds)
    ]
    return fp.SerialArm(joints, frame)


def test_links_and_joints_have_the_positions_of_the_arm():
    arm = with_mimic()
    q = np.array([0.3, 0.4, -0.5, 0.6])
    with Viewer(fp.simulate(arm, fp.Line([0.01, 0, 0], 1.0), fp.MVN(), q, dt=0.01), port=0) as viewer:
        links = viewer._scene._arm
        q = q + 0.2
        links.pose(q)
    points = joint_points(arm, q)
    for link, start, end in zip(links._links, points, points[1:]):
        half = SO3(link.wxyz).apply(np.array([0, 0, 0.5 * link.scale[2]]))
        np.testing.assert_allclose(link.position - half, start, atol=1e-6)
        np.testing.assert_allclose(link.position + half, end, atol=1e-6)
    axes = np.array([SO3(joint.wxyz).apply(np.array([0.0, 0, 1])) for joint in links._joints])
    np.testing.assert_allclose([joint.position for joint in links._joints], points[1:-1], atol=1e-6)
    swept = np.cross(axes, points[-1] - points[1:-1])
    moved = np.array([axes[0], swept[1] + 0.5 * swept[3], swept[2], swept[4]]).T
    np.testing.assert_allclose(moved, arm.jacobian(q), atol=1e-6)


URDF = """<robot name="made_up">
  <link name="world"/>
  <link name="foot"><visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual></link>
  <link name="upper"><visual><geometry><cylinder radius="0.04" length="0.4"/></geometry></visual></link>
  <link name="middle"><visual><geometry><mesh filename="package://made_up/{mesh}"/></geometry></visual></link>
  <link name="lower"/><link name="hand"/><link name="finger"/><link name="thumb"/>
  <joint name="stand" type="fixed"><parent link="world"/><child link="foot"/>
    <origin xyz="1 2 3" rpy="0.1 0.2 0.3"/></joint>
  <joint name="a" type="revolute"><parent link="foot"/><child link="upper"/><origin xyz="0 0 0.1" rpy="0.4 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
  <joint name="b" type="prismatic"><parent link="upper"/><child link="middle"/><origin xyz="0 0 0.4" rpy="0 0.7 0"/>
    <axis xyz="1 0 0"/><limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
  <joint name="c" type="revolute"><parent link="middle"/><child link="lower"/><origin xyz="0.1 0 0.4"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
  <joint name="d" type="revolute"><parent link="lower"/><child link="hand"/><origin xyz="0.1 0 0.2" rpy="0 0 1"/>
    <axis xyz="1 0 0"/><limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
  <joint name="grip" type="prismatic"><parent link="hand"/><child link="finger"/>
    <axis xyz="1 0 0"/><limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
  <joint name="follow" type="prismatic"><parent link="hand"/><child link="thumb"/><mimic joint="grip" multiplier="-1"/>
    <axis xyz="1 0 0"/><limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
</robot>"""
BOX = """solid box
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 0.1 0 0
vertex 0 0.1 0
endloop
endfacet
endsolid box
"""


@pytest.fixture
def file(tmp_path):
    """A URDF file in the folder of a package, with its mesh in another folder."""
    (tmp_path / "made_up" / "urdf").mkdir(parents=True)
    (tmp_path / "made_up" / "meshes").mkdir()
    (tmp_path / "made_up" / "meshes" / "middle.stl").write_text(BOX)
    made = tmp_path / "made_up" / "urdf" / "arm.urdf"
    made.write_text(URDF.format(mesh="meshes/middle.stl"))
    return made


@pytest.mark.parametrize("base", [None, "foot", "upper"])
def test_a_model_has_the_frames_of_the_arm(file, base):
    arm = fp.SerialArm.from_urdf(file, tip="hand", base=base)
    model = Meshes(file, arm, np.zeros(arm.dof))
    assert model.found

    @settings(max_examples=20)
    @given(st.lists(st.floats(-2, 2), min_size=arm.dof, max_size=arm.dof))
    def check(q):
        q = np.round(q, 6)  # trimesh discards changes of a transform below 1e-8.
        model.robot.update_cfg(model.configuration(q))
        tip = model.placement @ model.robot.get_transform("hand", model.robot.base_link)
        np.testing.assert_allclose(tip, arm.forward(q), atol=1e-9)
        for link in ("finger", "thumb"):
            np.testing.assert_allclose(model.robot.get_transform(link, "hand"), np.eye(4), atol=1e-12)

    check()


def test_meshes_that_are_not_found_are_left_out(file):
    file.write_text(URDF.format(mesh="meshes/nowhere.stl"))
    arm = fp.SerialArm.from_urdf(file, tip="hand")
    with pytest.warns(
        UserWarning, match=r"arm.urdf: 1 mesh is not found: package://made_up/meshes/nowhere.stl"
    ) as caught:
        model = Meshes(file, arm, np.zeros(4))
    assert len(caught) == 1
    assert model.found  # The box and the cylinder.


def test_without_any_mesh_the_arm_is_drawn_from_its_links(file):
    words = URDF.format(mesh="nowhere.stl")
    for shape in ('<box size="0.2 0.2 0.1"/>', '<cylinder radius="0.04" length="0.4"/>'):
        words = words.replace(shape, '<mesh filename="nowhere.stl"/>')
    file.write_text(words)
    arm = fp.SerialArm.from_urdf(file, tip="hand")
    path = fp.Line([0.01, 0, 0], 1.0)
    with pytest.warns(UserWarning, match="2 meshes are not found, the first is nowhere.stl"):
        viewer = Viewer(fp.simulate(arm, path, fp.MVN(), [0.3, 0.2, 0.5, 0.4], dt=0.01), urdf=file, port=0)
    with viewer:
        assert isinstance(viewer._scene._arm, Links)


def test_a_urdf_of_another_arm_is_rejected(file, tmp_path):
    arm = fp.SerialArm.from_urdf(file, tip="hand")
    longer = file.with_name("longer.urdf")
    longer.write_text(file.read_text().replace("0.1 0 0.2", "0.1 0 0.3"))
    broken = file.with_name("broken.urdf")
    broken.write_text("<robot")
    for bad, model, words in (
        (fp.PlanarArm([1, 1, 1, 1]), file, "must not be given for a planar arm"),
        (
            fp.SerialArm.preset("panda"),
            file,
            "has no joint 'panda_joint1' of the arm; joints of the file: a, b, c, d, grip",
        ),
        (arm, longer, "must be of this arm: joint 'd' is displaced by 0.1 m from this arm's joint"),
        (arm, broken, "must be a file that yourdfpy can read"),
    ):
        path = fp.Line([0.01, 0] if isinstance(bad, fp.PlanarArm) else [0.01, 0, 0], 1.0)
        q0 = np.linspace(0.3, 0.6, bad.dof)
        with pytest.raises(ValueError, match=words):
            Viewer(fp.simulate(bad, path, fp.MVN(), q0, dt=0.01), urdf=model, port=0).close()
    with pytest.raises(FileNotFoundError):
        fp.view(arm, path, fp.MVN(), q0, dt=0.01, urdf=tmp_path / "none.urdf", open_browser=False)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"dt": 0.3}, "dt = 0.3"),
        ({"task": "dance"}, "task = 'dance'"),
        ({"q0": [0, 0]}, "q0 has 2 entries"),
        ({"port": -1}, "port = -1: must be 0 to 65535"),
        ({"host": "nowhere.invalid"}, "host = 'nowhere.invalid'"),
    ],
)
def test_bad_arguments(change, words):
    def view(q0=Q0, **how):
        arm, path = fp.PlanarArm([1, 1, 1, 1]), fp.Circle(0.2, 2.0)
        fp.view(arm, path, fp.MVN(), q0, **{"dt": 0.01, "port": 0, "open_browser": False, **how})

    before = threading.active_count()
    with pytest.raises(ValueError, match=words):
        view(**change)
    assert threading.active_count() == before


def test_a_port_in_use():
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen()
        port = server.getsockname()[1]
        with pytest.raises(OSError, match=f"port {port} is in use: choose another port, or 0 for a free port"):
            Viewer(a_run(), port=port)


def test_the_server_runs_until_it_is_closed():
    viewer = a_viewer()
    with urllib.request.urlopen(viewer.url) as page:
        assert b"<html" in page.read()
    viewer.close()
    viewer.close()
    with pytest.raises(OSError, match="refused"):
        urllib.request.urlopen(viewer.url)


SCRIPT = """
import signal
import fpbm_cpp as fp
signal.signal(signal.SIGINT, signal.default_int_handler)
arm, path, scheme, q0 = fp.PlanarArm([1, 1, 1]), fp.Circle(0.2, 1.0), fp.MVN(), [0.3, 0.4, 0.5]
{call}
print("closed")
"""


@pytest.mark.parametrize("call", ["fp.view(arm, path, scheme, q0, ", "fp.simulate(arm, path, scheme, q0).view("])
def test_the_address_is_printed_and_ctrl_c_closes_the_server(call):
    command = [sys.executable, "-c", SCRIPT.format(call=f"{call}port=0, open_browser=False)")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
        printed = child.stdout.readline()
        assert printed, child.stderr.read()
        url = printed.removesuffix(": Ctrl-C stops the server.\n")
        with urllib.request.urlopen(url) as page:
            assert b"<html" in page.read()
        child.send_signal(signal.SIGINT)
        rest, errors = child.communicate(timeout=30)
    assert rest == "closed\n"
    assert "Traceback" not in errors
    assert child.returncode == 0


@pytest.mark.parametrize("call", ["fp.view(arm, path, fp.MVN(), q0)", "fp.simulate(arm, path, fp.MVN(), q0).view()"])
def test_without_viser(call):
    code = f"""
import sys
sys.modules["viser"] = None
import fpbm_cpp as fp
arm, path, q0 = fp.PlanarArm([1, 1, 1]), fp.Circle(0.2, 1.0), [0.3, 0.4, 0.5]
try:
    {call}
except ImportError as error:
    print(error)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == 'viewing needs viser: pip install "fpbm_cpp[view]"\n'


def test_importing_the_package_imports_no_viewer():
    code = "import fpbm_cpp, sys; print('viser' in sys.modules, 'fpbm_cpp.viewer.viewer' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "False False\n"


@pytest.mark.parametrize("end", ["viewer.close()", "viewer.time = 0.5"])
def test_viser_prints_nothing(end):
    code = f"""
import fpbm_cpp as fp
from fpbm_cpp.viewer import Viewer
run = fp.simulate(fp.PlanarArm([1, 1, 1]), fp.Circle(0.2, 1.0), fp.MVN(), [0.3, 0.4, 0.5], dt=0.01)
viewer = Viewer(run, port=0)
{end}
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (run.stdout, run.stderr) == ("", "")


@pytest.fixture
def page(tmp_path):
    with opened(tmp_path, 640, 480) as page:
        yield page


def picture(page, viewer):
    """The browser's image of the scene, small, after it has drawn all messages."""
    pictures = []
    (client,) = viewer._server.get_clients().values()
    thread = threading.Thread(target=lambda: pictures.append(client.get_render(120, 160, transport_format="png")))
    thread.start()
    while thread.is_alive():
        page.wait_for_timeout(20)
    return pictures[0][..., :3].astype(float)


def test_in_a_browser(page, viewer):
    page.goto(viewer.url)
    eventually(page, viewer._server.get_clients)
    eventually(page, lambda: picture(page, viewer).std() > 20)
    before = picture(page, viewer)
    viewer.time = 1.0
    eventually(page, lambda: np.abs(picture(page, viewer) - before).mean() > 1)
    moment = page.get_by_text("fastest joint").locator("xpath=following-sibling::td").first
    fastest = np.abs(viewer.run.qd[100]).max()
    eventually(page, lambda: f"{fastest:.3g} rad/s" in moment.inner_text())

    page.get_by_role("combobox", name="scheme").click()
    page.get_by_role("option", name="MVN", exact=True).click()
    eventually(page, lambda: isinstance(viewer.scheme, fp.MVN))
    fastest = np.abs(viewer.run.qd[100]).max()
    eventually(page, lambda: f"{fastest:.3g} rad/s" in moment.inner_text())
    assert page.get_by_text("complete, t = 3 s").is_visible()
