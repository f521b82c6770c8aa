"""What an arm keeps clear of."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import KW_ONLY, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ._core import Clearance as CoreClearance
from ._core import Nearest, preset_capsules
from ._types import Array
from .arms import Arm, Joint, SerialArm
from .capsule import Capsule
from .errors import ParameterError, suggestion, wrong
from .obstacle import OBSTACLES, Obstacle
from .parameter import NOT_NEGATIVE, POSITIVE, Data, data, parameter

MARGIN = 0.01


@data
class Clearance(Data):
    """What an arm keeps clear of: of itself and of obstacles around it, by a margin.

    Kept apart are all capsules whose links are not next to one another, and each capsule of a link that moves from each
    obstacle; but for pairs that overlap in every posture, and for those that are allowed to meet. Names without which a
    pair could not be told are given: 'link_3' to a capsule, 'obstacle_1' to an obstacle.

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
        """Clearance of SerialArm.preset(name), by capsules that contain its maker's meshes, without tools.

        Links that the joints' bounds keep apart anyway are allowed to meet. Raises ParameterError where there is none.
        """
        links, allowed = preset_capsules(name)
        capsules = [Capsule(link, a, b, radius, title) for link, a, b, radius, title in links]
        return cls(capsules, obstacles, margin=margin, allowed=allowed)

    @classmethod
    def from_urdf(
        cls,
        path: str | os.PathLike[str],
        tip: str,
        base: str | None = None,
        *,
        srdf: str | os.PathLike[str] | None = None,
        obstacles: Sequence[Obstacle] = (),
        margin: float = MARGIN,
        allowed: Sequence[tuple[str, str]] = (),
        per_link: int = 2,
        postures: ArrayLike | None = None,
    ) -> Clearance:
        """Clearance of SerialArm.from_urdf(path, tip, base), by capsules that contain the file's collision geometry.

        Each link gets one capsule, or up to per_link where these take less room, and one more, unless per_link is 1,
        where capsules of two links would often be closer than the margin though the links are not. srdf is a file of
        MoveIt's, whose disabled pairs are allowed to meet, beside those in `allowed`. Needs the extra 'clearance',
        meshes a part of it alone.

        postures: of shape (n,) or (k, n) [rad] or [m], in which the arm shall be accepted. There, links that are closer
        than the margin by their capsules get up to 8 capsules each, unless their meshes are closer as well. Unless
        given, they are the group states of the SRDF file that have all of the arm's joints and no other; none where
        per_link is 1.

        Raises ParameterError where postures have another shape or are not finite, ValueError where a file is not sound,
        OSError where one cannot be read.
        """
        from .io.capsules import capsules_of
        from .io.srdf import read_disabled_pairs

        cls([], obstacles, margin=margin)  # Whether these are sound is said before the fit, which takes long.
        pairs = [] if srdf is None else read_disabled_pairs(srdf)
        required = _postures(SerialArm.from_urdf(path, tip, base).joints, postures, srdf if per_link != 1 else None)
        capsules = capsules_of(
            path, tip, base, per_link=per_link, margin=margin, required=required, allowed=[*pairs, *allowed]
        )
        names = {each.name for each in capsules}
        disabled = [pair for pair in pairs if names.issuperset(pair)]
        return cls(capsules, obstacles, margin=margin, allowed=[*disabled, *allowed])

    def nearest(self, arm: Arm, q: ArrayLike) -> Nearest | None:
        """The pair that is nearest to one another in a posture q, shape (n,) [rad]; None where no pair is kept apart.

        Raises ParameterError where q is no posture of the arm, or a capsule's link is none of it.
        """
        return self._of(arm).nearest(q)

    def pairs(self, arm: Arm) -> list[tuple[str, str]]:
        """Names of the pairs that are kept apart; one for each pair of capsules, so some may be there twice."""
        return self._of(arm).pairs()

    def left_out(self, arm: Arm) -> list[tuple[str, str]]:
        """Names of the pairs that no motion can keep apart, since they overlap in every posture."""
        return self._of(arm).left_out()

    def _of(self, arm: Arm) -> CoreClearance:
        """The compiled part for an arm, which is kept for the next call."""
        known: tuple[Arm, CoreClearance] | None = self.__dict__.get("_known")
        if known is None or known[0] is not arm:
            self.__dict__["_known"] = known = arm, CoreClearance(arm, self)
        return known[1]


def _postures(joints: Sequence[Joint], given: ArrayLike | None, srdf: str | os.PathLike[str] | None) -> Array | None:
    """Postures (k, n) that are given, or that an SRDF file has for these joints; None where there are none."""
    if given is not None:
        try:
            q = np.atleast_2d(np.asarray(given, dtype=float))
        except (TypeError, ValueError):
            raise wrong("postures", given, f" = {given!r:.60}: must be numbers") from None
        if q.ndim != 2 or q.shape[1] != len(joints) or not np.all(np.isfinite(q)):
            demand = f"must be finite, of shape ({len(joints)},) or (k, {len(joints)})"
            raise wrong("postures", given, f" of shape {np.shape(given)}: {demand}")
        return q
    if srdf is None:
        return None
    from .io.srdf import read_group_states

    free = [joint.name for joint in joints if joint.mimic is None]
    states = [state for state in read_group_states(srdf) if sorted(state) == sorted(free)]
    q = np.zeros((len(states), len(joints)))
    for i, joint in enumerate(joints):
        leader, ratio, offset = joint.mimic or (i, 1.0, 0.0)
        q[:, i] = [ratio * state[joints[leader].name] + offset for state in states]
    return q if states else None


def _require(name: str, shapes: Iterable[Any], kinds: tuple[Any, ...], demand: str) -> None:
    if not isinstance(shapes, (list, tuple)):
        raise wrong(name, shapes, f" = {shapes!r:.60}: must be a list")
    for i, each in enumerate(shapes):
        if not isinstance(each, kinds):
            raise ParameterError(name, i, each, f"{name}[{i}] = {each!r:.80}: must be {demand}")


def _from_urdf(
    file: str,
    tip: str,
    base: str | None = None,
    *,
    srdf: str | None = None,
    obstacles: Sequence[Obstacle] = (),
    margin: float = MARGIN,
    per_link: int = 2,
    postures: ArrayLike | None = None,
) -> Clearance:
    return Clearance.from_urdf(
        file, tip, base, srdf=srdf, obstacles=obstacles, margin=margin, per_link=per_link, postures=postures
    )


# What makes a clearance, by the kind that a table has.
CLEARANCES: dict[str, Callable[..., Clearance]] = {Clearance.kind: Clearance, "urdf": _from_urdf}
