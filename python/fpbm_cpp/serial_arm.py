"""Serial arms, and the ways to one's own: a URDF file, a Denavit-Hartenberg table, joints, a preset."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._types import Array
from .joint import Joint


class SerialArm(_core.SerialArm):
    """Any chain of revolute, continuous and prismatic joints in space.

    Joint positions in radians or metres; the base frame is the one that the first placement is seen from. Chains of 4
    to 8 joints run in code made for just that number.

    Parameters
    ----------
    joints : sequence of Joint
        From base to tip, 1 to MAX_DOF of them.
    tip : array_like, shape (4, 4), optional
        The tip's frame, seen from the last joint; that joint's own unless given.

    Attributes
    ----------
    joints : tuple of Joint
        As given, each with a name.
    tip : numpy.ndarray, shape (4, 4)
        As given.

    Raises
    ------
    ValueError
        Where an axis is zero, a number is not finite, a frame is none, or a joint's bounds leave it no room.
    """

    def __init__(self, joints: Sequence[Joint], tip: ArrayLike | None = None) -> None:
        named = tuple(j if j.name else replace(j, name=f"joint_{i}") for i, j in enumerate(joints, 1))
        frame = np.eye(4) if tip is None else np.array(tip, dtype=float)
        super().__init__(list(named), frame)
        self.joints = named
        self.tip: Array = frame

    @classmethod
    def from_joints(cls, joints: Sequence[Joint], tip: ArrayLike | None = None) -> SerialArm:
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
        types : sequence of str, optional
            'revolute' (unless given), 'continuous' or 'prismatic'.
        lower, upper, velocity, acceleration : array_like, shape (n,), optional
            Bounds of each joint's motion.
        names : sequence of str, optional
            The joints'.
        base, tip : array_like, shape (4, 4), optional
            Frame 0 in the base frame, and the tip's frame seen from frame n.
        """
        n = len(np.atleast_1d(np.asarray(table, dtype=float)))
        fields, end = _core.dh(table, convention, list(types) if types is not None else ["revolute"] * n)
        if base is not None and fields:
            fields[0]["placement"] = np.asarray(base, dtype=float) @ fields[0]["placement"]
        columns = {"lower": lower, "upper": upper, "velocity": velocity, "acceleration": acceleration, "name": names}
        for key, values in columns.items():
            if values is None:
                continue
            entries = np.asarray(values, dtype=str if key == "name" else float).ravel().tolist()
            if len(entries) != n:
                raise ValueError(f"{key} has {len(entries)} entries: must have {n}, one per joint")
            for joint, value in zip(fields, entries):
                joint[key] = value
        return cls(_joints(fields), end if tip is None else end @ np.asarray(tip, dtype=float))

    @classmethod
    def from_urdf(cls, path: str | os.PathLike[str], tip: str, base: str | None = None) -> SerialArm:
        """Arm between two links of a URDF file.

        Fixed joints are folded into the frames; bounds and names are kept; mimic joints follow. Needs the extra
        'urdf'.

        Parameters
        ----------
        path : path
            The file; xacro files must be expanded first.
        tip, base : str
            Names of links; base is the root link unless given.

        Raises
        ------
        ValueError
            Where the file is no sound URDF or has no chain between these links.
        OSError
            Where the file cannot be read.
        ImportError
            Where the extra is missing.
        """
        from .urdf import read_urdf

        return cls(*read_urdf(path, tip, base))

    @classmethod
    def preset(cls, name: str) -> SerialArm:
        """Arm of a data sheet, up to its flange: 'panda' (Franka), 'iiwa14' (KUKA) or 'gen3' (Kinova, 7 joints)."""
        fields, tip = _core.preset(name)
        return cls(_joints(fields), tip)

    def _key(self) -> tuple[object, ...]:
        joints = tuple(
            (j.type, _bytes(j.placement), _bytes(j.axis), j.lower, j.upper, j.velocity, j.acceleration, j.name, j.mimic)
            for j in self.joints
        )
        return (*joints, _bytes(self.tip))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SerialArm) and other._key() == self._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def __reduce__(self) -> tuple[object, ...]:
        return (SerialArm, (self.joints, self.tip))

    def __repr__(self) -> str:
        return f"<SerialArm of {self.dof} joints, {self.joints[0].name} to {self.joints[-1].name}>"


def _joints(fields: list[dict[str, Any]]) -> list[Joint]:
    return [Joint(**joint) for joint in fields]


def _bytes(values: ArrayLike) -> bytes:
    return np.asarray(values, dtype=float).tobytes()
