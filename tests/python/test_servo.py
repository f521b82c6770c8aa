"""The page with the handle: the arm follows the handle, and the page shows the state of the arm."""

from __future__ import annotations

import asyncio
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from types import SimpleNamespace

import numpy as np
import pytest
from browser import eventually, opened

import fpbm_cpp as fp

pytest.importorskip("viser")
pytest.importorskip("yourdfpy")

from viser.transforms import SO3

from fpbm_cpp.viewer import Servo

PANDA = fp.SerialArm.preset("panda")
READY = np.array([0, -0.3, 0, -2.2, 0, 2.0, 0.785])
PLANAR = fp.PlanarArm([1, 1, 1, 1])
BENT = np.pi / np.array([12, 12, 15, 15])
ALIKE = 2e-5  # viser does not move an object if numpy.allclose holds [m].
CLICK = SimpleNamespace(client="somebody", target=None)


def fpbm(n):
    return fp.FPBM(0.6, np.ones(n), 10, 25, null_damping=2)


def bounds(n=4):
    wide = np.full(n, 2.5)
    return fp.JointLimits(lower=-wide, upper=wide, velocity=wide, acceleration=8 * wide, jerk=400 * wide)


def a_servo(which="planar", task="position", **how):
    arm, q0, limits = (PANDA, READY, None) if which == "panda" else (PLANAR, BENT, bounds())
    return Servo(arm, fpbm(arm.dof), q0, **{"task": task, "limits": limits, "port": 0, **how})


@pytest.fixture(scope="module")
def shared():
    with a_servo() as servo:
        yield servo


@pytest.fixture
def servo(shared):
    shared.scheme = fpbm(4)
    shared._speed.value = 100
    shared.restart()
    return shared


def readout(servo):
    return servo._readout._status.content + servo._readout._table.content


def wait_until(check):
    """Waits until a check holds, as long as a busy machine may need."""
    end = time.monotonic() + 60
    while not check():
        assert time.monotonic() < end, check
        time.sleep(0.02)


@pytest.mark.parametrize(("which", "task"), [("panda", "pose"), ("panda", "position"), ("planar", "pose")])
def test_a_handle_sets_a_target(which, task):
    with a_servo(which, task) as servo:
        np.testing.assert_allclose(servo.target, servo.tip, atol=1e-12)
        x = servo.target
        if x.shape == (4, 4):
            x[:3, :3] = fp.rotation([0.1, -0.2, 0.3]) @ x[:3, :3]
            x[:3, 3] += [-0.05, 0.1, 0.02]
        else:
            x += [-0.3, 0.1, 0.2][: len(x)]
        servo.target = x
        np.testing.assert_allclose(servo.target, x, atol=1e-9)
        wait_until(lambda: np.abs(servo.tip - x).max() < 1e-3)
        for invalid in (np.nan * x, [0.0]):
            with pytest.raises(ValueError, match=r"target|entries|shape"):
                servo.target = invalid


def test_the_status_of_the_arm_is_reported(servo):
    wait_until(lambda: "the whole task is executed" in readout(servo))
    servo.target = [8.0, 3.0]
    wait_until(
        lambda: "a lower level has stopped. The tip follows as fast as the joint limits admit." in readout(servo)
    )
    wait_until(lambda: "the arm stops. Drag the handle into the workspace" in readout(servo))
    assert servo.status is fp.Status.STALLED
    assert "100 %" in readout(servo)
    servo.target = [1.5, 2.0]
    wait_until(lambda: "the whole task is executed" in readout(servo) and "0.000 m" in readout(servo))
    np.testing.assert_allclose(servo.tip, [1.5, 2.0], atol=1e-3)
    shown = np.array(servo._chart._plot.data)
    assert shown.shape == (5, 200)
    assert np.nanmax(shown[1:], axis=1) == pytest.approx(100.0, abs=70.0)


def test_stop_resume_and_restart(servo):
    servo.target = [1.0, 2.0]
    wait_until(lambda: servo.tick and np.abs(servo.tick.qd).max() > 0.1)
    servo.stop()
    assert servo._button.label == "continue"
    wait_until(lambda: "stopped: the arm is at rest" in readout(servo))
    stopped = servo.q
    time.sleep(0.2)
    np.testing.assert_array_equal(servo.q, stopped)
    servo.resume()
    assert servo._button.label == "stop"
    wait_until(lambda: np.abs(servo.tip - [1.0, 2.0]).max() < 1e-3)
    servo.restart()
    wait_until(lambda: servo.tick is not None)
    np.testing.assert_allclose(servo.q, BENT, atol=1e-6)
    np.testing.assert_allclose(servo.target, PLANAR.forward(BENT), atol=1e-9)


def test_the_page_chooses_schemes(servo):
    controls = servo._controls
    assert not controls._limited.visible
    servo.target = [1.0, 2.0]
    controls._kind.value = "WMVN"
    controls._on_update(SimpleNamespace(client="somebody", target=controls._kind))
    assert isinstance(servo.scheme, fp.WMVN)
    controls._weights[0].value = -1.0
    controls._on_update(CLICK)
    wait_until(lambda: "rejected: weights" in readout(servo))
    controls._reset(fpbm(4))
    wait_until(lambda: "rejected" not in readout(servo))
    assert servo.scheme == fpbm(4)


def test_the_slider_sets_the_speed(servo):
    assert (servo._speed.min, servo._speed.max, servo._speed.value, servo._loop.speed) == (5, 100, 100, 1.0)
    servo._speed.value = 5  # Assignment calls the functions that the slider of the page calls.
    assert servo._loop.speed == 0.05
    servo.target = [1.0, 2.0]
    wait_until(lambda: servo._loop.time > 1.0)
    before, moment = servo.tip, servo._loop.time
    wait_until(lambda: servo._loop.time > moment + 1.0)
    displacement = np.abs(servo.tip - before).max()
    assert (
        0.1 < displacement < 0.05 * 4 * (servo._loop.time - moment + 0.1)
    )  # The bound is the length of the arm per second.
    servo._speed.value = 100
    wait_until(lambda: np.abs(servo.tip - [1.0, 2.0]).max() < 1e-3)
    slow = fp.TargetFilter(PLANAR.forward(BENT), velocity=1, acceleration=5, jerk=100)
    slow.set_speed(0.3)
    with a_servo(targets=slow) as other:
        assert other._speed.value == 30
    with a_stack_servo(fp.Stack(fp.OrientationTask())) as other:
        assert not other._speed.visible  # Without a filter.


def test_missing_bounds_are_reported():
    with a_servo(limits=None) as servo:
        servo.target = [1.0, 2.0]
        wait_until(lambda: np.abs(servo.tip - [1.0, 2.0]).max() < 1e-3)
        wait_until(lambda: readout(servo).count("no bound") == 3)
        assert "speed (no bound)" in str(servo._chart._plot.series)


def test_the_arm_avoids_a_dragged_obstacle():
    links = [fp.Capsule(i, [0, 0, 0], [1, 0, 0], 0.05, f"link {i}") for i in range(1, 5)]
    around = [fp.Capsule(0, [2.2, 0.3, -1], [2.2, 0.3, 1], 0.1, "post"), fp.HalfSpace([0, 1, 0], -2, name="wall")]
    with a_servo(bounds=[fp.Clearance(links, around)]) as servo:
        wait_until(lambda: servo.tick is not None)
        ((place, grip),) = servo._scene._grips  # The wall has no handle.
        np.testing.assert_allclose(place, [2.2, 0.3, 0])
        servo.target = [2.2, 0.0]
        wait_until(lambda: "Drag the handle around the nearest shape." in readout(servo))
        wait_until(lambda: f"{servo.tick.nearest.distance:.3f} m" in readout(servo))  # The arm still brakes.
        assert "post" in readout(servo)
        servo.target = [2.6, 2.4]
        grip.position = np.array([2.2, 0.8, 0.0])
        servo._loop.drag("post", grip.position - place)
        wait_until(lambda: np.abs(servo._scene._shapes._obstacles[0].position - grip.position).max() < ALIKE)
        assert servo.tick.nearest.distance >= 0.01 - 1e-9
        servo.restart()
        wait_until(lambda: np.abs(servo._scene._shapes._obstacles[0].position - place).max() < ALIKE)
        np.testing.assert_allclose(grip.position, place)


def cup():
    """Axis, place, height of the elbow, orientation, posture."""
    return fp.Stack(
        [fp.AxisTask(name="upright"), fp.PositionTask(name="place")],
        fp.PositionTask("panda_joint4", rows=("z",), name="elbow"),
        fp.OrientationTask(name="turn"),
        fp.PostureTask(name="home"),
    )


def a_stack_servo(stack=None, **how):
    scheme = fp.Balanced(0.6, np.ones(7), null_damping=2)
    return Servo(PANDA, scheme, READY, **{"stack": stack or cup(), "port": 0, **how})


@pytest.fixture(scope="module")
def shared_stack():
    with a_stack_servo() as servo:
        yield servo


@pytest.fixture
def stacked(shared_stack):
    shared_stack.restart()
    return shared_stack


def test_a_handle_that_the_browser_displaced_returns_to_its_frame_when_the_drag_ends(stacked):
    upright = next(handle for handle in stacked._scene.handles if handle.task.name == "upright")
    upright._gizmo.position = [0.01, -0.02, 0.03]
    for phase, displaced in (("update", True), ("end", False)):
        for told in upright._gizmo._impl_aux.update_cb:
            asyncio.run(told(SimpleNamespace(phase=phase)))
        assert np.any(np.asarray(upright._gizmo.position)) == displaced


def test_each_task_of_a_frame_has_a_handle(stacked):
    handles = {handle.task.name: handle for handle in stacked._scene.handles}
    assert [*handles] == ["upright", "place", "elbow", "turn"]
    moves = {name: (not each._gizmo.disable_axes, not each._gizmo.disable_rotations) for name, each in handles.items()}
    assert moves == {"upright": (0, 1), "place": (1, 0), "elbow": (1, 0), "turn": (0, 1)}
    assert handles["elbow"]._gizmo.active_axes == (False, False, True)
    names = [node for node in stacked._server.scene._handle_from_node_name if node.endswith("/name")]
    assert len(names) == 4
    stacked.target = {
        "upright": fp.rotation([0.3, 0.1, 0]) @ stacked.target["upright"],
        "place": stacked.target["place"] + [0.0, 0.2, 0.1],
        "elbow": stacked.target["elbow"] - [0.0, 0.0, 0.05],
        "turn": fp.rotation([0.0, 0.2, 0.1]) @ stacked.target["turn"],
    }
    wait_until(lambda: np.abs(stacked.tip["place"] - stacked.target["place"]).max() < 1e-3)
    wait_until(lambda: np.abs(stacked.tick.qd).max() < 1e-3)
    for name in ("upright", "place", "turn"):
        np.testing.assert_allclose(handles[name].target, stacked.target[name], atol=1e-9)
    tip, elbow = stacked.tip["place"], stacked.tip["elbow"]
    for name in ("upright", "turn"):
        np.testing.assert_allclose(handles[name].position, tip, atol=1e-3)
    assert handles["elbow"].position[2] == stacked.target["elbow"][2]
    np.testing.assert_allclose(handles["elbow"].position[:2], elbow[:2], atol=1e-3)  # No target in x and y.
    lines = stacked._scene._gap.points
    assert len(lines) == 2 + 1 + 1 + 6
    np.testing.assert_allclose(lines[3], [elbow, [*elbow[:2], stacked.target["elbow"][2]]], atol=1e-3)


def test_targets_of_a_stack_are_a_dictionary(stacked):
    before = stacked.target
    assert [*before] == ["upright", "place", "elbow", "turn", "home"]
    stacked.target = {"place": before["place"] + [0, 0.1, 0], "home": READY + 0.1}
    np.testing.assert_array_equal(stacked.target["home"], READY + 0.1)
    for name in ("upright", "elbow", "turn"):
        np.testing.assert_array_equal(stacked.target[name], before[name])
    for invalid, words in [
        ({"palce": before["place"]}, "task = 'palce': must be one of .*; did you mean 'place'"),
        ({"upright": [0, 0, 0]}, "target of 'upright': must be finite"),
        ({"place": [0, 0, np.nan]}, "target of 'place': must be finite"),
        ([0, 0, 0], "target = .*: must be a dictionary of points by task names"),
    ]:
        with pytest.raises(ValueError, match=words):
            stacked.target = invalid
    with a_servo() as servo, pytest.raises(ValueError, match=r"target = .*: must be a point of the tip"):
        servo.target = {"tip": [1, 2]}


def test_the_status_of_each_task_and_level_is_reported(stacked):
    wait_until(lambda: "the whole task is executed" in readout(stacked))
    levels = ["upright, place", "elbow", "turn", "home"]
    for text in (*(f"scale of {level}" for level in levels), *(f"from {name} to handle" for name in stacked.tip)):
        assert (text in readout(stacked)) == ("home to" not in text), text
    stacked.target = {"place": stacked.target["place"] + [2.0, 0, 0]}  # An unreachable target.
    wait_until(lambda: "Drag the handle into the workspace" in readout(stacked))
    frame = stacked._loop.frame("place")[:3, 3]
    assert f"{np.linalg.norm(stacked.target['place'] - frame):.3f} m" in readout(stacked)
    labels = [series["label"] for series in stacked._chart._plot.series]
    assert labels == ["t [s]", "speed", "acceleration", "jerk", "torque", *(f"scale of {level}" for level in levels)]
    assert len(stacked._chart._plot.data) == len(labels)


def test_schemes_with_a_stack_have_no_gains(stacked):
    controls = stacked._controls
    target = stacked.target
    for kind in ("FPBM", "MVN", "WMVN", "Balanced"):
        controls._kind.value = kind
        controls._on_update(SimpleNamespace(client="somebody", target=controls._kind))
        assert type(stacked.scheme).__name__ == kind
        assert not any(controls._sliders[name].visible for name in ("k1", "k2", "k"))
    assert "rejected" not in readout(stacked)
    for name, x in target.items():
        np.testing.assert_array_equal(stacked.target[name], x)


def test_simulated_time_keeps_pace_with_the_clock(servo):
    wait_until(lambda: servo.tick is not None)
    begin, moment = time.perf_counter(), servo._loop.time
    time.sleep(2.0)
    passed = time.perf_counter() - begin
    assert 0.5 * passed < servo._loop.time - moment < passed + 0.1


def test_the_server_runs_until_it_is_closed():
    before = threading.active_count()
    servo = a_servo()
    with urllib.request.urlopen(servo.url) as page:
        assert b"<html" in page.read()
    servo.close()
    servo.close()
    assert threading.active_count() <= before + 1
    with pytest.raises(OSError, match="refused"):
        urllib.request.urlopen(servo.url)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"dt": 0.0}, "dt = 0"),
        ({"task": "dance"}, "task = 'dance'"),
        ({"q0": [0, 0]}, "q0 has 2 entries"),
        ({"q0": [9, 0, 0, 0]}, r"q0\[0\] = 9: must be within"),
        ({"bounds": [3]}, "bounds: must be a Clearance, TaskBounds and TorqueBounds in a sequence"),
        ({"port": -1}, "port = -1"),
        ({"urdf": "none.urdf"}, "must not be given for a planar arm"),
        ({"targets": fp.TargetFilter([0, 0, 0], velocity=1, acceleration=1, jerk=1)}, "another task"),
        ({"stack": fp.PoseTask()}, "stack: must be a Stack"),
    ],
)
def test_bad_arguments(change, words):
    def servo(q0=BENT, **how):
        fp.servo(PLANAR, fpbm(4), q0, **{"limits": bounds(), "port": 0, "open_browser": False, **how})

    before = threading.active_count()
    with pytest.raises(ValueError, match=words):
        servo(**change)
    assert threading.active_count() == before


def test_a_port_in_use():
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        with pytest.raises(OSError, match=f"port {port} is in use"):
            a_servo(port=port)


SCRIPT = """
import signal
import fpbm_cpp as fp
signal.signal(signal.SIGINT, signal.default_int_handler)
fp.servo(fp.PlanarArm([1, 1, 1]), fp.MVN(k=5), [0.3, 0.4, 0.5], port=0, open_browser=False)
print("closed")
"""


def test_the_address_is_printed_and_ctrl_c_closes_the_server():
    command = [sys.executable, "-c", SCRIPT]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
        printed = child.stdout.readline()
        assert printed, child.stderr.read()
        with urllib.request.urlopen(printed.removesuffix(": Ctrl-C stops the server.\n")) as page:
            assert b"<html" in page.read()
        child.send_signal(signal.SIGINT)
        rest, errors = child.communicate(timeout=30)
    assert (rest, errors, child.returncode) == ("closed\n", "", 0)


def test_without_viser():
    code = """
import sys
sys.modules["viser"] = None
import fpbm_cpp as fp
try:
    fp.servo(fp.PlanarArm([1, 1, 1]), fp.MVN(), [0.3, 0.4, 0.5])
except ImportError as error:
    print(error)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == 'viewing needs viser: pip install "fpbm_cpp[view]"\n'


# In a browser


@pytest.fixture
def page(tmp_path):
    with opened(tmp_path, 1000, 600) as page:
        yield page


def seen(page, servo, point):
    """Where on the page a point of the scene is [pixels]."""
    (client,) = servo._server.get_clients().values()
    box = page.locator("canvas").first.bounding_box()
    x, y, z = SO3(client.camera.wxyz).as_matrix().T @ (point - client.camera.position)
    focus = box["height"] / 2 / np.tan(client.camera.fov / 2)
    return np.array([box["x"] + box["width"] / 2 + focus * x / z, box["y"] + box["height"] / 2 + focus * y / z])


def drag(page, servo, goal):
    """Takes the handle by the square between its axes, in the plane, and releases it at a goal."""
    handle = servo._scene.handles[0]
    grip = np.array([0.3, 0.3, 0.0]) * handle._gizmo.scale
    mouse(page, *(seen(page, servo, point + grip) for point in (handle.position, np.array([*goal, 0.0]))))
    eventually(page, lambda: np.abs(servo.target - goal).max() < 0.1)


def mouse(page, begin, end):
    """Moves the mouse from one place to another with its button down."""
    page.mouse.move(*begin)
    page.wait_for_timeout(200)
    page.mouse.down()
    for share in np.linspace(0, 1, 12)[1:]:
        page.mouse.move(*(begin + share * (end - begin)))
        page.wait_for_timeout(30)
    page.mouse.up()


def visit(page, servo, text):
    page.goto(servo.url)
    eventually(page, servo._server.get_clients)
    page.get_by_text(text).wait_for()
    page.add_style_tag(content=".mantine-Notifications-root { display: none }")  # The warning that there is no graphics
    # processor.
    page.wait_for_timeout(2000)  # The scene comes last.


def test_dragged_in_a_browser(page, servo):
    """By true mouse events: to reachable and unreachable targets and back."""
    visit(page, servo, "from tip to handle")
    for goal in ([2.0, 2.5], [2.5, 1.0]):
        drag(page, servo, goal)
        eventually(page, lambda: np.abs(servo.tip - servo.target).max() < 0.01)
    page.get_by_text("the whole task is executed").wait_for()
    drag(page, servo, [4.5, 2.0])
    page.get_by_text("the arm stops. Drag the handle into the workspace").wait_for()
    assert np.linalg.norm(servo.target) > 4 > np.linalg.norm(servo.tip) > 3
    drag(page, servo, [1.0, 2.0])
    page.get_by_text("the whole task is executed").wait_for()
    eventually(page, lambda: np.abs(servo.tip - servo.target).max() < 0.01)

    drawn = "Object.values(window.__viserTestpoints.uplots)[0].chart.data"
    t, *shares = page.evaluate(f"{drawn}.map(each => Math.max(...each.filter(Number.isFinite)))")
    assert t == pytest.approx(servo._loop.time, abs=3.0)
    assert all(0 < share <= 100.001 for share in shares)
    page.get_by_role("slider").first.press("Home")
    eventually(page, lambda: servo._loop.speed == 0.05)
    page.get_by_role("button", name="stop").click()
    page.get_by_text("stopped: the arm is at rest").wait_for()
    page.get_by_role("button", name="continue").click()
    page.get_by_text("the whole task is executed").wait_for()
    page.get_by_role("button", name="back to start").click()
    eventually(page, lambda: np.abs(servo.q - BENT).max() < 1e-6)


def test_the_handles_of_a_stack_in_a_browser(page):
    """By true mouse events: an arc turns the axis, an arrow lifts the elbow, and nothing else has another target."""
    stack = fp.Stack(
        fp.AxisTask(name="upright"),
        fp.PositionTask("panda_joint4", rows=("z",), name="elbow"),
        fp.PostureTask(),
    )
    with a_stack_servo(stack) as servo:
        visit(page, servo, "from upright to handle")
        upright, elbow = servo._scene.handles
        first = servo.target
        arc = 0.65 * upright._gizmo.scale * np.array([0.0, 1.0, 1.0]) / np.sqrt(2)  # About the gizmo's x axis.
        R = SO3(upright._gizmo.wxyz).as_matrix()
        turned = (upright.position + R @ fp.rotation([angle, 0, 0]) @ arc for angle in (0.0, 0.4))
        mouse(page, *(seen(page, servo, point) for point in turned))
        expected = R @ fp.rotation([0.4, 0, 0])[:, 2]
        eventually(page, lambda: np.abs(servo.target["upright"] - expected).max() < 0.1)
        eventually(page, lambda: np.abs(servo.tip["upright"] - servo.target["upright"]).max() < 0.01)
        np.testing.assert_array_equal(servo.target["elbow"], first["elbow"])
        eventually(page, lambda: np.abs(upright.position - servo._loop.frame("upright")[:3, 3]).max() < 1e-3)

        grip = np.array([0.0, 0.0, 0.7 * elbow._gizmo.scale])
        lifted = (elbow.position + grip - [0, 0, drop] for drop in (0.0, 0.1))
        mouse(page, *(seen(page, servo, point) for point in lifted))
        eventually(page, lambda: abs(servo.target["elbow"][2] - first["elbow"][2] + 0.1) < 0.03)
        eventually(page, lambda: abs(servo.tip["elbow"][2] - servo.target["elbow"][2]) < 0.01)
        np.testing.assert_allclose(servo.tip["upright"], servo.target["upright"], atol=0.01)
        np.testing.assert_array_equal(servo.target["posture"], first["posture"])
