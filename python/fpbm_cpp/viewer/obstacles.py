"""Obstacles that the user drags."""

import math
from dataclasses import replace

import numpy as np

from .._core import Tracker
from .._types import Array
from ..capsule import Capsule
from ..clearance import Clearance
from ..errors import wrong
from ..obstacle import Cuboid, Obstacle

SPEED = 0.3  # Largest velocity toward the goal [m/s].
ACCELERATION = 1.0  # Largest acceleration [m/s²].


class Obstacles:
    """Obstacles of a tracker; capsules and boxes move tick by tick to the place to which the user drags them.

    Without a clearance, nothing can be dragged.
    """

    def __init__(self, clearance: Clearance | None, dt: float) -> None:
        self._first, self._dt = clearance, dt
        self._given: dict[str, Obstacle] = {each.name: each for each in clearance.obstacles} if clearance else {}
        self.restart()

    @property
    def clearance(self) -> Clearance | None:
        """The clearance, with its obstacles at their present places."""
        if self._first is None or not self._moves:
            return self._first
        moved = {name: shifted(self._given[name], displacement) for name, (displacement, _) in self._moves.items()}
        return replace(self._first, obstacles=[moved.get(each.name, each) for each in self._first.obstacles])

    def restart(self) -> None:
        """Move all obstacles to their given places."""
        self._goals: dict[str, Array] = {}
        self._moves: dict[str, tuple[Array, Array]] = {}  # Displacement [m] and velocity [m/s].

    def drag(self, name: str, displacement: Array) -> None:
        """Move a capsule or a box to this displacement from its given place [m], within SPEED and ACCELERATION.

        Raises ParameterError if no obstacle has that name.
        """
        if name not in self._given:
            names = ", ".join(self._given) or "none"
            raise wrong("name", name, f" = {name!r}: must be one of the obstacles: {names}")
        self._goals[name] = np.array(displacement, dtype=float)

    def step(self, tracker: Tracker) -> None:
        """Move the obstacles that have a goal, by one tick."""
        for name, goal in [*self._goals.items()]:
            before, velocity = self._moves.get(name, (np.zeros(3), np.zeros(3)))
            left = goal - before
            distance, change = float(np.linalg.norm(left)), ACCELERATION * self._dt
            if distance <= change * self._dt and np.linalg.norm(velocity) <= 2 * change:
                displacement, velocity = goal, np.zeros(3)
                del self._goals[name]
            else:
                # With half of the acceleration, the obstacle stops in time in spite of a delay of one tick.
                desired = left * min(SPEED, math.sqrt(ACCELERATION * distance)) / max(distance, math.ulp(1.0))
                turn = desired - velocity
                velocity = velocity + turn * min(1.0, change / max(float(np.linalg.norm(turn)), math.ulp(1.0)))
                displacement = before + self._dt * velocity
            self._moves[name] = displacement, velocity
            tracker.move(name, shifted(self._given[name], displacement), velocity)


def shifted(shape: Obstacle, displacement: Array) -> Obstacle:
    """A capsule or a box, displaced [m]."""
    if isinstance(shape, Capsule):
        return replace(shape, a=shape.a + displacement, b=shape.b + displacement)
    assert isinstance(shape, Cuboid)
    pose = shape.pose.copy()
    pose[:3, 3] += displacement
    return replace(shape, pose=pose)
