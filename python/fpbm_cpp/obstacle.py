"""Obstacles: half-spaces, cuboids and capsules."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import KW_ONLY
from typing import ClassVar

from ._core import Shape
from ._types import ArrayField
from .capsule import Capsule
from .joints import FRAME
from .parameter import NOT_NEGATIVE, Data, data, parameter

NAME = "Name in errors and in Nearest; if empty, 'obstacle_1', 'obstacle_2' and so on."


@data
class HalfSpace(Data, Shape):
    """A floor or a wall: all points x with n'x <= offset, where n is the unit normal.

    Raises ParameterError if the normal is zero.
    """

    kind: ClassVar[str] = "half_space"
    normal: ArrayField = parameter("Normal that points out of the solid; its length is ignored.", shape="(3,)")
    offset: float = parameter("Distance of the surface from the base frame's origin, along the normal.", unit="m")
    _: KW_ONLY
    name: str = parameter(NAME, default="")

    def _finish(self) -> None:
        Shape.__init__(self, normal=self.normal, offset=self.offset)


@data
class Cuboid(Data, Shape):
    """A box: all points x with |x_i| <= half_i in the frame of the box.

    Raises ParameterError if the pose is not a frame.
    """

    kind: ClassVar[str] = "cuboid"
    pose: ArrayField = parameter("Frame of the box in the base frame; its origin is the centre of the box.", FRAME)
    half: ArrayField = parameter("Half the length of each edge.", NOT_NEGATIVE, shape="(3,)", unit="m")
    _: KW_ONLY
    name: str = parameter(NAME, default="")

    def _finish(self) -> None:
        Shape.__init__(self, pose=self.pose, half=self.half)


Obstacle = Capsule | HalfSpace | Cuboid
OBSTACLES: dict[str, Callable[..., Obstacle]] = {each.kind: each for each in (Capsule, HalfSpace, Cuboid)}
