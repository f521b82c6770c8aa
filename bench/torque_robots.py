"""Robots with payloads, and their torques by Pinocchio, for bench/torque.py."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

import fpbm_cpp as fp

Array = NDArray[np.float64]
NAMES = ("panda", "ur10e", "g1", "z1")
G1_TIPS = ("left_wrist_yaw_link", "right_wrist_yaw_link")
POINT = (0.02, 0.0, 0.1)  # Centre of mass of a payload, in the frame of a tip [m].


class Torques:
    """Torques of the joints by Pinocchio, with the viscous friction of a model."""

    def __init__(self, model: Any, damping: Array, gravity: Array) -> None:
        model.gravity.linear = gravity
        self.model, self.data, self.damping = model, model.createData(), damping

    def __call__(self, q: Array, qd: Array, qdd: Array) -> Array:
        return np.asarray(pin.rnea(self.model, self.data, q, qd, qdd) + self.damping * qd)


class Machine(NamedTuple):
    arm: Any  # A SerialArm or a Robot.
    tips: Sequence[str]  # Frames that carry the payload and have targets.
    limits: fp.JointLimits
    clearance: fp.Clearance | None  # Self-collision only; None if the library has no capsules of the robot.
    torques: Torques
    friction: Array  # Dry friction, which reduces the bounds [Nm].

    def holds(self, q: Array, effort: Array) -> bool:
        """Whether the efforts can hold a posture."""
        rest = np.zeros(self.arm.dof)
        return bool(np.all(np.abs(self.torques(q, rest, rest)) <= effort))


def data_file(name: str) -> Path:
    found = importlib.util.find_spec("cmeel")
    if found is None or found.origin is None:
        raise SystemExit("needs example-robot-data: pip install example-robot-data")
    return Path(found.origin).parents[1] / "cmeel.prefix/share/example-robot-data/robots" / name


def model_of_joints(arm: fp.SerialArm) -> Any:
    """The joints and the links of an arm as a model of Pinocchio."""
    model = pin.Model()
    for i, joint in enumerate(arm.joints):
        kind = pin.JointModelPrismaticUnaligned if joint.type == "prismatic" else pin.JointModelRevoluteUnaligned
        axis = joint.axis / np.linalg.norm(joint.axis)
        model.addJoint(i, kind(axis), pin.SE3(joint.placement), joint.name)
        model.appendBodyToJoint(i + 1, pin.Inertia(joint.mass, joint.center, joint.inertia), pin.SE3.Identity())
    model.addFrame(pin.Frame("tip", arm.dof, pin.SE3(arm.tip), pin.FrameType.OP_FRAME))
    model.armature = np.array([joint.rotor_inertia for joint in arm.joints])
    return model


def model_of_file(file: Path, joints: Sequence[str]) -> Any:
    """A URDF file as Pinocchio reads the file, with the joints of the arm; the other joints are fixed at 0."""
    model = pin.buildModelFromUrdf(str(file))
    held = [i for i in range(1, model.njoints) if model.names[i] not in joints]
    model = pin.buildReducedModel(model, held, np.zeros(model.nq))
    if list(model.names[1:]) != list(joints):
        raise SystemExit(f"{file.name}: joints {list(joints)} are required, but Pinocchio has {list(model.names[1:])}")
    return model


def machine(name: str, payload: float, gravity: Array | None = None) -> Machine:
    """A robot that carries a payload [kg] at each tip."""
    preset: Any = fp.Robot.preset("g1_upper_body") if name == "g1" else fp.SerialArm.preset(name)
    tips: Sequence[str] = ("tip",)
    if name == "g1":
        tips, file = G1_TIPS, data_file("g1_description/urdf/g1_29dof_rev_1_0.urdf")
        arm: Any = fp.Robot.from_urdf(file, base="fixed", tips=G1_TIPS)
        model = model_of_file(file, arm.joint_names)
    elif name == "z1":
        file = data_file("z1_description/urdf/z1.urdf")
        arm = fp.SerialArm.from_urdf(file, "gripperStator")
        model = model_of_file(file, arm.joint_names)
        flange = model.frames[model.getFrameId("gripperStator", pin.BODY)]
        model.addFrame(pin.Frame("tip", flange.parentJoint, flange.placement, pin.OP_FRAME))
    else:
        arm, model = preset, model_of_joints(preset)
    arm = arm if gravity is None else arm.with_gravity(gravity)
    joints = [getattr(each, "joint", each) for each in arm.joints]
    for tip in tips:
        arm = arm.with_payload(payload, com=POINT, frame=tip)
        frame = model.frames[model.getFrameId(tip, pin.OP_FRAME if tip == "tip" else pin.BODY)]
        body = pin.Inertia(payload, np.array(POINT), np.zeros((3, 3)))
        model.appendBodyToJoint(frame.parentJoint, body, frame.placement)
    damping, friction = (np.array([getattr(each, key) for each in joints]) for key in ("damping", "friction"))
    torques = Torques(model, damping, np.array(arm.gravity_vector))
    limits = replace(arm.limits, velocity=preset.limits.velocity, acceleration=preset.limits.acceleration)
    clearance = fp.Clearance.preset(name) if name in ("panda", "ur10e") else None
    return Machine(arm, tips, limits, clearance, torques, friction)
