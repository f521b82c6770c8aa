"""Chains read from URDF files, and error messages for files without a chain."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import inf, pi
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import fpbm_cpp as fp
from fpbm_cpp.arms import Joint
from fpbm_cpp.errors import ParameterError
from fpbm_cpp.urdf.chain import read_urdf
from fpbm_cpp.urdf.xml_file import MAX_ELEMENTS

LIMIT = '<limit lower="-1" upper="2" velocity="3" effort="4"/>'
Z = '<axis xyz="0 0 1"/>'


def link(*names: str) -> str:
    return "".join(f'<link name="{name}"/>' for name in names)


def joint(name: str, parent: str, child: str, parts: str = Z + LIMIT, type: str = "revolute") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{type}">{ends}{parts}</joint>'


def robot(*parts: str) -> str:
    return f'<?xml version="1.0"?>\n<robot name="r">{"".join(parts)}</robot>'


def two_links(*joints: str) -> str:
    return robot(link("base", "tip"), *joints)


def three_links(first: str, second: str) -> str:
    """base, a, mid, b, tip, where the parts of joint a and of joint b are given."""
    return robot(link("base", "mid", "tip"), joint("a", "base", "mid", first), joint("b", "mid", "tip", second))


def mimic(of: str, numbers: str = "", limit: str = LIMIT) -> str:
    return f'{Z}{limit}<mimic joint="{of}" {numbers}/>'


def transform(xyz: Sequence[float] = (0, 0, 0), rpy: Sequence[float] = (0, 0, 0)) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = xyz
    T[:3, :3] = Rotation.from_euler("xyz", rpy).as_matrix()
    return T


def moved(type: str, axis: Sequence[float], q: float) -> np.ndarray:
    """The displacement of a joint at position q."""
    T = np.eye(4)
    direction = np.asarray(axis) / np.linalg.norm(axis)
    if type == "prismatic":
        T[:3, 3] = q * direction
    elif type != "fixed":
        T[:3, :3] = Rotation.from_rotvec(q * direction).as_matrix()
    return T


def forward(joints: Sequence[Joint], tip: np.ndarray, q: Sequence[float]) -> np.ndarray:
    """Tip of a chain at q, one number per joint that is not a mimic joint."""
    drives = iter(q)
    own = [next(drives) if joint.mimic is None else np.nan for joint in joints]
    T = np.eye(4)
    for joint, position in zip(joints, own):
        if joint.mimic is not None:
            leader, ratio, offset = joint.mimic
            position = ratio * own[leader] + offset
        T = T @ joint.placement @ moved(joint.type, joint.axis, position)
    return T @ tip


@pytest.fixture(autouse=True)
def silence(capfd: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture) -> Iterator[None]:
    """Nothing reaches the terminal or a log."""
    yield
    assert capfd.readouterr() == ("", "")
    assert not caplog.records


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str | bytes], Path]:
    def write(text: str | bytes) -> Path:
        file = tmp_path / "arm.urdf"
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return file

    return write


def error_message(file: Path, tip: str = "tip", base: str | None = None) -> str:
    """The error message for a file: one line with the name of the file, within 4 s."""
    start = time.process_time()
    with pytest.raises(ValueError, match=r".") as caught:
        read_urdf(file, tip, base)
    assert time.process_time() - start < 4.0
    assert caught.type is ValueError
    assert caught.value.__suppress_context__
    name, _, message = str(caught.value).partition(": ")
    assert name == str(file)
    assert "\n" not in message
    assert len(message) < 1500
    return message


def attempt(file: Path, tip: str) -> tuple[tuple[list[Joint], np.ndarray] | None, str]:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Warnings about joints that are held.
            return read_urdf(file, tip), ""
    except ValueError as error:
        return None, str(error)


# Read


def test_names_types_and_bounds(write) -> None:
    joints, _ = read_urdf(
        write(
            robot(
                link("base", "x", "y", "tip"),
                joint("turn", "base", "x"),
                joint("slide", "x", "y", Z + '<limit upper="0.5" velocity="0.1"/>', "prismatic"),
                joint("spin", "y", "tip", Z + '<limit lower="-1" upper="-5" velocity="7"/>', "continuous"),
            )
        ),
        "tip",
    )
    assert [j.name for j in joints] == ["turn", "slide", "spin"]
    assert [j.type for j in joints] == ["revolute", "prismatic", "continuous"]
    bounds = [(j.lower, j.upper, j.velocity, j.acceleration) for j in joints]
    assert bounds == [(-1, 2, 3, inf), (0, 0.5, 0.1, inf), (-inf, inf, 7, inf)]
    assert all(j.mimic is None for j in joints)


def test_jerk_and_the_velocity_bound_of_a_franka_are_read(write) -> None:
    limit = '<limit lower="-2" upper="2" velocity="3" acceleration="10" jerk="5000"/>'
    envelope = '<position_based_velocity_limits velocity_offset="0.3" deceleration_limit="6.0"/>'
    (a, b), _ = read_urdf(write(three_links(Z + limit + envelope, Z + LIMIT)), "tip")
    assert (a.jerk, a.velocity_offset, a.deceleration) == (5000, 0.3, 6)
    assert (b.jerk, b.velocity_offset, b.deceleration) == (inf, 0, inf)
    (a, b), _ = read_urdf(write(three_links(Z + limit, mimic("a", 'multiplier="-2"', limit))), "tip")
    assert (a.jerk, b.jerk) == (2500, 5000)
    for broken in ('velocity_offset="0.3"', 'velocity_offset="-1" deceleration_limit="6"'):
        urdf = write(three_links(Z + limit + f"<position_based_velocity_limits {broken}/>", Z + LIMIT))
        with pytest.raises(ValueError, match="joint 'a': <position_based_velocity_limits>: must have velocity_offset"):
            read_urdf(urdf, "tip")


def test_acceleration_is_read(write) -> None:
    """The acceleration of a leader is reduced like its velocity."""
    limit = '<limit lower="-1" upper="2" velocity="3" acceleration="{}"/>'
    (a, b), _ = read_urdf(write(three_links(Z + limit.format(8), Z + limit.format("1e2"))), "tip")
    assert (a.acceleration, b.acceleration) == (8, 100)
    (a, b), _ = read_urdf(
        write(three_links(Z + limit.format(8), mimic("a", 'multiplier="-2"', limit.format(6)))), "tip"
    )
    assert (a.acceleration, b.acceleration) == (3, 6)
    continuous = two_links(joint("a", "base", "tip", Z + '<limit acceleration="5"/>', "continuous"))
    assert read_urdf(write(continuous), "tip")[0][0].acceleration == 5


def test_continuous_joint_needs_no_limit(write) -> None:
    for limit in ("", "<limit/>"):
        ((joint_,), _) = read_urdf(write(two_links(joint("a", "base", "tip", Z + limit, "continuous"))), "tip")
        assert (joint_.lower, joint_.upper, joint_.velocity) == (-inf, inf, inf)


def test_axis_is_kept_and_is_x_where_omitted(write) -> None:
    for axis, expected in (("", [1, 0, 0]), ("<axis/>", [1, 0, 0]), ('<axis xyz="0 -2 1e-3"/>', [0, -2, 1e-3])):
        ((joint_,), _) = read_urdf(write(two_links(joint("a", "base", "tip", axis + LIMIT))), "tip")
        np.testing.assert_array_equal(joint_.axis, expected)


def test_fixed_joints_are_folded(write) -> None:
    file = write(
        robot(
            link("world", "base", "mid", "flange", "tip"),
            joint("mount", "world", "base", '<origin xyz="1 2 3" rpy="0.1 0.2 0.3"/>', "fixed"),
            joint("a", "base", "mid", '<origin rpy="0.4 -0.5 0.6"/>' + Z + LIMIT),
            joint("plate", "mid", "flange", '<origin xyz="0 0 0.25"/>', "fixed"),
            joint("tool", "flange", "tip", '<origin xyz="0.1 0 0" rpy="0 0 1"/>', "fixed"),
        )
    )
    ((a,), tip) = read_urdf(file, "tip")
    np.testing.assert_allclose(
        a.placement, transform([1, 2, 3], [0.1, 0.2, 0.3]) @ transform(rpy=[0.4, -0.5, 0.6]), atol=1e-15
    )
    np.testing.assert_allclose(tip, transform([0, 0, 0.25]) @ transform([0.1, 0, 0], [0, 0, 1]), atol=1e-15)
    ((a,), tip) = read_urdf(file, "flange", "base")
    np.testing.assert_allclose(a.placement, transform(rpy=[0.4, -0.5, 0.6]), atol=1e-15)
    np.testing.assert_allclose(tip, transform([0, 0, 0.25]), atol=1e-15)


TREE = robot(
    link("root", "torso", "left", "hand", "right"),
    joint("hip", "root", "torso"),
    joint("shoulder_l", "torso", "left"),
    joint("wrist_l", "left", "hand"),
    joint("shoulder_r", "torso", "right", type="prismatic"),
)


def test_base_is_the_root_or_any_link_above(write) -> None:
    file = write(TREE)
    for base, names in (
        (None, ["hip", "shoulder_l", "wrist_l"]),
        ("root", ["hip", "shoulder_l", "wrist_l"]),
        ("torso", ["shoulder_l", "wrist_l"]),
        ("left", ["wrist_l"]),
    ):
        assert [j.name for j in read_urdf(file, "hand", base)[0]] == names
    assert [j.type for j in read_urdf(str(file), "right")[0]] == ["revolute", "prismatic"]


def test_order_in_the_file_does_not_matter(write) -> None:
    text = robot(joint("b", "mid", "tip"), link("tip", "mid"), joint("a", "base", "mid"), link("base"))
    assert [j.name for j in read_urdf(write(text), "tip")[0]] == ["a", "b"]


def test_elements_outside_the_chain_have_no_effect(write) -> None:
    clutter = (
        '<link name="eye"><visual><origin xyz="here"/><geometry><mesh filename="no/where.stl" scale="?"/></geometry>'
        '<material name="m"><color rgba="red"/></material></visual><inertial><mass value="heavy"/></inertial></link>'
        '<transmission name="t"><joint name="a"/><joint name="a"/></transmission>'
        '<gazebo reference="eye"><joint name="loose"/></gazebo><!-- <!DOCTYPE no> ${no} -->'
        + joint("float", "base", "eye", type="floating")
        + link("f1", "f2", "f3")
        + joint("finger_1", "tip", "f1", '<axis xyz="0 0 0"/>')
        + joint("finger_2", "tip", "f2", '<mimic joint="nowhere" multiplier="0"/><limit lower="1" upper="0"/>')
        + joint("finger_3", "tip", "f3", '<mimic joint="finger_3"/>', "magic")
    )
    ((a,), tip) = read_urdf(write(two_links(joint("a", "base", "tip"), clutter)), "tip")
    assert a.name == "a"
    np.testing.assert_array_equal(tip, np.eye(4))


def test_names_in_any_script(write) -> None:
    text = robot(link("Grundplatte", "Hände"), joint("Ärmel &quot;1&quot;", "Grundplatte", "Hände"))
    assert read_urdf(write(text), "Hände")[0][0].name == 'Ärmel "1"'
    latin = text.replace("?>", ' encoding="ISO-8859-1"?>', 1).encode("latin-1")
    assert read_urdf(write(latin), "Hände")[0][0].name == 'Ärmel "1"'
    assert read_urdf(write(text.encode("utf-16")), "Hände")[0][0].name == 'Ärmel "1"'


def test_xacro_namespaces_are_accepted(write) -> None:
    text = TREE.replace("<robot", '<robot xmlns:xacro="http://ros.org/wiki/xacro" xmlns="urn:x"')
    assert len(read_urdf(write(text), "hand")[0]) == 3


@dataclass
class Piece:
    """One joint of a random chain, and how it is written."""

    type: str
    xyz: list[float]
    rpy: list[float]
    axis: list[float]
    q: float

    def xml(self, i: int) -> str:
        def row(numbers: Sequence[float]) -> str:
            return " ".join(map(repr, numbers))

        parts = f'<origin xyz="{row(self.xyz)}" rpy="{row(self.rpy)}"/><axis xyz="{row(self.axis)}"/>{LIMIT}'
        return joint(f"j{i}", f"l{i}", f"l{i + 1}", parts, self.type)


NUMBER = st.floats(-3, 3)
VECTOR = st.lists(NUMBER, min_size=3, max_size=3)
AXIS = VECTOR.filter(lambda axis: float(np.linalg.norm(axis)) > 0.01)
PIECES = st.lists(
    st.builds(Piece, st.sampled_from(["revolute", "continuous", "prismatic", "fixed"]), VECTOR, VECTOR, AXIS, NUMBER),
    min_size=1,
    max_size=12,
).filter(lambda pieces: any(piece.type != "fixed" for piece in pieces))


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(pieces=PIECES)
def test_forward_kinematics_of_random_chains(pieces: list[Piece], write) -> None:
    text = robot(*(link(f"l{i}") for i in range(len(pieces) + 1)), *(p.xml(i) for i, p in enumerate(pieces)))
    joints, tip = read_urdf(write(text), f"l{len(pieces)}")
    expected = np.eye(4)
    for piece in pieces:
        expected = expected @ transform(piece.xyz, piece.rpy) @ moved(piece.type, piece.axis, piece.q)
    q = [piece.q for piece in pieces if piece.type != "fixed"]
    np.testing.assert_allclose(forward(joints, tip, q), expected, rtol=0, atol=1e-12)


# Mimic joints


def four_joints(*parts: str) -> str:
    links = [f"l{i}" for i in range(len(parts) + 1)]
    origin = '<origin xyz="0.3 0 0.1" rpy="0.2 0.4 -0.1"/>'
    joints = [joint(f"j{i}", links[i], links[i + 1], origin + part) for i, part in enumerate(parts)]
    return robot(link(*links), *joints)


def test_mimic_of_a_mimic(write) -> None:
    wide = '<limit lower="-90" upper="90" velocity="90"/>'
    text = four_joints(
        mimic("j2", 'multiplier="-2" offset="0.5"', wide), Z + wide, mimic("j3", 'offset="0.1"', wide), Z + LIMIT
    )
    joints, tip = read_urdf(write(text), "l4")
    assert [j.mimic for j in joints] == [(3, -2.0, 0.5 - 2 * 0.1), None, (3, 1.0, 0.1), None]
    q1, q3 = 0.7, -0.4
    expected = np.eye(4)
    for position in (-2 * (q3 + 0.1) + 0.5, q1, q3 + 0.1, q3):
        expected = expected @ transform([0.3, 0, 0.1], [0.2, 0.4, -0.1]) @ moved("revolute", [0, 0, 1], position)
    np.testing.assert_allclose(forward(joints, tip, [q1, q3]), expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    ("numbers", "lower", "upper", "velocity"),
    [
        ("", -1, 2, 3),
        ('multiplier="2"', -0.5, 1, 1.5),
        ('multiplier="-2"', -1, 0.5, 1.5),
        ('multiplier="0.1" offset="1"', -1, 2, 3),  # -20 <= q <= 10
        ('multiplier="-1" offset="1.5"', -0.5, 2, 3),
    ],
)
def test_bounds_hold_for_mimic_joints(numbers: str, lower: float, upper: float, velocity: float, write) -> None:
    (a, b), _ = read_urdf(write(three_links(Z + LIMIT, mimic("a", numbers))), "tip")
    assert (a.type, a.lower, a.upper, a.velocity) == ("revolute", lower, upper, velocity)
    assert (b.lower, b.upper, b.velocity) == (-1, 2, 3)


def test_continuous_joint_is_bounded_by_its_mimic_joints(write) -> None:
    text = three_links(Z, mimic("a")).replace("revolute", "continuous", 1)
    (a, _), _ = read_urdf(write(text), "tip")
    assert (a.type, a.lower, a.upper, a.velocity) == ("revolute", -1, 2, 3)
    (a, _), _ = read_urdf(write(text.replace("revolute", "continuous")), "tip")
    assert (a.type, a.lower, a.upper, a.velocity) == ("continuous", -inf, inf, 3)


def test_mimic_through_a_joint_outside_the_chain(write) -> None:
    """b mimics c, which mimics a: c is not between base and tip, but determines how b follows a."""
    text = robot(
        link("base", "mid", "tip", "eye"),
        joint("a", "base", "mid"),
        joint("b", "mid", "tip", mimic("c", 'multiplier="0.5" offset="0.1"')),
        joint("c", "mid", "eye", mimic("a", 'multiplier="-2" offset="0.2"')),
    )
    (_, b), _ = read_urdf(write(text), "tip")
    assert b.mimic == (0, -1.0, 0.1 + 0.5 * 0.2)


# A gripper as many arms have it: one finger is driven, the other mimics it.
GRIPPER = robot(
    link("base", "hand", "left", "right", "pad"),
    joint("wrist", "base", "hand", '<origin xyz="0 0 0.4" rpy="0.3 0 0"/>' + Z + LIMIT),
    joint("finger", "hand", "left", '<origin xyz="0 0.1 0"/><axis xyz="0 1 0"/>' + LIMIT, "prismatic"),
    joint(
        "follower",
        "hand",
        "right",
        '<origin xyz="0 -0.1 0.2" rpy="0 0.5 0"/><axis xyz="0 3 4"/>'
        '<mimic joint="finger" multiplier="-1" offset="0.02"/>' + LIMIT,
        "prismatic",
    ),
    joint(
        "tilt",
        "right",
        "pad",
        '<origin xyz="0.1 0 0"/><axis xyz="1 2 2"/><mimic joint="follower" offset="0.7"/>' + LIMIT,
    ),
)


def test_follower_of_a_joint_outside_the_chain_is_held(write) -> None:
    file = write(GRIPPER)
    with pytest.warns(UserWarning, match="is held") as warned:
        joints, tip = read_urdf(file, "pad")
    assert [j.name for j in joints] == ["wrist"]
    assert joints[0].mimic is None
    assert (joints[0].lower, joints[0].upper, joints[0].velocity) == (-1, 2, 3)  # A held joint bounds nothing.
    reason = "it mimics 'finger', which does not move between base and tip"
    assert [str(warning.message) for warning in warned] == [
        f"{file}: joint 'follower' is held at 0.02 m: {reason}",
        f"{file}: joint 'tilt' is held at 0.72 rad: {reason}",
    ]
    expected = (
        transform([0, -0.1, 0.2], [0, 0.5, 0])
        @ moved("prismatic", [0, 3, 4], 0.02)
        @ transform([0.1, 0, 0])
        @ moved("revolute", [1, 2, 2], 0.72)
    )
    np.testing.assert_allclose(tip, expected, rtol=0, atol=1e-15)


def test_warning_points_to_the_caller(write) -> None:
    with pytest.warns(UserWarning, match="is held") as warned:
        fp.SerialArm.from_urdf(write(GRIPPER), "right")
    assert warned[0].filename == __file__


def test_held_joint_agrees_with_pinocchio(write) -> None:
    """Pinocchio has the finger as a joint of its own, which stays at zero here, but supports no mimic of a mimic."""
    pin = pytest.importorskip("pinocchio")
    of_finger = '<mimic joint="finger" multiplier="-1" offset="0.72"/>'
    model = pin.buildModelFromXML(GRIPPER.replace('<mimic joint="follower" offset="0.7"/>', of_finger), mimic=True)
    data = model.createData()
    with pytest.warns(UserWarning, match="is held"):
        joints, tip = read_urdf(write(GRIPPER), "pad")
    for wrist in np.linspace(-1, 2, 7):
        q = pin.neutral(model)
        q[model.joints[model.getJointId("wrist")].idx_q] = wrist
        pin.framesForwardKinematics(model, data, q)
        pad = data.oMf[model.getFrameId("pad")].homogeneous
        np.testing.assert_allclose(forward(joints, tip, [wrist]), pad, rtol=0, atol=1e-14)


def test_follower_is_held_where_the_base_is_below_its_leader(write) -> None:
    text = robot(
        link("base", "mid", "far", "tip"),
        joint("a", "base", "mid"),
        joint("b", "mid", "far", mimic("a", 'offset="0.3"')),
        joint("c", "far", "tip"),
    )
    file = write(text)
    assert [j.name for j in read_urdf(file, "tip", "base")[0]] == ["a", "b", "c"]
    with pytest.warns(UserWarning, match="joint 'b' is held at 0.3 rad: "):
        (c,), _ = read_urdf(file, "tip", "mid")
    assert c.name == "c"
    np.testing.assert_allclose(c.placement, moved("revolute", [0, 0, 1], 0.3), rtol=0, atol=1e-15)
    assert error_message(file, "far", "mid") == (
        f"all joints between base and tip mimic joints elsewhere: 'b': at least one joint must have a drive, {ELSE}"
    )


# Refused

# Ends of messages.
NO_LINKS = "links without a parent joint: none: must be one link, the root: add the links of the robot"
NO_LINK = "does not exist: must be a <link> of the file: add the link, or correct the name"
TREE_OF = "must form a tree: remove a joint of the loop"
COUNT = "must be 1 to 64: give another base or tip"
ELSE = "or give another base or tip"
DRIVE = f"one joint must have a drive: remove its <mimic>, {ELSE}"
OWN_RANGE = f"give limits=fp.JointLimits(lower=..., upper=...), {ELSE}"
FIXED = f"all joints between base and tip are fixed, because lower = upper: 'a': to move a joint, {OWN_RANGE}"
ROBOT_FILE = "must be the URDF or SRDF file of a robot"
DEEP = "XML elements are nested more than 64 deep: must be a URDF or SRDF file"


def with_number(text: str) -> str:
    return two_links(joint("a", "base", "tip", text))


ORIGIN = "joint 'a': origin xyz = {!r}: must be 3 finite numbers"
REJECTED = {
    # Not a URDF.
    "": "line 1: invalid XML: no element found",
    "solid cube": "line 1: invalid XML: syntax error",
    "<robot>\n<link>\n</robot>": "line 3: invalid XML: mismatched tag",
    "<robot>\n<link name='a' name='b'/></robot>": "line 2: invalid XML: duplicate attribute",
    "<robot>\n": "line 2: invalid XML: no element found",
    '<?xml version="1.0" encoding="klingon"?><robot/>': "line 1: invalid XML: unknown encoding: klingon",
    "<mujoco/>": "line 1: the root is <mujoco>: must be <robot>, as in a URDF or SRDF file",
    "<" + "m" * 5000 + "/>": f"line 1: the root is <{'m' * 40}...>: must be <robot>, as in a URDF or SRDF file",
    robot('\n<xacro:include filename="x"/>'): "line 3: <xacro:include>: run xacro on the file first",
    with_number('<origin xyz="0 0 ${h}"/>'): "line 2: origin xyz = '0 0 ${h}': run xacro on the file first",
    # Names.
    robot("<link/>"): "<link> number 1 has no name",
    robot(link("a", "")): "<link> number 2 has no name",
    two_links("<joint/>"): "<joint> number 1 has no name",
    robot(link("a", "b", "a")): "two links are named 'a': names must be unique: rename one",
    two_links(
        joint("a", "base", "tip"), joint("a", "base", "tip")
    ): "two joints are named 'a': names must be unique: rename one",
    robot(link("x" * 257)): f"line 2: link name = '{'x' * 40}...' has 257 characters: must have at most 256",
    # Parts of a joint.
    two_links('<joint name="a" type="fixed"><child link="tip"/></joint>'): "joint 'a' has no <parent link=\"...\">",
    two_links('<joint name="a"><parent link="base"/><child/></joint>'): "joint 'a' has no <child link=\"...\">",
    with_number("<mimic/>"): "joint 'a' has no <mimic joint=\"...\">",
    with_number(LIMIT + LIMIT): "line 2: joint 'a' has a second <limit>: must have one",
    # Numbers.
    **{
        with_number(f'<origin xyz="{text}"/>'): ORIGIN.format(text)
        for text in ("", "1 2", "1 2 3 4", "1 2 x", "1,2,3", "1 2 nan", "inf 0 0", "1 2 1e999", "1 2 1_0", "1 2 ٣")
    },
    with_number('<origin rpy="0 -inf 0"/>'): "joint 'a': origin rpy = '0 -inf 0': must be 3 finite numbers",
    with_number('<axis xyz="0 0"/>'): "joint 'a': axis xyz = '0 0': must be 3 finite numbers",
    with_number('<axis xyz="0 -0 0.0"/>' + LIMIT): (
        f"joint 'a': axis = 0 0 0: must be a nonzero vector: correct the axis, {ELSE}"
    ),
    with_number('<limit lower="left"/>'): "joint 'a': limit lower = 'left': must be 1 finite number",
    with_number('<limit lower="-inf"/>'): "joint 'a': limit lower = '-inf': must be 1 finite number",
    with_number('<limit upper="nan"/>'): "joint 'a': limit upper = 'nan': must be 1 finite number",
    with_number('<limit velocity="1 2"/>'): "joint 'a': limit velocity = '1 2': must be 1 finite number",
    with_number('<limit velocity="Infinity"/>'): "joint 'a': limit velocity = 'Infinity': must be 1 finite number",
    with_number('<mimic joint="b" offset="?"/>'): "joint 'a': mimic offset = '?': must be 1 finite number",
    with_number('<mimic joint="b" multiplier=""/>'): "joint 'a': mimic multiplier = '': must be 1 finite number",
    # Bounds.
    with_number(""): FIXED,
    with_number('<limit velocity="1"/>'): FIXED,
    with_number('<limit lower="1.5" upper="-2" velocity="1"/>'): (
        f"joint 'a': lower = 1.5: must be below upper = -2: {OWN_RANGE}"
    ),
    with_number('<limit lower="0" upper="1" velocity="-2"/>'): (
        f"joint 'a': velocity = -2: must be positive: give limits=fp.JointLimits(velocity=...), {ELSE}"
    ),
    with_number('<limit acceleration="fast"/>'): "joint 'a': limit acceleration = 'fast': must be 1 finite number",
    # Types.
    **{
        two_links(joint("a", "base", "tip", type=type)): (
            f"joint 'a': type = '{type}': must be revolute, continuous, prismatic or fixed: correct the type, {ELSE}"
        )
        for type in ("floating", "planar", "Revolute", "spherical", "")
    },
    two_links(joint("a", "base", "tip").replace('type="revolute"', "")): (
        f"joint 'a': type = None: must be revolute, continuous, prismatic or fixed: correct the type, {ELSE}"
    ),
    # The tree.
    robot(): NO_LINKS,
    robot(link("tip", "b")): (
        "links without a parent joint: 'tip', 'b': must be one link, the root: connect the other links by joints"
    ),
    robot(link(*map(str, range(15)))): (
        f"links without a parent joint: {', '.join(repr(str(i)) for i in range(12))}, 3 more: must be one link, the "
        "root: connect the other links by joints"
    ),
    two_links(joint("a", "base", "tap")): f"joint 'a': child link 'tap' {NO_LINK}",
    two_links(joint("a", "bass", "tip")): f"joint 'a': parent link 'bass' {NO_LINK}",
    two_links(joint("a", "base", "tip"), joint("b", "base", "tip")): (
        "link 'tip' is the child of two joints, 'a' and 'b': must be the child of one joint: correct one <child>"
    ),
    two_links(
        joint("a", "base", "tip"), joint("b", "tip", "base")
    ): f"links form a loop: 'base', 'tip', 'base': {TREE_OF}",
    robot(link("tip"), joint("a", "tip", "tip")): f"links form a loop: 'tip', 'tip': {TREE_OF}",
    two_links(joint("a", "base", "tip"), link("x", "y"), joint("b", "x", "y"), joint("c", "y", "x")): (
        f"links form a loop: 'x', 'y', 'x': {TREE_OF}"
    ),
    # The joints between base and tip.
    two_links(joint("a", "base", "tip", type="fixed")): (f"no joints move between base 'base' and tip 'tip': {COUNT}"),
    robot(link("tip")): f"no joints move between base 'tip' and tip 'tip': {COUNT}",
    robot(link("0", *map(str, range(1, 65)), "tip"), *(joint(f"j{i}", str(i), str(i + 1)) for i in range(64))).replace(
        "</robot>", joint("last", "64", "tip") + "</robot>"
    ): f"65 joints move between base '0' and tip 'tip': {COUNT}",
    # Mimics.
    three_links(mimic("a"), Z + LIMIT): f"mimics form a loop: 'a', 'a': {DRIVE}",
    three_links(mimic("b"), mimic("a")): f"mimics form a loop: 'a', 'b', 'a': {DRIVE}",
    three_links(mimic("c"), Z + LIMIT): (
        "joint 'a' mimics 'c', which does not exist: "
        f"must mimic a joint of the file: correct the name, or remove <mimic>, {ELSE}"
    ),
    three_links(Z + LIMIT, mimic("a", 'multiplier="0"')): (
        "joint 'b' mimics 'a' by ratio 0 and offset 0: must be finite, the ratio not zero: "
        f"correct multiplier and offset, {ELSE}"
    ),
    three_links(Z + LIMIT, mimic("a")).replace("revolute", "fixed", 1): (
        f"all joints between base and tip mimic joints elsewhere: 'b': at least one joint must have a drive, {ELSE}"
    ),
    robot(
        link("base", "tip", *(f"l{i}" for i in range(71))),
        joint("j0", "base", "tip", mimic("j1")),
        *(joint(f"j{i + 1}", "base", f"l{i}", mimic(f"j{i + 2}")) for i in range(70)),
        joint("j71", "base", "l70"),
    ): "joint 'j0': more than 64 joints mimic one another in a row: must be fewer: let each mimic the last leader, "
    f"{ELSE}",
}


@pytest.mark.parametrize(("text", "message"), REJECTED.items(), ids=range(len(REJECTED)))
def test_invalid_urdf_is_rejected(text: str, message: str, write) -> None:
    assert error_message(write(text)) == message


@pytest.mark.parametrize(
    ("tip", "base", "message"),
    [
        (
            "hand",
            "right",
            "tip 'hand' is not below base 'right', they have 'torso' in common: "
            "base must be between the root 'root' and the tip",
        ),
        (
            "torso",
            "hand",
            "tip 'torso' is not below base 'hand', they have 'torso' in common: "
            "base must be between the root 'root' and the tip",
        ),
        ("hand", "hand", f"no joints move between base 'hand' and tip 'hand': {COUNT}"),
    ],
)
def test_links_with_no_chain_between(tip: str, base: str, message: str, write) -> None:
    assert error_message(write(TREE), tip, base) == message


@pytest.mark.parametrize(
    ("tip", "base", "message"),
    [
        ("hnad", None, "tip = 'hnad': must be a link, perhaps 'hand'; branches end in 'hand', 'right'"),
        ("lift", None, "tip = 'lift': must be a link, perhaps 'left'; branches end in 'hand', 'right'"),
        ("", None, "tip = '': must be a link; branches end in 'hand', 'right'"),
        (None, None, "tip = None: must be a link; branches end in 'hand', 'right'"),
        ("hand", "tors", "base = 'tors': must be a link, perhaps 'torso'; branches end in 'hand', 'right'"),
        ("hand", "", "base = '': must be a link; branches end in 'hand', 'right'"),
    ],
)
def test_unknown_links_are_rejected(tip: str, base: str | None, message: str, write) -> None:
    with pytest.raises(ParameterError) as caught:
        read_urdf(write(TREE), tip, base)
    assert str(caught.value) == message
    assert (caught.value.name, caught.value.value) == (("tip", tip) if base is None else ("base", base))


def test_64_joints_are_read(write) -> None:
    text = robot(link(*map(str, range(65))), *(joint(f"j{i}", str(i), str(i + 1)) for i in range(64)))
    assert len(read_urdf(write(text), "64")[0]) == 64


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"nowhere\.urdf"):
        read_urdf(tmp_path / "nowhere.urdf", "tip")
    with pytest.raises(IsADirectoryError):
        read_urdf(tmp_path, "tip")
    with pytest.raises(TypeError):
        read_urdf(0, "tip")  # type: ignore[arg-type]  # Not the standard input.


def test_requires_only_the_standard_library(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(TREE)
    program = (
        "import sys, fpbm_cpp as fp\n"
        "assert fp.SerialArm.from_urdf('arm.urdf', 'hand').dof == 3\n"
        "assert not {'yourdfpy', 'lxml', 'trimesh'} & sys.modules.keys()"
    )
    subprocess.run([sys.executable, "-c", program], cwd=tmp_path, check=True)


# Hostile files


def entities(n: int, use: str) -> str:
    """Entities that expand to 10^n words (the billion laughs)."""
    nested = "".join(f'<!ENTITY e{i} "{f"&e{i - 1};" * 10}">' for i in range(1, n + 1))
    return f'<?xml version="1.0"?>\n<!DOCTYPE robot [<!ENTITY e0 "ha">{nested}]>{use.format(f"&e{n};")}'


DOCTYPE = "line 2: has a DOCTYPE: must have none"
HOSTILE = {
    "laughs in text": (lambda: entities(12, "<robot>{}</robot>"), DOCTYPE),
    "laughs in a name": (lambda: entities(12, '<robot><link name="{}"/></robot>'), DOCTYPE),
    "long entity": (
        lambda: f'\n<!DOCTYPE robot [<!ENTITY e "{"x" * 100_000}">]><robot>{"&e;" * 100_000}</robot>',
        DOCTYPE,
    ),
    "file from outside": (
        lambda: '\n<!DOCTYPE robot [<!ENTITY e SYSTEM "file:///etc/passwd">]><robot><link name="&e;"/></robot>',
        DOCTYPE,
    ),
    "DTD from outside": (lambda: '\n<!DOCTYPE robot SYSTEM "http://localhost:9/x.dtd"><robot/>', DOCTYPE),
    "parameter entity": (lambda: '\n<!DOCTYPE r [<!ENTITY % e SYSTEM "http://localhost:9/x">%e;]><robot/>', DOCTYPE),
    "entity without DTD": (lambda: "<robot>&e;</robot>", "line 1: invalid XML: undefined entity"),
    "deep": (lambda: "<robot>" + "<a>" * 4_000_000, f"line 1: {DEEP}"),
    "long tag round many": (
        lambda: "<robot><" + "x" * 15_000_000 + ">" + "<a/>" * 60_000,
        f"line 1: has more than 50000 XML elements: {ROBOT_FILE}",
    ),
    "65 deep": (lambda: robot("<a>" * 64 + "</a>" * 64), f"line 2: {DEEP}"),
    "many elements": (
        lambda: "<robot>" + "<a/>" * 4_000_000,
        f"line 1: has more than 50000 XML elements: {ROBOT_FILE}",
    ),
    "many attributes": (
        lambda: "<robot {}/>".format(" ".join(f"a{i}='0'" for i in range(1_000_000))),
        NO_LINKS,
    ),
    "long name": (
        lambda: robot(link("x" * 16_000_000)),
        f"line 2: link name = '{'x' * 40}...' has 16000000 characters: must have at most 256",
    ),
    "long number": (
        lambda: with_number(f'<origin xyz="{"1" * 10_000_000}"/>'),
        f"line 2: origin xyz = '{'1' * 40}...' has 10000000 characters: must have at most 256",
    ),
    "long text": (lambda: robot(" " * 16_000_000), NO_LINKS),
    "zeros": (lambda: b"\0" * 1_000_000, "line 1: invalid XML: not well-formed (invalid token)"),
    "noise": (
        lambda: np.random.default_rng(0).bytes(1_000_000),
        "line 1: invalid XML: not well-formed (invalid token)",
    ),
    "other markup": (lambda: "\n<!DOCTYPE html><html/>", DOCTYPE),
}


@pytest.mark.parametrize(("make", "message"), HOSTILE.values(), ids=HOSTILE)
def test_malicious_file_is_rejected(make: Callable[[], str | bytes], message: str, write) -> None:
    assert error_message(write(make())) == message


def test_gigantic_file(tmp_path: Path) -> None:
    file = tmp_path / "big.urdf"
    with open(file, "wb") as out:
        out.truncate(1 << 40)  # A hole, which takes no disk space.
    assert error_message(file) == f"has more than 16 MiB: {ROBOT_FILE}"


@pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="no /dev/zero")
def test_infinite_file_is_rejected() -> None:
    assert error_message(Path("/dev/zero")) == f"has more than 16 MiB: {ROBOT_FILE}"


def test_64_deep_is_read(write) -> None:
    assert read_urdf(write(TREE.replace("</robot>", "<a>" * 63 + "</a>" * 63 + "</robot>")), "hand")


@pytest.mark.parametrize("length", [5, 190])
def test_long_chain(length: int, write) -> None:
    count = MAX_ELEMENTS // 8
    letters = np.random.default_rng(0).choice(list("abcdefgh"), (count, length))
    links = ["".join(row) + str(i) for i, row in enumerate(letters)]
    joints = (joint(f"j{i}", links[i], links[i + 1], type="fixed") for i in range(count - 1))
    file = write(robot(link(*links), *joints))
    start = time.process_time()
    with pytest.raises(ParameterError, match="must be a link"):
        read_urdf(file, links[1] + "?")
    assert time.process_time() - start < 4.0
    assert error_message(file, links[-1]).startswith("no joints move between base ")


@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(at=st.floats(0, 1), length=st.integers(0, 60), instead=st.text(max_size=20) | st.sampled_from(["nan", "<", "0"]))
def test_damaged_file_is_read_or_rejected(at: float, length: int, instead: str, write) -> None:
    text = three_links('<origin xyz="0 0 1" rpy="0 0 0"/>' + Z + LIMIT, mimic("a", 'multiplier="0.5"'))
    begin = int(at * len(text))
    file = write((text[:begin] + instead + text[begin + length :]).encode(errors="replace"))
    chain, reason = attempt(file, "tip")
    if chain is None:
        assert reason.startswith(f"{file}: ")
        assert len(reason.splitlines()) == 1
    else:
        assert 1 <= len(chain[0]) <= 2
        assert all(np.all(np.isfinite(joint.placement)) for joint in chain[0])
        assert np.all(np.isfinite(chain[1]))


# Robots of other packages


def robots() -> Path | None:
    spec = importlib.util.find_spec("cmeel")
    if spec is None or spec.origin is None:
        return None
    return Path(spec.origin).parents[1] / "cmeel.prefix/share/example-robot-data/robots"


ROBOTS = robots()
with_robots = pytest.mark.skipif(ROBOTS is None or not ROBOTS.exists(), reason="needs example-robot-data")


@with_robots
def test_panda() -> None:
    joints, tip = read_urdf(ROBOTS / "panda_description/urdf/panda.urdf", "panda_hand")
    assert [j.name for j in joints] == [f"panda_joint{i}" for i in range(1, 8)]
    assert (joints[3].lower, joints[3].upper, joints[6].velocity) == (-3.0718, -0.0698, 2.61)
    hand = transform([0.088, 0, 0.333 + 0.316 + 0.384 - 0.107], [pi, 0, pi / 4])  # From the data sheet.
    np.testing.assert_allclose(forward(joints, tip, np.zeros(7)), hand, atol=1e-12)


@with_robots
def test_baxter_finger() -> None:
    with pytest.warns(UserWarning, match="joint 'r_gripper_r_finger_joint' is held at 0 m: "):
        joints, _ = read_urdf(ROBOTS / "baxter_description/urdf/baxter.urdf", "r_gripper_r_finger_tip")
    assert [j.name for j in joints] == [f"right_{j}" for j in ("s0", "s1", "e0", "e1", "w0", "w1", "w2")]


@with_robots
def test_ur5() -> None:
    joints, tip = read_urdf(ROBOTS / "ur_description/urdf/ur5_robot.urdf", "tool0")
    assert len(joints) == 6
    a, d = [0.425, 0.39225], [0.089159, 0.10915, 0.09465, 0.0823]  # Universal Robots' DH parameters.
    stretched = [sum(a), d[1] + d[3], d[0] - d[2]]
    np.testing.assert_allclose(forward(joints, tip, np.zeros(6))[:3, 3], stretched, atol=1e-4)


# Sensors that nothing moves, grippers' fingers, wheels and joints locked by their bounds.
KNOWN_REASONS = ("must be 1 to 64", "must have a drive", "must be positive", "must be below")


@with_robots
@pytest.mark.parametrize("model", ["panda", "ur", "tiago", "talos", "romeo", "baxter", "pr2", "kinova", "iris", "icub"])
def test_each_branch_is_read_or_rejected(model: str) -> None:
    files = sorted(file for folder in ROBOTS.glob(f"{model}_*") for file in folder.rglob("*.urdf"))[:2]
    assert files
    for file in files:
        tree = ElementTree.parse(file)
        parents = {parent.get("link") for parent in tree.iterfind("joint/parent")}
        for leaf in (name for name in (link.get("name") for link in tree.iterfind("link")) if name not in parents):
            chain, reason = attempt(file, leaf)
            assert chain or any(known in reason for known in KNOWN_REASONS)
