"""Paths of the tip: shapes, waypoints, and paths made from other paths."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import KW_ONLY, replace
from functools import cached_property
from math import pi
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ._core import TIME_LAWS, circle, in_plane, line, lissajous, sequence, tricuspid, waypoints, with_rotation
from ._core import Path as CorePath
from ._types import ArrayField, DerivedField, OptionalArrayField
from .parameter import POSITIVE, Data, Parameter, data, parameter, parameters

__all__ = ["Circle", "InPlane", "Line", "Lissajous", "Path", "Sequence", "Tricuspid", "Waypoints", "WithRotation"]

# Who compiles a path of its parameters, by its kind.
COMPILERS: dict[str, Callable[..., CorePath]] = {
    each.__name__: each for each in (circle, lissajous, tricuspid, line, waypoints, with_rotation, sequence)
}
# What shapes have in common.
DURATION = replace(POSITIVE, help="Duration T of the path.", usual=10.0, unit="s")
TIME_LAW = Parameter(help="How the fraction s of the way grows with time.", choices=TIME_LAWS)


class Path(Data, CorePath):
    """Where the tip is to be, over T seconds, from rest to rest; then held.

    A displacement from where the tip starts, so that x(0) = f(q0). Paths of positions in the plane lie in the xy plane
    unless in_plane() lays them elsewhere. Paths of positions leave the tip's orientation free under task='position' and
    hold it under task='pose', unless with_rotation() rotates it.

    The time laws give the fraction s of the way, with tau = t/T: 'sin_squared', the paper's sin^2(pi tau / 2), whose
    acceleration steps at both ends; 'quintic', 10 tau^3 - 15 tau^4 + 6 tau^5, whose acceleration is zero there;
    'constant_speed', tau.
    """

    kind: ClassVar[str]

    @cached_property
    def duration(self) -> float:
        """T [s]."""
        return self._duration()

    def in_plane(self, plane: str | ArrayLike) -> Path:
        """This path of the plane, laid into a plane of space, 'yz' say: InPlane(path, plane)."""
        return InPlane(self, plane)

    def with_rotation(self, rotation: ArrayLike, *, time_law: str = "quintic") -> Path:
        """This path of positions, with the tip rotated on the way: WithRotation(path, rotation, time_law=time_law).

        To end in an orientation R: rotation_vector(R @ R0.T). Zero holds the orientation.
        """
        return WithRotation(self, rotation, time_law=time_law)

    def then(self, path: Path) -> Path:
        """This path, and from its end another."""
        return Sequence((self, path))

    def _finish(self) -> None:
        CorePath.__init__(self, COMPILERS[self.kind](*self._values().values()))


@data
class Circle(Path):
    """Circle, counter-clockwise from its rightmost point: r (cos phi - 1, sin phi), phi = 2 pi s."""

    kind = "circle"
    radius: float = parameter("Radius r.", POSITIVE, unit="m", usual=0.1)
    duration: float = parameter(like=DURATION)
    _: KW_ONLY
    time_law: str = parameter(like=TIME_LAW, default="sin_squared")


@data
class Lissajous(Path):
    """Lissajous figure.

    (a_x (cos(f_x phi + delta) - cos delta), a_y (sin(f_y phi + delta) - sin delta)), phi = 2 pi s.
    """

    kind = "lissajous"
    amplitude: ArrayField = parameter(
        "Amplitude a: one for both axes or one each.", POSITIVE, shape="() or (2,)", unit="m", usual=0.1
    )
    duration: float = parameter(like=DURATION)
    _: KW_ONLY
    frequencies: ArrayField = parameter(
        "Frequencies f: whole, so that the figure closes.", default=(2, 1), shape="(2,)", whole=True, low=1.0
    )
    phase: float = parameter("Phase delta.", default=pi / 6, unit="rad")
    time_law: str = parameter(like=TIME_LAW, default="sin_squared")


@data
class Tricuspid(Path):
    """Deltoid, from its rightmost cusp: a (2 cos phi + cos 2 phi - 3, 2 sin phi - sin 2 phi), phi = 2 pi s."""

    kind = "tricuspid"
    size: float = parameter("Size a.", POSITIVE, unit="m", usual=0.05)
    duration: float = parameter(like=DURATION)
    _: KW_ONLY
    time_law: str = parameter(like=TIME_LAW, default="sin_squared")


@data
class Line(Path):
    """Straight line."""

    kind = "line"
    displacement: ArrayField = parameter("From its start to its end.", shape="(2,) or (3,)", unit="m", usual=(0.1, 0.0))
    duration: float = parameter(like=DURATION)
    _: KW_ONLY
    time_law: str = parameter(like=TIME_LAW, default="sin_squared")


class _Derived(float):
    """A duration that follows from times or bounds, and was not given."""


@data
class Waypoints(Path):
    """A smooth path through points, from rest to rest.

    A quintic spline: of all curves through the points at those times, the one of least jerk. Acceleration is continuous
    everywhere, the ends included. Orientations are splines of quaternions, and turn by the shorter way.

    Give one of: the duration, of which each piece gets a share by its length; the times; bounds of the tip's motion,
    for the shortest duration that they allow, to 1 %, rounded up to 0.01 s.
    """

    kind = "waypoints"
    points: ArrayField = parameter(
        "Positions or poses, two at least. Only differences from the first matter: a path starts where the tip is.",
        shape="(k, 2) or (k, 3) or (k, 4, 4)",
        unit="m",
    )
    _: KW_ONLY
    duration: DerivedField = parameter("Duration T of the path.", POSITIVE, type=float, default=None, unit="s")
    times: OptionalArrayField = parameter("When each is passed, the first at 0.", default=None, shape="(k,)", unit="s")
    velocity: float | None = parameter("Highest speed of the tip.", POSITIVE, default=None, unit="m/s")
    acceleration: float | None = parameter("Highest acceleration of the tip.", POSITIVE, default=None, unit="m/s^2")
    angular_velocity: float | None = parameter("Highest angular velocity.", POSITIVE, default=None, unit="rad/s")
    angular_acceleration: float | None = parameter(
        "Highest angular acceleration of the tip.", POSITIVE, default=None, unit="rad/s^2"
    )

    def __post_init__(self) -> None:
        if isinstance(self.duration, _Derived):  # From dataclasses.replace().
            object.__setattr__(self, "duration", None)
        super().__post_init__()
        if self.duration is None:
            object.__setattr__(self, "duration", _Derived(self._duration()))

    def _values(self) -> dict[str, Any]:
        values = super()._values()
        return {**values, "duration": None} if isinstance(self.duration, _Derived) else values


@data
class InPlane(Path):
    """A path of the plane, laid into a plane of space: path.in_plane(plane)."""

    path: Path = parameter("A path of positions in the plane.")
    plane: ArrayField = parameter(
        "The base frame's axes that the path's x and y run along, or two directions at right angles.",
        choices=("xy", "xz", "yx", "yz", "zx", "zy"),
        shape="(2, 3)",
    )

    def _finish(self) -> None:
        axes = np.eye(3)[["xyz".index(axis) for axis in self.plane]] if isinstance(self.plane, str) else self.plane
        CorePath.__init__(self, in_plane(self.path, axes))


@data
class WithRotation(Path):
    """A path of positions, with the tip rotated on the way, from rest to rest over the whole duration."""

    kind = "with_rotation"
    path: Path = parameter("A path of positions.")
    rotation: ArrayField = parameter(
        "Rotation vector along the base frame's axes, or an angle in the plane, from the orientation at the start.",
        shape="() or (3,)",
        unit="rad",
    )
    _: KW_ONLY
    time_law: str = parameter("How the rotation grows with time.", default="quintic", choices=TIME_LAWS)


@data
class Sequence(Path):
    """Paths one after another: path.then(next). Sequences among them are replaced by their paths."""

    kind = "sequence"
    paths: tuple[Path, ...] = parameter("In their order, one at least.")

    def _finish(self) -> None:
        parts = (path.paths if isinstance(path, Sequence) else (path,) for path in self.paths)
        object.__setattr__(self, "paths", sum(parts, ()))
        super()._finish()


# The shapes by the kind that a table has, and how any of them is laid and rotated.
PATHS: dict[str, type[Path]] = {shape.kind: shape for shape in (Circle, Lissajous, Tricuspid, Line, Waypoints)}
PATH_OPTIONS: dict[str, Parameter] = {
    "in_plane": replace(parameters(InPlane)["plane"], name="in_plane", default=None, usual=None),
    "with_rotation": replace(parameters(WithRotation)["rotation"], name="with_rotation", default=None, usual=None),
    "rotation_time_law": replace(
        parameters(WithRotation)["time_law"], name="rotation_time_law", default=None, usual=None
    ),
}
