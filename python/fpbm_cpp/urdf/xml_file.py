"""XML files of robots.

Files are not trusted: one bounded pass expands no entity, opens no other file, and keeps the requested elements only.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from xml.parsers import expat

from ..errors import ParameterError, wrong

MAX_BYTES = 16 * 2**20
MAX_ELEMENTS = 50_000
MAX_DEPTH = 64
MAX_TEXT = 256  # Largest number of characters of an attribute.

# Kept elements of a file and their kept attributes, by the enclosing elements.
Kept = Mapping[tuple[str, ...], Mapping[str, tuple[str, ...]]]


@dataclass
class Element:
    """An element, its kept attributes, and its kept child elements."""

    tag: str
    line: int
    attributes: dict[str, str]
    parts: list[Element] = field(default_factory=list)

    def all(self, tag: str) -> list[Element]:
        return [part for part in self.parts if part.tag == tag]

    def get(self, tag: str, key: str) -> str | None:
        """An attribute of the first part with this tag; None if there is none."""
        return next((part.attributes.get(key) for part in self.parts if part.tag == tag), None)

    def require_one_each(self, owner: str) -> None:
        """Raise ValueError if two parts have the same tag."""
        seen: set[str] = set()
        for part in self.parts:
            if part.tag in seen:
                raise ValueError(f"line {part.line}: {owner} has a second <{part.tag}>: must have one")
            seen.add(part.tag)

    def numbers(self, tag: str, key: str, default: list[float], owner: str) -> list[float]:
        """Numbers in an attribute of the first part with this tag."""
        part = next((part for part in self.parts if part.tag == tag), Element(tag, self.line, {}))
        return part.own_numbers(key, default, owner)

    def own_numbers(self, key: str, default: list[float], owner: str) -> list[float]:
        """As many finite numbers as in the default, which applies if the attribute is missing."""
        text = self.attributes.get(key)
        if text is None:
            return default
        try:
            # float() also accepts 1_000 and the digits of other scripts.
            found = [float(word) for word in text.split()] if text.isascii() and "_" not in text else []
        except ValueError:
            found = []
        # No robot has numbers beyond 1e100, and products of smaller numbers do not overflow.
        if len(found) != len(default) or not all(abs(number) < 1e100 for number in found):
            required = f"{len(default)} finite number{'s' * (len(default) > 1)}"
            raise ValueError(f"{owner}: {self.tag} {key} = {text!r}: must be {required}")
        return found


def read_xml(path: str | os.PathLike[str], kept: Kept) -> Element:
    """Read the kept elements of a file whose root is <robot>. Raises ValueError if the file is invalid."""
    if isinstance(path, str) and path.lstrip().startswith("<"):
        problem = f" = {cut(path.lstrip())!r}: must be the name of a file, not XML text: write the text to a file"
        raise wrong("path", path, problem)
    with open(path, "rb") as file:
        xml = file.read(MAX_BYTES + 1)
    if len(xml) > MAX_BYTES:
        raise ValueError(f"has more than {MAX_BYTES >> 20} MiB: must be the URDF or SRDF file of a robot")
    parser = expat.ParserCreate()
    opened: list[Element] = []
    root = Element("robot", 1, {})
    count = 0

    def reject(reason: str) -> None:
        raise ValueError(f"line {parser.CurrentLineNumber}: {reason}")

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > MAX_ELEMENTS:
            reject(f"has more than {MAX_ELEMENTS} XML elements: must be the URDF or SRDF file of a robot")
        if len(opened) >= MAX_DEPTH:
            reject(f"XML elements are nested more than {MAX_DEPTH} deep: must be a URDF or SRDF file")
        if tag.startswith("xacro:"):
            reject(f"<{cut(tag)}>: run xacro on the file first")
        if not opened and tag != "robot":
            reject(f"the root is <{cut(tag)}>: must be <robot>, as in a URDF or SRDF file")
        here = kept.get(tuple([element.tag for element in opened]), {})
        own = {key: attributes[key] for key in here.get(tag, ()) if key in attributes}
        for key, text in own.items():
            if len(text) > MAX_TEXT:
                has = f"has {len(text)} characters: must have at most {MAX_TEXT}"
                reject(f"{tag} {key} = {cut(text)!r} {has}")
            if "${" in text:
                reject(f"{tag} {key} = {cut(text)!r}: run xacro on the file first")
        element = Element(tag, parser.CurrentLineNumber, own) if opened else root
        if tag in here:
            opened[-1].parts.append(element)
        opened.append(element)

    parser.StartDoctypeDeclHandler = lambda *_: reject("has a DOCTYPE: must have none")
    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: opened.pop()
    try:
        parser.Parse(xml, True)
    except expat.ExpatError as error:
        raise ValueError(f"line {error.lineno}: invalid XML: {expat.ErrorString(error.code)}") from None
    except LookupError as error:
        raise ValueError(f"line 1: invalid XML: {error}") from None
    return root


@contextmanager
def errors_of(path: str | os.PathLike[str] | None, remedy: str = "") -> Iterator[None]:
    """Add the name of a file before the message of a ValueError, and a remedy after the message."""
    try:
        yield
    except ParameterError:
        raise
    except ValueError as error:
        raise ValueError(f"{f'{os.fsdecode(path)}: ' if path else ''}{error}{remedy}") from None


def cut(text: str) -> str:
    return text if len(text) <= 40 else text[:40] + "..."


def named(elements: Iterable[Element]) -> dict[str, Element]:
    """Elements of one tag by name; each must have a unique name."""
    found: dict[str, Element] = {}
    for i, element in enumerate(elements, 1):
        name = element.attributes.get("name")
        if not name:
            raise ValueError(f"<{element.tag}> number {i} has no name")
        if name in found:
            raise ValueError(f"two {element.tag}s are named {name!r}: names must be unique: rename one")
        found[name] = element
    return found
