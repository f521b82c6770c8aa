"""Chains of joints from URDF files.

A file is hostile until proven otherwise: one bounded pass over its XML takes the kinematics and leaves the rest, names
and numbers are checked, and only then does yourdfpy see it. What is wrong off the way from base to tip, but for its
names, numbers and tree, does not matter.
"""

from __future__ import annotations

import difflib
import io
import os
import warnings
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace
from graphlib import CycleError, TopologicalSorter
from math import inf
from typing import Any, NoReturn
from xml.etree import ElementTree
from xml.parsers import expat

import numpy as np

from ._core import MAX_DOF
from ._types import Array
from .joint import Joint

MAX_BYTES = 16 * 2**20
MAX_ELEMENTS = 50_000
MAX_DEPTH = 64
MAX_TEXT = 256  # characters of a name or of an attribute's numbers
TYPES = ("revolute", "continuous", "prismatic", "fixed")

# What a chain is made of; links with their masses and meshes, transmissions and simulators' extras are not read.
ELEMENTS = {"robot": ("link", "joint"), "joint": ("parent", "child", "origin", "axis", "limit", "mimic")}
NAMES = {"link": ("name",), "joint": ("name", "type"), "parent": ("link",), "child": ("link",), "mimic": ("joint",)}
NUMBERS = {
    "origin": {"xyz": 3, "rpy": 3},
    "axis": {"xyz": 3},
    "limit": {"lower": 1, "upper": 1, "velocity": 1},
    "mimic": {"multiplier": 1, "offset": 1},
}


def read_urdf(path: str | os.PathLike[str], tip: str, base: str | None = None) -> tuple[list[Joint], Array]:
    """Read the chain of joints between two links of a URDF file.

    Parameters
    ----------
    path
        The file. Meshes that it names are not looked for.
    tip : str
        Name of the link to move.
    base : str, optional
        Name of a link above it; the root unless given.

    Returns
    -------
    joints : list of Joint
        The joints that move, from base to tip, each placed as seen from the one before [m]; fixed joints are folded
        into the placements. A joint that mimics another has that one's index, ratio and offset, and that one's bounds
        are narrowed so that both stay within theirs.
    tip : numpy.ndarray, shape (4, 4)
        The tip's frame, seen from the last joint, at zero [m].

    Raises
    ------
    OSError
        Where the file cannot be read.
    ImportError
        Where yourdfpy is not installed.
    ValueError
        Where the file is not a URDF, is none that can be trusted, or has no such chain.
    """
    name = os.fsdecode(path)
    try:
        robot = _Sieve().robot(_read(name))
        _require_sound(robot)
        return _chain(_way(_tree(_parse(robot)), tip, base))
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def _read(path: str) -> bytes:
    with open(path, "rb") as file:
        xml = file.read(MAX_BYTES + 1)
    if len(xml) > MAX_BYTES:
        raise ValueError(f"has more than {MAX_BYTES >> 20} MiB")
    return xml


class _Sieve:
    """Takes the kinematics out of XML, in one pass that no file can make long."""

    def __init__(self) -> None:
        self._robot = ElementTree.Element("robot", name="robot")
        self._open: list[ElementTree.Element | None] = []  # None where what is inside is not read.
        self._count = 0
        self._parser = expat.ParserCreate()
        self._parser.StartDoctypeDeclHandler = self._doctype
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end

    def robot(self, xml: bytes) -> ElementTree.Element:
        """The robot with its links and joints, their names and numbers, and nothing else."""
        try:
            self._parser.Parse(xml, True)
        except expat.ExpatError as error:
            raise ValueError(f"line {error.lineno}: invalid XML: {expat.ErrorString(error.code)}") from None
        except LookupError as error:
            raise ValueError(f"line 1: invalid XML: {error}") from None
        return self._robot

    def _doctype(self, *_: object) -> None:
        self._refuse("has a DOCTYPE: must have none")

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self._count += 1
        if self._count > MAX_ELEMENTS:
            self._refuse(f"has more than {MAX_ELEMENTS} XML elements")
        if len(self._open) == MAX_DEPTH:
            self._refuse(f"XML elements are nested more than {MAX_DEPTH} deep")
        if tag.startswith("xacro:"):
            self._refuse(f"<{_cut(tag)}>: run xacro on the file first")
        self._open.append(self._kept(tag, attributes) if self._open else self._root(tag))

    def _end(self, _: str) -> None:
        self._open.pop()

    def _root(self, tag: str) -> ElementTree.Element:
        if tag != "robot":
            self._refuse(f"the root is <{_cut(tag)}>: must be <robot>")
        return self._robot

    def _kept(self, tag: str, attributes: dict[str, str]) -> ElementTree.Element | None:
        parent = self._open[-1]
        if parent is None or tag not in ELEMENTS.get(parent.tag, ()):
            return None
        wanted = (*NAMES.get(tag, ()), *NUMBERS.get(tag, ()))
        kept = {key: value for key, value in attributes.items() if key in wanted}
        for key, value in kept.items():
            if len(value) > MAX_TEXT:
                self._refuse(f"{tag} {key} = {_cut(value)!r} has {len(value)} characters: must have at most {MAX_TEXT}")
            if "${" in value:
                self._refuse(f"{tag} {key} = {_cut(value)!r}: run xacro on the file first")
        return ElementTree.SubElement(parent, tag, kept)

    def _refuse(self, reason: str) -> NoReturn:
        raise ValueError(f"line {self._parser.CurrentLineNumber}: {reason}")


def _cut(text: str) -> str:
    return text if len(text) <= 40 else text[:40] + "..."


def _require_sound(robot: ElementTree.Element) -> None:
    _require_names(robot, "link")
    _require_names(robot, "joint")
    for joint in robot.findall("joint"):
        _require_parts(joint)


def _require_names(robot: ElementTree.Element, tag: str) -> None:
    names: set[str] = set()
    for i, element in enumerate(robot.findall(tag), 1):
        name = element.get("name")
        if not name:
            raise ValueError(f"<{tag}> number {i} has no name")
        if name in names:
            raise ValueError(f"two {tag}s are named {name!r}")
        names.add(name)


def _require_parts(joint: ElementTree.Element) -> None:
    """Refuse a joint that lacks what it hangs on, has a part twice, or a number that is none."""
    name = f"joint {joint.get('name')!r}"
    for tag, count in Counter(part.tag for part in joint).items():
        if count > 1:
            raise ValueError(f"{name} has {count} <{tag}>: must have one")
    for tag, key in (("parent", "link"), ("child", "link"), ("mimic", "joint")):
        part = joint.find(tag)
        if not (tag == "mimic" if part is None else part.get(key)):
            raise ValueError(f'{name} has no <{tag} {key}="...">')
    for part in joint:
        for key, count in NUMBERS.get(part.tag, {}).items():
            value = part.get(key)
            if value is not None and not _are_numbers(value.split(), count):
                raise ValueError(
                    f"{name}: {part.tag} {key} = {value!r}: must be {count} finite number{'s' * (count > 1)}"
                )


def _are_numbers(words: list[str], count: int) -> bool:
    def is_number(word: str) -> bool:
        try:
            # No robot has numbers beyond 1e100, and no product of theirs overflows.
            return abs(float(word)) < 1e100 and word.isascii() and "_" not in word
        except ValueError:
            return False

    return len(words) == count and all(map(is_number, words))


def _parse(robot: ElementTree.Element) -> Any:
    """The yourdfpy.Robot."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            import yourdfpy
        except ImportError:
            raise ImportError('reading URDF needs yourdfpy: pip install "fpbm_cpp[urdf]"') from None
        try:
            xml = io.BytesIO(ElementTree.tostring(robot))
            return yourdfpy.URDF.load(xml, build_scene_graph=False, load_meshes=False).robot
        except Exception as error:
            raise ValueError(f"yourdfpy cannot read it: {error}") from None


def _tree(robot: Any) -> dict[str, Any]:
    """The joint above each link, None above the root."""
    above = dict.fromkeys(link.name for link in robot.links)
    for joint in robot.joints:
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in above:
                raise ValueError(f"joint {joint.name!r}: {role} link {link!r} does not exist")
        other = above[joint.child]
        if other is not None:
            raise ValueError(f"link {joint.child!r} is the child of two joints, {other.name!r} and {joint.name!r}")
        above[joint.child] = joint
    _refuse_loop("its links", {link: joint.parent for link, joint in above.items() if joint})
    roots = [link for link, joint in above.items() if joint is None]
    if len(roots) != 1:
        raise ValueError(f"links that are no joint's child: {_listed(roots)}: must be one, the root")
    return above


def _refuse_loop(what: str, successor: Mapping[str, str]) -> None:
    try:
        TopologicalSorter({name: (after,) for name, after in successor.items()}).prepare()
    except CycleError as error:
        raise ValueError(f"{what} form a loop: {_listed(error.args[1])}") from None


def _listed(names: Iterable[str]) -> str:
    shown = list(map(repr, names))
    more = [f"{len(shown) - 12} more"] if len(shown) > 12 else []
    return ", ".join(shown[:12] + more) or "none"


def _way(above: Mapping[str, Any], tip: str, base: str | None) -> list[Any]:
    """The joints from base to tip."""
    _require_link(above, "tip", tip)
    if base is not None:
        _require_link(above, "base", base)
    up = _to_root(above, tip)
    links = [tip, *(joint.parent for joint in up)]
    if base is None:
        base = links[-1]
    if base not in links:
        others = {base, *(joint.parent for joint in _to_root(above, base))}
        fork = next(link for link in links if link in others)
        raise ValueError(
            f"tip {tip!r} is not below base {base!r}, they have {fork!r} in common: "
            f"base must lie between the root {links[-1]!r} and the tip"
        )
    way = up[: links.index(base)][::-1]
    count = sum(joint.type != "fixed" for joint in way)
    if not 1 <= count <= MAX_DOF:
        raise ValueError(f"{count or 'no'} joints move between base {base!r} and tip {tip!r}: must be 1 to {MAX_DOF}")
    return way


def _require_link(above: Mapping[str, Any], role: str, link: str) -> None:
    if link in above:
        return
    parents = {joint.parent for joint in above.values() if joint}
    leaves = _listed(sorted((name for name in above if name not in parents), key=lambda name: -_moving(above, name)))
    close = difflib.get_close_matches(str(link), list(above)[:300])  # Of thousands it would take long.
    hint = f", perhaps {' or '.join(map(repr, close))}" if close else ""
    raise ValueError(f"{role} = {link!r}: must be a link{hint}; its branches end in {leaves}")


def _moving(above: Mapping[str, Any], link: str) -> int:
    """How many joints move between the root and a link."""
    return sum(joint.type != "fixed" for joint in _to_root(above, link))


def _to_root(above: Mapping[str, Any], link: str) -> list[Any]:
    joints = []
    joint = above[link]
    while joint is not None:
        joints.append(joint)
        joint = above[joint.parent]
    return joints


def _chain(way: list[Any]) -> tuple[list[Joint], Array]:
    joints: list[Joint] = []
    frame = np.eye(4)
    for joint in way:
        if joint.type not in TYPES:
            raise ValueError(f"joint {joint.name!r}: type = {joint.type!r}: must be {', '.join(TYPES[:-1])} or fixed")
        if joint.origin is not None:
            frame = frame @ joint.origin
        if joint.type != "fixed":
            joints.append(_joint(joint, frame))
            frame = np.eye(4)
    return _coupled(joints, {joint.name: joint.mimic for joint in way if joint.type != "fixed"}), frame


def _joint(joint: Any, placement: Array) -> Joint:
    if not np.any(joint.axis):
        raise ValueError(f"joint {joint.name!r}: axis = 0 0 0: must point somewhere")
    limit = joint.limit
    if joint.type == "continuous":
        velocity = inf if limit is None or limit.velocity is None else limit.velocity
        lower, upper = -inf, inf
    else:
        if limit is None or limit.velocity is None:
            raise ValueError(f"joint {joint.name!r} is {joint.type} and has no <limit> with a velocity")
        velocity = limit.velocity
        lower, upper = limit.lower or 0.0, limit.upper or 0.0  # URDF's defaults.
    if lower >= upper:
        raise ValueError(f"joint {joint.name!r}: lower = {lower:g}: must be below upper = {upper:g}")
    if velocity <= 0.0:
        raise ValueError(f"joint {joint.name!r}: velocity = {velocity:g}: must be positive")
    return Joint(joint.type, placement, joint.axis, lower, upper, velocity, name=joint.name)


def _coupled(joints: list[Joint], mimics: Mapping[str, Any]) -> list[Joint]:
    """The joints with their mimics: each follows one that follows none, whose bounds hold for both."""
    coupled = list(joints)
    index = {joint.name: i for i, joint in enumerate(joints)}
    for name, mimic in mimics.items():
        if mimic is not None and mimic.joint not in index:
            raise ValueError(f"joint {name!r} mimics {mimic.joint!r}: must mimic one that moves between base and tip")
    _refuse_loop("mimics", {name: mimic.joint for name, mimic in mimics.items() if mimic})
    for i, follower in enumerate(joints):
        master, ratio, offset = follower.name, 1.0, 0.0
        while (mimic := mimics[master]) is not None:
            master, ratio, offset = mimic.joint, ratio * mimic.multiplier, offset + ratio * mimic.offset
        if master == follower.name:
            continue
        if not 0.0 < abs(ratio) < inf:
            raise ValueError(f"joint {follower.name!r} mimics {master!r} by {ratio:g}: must be finite and not zero")
        coupled[i] = replace(follower, mimic=(index[master], ratio, offset))
        coupled[index[master]] = _narrowed(coupled[index[master]], follower, ratio, offset)
    return coupled


def _narrowed(master: Joint, follower: Joint, ratio: float, offset: float) -> Joint:
    """The master, bounded so that ratio times its position plus offset is within the follower's bounds."""
    ends = sorted(((follower.lower - offset) / ratio, (follower.upper - offset) / ratio))
    lower, upper = max(master.lower, ends[0]), min(master.upper, ends[1])
    if lower >= upper:
        raise ValueError(
            f"joint {master.name!r}: those that mimic it leave it no room: lower = {lower:g}, upper = {upper:g}"
        )
    bounded = "revolute" if master.type == "continuous" and upper < inf else master.type
    velocity = min(master.velocity, follower.velocity / abs(ratio))
    return replace(master, type=bounded, lower=lower, upper=upper, velocity=velocity)
