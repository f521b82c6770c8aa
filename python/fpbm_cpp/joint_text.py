"""What an arm's joints are called, and measured in."""

from __future__ import annotations

from .arms import Arm, SerialArm


def joint_labels(arm: Arm) -> list[str]:
    """Names of the joints for people to read; in the plane, where they have none, their numbers."""
    return list(arm.joint_names) if isinstance(arm, SerialArm) else [f"joint {i}" for i in range(1, arm.dof + 1)]


def joint_units(arm: Arm) -> list[str]:
    """Unit of each joint's position."""
    if not isinstance(arm, SerialArm):
        return ["rad"] * arm.dof
    return ["m" if joint.type == "prismatic" else "rad" for joint in arm.joints if joint.mimic is None]
