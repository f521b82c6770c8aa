"""Redundancy resolution schemes. Numbers in brackets are the equations of Wang et al., IEEE Access 2019."""

from __future__ import annotations

from dataclasses import KW_ONLY, replace
from typing import ClassVar

from ._core import Scheme as CoreScheme
from ._types import ArrayField, OptionalArrayField
from .parameter import NOT_NEGATIVE, POSITIVE, Data, Parameter, data, library_class, parameter

__all__ = [
    "FPBM",
    "MAN",
    "MVN",
    "WMVN",
    "Balanced",
    "MinimumEnergy",
    "MinimumTorque",
    "Scheme",
    "WMVNAcceleration",
]

# Parameters of several classes.
ALPHA = Parameter(help="Weight of WMVN in the balance; the weight of MAN is 1 - alpha.", usual=0.6, low=0.0, high=1.0)
WEIGHTS = replace(POSITIVE, help="W or its diagonal, positive definite. Only ratios count.", shape="(n,) or (n, n)")
K = replace(NOT_NEGATIVE, help="Position feedback gain: xd + k (x - f(q)) replaces xd.", unit="1/s")
STIFFNESS = replace(NOT_NEGATIVE, unit="1/s^2, 1/s at velocity level")
FREE = Parameter(shape="(n,)", unit="rad/s^2, rad/s at velocity level")
SQUARED = replace(NOT_NEGATIVE, unit="rad^2/s^2, rad^2/s at velocity level")


@data
class Scheme(Data, CoreScheme):
    """Base class of the redundancy resolution schemes.

    joint_centring, manipulability_gain, MinimumTorque and MinimumEnergy need an arm: resolve() rejects them for a
    Kinematics.
    """

    kind: ClassVar[str]
    level: ClassVar[str]  #: 'velocity' if resolve() returns qd, 'acceleration' if resolve() returns qdd.
    fixed: ClassVar[dict[str, float]] = {}  # Parameters that the scheme fixes in the law of its level.
    _: KW_ONLY
    rest_posture: OptionalArrayField = parameter("Rest posture.", default=None, shape="(n,)", unit="rad")
    null_stiffness: float = parameter("Stiffness of the rest posture.", STIFFNESS, default=0.0)
    c: OptionalArrayField = parameter("Free choice in the general solution (5) or (3).", FREE, default=None)
    joint_centring: float = parameter(
        "Gain down the gradient of 1/2 sum ((q_i - middle_i)/(upper_i - lower_i))^2, the sum over the joints with a "
        "lower and an upper bound (Liegeois, 1977).",
        SQUARED,
        default=0.0,
    )
    manipulability_gain: float = parameter(
        "Gain up the gradient of sqrt(det(J J')) (Yoshikawa, 1985). At acceleration level, also set null_damping: "
        "without damping, the oscillation of the joints does not decay.",
        SQUARED,
        default=0.0,
    )
    singular_radius: float = parameter(
        "Singular values of J below singular_radius times the norm of J are damped; 0.02 is a good value. 0: no "
        "damping, and singular postures are an error.",
        default=0.0,
        low=0.0,
        high=1.0,
    )
    singular_brake: float = parameter(
        "Null-space damping near singular postures.", NOT_NEGATIVE, default=10.0, unit="1/s"
    )

    def _finish(self) -> None:
        meaning = library_class(type(self))
        if meaning not in SCHEMES.values():
            names = ", ".join(each.__name__ for each in SCHEMES.values())
            raise TypeError(f"{type(self).__name__}: is not a scheme: must be derived from one of {names}")
        CoreScheme.__init__(self, meaning.level, {**meaning.fixed, **self._values()})


class VelocityScheme(Scheme):
    """A scheme at velocity level: the result is the joint velocity."""

    level = "velocity"


@data
class AccelerationScheme(Scheme):
    """A scheme at acceleration level: the result is the joint acceleration."""

    level = "acceleration"
    _: KW_ONLY
    null_damping: float = parameter(
        "Null-space damping; the schemes of the paper have none.", NOT_NEGATIVE, default=0.0, usual=2.0, unit="1/s"
    )


@data
class MVN(VelocityScheme):
    """Minimum velocity norm, (6): qd = J+ xd. With c: the general solution (3)."""

    kind = "mvn"
    _: KW_ONLY
    k: float = parameter(like=K, default=0.0)


@data
class WMVN(VelocityScheme):
    """Weighted minimum velocity norm, (7): qd = J_W+ xd, which minimises qd' W qd."""

    kind = "wmvn"
    weights: ArrayField = parameter(like=WEIGHTS)
    _: KW_ONLY
    k: float = parameter(like=K, default=0.0)


@data
class MAN(AccelerationScheme):
    """Minimum acceleration norm, (8): qdd = J+ (xdd - Jd qd). With c: the general solution (5)."""

    kind = "man"
    fixed: ClassVar[dict[str, float]] = {"alpha": 0.0}


@data
class WMVNAcceleration(AccelerationScheme):
    """Weighted minimum velocity norm at acceleration level, (9): the time derivative of (7).

    qdd = J_W+ (xdd - Jd qd) + N_W W^-1 Jd' (J W^-1 J')^-1 xd.
    """

    kind = "wmvn_acceleration"
    fixed: ClassVar[dict[str, float]] = {"alpha": 1.0}
    weights: ArrayField = parameter(like=WEIGHTS)


@data
class Balanced(AccelerationScheme):
    """Balance of MAN and WMVN without feedback, (16): (1 - alpha) MAN (8) + alpha WMVN (9)."""

    kind = "balanced"
    alpha: float = parameter(like=ALPHA)
    weights: ArrayField = parameter(like=WEIGHTS)


@data
class FPBM(AccelerationScheme):
    """Feedback-added pseudoinverse-type balanced minimisation, (13).

    The balance (16) with b = xdd - Jd qd + k1 (xd - J qd) + k2 (x - f(q)) instead of xdd - Jd qd, so that the tip
    error e obeys e'' + k1 e' + k2 e = 0 for every alpha and W.
    """

    kind = "fpbm"
    alpha: float = parameter(like=ALPHA)
    weights: ArrayField = parameter(like=WEIGHTS)
    k1: float = parameter("Feedback gain on velocity.", NOT_NEGATIVE, default=10.0, unit="1/s")
    k2: float = parameter("Feedback gain on position.", NOT_NEGATIVE, default=25.0, unit="1/s^2")


@data
class MinimumEnergy(VelocityScheme):
    """Least kinetic energy: qd = J_M+ xd, which minimises qd' M qd (Whitney, 1969). M is the mass matrix of the arm."""

    kind = "minimum_energy"
    fixed: ClassVar[dict[str, float]] = {"uses_dynamics": 1.0}
    _: KW_ONLY
    k: float = parameter(like=K, default=0.0)


@data
class MinimumTorque(AccelerationScheme):
    """Least torque: (1 - alpha) MTN + alpha WMVN (9), with feedback as in FPBM.

    MTN is the qdd with the least norm of the torque M qdd + h of the arm, gravity included (Hollerbach and Suh, 1987).
    Long motions are unstable without null_damping, and MTN alone (alpha = 0) moves light joints fast. With a stack, set
    k1 = k2 = 0, since the tasks have their own gains.
    """

    kind = "minimum_torque"
    fixed: ClassVar[dict[str, float]] = {"uses_dynamics": 1.0}
    _: KW_ONLY
    alpha: float = parameter(
        "Weight of WMVN in the balance; the weight of MTN is 1 - alpha.", default=0.0, low=0.0, high=1.0
    )
    weights: OptionalArrayField = parameter(
        "W of WMVN or its diagonal, positive definite; I by default. Only ratios count.",
        POSITIVE,
        default=None,
        shape="(n,) or (n, n)",
    )
    k1: float = parameter("Feedback gain on velocity.", NOT_NEGATIVE, default=10.0, unit="1/s")
    k2: float = parameter("Feedback gain on position.", NOT_NEGATIVE, default=25.0, unit="1/s^2")


# Classes of schemes, by the kind in a table.
SCHEMES: dict[str, type[Scheme]] = {
    each.kind: each for each in (MVN, WMVN, MAN, WMVNAcceleration, Balanced, FPBM, MinimumEnergy, MinimumTorque)
}
# Classes that also suit an arm without masses.
WITHOUT_DYNAMICS = {kind: each for kind, each in SCHEMES.items() if "uses_dynamics" not in each.fixed}
