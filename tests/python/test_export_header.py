"""Arms written as C++ headers: the results of the header, and error messages of the command."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import replace
from importlib.util import find_spec
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

import fpbm_cpp as fp
from fpbm_cpp.arms import Joint
from fpbm_cpp.capsule import Capsule
from fpbm_cpp.io.header import export_header, export_tree, namespace_of

pytest.importorskip("click")

from click.testing import CliRunner, Result

from fpbm_cpp.cli import command
from fpbm_cpp.urdf.capsules import capsules_of
from fpbm_cpp.urdf.chain import read_urdf

ROOT = Path(__file__).parents[2]
EIGEN = Path("/usr/include/eigen3")
CMEEL = find_spec("cmeel")
G1_FILE = "cmeel.prefix/share/example-robot-data/robots/g1_description/urdf/g1_29dof_rev_1_0.urdf"
G1 = Path(CMEEL.origin).parents[1] / G1_FILE if CMEEL and CMEEL.origin else None
NASTY = ['say "hi"', "back\\slash", "two\nlines", "Gelenk für 関節", "what??/", "tab\there\x7f1", ""]


def placed(rng: np.random.Generator) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3] = Rotation.random(random_state=rng.integers(1 << 30)).as_matrix()
    T[:3, 3] = rng.uniform(-1, 1, 3)
    return T


def chain(seed: int, types: Sequence[str], mimics: dict[int, tuple[int, float, float]]) -> list[Joint]:
    rng = np.random.default_rng(seed)
    bounds = {"continuous": (-inf, inf)}
    return [
        Joint(
            type,
            placed(rng),
            rng.uniform(-2, 2, 3),
            *bounds.get(type, (-1.5, 2.5)),
            3.0,
            name=name,
            mimic=mimic,
            **dynamics(rng),
        )
        for type, name, mimic in zip(types, NASTY, map(mimics.get, range(len(types))))
    ]


def dynamics(rng: np.random.Generator) -> dict[str, Any]:
    """Effort, inertia and friction of a joint."""
    R, (a, b, c) = Rotation.random(random_state=rng.integers(1 << 30)).as_matrix(), rng.uniform(0, 1, 3)
    effort, mass, rotor, damping, friction = rng.uniform(0.1, 3, 5)
    return {
        "effort": effort,
        "mass": mass,
        "center": rng.uniform(-1, 1, 3),
        "inertia": R @ np.diag([a + b, b + c, c + a]) @ R.T,
        "rotor_inertia": rotor,
        "damping": damping,
        "friction": friction,
    }


TIP = placed(np.random.default_rng(5))
ARMS = {
    "serial": chain(1, ["revolute", "prismatic", "continuous"] * 2 + ["revolute"], {}),
    "my::coupled": chain(2, ["revolute", "prismatic", "revolute", "revolute"], {0: (2, -1.5, 0.3), 3: (1, 0.7, -0.2)}),
}
CAPSULES = {
    "serial": [Capsule(i, [0.1 * i, -1 / 3, 1e-17], [-0.0, 2.0, 1e300], 0.1 + i, each) for i, each in enumerate(NASTY)],
    "my::coupled": [],
}


def coupling(joints: Sequence[Joint]) -> tuple[np.ndarray, np.ndarray]:
    """A and b, where the chain's positions are A q + b."""
    drives = [i for i, joint in enumerate(joints) if joint.mimic is None]
    A, b = np.eye(len(joints))[:, drives], np.zeros(len(joints))
    for i, joint in enumerate(joints):
        if joint.mimic is not None:
            leader, ratio, b[i] = joint.mimic
            A[i] = ratio * A[leader]
    return A, b


def bounds_of_drives(joints: Sequence[Joint]) -> np.ndarray:
    """Lower, upper, velocity, acceleration, jerk, effort of the drives: the bounds of all joints hold within them."""
    A, b = coupling(joints)
    rows = []
    for column in A.T:
        moved = [(ratio, offset, joint) for ratio, offset, joint in zip(column, b, joints) if ratio]
        ends = [sorted(((j.lower - offset) / ratio, (j.upper - offset) / ratio)) for ratio, offset, j in moved]
        lower, upper = max(low for low, _ in ends), min(high for _, high in ends)
        speeds = [
            min(getattr(j, name) / abs(ratio) for ratio, _, j in moved) for name in ("velocity", "acceleration", "jerk")
        ]
        rows.append([lower, upper, *speeds, min(j.effort * abs(ratio) for ratio, _, j in moved)])
    return np.transpose(rows)


def screw(axis: np.ndarray, through: np.ndarray, type: str) -> np.ndarray:
    """Twist [v, w] of a joint with its axis through a point, in base axes."""
    w = axis / np.linalg.norm(axis)
    return np.r_[w, 0, 0, 0] if type == "prismatic" else np.r_[np.cross(through, w), w]


def hat(twist: np.ndarray) -> np.ndarray:
    v, (x, y, z) = twist[:3], twist[3:]
    return np.vstack([np.column_stack([[[0, -z, y], [z, 0, -x], [-y, x, 0]], v]), np.zeros(4)])


def adjoint(T: np.ndarray) -> np.ndarray:
    R, (x, y, z) = T[:3, :3], T[:3, 3]
    p = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.block([[R, p @ R], [np.zeros((3, 3)), R]])


def product_of_exponentials(joints: Sequence[Joint], q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Tip and J at q, which may be complex."""
    A, b = coupling(joints)
    zero, moved, columns = np.eye(4), np.eye(4), []
    for joint, position in zip(joints, A @ q + b):
        zero = zero @ joint.placement
        twist = screw(zero[:3, :3] @ joint.axis, zero[:3, 3], joint.type)
        columns.append(adjoint(moved) @ twist)
        moved = moved @ expm(hat(twist) * position)
    tip = moved @ zero @ TIP
    at_tip = adjoint(np.vstack([np.column_stack([np.eye(3), -tip[:3, 3]]), [0, 0, 0, 1]]))
    return tip, at_tip @ np.column_stack(columns) @ A


PROGRAM = """
#include "coupled.hpp"
#include "serial.hpp"

#include <cstdio>
#include <fpbm/model/dynamics.hpp>

void print(const char* format, double number) { std::printf(format, number); }

template <typename Derived>
void print(const Eigen::MatrixBase<Derived>& M) {
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    for (Eigen::Index j = 0; j < M.cols(); ++j) print("%.17g ", M(i, j));
  }
}

template <int N, typename Arm, int Length>
void run(const Arm& arm, const std::array<const char*, N>& names, const std::vector<fpbm::LinkCapsule<>>& capsules,
         const fpbm::Chain<double, Length>& chain) {
  for (const auto& [link, capsule, name] : capsules) {
    std::printf("%d ", link), print(capsule.a), print(capsule.b), print("%.17g", capsule.radius);
    std::printf("%c%s%c", 0, name.c_str(), 0);
  }
  const auto& limits = arm.limits();
  for (const char* name : names) std::printf("%s%c", name, 0);
  print(limits.lower), print(limits.upper), print(limits.velocity), print(limits.acceleration), print(limits.jerk);
  print(limits.effort);
  for (const auto& joint : chain.joints) print("%.17g ", joint.drive.dry);
  const fpbm::Dynamics<N, double, Length> dynamics(chain);
  typename fpbm::Dynamics<N, double, Length>::State placed;
  fpbm::State<N> state;
  for (int sample = 0; sample < 20; ++sample) {
    for (int i = 0; i < N; ++i) if (std::scanf("%lf", &state.q(i)) != 1) return;
    for (int i = 0; i < N; ++i) if (std::scanf("%lf", &state.qd(i)) != 1) return;
    fpbm::Kinematics<fpbm::Pose, N> kinematics;
    arm.kinematics(state.q, state.qd, kinematics);
    print(kinematics.tip.p), print(kinematics.tip.R), print(kinematics.J), print(kinematics.Jd);
    dynamics.robot().update(state.q, state.qd, placed);
    print(dynamics.inverse_dynamics(placed, state.q));
  }
  std::printf("%c", 0);
}

int main() {
  run<serial::kDof>(serial::arm(), serial::kJointNames, serial::capsules(), serial::chain());
  run<my::coupled::kDof>(my::coupled::arm(), my::coupled::kJointNames, my::coupled::capsules(), my::coupled::chain());
}
"""


@pytest.mark.skipif(not shutil.which("g++") or not EIGEN.exists(), reason="needs g++ and Eigen")
def test_header_agrees_with_numpy(tmp_path: Path) -> None:
    for name, joints in ARMS.items():
        source = 'an "arm" \\\nint x = 1;'
        file = tmp_path / f"{name.split('::')[-1]}.hpp"
        text = export_header(joints, TIP, name=name, source=source, capsules=CAPSULES[name])
        file.write_text(text, encoding="utf-8")
    (tmp_path / "main.cpp").write_text(PROGRAM)
    flags = ["-std=c++17", "-O0", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]
    includes = ["-I", str(ROOT / "cpp/include"), "-isystem", str(EIGEN)]
    subprocess.run(["g++", *flags, *includes, "main.cpp", "-o", "main"], cwd=tmp_path, check=True)

    rng = np.random.default_rng(3)
    states = {name: rng.uniform(-2, 2, (20, 2, coupling(joints)[0].shape[1])) for name, joints in ARMS.items()}
    numbers = " ".join(repr(float(x)) for array in states.values() for x in array.ravel())
    printed = subprocess.run([tmp_path / "main"], input=numbers.encode(), capture_output=True, check=True).stdout
    parts = iter(printed.split(b"\0"))
    for name, joints in ARMS.items():
        for capsule in CAPSULES[name]:
            link, *numbers = map(float, next(parts).split())
            assert (link, numbers) == (capsule.link, [*capsule.a, *capsule.b, capsule.radius])
            assert next(parts).decode() == capsule.name
        drives = [joint for joint in joints if joint.mimic is None]
        expected_names = [joint.name or f"joint_{joints.index(joint) + 1}" for joint in drives]
        assert [next(parts).decode() for _ in drives] == expected_names
        n = len(drives)
        first = 6 * n + len(joints)
        given, *samples = np.split(np.array(next(parts).split(), float), first + np.arange(20) * (12 + 13 * n))
        np.testing.assert_array_equal(given[: 6 * n].reshape(6, n), bounds_of_drives(joints))
        assert given[6 * n :].tolist() == [joint.friction for joint in joints]
        arm = fp.SerialArm(joints, TIP)
        for (q, qd), sample in zip(states[name], samples):
            p, R, J, Jd, torque = np.split(sample, [3, 12, 12 + 6 * n, 12 + 12 * n])
            np.testing.assert_allclose(torque, arm.inverse_dynamics(q, qd, q), rtol=1e-12, atol=1e-11)
            tip, jacobian = product_of_exponentials(joints, q)
            _, ahead = product_of_exponentials(joints, q + 1e-30j * qd)
            np.testing.assert_allclose(p, tip[:3, 3], rtol=0, atol=1e-12)
            np.testing.assert_allclose(R.reshape(3, 3), tip[:3, :3], rtol=0, atol=1e-12)
            np.testing.assert_allclose(J.reshape(6, n), jacobian, rtol=0, atol=1e-12)
            np.testing.assert_allclose(Jd.reshape(6, n), ahead.imag / 1e-30, rtol=0, atol=1e-11)


# Robots

TREE_PROGRAM = """
#include "tree.hpp"

#include <cstdio>

void print(double number) { std::printf("%.17g ", number); }
void print(const char* name) { std::printf("%c%s%c", 0, name, 0); }

template <typename Derived>
void print(const Eigen::MatrixBase<Derived>& M) {
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    for (Eigen::Index j = 0; j < M.cols(); ++j) print(M(i, j));
  }
}

int main() {
  const auto tree = t::tree();
  const auto robot = t::robot();
  print(robot.dof()), print(tree.base.mass), print(tree.base.centre);
  for (const char* name : t::kJointNames) print(name);
  for (const auto& [joint, parent] : tree.joints) {
    print(joint.name.data()), print(static_cast<int>(joint.type));
    print(joint.placement.p), print(joint.placement.R), print(joint.axis);
    print(joint.bounds.lower), print(joint.bounds.upper), print(joint.bounds.velocity), print(joint.bounds.effort);
    print(joint.mimic.joint), print(joint.mimic.ratio), print(joint.mimic.offset), print(parent);
    print(joint.moved.mass), print(joint.moved.centre), print(joint.moved.inertia);
    print(joint.drive.rotor_inertia), print(joint.drive.viscous), print(joint.drive.dry);
  }
  for (const auto& [name, link, offset] : tree.frames) {
    print(name.data()), print(link), print(offset.p), print(offset.R);
  }
}
"""


def robot_of_branches() -> fp.Robot:
    """A robot with two branches, joints that follow others, and masses."""
    rng = np.random.default_rng(4)
    types = ["revolute", "prismatic", "continuous", "revolute", "revolute", "revolute"]
    mimics = {3: (1, 0.5, -0.2), 5: (0, 1.5, 0.1)}
    joints = list(map(fp.TreeJoint, chain(6, types, mimics), (0, 1, 1, 3, 0, 5)))
    joints[0] = fp.TreeJoint(replace(joints[0].joint, mass=0, center=(0, 0, 0), inertia=np.zeros((3, 3))))
    frames = [fp.NamedFrame(name, link, placed(rng)) for link, name in enumerate(NASTY[:5])]
    return fp.Robot(joints, [*frames, fp.NamedFrame("as it is", 2)], base_mass=7.0, base_center=[0.1, 0, 1 / 3])


@pytest.mark.skipif(not shutil.which("g++") or not EIGEN.exists(), reason="needs g++ and Eigen")
def test_a_tree_equals_the_robot(tmp_path: Path) -> None:
    robot = robot_of_branches()
    (tmp_path / "tree.hpp").write_text(export_tree(robot, name="t", source="robot"), encoding="utf-8")
    (tmp_path / "main.cpp").write_text(TREE_PROGRAM)
    flags = ["-std=c++17", "-O0", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]
    includes = ["-I", str(ROOT / "cpp/include"), "-isystem", str(EIGEN)]
    subprocess.run(["g++", *flags, *includes, "main.cpp", "-o", "main"], cwd=tmp_path, check=True)
    printed = subprocess.run([tmp_path / "main"], capture_output=True, check=True).stdout
    parts = printed.decode().split("\0")
    assert [part for part in parts[1::2] if part] == [
        *(name or "joint_7" for name in robot.joint_names),
        *(each.joint.name for each in robot.joints),
        *robot.frames,
    ]
    kinds = ("revolute", "continuous", "prismatic")
    expected = [4, robot.base_mass, *robot.base_center]
    for each in robot.joints:
        joint, mimic = each.joint, each.joint.mimic or (-1, 1.0, 0.0)
        expected += [kinds.index(joint.type), *joint.placement[:3, 3], *joint.placement[:3, :3].ravel(), *joint.axis]
        expected += [joint.lower, joint.upper, joint.velocity, joint.effort, *mimic, each.parent]
        expected += [joint.mass, *joint.center, *joint.inertia.ravel()]
        expected += [joint.rotor_inertia, joint.damping, joint.friction]
    for frame in robot.named_frames:
        expected += [frame.link, *frame.offset[:3, 3], *frame.offset[:3, :3].ravel()]
    np.testing.assert_array_equal([float(number) for part in parts[::2] for number in part.split()], expected)


def test_a_tree_of_float_and_long_sources() -> None:
    robot = fp.Robot.preset("two_pandas")
    text = export_tree(robot, name="n", source=", ".join(["a long link"] * 20), scalar="float")
    assert "inline fpbm::Tree<float, 14, 2> tree() {\n  fpbm::Tree<float, 14, 2> tree;" in text
    assert "return fpbm::Robot<kDof, float>(tree());" in text
    first, second, third, *_ = text.splitlines()
    assert all(line.startswith("// ") and len(line) <= 120 for line in (first, second, third))
    with pytest.raises(fp.ParameterError, match="name = 'int'"):
        export_tree(robot, name="int")


# The text


def test_default_values_are_omitted() -> None:
    text = export_header([Joint(name="a"), Joint("continuous", velocity=2.0)], np.eye(4), name="n")
    assert "placement" not in text
    assert "chain.tip" not in text
    assert "joints[0].bounds" not in text
    assert "  chain.joints[1].bounds = {-kNone, kNone, 2.0};\n" in text
    assert "constexpr double kNone = fpbm::JointBounds<double>::kNone;" in text
    assert "kNone" not in export_header([Joint()], np.eye(4), name="n")


@given(numbers=st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=16, max_size=16))
def test_numbers_are_written_exactly(numbers: list[float]) -> None:
    p, R, axis, lower = numbers[:3], np.reshape(numbers[3:12], (3, 3)), numbers[12:15], numbers[15]
    T = np.block([[R, np.reshape(p, (3, 1))], [np.zeros(3), 1]])
    text = export_header([Joint("revolute", T, axis, lower)], T, name="n")

    def written(name: str) -> list[float]:
        (braces,) = re.findall(rf"  {re.escape(name)} = (?:fpbm::Matrix<3, 3, double>)?({{[^;]*}});", text)
        return [inf if number == "kNone" else float(number) for number in re.findall(r"[^{},\s]+", braces)]

    assert written("chain.joints[0].axis") == axis
    assert lower == -inf or written("chain.joints[0].bounds")[0] == lower
    for name in ("chain.joints[0].placement", "chain.tip"):
        assert not np.any(p) or written(f"{name}.p") == p
        assert np.array_equal(R, np.eye(3)) or written(f"{name}.R") == R.ravel().tolist()


def test_capsules_are_written_if_they_are_given() -> None:
    without, none, one = (
        export_header([Joint()], np.eye(4), name="n", capsules=capsules)
        for capsules in (None, [], [Capsule(1, [0, 0, 0], [0, 0, 1], 0.5, "link")])
    )
    assert "LinkCapsule" not in without
    assert "clearance" not in without
    for text in (none, one):
        assert "#include <fpbm/bound/clearance.hpp>\n" in text
        assert "inline std::vector<fpbm::LinkCapsule<double>> capsules() {\n" in text
    assert '      {1, {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.5}, "link"},\n' in one


@pytest.mark.parametrize(
    ("stem", "name"),
    [
        ("panda", "panda"),
        ("04_exported_arm", "exported_arm"),
        ("my-arm v2.1", "my_arm_v2_1"),
        ("__x__y__", "x_y"),
        ("Łódź", "d"),
        ("関節", "arm"),
        ("7", "arm"),
        ("", "arm"),
        ("int", "int_arm"),
        ("std", "std_arm"),
        ("fpbm", "fpbm_arm"),
    ],
)
def test_namespace_is_derived_from_the_file_name(stem: str, name: str) -> None:
    assert namespace_of(stem) == name
    assert f"namespace {name} {{" in export_header([Joint()], np.eye(4), name=name)


@pytest.mark.parametrize(
    "name", ["", "7up", "a b", "a-b", "a\n", "_a", "a__b", "int", "fpbm", "std::x", "a::", "::a", "a:b", "é", "x{"]
)
def test_invalid_namespace_is_rejected(name: str) -> None:
    with pytest.raises(ValueError, match=r"must be a C\+\+ identifier, not a keyword, Eigen, fpbm or std") as caught:
        export_header([Joint()], np.eye(4), name=name)
    assert str(caught.value).startswith(f"name = {name!r}: ")


def test_source_is_escaped_in_its_comment() -> None:
    text = export_header([Joint()], np.eye(4), name="n", source="a\nb\r\u2028\u202ec\\ é")
    assert text.startswith("// Written by fpbm-cpp export-header from a?b???c\\ é. Do not edit.\n#pragma")


# The command

URDF = """<robot name="r"><link name="base"/><link name="mid"/><link name="tip"/>
<joint name="a" type="revolute"><parent link="base"/><child link="mid"/><limit upper="1" velocity="1"/></joint>
<joint name="b" type="continuous"><parent link="mid"/><child link="tip"/></joint></robot>
"""


def call(*arguments: str | Path) -> Result:
    return CliRunner().invoke(command, ["export-header", *map(str, arguments)])


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    file = tmp_path / "two.urdf"
    file.write_text(URDF)
    return file


def test_example_is_up_to_date(tmp_path: Path) -> None:
    """If not: fpbm-cpp export-header examples/04_exported_arm.urdf --tip tool -o examples/04_exported_arm.hpp"""
    out = tmp_path / "04_exported_arm.hpp"
    result = call(ROOT / "examples/04_exported_arm.urdf", "--tip", "tool", "-o", out)
    assert (result.exit_code, result.output) == (0, "")
    assert out.read_bytes() == (ROOT / "examples/04_exported_arm.hpp").read_bytes()


@pytest.mark.parametrize("name", ["panda", "ur5e"])
def test_arms_of_the_firmware_are_up_to_date(name: str, tmp_path: Path) -> None:
    """If not: fpbm-cpp export-header panda --scalar float -o examples/firmware/panda.hpp, and so on."""
    out = tmp_path / f"{name}.hpp"
    result = call(name, "--scalar", "float", "-o", out)
    assert (result.exit_code, result.output) == (0, "")
    assert out.read_bytes() == (ROOT / f"examples/firmware/{name}.hpp").read_bytes()


@pytest.mark.skipif(G1 is None or not G1.exists(), reason="needs example-robot-data")
def test_upper_body_is_up_to_date(tmp_path: Path) -> None:
    """If not: fpbm-cpp export-header g1_29dof_rev_1_0.urdf --base fixed --tip left_wrist_yaw_link --tip
    right_wrist_yaw_link -o examples/17_upper_body.hpp"""
    out = tmp_path / "17_upper_body.hpp"
    assert G1 is not None
    result = call(G1, "--base", "fixed", "--tip", "left_wrist_yaw_link", "--tip", "right_wrist_yaw_link", "-o", out)
    assert (result.exit_code, result.output) == (0, "")
    assert out.read_bytes() == (ROOT / "examples/17_upper_body.hpp").read_bytes()


def test_command_writes_robots(arm: Path) -> None:
    robot = fp.Robot.from_urdf(arm)
    assert call(arm, "-o", "-").stdout == export_tree(robot, name="two", source="two.urdf")
    tips = ("--tip", "mid", "--tip", "tip")
    text = call(arm, *tips, "--base", "planar", "-o", "-").stdout
    robot = fp.Robot.from_urdf(arm, base="planar")
    frames = [frame for frame in robot.named_frames if frame.name != "base"]
    source = "two.urdf, base planar, tips mid, tip"
    assert text == export_tree(replace(robot, named_frames=frames), name="two", source=source)
    two_pandas = fp.Robot.preset("two_pandas")
    assert call("two_pandas", "-o", "-").stdout == export_tree(
        two_pandas, name="two_pandas", source="preset two_pandas"
    )
    assert_rejected(
        call(arm, "--tip", "top", "--tip", "tip", "-o", "-"), "tips has 'top': must be links, perhaps 'tip'"
    )
    assert_rejected(call(arm, "--base", "wheels", "-o", "-"), "base = 'wheels': must be one of fixed, planar")
    for wrong in ((arm, "--capsules"), ("two_pandas", "--capsules")):
        result = call(*wrong, "-o", "-")
        assert result.exit_code == 2
        assert "--capsules are for an arm only: give one --tip." in result.output


@pytest.mark.parametrize("preset", ["panda", "two_pandas"])
def test_presets_have_their_own_tip(preset: str) -> None:
    for option in ("--tip", "--base"):
        result = call(preset, option, "x", "-o", "-")
        assert result.exit_code == 2
        assert "--tip and --base are for URDF files" in result.output


def test_presets_have_capsules() -> None:
    capsules = fp.Clearance.preset("panda").capsules
    assert call("panda", "-o", "-", "--capsules").stdout == export_header(
        fp.SerialArm.preset("panda").joints,
        fp.SerialArm.preset("panda").tip,
        name="panda",
        source="preset panda",
        capsules=capsules,
    )


def test_numbers_in_float() -> None:
    joint = Joint("revolute", velocity=2.0, mimic=(1, 0.5, 0.1))
    text = export_header([joint, Joint()], np.eye(4), name="n", scalar="float")
    assert "inline fpbm::Chain<float, 2> chain() {\n  constexpr float kNone" in text
    assert "bounds = {-kNone, kNone, 2.0F};" in text
    assert "mimic = {1, 0.5F, 0.1F};" in text
    assert "return fpbm::CoupledArm<kDof, float>(chain());" in text
    with pytest.raises(fp.ParameterError, match="scalar = 'half': must be one of double, float"):
        export_header([Joint()], np.eye(4), name="n", scalar="half")


def test_command_writes_the_header_of_the_function(arm: Path, tmp_path: Path) -> None:
    joints, tip = read_urdf(arm, "tip", "mid")
    assert call(arm, "--tip", "tip", "--base", "mid", "-o", tmp_path / "my-arm.hpp").exit_code == 0
    expected = export_header(joints, tip, name="my_arm", source="two.urdf, base mid, tip tip")
    assert (tmp_path / "my-arm.hpp").read_text() == expected
    assert sorted(os.listdir(tmp_path)) == ["my-arm.hpp", "two.urdf"]


def test_standard_output(arm: Path) -> None:
    joints, tip = read_urdf(arm, "tip")
    for options, name in ((), "two"), (("--name", "robots::left"), "robots::left"):
        result = call(arm, "--tip", "tip", "-o", "-", *options)
        assert result.exit_code == 0
        assert result.stdout == export_header(joints, tip, name=name, source="two.urdf, tip tip")


def test_capsules_of_a_file(arm: Path) -> None:
    result = call(arm, "--tip", "tip", "-o", "-", "--capsules")
    assert_rejected(
        result,
        f"{arm}: has no <collision> geometry: must be on at least one link: add <collision>, or give capsules to "
        "Clearance()",
    )
    box = '<link name="tip"><collision><geometry><box size="0.1 0.2 0.5"/></geometry></collision></link>'
    arm.write_text(URDF.replace('<link name="tip"/>', box))
    for base, link, source in (None, 2, "two.urdf, tip tip"), ("mid", 1, "two.urdf, base mid, tip tip"):
        options = () if base is None else ("--base", base)
        result = call(arm, "--tip", "tip", *options, "-o", "-", "--capsules")
        joints, tip = read_urdf(arm, "tip", base)
        capsules = capsules_of(arm, "tip", base)
        assert {(capsule.link, capsule.name) for capsule in capsules} == {(link, "tip")}
        assert result.stdout == export_header(joints, tip, name="two", source=source, capsules=capsules)


def test_file_is_replaced_with_the_default_mode(arm: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.hpp"
    out.write_text("old")
    (tmp_path / "link.hpp").symlink_to(out)
    (tmp_path / "usual").write_text("")
    assert call(arm, "--tip", "tip", "-o", tmp_path / "link.hpp", "--name", "n").exit_code == 0
    assert "namespace n {" in out.read_text()
    assert (tmp_path / "link.hpp").is_symlink()
    assert out.stat().st_mode == (tmp_path / "usual").stat().st_mode


@pytest.mark.filterwarnings("default")
def test_held_joint_is_reported(tmp_path: Path) -> None:
    mimic = '<mimic joint="d" offset="0.1"/>'
    finger = f'<joint name="c" type="prismatic"><parent link="tip"/><child link="pad"/>{mimic}</joint>'
    leader = '<joint name="d" type="prismatic"><parent link="tip"/><child link="left"/></joint>'
    file = tmp_path / "hand.urdf"
    file.write_text(URDF.replace("</robot>", f'<link name="pad"/><link name="left"/>{finger}{leader}</robot>'))
    result = call(file, "--tip", "pad", "-o", "-")
    assert result.exit_code == 0
    assert result.stderr == (
        f"Warning: {file}: joint 'c' is held at 0.1 m: it mimics 'd', which does not move between base and tip\n"
    )
    assert "  chain.tip.p = {0.1, 0.0, 0.0};\n" in result.stdout


@pytest.mark.skipif(not os.path.exists("/dev/null"), reason="no /dev/null")
def test_device(arm: Path) -> None:
    assert call(arm, "--tip", "tip", "-o", "/dev/null").exit_code == 0
    assert Path("/dev/null").is_char_device()


def assert_rejected(result: Result, message: str) -> None:
    assert result.exit_code == 1
    assert result.output == f"Error: {message}\n"


def test_errors_have_one_line(arm: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "out.hpp"
    out.write_text("mine")
    before = sorted(os.listdir(tmp_path))
    to_out = ("--tip", "tip", "-o", out)
    bad = arm.parent / "nowhere.urdf"
    assert_rejected(call(bad, *to_out), f"cannot read {bad}: No such file or directory")
    assert_rejected(call(tmp_path, *to_out), f"cannot read {tmp_path}: Is a directory")
    leaves = "branches end in 'tip'"
    assert_rejected(call(arm, "--tip", "top", "-o", out), f"tip = 'top': must be a link, perhaps 'tip'; {leaves}")
    assert_rejected(call(arm, *to_out, "--base", "x"), f"base = 'x': must be a link; {leaves}")
    broken = tmp_path / "broken.urdf"
    broken.write_text("<robot/")
    assert_rejected(call(broken, *to_out), f"{broken}: line 1: invalid XML: unclosed token")
    broken.unlink()
    demand = "must be a C++ identifier, not a keyword, Eigen, fpbm or std"
    assert_rejected(call(arm, *to_out, "--name", "int"), f"name = 'int': {demand}")
    assert_rejected(call(arm, "--tip", "tip", "-o", tmp_path), f"cannot write to {tmp_path}: Is a directory")
    lost = tmp_path / "no" / "out.hpp"
    assert_rejected(call(arm, "--tip", "tip", "-o", lost), f"cannot write to {lost}: No such file or directory")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", full)
        assert_rejected(call(arm, *to_out), f"cannot write to {out}: No space left on device")
    assert out.read_text() == "mine"
    assert sorted(os.listdir(tmp_path)) == before


def test_invalid_usage_is_reported(arm: Path) -> None:
    for arguments, words in (((arm, "--tip", "tip"), "--out"), ((), "ARM")):
        result = call(*arguments)
        assert result.exit_code == 2
        assert words in result.output.splitlines()[-1]
    assert "Example: fpbm-cpp export-header my_arm.urdf --tip tool -o my_arm.hpp" in call("--help").output
