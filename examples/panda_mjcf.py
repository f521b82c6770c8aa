"""The Panda of fp.SerialArm.preset("panda") as a MuJoCo model (MJCF), written from published numbers.

Joints, inertias and bounds on torque: the preset, so that MuJoCo and the library have the same model. Coulomb friction:
the supplement of Gaz and others (2019), the paper of the preset's inertias, where friction changes by FI_1 from one
direction to the opposite direction. This model has FI_1 in each direction, twice as much, because the paper identified
the friction with the robot's own torque sensors. Viscous friction and armature: mujoco_menagerie, franka_emika_panda.
panda() is the model of a controller: the preset with the rotors.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np

import fpbm_cpp as fp

PANDA = fp.SerialArm.preset("panda")
TORQUE = PANDA.limits.effort  # [Nm]
COULOMB = (0.54615, 0.87224, 0.64068, 1.2794, 0.83904, 0.30301, 0.56489)  # [Nm]
VISCOUS = 1.0  # [Nm s/rad]
ARMATURE = 0.1  # [kg m²], inertia of the rotors at the joints
ONE = {"": np.eye(4)}


def panda(inertia_error: float = 0.0) -> fp.SerialArm:
    """The preset with the rotors, without friction. inertia_error: relative error of every mass and inertia."""
    factor = 1 + inertia_error
    joints = [
        replace(joint, mass=factor * joint.mass, inertia=factor * joint.inertia, rotor_inertia=factor * ARMATURE)
        for joint in PANDA.joints
    ]
    return replace(PANDA, joints=joints)


def panda_mjcf(
    arm: fp.SerialArm | None = None,
    *,
    friction: float = 1.0,
    timestep: float = 2.5e-4,
    placements: Mapping[str, np.ndarray] = ONE,
) -> str:
    """MJCF of the Panda with a torque motor on each joint and a site "tip" at its flange.

    arm: the Panda, for example with a payload; default: panda(). friction: factor on all friction. The joints have no
    stops and the links do not collide: the simulation shows if a joint leaves its range. placements: (4, 4) poses of
    the bases of several Pandas, by name, with the names of joints and tips of Robot.from_arms().
    """
    root = ElementTree.Element("mujoco", model="panda")
    _add(root, "compiler", angle="radian")
    _add(root, "option", timestep=timestep, integrator="implicitfast")
    defaults = _add(root, "default")
    _add(defaults, "geom", mass=0, contype=0, conaffinity=0, size=0.045, rgba=(0.9, 0.9, 0.9, 1))
    # As close to dry friction as the time step allows: with MuJoCo's default, a joint creeps.
    dry = {"solreffriction": (2 * timestep, 1), "solimpfriction": (0.99, 0.999, 1e-3)}
    _add(defaults, "joint", axis=(0, 0, 1), damping=friction * VISCOUS, **dry)

    world = _add(root, "worldbody")
    _add(world, "light", pos=(0.5, -1, 2), dir=(-0.3, 0.5, -1))
    _add(world, "geom", type="plane", size=(1, 1, 0.01), rgba=(0.75, 0.75, 0.75, 1))
    motors = _add(root, "actuator")
    for name, placement in placements.items():
        prefix = f"{name}_" if name else ""
        base = _add(world, "body", name=f"{prefix}base", **_frame(placement))
        _add_arm(base, motors, arm or panda(), prefix, friction)
    return ElementTree.tostring(root, encoding="unicode")


def _add_arm(
    body: ElementTree.Element, motors: ElementTree.Element, arm: fp.SerialArm, prefix: str, friction: float
) -> None:
    for i, (joint, coulomb) in enumerate(zip(arm.joints, COULOMB), 1):
        placement = np.asarray(joint.placement)
        _link(body, placement[:3, 3])
        body = _add(body, "body", name=f"{prefix}link{i}", **_frame(placement))
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = joint.inertia
        _add(body, "inertial", mass=joint.mass, pos=joint.center, fullinertia=(xx, yy, zz, xy, xz, yz))
        dry = friction * coulomb
        _add(body, "joint", name=f"{prefix}{joint.name}", frictionloss=dry, armature=joint.rotor_inertia)
        _add(body, "geom", type="cylinder", size=(0.055, 0.06), rgba=(0.3, 0.3, 0.3, 1))
    _link(body, arm.tip[:3, 3])
    _add(body, "site", name=f"{prefix}tip", **_frame(arm.tip))
    for joint, torque in zip(arm.joints, TORQUE.tolist()):
        joint_name = f"{prefix}{joint.name}"
        _add(motors, "motor", name=joint_name, joint=joint_name, forcerange=(-torque, torque))


def _link(body: ElementTree.Element, end: np.ndarray) -> None:
    """The visible part of a link, from its joint to the next joint."""
    if np.linalg.norm(end) > 0.01:
        _add(body, "geom", type="capsule", fromto=(0, 0, 0, *end))


def _frame(placement: np.ndarray) -> dict[str, object]:
    return {"pos": placement[:3, 3], "xyaxes": placement[:3, :2].T.ravel()}


def _add(parent: ElementTree.Element, tag: str, **attributes: object) -> ElementTree.Element:
    """Add a child element. Numbers keep all their digits."""
    texts = {
        key: value if isinstance(value, str) else " ".join(map(repr, np.ravel(value).tolist()))
        for key, value in attributes.items()
    }
    return ElementTree.SubElement(parent, tag, texts)


if __name__ == "__main__":
    print(panda_mjcf())
