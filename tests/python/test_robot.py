"""Robots as trees, against Pinocchio; tasks of their frames."""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import fpbm_cpp as fp
from fpbm_cpp._types import Array
from fpbm_cpp.errors import ParameterError

pin = pytest.importorskip("pinocchio")


def random_urdf(rng: np.random.Generator, joints: int) -> str:
    """A tree of revolute, continuous, prismatic, fixed and mimic joints, with masses."""
    text = ['<robot name="r">']
    moving: list[str] = []
    for i in range(joints + 1):
        xyz = " ".join(map(str, rng.uniform(-0.2, 0.2, 3)))
        inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        mass = f'<inertial><origin xyz="{xyz}"/><mass value="{rng.uniform(0.1, 3)}"/>{inertia}</inertial>'
        text.append(f'<link name="l{i}">{mass if rng.random() < 0.8 else ""}</link>')
    for i in range(joints):
        parent = i if rng.random() < 0.6 else int(rng.integers(0, i + 1))
        kind = str(rng.choice(["revolute", "continuous", "prismatic", "fixed"], p=[0.5, 0.15, 0.2, 0.15]))
        xyz, rpy, axis = (" ".join(map(str, rng.uniform(-1, 1, 3) * size)) for size in (0.5, 2, 1))
        mimic = ""
        if kind in ("revolute", "prismatic") and moving and rng.random() < 0.2:
            leader = moving[int(rng.integers(len(moving)))]
            mimic = f'<mimic joint="{leader}" multiplier="{rng.uniform(0.2, 1.5)}" offset="{rng.uniform(-0.2, 0.2)}"/>'
        elif kind == "revolute":
            moving.append(f"j{i}")
        limit = '<limit lower="-9" upper="9" velocity="1" effort="1"/>' if kind != "fixed" else ""
        ends = f'<parent link="l{parent}"/><child link="l{i + 1}"/>'
        axis = f'<axis xyz="{axis}"/>' if kind != "fixed" else ""
        origin = f'<origin xyz="{xyz}" rpy="{rpy}"/>'
        text.append(f'<joint name="j{i}" type="{kind}">{ends}{origin}{axis}{limit}{mimic}</joint>')
    return "".join(text) + "</robot>"


class Reference:
    """A URDF's robot by Pinocchio, with the positions of fpbm_cpp's joints."""

    def __init__(self, urdf: str, robot: fp.Robot) -> None:
        self.model = pin.buildModelFromXML(urdf, pin.JointModelFreeFlyer())
        self.data = self.model.createData()
        self.robot = robot
        names = [each.joint.name for each in robot.joints]
        drives = {name: i for i, name in enumerate(robot.joint_names)}
        self.ratio = np.zeros((len(names), robot.dof))
        self.offset = np.zeros(len(names))
        for i, each in enumerate(robot.joints):
            leader, ratio, offset = each.joint.mimic or (i, 1.0, 0.0)
            self.ratio[i, drives[names[leader]]], self.offset[i] = ratio, offset
        self.columns = [self.model.joints[self.model.getJointId(name)].idx_v for name in names]
        self.names = names

    def set(self, q: Array, qd: Array) -> None:
        positions, rates = self.ratio @ q + self.offset, self.ratio @ qd
        whole, v = pin.neutral(self.model), np.zeros(self.model.nv)
        for joint in self.model.joints[2:]:  # Held joints are at their positions nearest to 0.
            if joint.nq == 1:
                low, high = self.model.lowerPositionLimit[joint.idx_q], self.model.upperPositionLimit[joint.idx_q]
                whole[joint.idx_q] = min(max(0.0, low), high)
        for name, position, rate in zip(self.names, positions, rates):
            joint = self.model.joints[self.model.getJointId(name)]
            if joint.nq == 2:
                whole[joint.idx_q : joint.idx_q + 2] = np.cos(position), np.sin(position)
            else:
                whole[joint.idx_q] = position
            v[joint.idx_v] = rate
        pin.computeJointJacobiansTimeVariation(self.model, self.data, whole, v)
        pin.updateFramePlacements(self.model, self.data)
        self.center = pin.centerOfMass(self.model, self.data, whole, v, False).copy()

    def frame(self, name: str) -> tuple[Array, Array, Array]:
        number = self.model.getFrameId(name)
        axes = pin.LOCAL_WORLD_ALIGNED
        J = pin.getFrameJacobian(self.model, self.data, number, axes)[:, self.columns] @ self.ratio
        Jd = pin.getFrameJacobianTimeVariation(self.model, self.data, number, axes)[:, self.columns] @ self.ratio
        return self.data.oMf[number].homogeneous, J, Jd


def expect_pinocchio(urdf: str, robot: fp.Robot, rng: np.random.Generator, frames: list[str]) -> float:
    """The largest difference of frames, J, J̇ and centre of mass."""
    reference = Reference(urdf, robot)
    q, qd = rng.uniform(-1, 1, robot.dof), rng.uniform(-1, 1, robot.dof)
    reference.set(q, qd)
    worst = 0.0
    for frame in frames:
        at, J, Jd = reference.frame(frame)
        found = (robot.forward(q, frame), robot.jacobian(q, frame), robot.jacobian_dot(q, qd, frame))
        worst = max(worst, *(float(np.max(np.abs(one - two))) for one, two in zip(found, (at, J, Jd))))
    if robot.base_mass + sum(each.joint.mass for each in robot.joints) > 0:
        worst = max(worst, float(np.max(np.abs(robot.center_of_mass(q) - reference.center))))
    return worst


TREES = int(os.environ.get("FPBM_TREES", "100"))


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str], Path]:
    def write(text: str) -> Path:
        file = tmp_path / "robot.urdf"
        file.write_text(text)
        return file

    return write


def test_random_trees_agree_with_pinocchio(write) -> None:
    rng = np.random.default_rng(1)
    worst, compared = 0.0, 0
    while compared < TREES:
        urdf = random_urdf(rng, int(rng.integers(2, 64 if compared % 10 == 0 else 16)))
        if all(f'type="{kind}"' not in urdf for kind in ("revolute", "continuous", "prismatic")):
            continue
        robot = fp.Robot.from_urdf(write(urdf))
        frames = list(rng.choice(robot.frames, size=min(5, len(robot.frames)), replace=False))
        worst = max(worst, expect_pinocchio(urdf, robot, rng, frames))
        compared += 1
    print(f"{compared} random trees: {worst:.1e}")
    assert worst < 1e-12


ROBOTS = Path(pin.__file__).parents[4] / "share" / "example-robot-data" / "robots"


@pytest.mark.skipif(not ROBOTS.exists(), reason="needs example-robot-data")
@pytest.mark.parametrize(
    ("urdf", "dof", "tips"),
    [
        ("g1_description/urdf/g1_29dof_rev_1_0.urdf", 29, None),
        ("g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf", 43, None),
        ("baxter_description/urdf/baxter.urdf", 17, None),
        ("go2_description/urdf/go2.urdf", 6, ["FL_foot", "RR_foot"]),
        ("tiago_description/robots/tiago.urdf", 48, None),
        ("icub_description/robots/icub.urdf", 32, None),
        ("talos_data/robots/talos_full_v2.urdf", 32, None),
        ("ur_description/urdf/ur5_robot.urdf", 6, None),
    ],
)
def test_robots_agree_with_pinocchio(urdf: str, dof: int, tips: list[str] | None) -> None:
    file = ROBOTS / urdf
    robot = fp.Robot.from_urdf(file, base="fixed", tips=tips)
    assert robot.dof == dof
    rng = np.random.default_rng(3)
    assert max(expect_pinocchio(file.read_text(), robot, rng, list(robot.frames)) for _ in range(5)) < 1e-12


def test_a_robot_can_be_pickled(write) -> None:
    robot = fp.Robot.from_urdf(write(random_urdf(np.random.default_rng(2), 8)))
    again = pickle.loads(pickle.dumps(robot))
    assert again == robot
    assert again.frames == robot.frames
    q = np.full(robot.dof, 0.3)
    np.testing.assert_array_equal(again.jacobian(q, "l5"), robot.jacobian(q, "l5"))
    assert robot.limits.lower.shape == (robot.dof,)
    np.testing.assert_array_equal(robot.jacobian(q, "l5", task="position"), robot.jacobian(q, "l5")[:3])


def link(name: str, mass: float = 0.0) -> str:
    return f'<link name="{name}">' + (f'<inertial><mass value="{mass}"/></inertial>' if mass else "") + "</link>"


def joint(name: str, parent: str, child: str, kind: str = "revolute", more: str = "") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/>'
    return f'<joint name="{name}" type="{kind}">{ends}<limit lower="-1" upper="2" velocity="3"/>{more}</joint>'


def robot_text(*parts: str) -> str:
    return f'<robot name="r">{"".join(parts)}</robot>'


TWO_ARMS = robot_text(
    *map(link, ("base", "chest", "left", "left_tool", "right", "right_tool")),
    joint("waist", "base", "chest"),
    joint("left_shoulder", "chest", "left"),
    joint("left_elbow", "left", "left_tool"),
    joint("right_shoulder", "chest", "right"),
    joint("right_elbow", "right", "right_tool"),
)


def test_parts_and_locked_joints(write) -> None:
    file = write(TWO_ARMS)
    whole = fp.Robot.from_urdf(file)
    assert whole.joint_names == ["waist", "left_shoulder", "left_elbow", "right_shoulder", "right_elbow"]
    left = fp.Robot.from_urdf(file, tips="left_tool", locked={"waist": 0.5})
    assert left.joint_names == ["left_shoulder", "left_elbow"]
    q = np.array([0.2, -0.4])
    for tool, posture in (("left_tool", [0.5, *q, 0, 0]), ("right_tool", [0.5, 0, 0, 0, 0])):
        np.testing.assert_allclose(left.forward(q, tool), whole.forward(posture, tool), atol=1e-15)


def test_planar_base(write) -> None:
    robot = fp.Robot.from_urdf(write(TWO_ARMS), base="planar")
    assert robot.joint_names[:3] == ["base_x", "base_y", "base_yaw"]
    at = robot.forward([1.0, 2.0, np.pi / 2, 0, 0, 0, 0, 0], "chest")
    np.testing.assert_allclose(at[:3, 3], [1, 2, 1], atol=1e-12)
    np.testing.assert_allclose(at[:3, 0], [0, 1, 0], atol=1e-12)


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        (TWO_ARMS, {"locked": {"wrist": 0}}, r"locked has 'wrist': must be names of joints that move"),
        (TWO_ARMS, {"locked": {"waist": 3}}, r"locked\['waist'\] = 3: must be from -1 to 2"),
        (TWO_ARMS, {"tips": ["left_tol"]}, r"tips has 'left_tol': must be links, perhaps 'left_tool'"),
        (
            robot_text(link("a"), link("b"), joint("j", "a", "b").replace('upper="2"', 'upper="-1"')),
            {},
            "no joints move: must be 1 to 64: to move a joint, give limits=fp.JointLimits",
        ),
        (TWO_ARMS, {"base": "wheels"}, r"base = 'wheels': must be"),
        (
            robot_text(link("world"), link("base"), joint("free", "world", "base", "floating")),
            {},
            r"joint 'free' is floating: base= must be 'fixed' or 'planar', to replace it",
        ),
        (robot_text(link("a"), link("b"), joint("j", "a", "b", "fixed")), {}, "no joints move: must be 1 to 64"),
        (robot_text(link("a"), link("b"), joint("j", "a", "b"), joint("k", "b", "a")), {}, "links form a loop"),
        (
            robot_text(*(link(f"l{i}") for i in range(66)), *(joint(f"j{i}", "l0", f"l{i + 1}") for i in range(65))),
            {},
            "65 joints move: must be 1 to 64; fix the other joints by locked= or tips=",
        ),
    ],
)
def test_invalid_arguments_are_named(text: str, options: dict, message: str, write) -> None:
    with pytest.raises(ValueError, match=message):
        fp.Robot.from_urdf(write(text), **options)


def test_a_tracker_of_a_robot_needs_a_stack(write) -> None:
    robot = fp.Robot.from_urdf(write(TWO_ARMS))
    with pytest.raises(ParameterError, match="stack: must be given for a Robot"):
        fp.Tracker(robot, fp.MVN(), np.zeros(5))
    with pytest.raises(ParameterError, match=r"frame = 'tip': must be a frame, or the joint of a link: 'base', 'base'"):
        fp.Tracker(robot, fp.MVN(), np.zeros(5), stack=fp.Stack(fp.PositionTask()))
    task = fp.PositionTask("left", reference_frame="left_shoulder")
    with pytest.raises(ParameterError, match="reference_frame: moves with the task's frame"):
        fp.Tracker(robot, fp.MVN(), np.zeros(5), stack=fp.Stack(task))
    with pytest.raises(ParameterError, match="robot has no mass"):
        fp.Tracker(robot, fp.MVN(), np.zeros(5), stack=fp.Stack(fp.CenterOfMassTask()))


@pytest.mark.parametrize("level", ["acceleration", "velocity"])
def test_a_grasp_holds_within_limits(level: str) -> None:
    """The tray jumps farther than the limits allow; positions, velocities and accelerations by differences of q.

    A tick by velocity moves the grasp by h²/2 of its acceleration, which no gain undoes within that tick.
    """
    robot = fp.Robot.preset("two_pandas")
    q = np.tile([0, -0.6, 0, -2.4, 0, 1.8, 0.785], 2)
    stack = fp.Stack(
        fp.RelativePoseTask("left_tip", "right_tip", name="grasp", k1=500, k2=62_500, k=600),
        fp.PoseTask("right_tip", name="tray"),
        fp.PostureTask(q, k1=4, k2=4, k=2),
    )
    scheme = fp.MVN() if level == "velocity" else fp.Balanced(0, np.ones(14), null_damping=2)
    tracker = fp.Tracker(robot, scheme, q, stack=stack, keep_first_level=True)
    start = tracker.tip["tray"]
    rng, limits, slowed, path = np.random.default_rng(4), robot.limits, 0, [q, q]
    for k in range(4000):
        if k % 1000 == 0:
            goal = start.copy()
            goal[:3, 3] += rng.uniform(-0.4, 0.4, 3)
            goal[:3, :3] = fp.rotation(rng.uniform(-0.6, 0.6, 3)) @ start[:3, :3]
        tick = tracker.tick({"tray": goal})
        assert np.abs(tick.errors["grasp"]).max() < (1e-6 if level == "acceleration" else 1e-5)
        slowed += tick.scales[1] < 1
        path.append(tick.q)
    assert slowed > 0
    positions = np.array(path)
    assert np.all((limits.lower <= positions) & (positions <= limits.upper))
    assert np.all(np.abs(np.diff(positions, axis=0)) <= limits.velocity * 1e-3 * (1 + 1e-9))
    assert np.all(np.abs(np.diff(positions, n=2, axis=0)) <= limits.acceleration * 1e-6 * (1 + 1e-9))
