"""Inertia of rigid bodies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ._types import Array


class Inertia(NamedTuple):
    """Mass of a body [kg], its centre of mass [m], and its rotational inertia about this centre [kg m^2]."""

    mass: float
    center: Array
    inertia: Array

    def moved(self, frame: Array) -> Inertia:
        """The inertia in a frame in which `frame`, shape (4, 4), is the pose of the present frame."""
        R, p = frame[:3, :3], frame[:3, 3]
        return Inertia(self.mass, R @ self.center + p, R @ self.inertia @ R.T)


NO_INERTIA = Inertia(0.0, np.zeros(3), np.zeros((3, 3)))


def joined(bodies: Sequence[Inertia]) -> Inertia:
    """Inertia of one rigid body of several bodies in the same frame, by the parallel-axis theorem."""
    if len(bodies) < 2:
        return bodies[0] if bodies else NO_INERTIA
    mass = sum(body.mass for body in bodies)
    center = sum(body.mass * body.center for body in bodies) / mass if mass > 0.0 else np.zeros(3)
    inertia = np.zeros((3, 3))
    for body in bodies:
        d = body.center - center
        inertia += body.inertia + body.mass * (d @ d * np.eye(3) - np.outer(d, d))
    return Inertia(mass, np.asarray(center), inertia)
