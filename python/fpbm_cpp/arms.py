"""Arms in the plane and in space, their joints, and the bounds of their joints' motion."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence, Sized
from dataclasses import KW_ONLY, replace
from functools import cached_property
from math import inf
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ._core import PRESETS, dh, preset
from ._core import Arm as CoreArm
from ._core import Model as CoreModel
from ._types import ArrayField, FilledArrayField
from .errors import not_one_of, require, wrong
from .parameter import POSITIVE, Data, Parameter, data, parameter
from .shown import html_table, joint_table

__all__ = ["Arm", "Joint", "JointLimits", "PlanarArm", "SerialArm"]

NO_BOUNDS = {"lower": -inf, "upper": inf, "velocity": inf, "acceleration": inf, "jerk": inf}
NO_BOUNDS |= {"velocity_offset": 0.0, "deceleration": inf}
IDENTITY = tuple(map(tuple, np.eye(4).tolist()))
BOUND = Parameter(shape="(n,) or ()", infinite=True)
FRAME = Parameter(shape="(4, 4)", unit="m")


@data
class JointLimits(Data):
    """Bounds of the motion of each joint; infinity means no bound. For a prismatic joint, read m instead of rad.

    A number applies to all joints. If lower, upper, velocity or acceleration is missing, the limits change the limits
    of an arm: each missing field is the field of the arm. Otherwise, a missing jerk means no bound, and a missing
    velocity_offset or deceleration no braking envelope.

    Raises ParameterError if a bound is not a number, or the lengths of the arrays differ.
    """

    kind: ClassVar[str] = "limits"
    _: KW_ONLY
    lower: FilledArrayField = parameter("Lower bounds of the positions.", BOUND, default=None, unit="rad")
    upper: FilledArrayField = parameter("Upper bounds of the positions.", BOUND, default=None, unit="rad")
    velocity: FilledArrayField = parameter("Largest velocities, in both directions.", BOUND, default=None, unit="rad/s")
    acceleration: FilledArrayField = parameter(
        "Largest accelerations, in both directions.", BOUND, default=None, unit="rad/s^2"
    )
    jerk: FilledArrayField = parameter("Largest jerks, in both directions.", BOUND, default=None, unit="rad/s^3")
    velocity_offset: FilledArrayField = parameter(
        "Toward an end of the range at distance d, the velocity is at most -velocity_offset + sqrt(2 deceleration d).",
        BOUND,
        default=None,
        unit="rad/s",
    )
    deceleration: FilledArrayField = parameter("See velocity_offset.", BOUND, default=None, unit="rad/s^2")

    def _finish(self) -> None:
        given = self.given
        sizes = [len(values) for values in given.values() if isinstance(values, np.ndarray)]
        if given.keys() >= {"lower", "upper", "velocity", "acceleration"}:
            given = {**NO_BOUNDS, **given}
        for name, values in given.items():
            if sizes and not isinstance(values, np.ndarray):
                values = np.full(sizes[0], values)
                values.flags.writeable = False
            object.__setattr__(self, name, values)
            if sizes:
                require_length(name, values, sizes[0])

    @property
    def given(self) -> dict[str, Any]:
        """The fields that are not missing, by name: numbers or arrays of shape (n,)."""
        return {name: values for name, values in self._values().items() if values is not None}

    def replace(self, **fields: Any) -> JointLimits:
        """These limits with other fields: arm.limits.replace(acceleration=10)."""
        return replace(self, **fields)

    def of(self, arm: CoreModel) -> JointLimits:
        """These limits for an arm or a robot: with the arm's fields for missing fields, and arrays for numbers.

        Raises ParameterError if the length of an array is not arm.dof.
        """
        for values in self.given.values():
            if isinstance(values, np.ndarray):
                require_length("limits", values, arm.dof)
        own = {name: np.asarray(values) for name, values in arm.bounds().items()}
        return JointLimits(**{**own, **self.given})


@data
class Joint(Data):
    """One joint of a chain. For a prismatic joint, read m instead of rad."""

    type: str = parameter("Type of the joint.", default="revolute", choices=("revolute", "continuous", "prismatic"))
    placement: ArrayField = parameter(
        "Frame of the joint in the previous joint's frame, with both joints at zero.", FRAME, default=IDENTITY
    )
    axis: ArrayField = parameter("Axis in the joint's frame; its length is ignored.", default=(0, 0, 1), shape="(3,)")
    lower: float = parameter("Lower bound of the position.", default=-inf, infinite=True, unit="rad")
    upper: float = parameter("Upper bound of the position.", default=inf, infinite=True, unit="rad")
    velocity: float = parameter("Largest velocity, in both directions.", default=inf, infinite=True, unit="rad/s")
    acceleration: float = parameter(
        "Largest acceleration, in both directions.", default=inf, infinite=True, unit="rad/s^2"
    )
    jerk: float = parameter("Largest jerk, in both directions.", default=inf, infinite=True, unit="rad/s^3")
    velocity_offset: float = parameter(
        "Toward an end of the range at distance d, the velocity is at most -velocity_offset + sqrt(2 deceleration d).",
        default=0.0,
        unit="rad/s",
    )
    deceleration: float = parameter("See velocity_offset.", default=inf, infinite=True, unit="rad/s^2")
    name: str = parameter("Name; if empty, 'joint_1', 'joint_2' and so on.", default="")
    mimic: tuple[int, float, float] | None = parameter(
        "For a mimic joint: index of the leader in the chain, ratio and offset. The position is ratio times the "
        "leader's position plus offset. A mimic joint is not a degree of freedom; its bounds narrow the bounds of the "
        "leader.",
        default=None,
    )

    def _finish(self) -> None:
        if self.mimic is not None:
            joint, ratio, offset = self.mimic
            object.__setattr__(self, "mimic", (int(joint), float(ratio), float(offset)))


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
        bounds = {"lower": lower, "upper": upper, "velocity": velocity, "acceleration": acceleration, "jerk": jerk}
        columns = {name: replace(BOUND, name=name, default=None).check(values) for name, values in bounds.items()}
        columns = {name: [v] * len(rows) if isinstance(v, float) else v for name, v in columns.items()}
        for name, values in {**columns, "names": names}.items():
            if values is not None:
                require_length(name, values, len(rows))
                for joint, value in zip(joints, values):
                    joint["name" if name == "names" else name] = value
        if base is not None and joints:
            joints[0]["placement"] = _frame("base", base) @ joints[0]["placement"]
        return cls([Joint(**joint) for joint in joints], end if tip is None else end @ _frame("tip", tip))

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
        from .io.urdf import read_urdf

        return cls(*read_urdf(path, tip, base, limits))

    @classmethod
    def preset(cls, name: str) -> SerialArm:
        """Arm from a data sheet, up to the flange. name: one of PRESETS, for example 'panda'. Raises ParameterError."""
        if name not in PRESETS:
            raise not_one_of("name", name, PRESETS)
        joints, tip = preset(name)
        return cls([Joint(**joint) for joint in joints], tip)


def limits_of(arm: CoreModel, limits: JointLimits | None) -> JointLimits | None:
    """Limits without missing fields; None if no limits are given."""
    return limits.of(arm) if isinstance(limits, JointLimits) else limits


def limited(joints: Sequence[Joint], limits: JointLimits | None) -> list[Joint]:
    """The joints with the given bounds, one per joint with a drive; mimic joints lose their bounds of these kinds."""
    if limits is None:
        return list(joints)
    dof = sum(joint.mimic is None for joint in joints)
    columns = {}
    for name, values in limits.given.items():
        if isinstance(values, np.ndarray):
            require_length(name, values, dof)
        columns[name] = np.broadcast_to(values, dof)
    changed = []
    drive = 0
    for joint in joints:
        bounds: dict[str, Any] = {name: NO_BOUNDS[name] for name in columns}
        if joint.mimic is None:
            bounds = {name: float(values[drive]) for name, values in columns.items()}
            drive += 1
        ranged = np.isfinite([bounds.get(name, inf) for name in ("lower", "upper")]).any()
        kind = "revolute" if joint.type == "continuous" and ranged else joint.type
        changed.append(replace(joint, type=kind, **bounds))
    return changed


def require_length(name: str, values: Sized, dof: int) -> None:
    """Raise ParameterError unless there is one value per joint."""
    if len(values) != dof:
        raise wrong(name, values, f" has {len(values)} entries: must have {dof}, one per joint")


def _frame(name: str, value: ArrayLike) -> Any:
    return replace(FRAME, name=name).check(value)


def _from_urdf(file: str, tip: str, base: str | None = None) -> SerialArm:
    return SerialArm.from_urdf(file, tip, base)


# Constructors of arms, by the kind in a table.
ARMS: dict[str, Callable[..., Arm]] = {
    "preset": SerialArm.preset,
    PlanarArm.kind: PlanarArm,
    "urdf": _from_urdf,
    "dh": SerialArm.from_dh,
    SerialArm.kind: SerialArm,
}
