"""Whole motions of robots: a path for each task, run files, figures, jobs and the command line."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import fpbm_cpp as fp
from fpbm_cpp._types import Array
from fpbm_cpp.motion.task_errors import tracks
from fpbm_cpp.skeleton import frames_of, joint_points, joint_units, joints_of, length, link_frames

ROBOT = fp.Robot.preset("two_pandas")
READY = 2 * [0, -0.6, 0, -2.4, 0, 1.8, 0.785]
SCHEME = fp.Balanced(0.6, np.ones(14), null_damping=2)
PATHS = {"left": fp.Circle(0.08, 2).in_plane("yz"), "right": fp.Line([0.1, 0, -0.1], 1.5)}
URDF = """<robot name="torso">
  <link name="foot"><visual><geometry><box size="0.3 0.3 0.1"/></geometry></visual></link><link name="chest"/>
  <joint name="waist" type="revolute"><parent link="foot"/><child link="chest"/><origin xyz="0 0 0.5"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
  <link name="head"/>
  <joint name="neck" type="revolute"><parent link="chest"/><child link="head"/><origin xyz="0.05 0 0.5" rpy="0 0 0.3"/>
    <axis xyz="0 2 0"/><limit lower="-0.6" upper="0.6" velocity="1" effort="1"/></joint>
  {arms}
</robot>"""
LINKS = [("0 {y} 0.4", "0 1 0"), ("0 0.01 0", "1 0 0"), ("0 0 -0.12", "0 0 1"), ("0 0 -0.18", "0 1 0")]
LINKS += [("0 0 -0.1", "0 0 1"), ("0 0 -0.15", "0 1 0"), ("0 0 -0.03", "1 0 0")]


def torso_urdf() -> str:
    """A waist, a neck, and two arms of seven joints that end in 'left_tool' and 'right_tool'."""
    text = []
    for side, y in (("left", 0.2), ("right", -0.2)):
        before = "chest"
        for i, (xyz, axis) in enumerate(LINKS, 1):
            name = f"{side}_{i}"
            text.append(
                f'<link name="{name}"/><joint name="{name}_joint" type="revolute"><parent link="{before}"/>'
                f'<child link="{name}"/><origin xyz="{xyz.format(y=y)}"/><axis xyz="{axis}"/>'
                f'<limit lower="-2.5" upper="2.5" velocity="2" effort="1"/></joint>'
            )
            before = name
        ends = f'<parent link="{before}"/><child link="{side}_tool"/><origin xyz="0 0 -0.12"/>'
        text.append(f'<link name="{side}_tool"/><joint name="{side}_fixed" type="fixed">{ends}</joint>')
    return URDF.format(arms="".join(text))


@pytest.fixture
def urdf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "robot.urdf"
    file.write_text(torso_urdf())
    return file


def two_hands(**left: object) -> fp.Stack:
    hands = [fp.PoseTask("left_tip", name="left", **left), fp.PositionTask("right_tip", name="right")]
    return fp.Stack(hands, fp.PostureTask(READY, k1=4, k2=4))


@pytest.fixture(scope="module")
def run() -> fp.Run:
    return fp.track(ROBOT, PATHS, SCHEME, READY, stack=two_hands(), hold=0.5)


def poses(q: Array, frame: str) -> Array:
    return np.array([ROBOT.forward(row, frame) for row in q])


# Motions


def test_each_task_follows_its_path(run: fp.Run) -> None:
    """From the start of the task's frame to the end of the longest path."""
    assert (run.t[-1], run.task, run.kind) == (2.5, "left", "pose")
    assert run.x.shape == (2501, 4, 4)
    for name in ("left", "right"):
        p = poses(run.q, f"{name}_tip")
        np.testing.assert_allclose(run.frames[name], p, atol=1e-12)
        reference = p[0, :3, 3] + [PATHS[name].sample(t)[0] for t in run.t]
        np.testing.assert_allclose(p[:, :3, 3], reference, atol=1e-6)
        np.testing.assert_allclose(run.errors[name][:, :3], reference - p[:, :3, 3], atol=1e-12)
        np.testing.assert_allclose(dict(zip(run.paths, tracks(run)))[name][1], reference, atol=1e-12)
    np.testing.assert_allclose(run.x, poses(run.q, "left_tip"), atol=1e-12)
    assert np.abs(run.x_ref[:, :3, :3] - run.x_ref[0, :3, :3]).max() < 1e-12  # The path holds the orientation.
    limits = ROBOT.limits
    assert (np.abs(np.diff(run.qd, axis=0)) / 1e-3 <= limits.acceleration + 1e-6).all()


def test_ticks_equal_those_of_the_tracker(run: fp.Run) -> None:
    tracker = fp.Tracker(ROBOT, SCHEME, READY, stack=two_hands())
    followers = {name: tracker.follow(path, task=name) for name, path in PATHS.items()}
    for k in range(300):
        np.testing.assert_array_equal(run.q[k], tracker.q)
        tick = tracker.tick(followers)
        np.testing.assert_array_equal(run.errors["right"][k], tick.errors["right"])
        np.testing.assert_array_equal(run.scales[k], tick.scales)


def test_task_selects_the_meaning_of_x() -> None:
    """`task` does not change the motion."""
    stack = two_hands()
    right = fp.simulate(ROBOT, PATHS, SCHEME, READY, stack=stack, task="right", dt=0.01)
    left = fp.simulate(ROBOT, PATHS, SCHEME, READY, stack=stack, dt=0.01)
    np.testing.assert_array_equal(right.q, left.q)
    np.testing.assert_allclose(right.x, poses(right.q, "right_tip")[:, :3, 3], atol=1e-12)
    assert (right.error.shape[1], left.error.shape[1]) == (3, 6)
    assert right.scale is None
    alone = fp.simulate(ROBOT, PATHS["right"], SCHEME, READY, stack=stack, task="right", dt=0.01)
    assert alone.frames["left"][:, :3, 3].std(axis=0).max() < 1e-9  # Has no path.


def test_a_grasp_follows_a_path_relative_to_the_other_hand() -> None:
    stack = fp.Stack(fp.RelativePoseTask("left_tip", "right_tip", name="grasp"), fp.PoseTask("right_tip", name="right"))
    q0 = np.add(READY, np.linspace(-0.2, 0.2, 14))
    paths = {"grasp": fp.Line([0, 0, -0.1], 1), "right": fp.Line([0, 0, 0.1], 1).with_rotation([0, 0, 0.3])}
    run = fp.simulate(ROBOT, paths, SCHEME, q0, stack=stack, dt=0.01)
    right, left = poses(run.q, "right_tip"), poses(run.q, "left_tip")
    np.testing.assert_allclose(run.x, np.linalg.inv(right) @ left, atol=1e-12)
    np.testing.assert_allclose(run.x_ref[-1, :3, 3], run.x[0, :3, 3] + [0, 0, -0.1], atol=1e-12)
    np.testing.assert_allclose(right[-1, :3, 3] - right[0, :3, 3], [0, 0, 0.1], atol=0.02)
    (tip, target), _ = tracks(run)
    np.testing.assert_allclose(tip, left[:, :3, 3], atol=1e-12)
    seen = np.einsum("kij,kj->ki", right[:, :3, :3], run.x_ref[:, :3, 3]) + right[:, :3, 3]
    np.testing.assert_allclose(target, seen, atol=1e-12)


def test_jacobians_equal_those_of_the_tasks_with_paths() -> None:
    """By differences of the points of the tasks."""
    offset = np.eye(4)
    offset[:3, 3] = [0.1, -0.2, 0.3]
    stack = fp.Stack(
        [
            fp.PositionTask("left_tip", name="a", offset=offset),
            fp.PositionTask("left_tip", name="b", offset=offset, reference_frame="right_tip"),
        ]
    )
    paths = {name: fp.Line([0.01, 0, 0], 0.1) for name in "ab"}
    run = fp.simulate(ROBOT, paths, SCHEME, np.add(READY, 0.1), stack=stack, dt=0.01)
    J = run.jacobians()[3]

    def points(q: Array) -> Array:
        right, left = ROBOT.forward(q, "right_tip"), ROBOT.forward(q, "left_tip") @ offset
        R = ROBOT.forward(run.q[3], "right_tip")[:3, :3]
        return np.concatenate([left[:3, 3], R @ (np.linalg.inv(right) @ left)[:3, 3]])

    steps = 1e-6 * np.eye(14)
    expected = np.transpose([(points(run.q[3] + step) - points(run.q[3] - step)) / 2e-6 for step in steps])
    np.testing.assert_allclose(J, expected, atol=1e-8)
    np.testing.assert_allclose(run.manipulability()[3], np.sqrt(max(np.linalg.det(J @ J.T), 0)), atol=1e-12)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"stack": None}, "stack: must be given for a Robot"),
        ({"stack": None, "path": PATHS}, "path = .*: must be one path, or paths by task names of a stack"),
        ({"path": {}}, "path = {}: must be one path"),
        ({"path": {"lift": PATHS["left"]}}, "task = 'lift': must be the name of a position or a pose"),
        ({"path": {"left": 3}}, r"path\['left'\] = 3: must be a path"),
        ({"path": PATHS, "task": "posture"}, "task = 'posture': must be one of left, right"),
        ({"dt": 0.3, "path": PATHS}, "dt = 0.3: must be a divisor of duration = 2"),
    ],
)
def test_invalid_arguments_are_rejected(change: dict[str, object], words: str) -> None:
    how = {"path": PATHS["left"], "stack": two_hands(), "task": "left" if "path" not in change else None, **change}
    path = how.pop("path")
    for move in (fp.track, fp.simulate):
        with pytest.raises(ValueError, match=words):
            move(ROBOT, path, SCHEME, READY, **how)


def test_sweeps_reject_robots() -> None:
    with pytest.raises(fp.ParameterError, match="must be an arm; simulate"):
        fp.sweep(ROBOT, PATHS["left"], SCHEME, READY, stack=two_hands(), task="left")


def test_files_hold_the_robot_and_the_paths(run: fp.Run, tmp_path: Path) -> None:
    run.save(tmp_path / "run.npz")
    again = fp.load(tmp_path / "run.npz")
    assert again == run
    assert (again.arm, again.path) == (ROBOT, PATHS)
    assert again.replay() == run
    run.to_csv(tmp_path / "run.csv")
    head = (tmp_path / "run.csv").read_text().splitlines()[0]
    for column in ("q_left_panda_joint7 [rad]", "position_error_of_right_z [m]", "angle_error_of_left_x [rad]"):
        assert column in head


def test_all_branches_are_drawn(run: fp.Run, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    from fpbm_cpp.plot import animate

    (axes,) = [axes for axes in run.plot(panels=["arm", "task_errors"]).findobj() if getattr(axes, "name", "") == "3d"]
    drawn = [np.transpose(line.get_data_3d()) for line in axes.lines]
    last = joint_points(run.arm, run.q[-1])
    assert any(each.shape == last.shape and np.allclose(each, last, equal_nan=True) for each in drawn)
    long = [each for each in drawn if len(each) == len(run.t)]
    for line in (line for track in tracks(run) for line in track):
        assert any(np.array_equal(each, line) for each in long)
    assert len(long) == 4
    animate(run, tmp_path / "run.gif", fps=2, dpi=40)


# Points of a tree


@pytest.mark.parametrize("base", [None, "planar"])
def test_the_points_of_a_tree(urdf: Path, base: str | None) -> None:
    robot = fp.Robot.from_urdf(urdf, base=base, locked={"neck": 0.2})
    q = np.random.default_rng(1).uniform(-1, 1, (2, 3, robot.dof))
    frames = link_frames(robot, q)
    for name in ("left_3", "right_tool", "waist", "base"):
        expected = [[robot.forward(posture, name) for posture in row] for row in q]
        np.testing.assert_allclose(frames_of(robot, q, name), expected, atol=1e-12)
    points = joint_points(robot, q)
    assert np.isnan(points[0, 0]).any(axis=1).sum() == 1  # Between the arms.
    for row, of_frames in zip(points[0], frames[0]):
        for p in of_frames[:, :3, 3]:
            assert np.nanmin(np.linalg.norm(row - p, axis=1)) < 1e-12
    for side in ("left", "right"):
        tips = frames_of(robot, q[0], f"{side}_tool")[:, None, :3, 3]
        assert np.nanmin(np.linalg.norm(points[0] - tips, axis=2), axis=1).max() < 1e-12
    links = np.diff(points[0, 0], axis=0)
    spans = {round(float(span), 9) for span in np.linalg.norm(links, axis=1) if span > 0}
    assert {0.12, 0.18, 0.1, 0.15, 0.03} <= spans  # No line between branches.
    axis, J = joints_of(robot)[-1].axis, robot.jacobian(q[0, 0], "right_tool")
    np.testing.assert_allclose(frames[0, 0, -1, :3, :3] @ axis, J[3:, -1], atol=1e-12)
    assert joint_units(robot).count("m") == (0 if base is None else 2)
    with pytest.raises(fp.ParameterError, match="frame = 'left_tol': must be a frame"):
        frames_of(robot, q, "left_tol")


def test_the_length_is_that_of_the_longest_branch(urdf: Path) -> None:
    robot = fp.Robot.from_urdf(urdf)
    arm = 0.5 + np.hypot(0.2, 0.4) + 0.01 + 0.12 + 0.18 + 0.1 + 0.15 + 0.03 + 0.12
    assert length(robot, np.zeros(robot.dof)) == pytest.approx(arm)
    panda = fp.SerialArm.preset("panda")
    spans = np.diff(joint_points(panda, np.ones(7)), axis=0)
    assert length(panda, np.ones(7)) == pytest.approx(np.linalg.norm(spans, axis=1).sum())


# Jobs and the command line

JOB = """
[arm]
kind = "robot"
file = "robot.urdf"
base = "planar"
locked = { neck = 0.2 }

[path.left]
kind = "circle"
radius = 0.05
duration = 4.0

[[path.right]]
kind = "line"
displacement = [0.05, 0.0, 0.0]
duration = 2.0

[[path.right]]
kind = "line"
displacement = [-0.05, 0.0, 0.0]
duration = 2.0

[limits]
acceleration = 10.0

[run]
dt = 0.01

[[task]]
kind = "pose"
frame = "left_tool"
name = "left"

[[task]]
kind = "position"
frame = "right_tool"
name = "right"

[[task]]
kind = "posture"
level = 1
"""


def test_a_job_of_a_robot(urdf: Path) -> None:
    pytest.importorskip("tomlkit")
    from fpbm_cpp.job import prepare, read_job

    Path("job.toml").write_text(JOB)
    motion = prepare(read_job("job.toml"))
    limits = fp.JointLimits(acceleration=10)
    assert motion.arm == fp.Robot.from_urdf(urdf, base="planar", locked={"neck": 0.2}, limits=limits)
    back = fp.Line([0.05, 0, 0], 2).then(fp.Line([-0.05, 0, 0], 2))
    assert motion.path == {"left": fp.Circle(0.05, 4).in_plane("yz"), "right": back}
    assert motion.label.endswith("robot.urdf, circle and line then line")
    run = motion.run()
    assert (run.task, run.arm, run.path) == ("left", motion.arm, motion.path)
    assert max(np.abs(run.errors[name]).max() for name in PATHS) < 0.01
    motion.save("again.toml")
    assert prepare(read_job("again.toml")).run() == run
    run.save("run.npz")
    assert fp.load("run.npz") == run


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("radius = 0.05", "radius = -1", "path.left.radius = -1: must be positive"),
        ("[path.left]", "[path.lift]", "run.task = 'lift': must be the name of a position or a pose"),
        ("neck = 0.2", "neck = 2", r"arm.locked\['neck'\] = 2: must be from -0.6 to 0.6"),
        ('base = "planar"', 'base = "wheels"', "arm.base = 'wheels': must be one of fixed, planar"),
        ('frame = "left_tool"', 'frame = "left_tol"', "frame = 'left_tol': must be a frame"),
        (JOB[JOB.index("[[task]]") :], "", "task: is missing: a robot needs"),
    ],
)
def test_invalid_jobs_are_rejected(urdf: Path, old: str, new: str, words: str) -> None:
    pytest.importorskip("tomlkit")
    from fpbm_cpp.job import JobError, prepare, read_job

    Path("job.toml").write_text(JOB.replace(old, new))
    with pytest.raises(JobError, match=words):
        prepare(read_job("job.toml"))


@pytest.mark.parametrize("count", [1, 2])
def test_frames_on_the_command_line(urdf: Path, count: int) -> None:
    cli, testing = pytest.importorskip("fpbm_cpp.cli"), pytest.importorskip("click.testing")
    from fpbm_cpp.job import prepare, read_job

    tools = ["left_tool", "right_tool"][:count]
    tasks = [word for tool in tools for word in ("--task", tool)]
    short = ["--radius", "0.05", "--duration", "0.5", "--dt", "0.01", "--limit-acceleration", "10"]
    how = ["track", "robot.urdf", *tasks, "--base", "planar", "--locked", "neck=0.2", *short, "--save-job", "job.toml"]
    result = testing.CliRunner().invoke(cli.command, how)
    assert result.exit_code == 0, result.output
    for words in ("final error of left_tool", "least scale of posture", "status"):
        assert words in result.stdout
    motion = prepare(read_job("job.toml"))
    limits = fp.JointLimits(acceleration=10)
    assert motion.arm == fp.Robot.from_urdf(urdf, base="planar", locked={"neck": 0.2}, limits=limits)
    assert motion.stack == fp.Stack([fp.PoseTask(tool, name=tool) for tool in tools], fp.PostureTask(k1=4, k2=4))
    circle = fp.Circle(0.05, 0.5).in_plane("yz")
    assert motion.path == (circle if count == 1 else dict.fromkeys(tools, circle))


def test_the_command_line_reports_invalid_options(urdf: Path) -> None:
    cli, testing = pytest.importorskip("fpbm_cpp.cli"), pytest.importorskip("click.testing")
    for words, line in [
        (["track", "robot.urdf", "--task", "tol"], "--task = 'tol': must be a frame"),
        (["track", "robot.urdf", "--task", "left_tool", "--locked", "neck"], "--locked = 'neck': must be JOINT=NUMBER"),
        (["track", "robot.urdf", "--task", "left_tool", "--locked", "nek=1"], "--locked has 'nek'"),
        (["track", "robot.urdf", "--task", "pose"], "--tip = '': must be a link"),
        (["track", "panda", "--task", "pose", "--task", "position"], "--task: must be given once"),
        (["sweep", "two_pandas", "--task", "left_tip"], "arm: must be an arm on one path"),
    ]:
        result = testing.CliRunner().invoke(cli.command, words)
        assert result.exit_code == 1, result.output
        assert re.match(rf"Error: {re.escape(line)}", result.stderr), result.stderr
