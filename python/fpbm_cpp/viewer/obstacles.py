"""Obstacles that are dragged about."""

from dataclasses import replace

import numpy as np

from .._core import Tracker
from .._types import Array
from ..capsule import Capsule
from ..clearance import Clearance
from ..errors import wrong
from ..obstacle import Cuboid, HalfSpace, Obstacle

SPEED = 0.3  # At most, toward where it is dragged [m/s].


class Obstacles:
    """What a tracker keeps clear of, whose capsules and boxes in the world go where they are dragged, tick by tick.

    Where nothing is to be kept clear of, nothing can be dragged.
    """

    def __init__(self, clearance: Clearance | None, dt: float) -> None:
        self._first, self._dt = clearance, dt
        # What is no clearance the tracker refuses.
        self._given: dict[str, Obstacle] = {each.name: each for each in getattr(clearance, "obstacles", ())}
        self.restart()

    @property
    def clearance(self) -> Clearance | None:
        """The clearance, its obstacles where they are now."""
        if self._first is None or not self._moved:
            return self._first
        return replace(self._first, obstacles=[self._moved.get(each.name, each) for each in self._first.obstacles])

    def restart(self) -> None:
        """Back to where they were given."""
        self._goals: dict[str, Array] = {}
        self._ways: dict[str, Array] = {}
        self._moved: dict[str, Obstacle] = {}

    def drag(self, name: str, way: Array) -> None:
        """Let a capsule or a box go to a place this far from where it was given [m], at SPEED at most.

        Raises ParameterError where no obstacle has that name.
        """
        if name not in self._given:
            names = ", ".join(self._given)
            raise wrong("name", name, f" = {name!r}: must be one of the obstacles{names and ': '}{names}")
        self._goals[name] = np.array(way, dtype=float)

    def step(self, tracker: Tracker) -> None:
        """Move those that are on their way, by a tick."""
        for name, goal in [*self._goals.items()]:
            before = self._ways.get(name, np.zeros(3))
            way = goal - before
            distance = float(np.linalg.norm(way))
            step = way * min(1.0, SPEED * self._dt / distance) if distance > 0.0 else way
            self._ways[name] = before + step
            self._moved[name] = shifted(self._given[name], before + step)
            tracker.move(name, self._moved[name], step / self._dt)
            if not step.any():  # The tracker has been told that it rests.
                del self._goals[name]


def can_be_dragged(shape: Obstacle) -> bool:
    return not isinstance(shape, HalfSpace)


def shifted(shape: Obstacle, way: Array) -> Obstacle:
    """A capsule or a box, displaced [m]."""
    if isinstance(shape, Capsule):
        return replace(shape, a=shape.a + way, b=shape.b + way)
    assert isinstance(shape, Cuboid)
    pose = shape.pose.copy()
    pose[:3, 3] += way
    return replace(shape, pose=pose)
