"""Shapes of the world that an arm is to keep clear of; a Capsule may be one, too."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import KW_ONLY
from typing import ClassVar

from ._core import Shape
from ._types import ArrayField
from .arms import FRAME
from .capsule import Capsule
from .parameter import NOT_NEGATIVE, Data, data, parameter

NAME = "What errors and Nearest call it; 'obstacle_1' and so on where empty."


@data
class HalfSpace(Data, Shape):
    """A floor or a wall: all points x with n'x <= offset, for the normal n at length 1.

    Raises ParameterError where the normal is zero.
    """

    kind: ClassVar[str] = "half_space"
    normal: ArrayField = parameter("Out of what is solid; its length does not matter.", shape="(3,)")
    offset: float = parameter("How far along the normal its surface is from the base frame's origin.", unit="m")
    _: KW_ONLY
    name: str = parameter(NAME, default="")

    def _finish(self) -> None:
        Shape.__init__(self, normal=self.normal, offset=self.offset)


@data
class Cuboid(Data, Shape):
    """A box: all points whose coordinates in its own frame are at most half its edges, either way.

    Raises ParameterError where the pose is no frame.
    """

    kind: ClassVar[str] = "cuboid"
    pose: ArrayField = parameter("Its frame, whose origin is its centre, in the base frame.", FRAME)
    half: ArrayField = parameter("Half the length of each edge.", NOT_NEGATIVE, shape="(3,)", unit="m")
    _: KW_ONLY
    name: str = parameter(NAME, default="")

    def _finish(self) -> None:
        Shape.__init__(self, pose=self.pose, half=self.half)


Obstacle = Capsule | HalfSpace | Cuboid
OBSTACLES: dict[str, Callable[..., Obstacle]] = {each.kind: each for each in (Capsule, HalfSpace, Cuboid)}
