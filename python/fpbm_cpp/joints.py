"""Joints of arms and robots, and the bounds of their motion."""

from __future__ import annotations

from collections.abc import Sequence, Sized
from dataclasses import KW_ONLY, replace
from math import inf
from typing import Any, ClassVar

import numpy as np

from ._core import Model as CoreModel
from ._types import ArrayField, FilledArrayField
from .errors import wrong
from .inertia import Inertia, joined
from .parameter import NOT_NEGATIVE, Data, Parameter, data, parameter
from .shown import html_table, number

__all__ = ["Joint", "JointLimits", "NamedFrame", "TreeJoint"]

NO_BOUNDS = {"lower": -inf, "upper": inf, "velocity": inf, "acceleration": inf, "jerk": inf}
NO_BOUNDS |= {"velocity_offset": 0.0, "deceleration": inf, "effort": inf}
IDENTITY = tuple(map(tuple, np.eye(4).tolist()))
BOUND = Parameter(shape="(n,) or ()", infinite=True)
FRAME = Parameter(shape="(4, 4)", unit="m")
CENTER = Parameter(shape="(3,)", unit="m")
INERTIA = Parameter(shape="(3, 3)", unit="kg m^2")


@data
class JointLimits(Data):
    """Bounds of the motion and of the torque of each joint; infinity means no bound.

    For a prismatic joint, read m instead of rad and N instead of Nm.

    A number applies to all joints. If lower, upper, velocity or acceleration is missing, the limits change the limits
    of an arm: each missing field is the field of the arm. Otherwise, a missing jerk or effort means no bound, and a
    missing velocity_offset or deceleration no braking envelope.

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
    effort: FilledArrayField = parameter(
        "Largest torques, or forces, of the drives, in both directions.", BOUND, default=None, unit="Nm"
    )

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
    """One joint of a chain, and the inertia of the link that the joint moves.

    For a prismatic joint, read m instead of rad, N instead of Nm, and kg instead of kg m^2 for the rotor. The frame of
    the link is the frame of the joint after the joint's motion.
    """

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
    effort: float = parameter("Largest torque, in both directions.", default=inf, infinite=True, unit="Nm")
    mass: float = parameter("Mass of the link.", NOT_NEGATIVE, default=0.0, unit="kg")
    center: ArrayField = parameter("Centre of mass of the link, in its frame.", CENTER, default=(0, 0, 0))
    inertia: ArrayField = parameter(
        "Rotational inertia of the link about its centre of mass, along the axes of its frame.",
        INERTIA,
        default=((0, 0, 0), (0, 0, 0), (0, 0, 0)),
    )
    rotor_inertia: float = parameter(
        "Inertia of the rotor times the square of the gear ratio.", NOT_NEGATIVE, default=0.0, unit="kg m^2"
    )
    damping: float = parameter("Viscous friction.", NOT_NEGATIVE, default=0.0, unit="Nm s/rad")
    friction: float = parameter("Dry friction.", NOT_NEGATIVE, default=0.0, unit="Nm")

    def _finish(self) -> None:
        if self.mimic is not None:
            joint, ratio, offset = self.mimic
            object.__setattr__(self, "mimic", (int(joint), float(ratio), float(offset)))

    def carrying(self, body: Inertia) -> Joint:
        """This joint with a body that is fixed to the link, given in the frame of the link."""
        mass, center, inertia = joined([Inertia(self.mass, self.center, self.inertia), body])
        return replace(self, mass=mass, center=center, inertia=inertia)


@data
class TreeJoint(Data):
    """A joint of a tree, and its parent link.

    Link 0 is the base. Link i + 1 is the child of joint i; its frame is the frame of joint i after the joint's motion.
    """

    joint: Joint = parameter("The joint, placed in the frame of the parent link.")
    parent: int = parameter("Number of the parent link, at most the index of the joint.", default=0)


@data
class NamedFrame(Data):
    """A frame of a link."""

    name: str = parameter("Name of the frame.")
    link: int = parameter("Number of the link, as in TreeJoint.", default=0)
    offset: ArrayField = parameter("Pose of the frame in the link's frame.", default=IDENTITY, shape="(4, 4)", unit="m")


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


def joint_table(caption: str, names: Sequence[str], types: Sequence[str], limits: JointLimits) -> str:
    """A row for each joint, with its type and its bounds, in HTML."""
    bounded = ("lower", "upper", "velocity", "acceleration", "jerk", "effort")
    headings = ["joint", "type", *bounded]
    bounds = zip(*(getattr(limits, name) for name in bounded))
    rows = [[name, kind, *map(number, each)] for name, kind, each in zip(names, types, bounds)]
    return html_table(caption.strip("<>"), headings, rows)
