"""Robots as trees of joints: several arms, a torso, a mobile base."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, replace
from functools import cached_property
from typing import ClassVar

from numpy.typing import ArrayLike

from ._core import PRESETS, ROBOT_PRESETS, robot_preset
from ._core import Robot as CoreRobot
from ._types import ArrayField
from .arms import ARMS, IDENTITY, Arm, Joint, JointLimits, SerialArm
from .errors import ParameterError, not_one_of, wrong
from .parameter import NOT_NEGATIVE, Data, Parameter, data, parameter

__all__ = ["NamedFrame", "Robot", "TreeJoint"]

CENTER = Parameter(shape="(3,)", unit="m")
PLACE = Parameter(shape="(4, 4)", unit="m")


@data
class TreeJoint(Data):
    """A joint of a tree, the link that carries it, and the mass of the link that it moves.

    Link 0 is the base, link i + 1 the one that joint i moves, with the joint's frame after its motion.
    """

    joint: Joint = parameter("Placed in the frame of the link that carries it.")
    parent: int = parameter("Number of that link: at most the joint's index.", default=0)
    _: KW_ONLY
    mass: float = parameter("Of the link that the joint moves.", NOT_NEGATIVE, default=0.0, unit="kg")
    center: ArrayField = parameter("Its centre of mass in the link's frame.", CENTER, default=(0, 0, 0))


@data
class NamedFrame(Data):
    """A frame of a link."""

    name: str = parameter("Of the frame.")
    link: int = parameter("Number of the link, as in TreeJoint.", default=0)
    offset: ArrayField = parameter("The frame, in the link's frame.", default=IDENTITY, shape="(4, 4)", unit="m")


@data
class Robot(Data, CoreRobot):
    """A tree of revolute, continuous and prismatic joints, some of which may follow others.

    Joint positions are in radians or metres, those of the joints that have a drive, in the order of joints. A Tracker
    of a robot needs a stack of tasks, each of a frame: 'base', one of frames, or a joint's name.

    Raises ParameterError where an axis is zero, a number is not finite, a joint is carried by a link that does not come
    before it, two frames have one name, or a joint's bounds leave it no room.
    """

    kind: ClassVar[str] = "tree"
    joints: Sequence[TreeJoint] = parameter("Each behind the joint that carries it, 1 to MAX_DOF of them.")
    named_frames: Sequence[NamedFrame] = parameter("Frames that tasks refer to.", default=())
    _: KW_ONLY
    base_mass: float = parameter("Mass of link 0.", NOT_NEGATIVE, default=0.0, unit="kg")
    base_center: ArrayField = parameter("Its centre of mass.", CENTER, default=(0, 0, 0))

    def _finish(self) -> None:
        for i, each in enumerate(self.joints):
            if not isinstance(each, TreeJoint):
                raise ParameterError("joints", i, each, f"joints[{i}] = {each!r:.80}: must be a TreeJoint")
        named = tuple(
            each if each.joint.name else replace(each, joint=replace(each.joint, name=f"joint_{i}"))
            for i, each in enumerate(self.joints, 1)
        )
        object.__setattr__(self, "joints", named)
        object.__setattr__(self, "named_frames", tuple(self.named_frames))
        seen: set[str] = set()
        for frame in self.named_frames:
            if frame.name in seen:
                raise wrong("named_frames", frame.name, f" has two frames of the name {frame.name!r}")
            seen.add(frame.name)
        CoreRobot.__init__(self, list(named), list(self.named_frames), self.base_mass, self.base_center)

    def __str__(self) -> str:
        return f"<Robot of {self.dof} joints and {len(self.named_frames)} frames>"

    @property
    def frames(self) -> tuple[str, ...]:
        """Names of the frames."""
        return tuple(frame.name for frame in self.named_frames)

    @cached_property
    def limits(self) -> JointLimits:
        """Bounds of the joints' motion."""
        return JointLimits(**self.bounds())

    @classmethod
    def from_arms(cls, arms: Mapping[str, SerialArm], placements: Mapping[str, ArrayLike] | None = None) -> Robot:
        """Robot of several arms by name, each placed in the base frame by a (4, 4) matrix; at its own base otherwise.

        Joint 'joint1' of arm 'left' is 'left_joint1', its tip the frame 'left_tip'.
        """
        joints: list[TreeJoint] = []
        frames = []
        for name, arm in arms.items():
            first = len(joints)
            place = replace(PLACE, name=f"placements[{name!r}]").check((placements or {}).get(name, IDENTITY))
            for i, joint in enumerate(arm.joints):
                moved = replace(joint, name=f"{name}_{joint.name}")
                if i == 0:
                    moved = replace(moved, placement=place @ moved.placement)
                if joint.mimic is not None:
                    moved = replace(moved, mimic=(first + joint.mimic[0], *joint.mimic[1:]))
                joints.append(TreeJoint(moved, first + i if i else 0))
            frames.append(NamedFrame(f"{name}_tip", len(joints), arm.tip))
        return cls(joints, frames)

    @classmethod
    def preset(cls, name: str) -> Robot:
        """Robot of data sheets: one of ROBOT_PRESETS, 'two_pandas' say. Raises ParameterError."""
        if name not in ROBOT_PRESETS:
            raise not_one_of("name", name, ROBOT_PRESETS)
        joints, frames, mass, center = robot_preset(name)
        return cls(
            [TreeJoint(Joint(**joint), parent, mass=m, center=c) for joint, parent, m, c in joints],
            [NamedFrame(*frame) for frame in frames],
            base_mass=mass,
            base_center=center,
        )

    @classmethod
    def from_urdf(
        cls,
        path: str | os.PathLike[str],
        *,
        base: str | None = None,
        locked: Mapping[str, float] | None = None,
        tips: Iterable[str] | None = None,
    ) -> Robot:
        """Robot of all joints of a URDF file; xacro must be expanded first.

        Each link of the file is a frame of its name. Fixed joints become part of the frames; bounds and names are kept;
        mimic joints follow.

        Parameters
        ----------
        path : path
            Of the file.
        base : str, optional
            'fixed', or 'planar': the root link moves along x and y and turns about z, by joints 'base_x', 'base_y' and
            'base_yaw' without bounds. A floating joint of the file needs 'fixed' or 'planar', which replaces it.
        locked : mapping, optional
            Positions at which joints are held, by name [rad] or [m]: they are no joints of the robot.
        tips : iterable of str, optional
            Links that the robot is to move: all joints that move none of them are held at 0, or at the position
            nearest to 0 that they have.

        Raises ValueError where the file is no sound URDF or has more than MAX_DOF joints that move, ParameterError
        where a locked joint does not exist or its position is out of range, OSError where the file cannot be read.
        """
        from .io.urdf_tree import read_tree

        return cls(**read_tree(path, base=base, locked=locked or {}, tips=tips))


def _from_urdf(
    file: str,
    *,
    base: str | None = None,
    locked: Mapping[str, float] | None = None,
    tips: Sequence[str] | None = None,
) -> Robot:
    return Robot.from_urdf(file, base=base, locked=locked, tips=tips)


def _preset(name: str) -> Arm | Robot:
    if name not in (*PRESETS, *ROBOT_PRESETS):
        raise not_one_of("name", name, (*PRESETS, *ROBOT_PRESETS))
    return Robot.preset(name) if name in ROBOT_PRESETS else SerialArm.preset(name)


# What makes an arm or a robot, by the kind that a table has.
ROBOTS: dict[str, Callable[..., Arm | Robot]] = {**ARMS, "preset": _preset, "robot": _from_urdf, Robot.kind: Robot}
