"""Robots as trees of joints: several arms, a torso, a mobile base."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, replace
from typing import ClassVar

from numpy.typing import ArrayLike

from ._core import PRESETS, ROBOT_PRESETS, robot_preset
from ._core import Robot as CoreRobot
from ._types import ArrayField
from .arms import ARMS, Arm, SerialArm
from .errors import not_one_of, require, wrong
from .inertia import Inertia
from .joints import CENTER, IDENTITY, Joint, JointLimits, NamedFrame, TreeJoint, joint_table
from .mechanism import Mechanism
from .parameter import NOT_NEGATIVE, Parameter, data, from_file, parameter, renamed
from .urdf.chain import read_tree

__all__ = ["Robot"]

PLACE = Parameter(shape="(4, 4)", unit="m")


@data
class Robot(Mechanism, CoreRobot):
    """A tree of revolute, continuous and prismatic joints, which may include mimic joints.

    The joint positions, in radians or metres, belong to the joints with a drive, in the order of joints. A Tracker of a
    robot needs a stack of tasks, each of a frame: 'base', a name in frames, or the name of a joint.

    Raises ParameterError if there are too few or too many joints, an axis is zero, a number is out of range or not
    finite, the parent link of a joint does not come before the joint, two frames share a name, or bounds leave no range
    for a joint.
    """

    kind: ClassVar[str] = "tree"
    joints: Sequence[TreeJoint] = parameter("Joints, each after its parent, 1 to MAX_DOF of them.")
    named_frames: Sequence[NamedFrame] = parameter("Frames that tasks refer to.", default=())
    _: KW_ONLY
    base_mass: float = parameter("Mass of link 0.", NOT_NEGATIVE, default=0.0, unit="kg")
    base_center: ArrayField = parameter("Centre of mass of link 0.", CENTER, default=(0, 0, 0))

    def _finish(self) -> None:
        for i, each in enumerate(self.joints):
            require("joints", each, TreeJoint, "a TreeJoint", index=i)
            require(f"joints[{i}].joint", each.joint, Joint, "a Joint")
        named = tuple(
            each if each.joint.name else replace(each, joint=replace(each.joint, name=f"joint_{i}"))
            for i, each in enumerate(self.joints, 1)
        )
        object.__setattr__(self, "joints", named)
        object.__setattr__(self, "named_frames", tuple(self.named_frames))
        for i, frame in enumerate(self.named_frames):
            require("named_frames", frame, NamedFrame, "a NamedFrame", index=i)
        seen: set[str] = set()
        for frame in self.named_frames:
            if frame.name in seen:
                raise wrong("named_frames", frame.name, f" has two frames {frame.name!r}: names must be unique")
            seen.add(frame.name)
        frames = list(self.named_frames)
        CoreRobot.__init__(self, list(named), frames, self.base_mass, self.base_center, self.gravity_vector)

    def __str__(self) -> str:
        return f"<Robot of {self.dof} joints and {len(self.named_frames)} frames>"

    def _repr_html_(self) -> str:
        moving = [each.joint.type for each in self.joints if each.joint.mimic is None]
        return joint_table(str(self), self.joint_names, moving, self.limits)

    @property
    def frames(self) -> tuple[str, ...]:
        """Names of the frames."""
        return tuple(frame.name for frame in self.named_frames)

    def _carrying(self, link: int, body: Inertia) -> Robot:
        joints = list(self.joints)
        each = joints[link - 1]
        joints[link - 1] = replace(each, joint=each.joint.carrying(body))
        return self._with(joints=joints)

    @classmethod
    def from_arms(cls, arms: Mapping[str, SerialArm], placements: Mapping[str, ArrayLike] | None = None) -> Robot:
        """Robot of several arms by name. A (4, 4) matrix places each arm in the base frame; default: identity.

        Joint 'joint1' of arm 'left' becomes 'left_joint1', and the tip of arm 'left' becomes the frame 'left_tip'.
        """
        joints: list[TreeJoint] = []
        frames = []
        for name, arm in arms.items():
            first = len(joints)
            place = renamed(f"placements[{name!r}]", (placements or {}).get(name, IDENTITY), PLACE)
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
        """Robot from data sheets. name: one of ROBOT_PRESETS, for example 'two_pandas'. Raises ParameterError."""
        if name not in ROBOT_PRESETS:
            raise not_one_of("name", name, ROBOT_PRESETS)
        joints, frames, mass, center = robot_preset(name)
        return cls(
            [TreeJoint(Joint(**joint), parent) for joint, parent in joints],
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
        limits: JointLimits | None = None,
        srdf: str | os.PathLike[str] | None = None,
    ) -> Robot:
        """Robot of all joints of a URDF file. Expand xacro first.

        Each link of the file is a frame with the name of the link. Fixed joints become part of the frames. Bounds,
        names, mimic joints and friction are kept. A velocity, acceleration, jerk or effort that is 0 or missing is not
        bounded. The inertia of a link of the robot includes all links of the file that move with the link.

        Parameters
        ----------
        path : path
            The URDF file.
        base : str, optional
            'fixed', or 'planar': the root link moves along x and y and rotates about z, by the joints 'base_x',
            'base_y' and 'base_yaw' without bounds. If the file has a floating joint, give 'fixed' or 'planar', which
            replaces the floating joint.
        locked : mapping, optional
            Positions of joints that are fixed, by name [rad] or [m]; fixed joints are not joints of the robot. A mimic
            joint can be fixed only if its leader does not exist.
        tips : iterable of str, optional
            Links that the robot moves. Joints that move none of these links are fixed at 0, or at the position in their
            range that is nearest to 0.
        limits : JointLimits, optional
            Bounds that replace bounds of the file, before the bounds are checked.
        srdf : path, optional
            An SRDF file, whose <rotor_params> are the inertias of the rotors.

        A UrdfWarning is issued if lower = upper: the joint is fixed; and if the range of a mimic joint leaves no range
        for its leader: the range of the mimic joint is ignored.

        Raises ValueError if the file is not a valid URDF or more than MAX_DOF joints move, ParameterError if a locked
        joint does not exist or its position is out of range, OSError if the file cannot be read.
        """
        return cls(**read_tree(path, base=base, locked=locked or {}, tips=tips, limits=limits, srdf=srdf))


def _preset(name: str) -> Arm | Robot:
    if name not in (*PRESETS, *ROBOT_PRESETS):
        raise not_one_of("name", name, (*PRESETS, *ROBOT_PRESETS))
    return Robot.preset(name) if name in ROBOT_PRESETS else SerialArm.preset(name)


# Constructors of arms and robots, by the kind in a table.
ROBOTS: dict[str, Callable[..., Arm | Robot]] = {
    **ARMS,
    "preset": _preset,
    "robot": from_file(Robot.from_urdf, "limits"),
    Robot.kind: Robot,
}
