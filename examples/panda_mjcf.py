"""The Panda of fp.SerialArm.preset("panda") as a MuJoCo model (MJCF), written from published numbers.

Kinematics: the joints of the preset, so that MuJoCo and the library have the same kinematics. Masses, centres of mass
and inertias: Gaz, Cognetti, Oliva, Robuffo Giordano, De Luca, "Dynamic Identification of the Franka Emika Panda Robot
With Retrieval of Feasible Parameters Using Penalty-Based Optimization", IEEE RA-L 4(4), 2019, as in franka_ros
(franka_description/robots/common/inertial.yaml). Coulomb friction: the supplement of the same paper, where friction
changes by FI_1 from one direction to the opposite direction. This model has FI_1 in each direction, twice as much,
because the paper identified the friction with the robot's own torque sensors. Viscous friction and armature:
mujoco_menagerie, franka_emika_panda. Bounds on torque: Franka Control Interface documentation, "Limits for Panda".
"""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree import ElementTree

import numpy as np

import fpbm_cpp as fp

# Mass [kg], centre of mass [m], and inertia about it [kg m²] as xx, yy, zz, xy, xz, yz, in the link's frame.
INERTIAS = (
    (4.970684, (3.875e-3, 2.081e-3, -4.762e-2), (7.0337e-1, 7.0661e-1, 9.117e-3, -1.39e-4, 6.772e-3, 1.9169e-2)),
    (0.646926, (-3.141e-3, -2.872e-2, 3.495e-3), (7.962e-3, 2.811e-2, 2.5995e-2, -3.925e-3, 1.0254e-2, 7.04e-4)),
    (3.228604, (2.7518e-2, 3.9252e-2, -6.6502e-2), (3.7242e-2, 3.6155e-2, 1.083e-2, -4.761e-3, -1.1396e-2, -1.2805e-2)),
    (3.587895, (-5.317e-2, 1.04419e-1, 2.7454e-2), (2.5853e-2, 1.9552e-2, 2.8323e-2, 7.796e-3, -1.332e-3, 8.641e-3)),
    (1.225946, (-1.1953e-2, 4.1065e-2, -3.8437e-2), (3.5549e-2, 2.9474e-2, 8.627e-3, -2.117e-3, -4.037e-3, 2.29e-4)),
    (1.666555, (6.0149e-2, -1.4117e-2, -1.0517e-2), (1.964e-3, 4.354e-3, 5.433e-3, 1.09e-4, -1.158e-3, 3.41e-4)),
    (0.735522, (1.0517e-2, -4.252e-3, 6.1597e-2), (1.2516e-2, 1.0027e-2, 4.815e-3, -4.28e-4, -1.196e-3, -7.41e-4)),
)
COULOMB = (0.54615, 0.87224, 0.64068, 1.2794, 0.83904, 0.30301, 0.56489)  # [Nm]
VISCOUS = 1.0  # [Nm s/rad]
ARMATURE = 0.1  # [kg m²], inertia of the rotors at the joints
ONE = {"": np.eye(4)}
TORQUE = (87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0)  # [Nm]


def panda_mjcf(
    *,
    inertia_error: float = 0.0,
    friction: float = 1.0,
    timestep: float = 2.5e-4,
    placements: Mapping[str, np.ndarray] = ONE,
) -> str:
    """MJCF of the Panda with a torque motor on each joint and a site "tip" at its flange.

    inertia_error: relative error of every mass and inertia. friction: factor on all friction. The joints have no stops
    and the links do not collide: the simulation shows if a joint leaves its range. placements: (4, 4) poses of the
    bases of several Pandas, by the prefixes of their names.
    """
    heavier = 1 + inertia_error
    root = ElementTree.Element("mujoco", model="panda")
    _add(root, "compiler", angle="radian")
    _add(root, "option", timestep=timestep, integrator="implicitfast")
    defaults = _add(root, "default")
    _add(defaults, "geom", mass=0, contype=0, conaffinity=0, size=0.045, rgba=(0.9, 0.9, 0.9, 1))
    # As close to dry friction as the time step allows: with MuJoCo's default, a joint creeps.
    dry = {"solreffriction": (2 * timestep, 1), "solimpfriction": (0.99, 0.999, 1e-3)}
    _add(defaults, "joint", axis=(0, 0, 1), damping=friction * VISCOUS, armature=heavier * ARMATURE, **dry)

    world = _add(root, "worldbody")
    _add(world, "light", pos=(0.5, -1, 2), dir=(-0.3, 0.5, -1))
    _add(world, "geom", type="plane", size=(1, 1, 0.01), rgba=(0.75, 0.75, 0.75, 1))
    motors = _add(root, "actuator")
    for name, placement in placements.items():
        base = _add(world, "body", name=f"{name}base", **_frame(placement))
        _add_arm(base, motors, name, heavier, friction)
    return ElementTree.tostring(root, encoding="unicode")


def _add_arm(
    body: ElementTree.Element, motors: ElementTree.Element, name: str, heavier: float, friction: float
) -> None:
    arm = fp.SerialArm.preset("panda")
    for i, (joint, (mass, centre, inertia), coulomb) in enumerate(zip(arm.joints, INERTIAS, COULOMB), 1):
        placement = np.asarray(joint.placement)
        _link(body, placement[:3, 3])
        body = _add(body, "body", name=f"{name}link{i}", **_frame(placement))
        _add(body, "inertial", mass=heavier * mass, pos=centre, fullinertia=heavier * np.array(inertia))
        _add(body, "joint", name=f"{name}{joint.name}", frictionloss=friction * coulomb)
        _add(body, "geom", type="cylinder", size=(0.055, 0.06), rgba=(0.3, 0.3, 0.3, 1))
    _link(body, arm.tip[:3, 3])
    _add(body, "site", name=f"{name}tip", **_frame(arm.tip))
    for joint, torque in zip(arm.joints, TORQUE):
        joint_name = f"{name}{joint.name}"
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
