"""The links and joints of a URDF file.

A file may come from anywhere: one bounded pass over its XML, which expands no entity and opens no other file, keeps
what a chain is made of. Meshes, masses, transmissions and simulators' extras are not read.
"""

from dataclasses import dataclass
from xml.parsers import expat

MAX_BYTES = 16 * 2**20
MAX_ELEMENTS = 50_000
MAX_DEPTH = 64
MAX_TEXT = 256  # Characters of an attribute.

# The attributes that are read, by the elements that they are in.
LIMITS = ("lower", "upper", "velocity", "acceleration", "jerk")
ENVELOPE = ("velocity_offset", "deceleration_limit")  # Of a Franka: a bound on velocity that depends on position.
KEPT: dict[tuple[str, ...], dict[str, tuple[str, ...]]] = {
    ("robot",): {"link": ("name",), "joint": ("name", "type")},
    ("robot", "joint"): {
        "parent": ("link",),
        "child": ("link",),
        "origin": ("xyz", "rpy"),
        "axis": ("xyz",),
        "limit": LIMITS,
        "position_based_velocity_limits": ENVELOPE,
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
    envelope: dict[str, float]  # What is stated of ENVELOPE.
    mimic: tuple[str, float, float] | None  # Another joint, multiplier, offset.


def read_robot(path: str) -> tuple[list[str], list[UrdfJoint]]:
    """Read the names of the links, and the joints; a ValueError says what is wrong with the file."""
    with open(path, "rb") as file:
        xml = file.read(MAX_BYTES + 1)
    if len(xml) > MAX_BYTES:
        raise ValueError(f"has more than {MAX_BYTES >> 20} MiB")
    parser = expat.ParserCreate()
    robot: dict[str, list[Parts]] = {"link": [], "joint": []}
    opened: list[str] = []
    count = 0

    def require(sound: object, reason: str) -> None:
        if not sound:
            raise ValueError(f"line {parser.CurrentLineNumber}: {reason}")

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        require(count <= MAX_ELEMENTS, f"has more than {MAX_ELEMENTS} XML elements")
        require(len(opened) < MAX_DEPTH, f"XML elements are nested more than {MAX_DEPTH} deep")
        require(not tag.startswith("xacro:"), f"<{_cut(tag)}>: run xacro on the file first")
        require(opened or tag == "robot", f"the root is <{_cut(tag)}>: must be <robot>")
        keys = KEPT.get(tuple(opened), {}).get(tag, ())
        kept = {key: attributes[key] for key in keys if key in attributes}
        for key, text in kept.items():
            what = f"{tag} {key} = {_cut(text)!r}"
            require(len(text) <= MAX_TEXT, f"{what} has {len(text)} characters: must have at most {MAX_TEXT}")
            require("${" not in text, f"{what}: run xacro on the file first")
        opened.append(tag)
        if tag in robot and keys:
            robot[tag].append({tag: kept})
        elif keys:
            parts = robot["joint"][-1]
            require(tag not in parts, f"joint {parts['joint'].get('name')!r} has a second <{tag}>: must have one")
            parts[tag] = kept

    parser.StartDoctypeDeclHandler = lambda *_: require(False, "has a DOCTYPE: must have none")
    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: opened.pop()
    try:
        parser.Parse(xml, True)
    except expat.ExpatError as error:
        raise ValueError(f"line {error.lineno}: invalid XML: {expat.ErrorString(error.code)}") from None
    except LookupError as error:
        raise ValueError(f"line 1: invalid XML: {error}") from None
    links, joints = _named("link", robot["link"]), _named("joint", robot["joint"])
    return list(links), [_joint(name, parts) for name, parts in joints.items()]


def _cut(text: str) -> str:
    return text if len(text) <= 40 else text[:40] + "..."


def _named(tag: str, elements: list[Parts]) -> dict[str, Parts]:
    named: dict[str, Parts] = {}
    for i, parts in enumerate(elements, 1):
        name = parts[tag].get("name")
        if not name:
            raise ValueError(f"<{tag}> number {i} has no name")
        if name in named:
            raise ValueError(f"two {tag}s are named {name!r}")
        named[name] = parts
    return named


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

    kind, parent, child = parts["joint"].get("type"), required("parent", "link"), required("child", "link")
    xyz, rpy = (numbers("origin", key, [0.0, 0.0, 0.0]) for key in ("xyz", "rpy"))
    axis = numbers("axis", "xyz", [1.0, 0.0, 0.0])
    limit = {key: numbers("limit", key, [0.0])[0] for key in LIMITS if key in parts.get("limit", {})}
    tag = "position_based_velocity_limits"
    envelope = {key: numbers(tag, key, [0.0])[0] for key in ENVELOPE if key in parts.get(tag, {})}
    mimic = None
    if "mimic" in parts:
        (multiplier,), (offset,) = numbers("mimic", "multiplier", [1.0]), numbers("mimic", "offset", [0.0])
        mimic = (required("mimic", "joint"), multiplier, offset)
    return UrdfJoint(name, kind, parent, child, xyz, rpy, axis, limit, envelope, mimic)
