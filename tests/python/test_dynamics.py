"""Dynamics of arms and robots, against Pinocchio, finite differences of the energies and textbook formulas."""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import fpbm_cpp as fp
from fpbm_cpp._types import Array
from fpbm_cpp.arms import Arm
from fpbm_cpp.joints import Joint
from fpbm_cpp.skeleton import joints_of, link_frames

pin = pytest.importorskip("pinocchio") if find_spec("pinocchio") else None
needs_pinocchio = pytest.mark.skipif(pin is None, reason="needs Pinocchio")

CMEEL = find_spec("cmeel")
DATA = (
    Path(CMEEL.origin).parents[1] / "cmeel.prefix/share/example-robot-data/robots" if CMEEL and CMEEL.origin else None
)
needs_robots = pytest.mark.skipif(pin is None or DATA is None or not DATA.exists(), reason="needs example-robot-data")

# Robots of example-robot-data: file, file with rotors, links that move or None.
ROBOTS: dict[str, tuple[str, str | None, tuple[str, ...] | None]] = {
    "panda": ("panda_description/urdf/panda.urdf", None, None),
    "g1": ("g1_description/urdf/g1_29dof_rev_1_0.urdf", None, None),
    "talos": ("talos_data/robots/talos_reduced.urdf", "talos_data/srdf/talos.srdf", None),
    "tiago": ("tiago_description/robots/tiago.urdf", None, None),
    "tiago_arm": ("tiago_description/robots/tiago.urdf", None, ("arm_tool_link",)),
    "ur10": ("ur_description/urdf/ur10_robot.urdf", None, None),
}
TREES = int(os.environ.get("FPBM_TREES", "100"))
INERTIAL = ("kinetic_energy", "potential_energy", "inverse_dynamics", "bias", "gravity", "mass_matrix")


def coupling(robot: Arm | fp.Robot) -> tuple[Array, Array]:
    """A and b, where the positions of all joints are A q + b."""
    joints = joints_of(robot)
    drives = [i for i, joint in enumerate(joints) if joint.mimic is None]
    A, b = np.eye(len(joints))[:, drives], np.zeros(len(joints))
    for i, joint in enumerate(joints):
        if joint.mimic is not None:
            leader, ratio, b[i] = joint.mimic
            A[i] = ratio * A[leader]
    return A, b


class Reference:
    """Dynamics by Pinocchio, in the drives of a robot; joints that the robot fixes are near 0."""

    def __init__(self, model: Any, robot: Arm | fp.Robot, srdf: str | None = None) -> None:
        self.model = model
        if srdf is not None:
            pin.loadRotorParameters(self.model, srdf)
            self.model.armature = self.model.rotorInertia * self.model.rotorGearRatio**2
        self.model.gravity.linear = np.array(robot.gravity_vector)
        self.data = self.model.createData()
        self.A, self.b = coupling(robot)
        self.joints = joints_of(robot)
        own = [self.model.joints[self.model.getJointId(joint.name)] for joint in self.joints]
        self.q, self.v = [each.idx_q for each in own], [each.idx_v for each in own]
        self.circle = [each.nq == 2 for each in own]
        self.damping = np.diag([joint.damping for joint in self.joints])

    def of(self, q: Array, qd: Array, qdd: Array) -> dict[str, Any]:
        """The results of the methods INERTIAL at (q, qd, qdd)."""
        model, data, A = self.model, self.data, self.A
        whole = pin.neutral(model)
        for joint in model.joints[1:]:
            if joint.nq == 1:
                low, high = model.lowerPositionLimit[joint.idx_q], model.upperPositionLimit[joint.idx_q]
                whole[joint.idx_q] = min(max(0.0, low), high)
        for i, circle, position in zip(self.q, self.circle, A @ q + self.b):
            whole[i : i + 1 + circle] = [np.cos(position), np.sin(position)] if circle else position
        v, a = np.zeros(model.nv), np.zeros(model.nv)
        v[self.v], a[self.v] = A @ qd, A @ qdd

        def torque(v: Array, a: Array) -> Array:
            return np.asarray(A.T @ (pin.rnea(model, data, whole, v, a)[self.v] + self.damping @ v[self.v]))

        zero = np.zeros(model.nv)
        full = pin.crba(model, data, whole)
        M = np.triu(full) + np.triu(full, 1).T
        mass = A.T @ M[np.ix_(self.v, self.v)] @ A
        potential = pin.computePotentialEnergy(model, data, whole)
        return {
            "inverse_dynamics": torque(v, a),
            "bias": torque(v, zero),
            "gravity": torque(zero, zero),
            "mass_matrix": mass,
            "kinetic_energy": qd @ mass @ qd / 2,
            "potential_energy": potential,
        }


def model_of(robot: fp.SerialArm | fp.Robot) -> Any:
    """The joints and links of an arm or a robot as a model of Pinocchio, in which mimic joints are independent."""
    model = pin.Model()
    joints = joints_of(robot)
    parents = [each.parent for each in robot.joints] if isinstance(robot, fp.Robot) else range(len(joints))
    for i, (joint, parent) in enumerate(zip(joints, parents), 1):
        axis = joint.axis / np.linalg.norm(joint.axis)
        kind = pin.JointModelPrismaticUnaligned if joint.type == "prismatic" else pin.JointModelRevoluteUnaligned
        model.addJoint(parent, kind(axis), pin.SE3(joint.placement), joint.name)
        model.appendBodyToJoint(i, pin.Inertia(joint.mass, joint.center, joint.inertia), pin.SE3.Identity())
    model.armature = np.array([joint.rotor_inertia for joint in joints])
    return model


def expect_equal(robot: Arm | fp.Robot, reference: Reference, rng: np.random.Generator, states: int = 10) -> None:
    for _ in range(states):
        q, qd, qdd = rng.uniform(-1.5, 1.5, (3, robot.dof))
        expected = reference.of(q, qd, qdd)
        # Pinocchio counts the links that move with a fixed joint, as long as the joint is not fixed in its model.
        expected["potential_energy"] -= reference.of(0 * q, qd, qdd)["potential_energy"] - robot.potential_energy(0 * q)
        given = {"inverse_dynamics": (q, qd, qdd), "bias": (q, qd), "kinetic_energy": (q, qd)}
        largest = np.abs(expected["inverse_dynamics"]).max()
        for name in INERTIAL:
            found = getattr(robot, name)(*given.get(name, (q,)))
            scale = largest if name in ("bias", "gravity") else np.abs(expected[name]).max()
            assert np.abs(found - expected[name]).max() <= 1e-12 * scale, name


def random_joint(rng: np.random.Generator, name: str = "", type: str = "revolute") -> Joint:
    placement = np.eye(4)
    placement[:3, :3] = Rotation.random(random_state=int(rng.integers(1 << 30))).as_matrix()
    placement[:3, 3] = rng.uniform(-0.5, 0.5, 3)
    R = Rotation.random(random_state=int(rng.integers(1 << 30))).as_matrix()
    a, b, c = rng.uniform(0.01, 0.1, 3)
    return Joint(
        type,
        placement,
        rng.uniform(-1, 1, 3),
        name=name,
        mass=rng.uniform(0.1, 5),
        center=rng.uniform(-0.3, 0.3, 3),
        inertia=R @ np.diag([a + b, b + c, c + a]) @ R.T,
        rotor_inertia=rng.uniform(0, 0.1),
        damping=rng.uniform(0, 0.5),
    )


def random_robot(seed: int) -> fp.Robot:
    """A tree of revolute and prismatic joints, of which two follow others, with gravity in any direction."""
    rng = np.random.default_rng(seed)
    types = rng.choice(["revolute", "prismatic", "continuous"], 8, p=[0.6, 0.3, 0.1])
    joints = [random_joint(rng, f"j{i}", str(type)) for i, type in enumerate(types)]
    joints[4] = replace(joints[4], type="revolute", mimic=(1, -0.7, 0.2))
    joints[6] = replace(joints[6], mimic=(3, 1.3, 0.0))
    parents: list[int] = []
    carriers = [0]  # Links from the base to the last link: depth first, as Pinocchio needs.
    for i in range(8):
        carriers = carriers[: int(rng.integers(1, len(carriers) + 1))]
        parents.append(carriers[-1])
        carriers.append(i + 1)
    return fp.Robot(list(map(fp.TreeJoint, joints, parents)), gravity_vector=rng.uniform(-10, 10, 3))


PAPER = fp.PlanarArm([1, 1, 1, 1], [1, 1, 1, 1])  # The paper's robot.
MACHINES: dict[str, Callable[[], Any]] = {
    "paper": lambda: PAPER.with_gravity((0, -9.81, 0)),
    "panda": lambda: fp.SerialArm.preset("panda"),
    "so101": lambda: fp.SerialArm.preset("so101"),
    "ur10e": lambda: fp.SerialArm.preset("ur10e").with_gravity((1, -3, 8)),
    "g1": lambda: fp.Robot.preset("g1_upper_body"),
    "two": lambda: fp.Robot.preset("two_pandas"),
    **{f"tree {seed}": (lambda seed=seed: random_robot(seed)) for seed in range(3)},
}


@pytest.fixture(params=MACHINES)
def machine(request: pytest.FixtureRequest) -> Any:
    return MACHINES[request.param]()


# Pinocchio


@needs_robots
@pytest.mark.parametrize("name", ROBOTS)
def test_equals_pinocchio(name: str) -> None:
    assert DATA is not None
    file, rotors, tips = ROBOTS[name]
    srdf = None if rotors is None else str(DATA / rotors)
    robot = fp.Robot.from_urdf(DATA / file, base="fixed", srdf=srdf, tips=tips)
    if srdf:
        assert any(joint.rotor_inertia > 0 for joint in joints_of(robot))
    expect_equal(robot, Reference(pin.buildModelFromUrdf(str(DATA / file)), robot, srdf), np.random.default_rng(1))


@needs_robots
@pytest.mark.parametrize(
    ("file", "tip"),
    [("panda_description/urdf/panda.urdf", "panda_link8"), ("tiago_description/robots/tiago.urdf", "arm_5_link")],
)
def test_an_arm_carries_all_that_is_attached(file: str, tip: str) -> None:
    """Links beyond the tip, such as a hand, count, with their joints at zero."""
    assert DATA is not None
    arm = fp.SerialArm.from_urdf(DATA / file, tip)
    expect_equal(arm, Reference(pin.buildModelFromUrdf(str(DATA / file)), arm), np.random.default_rng(2))


@needs_pinocchio
@pytest.mark.parametrize("name", ["panda", "fr3", "iiwa14", "gen3", "ur5e", "ur10e", "xarm7", "so101", "openarm", "z1"])
def test_presets_equal_pinocchio(name: str) -> None:
    arm = fp.SerialArm.preset(name)
    expect_equal(arm, Reference(model_of(arm), arm), np.random.default_rng(3))


@needs_pinocchio
def test_random_trees_equal_pinocchio() -> None:
    """Trees with prismatic joints, joints that follow others, rotors and gravity in any direction."""
    for seed in range(TREES):
        robot = random_robot(seed)
        expect_equal(robot, Reference(model_of(robot), robot), np.random.default_rng(seed), states=1)


# Laws


def test_power_is_the_rate_of_the_energies(machine: Any) -> None:
    """d/dt (T + U) = qd^T (tau - damping qd), and M is the derivative of the torques."""
    rng = np.random.default_rng(4)
    A, _ = coupling(machine)
    damping = A.T @ np.diag([joint.damping for joint in joints_of(machine)]) @ A
    h = 1e-5
    for _ in range(5):
        q, qd, qdd = rng.uniform(-1, 1, (3, machine.dof))
        at = [(q + t * qd + t * t / 2 * qdd, qd + t * qdd) for t in (-h, h)]
        before, after = (machine.kinetic_energy(*each) + machine.potential_energy(each[0]) for each in at)
        torque = machine.inverse_dynamics(q, qd, qdd)
        scale = np.abs(qd) @ np.abs(torque)
        assert (after - before) / (2 * h) == pytest.approx(qd @ (torque - damping @ qd), abs=1e-7 * scale)
        M = machine.mass_matrix(q)
        np.testing.assert_allclose(M, M.T, rtol=0, atol=1e-12 * M.max())
        assert np.linalg.eigvalsh(M).min() > 0
        np.testing.assert_allclose(torque, M @ qdd + machine.bias(q, qd), rtol=0, atol=1e-12 * scale)


def test_gravity_is_the_gradient_of_the_potential_energy(machine: Any) -> None:
    q = np.random.default_rng(5).uniform(-1, 1, machine.dof)
    h = 1e-5
    gradient = [
        (machine.potential_energy(q + step) - machine.potential_energy(q - step)) / (2 * h)
        for step in h * np.eye(machine.dof)
    ]
    g = machine.gravity(q)
    np.testing.assert_allclose(g, gradient, rtol=0, atol=1e-8 * max(1.0, np.abs(g).max()))
    np.testing.assert_allclose(g, machine.inverse_dynamics(q, 0 * q, 0 * q), rtol=0, atol=1e-12 * np.abs(g).max())


def test_rows_are_single_states(machine: Any) -> None:
    q, qd, qdd = np.random.default_rng(6).uniform(-1, 1, (3, 4, machine.dof))
    n = machine.dof
    for name, arguments, shape in (
        ("inverse_dynamics", (q, qd, qdd), (4, n)),
        ("bias", (q, qd), (4, n)),
        ("gravity", (q,), (4, n)),
        ("mass_matrix", (q,), (4, n, n)),
        ("kinetic_energy", (q, qd), (4,)),
        ("potential_energy", (q,), (4,)),
    ):
        method = getattr(machine, name)
        found = method(*arguments)
        assert found.shape == shape
        np.testing.assert_array_equal(found, [method(*rows) for rows in zip(*arguments)])
        assert method(*(each[:0] for each in arguments)).shape == (0, *shape[1:])


def test_a_planar_arm_is_the_textbook_arm() -> None:
    """Two uniform rods in a vertical plane (Spong, Hutchinson, Vidyasagar, Robot Modeling and Control, 7.3)."""
    (l1, l2), (m1, m2), g = (0.7, 0.4), (1.3, 0.8), 9.81
    arm = fp.PlanarArm([l1, l2], [m1, m2]).with_gravity((0, -g, 0))
    q, qd = np.array([0.3, -0.9]), np.array([0.7, 1.1])
    c1, c2, i1, i2 = l1 / 2, l2 / 2, m1 * l1**2 / 12, m2 * l2**2 / 12
    d12 = m2 * (c2**2 + l1 * c2 * np.cos(q[1])) + i2
    d11 = m1 * c1**2 + m2 * (l1**2 + c2**2 + 2 * l1 * c2 * np.cos(q[1])) + i1 + i2
    np.testing.assert_allclose(arm.mass_matrix(q), [[d11, d12], [d12, m2 * c2**2 + i2]], rtol=1e-12)
    x = -m2 * l1 * c2 * np.sin(q[1])
    bend = m2 * c2 * g * np.cos(q.sum())
    weight = np.array([(m1 * c1 + m2 * l1) * g * np.cos(q[0]) + bend, bend])
    np.testing.assert_allclose(arm.gravity(q), weight, rtol=1e-12)
    coriolis = [x * (2 * qd[0] * qd[1] + qd[1] ** 2), -x * qd[0] ** 2]
    np.testing.assert_allclose(arm.bias(q, qd), coriolis + weight, rtol=1e-12)
    np.testing.assert_array_equal(fp.PlanarArm([l1, l2], [m1, m2]).gravity(q), np.zeros(2))


def test_a_turned_base_is_another_gravity() -> None:
    R = Rotation.from_rotvec([0.3, -1.0, 0.4]).as_matrix()
    arm = fp.SerialArm.preset("panda")
    turned = np.eye(4)
    turned[:3, :3] = R
    on_a_wall = replace(
        arm, joints=[replace(arm.joints[0], placement=turned @ arm.joints[0].placement), *arm.joints[1:]]
    )
    q, qd, qdd = np.random.default_rng(7).uniform(-1, 1, (3, 7))
    expected = on_a_wall.inverse_dynamics(q, qd, qdd)
    found = arm.with_gravity(R.T @ [0, 0, -9.81])
    np.testing.assert_allclose(found.inverse_dynamics(q, qd, qdd), expected, rtol=1e-12)
    assert found.gravity_vector.tolist() == (R.T @ [0, 0, -9.81]).tolist()
    assert np.abs(arm.inverse_dynamics(q, qd, qdd) - expected).max() > 1


def test_friction_and_rotors() -> None:
    joint = Joint(mass=1.0, center=(0.5, 0, 0), rotor_inertia=0.2, damping=0.3, friction=0.4)
    arm = fp.SerialArm([joint])
    assert arm.mass_matrix([0.1]) == pytest.approx(0.45)
    assert arm.bias([0.1], [2.0]) == pytest.approx(0.6)  # Without dry friction.


# Payloads

LOAD = {"com": [0.02, -0.01, 0.07], "inertia": np.diag([0.02, 0.03, 0.04])}


def loaded_by_hand(robot: Any, frame: str, q: Array, qd: Array, mass: float, com: Sequence[float]) -> float:
    """Kinetic energy of a robot with a point mass, by differences of the position of the mass."""
    h = 1e-6

    def point(q: Array) -> Array:
        link, place = robot.locate(frame)
        return np.asarray(link_frames(robot, q)[link] @ place @ [*com, 1.0])[:3]

    v = (point(q + h * qd) - point(q - h * qd)) / (2 * h)
    return float(robot.kinetic_energy(q, qd) + mass * v @ v / 2)


@pytest.mark.parametrize(
    ("name", "frame"),
    [("paper", "tip"), ("paper", "joint_2"), ("panda", "tip"), ("g1", "left_wrist_yaw_link"), ("two", "right_tip")],
)
def test_a_payload_moves_with_its_frame(name: str, frame: str) -> None:
    robot = MACHINES[name]()
    rng = np.random.default_rng(8)
    q, qd = rng.uniform(-1, 1, (2, robot.dof))
    heavy = robot.with_payload(3.0, com=LOAD["com"], frame=frame)
    expected = loaded_by_hand(robot, frame, q, qd, 3.0, LOAD["com"])
    assert heavy.kinetic_energy(q, qd) == pytest.approx(expected, rel=1e-8)
    assert type(heavy) is type(robot)
    assert heavy == eval(repr(heavy), {"PlanarArm": fp.PlanarArm, **vars(fp)}) == pickle.loads(pickle.dumps(heavy))
    again = heavy.with_payload(1.0, com=LOAD["com"], frame=frame)
    once = robot.with_payload(4.0, com=LOAD["com"], frame=frame)
    np.testing.assert_allclose(again.mass_matrix(q), once.mass_matrix(q), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(again.gravity(q), once.gravity(q), rtol=1e-12, atol=1e-11)
    turning = robot.with_payload(3.0, com=LOAD["com"], inertia=LOAD["inertia"], frame=frame)
    assert turning.kinetic_energy(q, qd) > heavy.kinetic_energy(q, qd)


@needs_pinocchio
def test_a_payload_equals_a_body_of_the_model() -> None:
    """With a frame that is turned against the link."""
    tip = np.eye(4)
    tip[:3, :3], tip[:3, 3] = Rotation.from_euler("xyz", [0.3, 0.5, -0.8]).as_matrix(), [0.1, 0.05, 0.2]
    arm = replace(fp.SerialArm.preset("panda"), tip=tip)
    inertia = np.array([[0.02, 0.001, 0], [0.001, 0.03, 0], [0, 0, 0.04]])
    com = np.array([0.02, -0.01, 0.07])
    model = model_of(arm)
    model.appendBodyToJoint(7, pin.Inertia(3.0, com, inertia), pin.SE3(tip))
    heavy = arm.with_payload(3.0, com=com, inertia=inertia)
    expect_equal(heavy, Reference(model, heavy), np.random.default_rng(9))


# Files


def inertial(moments: str = "", mass: float = 2.0, origin: str = "") -> str:
    return f'<inertial>{origin}<mass value="{mass}"/><inertia {moments}/></inertial>'


RANGE = '<limit lower="-1" upper="1"/>'


def file_of(write: Callable[[str], Path], *, moving: str = inertial(), joint: str = "", more: str = "") -> Path:
    return write(
        f'<robot name="r"><link name="base"/><link name="arm">{moving}</link>{more}'
        '<joint name="j" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>'
        f"{joint or RANGE}</joint></robot>"
    )


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str], Path]:
    def write(text: str) -> Path:
        (tmp_path / "r.urdf").write_text(text)
        return tmp_path / "r.urdf"

    return write


READERS: dict[str, Callable[..., Any]] = {
    "arm": lambda file, **given: fp.SerialArm.from_urdf(file, "arm", **given),
    "robot": fp.Robot.from_urdf,
}


@pytest.fixture(params=READERS)
def read(request: pytest.FixtureRequest) -> Callable[..., Any]:
    return READERS[request.param]


def test_effort_and_friction_of_a_file(write: Any, read: Any) -> None:
    given = '<limit lower="-1" upper="1" effort="20"/><dynamics damping="0.3" friction="0.4"/>'
    robot = read(file_of(write, joint=given))
    (joint,) = joints_of(robot)
    assert (joint.effort, joint.damping, joint.friction) == (20.0, 0.3, 0.4)
    assert robot.limits.effort.tolist() == [20.0]
    assert read(file_of(write, joint=given), limits=fp.JointLimits(effort=5)).limits.effort.tolist() == [5.0]
    for text in ("", 'effort="0"'):  # Not given.
        robot = read(file_of(write, joint=f'<limit lower="-1" upper="1" {text}/>'))
        assert robot.limits.effort.tolist() == [np.inf]


def test_the_effort_of_a_follower_bounds_its_leader() -> None:
    """The follower has at most the effort of the drive, divided by the ratio."""
    leader = Joint(effort=20.0)
    for ratio, effort, expected in ((0.5, 20.0, 10.0), (-2.0, 20.0, 20.0), (-0.1, 5.0, 0.5)):
        arm = fp.SerialArm([leader, Joint(mimic=(0, ratio, 0.0), effort=effort)])
        assert arm.limits.effort == pytest.approx([expected])


def test_the_effort_of_a_follower_of_a_file(write: Any, read: Any) -> None:
    limit = '<limit lower="-1" upper="1" effort="20"/>'
    between = (
        '<link name="root"/><joint name="lead" type="revolute"><parent link="root"/><child link="base"/>'
        f'<axis xyz="0 1 0"/>{limit}</joint>'
    )
    robot = read(file_of(write, joint=f'{limit}<mimic joint="lead" multiplier="-0.5"/>', more=between))
    assert [joint.effort for joint in joints_of(robot)] == [10.0, 20.0]
    assert robot.limits.effort.tolist() == [10.0]


def test_inertials_are_turned_and_joined(write: Any, read: Any) -> None:
    turned = '<origin xyz="0.1 0 0.2" rpy="0 0 1.5707963267948966"/>'
    beyond = (
        '<link name="tool"><inertial><origin xyz="0 0 0.5"/><mass value="1"/></inertial></link>'
        '<joint name="f" type="fixed"><parent link="arm"/><child link="tool"/><origin xyz="0.1 0 0"/></joint>'
    )
    moving = inertial('ixx="0.2" iyy="0.3" izz="0.4" ixy="0.05"', origin=turned)
    (joint,) = joints_of(read(file_of(write, moving=moving, more=beyond)))
    assert joint.mass == 3.0
    np.testing.assert_allclose(joint.center, [0.1, 0, 0.3], atol=1e-15)
    own = np.array([[0.3, -0.05, 0], [-0.05, 0.2, 0], [0, 0, 0.4]])
    np.testing.assert_allclose(joint.inertia, own + np.diag([2 / 3 * 0.3**2] * 2 + [0]), atol=1e-15)


def test_rotors_of_an_srdf_file(write: Any, read: Any, tmp_path: Path) -> None:
    rotors = tmp_path / "r.srdf"
    rotors.write_text(
        '<robot name="r"><rotor_params><joint name="j" mass="1e-5" gear_ratio="100"/><joint name="k" mass="1"/>'
        "</rotor_params></robot>"
    )
    (joint,) = joints_of(read(file_of(write), srdf=rotors))
    assert joint.rotor_inertia == pytest.approx(0.1)
    rotors.write_text('<robot name="r"><rotor_params><joint name="j" mass="-1"/></rotor_params></robot>')
    with pytest.raises(ValueError, match=r"r\.srdf: line 1: rotor of joint 'j': mass = -1: must not be negative"):
        read(file_of(write), srdf=rotors)


# Bad input


def physical(arm: Any) -> Any:
    return arm.inverse_dynamics([0.1], [0.0], [0.0])


@pytest.mark.parametrize(
    ("moments", "message"),
    [
        ('ixx="-0.1" iyy="0.2" izz="0.2"', r"joint 'j'.*inertia has the principal moment -0\.1.*must"),
        (
            'ixx="0.1" iyy="0.2" izz="0.4"',
            r"joint 'j'.*inertia has the principal moments 0\.1, 0\.2 and 0\.4.*triangle inequality",
        ),
        ('ixx="0.1" iyy="0.1" izz="0.1" ixy="0.2"', r"joint 'j'.*inertia has the principal moment -0\.1.*must"),
    ],
)
def test_an_inertia_that_no_body_has(write: Any, read: Any, moments: str, message: str) -> None:
    """Refused by the dynamics only."""
    robot = read(file_of(write, moving=inertial(moments)))
    assert np.all(np.isfinite(robot.jacobian([0.1], *(() if isinstance(robot, fp.SerialArm) else ("arm",)))))
    for _ in range(2):
        with pytest.raises(fp.ParameterError, match=message):
            physical(robot)


def test_an_inertia_may_be_rounded(write: Any, read: Any) -> None:
    """To 4 digits, or to nothing: the numbers of a neck of iCub, and of a plate."""
    for moments in ('ixx="7.9e-67" ixz="2.40741e-35"', 'ixx="0.1234" iyy="0.5678" izz="0.69125"'):
        assert np.isfinite(physical(read(file_of(write, moving=inertial(moments)))))


def test_an_inertia_that_is_not_symmetric() -> None:
    with pytest.raises(fp.ParameterError, match=r"joint 'a'.*inertia.* must be symmetric"):
        physical(fp.SerialArm([Joint(name="a", mass=1, inertia=[[1, 0.5, 0], [0, 1, 0], [0, 0, 1]])]))


def test_a_drive_that_moves_no_mass(write: Any, read: Any) -> None:
    with pytest.raises(fp.ParameterError, match=r"joint 'j' moves no mass.*: give "):
        physical(read(file_of(write, moving="")))
    for arm in (fp.PlanarArm([1, 1]), fp.SerialArm([Joint(mass=1), Joint()])):
        with pytest.raises(fp.ParameterError, match=r"joint 'joint_[12]' moves no mass"):
            arm.gravity([0, 0])
    fp.SerialArm([Joint(), Joint(mass=1)]).gravity([0, 0])  # The second link is a mass for both drives.
    fp.SerialArm([Joint(rotor_inertia=1)]).gravity([0])
    follower = Joint(mass=1, mimic=(0, 1.0, 0.0))
    fp.Robot([fp.TreeJoint(Joint()), fp.TreeJoint(follower)]).gravity([0])


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ('<limit lower="-1" upper="1" effort="-2"/>', r"joint 'j': effort = -2: must be positive"),
        ('<limit lower="-1" upper="1"/><dynamics damping="-2"/>', r"joint 'j': damping = -2: must not be negative"),
        (
            '<limit lower="-1" upper="1"/><dynamics friction="x"/>',
            r"joint 'j': dynamics friction = 'x': must be 1 finite",
        ),
    ],
)
def test_numbers_of_a_joint_that_are_wrong(write: Any, read: Any, joint: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        read(file_of(write, joint=joint))


@pytest.mark.parametrize(
    ("moving", "message"),
    [
        (inertial(mass=-1), r"link 'arm': mass = -1: must not be negative"),
        (inertial('ixx="one"'), r"link 'arm': inertia ixx = 'one': must be 1 finite number"),
        (inertial(origin='<origin rpy="0 0"/>'), r"link 'arm': origin rpy = '0 0': must be 3 finite numbers"),
    ],
)
def test_numbers_of_a_link_that_are_wrong(write: Any, read: Any, moving: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        read(file_of(write, moving=moving))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"mass": -1.0}, "mass = -1: must be positive or zero|mass = -1: must be finite and not negative"),
        ({"effort": 0.0}, r"joint_1'\.effort = 0: must be positive"),
        ({"inertia": np.full((3, 3), np.nan)}, r"inertia\[0, 0\] = nan: must be finite"),
        ({"inertia": [1, 2, 3]}, r"inertia = \[1, 2, 3\]: must be real numbers of shape \(3, 3\)"),
        ({"center": [0, 0, np.inf]}, r"center\[2\] = inf: must be finite"),
        ({"rotor_inertia": -1}, "rotor_inertia = -1: must be finite and not negative"),
        ({"damping": -1}, "damping = -1: must be finite and not negative"),
        ({"friction": np.inf}, "friction = inf: must be finite and not negative"),
    ],
)
def test_fields_of_a_joint_that_are_wrong(given: dict[str, Any], message: str) -> None:
    with pytest.raises(fp.ParameterError, match=message):
        fp.SerialArm([Joint(**given)])


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"mass": -1.0, "com": [0, 0, 0]}, "mass = -1: must be finite and not negative"),
        ({"mass": np.nan, "com": [0, 0, 0]}, "mass = nan: must be finite and not negative"),
        ({"mass": 1.0, "com": [0, 0]}, r"com = \[0, 0\]: must be real numbers of shape \(3,\)"),
        ({"mass": 1.0, "com": [0, 0, 0], "inertia": 0.1}, r"inertia = 0\.1: must be real numbers of shape \(3, 3\)"),
        ({"mass": 1.0, "com": [0, 0, 0], "frame": "hand"}, "frame = 'hand': must be a frame"),
        ({"mass": 1.0, "com": [0, 0, 0], "frame": "base"}, "frame = 'base': is fixed to the base"),
    ],
)
def test_payloads_that_are_wrong(given: dict[str, Any], message: str) -> None:
    for machine in (PAPER, fp.SerialArm.preset("panda"), fp.Robot.from_arms({"a": fp.SerialArm.preset("z1")})):
        frame = {} if isinstance(machine, Arm) else {"frame": "a_tip"}
        with pytest.raises(fp.ParameterError, match=message):
            machine.with_payload(**{**frame, **given})
    with pytest.raises(fp.ParameterError, match="frame = 'tip': must be a frame"):
        machine.with_payload(1.0, com=[0, 0, 0])


def test_arguments_that_are_wrong() -> None:
    arm = fp.SerialArm.preset("panda")
    zero, rows = np.zeros(7), np.zeros((3, 7))
    for call, message in (
        (lambda: arm.gravity(np.zeros(6)), r"q has 6 entries: must have 7"),
        (lambda: arm.gravity([np.nan] * 7), r"q\[0\] = nan: must be finite"),
        (lambda: arm.gravity(np.full((2, 7), np.inf)), r"q\[0, 0\] = inf: must be finite"),
        (lambda: arm.mass_matrix(np.zeros((2, 6))), r"q: must have shape \(2, 7\), got \(2, 6\)"),
        (lambda: arm.bias(zero, rows), r"qd: must have 1 dimension, got shape \(3, 7\)"),
        (lambda: arm.bias(rows, rows[:2]), r"qd: must have shape \(3, 7\), got \(2, 7\)"),
        (lambda: arm.inverse_dynamics(zero, zero, zero[:3]), r"qdd has 3 entries: must have 7"),
        (lambda: arm.inverse_dynamics(rows, rows, zero), r"qdd: must have 2 dimensions"),
        (lambda: arm.with_gravity((0, 0)), r"vector = \(0, 0\): must be real numbers of shape \(3,\)"),
        (lambda: arm.with_gravity((0, 0, np.inf)), r"vector\[2\] = inf: must be finite"),
        (lambda: fp.PlanarArm([1, 1], [1, 1, 1]), r"masses has 3 entries: must have 2"),
        (lambda: fp.PlanarArm([1, 1], [1, -1]), r"masses\[1\] = -1: must be finite and not negative"),
        (lambda: fp.PlanarArm([1, 1], centers=[[0, 0, 0]]), r"centers has 1 entries: must have 2"),
    ):
        with pytest.raises(fp.ParameterError, match=message):
            call()


# Presets


@pytest.mark.parametrize("name", ["panda", "fr3", "iiwa14", "gen3", "ur5e", "ur10e", "xarm7", "so101", "openarm", "z1"])
def test_presets_can_hold_themselves(name: str) -> None:
    """The efforts of a preset hold its own weight in all postures."""
    arm = fp.SerialArm.preset(name)
    assert np.all(np.isfinite(arm.limits.effort))
    q = np.random.default_rng(10).uniform(
        np.maximum(arm.limits.lower, -3.2), np.minimum(arm.limits.upper, 3.2), (500, arm.dof)
    )
    assert np.all(np.abs(arm.gravity(q)) < 0.7 * arm.limits.effort)


def test_links_of_the_ur10e_are_in_the_frames_of_its_table() -> None:
    """Stretched along -x, with the centres of Universal Robots' table: the torque of the shoulder by hand."""
    arm = fp.SerialArm.preset("ur10e")
    wrist = -0.6127 - 0.57155
    moment = 13.051 * (-0.6127 + 0.38) + 3.989 * (wrist + 0.24) + (2.1 + 1.98 + 0.615) * wrist
    assert abs(arm.gravity(np.zeros(6))[1]) == pytest.approx(9.81 * abs(moment), rel=1e-12)
