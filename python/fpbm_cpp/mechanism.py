"""Bounds, gravity and payloads of arms and robots."""

from __future__ import annotations

from dataclasses import KW_ONLY
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from ._types import ArrayField, OptionalArrayField
from .errors import wrong
from .inertia import Inertia
from .joints import CENTER, INERTIA, JointLimits
from .parameter import NOT_NEGATIVE, Data, Parameter, data, parameter, renamed

if TYPE_CHECKING:
    from ._core import Model as CoreModel
else:  # The compiled part is a base of the subclasses, once.
    CoreModel = object

M = TypeVar("M", bound="Mechanism")


@data
class Payload(Data):
    """A payload, as the arguments of with_payload(), or as a table of a job."""

    mass: float = parameter("Mass.", NOT_NEGATIVE, unit="kg")
    com: ArrayField = parameter("Centre of mass in the frame.", CENTER, default=(0, 0, 0))
    inertia: OptionalArrayField = parameter(
        "Rotational inertia about com, along the axes of the frame; default: a point mass.", INERTIA, default=None
    )
    frame: str = parameter("Frame that carries the payload.", default="tip")


PAYLOAD = Parameter("payload", default=None, usual=None, help="Payload: a table with mass, com, inertia and frame.")


@data
class Mechanism(Data, CoreModel):
    """An arm or a robot."""

    _: KW_ONLY
    gravity_vector: ArrayField = parameter(
        "Acceleration of gravity in the base frame.", default=(0, 0, -9.81), shape="(3,)", unit="m/s^2"
    )

    @cached_property
    def limits(self) -> JointLimits:
        """Bounds of the joints' motion and of their torques."""
        return JointLimits(**self.bounds())

    def with_gravity(self: M, vector: ArrayLike) -> M:
        """A copy with another acceleration of gravity, for a base that is mounted at an angle.

        vector: acceleration of gravity in the base frame, shape (3,) [m/s^2]; (0, 0, 9.81) for an arm on a ceiling.

        Raises ParameterError if vector is not three finite numbers.
        """
        return self._with(gravity_vector=renamed("vector", vector, CENTER))

    def with_payload(
        self: M, mass: float, *, com: ArrayLike, inertia: ArrayLike | None = None, frame: str = "tip"
    ) -> M:
        """A copy with a payload fixed to a frame. Payloads of repeated calls add.

        The link of the frame and the payload become one body, whose inertia follows from the parallel-axis theorem.

        Parameters
        ----------
        mass : float, not negative [kg]
        com : array_like, shape (3,) [m]
            Centre of mass of the payload in the frame.
        inertia : array_like, shape (3, 3), optional [kg m^2]
            Rotational inertia about com, along the axes of the frame; default: a point mass.
        frame : str
            'tip' of an arm, a frame of a robot, or a joint, for the frame of the link that the joint moves.

        Raises ParameterError if a number is out of range, or the frame does not exist or does not move.
        """
        load = Payload(mass, com, inertia, frame)
        body = Inertia(load.mass, load.com, np.zeros((3, 3)) if load.inertia is None else load.inertia)
        link, place = self.locate(frame)
        if link == 0:
            raise wrong("frame", frame, f" = {frame!r}: is fixed to the base: must be a frame that a joint moves")
        return self._carrying(link, body.moved(place))

    def _carrying(self: M, link: int, body: Inertia) -> M:
        """A copy whose link carries a body, given in the frame of the link."""
        raise NotImplementedError
