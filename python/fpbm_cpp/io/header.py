"""C++ headers of arms and robots, for programs that read no files."""

import re
import textwrap
from collections.abc import Sequence
from math import inf

import numpy as np
from numpy.typing import ArrayLike

from ..capsule import Capsule
from ..errors import not_one_of, wrong
from ..joints import Joint
from ..robots import Robot

SCALARS = ("double", "float")

# Invalid names of a namespace: keywords of C++, and namespaces of other libraries.
TAKEN = """alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t char32_t class
co_await co_return co_yield compl concept const consteval constexpr constinit const_cast continue decltype default
delete do double dynamic_cast else enum explicit export extern false float for friend goto if inline int long mutable
namespace new noexcept not not_eq nullptr operator or or_eq private protected public register reinterpret_cast requires
return short signed sizeof static static_assert static_cast struct switch template this thread_local throw true try
typedef typeid typename union unsigned using virtual void volatile wchar_t while xor xor_eq Eigen fpbm std"""

BOUNDS = """\
/// Bounds are lower, upper [rad] or [m], velocity, acceleration, jerk, and the offset and deceleration of the velocity
/// bound near an end of the range; effort [Nm] or [N]. A value that is left out means no bound. moved: mass [kg],
/// centre [m] and inertia [kg m²] of the link. drive: inertia of the rotor, viscous and dry friction."""


def export_header(
    joints: Sequence[Joint],
    tip: ArrayLike,
    *,
    name: str,
    source: str = "",
    capsules: Sequence[Capsule] | None = None,
    scalar: str = "double",
) -> str:
    """Text of a C++ header that constructs an arm, so that a program needs neither a parser nor a file.

    The header has kDof, kJointNames, chain(), of which fpbm::Dynamics can also be constructed, and arm(), which returns
    an fpbm::CoupledArm if the arm has mimic joints, otherwise an fpbm::SerialArm. The header has capsules() if capsules
    are given, also for an empty list. name: the namespace, for example 'my::arm'. tip: frame of the tip in the frame of
    the last joint, shape (4, 4) [m]. source: origin of the arm, for a comment. scalar: 'double', or 'float' for a
    processor without double. Raises ParameterError if the name is not a valid namespace.
    """
    kind = "CoupledArm" if any(joint.mimic for joint in joints) else "SerialArm"
    parts = [_joint_lines(f"  chain.joints[{i}]", joint, scalar) for i, joint in enumerate(joints)]
    parts.append(_transform_lines("  chain.tip", tip, scalar))
    includes = ["array", f"fpbm/model/{'serial_arm' if kind == 'SerialArm' else 'coupled_arm'}.hpp"]
    if capsules is not None:
        includes += ["fpbm/bound/clearance.hpp", "vector"]
    made = f"Chain<{scalar}, {len(joints)}> chain", f"{kind}<kDof, {scalar}> arm"
    comment = "/// The joints from base to tip, each placed in the frame of the previous joint [m]."
    rest = "" if capsules is None else _capsule_lines(capsules, scalar)
    return _header(joints, name, source, scalar, includes, comment, made, parts, rest)


def export_tree(robot: Robot, *, name: str, source: str = "", scalar: str = "double") -> str:
    """Text of a C++ header that constructs a robot, so that a program needs neither a parser nor a file.

    The header has kDof, kJointNames, tree(), with the masses of the links and all frames of the robot, and robot().
    name, source, scalar and errors are as in export_header().
    """
    joints = [each.joint for each in robot.joints]
    followers = f", {len(joints)}" if any(joint.mimic for joint in joints) else ""
    parts = [_mass_lines("  tree.base", robot.base_mass, robot.base_center, scalar)]
    for i, each in enumerate(robot.joints):
        parts.append(_joint_lines(f"  tree.joints[{i}].joint", each.joint, scalar))
        parts[-1].append(f"  tree.joints[{i}].parent = {each.parent};")
    for i, frame in enumerate(robot.named_frames):
        member = f"  tree.frames[{i}]"
        parts.append([f"{member}.name = {_literal(frame.name)};", f"{member}.link = {frame.link};"])
        parts[-1] += _transform_lines(f"{member}.offset", frame.offset, scalar)
    tree = f"Tree<{scalar}, {len(joints)}, {len(robot.named_frames)}> tree"
    made = tree, f"Robot<kDof, {scalar}{followers}> robot"
    comment = """\
/// The joints from the base on, each placed in the frame of its parent link [m], with their links; frames. Link 0 is
/// the base, with its mass [kg] and centre [m]; link i + 1 is the child of joint i."""
    return _header(joints, name, source, scalar, ["array", "fpbm/model/robot.hpp"], comment, made, parts)


def namespace_of(stem: str) -> str:
    """A namespace from the name of a file without its suffix: '04-my arm' gives 'my_arm'."""
    name = re.sub(r"[^A-Za-z0-9]+", "_", stem).lstrip("_0123456789").rstrip("_") or "arm"
    return f"{name}_arm" if name in TAKEN.split() else name


def _is_identifier(name: str) -> bool:
    # Two successive underscores, and a leading underscore, are reserved for the compiler.
    return re.fullmatch(r"[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*_?", name) is not None and name not in TAKEN.split()


def _header(
    joints: Sequence[Joint],
    name: str,
    source: str,
    scalar: str,
    includes: Sequence[str],
    comment: str,
    made: tuple[str, str],
    parts: Sequence[Sequence[str]],
    rest: str = "",
) -> str:
    """The whole header. made: type and function of the data, whose lines are parts, and of the arm or the robot.

    Raises ParameterError if scalar or name is invalid.
    """
    if scalar not in SCALARS:
        raise not_one_of("scalar", scalar, SCALARS)
    if not all(_is_identifier(part) for part in name.split("::")):
        raise wrong("name", name, f" = {name!r}: must be a C++ identifier, not a keyword, Eigen, fpbm or std")
    drives = [_literal(joint.name or f"joint_{i}") for i, joint in enumerate(joints, 1) if joint.mimic is None]
    width = max(map(len, drives), default=0)
    names = "\n".join(f"    {literal + ',':{width + 1}}  // q({i})" for i, literal in enumerate(drives))
    origin = f" from {''.join(c if c.isprintable() else '?' for c in source)}" if source else ""
    said = f"// Written by fpbm-cpp export-header{origin}. Do not edit."
    text = "\n\n".join("\n".join(lines) for lines in parts if lines)
    none = f"  constexpr {scalar} kNone = fpbm::JointBounds<{scalar}>::kNone;\n" if "kNone" in text else ""
    (data, arm), variable = made, made[0].split()[-1]
    return f"""\
{textwrap.fill(said, 120, subsequent_indent="// ", break_long_words=False, break_on_hyphens=False)}
#pragma once

{chr(10).join(f"#include <{include}>" for include in sorted(includes))}

namespace {name} {{

inline constexpr int kDof = {len(drives)};

inline constexpr std::array<const char*, kDof> kJointNames = {{
{names}
}};

{comment}
{BOUNDS}
inline fpbm::{data}() {{
{none}  fpbm::{data};

{text}

  return {variable};
}}

inline fpbm::{arm}() {{
  return fpbm::{arm.rpartition(" ")[0]}({variable}());
}}
{rest}
}}  // namespace {name}
"""


def _mass_lines(member: str, mass: float, center: ArrayLike, scalar: str) -> list[str]:
    return [f"{member} = {{{_number(mass, scalar)}, {_braced(center, scalar)}}};"] if mass else []


def _matrix_lines(member: str, matrix: ArrayLike, scalar: str) -> list[str]:
    rows = (f"      {_braced(row, scalar)}," for row in np.asarray(matrix))
    return [f"{member} = fpbm::Matrix<3, 3, {scalar}>{{", *rows, "  };"]


def _joint_lines(member: str, joint: Joint, scalar: str) -> list[str]:
    lines = [
        f"{member}.name = {_literal(joint.name)};",
        f"{member}.type = fpbm::JointType::k{joint.type.capitalize()};",
        *_transform_lines(f"{member}.placement", joint.placement, scalar),
        f"{member}.axis = {_braced(joint.axis, scalar)};",
    ]
    bounds = [joint.lower, joint.upper, joint.velocity, joint.acceleration, joint.jerk]
    if joint.deceleration < inf:
        bounds += [joint.velocity_offset, joint.deceleration]
    if bounds != [-inf, inf, inf, inf, inf]:
        while bounds[-1] == inf:
            bounds.pop()
        lines.append(f"{member}.bounds = {_braced(bounds, scalar)};")
    if joint.effort < inf:
        lines.append(f"{member}.bounds.effort = {_number(joint.effort, scalar)};")
    if joint.mimic is not None:
        leader, *line = joint.mimic
        ratio, offset = (_number(x, scalar) for x in line)
        lines.append(f"{member}.mimic = {{{leader}, {ratio}, {offset}}};  // joint, ratio, offset")
    lines += _mass_lines(f"{member}.moved", joint.mass, joint.center, scalar)
    if np.any(joint.inertia):
        lines += _matrix_lines(f"{member}.moved.inertia", joint.inertia, scalar)
    drive = [joint.rotor_inertia, joint.damping, joint.friction]
    return [*lines, f"{member}.drive = {_braced(drive, scalar)};"] if any(drive) else lines


def _capsule_lines(capsules: Sequence[Capsule], scalar: str) -> str:
    each = "".join(
        f"      {{{c.link}, {{{_braced(c.a, scalar)}, {_braced(c.b, scalar)}, {_number(c.radius, scalar)}}}, "
        f"{_literal(c.name)}}},\n"
        for c in capsules
    )
    return f"""
/// Capsules on the links [m], in the frames of the chain's joints; link 0 is the base.
inline std::vector<fpbm::LinkCapsule<{scalar}>> capsules() {{
  return {{
{each}  }};
}}
"""


def _transform_lines(name: str, transform: ArrayLike, scalar: str) -> list[str]:
    """Assignments to the parts of a Transform that differ from its default."""
    T = np.asarray(transform, dtype=float)
    lines = []
    if np.any(T[:3, 3]):
        lines.append(f"{name}.p = {_braced(T[:3, 3], scalar)};")
    if not np.array_equal(T[:3, :3], np.eye(3)):
        lines += _matrix_lines(f"{name}.R", T[:3, :3], scalar)
    return lines


def _braced(numbers: ArrayLike, scalar: str) -> str:
    return f"{{{', '.join(_number(x, scalar) for x in np.asarray(numbers, dtype=float).tolist())}}}"


def _number(number: float, scalar: str) -> str:
    if abs(number) == inf:
        return "kNone" if number > 0 else "-kNone"
    return f"{float(number)!r}{'F' if scalar == 'float' else ''}"


def _literal(text: str) -> str:
    """A C++ string literal of the text in UTF-8; bytes beyond ASCII are written in octal."""
    special = {byte: f"\\{byte:c}" for byte in b'\\"?'}  # ? is escaped because ??/ was a trigraph for a backslash.
    escaped = (special.get(byte, f"{byte:c}" if 32 <= byte < 127 else f"\\{byte:03o}") for byte in text.encode())
    return '"' + "".join(escaped) + '"'
