"""The links and joints of a URDF file.

Meshes, transmissions and extensions for simulators are not read; masses are read on request.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .._types import Array
from .xml_file import Element, Kept, named, read_xml

# Attributes that are read, by their elements.
LIMITS = ("lower", "upper", "velocity", "acceleration", "jerk")
ENVELOPE = ("velocity_offset", "deceleration_limit")  # Franka's element: bound on velocity as a function of position.
KEPT: Kept = {
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
INERTIALS: Kept = {
    **KEPT,
    ("robot", "link"): {"inertial": ()},
    ("robot", "link", "inertial"): {"origin": ("xyz",), "mass": ("value",)},
}


class Mass(NamedTuple):
    """Mass of a link [kg], and its centre in the link's frame [m]."""

    mass: float
    center: Array


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
    envelope: dict[str, float]  # Given attributes of ENVELOPE.
    mimic: tuple[str, float, float] | None  # Leader, multiplier, offset.


def read_robot(path: str, kept: Kept = KEPT) -> tuple[list[str], list[UrdfJoint], dict[str, Mass]]:
    """Read the names of the links, the joints, and if INERTIALS are kept, the masses of the links with a mass.

    Raises ValueError if the file is invalid.
    """
    robot = read_xml(path, kept)
    for joint in robot.all("joint"):
        joint.require_one_each(f"joint {joint.attributes.get('name')!r}")
    links = named(robot.all("link"))
    joints = [_joint(name, element) for name, element in named(robot.all("joint")).items()]
    masses: dict[str, Mass] = {}
    for name, link in links.items():
        for inertial in link.all("inertial")[:1]:
            (mass,) = inertial.numbers("mass", "value", [0.0], f"link {name!r}")
            if mass < 0.0:
                raise ValueError(f"link {name!r}: mass = {mass:g}: must not be negative")
            masses[name] = Mass(mass, np.array(inertial.numbers("origin", "xyz", [0.0] * 3, f"link {name!r}")))
    return list(links), joints, masses


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
    tag = "position_based_velocity_limits"
    envelope = {key: numbers(tag, key, [0.0])[0] for key in ENVELOPE if joint.get(tag, key) is not None}
    mimic = None
    if joint.all("mimic"):
        (multiplier,), (offset,) = numbers("mimic", "multiplier", [1.0]), numbers("mimic", "offset", [0.0])
        mimic = (required("mimic", "joint"), multiplier, offset)
    return UrdfJoint(name, kind, parent, child, xyz, rpy, axis, limit, envelope, mimic)
