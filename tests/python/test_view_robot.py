"""Pages of robots: all branches are drawn, each task has its handle, and meshes follow the joints."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest
from browser import opened
from test_robot_motions import PATHS, READY, ROBOT, torso_urdf

import fpbm_cpp as fp

pytest.importorskip("viser")
pytest.importorskip("yourdfpy")

import viser
from viser.transforms import SO3

from fpbm_cpp import viewer as viewers
from fpbm_cpp.skeleton import link_frames
from fpbm_cpp.viewer import Servo, Viewer
from fpbm_cpp.viewer.scene import Meshes, rods

TORSO_READY = np.array([0.1, 0.0, -0.3, 0.2, 0.1, 1.0, 0.2, 0.3, 0.1, -0.3, -0.2, -0.1, 1.0, 0.2, 0.3, 0.1])


def torso(tmp_path, base=None, **held):
    file = tmp_path / "torso.urdf"
    file.write_text(torso_urdf())
    return file, fp.Robot.from_urdf(file, base=base, locked=held)


def hand_motion(robot, q0, **how):
    """Both hands along a line each."""
    stack = fp.Stack([fp.PoseTask("left_tool", name="left"), fp.PositionTask("right_tool", name="right")])
    paths = {"left": fp.Line([0.05, 0, 0], 1.0), "right": fp.Line([0, 0, 0.05], 0.5)}
    return fp.simulate(robot, paths, fp.MVN(), q0, stack=stack, dt=0.01, **how)


@pytest.mark.parametrize("base", [None, "planar"])
def test_the_model_has_the_frames_of_the_robot(tmp_path, base):
    """Also the payload of the robot on a base that moves, and held joints."""
    file, robot = torso(tmp_path, base, neck=0.4)
    rng = np.random.default_rng(1)
    server = viser.ViserServer("127.0.0.1", 0, verbose=False)
    try:
        model = Meshes(file, robot, rng.uniform(-1, 1, robot.dof))
        assert model.found
        model.show(server)
        for _ in range(5):
            q = rng.uniform(-1, 1, robot.dof)
            model.pose(q)
            root = np.eye(4)
            root[:3, :3], root[:3, 3] = SO3(model._root.wxyz).as_matrix(), model._root.position
            for link in ("foot", "head", "left_tool", "right_5"):
                there = root @ model.robot.get_transform(link, model.robot.base_link)
                np.testing.assert_allclose(there, robot.forward(q, link), atol=1e-9)
    finally:
        server.stop()


def test_a_run_of_a_robot_is_shown(tmp_path):
    file, robot = torso(tmp_path)
    run = hand_motion(robot, TORSO_READY[: robot.dof])
    with Viewer(run, port=0) as viewer:
        links, scene = viewer._scene._arm, viewer._scene
        viewer.time = 0.5
        np.testing.assert_array_equal(scene._tip.position, run.frames["left"][50][:3, 3])
        assert len(scene._path.points) == 2 * 51
        for line, name in zip(scene._path.points[[50, 101]], PATHS):
            np.testing.assert_allclose(line[1], run.frames[name][50][:3, 3], atol=1e-6)
        q = run.q[50]
        frames = link_frames(robot, q)
        np.testing.assert_allclose([joint.position for joint in links._joints], frames[1:, :3, 3], atol=1e-6)
        spans = np.linalg.norm(np.diff(rods(robot, q), axis=1)[:, 0], axis=1)
        for link, (start, end), span in zip(links._links, rods(robot, q), spans):
            assert link.visible == (span > 0)
            if span > 0:
                assert link.scale[2] == pytest.approx(span)
                np.testing.assert_allclose(link.position, (start + end) / 2, atol=1e-6)
        viewer.scheme = fp.WMVN(np.arange(1.0, robot.dof + 1))
        assert viewer.run.paths == run.paths
        assert viewer.run.arm == robot
    with Viewer(run, urdf=file, port=0) as viewer:
        assert isinstance(viewer._scene._arm, Meshes)


HANDS = ["left_tip", "right_tip"]


def hands(robot=ROBOT, q0=READY, **how):
    """A page with the handles of `fpbm-cpp servo --task left_tip --task right_tip`."""
    stack = fp.Stack([fp.PoseTask(name, name=name) for name in HANDS], fp.PostureTask(k1=4, k2=4))
    scheme = fp.Balanced(0.6, np.ones(robot.dof), null_damping=2)
    return Servo(robot, scheme, q0, **{"stack": stack, "port": 0, **how})


def wait_until(check, seconds=60.0):
    end = time.monotonic() + seconds
    while not check():
        assert time.monotonic() < end, check
        time.sleep(0.05)


def test_each_hand_has_a_handle():
    with hands() as servo:
        handles = {handle.task.name: handle for handle in servo._scene.handles}
        assert [*handles] == HANDS
        assert not servo._scene._tip.visible
        goals = {name: servo.target[name].copy() for name in HANDS}
        goals["left_tip"][:3, 3] += [0.05, 0.05, 0.05]
        start = servo.tip["right_tip"].copy()
        handles["left_tip"]._gizmo.position = goals["left_tip"][:3, 3]
        servo.target = {"left_tip": goals["left_tip"]}
        wait_until(lambda: np.abs(servo.tip["left_tip"] - goals["left_tip"]).max() < 1e-3)
        np.testing.assert_allclose(servo.tip["right_tip"], start, atol=1e-3)  # The right tip keeps its own target.
        for name in HANDS:
            np.testing.assert_allclose(handles[name].target, goals[name], atol=1e-6)
            assert f"from {name} to handle" in servo._readout._table.content
        lines = servo._scene._trace.points
        ends = {name: np.linalg.norm(lines - servo.tip[name][:3, 3], axis=2).min() for name in HANDS}
        assert max(ends.values()) < 1e-2  # The lines of both hands.


def test_a_slowed_level_is_named():
    """The page does not report joint limits that do not slow the hands."""
    with hands() as servo:
        goal = servo.target["left_tip"].copy()
        goal[:3, 3] += [0.1, 0.1, 0.15]
        servo.target = {"left_tip": goal}
        wait_until(lambda: "posture: slowed by higher levels" in servo._readout._status.content)


def test_relative_tasks_have_no_handle():
    """The targets of relative tasks are not in the base frame."""
    stack = fp.Stack(
        fp.RelativePoseTask(*HANDS, name="grasp"), fp.PoseTask("right_tip", name="tray"), fp.CenterOfMassTask()
    )
    heavy = fp.Robot(ROBOT.joints, ROBOT.named_frames, base_mass=1.0)
    with hands(heavy, stack=stack) as servo:
        assert [handle.task.name for handle in servo._scene.handles] == ["tray"]
        assert servo.target["center_of_mass"].shape == (3,)


def test_servo_from_the_command_line(tmp_path, monkeypatch):
    cli, testing = pytest.importorskip("fpbm_cpp.cli"), pytest.importorskip("click.testing")
    file, robot = torso(tmp_path, "planar", neck=0.2)
    shown = []

    class Page(Servo):
        def wait(self):
            shown.append(([handle.task.frame for handle in self._scene.handles], self._loop.arm, self._scene._arm))
            self.close()

    monkeypatch.setitem(vars(viewers), "Servo", Page)
    how = ["--base", "planar", "--locked", "neck=0.2", "--limit-acceleration", "10", "--port", "0", "--no-browser"]
    tasks = ["--task", "left_tool", "--task", "right_tool"]
    result = testing.CliRunner().invoke(cli.command, ["servo", str(file), *tasks, *how])
    assert result.exit_code == 0, result.output
    ((frames, arm, drawn),) = shown
    limited = [replace(each, joint=replace(each.joint, acceleration=10)) for each in robot.joints]
    assert (frames, arm) == (["left_tool", "right_tool"], replace(robot, joints=limited))
    assert isinstance(drawn, Meshes)


def test_two_hands_in_a_browser(tmp_path):
    with opened(tmp_path, 900, 600) as page, hands() as servo:
        page.goto(servo.url)
        wait_until(servo._server.get_clients)
        for name in HANDS:
            page.get_by_text(f"from {name} to handle").wait_for()
