"""Arms in the plane and in space."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import KW_ONLY, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ._core import PRESETS, dh, preset
from ._core import Arm as CoreArm
from ._types import Array, ArrayField, OptionalArrayField
from .errors import not_one_of, require
from .inertia import Inertia
from .joints import FRAME, IDENTITY, Joint, JointLimits, joint_table, limited, require_length
from .mechanism import Mechanism
from .parameter import NOT_NEGATIVE, POSITIVE, Parameter, data, from_file, parameter, renamed
from .shown import html_table
from .urdf.chain import read_urdf

__all__ = ["Arm", "PlanarArm", "SerialArm"]


class Arm(Mechanism, CoreArm):
    """A robot arm of n joints."""

    kind: ClassVar[str]

    if TYPE_CHECKING:

        @property
        def joints(self) -> Sequence[Joint]:
            """Joints from base to tip."""


@data
class PlanarArm(Arm):
    """Planar arm of n revolute joints.

    The tip is f(q) = sum_i l_i (cos th_i, sin th_i) with th_i = q_1 + ... + q_i. Joint angles [rad] are relative to
    the previous link; the first angle is relative to the x axis of the base frame. The pose of the tip is (x, y, th_n).

    joints are the joints in space. The frame of a link has its origin at the joint, and x along the link. Gravity acts
    along -z, across the plane, and has no effect; with_gravity((0, -9.81, 0)) is for a vertical plane.

    Raises ParameterError if a number is out of range, or if there are too few or too many lengths.
    """

    kind: ClassVar[str] = "planar"
    lengths: ArrayField = parameter("Link lengths, 2 to MAX_DOF of them.", POSITIVE, shape="(n,)", unit="m")
    masses: OptionalArrayField = parameter(
        "Masses of the links, which are uniform rods without centers and inertias; default: links without mass.",
        NOT_NEGATIVE,
        default=None,
        shape="(n,)",
        unit="kg",
    )
    _: KW_ONLY
    centers: OptionalArrayField = parameter(
        "Centres of mass of the links, in their frames; default: the middles.", default=None, shape="(n, 3)", unit="m"
    )
    inertias: OptionalArrayField = parameter(
        "Rotational inertias of the links about their centres of mass; default: uniform rods.",
        default=None,
        shape="(n, 3, 3)",
        unit="kg m^2",
    )

    def _repr_html_(self) -> str:
        return html_table("PlanarArm", ["link", "length [m]"], enumerate(self.lengths, 1))

    def _finish(self) -> None:
        for name in ("masses", "centers", "inertias"):
            if (values := getattr(self, name)) is not None:
                require_length(name, values, len(self.lengths))
        joints, tip = _in_space(self)
        object.__setattr__(self, "joints", joints)
        CoreArm.__init__(self, list(joints), tip, self.gravity_vector, self.lengths)

    def _carrying(self, link: int, body: Inertia) -> PlanarArm:
        joints = list(self.joints)
        joints[link - 1] = joints[link - 1].carrying(body)
        fields = {"masses": "mass", "centers": "center", "inertias": "inertia"}
        return self._with(**{field: [getattr(each, name) for each in joints] for field, name in fields.items()})


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
        CoreArm.__init__(self, list(named), self.tip, self.gravity_vector)

    def _carrying(self, link: int, body: Inertia) -> SerialArm:
        joints = list(self.joints)
        joints[link - 1] = joints[link - 1].carrying(body)
        return self._with(joints=joints)

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
        effort: ArrayLike | None = None,
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
        types, lower, upper, velocity, acceleration, jerk, effort, names : array_like, shape (n,), optional
            As in Joint: 'revolute' (default), 'continuous' or 'prismatic'; bounds, one number for all joints or an
            array; names.
        base, tip : array_like, shape (4, 4), optional
            Frame 0 in the base frame, and the frame of the tip in frame n.
        """
        rows = Parameter(name="table", shape="(n, 4)").check(table)
        joints, end = dh(rows, convention, ["revolute"] * len(rows) if types is None else list(types))
        limits = JointLimits(
            lower=lower, upper=upper, velocity=velocity, acceleration=acceleration, jerk=jerk, effort=effort
        )
        if names is not None:
            require_length("names", names, len(rows))
            joints = [{**joint, "name": name} for joint, name in zip(joints, names)]
        if base is not None and joints:
            joints[0]["placement"] = _frame("base", base) @ joints[0]["placement"]
        chain = limited([Joint(**joint) for joint in joints], limits)
        return cls(chain, end if tip is None else end @ _frame("tip", tip))

    @classmethod
    def from_urdf(
        cls,
        path: str | os.PathLike[str],
        tip: str,
        base: str | None = None,
        *,
        limits: JointLimits | None = None,
        srdf: str | os.PathLike[str] | None = None,
    ) -> SerialArm:
        """Arm between two links of a URDF file: base (default: the root) and tip. Expand xacro first.

        Fixed joints become part of the frames. Bounds, names, mimic joints and friction are kept. A velocity,
        acceleration, jerk or effort that is 0 or missing is not bounded. limits replaces bounds of the file, before
        the bounds are checked. srdf is an SRDF file, whose <rotor_params> are the inertias of the rotors.

        The inertia of a link includes all links that move with the link: links behind fixed joints, and also links
        beyond the tip and on side branches, for example a gripper, whose joints are at zero.

        A UrdfWarning is issued if lower = upper: the joint is fixed; if the range of a mimic joint leaves no range for
        its leader: the range of the mimic joint is ignored; and if the leader of a mimic joint is not a moving joint
        between base and tip: the mimic joint is fixed at its position for the leader at zero.

        Raises ValueError if the file is not a valid URDF or has no chain between the links, OSError if the file cannot
        be read.
        """
        return cls(*read_urdf(path, tip, base, limits, srdf))

    @classmethod
    def preset(cls, name: str) -> SerialArm:
        """Arm from a data sheet, up to the flange. name: one of PRESETS, for example 'panda'. Raises ParameterError."""
        if name not in PRESETS:
            raise not_one_of("name", name, PRESETS)
        joints, tip = preset(name)
        return cls([Joint(**joint) for joint in joints], tip)


def _in_space(arm: PlanarArm) -> tuple[tuple[Joint, ...], Array]:
    """The joints of a planar arm in space, about z at the starts of the links, and the frame of the tip."""
    joints = []
    place = np.eye(4)
    for i, length in enumerate(arm.lengths):
        mass = 0.0 if arm.masses is None else arm.masses[i]
        center = (length / 2, 0, 0) if arm.centers is None else arm.centers[i]
        rod = np.diag([0.0, 1.0, 1.0]) * mass * length**2 / 12
        inertia = rod if arm.inertias is None else arm.inertias[i]
        joints.append(Joint(placement=place, name=f"joint_{i + 1}", mass=mass, center=center, inertia=inertia))
        place = np.eye(4)
        place[0, 3] = length
    return tuple(joints), place


def _frame(name: str, value: ArrayLike) -> Any:
    return renamed(name, value, FRAME)


# Constructors of arms, by the kind in a table.
ARMS: dict[str, Callable[..., Arm]] = {
    "preset": SerialArm.preset,
    PlanarArm.kind: PlanarArm,
    "urdf": from_file(SerialArm.from_urdf, "limits"),
    "dh": SerialArm.from_dh,
    SerialArm.kind: SerialArm,
}
