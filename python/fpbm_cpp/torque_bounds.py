"""Bounds on the torques of the drives."""

from __future__ import annotations

from dataclasses import KW_ONLY
from typing import ClassVar

from ._core import Model as CoreModel
from ._types import OptionalArrayField
from .errors import require
from .parameter import POSITIVE, Data, Parameter, data, parameter


@data
class TorqueBounds(Data):
    """Bounds on the torques of the drives, for schemes at acceleration level.

    The torques of inverse dynamics, M(q) qdd + h(q, qd), keep the bounds at the start and at the end of every tick: a
    tick is executed only if the torques keep the bounds until the arm is at rest. If full deceleration exceeds a
    bound, a slower stop is planned, so the arm slows down near the edge of its torques. Dry friction reduces the
    bounds, because its sign is unknown at rest. The arm needs masses and bounds on acceleration; see "Torques" in the
    documentation.

    Raises ParameterError if a number is out of range. A tracker also raises ParameterError if the arm has no efforts
    or no masses, if a bound does not exceed the dry friction, or if the arm cannot hold its start.
    """

    kind: ClassVar[str] = "torque_bounds"
    _: KW_ONLY
    fraction: float = parameter("Fraction of the efforts that the torques use.", POSITIVE, default=1.0, high=1.0)
    effort: OptionalArrayField = parameter(
        "Largest torques; for a prismatic joint, forces [N]. Default: arm.limits.effort.",
        Parameter(low=0.0, infinite=True, shape="(n,) or ()"),
        default=None,
        unit="Nm",
    )
    lighter: CoreModel | None = parameter(
        "The arm with a smaller payload, if the mass of the payload is only known to be between two values: the arm "
        "itself has the larger payload.",
        default=None,
    )

    def _finish(self) -> None:
        if self.lighter is not None:
            require("lighter", self.lighter, CoreModel, "an arm or a Robot")
