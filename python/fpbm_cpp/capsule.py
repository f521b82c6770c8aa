"""Capsules, on an arm's links or in the world around it."""

from __future__ import annotations

from typing import ClassVar

from ._core import Shape
from ._types import ArrayField
from .parameter import NOT_NEGATIVE, Data, data, parameter


@data
class Capsule(Data, Shape):
    """All points of a link within a radius of a segment; a ball where both ends are one point.

    As an obstacle in the world it is of link 0, the base. Raises ParameterError.
    """

    kind: ClassVar[str] = "capsule"
    link: int = parameter(
        "How many of arm.joints move it: 0 is the base. Its frame is that of joint number link after its motion, "
        "placement_1 motion_1(q_1) ... placement_link motion_link(q_link), or the base frame.",
        NOT_NEGATIVE,
    )
    a: ArrayField = parameter("One end of the segment, in the link's frame.", shape="(3,)", unit="m")
    b: ArrayField = parameter("The other end.", shape="(3,)", unit="m")
    radius: float = parameter("Radius.", NOT_NEGATIVE, unit="m")
    name: str = parameter("The link's name in its URDF file; capsules of one link share it.", default="")

    def _finish(self) -> None:
        Shape.__init__(self, a=self.a, b=self.b, radius=self.radius, link=self.link)
