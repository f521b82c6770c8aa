"""Clearance: self-collision and obstacles that an arm or a robot avoids."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ._core import Clearance as CoreClearance
from ._core import Nearest, preset_capsules
from ._types import Array
from .arms import Arm, SerialArm
from .capsule import MARGIN, Capsule
from .errors import ParameterError, require, suggestion, wrong
from .joints import IDENTITY, Joint, JointLimits
from .obstacle import OBSTACLES, Obstacle
from .parameter import NOT_NEGATIVE, POSITIVE, Data, data, from_file, parameter
from .robots import PLACE, Robot
from .urdf.capsules import capsules_of, read_joints
from .urdf.srdf import read_disabled_pairs, read_group_states

PLANAR_BASE = {"base_x", "base_y", "base_yaw"}  # Joints of Robot.from_urdf(base="planar"); not in SRDF files.


@data
class Clearance(Data):
    """Self-collision and obstacles that an arm or a Robot avoids, with a margin.

    Two kinds of pairs are checked: capsules of two links that are not adjacent, also on different branches of a Robot;
    and each capsule of a moving link with each obstacle. Allowed pairs and the pairs of excluded_pairs() are not
    checked. Shapes without a name get a default: 'link_3' for a capsule, 'obstacle_1' for an obstacle.

    Raises ParameterError if a shape has a wrong type, an obstacle is not in the base frame, two obstacles share a name,
    or `allowed` contains a name that no shape has.
    """

    kind: ClassVar[str] = "clearance"
    capsules: Sequence[Capsule] = parameter("Capsules that contain the links of the arm.")
    obstacles: Sequence[Obstacle] = parameter(
        "Obstacles in the base frame; the z axis of a planar arm is normal to the plane.", default=()
    )
    _: KW_ONLY
    margin: float = parameter("Least distance between two shapes.", NOT_NEGATIVE, default=MARGIN, unit="m")
    allowed: Sequence[tuple[str, str]] = parameter("Names of the pairs that are not checked.", default=())
    away_gain: float = parameter(
        "Gain of the null-space motion away from shapes; at velocity level in rad/(m s).",
        NOT_NEGATIVE,
        default=0.0,
        unit="rad/(m s^2)",
    )
    away_range: float = parameter(
        "away_gain acts on shapes that are closer than the margin plus this distance.", POSITIVE, default=0.1, unit="m"
    )

    def _finish(self) -> None:
        _require("capsules", self.capsules, (Capsule,), "a Capsule")
        _require("obstacles", self.obstacles, tuple(OBSTACLES.values()), "a HalfSpace, a Cuboid or a Capsule")
        capsules = tuple(each if each.name else replace(each, name=f"link_{each.link}") for each in self.capsules)
        obstacles = tuple(
            each if each.name else replace(each, name=f"obstacle_{i}") for i, each in enumerate(self.obstacles, 1)
        )
        allowed = tuple(map(tuple, self.allowed))
        names = [each.name for each in obstacles]
        for i, each in enumerate(obstacles):
            if each.name in names[:i]:
                raise ParameterError("obstacles", i, each, f"obstacles[{i}].name = {each.name!r}: must be unique")
            if isinstance(each, Capsule) and each.link != 0:
                raise ParameterError("obstacles", i, each, f"obstacles[{i}].link = {each.link}: must be 0, the base")
        names = sorted({*names, *(each.name for each in capsules)})
        for i, pair in enumerate(allowed):
            if len(pair) != 2:
                raise ParameterError("allowed", i, pair, f"allowed[{i}] = {pair!r:.80}: must be two names")
            for name in pair:
                if name not in names:
                    problem = f"allowed[{i}] has {name!r}: must be names of shapes{suggestion(name, names)}"
                    raise ParameterError("allowed", i, name, problem)
        for name, values in {"capsules": capsules, "obstacles": obstacles, "allowed": allowed}.items():
            object.__setattr__(self, name, values)

    @classmethod
    def preset(cls, name: str, *, obstacles: Sequence[Obstacle] = (), margin: float = MARGIN) -> Clearance:
        """Clearance of SerialArm.preset(name) or Robot.preset(name), with capsules that contain the maker's meshes.

        Tools have no capsules. Pairs of links that cannot collide within the joint bounds are allowed pairs. Raises
        ParameterError if the preset does not exist.
        """
        links, allowed = preset_capsules(name)
        capsules = [Capsule(link, a, b, radius, title) for link, a, b, radius, title in links]
        return cls(capsules, obstacles, margin=margin, allowed=allowed)

    @classmethod
    def from_arms(
        cls,
        arms: Mapping[str, SerialArm],
        clearances: Mapping[str, Clearance],
        placements: Mapping[str, ArrayLike] | None = None,
        *,
        obstacles: Sequence[Obstacle] = (),
        margin: float = MARGIN,
        allowed: Sequence[tuple[str, str]] = (),
    ) -> Clearance:
        """Clearance of Robot.from_arms(arms, placements), with the capsules of the arms' clearances.

        Capsule 'panda_link5' of arm 'left' becomes 'left_panda_link5'. The allowed pairs are the allowed pairs of the
        clearances and the pairs in `allowed`. An arm without a clearance has no capsules.

        Raises ParameterError if a clearance belongs to no arm or has obstacles: give obstacles in the robot's base
        frame.
        """
        for name, clearance in clearances.items():
            if name not in arms:
                raise wrong("clearances", name, f" has {name!r}: must be names of arms{suggestion(name, arms)}")
            if clearance.obstacles:
                problem = f"[{name!r}] has obstacles: give them to from_arms(obstacles=), in the robot's base frame"
                raise wrong("clearances", clearance, problem)
        capsules: list[Capsule] = []
        pairs: list[tuple[str, str]] = []
        first = 0
        for name, arm in arms.items():
            own = clearances.get(name, cls([]))
            place = replace(PLACE, name=f"placements[{name!r}]").check((placements or {}).get(name, IDENTITY))
            for each in own.capsules:
                moved = replace(each, link=each.link and first + each.link, name=f"{name}_{each.name}")
                if each.link == 0:
                    a, b = (place[:3, :3] @ end + place[:3, 3] for end in (each.a, each.b))
                    moved = replace(moved, a=a, b=b)
                capsules.append(moved)
            pairs += [(f"{name}_{one}", f"{name}_{other}") for one, other in own.allowed]
            first += len(arm.joints)
        return cls(capsules, obstacles, margin=margin, allowed=[*pairs, *allowed])

    @classmethod
    def from_urdf(
        cls,
        path: str | os.PathLike[str],
        tip: str | None = None,
        base: str | None = None,
        *,
        locked: Mapping[str, float] | None = None,
        tips: Iterable[str] | None = None,
        srdf: str | os.PathLike[str] | None = None,
        obstacles: Sequence[Obstacle] = (),
        margin: float = MARGIN,
        allowed: Sequence[tuple[str, str]] = (),
        per_link: int = 2,
        postures: ArrayLike | None = None,
        limits: JointLimits | None = None,
    ) -> Clearance:
        """Clearance of the robot in a URDF file, with capsules that contain the collision geometry of the file.

        The robot is SerialArm.from_urdf(path, tip, base, limits=limits). Without tip, the robot is Robot.from_urdf(
        path, base=base, locked=locked, tips=tips, limits=limits). Give the same arguments to both functions. Joints
        that do not move are at the positions at which the robot fixes them.

        Each link gets one capsule, or up to per_link capsules if their volume is smaller. Unless per_link is 1, a link
        gets one more capsule if its capsules would often be closer to the capsules of another link than the margin
        although the links are not. srdf is an SRDF file of MoveIt, whose disabled pairs are
        allowed pairs, in addition to `allowed`. Needs the extra 'clearance'; only meshes need its packages trimesh and
        pycollada.

        postures, of shape (n,) or (k, n) [rad] or [m], are postures in which the clearance must accept the robot. If
        the capsules of two links are closer than the margin in one of these postures, the links get up to 8 capsules
        each, unless the meshes of the links are also closer than the margin. Default: the group states of the SRDF file
        that have all joints of the robot and no others, with a planar base at zero; none if per_link is 1.

        Raises ParameterError if postures have a wrong shape or are not finite, or an argument is for another kind of
        robot; ValueError if a file is not valid; OSError if a file cannot be read.
        """
        cls([], obstacles, margin=margin)  # Check these arguments before the slow fit.
        pairs = [] if srdf is None else read_disabled_pairs(srdf)
        if tips is not None:
            tips = [tips] if isinstance(tips, str) else list(tips)
        robot: dict[str, Any] = {"locked": locked, "tips": tips, "limits": limits}
        joints = [each.joint for each in read_joints(path, tip, base, **robot)[0]]
        robot["required"] = _postures(joints, postures, srdf if per_link != 1 else None)
        robot["allowed"] = [*pairs, *allowed]
        capsules = capsules_of(path, tip, base, per_link=per_link, margin=margin, **robot)
        names = {each.name for each in capsules}
        disabled = [pair for pair in pairs if names.issuperset(pair)]
        return cls(capsules, obstacles, margin=margin, allowed=[*disabled, *allowed])

    def nearest(self, arm: Arm | Robot, q: ArrayLike) -> Nearest | None:
        """The nearest checked pair of shapes in a posture q, shape (n,) [rad]; None if no pair is checked.

        Raises ParameterError if q is not a posture of the arm or the robot, or if a capsule is on a link that does not
        exist.
        """
        return self._of(arm).nearest(q)

    def pairs(self, arm: Arm | Robot) -> list[tuple[str, str]]:
        """Names of the checked pairs, one entry for each pair of capsules; a pair of names may occur several times."""
        return self._of(arm).pairs()

    def excluded_pairs(self, arm: Arm | Robot) -> list[tuple[str, str]]:
        """Names of the pairs that are not checked because they are closer than the margin in all of 256 postures."""
        return self._of(arm).excluded_pairs()

    def _of(self, arm: Arm | Robot) -> CoreClearance:
        """The compiled part for an arm or a robot, cached for the next call."""
        known: tuple[Arm | Robot, CoreClearance] | None = self.__dict__.get("_known")
        if known is None or known[0] is not arm:
            self.__dict__["_known"] = known = arm, CoreClearance(arm, self)
        return known[1]


def _postures(joints: Sequence[Joint], given: ArrayLike | None, srdf: str | os.PathLike[str] | None) -> Array | None:
    """Positions (k, N) of all joints in the given postures or the SRDF file's group states; None without postures."""
    free = [i for i, joint in enumerate(joints) if joint.mimic is None]
    if given is not None:
        try:
            q = np.atleast_2d(np.asarray(given, dtype=float))
        except (TypeError, ValueError):
            raise wrong("postures", given, f" = {given!r:.60}: must be numbers") from None
        if q.ndim != 2 or q.shape[1] != len(free) or not np.all(np.isfinite(q)):
            demand = f"must be finite, of shape ({len(free)},) or (k, {len(free)})"
            raise wrong("postures", given, f" of shape {np.shape(given)}: {demand}")
    else:
        names = [joints[i].name for i in free]
        states = [] if srdf is None else read_group_states(srdf)
        q = np.array([[state.get(name, 0.0) for name in names] for state in states if _is_whole(state, names)])
        if not len(q):
            return None
    positions = np.zeros((len(q), len(joints)))
    positions[:, free] = q
    return positions


def _is_whole(state: Mapping[str, float], names: Sequence[str]) -> bool:
    """Whether a group state has all joints of a robot, except the joints of its planar base, and no others."""
    return set(names) - PLANAR_BASE <= set(state) <= set(names)


def _require(name: str, shapes: Iterable[Any], kinds: tuple[Any, ...], demand: str) -> None:
    if not isinstance(shapes, (list, tuple)):
        raise wrong(name, shapes, f" = {shapes!r:.60}: must be a list")
    for i, each in enumerate(shapes):
        require(name, each, kinds, demand, index=i)


# Constructors of clearances, by the kind in a table.
CLEARANCES: dict[str, Callable[..., Clearance]] = {
    Clearance.kind: Clearance,
    "urdf": from_file(Clearance.from_urdf, "allowed", "limits"),
}
