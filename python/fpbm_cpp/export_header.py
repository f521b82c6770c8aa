"""Arms as C++ headers, for programs that read no files."""

from __future__ import annotations

import re
from collections.abc import Sequence
from math import inf

import numpy as np
from numpy.typing import ArrayLike

from .joint import Joint

TYPES = {"revolute": "kRevolute", "continuous": "kContinuous", "prismatic": "kPrismatic"}

# No names for a namespace: C++'s keywords, and whose namespaces these are.
TAKEN = """alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t char32_t class
co_await co_return co_yield compl concept const consteval constexpr constinit const_cast continue decltype default
delete do double dynamic_cast else enum explicit export extern false float for friend goto if inline int long mutable
namespace new noexcept not not_eq nullptr operator or or_eq private protected public register reinterpret_cast requires
return short signed sizeof static static_assert static_cast struct switch template this thread_local throw true try
typedef typeid typename union unsigned using virtual void volatile wchar_t while xor xor_eq Eigen fpbm std"""


def export_header(joints: Sequence[Joint], tip: ArrayLike, *, name: str, source: str = "") -> str:
    """Write a C++ header that constructs an arm, with neither parser nor file when the program runs.

    The numbers are these to the last bit. The header needs this library's headers alone.

    Parameters
    ----------
    joints
        The joints from base to tip. Where one mimics another the arm is an fpbm::CoupledArm, else an fpbm::SerialArm.
    tip : array_like, shape (4, 4)
        The tip's frame, seen from the last joint [m].
    name : str
        The namespace, 'my_arm' or 'my::arm'.
    source : str
        What the arm was read from, for a comment.

    Returns
    -------
    str
        The header: kDof, kJointNames, chain() and arm() in the namespace.

    Raises
    ------
    ValueError
        Where a namespace cannot have that name.
    """
    if not all(_is_identifier(part) for part in name.split("::")):
        raise ValueError(f"name = {name!r}: must be a C++ identifier that is not taken")
    drives = [joint.name or f"joint_{i}" for i, joint in enumerate(joints, 1) if joint.mimic is None]
    kind = "SerialArm" if len(drives) == len(joints) else "CoupledArm"
    parts = [_joint_lines(i, joint) for i, joint in enumerate(joints)] + [_transform_lines("  chain.tip", tip)]
    chain = "\n\n".join("\n".join(lines) for lines in parts if lines)
    none = "  constexpr double kNone = fpbm::JointBounds<>::kNone;\n" if "kNone" in chain else ""
    origin = f" from {_printable(source)}" if source else ""
    return f"""\
// Written by fpbm-cpp export-header{origin}. Regenerate rather than edit.
#pragma once

#include <array>
#include <fpbm/model/{"serial_arm" if kind == "SerialArm" else "coupled_arm"}.hpp>

namespace {name} {{

inline constexpr int kDof = {len(drives)};

inline constexpr std::array<const char*, kDof> kJointNames = {{
{_names(drives)}
}};

/// The joints from base to tip, each placed as seen from the one before [m].
/// Bounds are lower and upper [rad] or [m], velocity, acceleration; those left out are none.
inline fpbm::Chain<> chain() {{
{none}  fpbm::Chain<> chain;
  chain.joints.resize({len(joints)});

{chain}

  return chain;
}}

inline fpbm::{kind}<kDof> arm() {{
  return fpbm::{kind}<kDof>(chain());
}}

}}  // namespace {name}
"""


def namespace_of(stem: str) -> str:
    """A namespace after a file's name without suffix: '04-my arm' gives 'my_arm'."""
    name = re.sub(r"[^A-Za-z0-9]+", "_", stem).lstrip("_0123456789").rstrip("_") or "arm"
    return f"{name}_arm" if name in TAKEN.split() else name


def _names(drives: Sequence[str]) -> str:
    literals = [f"{_literal(name)}," for name in drives]
    width = max(map(len, literals), default=0)
    return "\n".join(f"    {literal:{width}}  // q({i})" for i, literal in enumerate(literals))


def _is_identifier(name: str) -> bool:
    # Names with two underscores in a row, or one ahead, are the compiler's.
    return re.fullmatch(r"[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*_?", name) is not None and name not in TAKEN.split()


def _joint_lines(i: int, joint: Joint) -> list[str]:
    it = f"  chain.joints[{i}]"
    lines = [
        f"{it}.name = {_literal(joint.name)};",
        f"{it}.type = fpbm::JointType::{TYPES[joint.type]};",
        *_transform_lines(f"{it}.placement", joint.placement),
        f"{it}.axis = {_braced(joint.axis)};",
    ]
    bounds = [joint.lower, joint.upper, joint.velocity, joint.acceleration]
    if bounds != [-inf, inf, inf, inf]:
        while bounds[-1] == inf:
            bounds.pop()
        lines.append(f"{it}.bounds = {_braced(bounds)};")
    if joint.mimic is not None:
        master, ratio, offset = joint.mimic
        lines.append(f"{it}.mimic = {{{master}, {_number(ratio)}, {_number(offset)}}};  // joint, ratio, offset")
    return lines


def _transform_lines(name: str, transform: ArrayLike) -> list[str]:
    """Assignments to what of a Transform is not as it is by default."""
    T = np.asarray(transform, dtype=float)
    lines = []
    if np.any(T[:3, 3]):
        lines.append(f"{name}.p = {_braced(T[:3, 3])};")
    if not np.array_equal(T[:3, :3], np.eye(3)):
        rows = (f"      {_braced(row)}," for row in T[:3, :3])
        lines += [f"{name}.R = fpbm::Matrix<3, 3>{{", *rows, "  };"]
    return lines


def _braced(numbers: ArrayLike) -> str:
    return "{" + ", ".join(map(_number, np.asarray(numbers, dtype=float))) + "}"


def _number(value: float) -> str:
    return repr(float(value)).replace("inf", "kNone")


def _literal(text: str) -> str:
    """A C++ string literal of the text in UTF-8, in ASCII: in octal what is not."""

    def escaped(byte: int) -> str:
        if not 32 <= byte < 127:
            return f"\\{byte:03o}"
        return f"\\{byte:c}" if byte in b'\\"?' else f"{byte:c}"  # ?, since ??/ was once a backslash.

    return '"' + "".join(map(escaped, text.encode())) + '"'


def _printable(text: str) -> str:
    return "".join(c if c.isprintable() else "?" for c in text)
