"""The schemes of a job, one kind a class, with the options that they have in Python."""

from typing import Annotated, ClassVar, Literal, Optional, Union

from pydantic import Field

from .. import _core
from ..serial_arm import SerialArm
from .section import Numbers, Section


class Point(Section):
    """A point for the tip of the first joints, an elbow, say."""

    kind: Literal["point"] = "point"
    joints: int
    x: Numbers
    k1: Optional[float] = None
    k2: Optional[float] = None

    def build(self, arm: _core.Arm) -> _core.SecondTask:
        """The second task, of the arm's first joints."""
        if not 0 < self.joints < arm.dof:
            raise ValueError(f"joints = {self.joints}: must be from 1 to {arm.dof - 1}, the arm's first so many")
        first: _core.Arm
        if isinstance(arm, SerialArm):
            first = SerialArm(arm.joints[: self.joints])
        else:
            assert isinstance(arm, _core.PlanarArm)
            first = _core.PlanarArm(arm.lengths[: self.joints])
        return _core.SecondTask(first, **self.given("joints"))


class Gaze(Section):
    """A direction for the tip's z axis."""

    kind: Literal["gaze"] = "gaze"
    direction: Numbers
    k1: Optional[float] = None
    k2: Optional[float] = None

    def build(self, arm: _core.Arm) -> _core.Gaze:
        """The second task."""
        return _core.Gaze(**self.given())


SecondTask = Annotated[Union[Point, Gaze], Field(discriminator="kind")]


class _Scheme(Section):
    law: ClassVar[type[_core.Scheme]]

    rest_posture: Optional[Numbers] = Field(default=None, description="Posture that the null space is drawn to [rad].")
    null_stiffness: Optional[float] = Field(
        default=None, description="How strongly it is [1/s^2], or [1/s] for velocities."
    )
    c: Optional[Numbers] = Field(default=None, description="Free vector of the general solution [rad/s^2] or [rad/s].")
    joint_centring: Optional[float] = Field(default=None, description="Gain toward the middle of the joints' limits.")
    manipulability_gain: Optional[float] = Field(
        default=None, description="Gain up the gradient of the manipulability."
    )
    second_task: Optional[SecondTask] = None
    singular_radius: Optional[float] = Field(
        default=None, description="Damping near singular postures; 0.02 is a good one, none unless given."
    )
    singular_brake: Optional[float] = Field(default=None, description="Damping of the null space there [1/s].")

    def build(self, arm: _core.Arm) -> _core.Scheme:
        """The scheme, for this arm."""
        options = self.given("second_task")
        if self.second_task is not None:
            options["second_task"] = self.second_task.build(arm)
        return self.law(**options)


class _Velocity(_Scheme):
    k: Optional[float] = Field(default=None, description="Position feedback of mvn and wmvn [1/s]; none unless given.")


class _Acceleration(_Scheme):
    null_damping: float = Field(default=2.0, description="Damping of the self-motion [1/s], at acceleration level.")


class _Weighted(_Scheme):
    weights: Optional[Numbers] = Field(
        default=None, description="Diagonal of W, or its rows, as in '2,1; 1,2'; ones unless given. Only ratios matter."
    )


class _Balanced(_Weighted, _Acceleration):
    alpha: float = Field(default=0.6, description="Share of WMVN, in [0, 1]; MAN has the rest.")


class _Feedback(_Scheme):
    k1: float = Field(default=10.0, description="FPBM's feedback gain on velocity [1/s].")
    k2: float = Field(default=25.0, description="FPBM's feedback gain on position [1/s^2].")


class MVN(_Velocity):
    """Minimum velocity norm, (6)."""

    kind: Literal["mvn"] = "mvn"
    law = _core.MVN


class WMVN(_Velocity, _Weighted):
    """Weighted minimum velocity norm, (7)."""

    kind: Literal["wmvn"] = "wmvn"
    law = _core.WMVN


class MAN(_Acceleration):
    """Minimum acceleration norm, (8)."""

    kind: Literal["man"] = "man"
    law = _core.MAN


class WMVNAcceleration(_Weighted, _Acceleration):
    """Weighted minimum velocity norm at acceleration level, (9)."""

    kind: Literal["wmvn_acceleration"] = "wmvn_acceleration"
    law = _core.WMVNAcceleration


class Balanced(_Balanced):
    """Balance of MAN and WMVN, (16)."""

    kind: Literal["balanced"] = "balanced"
    law = _core.Balanced


class FPBM(_Balanced, _Feedback):
    """The balance with feedback, (13)."""

    kind: Literal["fpbm"] = "fpbm"
    law = _core.FPBM


AnyScheme = Annotated[Union[MVN, WMVN, MAN, WMVNAcceleration, Balanced, FPBM], Field(discriminator="kind")]
