"""Chains and trees of joints from URDF files. The names, numbers and tree of the whole file must be valid."""

import difflib
import os
import warnings
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from graphlib import CycleError, TopologicalSorter
from math import inf
from typing import Any

import numpy as np

from .._core import MAX_DOF, rotation
from .._types import Array
from ..errors import ParameterError, UrdfWarning, not_one_of, wrong
from ..inertia import Inertia, joined
from ..joints import NO_BOUNDS, Joint, JointLimits, NamedFrame, TreeJoint, limited
from .file import ENVELOPE, INERTIALS, KEPT, UrdfJoint, inertia_of, read_robot
from .place import frame_at, pose
from .srdf import read_rotors
from .xml_file import Element, Kept, errors_of

OWN_RANGE = "give limits=fp.JointLimits(lower=..., upper=...)"
FREE = f"to move a joint, {OWN_RANGE}"
TYPES = ("revolute", "continuous", "prismatic", "fixed")
TREE_TYPES = (*TYPES, "floating", "planar")
BASES = ("fixed", "planar")
PLANAR_BASE = (
    Joint("prismatic", axis=(1, 0, 0), name="base_x"),
    Joint("prismatic", axis=(0, 1, 0), name="base_y"),
    Joint("continuous", axis=(0, 0, 1), name="base_yaw"),
)
Tree = dict[str, "UrdfJoint | None"]  # The parent joint of each link, None for the root.
# For each link: number of joints that move the link, and the pose of the link in the frame of the last joint.
Places = dict[str, tuple[int, Array]]
Follow = tuple[str, float, float]  # Leader, ratio, offset: the position is ratio times the leader's plus offset.


def read_urdf(
    path: str | os.PathLike[str],
    tip: str,
    base: str | None = None,
    limits: JointLimits | None = None,
    srdf: str | os.PathLike[str] | None = None,
) -> tuple[list[Joint], Array]:
    """Read the moving joints from link base (default: the root) to link tip, and the frame of the tip.

    See SerialArm.from_urdf(). The bounds of a leader are narrowed so that its mimic joints keep their own bounds.
    """
    notes: list[str] = []
    joints, frame, places, inertials = _read_chain(path, tip, base, limits, notes, INERTIALS)
    with errors_of(path):
        moving = {link: inertial for link, inertial in inertials.items() if places[link][0]}
        joints = _weighed(joints, _bodies(places, moving, len(joints) + 1), srdf)
    warn(path, notes, 4)
    return joints, frame


def read_places(
    path: str | os.PathLike[str], tip: str, base: str | None = None, limits: JointLimits | None = None
) -> tuple[list[Joint], Array, Places]:
    """The result of read_urdf() without inertias and warnings, and the place of each link of the file.

    Joints off the chain are fixed at zero.
    """
    return _read_chain(path, tip, base, limits, [], KEPT)[:3]


def _read_chain(
    path: str | os.PathLike[str], tip: str, base: str | None, limits: JointLimits | None, notes: list[str], kept: Kept
) -> tuple[list[Joint], Array, Places, dict[str, Element]]:
    """Joints, frame of the tip, places of all links, and the <inertial> of the links if these are kept.

    notes: list for the texts of warnings.
    """
    own = limits.given if limits is not None else {}
    with errors_of(path):
        links, every, inertials = read_robot(os.fsdecode(path), kept)
        above = tree_of(links, every)
        branch = _branch(above, tip, base)
        with errors_of(None, ", or give another base or tip"):
            follows = follows_of(branch, {joint.name: joint.mimic for joint in every})
            joints, places = _chain(branch, follows, own, notes)
        joints = limited(coupled_joints(joints, follows, notes), limits)
        return joints, places[tip][1], _all_places(above, places), inertials


def warn(path: str | os.PathLike[str], notes: Iterable[str], level: int) -> None:
    """Issue a warning for each note about a file, for the caller `level` functions up."""
    for note in notes:
        warnings.warn(f"{os.fsdecode(path)}: {note}", UrdfWarning, stacklevel=level)


def tree_of(links: Iterable[str], joints: Iterable[UrdfJoint]) -> Tree:
    """The parent joint of each link. Raises ValueError with the cause if the joints are not a tree."""
    above: Tree = dict.fromkeys(links)
    for joint in joints:
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in above:
                problem = "does not exist: must be a <link> of the file: add the link, or correct the name"
                raise ValueError(f"joint {joint.name!r}: {role} link {link!r} {problem}")
        other = above[joint.child]
        if other is not None:
            twice = f"is the child of two joints, {other.name!r} and {joint.name!r}"
            raise ValueError(f"link {joint.child!r} {twice}: must be the child of one joint: correct one <child>")
        above[joint.child] = joint
    try:
        TopologicalSorter({link: (joint.parent,) for link, joint in above.items() if joint}).prepare()
    except CycleError as error:
        remedy = "must form a tree: remove a joint of the loop"
        raise ValueError(f"links form a loop: {listed(error.args[1])}: {remedy}") from None
    roots = [link for link, joint in above.items() if joint is None]
    if len(roots) != 1:
        remedy = "connect the other links by joints" if roots else "add the links of the robot"
        raise ValueError(f"links without a parent joint: {listed(roots)}: must be one link, the root: {remedy}")
    return above


def listed(names: Iterable[str]) -> str:
    """Names for a message, at most 12."""
    return first(map(repr, names)) or "none"


def first(parts: Iterable[str]) -> str:
    """Parts of a message, at most 12."""
    shown = list(parts)
    more = [f"{len(shown) - 12} more"] if len(shown) > 12 else []
    return ", ".join(shown[:12] + more)


def _branch(above: Tree, tip: str, base: str | None) -> list[UrdfJoint]:
    """The joints from base to tip."""
    up = _to_root(above, "tip", tip)
    links = [tip, *(joint.parent for joint in up)]
    base = links[-1] if base is None else base
    others = {base, *(joint.parent for joint in _to_root(above, "base", base))}
    if base not in links:
        fork = next(link for link in links if link in others)
        where = f"base must be between the root {links[-1]!r} and the tip"
        raise ValueError(f"tip {tip!r} is not below base {base!r}, they have {fork!r} in common: {where}")
    branch = up[: links.index(base)][::-1]
    count = _moving(branch)
    if not 1 <= count <= MAX_DOF:
        demand = f"must be 1 to {MAX_DOF}: give another base or tip"
        raise ValueError(f"{count or 'no'} joints move between base {base!r} and tip {tip!r}: {demand}")
    return branch


def _moving(joints: Iterable[UrdfJoint]) -> int:
    return sum(joint.type != "fixed" for joint in joints)


def _to_root(above: Tree, role: str, link: str) -> list[UrdfJoint]:
    if link not in above:
        raise wrong(role, link, f" = {link!r}: must be a link{_hint(above, str(link))}")
    joints = []
    while (joint := above[link]) is not None:
        joints.append(joint)
        link = joint.parent
    return joints


def _hint(above: Tree, link: str) -> str:
    """Similar names of links, and the ends of all branches, first the branch with the most joints."""
    parents = {joint.parent for joint in above.values() if joint}
    leaves = (name for name in above if name not in parents)
    ends = sorted(leaves, key=lambda name: -_moving(_to_root(above, "tip", name)))
    return f"{_perhaps(link, above)}; branches end in {listed(ends)}"


def _perhaps(name: str, names: Iterable[str]) -> str:
    close = difflib.get_close_matches(name, list(names)[:300])  # A search of thousands of names is slow.
    return f", perhaps {' or '.join(map(repr, close))}" if close else ""


def follows_of(branch: Iterable[UrdfJoint], mimics: Mapping[str, Follow | None]) -> dict[str, Follow]:
    """For each mimic joint of the chain: the last leader, which is not a mimic joint."""
    follows = {}
    for joint in branch:
        if joint.type == "fixed" or mimics[joint.name] is None:
            continue
        leader, ratio, offset = joint.name, 1.0, 0.0
        passed: list[str] = []
        while (mimic := mimics[leader]) is not None:
            passed.append(leader)
            leader, multiplier, plus = mimic
            ratio, offset = ratio * multiplier, offset + ratio * plus
            if leader not in mimics:
                remedy = "must mimic a joint of the file: correct the name, or remove <mimic>"
                raise ValueError(f"joint {passed[-1]!r} mimics {leader!r}, which does not exist: {remedy}")
            if leader in passed:
                loop = listed([*passed[passed.index(leader) :], leader])
                raise ValueError(f"mimics form a loop: {loop}: one joint must have a drive: remove its <mimic>")
            if len(passed) > MAX_DOF:
                row = f"more than {MAX_DOF} joints mimic one another in a row"
                raise ValueError(f"joint {joint.name!r}: {row}: must be fewer: let each mimic the last leader")
        if not (0.0 < abs(ratio) < inf and abs(offset) < 1e100):
            by = f"ratio {ratio:g} and offset {offset:g}"
            required = "must be finite, the ratio not zero: correct multiplier and offset"
            raise ValueError(f"joint {joint.name!r} mimics {leader!r} by {by}: {required}")
        follows[joint.name] = (leader, ratio, offset)
    return follows


def _chain(
    branch: list[UrdfJoint], follows: Mapping[str, Follow], own: Collection[str], notes: list[str]
) -> tuple[list[Joint], Places]:
    """The moving joints, and the places of the links of the chain."""
    for joint in branch:
        if joint.type not in TYPES:
            problem = f"type = {joint.type!r}: must be {', '.join(TYPES[:-1])} or fixed"
            raise ValueError(f"joint {joint.name!r}: {problem}: correct the type")
    fixed = without_range((joint for joint in branch if joint.name not in follows), own, notes)
    moving = {joint.name for joint in branch if joint.type != "fixed"}
    held = {**{leader: 0.0 for leader, _, _ in follows.values() if leader not in moving}, **fixed}
    for joint in branch:
        leader, _, offset = follows.get(joint.name, ("", 1.0, 0.0))
        if leader in held and leader not in fixed:
            reason = f"it mimics {leader!r}, which does not move between base and tip"
            notes.append(f"joint {joint.name!r} is held at {offset:g} {unit_of(joint)}: {reason}")
    joints: list[Joint] = []
    places: Places = {branch[0].parent: (0, frame_at())}
    _add(branch, follows, held, own, joints, places)
    if not joints:
        names = listed(joint.name for joint in branch if joint.type != "fixed")
        if fixed:
            raise ValueError(f"all joints between base and tip are fixed, because lower = upper: {names}: {FREE}")
        problem = f"all joints between base and tip mimic joints elsewhere: {names}"
        raise ValueError(f"{problem}: at least one joint must have a drive")
    return joints, places


def _add(
    every: Iterable[UrdfJoint],
    follows: Mapping[str, Follow],
    held: Mapping[str, float],
    own: Collection[str],
    joints: list[Joint],
    places: Places,
) -> list[int]:
    """Add the joints that move, and the places of the children of all joints; each joint follows its parent.

    Returns the numbers of the parent links of the added joints.
    """
    parents = []
    for joint in every:
        number, frame = places[joint.parent]
        frame = frame @ pose(joint.xyz, joint.rpy)
        if joint.type in TYPES[:-1]:
            leader, ratio, offset = follows.get(joint.name, (joint.name, 1.0, 0.0))
            if leader in held:
                frame = frame @ step_of(joint, ratio * held[leader] + offset)
            else:
                joints.append(chain_joint(joint, frame, own, leader != joint.name))
                parents.append(number)
                number, frame = len(joints), frame_at()
        places[joint.child] = (number, frame)
    return parents


def without_range(joints: Iterable[UrdfJoint], own: Collection[str], notes: list[str]) -> dict[str, float]:
    """Positions of the joints that their bounds fix, by name."""
    fixed = {}
    said = []
    for joint in joints:
        lower, upper = (joint.limit.get(name, 0.0) for name in ("lower", "upper"))  # Defaults of the URDF format.
        if joint.type in ("revolute", "prismatic") and lower == upper and not {"lower", "upper"} & set(own):
            fixed[joint.name] = lower
            said.append(f"{joint.name!r} at {lower:g} {unit_of(joint)}")
    if said:
        notes.append(f"joints are fixed, because lower = upper, which are 0 if missing: {first(said)}: {FREE}")
    return fixed


def unit_of(joint: UrdfJoint) -> str:
    return "m" if joint.type == "prismatic" else "rad"


def step_of(joint: UrdfJoint, position: float) -> Array:
    """Transform of a joint at a position."""
    if position == 0.0:
        return frame_at()
    require_axis(joint)
    along = position * np.array(joint.axis) / np.linalg.norm(joint.axis)
    return frame_at(p=along) if joint.type == "prismatic" else frame_at(R=rotation(along))


def _all_places(above: Tree, known: Places) -> Places:
    """Places of all links; joints above the base and on side branches are fixed at zero."""
    beside: dict[str, list[tuple[str, Array]]] = {link: [] for link in above}
    for joint in filter(None, above.values()):
        step = pose(joint.xyz, joint.rpy)
        beside[joint.parent].append((joint.child, step))
        beside[joint.child].append((joint.parent, np.asarray(np.linalg.inv(step))))
    places = dict(known)
    queue = list(known)
    for link in queue:
        count, frame = places[link]
        for other, step in beside[link]:
            if other not in places:
                places[other] = (count, frame @ step)
                queue.append(other)
    return places


def require_axis(joint: UrdfJoint) -> None:
    if not np.any(joint.axis):
        raise ValueError(f"joint {joint.name!r}: axis = 0 0 0: must be a nonzero vector: correct the axis")


def chain_joint(joint: UrdfJoint, placement: Array, own: Collection[str] = (), follows: bool = False) -> Joint:
    """A moving joint with its bounds, except the bounds in `own`. Raises ValueError if the bounds are invalid.

    follows: whether the joint is a mimic joint, whose range coupled_joints() checks.
    """
    require_axis(joint)
    given = {name: value for name, value in joint.limit.items() if value != 0.0 or name in ("lower", "upper")}
    limit: dict[str, Any] = {**NO_BOUNDS, "lower": 0.0, "upper": 0.0, **given}  # Defaults of the URDF format.
    if joint.type == "continuous":
        limit |= {"lower": -inf, "upper": inf}
    if not {"velocity_offset", "deceleration"} & set(own):
        limit |= _envelope(joint)
    limit |= {name: NO_BOUNDS[name] for name in own}
    lower, upper = limit["lower"], limit["upper"]
    if lower >= upper and not follows:
        raise ValueError(f"joint {joint.name!r}: lower = {lower:g}: must be below upper = {upper:g}: {OWN_RANGE}")
    for what in ("velocity", "acceleration", "jerk", "effort"):
        if limit[what] < 0.0:
            problem = f"{what} = {limit[what]:g}: must be positive: give limits=fp.JointLimits({what}=...)"
            raise ValueError(f"joint {joint.name!r}: {problem}")
    for what, value in joint.friction.items():
        if value < 0.0:
            raise ValueError(f"joint {joint.name!r}: {what} = {value:g}: must not be negative: correct <dynamics>")
    fields: dict[str, Any] = {**limit, **joint.friction}
    return Joint(str(joint.type), placement, joint.axis, **fields, name=joint.name)


def _envelope(joint: UrdfJoint) -> dict[str, float]:
    """Bound on velocity as a function of position for Franka, as libfranka reads it."""
    if not joint.envelope:
        return {}
    offset, deceleration = (joint.envelope.get(name) for name in ENVELOPE)
    if offset is None or deceleration is None or offset < 0.0 or deceleration <= 0.0:
        needs = "must have velocity_offset, not negative, and deceleration_limit, positive: correct the numbers"
        raise ValueError(f"joint {joint.name!r}: <position_based_velocity_limits>: {needs}")
    return {"velocity_offset": offset, "deceleration": deceleration}


def coupled_joints(joints: list[Joint], follows: Mapping[str, Follow], notes: list[str]) -> list[Joint]:
    """The joints with their mimics, and each leader bounded so that its mimic joints keep their own bounds.

    The range of a mimic joint that leaves no range for the leader is removed.
    """
    coupled = list(joints)
    index = {joint.name: i for i, joint in enumerate(joints)}
    said = []
    for i, follower in enumerate(joints):
        if follower.name not in follows:
            continue
        name, ratio, offset = follows[follower.name]
        leader = coupled[index[name]]
        ends = sorted(((follower.lower - offset) / ratio, (follower.upper - offset) / ratio))
        lower, upper = max(leader.lower, ends[0]), min(leader.upper, ends[1])
        if lower >= upper or follower.lower >= follower.upper:
            said.append(f"{follower.name!r} of {name!r}")
            lower, upper = leader.lower, leader.upper
            follower = replace(follower, lower=-inf, upper=inf)
        coupled[i] = replace(follower, mimic=(index[name], ratio, offset))
        coupled[index[name]] = replace(
            leader,
            type="revolute" if leader.type == "continuous" and upper < inf else leader.type,
            lower=lower,
            upper=upper,
            velocity=min(leader.velocity, follower.velocity / abs(ratio)),
            acceleration=min(leader.acceleration, follower.acceleration / abs(ratio)),
            jerk=min(leader.jerk, follower.jerk / abs(ratio)),
            effort=min(leader.effort, follower.effort * abs(ratio)),
        )
    if said:
        problem = "ranges of mimic joints are ignored, because they leave no range for the joint that leads them"
        notes.append(f"{problem}: {first(said)}")
    return coupled


def read_tree(
    path: str | os.PathLike[str],
    *,
    base: str | None = None,
    locked: Mapping[str, float] | None = None,
    tips: Iterable[str] | None = None,
    limits: JointLimits | None = None,
    srdf: str | os.PathLike[str] | None = None,
    notes: list[str] | None = None,
) -> dict[str, Any]:
    """The arguments of a Robot; see Robot.from_urdf(). notes: list for the texts of warnings, instead of warnings."""
    if base is not None and base not in BASES:
        raise not_one_of("base", base, BASES)
    said: list[str] = [] if notes is None else notes
    with errors_of(path):
        links, every, inertials = read_robot(os.fsdecode(path), INERTIALS)
        above = tree_of(links, every)
        held = _held(above, every, dict(locked or {}), tips)
        own = limits.given if limits is not None else {}
        names = {joint.name for joint in every}
        lost = [joint.name for joint in every if joint.name not in held and joint.mimic and joint.mimic[0] not in names]
        if lost:
            problem = "must mimic a joint of the file: fix the joints by locked= or tips=, or correct the names"
            raise ValueError(f"joints mimic joints that do not exist: {listed(lost)}: {problem}")
        for joint in every:
            if joint.type not in TREE_TYPES:
                raise ValueError(f"joint {joint.name!r}: type = {joint.type!r}: must be {', '.join(TREE_TYPES)}")
            if joint.type in ("floating", "planar") and base is None:
                demand = "base= must be 'fixed' or 'planar', to replace it"
                raise ValueError(f"joint {joint.name!r} is {joint.type}: {demand}")
        joints = list(PLANAR_BASE) if base == "planar" else []
        parents = list(range(len(joints)))
        root = next(link for link, joint in above.items() if joint is None)
        places = {root: (len(joints), frame_at())}
        with errors_of(None, ", or fix the joint by locked= or tips="):
            follows = follows_of(every, {joint.name: None if joint.name in held else joint.mimic for joint in every})
            free = [joint for joint in every if joint.name not in held and joint.name not in follows]
            fixed = without_range(free, own, said)
            parents += _add(_depth_first(above), follows, {**held, **fixed}, own, joints, places)
        if not joints:
            remedy = f"{FREE}, or if" if fixed else "if"
            raise ValueError(f"no joints move: must be 1 to {MAX_DOF}: {remedy} the base moves, give base='planar'")
        if len(joints) > MAX_DOF:
            remedy = "fix the other joints by locked= or tips="
            raise ValueError(f"{len(joints)} joints move: must be 1 to {MAX_DOF}; {remedy}")
        moving = {joint.name for joint in joints}
        followers = {name: follow for name, follow in follows.items() if name in moving}
        coupled = limited(coupled_joints(joints, followers, said), limits)
        moved = _bodies(places, inertials, len(joints) + 1)
    if notes is None:
        warn(path, said, 4)
    return {
        "joints": list(map(TreeJoint, _weighed(coupled, moved, srdf), parents)),
        "named_frames": [NamedFrame(link, number, frame) for link, (number, frame) in places.items()],
        "base_mass": moved[0].mass,
        "base_center": moved[0].center,
    }


def _held(
    above: Tree, every: Iterable[UrdfJoint], locked: dict[str, float], tips: Iterable[str] | None
) -> dict[str, float]:
    """Positions of the fixed joints, by name."""
    joints = {joint.name: joint for joint in every}
    for name, position in locked.items():
        if name not in joints or joints[name].type in ("fixed", "floating", "planar"):
            raise wrong("locked", name, f" has {name!r}: must be names of joints that move{_perhaps(name, joints)}")
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
        needed = _needed(above, joints, [tips] if isinstance(tips, str) else tips)
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


def _needed(above: Tree, joints: Mapping[str, UrdfJoint], tips: Iterable[str]) -> set[str]:
    """Names of the joints that move a tip, and of their leaders."""
    needed: set[str] = set()
    for tip in tips:
        if tip not in above:
            raise wrong("tips", tip, f" has {tip!r}: must be links{_perhaps(str(tip), above)}")
        for joint in _to_root(above, "tips", tip):
            while joint.name not in needed:
                needed.add(joint.name)
                if joint.mimic is None or joint.mimic[0] not in joints:
                    break
                joint = joints[joint.mimic[0]]
    return needed


def _range(joint: UrdfJoint) -> tuple[float, float]:
    return (-inf, inf) if joint.type == "continuous" else (joint.limit.get("lower", 0.0), joint.limit.get("upper", 0.0))


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


def _bodies(places: Places, inertials: Mapping[str, Element], count: int) -> list[Inertia]:
    """Inertia of each link of the robot, which may combine several links of the file."""
    parts: list[list[Inertia]] = [[] for _ in range(count)]
    for link, inertial in inertials.items():
        number, frame = places[link]
        parts[number].append(inertia_of(link, inertial).moved(frame))
    return list(map(joined, parts))


def _weighed(joints: Iterable[Joint], bodies: Sequence[Inertia], srdf: str | os.PathLike[str] | None) -> list[Joint]:
    """The joints with the inertias of their links, of which the first is the base, and of their rotors."""
    rotors = {} if srdf is None else read_rotors(srdf)
    return [
        replace(joint, mass=mass, center=center, inertia=inertia, rotor_inertia=rotors.get(joint.name, 0.0))
        for joint, (mass, center, inertia) in zip(joints, bodies[1:])
    ]
