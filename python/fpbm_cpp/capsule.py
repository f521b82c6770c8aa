"""Capsules, on the links of an arm or as obstacles."""

from __future__ import annotations

from typing import ClassVar

from ._core import Shape
from ._types import ArrayField
from .parameter import NOT_NEGATIVE, Data, data, parameter

MARGIN = 0.01  # Default of the least distance between two shapes [m].


@data
class Capsule(Data, Shape):
    """All points within a radius of a segment that is fixed to a link; a ball if both ends of the segment coincide.

    The link of an obstacle is 0, the base. Raises ParameterError if an argument is out of range.
    """

    kind: ClassVar[str] = "capsule"
    link: int = parameter(
        "Number of the link: link i is the child of joint i, counted from 1; 0 is the base. The frame of link 0 is the "
        "base frame. The frame of another link is the frame of its joint after the motion of the joint, in a SerialArm "
        "placement_1 motion_1(q_1) ... placement_link motion_link(q_link).",
        NOT_NEGATIVE,
    )
    a: ArrayField = parameter("One end of the segment, in the link's frame.", shape="(3,)", unit="m")
    b: ArrayField = parameter("Other end of the segment.", shape="(3,)", unit="m")
    radius: float = parameter("Radius.", NOT_NEGATIVE, unit="m")
    name: str = parameter("Name of the link in the URDF file; capsules of one link share the name.", default="")

    def _finish(self) -> None:
        Shape.__init__(self, a=self.a, b=self.b, radius=self.radius, link=self.link)
