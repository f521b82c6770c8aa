"""Serial arms against Pinocchio and Orocos KDL, presets against other URDFs; skipped without a peer."""

from __future__ import annotations

import functools
import importlib.util
import sysconfig
from collections.abc import Callable, Iterator
from importlib import metadata
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np
import pytest

import fpbm_cpp as fp
from fpbm_cpp._types import Array

STATES = 1000


class Link(NamedTuple):
    """A joint, and its placement in the frame of the previous joint."""

    placement: Array
    axis: Array
    prismatic: bool


class Robot(NamedTuple):
    """An arm, and its model for the peers: the links, or a URDF and its tip for peers that read URDF files."""

    arm: fp.SerialArm
    links: list[Link]
    tip: Array
    urdf: tuple[str, str] | None = None


# Pose of the tip, J and Jd at (q, qd).
Kinematics = Callable[[Array, Array], tuple[Array, Array, Array]]


def rotation(axis: Array, angle: float) -> Array:
    """Rodrigues' formula."""
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def frame(R: Array, p: Array) -> Array:
    T = np.eye(4)
    T[:3, :3] = R
    T[:3, 3] = p
    return T


def read_urdf(path: str, tip: str) -> tuple[list[Link], Array]:
    """A minimal reader of URDF files, which shares no code with the package's reader."""

    def numbers(element: ElementTree.Element | None, key: str, default: str) -> Array:
        return np.array((default if element is None else element.get(key, default)).split(), dtype=float)

    x, y, z = np.eye(3)
    above = {joint.find("child").get("link"): joint for joint in ElementTree.parse(path).findall("joint")}
    links: list[Link] = []
    after = np.eye(4)  # From the joint to the next, or to the tip.
    while (joint := above.get(tip)) is not None:
        origin = joint.find("origin")
        roll, pitch, yaw = numbers(origin, "rpy", "0 0 0")
        R = rotation(z, yaw) @ rotation(y, pitch) @ rotation(x, roll)
        placement = frame(R, numbers(origin, "xyz", "0 0 0"))
        if joint.get("type") == "fixed":
            after = placement @ after
        else:
            axis = numbers(joint.find("axis"), "xyz", "1 0 0")
            links.insert(0, Link(after, axis / np.linalg.norm(axis), joint.get("type") == "prismatic"))
            after = placement
        tip = joint.find("parent").get("link")
    # Each placement was stored with the previous link: shift by one.
    placements = [after, *(link.placement for link in links)]
    return [link._replace(placement=p) for link, p in zip(links, placements)], placements[-1]


def links_of(joints: tuple[fp.Joint, ...]) -> list[Link]:
    return [
        Link(np.asarray(j.placement), np.asarray(j.axis) / np.linalg.norm(j.axis), j.type == "prismatic")
        for j in joints
    ]


def pinocchio(robot: Robot) -> Kinematics:
    try:
        import pinocchio as pin
    except ImportError as error:
        pytest.skip(f"Pinocchio (PyPI: pin): {error}")
    if robot.urdf is not None:
        path, tip = robot.urdf
        whole = pin.buildModelFromUrdf(path)
        chain_joints = []
        joint = whole.frames[whole.getFrameId(tip)].parentJoint
        while joint > 0:
            chain_joints.append(joint)
            joint = whole.parents[joint]
        others = [joint for joint in range(1, whole.njoints) if joint not in chain_joints]
        model = pin.buildReducedModel(whole, others, pin.neutral(whole))
        end = model.getFrameId(tip)
    else:
        model = pin.Model()
        joint = 0
        for i, link in enumerate(robot.links):
            kind = pin.JointModelPrismaticUnaligned if link.prismatic else pin.JointModelRevoluteUnaligned
            joint = model.addJoint(joint, kind(link.axis), pin.SE3(link.placement), f"joint_{i}")
        end = model.addFrame(pin.Frame("tip", joint, 0, pin.SE3(robot.tip), pin.FrameType.OP_FRAME))
    assert model.nv == robot.arm.dof
    data = model.createData()
    zero = pin.neutral(model)

    def kinematics(q: Array, qd: Array) -> tuple[Array, Array, Array]:
        # Pinocchio represents the position of a joint without bounds by its cosine and sine.
        pin.computeJointJacobiansTimeVariation(model, data, pin.integrate(model, zero, q), qd)
        return (
            pin.updateFramePlacement(model, data, end).homogeneous,
            pin.getFrameJacobian(model, data, end, pin.LOCAL_WORLD_ALIGNED),
            pin.getFrameJacobianTimeVariation(model, data, end, pin.LOCAL_WORLD_ALIGNED),
        )

    return kinematics


@functools.cache
def import_kdl():
    """PyKDL. Debian's PyKDL is imported from its file, because its folder has packages for another environment."""
    spec = importlib.util.find_spec("PyKDL")
    if spec is None:
        file = Path("/usr/lib/python3/dist-packages", "PyKDL" + sysconfig.get_config_var("EXT_SUFFIX"))
        spec = importlib.util.spec_from_file_location("PyKDL", file)
    try:
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    except ImportError as error:
        pytest.skip(f"PyKDL (Debian: python3-pykdl): {error}")
    return module


def kdl(robot: Robot) -> Kinematics:
    orocos = import_kdl()
    n = len(robot.links)

    def fixed(T: Array):
        return orocos.Segment(
            orocos.Joint(orocos.Joint.Fixed),
            orocos.Frame(orocos.Rotation(*map(float, T[:3, :3].flat)), orocos.Vector(*T[:3, 3])),
        )

    chain = orocos.Chain()
    for link in robot.links:
        kind = orocos.Joint.TransAxis if link.prismatic else orocos.Joint.RotAxis
        chain.addSegment(fixed(link.placement))
        chain.addSegment(orocos.Segment(orocos.Joint("", orocos.Vector(0, 0, 0), orocos.Vector(*link.axis), kind)))
    chain.addSegment(fixed(robot.tip))
    to_tip = orocos.ChainFkSolverPos_recursive(chain)
    to_jacobian = orocos.ChainJntToJacSolver(chain)
    to_jacobian_dot = orocos.ChainJntToJacDotSolver(chain)
    to_jacobian_dot.setHybridRepresentation()  # Axes of the base, at the tip.

    def joints(values: Array):
        array = orocos.JntArray(n)
        for i, value in enumerate(values):
            array[i] = value
        return array

    def matrix(jacobian) -> Array:
        return np.array([[jacobian[row, column] for column in range(n)] for row in range(6)])

    def kinematics(q: Array, qd: Array) -> tuple[Array, Array, Array]:
        assert chain.getNrOfJoints() == n  # Keeps the chain alive: the solvers only refer to it.
        end, jacobian, jacobian_dot = orocos.Frame(), orocos.Jacobian(n), orocos.Jacobian(n)
        assert to_tip.JntToCart(joints(q), end) == 0
        assert to_jacobian.JntToJac(joints(q), jacobian) == 0
        assert to_jacobian_dot.JntToJacDot(orocos.JntArrayVel(joints(q), joints(qd)), jacobian_dot) == 0
        tip = np.array([[end[row, column] for column in range(4)] for row in range(3)] + [[0.0, 0.0, 0.0, 1.0]])
        return tip, matrix(jacobian), matrix(jacobian_dot)

    return kinematics


# From example-robot-data. The torso of TIAGo and PR2 is prismatic, some joints of PR2 are continuous, and the fixed
# joints at TIAGo's wrist and at both ends of Baxter's arm do not commute.
URDFS = {
    "Panda": ("panda_description/urdf/panda.urdf", "panda_hand"),
    "UR5": ("ur_description/urdf/ur5_robot.urdf", "tool0"),
    "TIAGo": ("tiago_description/robots/tiago_no_hand.urdf", "wrist_ft_link"),
    "Baxter": ("baxter_description/urdf/baxter.urdf", "right_hand_range_link"),
    "PR2": ("pr2_description/urdf/pr2.urdf", "r_gripper_tool_frame"),
}
PRESETS = ("panda", "iiwa14", "gen3", "ur5e", "ur10e")


@functools.cache
def robot(name: str) -> Robot:
    if name in PRESETS:
        arm = fp.SerialArm.preset(name)
        return Robot(arm, links_of(arm.joints), arm.tip)
    for package in ("yourdfpy", "example-robot-data"):
        try:
            data = metadata.distribution(package)
        except metadata.PackageNotFoundError:
            pytest.skip(f"{package} is not installed")
    file, tip = URDFS[name]
    path = str(data.locate_file(f"cmeel.prefix/share/example-robot-data/robots/{file}"))
    return Robot(fp.SerialArm.from_urdf(path, tip), *read_urdf(path, tip), (path, tip))


def random_robot(rng: np.random.Generator) -> Robot:
    def transform() -> Array:
        axis = rng.normal(size=3)
        return frame(rotation(axis / np.linalg.norm(axis), rng.uniform(0, np.pi)), rng.uniform(-0.5, 0.5, 3))

    kinds = rng.choice(["revolute", "continuous", "prismatic"], size=rng.integers(2, 11))
    joints = tuple(fp.Joint(str(kind), transform(), rng.normal(size=3)) for kind in kinds)
    tip = transform()
    return Robot(fp.SerialArm.from_joints(joints, tip), links_of(joints), tip)


def states(links: list[Link], count: int, seed: int = 1) -> Iterator[tuple[Array, Array]]:
    rng = np.random.default_rng(seed)
    half_range = np.where([link.prismatic for link in links], 1.0, np.pi)
    for _ in range(count):
        yield rng.uniform(-half_range, half_range), rng.uniform(-2.0, 2.0, len(links))


def deviation(robot: Robot, peer: Kinematics, count: int) -> float:
    """Largest deviation, relative to entries above 1."""
    worst = 0.0
    for q, qd in states(robot.links, count):
        ours = robot.arm.kinematics(q, qd, task="pose")
        for a, b in zip((ours.tip, ours.J, ours.Jd), peer(q, qd)):
            assert a.shape == b.shape
            worst = max(worst, np.max(np.abs(a - b) / np.maximum(1.0, np.abs(b))))
    return worst


peers = pytest.mark.parametrize(("peer", "tolerance"), [(pinocchio, 1e-12), (kdl, 1e-10)], ids=["Pinocchio", "KDL"])


@peers
@pytest.mark.parametrize("name", [*URDFS, *PRESETS])
def test_arms_agree_with_the_peers(peer, tolerance, name):
    assert deviation(robot(name), peer(robot(name)), STATES) <= tolerance


@peers
def test_chains_of_mixed_joints_agree_with_the_peers(peer, tolerance):
    rng = np.random.default_rng(2)
    chains = [random_robot(rng) for _ in range(25)]
    assert {link.prismatic for chain in chains for link in chain.links} == {False, True}
    for chain in chains:
        assert deviation(chain, peer(chain), STATES // len(chains)) <= tolerance


@pytest.mark.parametrize("name", [*URDFS, *PRESETS])
def test_a_position_is_the_linear_rows_of_a_pose(name):
    arm = robot(name).arm
    for q, qd in states(robot(name).links, 100):
        pose = arm.kinematics(q, qd, task="pose")
        position = arm.kinematics(q, qd, task="position")
        for a, b in (
            (arm.forward(q), pose.tip),
            (arm.jacobian(q, task="pose"), pose.J),
            (arm.jacobian_dot(q, qd, task="pose"), pose.Jd),
            (position.tip, pose.tip[:3, 3]),
            (position.J, pose.J[:3]),
            (position.Jd, pose.Jd[:3]),
            (arm.jacobian(q, task="position"), pose.J[:3]),
            (arm.jacobian_dot(q, qd, task="position"), pose.Jd[:3]),
        ):
            np.testing.assert_allclose(a, b, rtol=0, atol=1e-14)


# URDFs in the PyPI package ManipulaPy, from several sources. The accuracy of a URDF is the accuracy of π in the file:
# the first two files have twelve digits or more, the file of Kinova has 3.1416, and ur_description has 1.570796327.
OTHERS = {
    "panda": ("franka_panda/panda.urdf", "panda_link8", 1e-10),
    "iiwa14": ("kuka_iiwa/iiwa14/iiwa14.urdf", "iiwa_link_ee_kuka", 1e-10),
    "gen3": ("kinova/gen3/gen3_v12.urdf", "end_effector_link", 3e-5),
    "ur5e": ("universal_robots/ur5e/ur5e.urdf", "tool0", 1e-9),
    "ur10e": ("universal_robots/ur10e/ur10e.urdf", "tool0", 1e-9),
}


@pytest.mark.parametrize("name", PRESETS)
def test_presets_agree_with_manipulapy(name):
    package = importlib.util.find_spec("ManipulaPy")
    if package is None:
        pytest.skip("ManipulaPy is not installed")
    file, tip, tolerance = OTHERS[name]
    path = Path(package.origin).parent / "ManipulaPy_data" / file
    links, end = read_urdf(str(path), tip)
    if name.startswith("ur"):  # The preset has the controller's base. ROS rotates base_link by half a turn.
        links[0] = links[0]._replace(placement=frame(rotation(np.eye(3)[2], np.pi), np.zeros(3)) @ links[0].placement)
    preset = fp.SerialArm.preset(name)
    other = fp.SerialArm.from_joints(
        [fp.Joint("prismatic" if link.prismatic else "revolute", link.placement, link.axis) for link in links], end
    )
    for q, _ in states(links, STATES):
        np.testing.assert_allclose(preset.forward(q), other.forward(q), rtol=0, atol=tolerance)
        np.testing.assert_allclose(preset.jacobian(q, task="pose"), other.jacobian(q, task="pose"), atol=tolerance)

    # The URDF of Kinova has wider ranges than the preset. The URDFs of UR have half of the preset's range of the elbow.
    limits = [limit for joint in ElementTree.parse(path).findall("joint") if (limit := joint.find("limit")) is not None]
    lower = [float(limit.get("lower", -np.inf)) for limit in limits[: preset.dof]]
    upper = [float(limit.get("upper", np.inf)) for limit in limits[: preset.dof]]
    halved = [joint == "elbow_joint" for joint in preset.joint_names]
    assert np.all(preset.limits.lower >= np.array(lower) * np.where(halved, 2, 1) - 1e-9)
    assert np.all(preset.limits.upper <= np.array(upper) * np.where(halved, 2, 1) + 1e-9)
    if name.startswith("ur"):
        speeds = [float(limit.get("velocity")) for limit in limits]
        np.testing.assert_allclose(preset.limits.velocity, speeds, rtol=1e-12)


# URDFs in the PyPI package example-robot-data.
OF_EXAMPLE_ROBOT_DATA = {
    "z1": ("z1_description/urdf/z1.urdf", "gripperStator", 1e-12),
    "so101": ("so_arm_description/urdf/so101.urdf", "gripper_frame_link", 2e-5),  # The file has five digits of π.
}


@pytest.mark.parametrize("name", OF_EXAMPLE_ROBOT_DATA)
def test_presets_agree_with_example_robot_data(name):
    file, tip, tolerance = OF_EXAMPLE_ROBOT_DATA[name]
    try:
        data = metadata.distribution("example-robot-data")
    except metadata.PackageNotFoundError:
        pytest.skip("example-robot-data is not installed")
    other = fp.SerialArm.from_urdf(str(data.locate_file(f"cmeel.prefix/share/example-robot-data/robots/{file}")), tip)
    preset = fp.SerialArm.preset(name)
    assert preset.joint_names == other.joint_names
    rng = np.random.default_rng(0)
    for q in rng.uniform(-1.5, 1.5, (100, preset.dof)):
        np.testing.assert_allclose(preset.forward(q), other.forward(q), rtol=0, atol=tolerance)
    np.testing.assert_allclose(preset.limits.lower, other.limits.lower, rtol=0, atol=1e-5)
    np.testing.assert_allclose(preset.limits.upper, other.limits.upper, rtol=0, atol=1e-5)
