"""Trees of joints from URDF files, with masses, for a Robot."""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterable, Iterator, Mapping
from math import inf
from typing import Any

import numpy as np

from .._core import MAX_DOF
from ..errors import ParameterError, not_one_of, wrong
from ..joints import Joint, JointLimits, NamedFrame, TreeJoint, limited
from .chain import (
    FREE,
    Places,
    Tree,
    chain_joint,
    coupled_joints,
    follows_of,
    frame_at,
    listed,
    or_else,
    own_bounds,
    pose,
    step_of,
    tree_of,
    warn,
    without_range,
)
from .file import Mass, UrdfJoint, read_robot_with_masses

TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
BASES = ("fixed", "planar")
FIX = "fix the joint by locked= or tips="


def read_tree(
    path: str | os.PathLike[str],
    *,
    base: str | None = None,
    locked: Mapping[str, float] | None = None,
    tips: Iterable[str] | None = None,
    limits: JointLimits | None = None,
    notes: list[str] | None = None,
) -> dict[str, Any]:
    """The arguments of a Robot; see Robot.from_urdf(). notes: list for the texts of warnings, instead of warnings."""
    name = os.fsdecode(path)
    if base is not None and base not in BASES:
        raise not_one_of("base", base, BASES)
    said: list[str] = [] if notes is None else notes
    try:
        links, every, masses = read_robot_with_masses(name)
        above = tree_of(links, every)
        held = _held(above, every, dict(locked or {}), tips)
        robot = _robot(above, every, masses, held, base, limits, said)
    except ParameterError:
        raise
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    if notes is None:
        warn(path, said, 4)
    return robot


def _held(
    above: Tree, every: Iterable[UrdfJoint], locked: dict[str, float], tips: Iterable[str] | None
) -> dict[str, float]:
    """Positions of the fixed joints, by name."""
    joints = {joint.name: joint for joint in every}
    for name, position in locked.items():
        if name not in joints or joints[name].type in ("fixed", "floating", "planar"):
            close = difflib.get_close_matches(name, list(joints)[:300])
            hint = f", perhaps {' or '.join(map(repr, close))}" if close else ""
            raise wrong("locked", name, f" has {name!r}: must be names of joints that move{hint}")
        mimic = joints[name].mimic
        if mimic is not None and _leads_to_drive(joints, name):
            raise wrong("locked", name, f" has {name!r}, which mimics {mimic[0]!r}: lock the leader")
        low, high = _range(joints[name])
        if low < high and not low <= position <= high:
            raise ParameterError(
                "locked", None, position, f"locked[{name!r}] = {position:g}: must be from {low:g} to {high:g}"
            )
    held = {name: float(position) for name, position in locked.items()}
    if tips is not None:
        needed = _needed(above, joints, [tips] if isinstance(tips, str) else list(tips))
        for name, joint in joints.items():
            if name not in needed and joint.type != "fixed" and not (joint.mimic and _leads_to_drive(joints, name)):
                low, high = _range(joint)
                held.setdefault(name, min(max(0.0, low), high))
    return held


def _leads_to_drive(joints: Mapping[str, UrdfJoint], name: str) -> bool:
    """Whether the leaders of a mimic joint exist, up to a joint that has a drive."""
    for _ in range(MAX_DOF + 1):
        mimic = joints[name].mimic
        if mimic is None:
            return True
        name = mimic[0]
        if name not in joints:
            return False
    return False


def _needed(above: Tree, joints: Mapping[str, UrdfJoint], tips: list[str]) -> set[str]:
    """Names of the joints that move a tip, and of their leaders."""
    needed: set[str] = set()
    for tip in tips:
        if tip not in above:
            close = difflib.get_close_matches(str(tip), list(above)[:300])
            raise wrong("tips", tip, f" has {tip!r}: must be links" + (f", perhaps {close[0]!r}" if close else ""))
        link = tip
        while (joint := above[link]) is not None:
            while joint.name not in needed:
                needed.add(joint.name)
                if joint.mimic is None or joint.mimic[0] not in joints:
                    break
                joint = joints[joint.mimic[0]]
            link = above[link].parent  # type: ignore[union-attr]
    return needed


def _range(joint: UrdfJoint) -> tuple[float, float]:
    return (-inf, inf) if joint.type == "continuous" else (joint.limit.get("lower", 0.0), joint.limit.get("upper", 0.0))


def _planar_base() -> list[Joint]:
    """Joints of a base that moves along x and y and rotates about z."""
    return [
        Joint("prismatic", axis=(1, 0, 0), name="base_x"),
        Joint("prismatic", axis=(0, 1, 0), name="base_y"),
        Joint("continuous", axis=(0, 0, 1), name="base_yaw"),
    ]


def _depth_first(above: Tree) -> Iterator[UrdfJoint]:
    """All joints, each after its parent; the joints of a chain follow one another."""
    below: dict[str, list[UrdfJoint]] = {link: [] for link in above}
    for joint in filter(None, above.values()):
        below[joint.parent].append(joint)
    left = [joint for link, joint_above in above.items() if joint_above is None for joint in below[link][::-1]]
    while left:
        joint = left.pop()
        yield joint
        left += below[joint.child][::-1]


def _robot(
    above: Tree,
    every: list[UrdfJoint],
    masses: Mapping[str, Mass],
    held: dict[str, float],
    base: str | None,
    limits: JointLimits | None,
    notes: list[str],
) -> dict[str, Any]:
    own = own_bounds(limits)
    names = {joint.name for joint in every}
    lost = [joint.name for joint in every if joint.name not in held and joint.mimic and joint.mimic[0] not in names]
    if lost:
        problem = "must mimic a joint of the file: fix the joints by locked= or tips=, or correct the names"
        raise ValueError(f"joints mimic joints that do not exist: {listed(lost)}: {problem}")
    with or_else(FIX):
        follows = follows_of(every, {joint.name: None if joint.name in held else joint.mimic for joint in every})
    free = [joint for joint in every if joint.name not in held and joint.name not in follows]
    fixed = without_range(free, own, notes)
    held = {**held, **fixed}
    joints = _planar_base() if base == "planar" else []
    parents = list(range(len(joints)))
    root = next(link for link, joint in above.items() if joint is None)
    places = {root: (len(joints), frame_at())}
    for joint in _depth_first(above):
        number, frame = places[joint.parent]
        frame = frame @ pose(joint.xyz, joint.rpy)
        if joint.type not in TYPES:
            raise ValueError(f"joint {joint.name!r}: type = {joint.type!r}: must be {', '.join(TYPES)}")
        if joint.type in ("floating", "planar") and base is None:
            raise ValueError(f"joint {joint.name!r} is {joint.type}: base= must be 'fixed' or 'planar', to replace it")
        if joint.type in ("revolute", "continuous", "prismatic"):
            leader, ratio, offset = follows.get(joint.name, (joint.name, 1.0, 0.0))
            if leader in held:
                frame = frame @ step_of(joint, ratio * held[leader] + offset)
            else:
                with or_else(FIX):
                    joints.append(chain_joint(joint, frame, own, leader != joint.name))
                parents.append(number)
                number, frame = len(joints), frame_at()
        places[joint.child] = (number, frame)
    if not joints:
        remedy = (
            f"{FREE}, or if the base moves, give base='planar'" if fixed else "if the base moves, give base='planar'"
        )
        raise ValueError(f"no joints move: must be 1 to {MAX_DOF}: {remedy}")
    if len(joints) > MAX_DOF:
        raise ValueError(f"{len(joints)} joints move: must be 1 to {MAX_DOF}; fix the other joints by locked= or tips=")
    moving = {joint.name for joint in joints}
    followers = {name: follow for name, follow in follows.items() if name in moving}
    coupled = limited(coupled_joints(joints, followers, notes), limits)
    weights = _weights(places, masses, len(joints) + 1)
    return {
        "joints": [
            TreeJoint(joint, parent, mass=mass, center=center)
            for joint, parent, (mass, center) in zip(coupled, parents, weights[1:])
        ],
        "named_frames": [NamedFrame(link, number, frame) for link, (number, frame) in places.items()],
        "base_mass": weights[0].mass,
        "base_center": weights[0].center,
    }


def _weights(places: Places, masses: Mapping[str, Mass], count: int) -> list[Mass]:
    """Mass and centre of mass of each link of the robot; a link may combine several links of the file."""
    total, moment = np.zeros(count), np.zeros((count, 3))
    for link, (mass, center) in masses.items():
        number, frame = places[link]
        total[number] += mass
        moment[number] += mass * (frame[:3, :3] @ center + frame[:3, 3])
    return [Mass(float(m), s / m if m > 0.0 else s) for m, s in zip(total, moment)]
