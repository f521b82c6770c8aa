"""Arms in the plane and in space."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar

from numpy.typing import ArrayLike

from ._core import PRESETS, dh, preset
from ._core import Arm as CoreArm
from ._types import ArrayField
from .errors import not_one_of, require
from .joints import FRAME, IDENTITY, Joint, JointLimits, joint_table, limited, require_length
from .parameter import POSITIVE, Data, Parameter, data, from_file, parameter
from .shown import html_table
from .urdf.chain import read_urdf

__all__ = ["Arm", "PlanarArm", "SerialArm"]


class Arm(Data, CoreArm):
    """A robot arm of n joints."""

    kind: ClassVar[str]

    @cached_property
    def limits(self) -> JointLimits:
        """Bounds of the joints' motion."""
        return JointLimits(**self.bounds())


@data
class PlanarArm(Arm):
    """Planar arm of n revolute joints.

    The tip is f(q) = sum_i l_i (cos th_i, sin th_i) with th_i = q_1 + ... + q_i. Joint angles [rad] are relative to
    the previous link; the first angle is relative to the x axis of the base frame. The pose of the tip is (x, y, th_n).

    Raises ParameterError if a length is out of range, or if there are too few or too many lengths.
    """

    kind: ClassVar[str] = "planar"
    lengths: ArrayField = parameter("Link lengths, 2 to MAX_DOF of them.", POSITIVE, shape="(n,)", unit="m")

    def _repr_html_(self) -> str:
        return html_table("PlanarArm", ["link", "length [m]"], enumerate(self.lengths, 1))

    def _finish(self) -> None:
        CoreArm.__init__(self, self.lengths)


@data
class SerialArm(Arm):
    """A chain of revolute, continuous and prismatic joints in space.

    Joint positions are in radians or metres. The placement of the first joint is in the base frame.

    Raises ParameterError if there are too few or too many joints, an axis is zero, a number is out of range or not
    finite, a matrix is not a frame, or bounds leave no range for a joint.
    """

    kind: ClassVar[str] = "joints"
    joints: Sequence[Joint] = parameter("Joints from base to tip, 1 to MAX_DOF of them. Empty names get a default.")
    tip: ArrayField = parameter("Frame of the tip in the last joint's frame.", FRAME, default=IDENTITY)

    def _finish(self) -> None:
        for i, joint in enumerate(self.joints):
            require("joints", joint, Joint, "a Joint", index=i)
        named = tuple(j if j.name else replace(j, name=f"joint_{i}") for i, j in enumerate(self.joints, 1))
        object.__setattr__(self, "joints", named)
        CoreArm.__init__(self, list(named), self.tip)

    def __str__(self) -> str:
        return f"<SerialArm of {self.dof} joints, {self.joints[0].name} to {self.joints[-1].name}>"

    def _repr_html_(self) -> str:
        moving = [each.type for each in self.joints if each.mimic is None]
        return joint_table(str(self), self.joint_names, moving, self.limits)

    @classmethod
    def from_joints(cls, joints: Sequence[Joint], tip: ArrayLike = IDENTITY) -> SerialArm:
        """Arm of these joints from base to tip: SerialArm(joints, tip)."""
        return cls(joints, tip)

    @classmethod
    def from_dh(
        cls,
        table: ArrayLike,
        convention: str,
        *,
        types: Sequence[str] | None = None,
        lower: ArrayLike | None = None,
        upper: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
        jerk: ArrayLike | None = None,
        names: Sequence[str] | None = None,
        base: ArrayLike | None = None,
        tip: ArrayLike | None = None,
    ) -> SerialArm:
        """Arm from a table of Denavit-Hartenberg parameters.

        In the classic convention, frame i in frame i - 1 is Rz(theta) Tz(d) Tx(a) Rx(alpha). In the modified convention
        (Craig), frame i in frame i - 1 is Rx(alpha) Tx(a) Rz(theta) Tz(d), and a and alpha belong to the previous link.

        Parameters
        ----------
        table : array_like, shape (n, 4)
            One row (a, alpha, d, theta) per joint [m, rad, m, rad]. The joint position is added to theta, or to d if
            the joint is prismatic.
        convention : str
            'classic' or 'modified'.
        types, lower, upper, velocity, acceleration, jerk, names : array_like, shape (n,), optional
            As in Joint: 'revolute' (default), 'continuous' or 'prismatic'; bounds of the motion, one number for all
            joints or an array; names.
        base, tip : array_like, shape (4, 4), optional
            Frame 0 in the base frame, and the frame of the tip in frame n.
        """
        rows = Parameter(name="table", shape="(n, 4)").check(table)
        joints, end = dh(rows, convention, ["revolute"] * len(rows) if types is None else list(types))
        limits = JointLimits(lower=lower, upper=upper, velocity=velocity, acceleration=acceleration, jerk=jerk)
        if names is not None:
            require_length("names", names, len(rows))
            joints = [{**joint, "name": name} for joint, name in zip(joints, names)]
        if base is not None and joints:
            joints[0]["placement"] = _frame("base", base) @ joints[0]["placement"]
        chain = limited([Joint(**joint) for joint in joints], limits)
        return cls(chain, end if tip is None else end @ _frame("tip", tip))

    @classmethod
    def from_urdf(
        cls, path: str | os.PathLike[str], tip: str, base: str | None = None, *, limits: JointLimits | None = None
    ) -> SerialArm:
        """Arm between two links of a URDF file: base (default: the root) and tip. Expand xacro first.

        Fixed joints become part of the frames. Bounds, names and mimic joints are kept. A velocity, acceleration or
        jerk that is 0 or missing is not bounded. limits replaces bounds of the file, before the bounds are checked.

        A UrdfWarning is issued if lower = upper: the joint is fixed; if the range of a mimic joint leaves no range for
        its leader: the range of the mimic joint is ignored; and if the leader of a mimic joint is not a moving joint
        between base and tip: the mimic joint is fixed at its position for the leader at zero.

        Raises ValueError if the file is not a valid URDF or has no chain between the links, OSError if the file cannot
        be read.
        """
        return cls(*read_urdf(path, tip, base, limits))

    @classmethod
    def preset(cls, name: str) -> SerialArm:
        """Arm from a data sheet, up to the flange. name: one of PRESETS, for example 'panda'. Raises ParameterError."""
        if name not in PRESETS:
            raise not_one_of("name", name, PRESETS)
        joints, tip = preset(name)
        return cls([Joint(**joint) for joint in joints], tip)


def _frame(name: str, value: ArrayLike) -> Any:
    return replace(FRAME, name=name).check(value)


# Constructors of arms, by the kind in a table.
ARMS: dict[str, Callable[..., Arm]] = {
    "preset": SerialArm.preset,
    PlanarArm.kind: PlanarArm,
    "urdf": from_file(SerialArm.from_urdf, "limits"),
    "dh": SerialArm.from_dh,
    SerialArm.kind: SerialArm,
}
