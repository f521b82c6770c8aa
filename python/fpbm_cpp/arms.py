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
from ._types import ArrayField, FilledArrayField
from .errors import ParameterError, not_one_of, wrong
from .parameter import POSITIVE, Data, Parameter, data, parameter

__all__ = ["Arm", "Joint", "JointLimits", "PlanarArm", "SerialArm"]

IDENTITY = tuple(map(tuple, np.eye(4).tolist()))
BOUND = Parameter(shape="(n,)", infinite=True)
FRAME = Parameter(shape="(4, 4)", unit="m")


@data
class JointLimits(Data):
    """Bounds of each joint's motion: infinite where there is none. Prismatic joints have m for rad.

    Raises ParameterError where a bound is not a number, or has another length.
    """

    kind: ClassVar[str] = "limits"
    _: KW_ONLY
    lower: ArrayField = parameter("Lowest positions.", BOUND, unit="rad")
    upper: ArrayField = parameter("Highest positions.", BOUND, unit="rad")
    velocity: ArrayField = parameter("Highest velocities, either way.", BOUND, unit="rad/s")
    acceleration: ArrayField = parameter("Highest accelerations, either way.", BOUND, unit="rad/s^2")
    jerk: FilledArrayField = parameter("Highest jerks, either way.", BOUND, default=None, unit="rad/s^3")
    velocity_offset: FilledArrayField = parameter(
        "Toward an end, the velocity is at most -velocity_offset + sqrt(2 deceleration distance).",
        BOUND,
        default=None,
        unit="rad/s",
    )
    deceleration: FilledArrayField = parameter("See velocity_offset.", BOUND, default=None, unit="rad/s^2")

    def _finish(self) -> None:
        dof = len(self.lower)
        for name, missing in (("jerk", inf), ("velocity_offset", 0.0), ("deceleration", inf)):
            if getattr(self, name) is None:
                values = np.full(dof, missing)
                values.flags.writeable = False
                object.__setattr__(self, name, values)
        for name in ("upper", "velocity", "acceleration", "jerk", "velocity_offset", "deceleration"):
            require_length(name, getattr(self, name), dof)


@data
class Joint(Data):
    """One joint of a chain, prismatic joints with m for rad."""

    type: str = parameter("How it moves.", default="revolute", choices=("revolute", "continuous", "prismatic"))
    placement: ArrayField = parameter("Its frame, seen from the joint before, both at zero.", FRAME, default=IDENTITY)
    axis: ArrayField = parameter("In the joint's frame; its length does not matter.", default=(0, 0, 1), shape="(3,)")
    lower: float = parameter("Lowest position.", default=-inf, infinite=True, unit="rad")
    upper: float = parameter("Highest position.", default=inf, infinite=True, unit="rad")
    velocity: float = parameter("Highest velocity, either way.", default=inf, infinite=True, unit="rad/s")
    acceleration: float = parameter("Highest acceleration, either way.", default=inf, infinite=True, unit="rad/s^2")
    jerk: float = parameter("Highest jerk, either way.", default=inf, infinite=True, unit="rad/s^3")
    velocity_offset: float = parameter(
        "Toward an end, the velocity is at most -velocity_offset + sqrt(2 deceleration distance).",
        default=0.0,
        unit="rad/s",
    )
    deceleration: float = parameter("See velocity_offset.", default=inf, infinite=True, unit="rad/s^2")
    name: str = parameter("'joint_1' and so on where empty.", default="")
    mimic: tuple[int, float, float] | None = parameter(
        "Of a joint that another one moves: the other's index in the chain, ratio and offset. The position is ratio "
        "times the other's plus offset. The joint is no degree of freedom; its bounds narrow the other's.",
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

    f(q) = sum_i l_i (cos th_i, sin th_i) with th_i = q_1 + ... + q_i: joint angles are relative [rad], the first from
    the base frame's x axis. The pose of the tip is (x, y, th_n).

    Raises ParameterError where a length is out of range, or there are too few or too many.
    """

    kind: ClassVar[str] = "planar"
    lengths: ArrayField = parameter("Link lengths, 2 to MAX_DOF of them.", POSITIVE, shape="(n,)", unit="m")

    def _finish(self) -> None:
        CoreArm.__init__(self, self.lengths)


@data
class SerialArm(Arm):
    """A chain of revolute, continuous and prismatic joints in space.

    Joint positions are in radians or metres. The base frame is the one that the first joint's placement is seen from.

    Raises ParameterError where an axis is zero, a number is not finite, a frame is not one, or a joint's bounds leave
    it no room.
    """

    kind: ClassVar[str] = "joints"
    joints: Sequence[Joint] = parameter("From base to tip, 1 to MAX_DOF of them. Nameless ones are given names.")
    tip: ArrayField = parameter("The tip's frame, seen from the last joint.", FRAME, default=IDENTITY)

    def _finish(self) -> None:
        for i, joint in enumerate(self.joints):
            if not isinstance(joint, Joint):
                raise ParameterError("joints", i, joint, f"joints[{i}] = {joint!r:.80}: must be a Joint")
        named = tuple(j if j.name else replace(j, name=f"joint_{i}") for i, j in enumerate(self.joints, 1))
        object.__setattr__(self, "joints", named)
        CoreArm.__init__(self, list(named), self.tip)

    def __str__(self) -> str:
        return f"<SerialArm of {self.dof} joints, {self.joints[0].name} to {self.joints[-1].name}>"

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
        """Arm of a table of Denavit-Hartenberg parameters.

        Frame i is, seen from frame i - 1, Rz(theta) Tz(d) Tx(a) Rx(alpha) in the classic convention, and
        Rx(alpha) Tx(a) Rz(theta) Tz(d) in the modified one (Craig), where a and alpha are those of the link before.

        Parameters
        ----------
        table : array_like, shape (n, 4)
            One row (a, alpha, d, theta) a joint [m, rad, m, rad]; the joint position is added to theta, or to d where
            the joint is prismatic.
        convention : str
            'classic' or 'modified'.
        types, lower, upper, velocity, acceleration, jerk, names : array_like, shape (n,), optional
            As for each Joint: 'revolute' (unless given), 'continuous' or 'prismatic', bounds of its motion, its name.
        base, tip : array_like, shape (4, 4), optional
            Frame 0 in the base frame, and the tip's frame seen from frame n.
        """
        rows = Parameter(name="table", shape="(n, 4)").check(table)
        joints, end = dh(rows, convention, ["revolute"] * len(rows) if types is None else list(types))
        bounds = {"lower": lower, "upper": upper, "velocity": velocity, "acceleration": acceleration, "jerk": jerk}
        columns = {name: replace(BOUND, name=name, default=None).check(values) for name, values in bounds.items()}
        for name, values in {**columns, "names": names}.items():
            if values is not None:
                require_length(name, values, len(rows))
                for joint, value in zip(joints, values):
                    joint["name" if name == "names" else name] = value
        if base is not None and joints:
            joints[0]["placement"] = _frame("base", base) @ joints[0]["placement"]
        return cls([Joint(**joint) for joint in joints], end if tip is None else end @ _frame("tip", tip))

    @classmethod
    def from_urdf(cls, path: str | os.PathLike[str], tip: str, base: str | None = None) -> SerialArm:
        """Arm between two links, base (the root unless given) and tip, of a URDF file; xacro must be expanded first.

        Fixed joints become part of the frames; bounds and names are kept; mimic joints follow. A joint that mimics one
        that does not move between base and tip is held where that one's zero puts it, with a UserWarning.

        Raises ValueError where the file is no sound URDF or has no chain between these links, OSError where it cannot
        be read.
        """
        from .io.urdf import read_urdf

        return cls(*read_urdf(path, tip, base))

    @classmethod
    def preset(cls, name: str) -> SerialArm:
        """Arm of a data sheet, up to its flange: one of PRESETS, 'panda' say. Raises ParameterError."""
        if name not in PRESETS:
            raise not_one_of("name", name, PRESETS)
        joints, tip = preset(name)
        return cls([Joint(**joint) for joint in joints], tip)


def require_length(name: str, values: Sized, dof: int) -> None:
    """Raise ParameterError where there is not one value a joint."""
    if len(values) != dof:
        raise wrong(name, values, f" has {len(values)} entries: must have {dof}, one per joint")


def _frame(name: str, value: ArrayLike) -> Any:
    return replace(FRAME, name=name).check(value)


def _from_urdf(file: str, tip: str, base: str | None = None) -> SerialArm:
    return SerialArm.from_urdf(file, tip, base)


# What makes an arm, by the kind that a table has.
ARMS: dict[str, Callable[..., Arm]] = {
    "preset": SerialArm.preset,
    PlanarArm.kind: PlanarArm,
    "urdf": _from_urdf,
    "dh": SerialArm.from_dh,
    SerialArm.kind: SerialArm,
}
