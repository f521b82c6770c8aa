"""The links and joints of a URDF file.

Meshes, transmissions and extensions for simulators are not read; inertias are read on request.
"""

from dataclasses import dataclass

import numpy as np

from ..inertia import Inertia
from .place import pose
from .xml_file import Element, Kept, named, read_xml

# Attributes that are read, by their elements.
LIMITS = ("lower", "upper", "velocity", "acceleration", "jerk", "effort")
DYNAMICS = ("damping", "friction")
ENVELOPE = ("velocity_offset", "deceleration_limit")  # Franka's element: bound on velocity as a function of position.
KEPT: Kept = {
    ("robot",): {"link": ("name",), "joint": ("name", "type")},
    ("robot", "joint"): {
        "parent": ("link",),
        "child": ("link",),
        "origin": ("xyz", "rpy"),
        "axis": ("xyz",),
        "limit": LIMITS,
        "dynamics": DYNAMICS,
        "position_based_velocity_limits": ENVELOPE,
        "mimic": ("joint", "multiplier", "offset"),
    },
}
MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
INERTIALS: Kept = {
    **KEPT,
    ("robot", "link"): {"inertial": ()},
    ("robot", "link", "inertial"): {"origin": ("xyz", "rpy"), "mass": ("value",), "inertia": MOMENTS},
}


@dataclass(frozen=True)
class UrdfJoint:
    """A joint of a URDF file, with the defaults of the format."""

    name: str
    type: str | None
    parent: str
    child: str
    xyz: list[float]
    rpy: list[float]
    axis: list[float]
    limit: dict[str, float]  # Given attributes of LIMITS.
    friction: dict[str, float]  # Given attributes of DYNAMICS.
    envelope: dict[str, float]  # Given attributes of ENVELOPE.
    mimic: tuple[str, float, float] | None  # Leader, multiplier, offset.


def read_robot(path: str, kept: Kept = KEPT) -> tuple[list[str], list[UrdfJoint], dict[str, Element]]:
    """Read the names of the links, the joints, and if INERTIALS are kept, the <inertial> of the links that have one.

    Raises ValueError if the file is invalid.
    """
    robot = read_xml(path, kept)
    for joint in robot.all("joint"):
        joint.require_one_each(f"joint {joint.attributes.get('name')!r}")
    links = named(robot.all("link"))
    joints = [_joint(name, element) for name, element in named(robot.all("joint")).items()]
    inertials = {name: each for name, link in links.items() for each in link.all("inertial")[:1]}
    return list(links), joints, inertials


def inertia_of(link: str, inertial: Element) -> Inertia:
    """Inertia of a link in the frame of the link. Raises ValueError if a number is invalid or the mass negative."""
    owner = f"link {link!r}"
    (mass,) = inertial.numbers("mass", "value", [0.0], owner)
    if mass < 0.0:
        raise ValueError(f"{owner}: mass = {mass:g}: must not be negative")
    xyz, rpy = (inertial.numbers("origin", key, [0.0, 0.0, 0.0], owner) for key in ("xyz", "rpy"))
    xx, xy, xz, yy, yz, zz = (inertial.numbers("inertia", key, [0.0], owner)[0] for key in MOMENTS)
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if not any(rpy):
        return Inertia(mass, np.array(xyz), inertia)
    return Inertia(mass, np.zeros(3), inertia).moved(pose(xyz, rpy))


def _joint(name: str, joint: Element) -> UrdfJoint:
    def required(tag: str, key: str) -> str:
        text = joint.get(tag, key)
        if not text:
            raise ValueError(f'joint {name!r} has no <{tag} {key}="...">')
        return text

    def numbers(tag: str, key: str, default: list[float]) -> list[float]:
        return joint.numbers(tag, key, default, f"joint {name!r}")

    kind, parent, child = joint.attributes.get("type"), required("parent", "link"), required("child", "link")
    xyz, rpy = (numbers("origin", key, [0.0, 0.0, 0.0]) for key in ("xyz", "rpy"))
    axis = numbers("axis", "xyz", [1.0, 0.0, 0.0])
    limit = {key: numbers("limit", key, [0.0])[0] for key in LIMITS if joint.get("limit", key) is not None}
    friction = {key: numbers("dynamics", key, [0.0])[0] for key in DYNAMICS if joint.get("dynamics", key) is not None}
    tag = "position_based_velocity_limits"
    envelope = {key: numbers(tag, key, [0.0])[0] for key in ENVELOPE if joint.get(tag, key) is not None}
    mimic = None
    if joint.all("mimic"):
        (multiplier,), (offset,) = numbers("mimic", "multiplier", [1.0]), numbers("mimic", "offset", [0.0])
        mimic = (required("mimic", "joint"), multiplier, offset)
    return UrdfJoint(name, kind, parent, child, xyz, rpy, axis, limit, friction, envelope, mimic)
