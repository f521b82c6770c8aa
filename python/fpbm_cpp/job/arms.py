"""The arms of a job, one kind a class."""

from typing import Annotated, Literal, Optional, Union

from pydantic import Field

from .._core import Arm, PlanarArm
from ..joint import Joint
from ..serial_arm import SerialArm
from .section import Numbers, Section


class Preset(Section):
    """An arm of a data sheet."""

    kind: Literal["preset"] = "preset"
    name: Literal["panda", "iiwa14", "gen3"]

    @property
    def label(self) -> str:
        """What to call it."""
        return self.name

    def build(self) -> Arm:
        """The arm."""
        return SerialArm.preset(self.name)


class Planar(Section):
    """An arm in the plane."""

    kind: Literal["planar"] = "planar"
    lengths: Numbers

    @property
    def label(self) -> str:
        """What to call it."""
        return f"planar arm of {len(self.lengths)} links"

    def build(self) -> Arm:
        """The arm."""
        return PlanarArm(self.lengths)


class Urdf(Section):
    """An arm between two links of a URDF file, which is named as seen from the job's folder."""

    kind: Literal["urdf"] = "urdf"
    file: str
    tip: Optional[str] = Field(default=None, description="Link of a URDF file to move.")
    base: Optional[str] = Field(default=None, description="Link of a URDF file that stays; the root unless given.")

    @property
    def label(self) -> str:
        """What to call it."""
        return f"{self.file} to {self.tip}"

    def build(self) -> Arm:
        """The arm."""
        try:
            return SerialArm.from_urdf(self.file, self.tip or "", self.base)  # Which says what links there are.
        except ValueError as error:
            raise ValueError(str(error).removeprefix(f"{self.file}: ")) from None


class Dh(Section):
    """An arm of a Denavit-Hartenberg table."""

    kind: Literal["dh"] = "dh"
    table: Numbers
    convention: Literal["classic", "modified"]
    types: Optional[list[str]] = None
    lower: Optional[Numbers] = None
    upper: Optional[Numbers] = None
    velocity: Optional[Numbers] = None
    acceleration: Optional[Numbers] = None
    names: Optional[list[str]] = None
    base: Optional[Numbers] = None
    tip: Optional[Numbers] = None

    @property
    def label(self) -> str:
        """What to call it."""
        return "arm of a Denavit-Hartenberg table"

    def build(self) -> Arm:
        """The arm."""
        return SerialArm.from_dh(**self.given())


class JointEntry(Section):
    """One joint of a chain."""

    type: Literal["revolute", "continuous", "prismatic"] = "revolute"
    placement: Optional[Numbers] = None
    axis: Optional[Numbers] = None
    lower: Optional[float] = None
    upper: Optional[float] = None
    velocity: Optional[float] = None
    acceleration: Optional[float] = None
    name: Optional[str] = None


class Joints(Section):
    """An arm of joints from base to tip."""

    kind: Literal["joints"] = "joints"
    joints: list[JointEntry]
    tip: Optional[Numbers] = None

    @property
    def label(self) -> str:
        """What to call it."""
        return f"arm of {len(self.joints)} joints"

    def build(self) -> Arm:
        """The arm."""
        return SerialArm([Joint(**joint.given()) for joint in self.joints], self.tip)


AnyArm = Annotated[Union[Preset, Planar, Urdf, Dh, Joints], Field(discriminator="kind")]
