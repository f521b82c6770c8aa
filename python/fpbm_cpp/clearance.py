"""What an arm or a robot keeps clear of."""

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
from .arms import IDENTITY, Arm, Joint, SerialArm
from .capsule import Capsule
from .errors import ParameterError, suggestion, wrong
from .obstacle import OBSTACLES, Obstacle
from .parameter import NOT_NEGATIVE, POSITIVE, Data, data, parameter
from .robots import PLACE, Robot

MARGIN = 0.01
PLANAR_BASE = {"base_x", "base_y", "base_yaw"}  # Of Robot.from_urdf(base="planar"): SRDF files do not have them.


@data
class Clearance(Data):
    """What an arm or a Robot keeps clear of: of itself and of obstacles around it, by a margin.

    Kept apart are all capsules whose links are not next to one another, on one branch of a Robot or on two, and each
    capsule of a link that moves from each obstacle; but for pairs that overlap in every posture, and for those that are
    allowed to meet. Names without which a pair could not be told are given: 'link_3' to a capsule, 'obstacle_1' to an
    obstacle.

    Raises ParameterError where a shape is none, an obstacle is not in the base frame or shares another's name, or an
    allowed name is nobody's.
    """

    kind: ClassVar[str] = "clearance"
    capsules: Sequence[Capsule] = parameter("On the arm's links, which they contain.")
    obstacles: Sequence[Obstacle] = parameter(
        "In the base frame, which for an arm in the plane has its z axis out of it.", default=()
    )
    _: KW_ONLY
    margin: float = parameter("Least distance of two shapes.", NOT_NEGATIVE, default=MARGIN, unit="m")
    allowed: Sequence[tuple[str, str]] = parameter("Names of pairs that need not be kept apart.", default=())
    away_gain: float = parameter(
        "How strongly self-motion keeps the arm away from shapes, where the task leaves it free to; at velocity level "
        "in rad/(m s).",
        NOT_NEGATIVE,
        default=0.0,
        unit="rad/(m s^2)",
    )
    away_range: float = parameter("From what distance on, beyond the margin.", POSITIVE, default=0.1, unit="m")

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
                raise ParameterError("obstacles", i, each, f"obstacles[{i}].name = {each.name!r}: is there twice")
            if isinstance(each, Capsule) and each.link != 0:
                raise ParameterError("obstacles", i, each, f"obstacles[{i}].link = {each.link}: must be 0, the base")
        names = sorted({*names, *(each.name for each in capsules)})
        for i, pair in enumerate(allowed):
            if len(pair) != 2:
                raise ParameterError("allowed", i, pair, f"allowed[{i}] = {pair!r:.80}: must be two names")
            for name in pair:
                if name not in names:
                    problem = f"allowed[{i}]: no shape is called {name!r}{suggestion(name, names)}"
                    raise ParameterError("allowed", i, name, problem)
        for name, values in {"capsules": capsules, "obstacles": obstacles, "allowed": allowed}.items():
            object.__setattr__(self, name, values)

    @classmethod
    def preset(cls, name: str, *, obstacles: Sequence[Obstacle] = (), margin: float = MARGIN) -> Clearance:
        """Clearance of SerialArm.preset(name) or Robot.preset(name), by capsules that contain the maker's meshes.

        Tools are not among them. Links that the joints' bounds keep apart anyway are allowed to meet. Raises
        ParameterError where there is none.
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
        """Clearance of Robot.from_arms(arms, placements), by the capsules of a clearance of each arm.

        Capsule 'panda_link5' of arm 'left' is 'left_panda_link5'. Pairs that a clearance allows are allowed, beside
        those in `allowed`. An arm without a clearance has no capsules.

        Raises ParameterError where a clearance is of no arm, or has obstacles: give those in the robot's base frame.
        """
        for name, clearance in clearances.items():
            if name not in arms:
                raise wrong("clearances", name, f" has {name!r}: must be names of arms{suggestion(name, arms)}")
            if clearance.obstacles:
                problem = f"[{name!r}] has obstacles: give those to from_arms(obstacles=), in the robot's base frame"
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
    ) -> Clearance:
        """Clearance of a URDF file's robot, by capsules that contain the file's collision geometry.

        The robot is SerialArm.from_urdf(path, tip, base). Without tip, it is Robot.from_urdf(path, base=base,
        locked=locked, tips=tips): give the same arguments to both. Joints that do not move are held where the robot
        holds them.

        Each link gets one capsule, or up to per_link where these take less room, and one more, unless per_link is 1,
        where capsules of two links would often be closer than the margin though the links are not. srdf is a file of
        MoveIt's, whose disabled pairs are allowed to meet, beside those in `allowed`. Needs the extra 'clearance',
        meshes a part of it alone.

        postures: of shape (n,) or (k, n) [rad] or [m], in which the robot shall be accepted. There, links that are
        closer than the margin by their capsules get up to 8 capsules each, unless their meshes are closer as well.
        Unless given, they are the group states of the SRDF file that have all of the robot's joints and no other, a
        planar base at zero; none where per_link is 1.

        Raises ParameterError where postures have another shape or are not finite, or an argument is for another kind of
        robot, ValueError where a file is not sound, OSError where one cannot be read.
        """
        from .io.capsules import capsules_of
        from .io.srdf import read_disabled_pairs

        cls([], obstacles, margin=margin)  # Whether these are sound is said before the fit, which takes long.
        pairs = [] if srdf is None else read_disabled_pairs(srdf)
        if tips is not None:
            tips = [tips] if isinstance(tips, str) else list(tips)
        if tip is None:
            joints = [each.joint for each in Robot.from_urdf(path, base=base, locked=locked, tips=tips).joints]
        else:
            joints = list(SerialArm.from_urdf(path, tip, base).joints)
        capsules = capsules_of(
            path,
            tip,
            base,
            locked=locked,
            tips=tips,
            per_link=per_link,
            margin=margin,
            required=_postures(joints, postures, srdf if per_link != 1 else None),
            allowed=[*pairs, *allowed],
        )
        names = {each.name for each in capsules}
        disabled = [pair for pair in pairs if names.issuperset(pair)]
        return cls(capsules, obstacles, margin=margin, allowed=[*disabled, *allowed])

    def nearest(self, arm: Arm | Robot, q: ArrayLike) -> Nearest | None:
        """The pair that is nearest to one another in a posture q, shape (n,) [rad]; None where no pair is kept apart.

        Raises ParameterError where q is no posture of the arm or the robot, or a capsule's link is none of it.
        """
        return self._of(arm).nearest(q)

    def pairs(self, arm: Arm | Robot) -> list[tuple[str, str]]:
        """Names of the pairs that are kept apart; one for each pair of capsules, so some may be there twice."""
        return self._of(arm).pairs()

    def left_out(self, arm: Arm | Robot) -> list[tuple[str, str]]:
        """Names of the pairs that no motion can keep apart, since they overlap in every posture."""
        return self._of(arm).left_out()

    def _of(self, arm: Arm | Robot) -> CoreClearance:
        """The compiled part for an arm or a robot, which is kept for the next call."""
        known: tuple[Arm | Robot, CoreClearance] | None = self.__dict__.get("_known")
        if known is None or known[0] is not arm:
            self.__dict__["_known"] = known = arm, CoreClearance(arm, self)
        return known[1]


def _postures(joints: Sequence[Joint], given: ArrayLike | None, srdf: str | os.PathLike[str] | None) -> Array | None:
    """Positions (k, N) of all joints in postures that are given, or that an SRDF file has; None without any."""
    from .io.capsule_gaps import follow
    from .io.srdf import read_group_states

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
    return follow(joints, positions)


def _is_whole(state: Mapping[str, float], names: Sequence[str]) -> bool:
    """Whether a group state has all joints of a robot, but for those of its base, and no other."""
    return set(names) - PLANAR_BASE <= set(state) <= set(names)


def _require(name: str, shapes: Iterable[Any], kinds: tuple[Any, ...], demand: str) -> None:
    if not isinstance(shapes, (list, tuple)):
        raise wrong(name, shapes, f" = {shapes!r:.60}: must be a list")
    for i, each in enumerate(shapes):
        if not isinstance(each, kinds):
            raise ParameterError(name, i, each, f"{name}[{i}] = {each!r:.80}: must be {demand}")


def _from_urdf(
    file: str,
    tip: str | None = None,
    base: str | None = None,
    *,
    locked: Mapping[str, float] | None = None,
    tips: Sequence[str] | None = None,
    srdf: str | None = None,
    obstacles: Sequence[Obstacle] = (),
    margin: float = MARGIN,
    per_link: int = 2,
    postures: ArrayLike | None = None,
) -> Clearance:
    return Clearance.from_urdf(
        file,
        tip,
        base,
        locked=locked,
        tips=tips,
        srdf=srdf,
        obstacles=obstacles,
        margin=margin,
        per_link=per_link,
        postures=postures,
    )


# What makes a clearance, by the kind that a table has.
CLEARANCES: dict[str, Callable[..., Clearance]] = {Clearance.kind: Clearance, "urdf": _from_urdf}
