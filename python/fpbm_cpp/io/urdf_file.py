"""The links and joints of a URDF file.

A file may come from anywhere: one bounded pass over its XML, which expands no entity and opens no other file, keeps
what a chain is made of. Meshes, masses, transmissions and simulators' extras are not read.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NoReturn
from xml.parsers import expat

MAX_BYTES = 16 * 2**20
MAX_ELEMENTS = 50_000
MAX_DEPTH = 64
MAX_TEXT = 256  # Characters of an attribute.

# The attributes that are read, by the elements that they are in.
LIMITS = ("lower", "upper", "velocity", "acceleration")
KEPT: dict[tuple[str, ...], dict[str, tuple[str, ...]]] = {
    ("robot",): {"link": ("name",), "joint": ("name", "type")},
    ("robot", "joint"): {
        "parent": ("link",),
        "child": ("link",),
        "origin": ("xyz", "rpy"),
        "axis": ("xyz",),
        "limit": LIMITS,
        "mimic": ("joint", "multiplier", "offset"),
    },
}
Parts = dict[str, dict[str, str]]  # An element's own attributes, and those of what is in it.


@dataclass(frozen=True)
class UrdfJoint:
    """A joint as a URDF states it, with the format's defaults for what it leaves out."""

    name: str
    type: str | None
    parent: str
    child: str
    xyz: list[float]
    rpy: list[float]
    axis: list[float]
    limit: dict[str, float]  # What is stated of LIMITS.
    mimic: tuple[str, float, float] | None  # Another joint, multiplier, offset.


def read_robot(path: str) -> tuple[list[str], list[UrdfJoint]]:
    """Read the names of the links, and the joints; a ValueError says what is wrong with the file."""
    with open(path, "rb") as file:
        xml = file.read(MAX_BYTES + 1)
    if len(xml) > MAX_BYTES:
        raise ValueError(f"has more than {MAX_BYTES >> 20} MiB")
    scanner = _Scanner()
    try:
        scanner.parser.Parse(xml, True)
    except expat.ExpatError as error:
        raise ValueError(f"line {error.lineno}: invalid XML: {expat.ErrorString(error.code)}") from None
    except LookupError as error:
        raise ValueError(f"line 1: invalid XML: {error}") from None
    links, joints = scanner.elements["link"], scanner.elements["joint"]
    return _names("link", links), [_joint(name, parts) for name, parts in zip(_names("joint", joints), joints)]


class _Scanner:
    def __init__(self) -> None:
        self.elements: dict[str, list[Parts]] = {"link": [], "joint": []}
        self.parser = expat.ParserCreate()
        self.parser.StartDoctypeDeclHandler = lambda *_: self._refuse("has a DOCTYPE: must have none")
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = lambda _: self._open.pop()
        self._open: list[str] = []
        self._count = 0

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self._count += 1
        if self._count > MAX_ELEMENTS:
            self._refuse(f"has more than {MAX_ELEMENTS} XML elements")
        if len(self._open) == MAX_DEPTH:
            self._refuse(f"XML elements are nested more than {MAX_DEPTH} deep")
        if tag.startswith("xacro:"):
            self._refuse(f"<{_cut(tag)}>: run xacro on the file first")
        if not self._open and tag != "robot":
            self._refuse(f"the root is <{_cut(tag)}>: must be <robot>")
        keys = KEPT.get(tuple(self._open[:3]), {}).get(tag, ())
        if keys:
            self._keep(tag, {key: attributes[key] for key in keys if key in attributes})
        self._open.append(tag)

    def _keep(self, tag: str, attributes: dict[str, str]) -> None:
        for key, text in attributes.items():
            if len(text) > MAX_TEXT:
                self._refuse(f"{tag} {key} = {_cut(text)!r} has {len(text)} characters: must have at most {MAX_TEXT}")
            if "${" in text:
                self._refuse(f"{tag} {key} = {_cut(text)!r}: run xacro on the file first")
        if tag in self.elements:
            self.elements[tag].append({tag: attributes})
            return
        parts = self.elements["joint"][-1]
        if tag in parts:
            self._refuse(f"joint {parts['joint'].get('name')!r} has a second <{tag}>: must have one")
        parts[tag] = attributes

    def _refuse(self, reason: str) -> NoReturn:
        raise ValueError(f"line {self.parser.CurrentLineNumber}: {reason}")


def _cut(text: str) -> str:
    return text if len(text) <= 40 else text[:40] + "..."


def _names(tag: str, elements: Iterable[Parts]) -> list[str]:
    names: dict[str, None] = {}
    for i, parts in enumerate(elements, 1):
        name = parts[tag].get("name")
        if not name:
            raise ValueError(f"<{tag}> number {i} has no name")
        if name in names:
            raise ValueError(f"two {tag}s are named {name!r}")
        names[name] = None
    return list(names)


def _joint(name: str, parts: Parts) -> UrdfJoint:
    def required(tag: str, key: str) -> str:
        text = parts.get(tag, {}).get(key)
        if not text:
            raise ValueError(f'joint {name!r} has no <{tag} {key}="...">')
        return text

    def numbers(tag: str, key: str, default: list[float]) -> list[float]:
        text = parts.get(tag, {}).get(key)
        if text is None:
            return default
        try:
            # Python also reads 1_000 and the digits of other scripts.
            found = [float(word) for word in text.split()] if text.isascii() and "_" not in text else []
        except ValueError:
            found = []
        # No robot has numbers beyond 1e100, and products of smaller ones do not overflow.
        if len(found) != len(default) or not all(abs(number) < 1e100 for number in found):
            wanted = f"{len(default)} finite number{'s' * (len(default) > 1)}"
            raise ValueError(f"joint {name!r}: {tag} {key} = {text!r}: must be {wanted}")
        return found

    mimic = None
    if "mimic" in parts:
        (multiplier,), (offset,) = numbers("mimic", "multiplier", [1.0]), numbers("mimic", "offset", [0.0])
        mimic = (required("mimic", "joint"), multiplier, offset)
    return UrdfJoint(
        name,
        parts["joint"].get("type"),
        required("parent", "link"),
        required("child", "link"),
        numbers("origin", "xyz", [0.0, 0.0, 0.0]),
        numbers("origin", "rpy", [0.0, 0.0, 0.0]),
        numbers("axis", "xyz", [1.0, 0.0, 0.0]),
        {key: numbers("limit", key, [0.0])[0] for key in LIMITS if key in parts.get("limit", {})},
        mimic,
    )
