"""Paths of the tip: shapes, waypoints, and combinations of paths."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, replace
from functools import cached_property
from math import inf, pi
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ._core import (
    TIME_LAWS,
    at_speed,
    circle,
    in_plane,
    line,
    lissajous,
    polyline,
    sequence,
    tricuspid,
    untimed,
    waypoints,
    with_rotation,
)
from ._core import Path as CorePath
from ._types import ArrayField, OptionalArrayField
from .errors import require, wrong
from .parameter import NOT_NEGATIVE, POSITIVE, Data, Parameter, data, library_class, parameter, parameters

__all__ = ["AtSpeed", "Circle", "InPlane", "Line", "Lissajous", "Path", "Polyline", "Sequence", "Tricuspid"]
__all__ += ["Waypoints", "WithRotation"]

# Functions that construct the compiled part of a path, by kind.
COMPILERS: dict[str, Callable[..., CorePath]] = {
    each.__name__: each
    for each in (circle, lissajous, tricuspid, line, polyline, waypoints, with_rotation, sequence, at_speed)
}
# Parameters of all shapes.
DURATION = replace(
    POSITIVE, help="Duration T; without a duration, the path is as fast as possible.", usual=10.0, unit="s"
)
TIME_LAW = Parameter(help="Time law of the fraction s of the path.", choices=TIME_LAWS)


class Path(Data, CorePath):
    """Reference of the tip over T seconds, from rest to rest; after T, the reference stays at the end of the path.

    A path is a displacement from the start of the tip, so that x(0) = f(q0). Planar paths are in the xy plane, or in
    the plane that in_plane() gives. Under task='position', a path of positions leaves the orientation of the tip free.
    Under task='pose', the orientation is constant unless with_rotation() rotates the tip.

    A path without a duration is as fast as possible: for fastest(), for track(keep_path=True), and for at_speed().

    A time law gives the fraction s of the path, with tau = t/T. 'sin_squared' is the paper's sin^2(pi tau / 2); its
    acceleration is discontinuous at both ends. 'quintic' is 10 tau^3 - 15 tau^4 + 6 tau^5; its acceleration is zero at
    both ends. 'constant_speed' is tau.
    """

    kind: ClassVar[str]

    @cached_property
    def duration(self) -> float | None:
        """T [s]; None for a path without a duration."""
        return self._duration()

    def in_plane(self, plane: str | ArrayLike) -> Path:
        """This planar path in a plane of space, for example 'yz': InPlane(path, plane)."""
        return InPlane(self, plane)

    def with_rotation(self, rotation: ArrayLike, *, time_law: str = "quintic") -> Path:
        """This path of positions with a rotation of the tip: WithRotation(path, rotation, time_law=time_law).

        For an orientation R at the end and R0 at the start, give rotation_vector(R @ R0.T). Zero keeps the orientation.
        """
        return WithRotation(self, rotation, time_law=time_law)

    def at_speed(self, speed: float, *, acceleration: float, jerk: float | None = None) -> Path:
        """This path at a constant tool speed: AtSpeed(path, speed, acceleration=acceleration, jerk=jerk)."""
        return AtSpeed(self, speed, acceleration=acceleration, jerk=jerk)

    def then(self, path: Path) -> Path:
        """This path, followed by another path that starts at the end of this path."""
        return Sequence((self, path))

    def _finish(self) -> None:
        CorePath.__init__(self, self._compiled() if self._is_timed() else untimed(self._lasting(1.0)))

    def _compiled(self) -> CorePath:
        """The compiled part of a path with a duration."""
        return COMPILERS[library_class(type(self)).kind](*self._values().values())

    def _is_timed(self) -> bool:
        """Whether the path has a duration."""
        return self.duration is not None

    def _lasting(self, duration: float) -> Path:
        """The geometry of this path with another duration."""
        return self._with(duration=duration)

    def _smooth(self) -> Path:
        """This path with time laws that begin and end with zero velocity and acceleration; the geometry is equal."""
        return self._with(time_law="quintic") if "time_law" in self._values() else self

    def _speed(self) -> float:
        """Bound on the speed of the tip [m/s]."""
        return inf

    def _kept(self) -> tuple[Path, float, float]:
        """Arguments of a motion that keeps the path: smooth path, bound on the speed [m/s], least duration [s].

        A path at a speed, and a path without a duration, have no least duration.
        """
        smooth = self._smooth()
        if not smooth._is_timed():
            return smooth._lasting(1.0), self._speed(), 0.0
        return smooth, self._speed(), 0.0 if self._speed() < inf else smooth._duration() or 0.0


def are_timed(paths: Mapping[str, Path]) -> bool:
    """Whether paths have durations. paths: by their names in the error.

    Raises ParameterError if some paths have a duration, and others have none.
    """
    timed = {name: path._is_timed() for name, path in paths.items()}
    if any(timed.values()):
        for name in timed:
            if not timed[name]:
                mixed = ": has no duration, but another path has a duration: give all paths a duration, or no path"
                raise wrong(name, paths[name], mixed)
    return all(timed.values())


@data
class Circle(Path):
    """Circle, counter-clockwise from its rightmost point: r (cos phi - 1, sin phi), phi = 2 pi s."""

    kind = "circle"
    radius: float = parameter("Radius r.", POSITIVE, unit="m", usual=0.1)
    duration: float | None = parameter(like=DURATION, default=None)
    _: KW_ONLY
    time_law: str = parameter(like=TIME_LAW, default="sin_squared")


@data
class Lissajous(Path):
    """Lissajous figure.

    (a_x (cos(f_x phi + delta) - cos delta), a_y (sin(f_y phi + delta) - sin delta)), phi = 2 pi s.
    """

    kind = "lissajous"
    amplitude: ArrayField = parameter(
        "Amplitude a: one number, or one for each axis.", POSITIVE, shape="() or (2,)", unit="m", usual=0.1
    )
    duration: float | None = parameter(like=DURATION, default=None)
    _: KW_ONLY
    frequencies: ArrayField = parameter(
        "Frequencies f: integers, so that the figure is closed.", default=(2, 1), shape="(2,)", whole=True, low=1.0
    )
    phase: float = parameter("Phase delta.", default=pi / 6, unit="rad")
    time_law: str = parameter(like=TIME_LAW, default="sin_squared")


@data
class Tricuspid(Path):
    """Deltoid, from its rightmost cusp: a (2 cos phi + cos 2 phi - 3, 2 sin phi - sin 2 phi), phi = 2 pi s."""

    kind = "tricuspid"
    size: float = parameter("Size a.", POSITIVE, unit="m", usual=0.05)
    duration: float | None = parameter(like=DURATION, default=None)
    _: KW_ONLY
    time_law: str = parameter(like=TIME_LAW, default="sin_squared")


@data
class Line(Path):
    """Straight line."""

    kind = "line"
    displacement: ArrayField = parameter("From start to end.", shape="(2,) or (3,)", unit="m", usual=(0.1, 0.0))
    duration: float | None = parameter(like=DURATION, default=None)
    _: KW_ONLY
    time_law: str = parameter(like=TIME_LAW, default="sin_squared")


@data
class Polyline(Path):
    """Straight segments through points, with blends at the corners.

    A blend begins and ends at the distance `blend` from its corner, stays inside the corner, and has continuous
    curvature. With blend=0, the path stops at each corner. The rotation between two poses is proportional to the
    distance. s is proportional to the distance along the segments; blends are slower.
    """

    kind = "polyline"
    points: ArrayField = parameter(
        "Positions or poses, at least two. Only displacements from the first point count: a path starts at the tip.",
        shape="(k, 2) or (k, 3) or (k, 4, 4)",
        unit="m",
    )
    duration: float | None = parameter(like=DURATION, default=None)
    _: KW_ONLY
    blend: float = parameter(
        "Distance from a corner at which the blend begins, at most half of the shorter segment.",
        NOT_NEGATIVE,
        default=0.0,
        unit="m",
    )
    time_law: str = parameter(like=TIME_LAW, default="sin_squared")


class _Derived(float):
    """A duration that is computed from times or bounds."""


@data
class Waypoints(Path):
    """A smooth path through points, from rest to rest.

    The path is a quintic spline, which minimises the squared jerk through the points at the given times. Acceleration
    is continuous everywhere, also at the ends. Orientations are splines of quaternions, along the shorter rotation.

    Give the duration, the times, or bounds of the tip's motion. A duration is divided among the pieces by their
    lengths. With bounds, the duration is the shortest duration within the bounds, to 1 %, rounded up to 0.01 s. Without
    any of them, the path is as fast as possible.
    """

    kind = "waypoints"
    points: ArrayField = parameter(
        "Positions or poses, at least two. Only displacements from the first point count: a path starts at the tip.",
        shape="(k, 2) or (k, 3) or (k, 4, 4)",
        unit="m",
    )
    _: KW_ONLY
    duration: float | None = parameter("Duration T of the path.", POSITIVE, default=None, unit="s")
    times: OptionalArrayField = parameter("Time of each point; the first is 0.", default=None, shape="(k,)", unit="s")
    velocity: float | None = parameter("Largest speed of the tip.", POSITIVE, default=None, unit="m/s")
    acceleration: float | None = parameter("Largest acceleration of the tip.", POSITIVE, default=None, unit="m/s^2")
    angular_velocity: float | None = parameter("Largest angular velocity.", POSITIVE, default=None, unit="rad/s")
    angular_acceleration: float | None = parameter(
        "Largest angular acceleration of the tip.", POSITIVE, default=None, unit="rad/s^2"
    )
    jerk: float | None = parameter("Largest jerk of the tip.", POSITIVE, default=None, unit="m/s^3")
    angular_jerk: float | None = parameter("Largest angular jerk.", POSITIVE, default=None, unit="rad/s^3")

    def __post_init__(self) -> None:
        if isinstance(self.duration, _Derived):  # dataclasses.replace() passes the derived duration.
            object.__setattr__(self, "duration", None)
        super().__post_init__()
        if self.duration is None and self._is_timed():
            object.__setattr__(self, "duration", _Derived(self._duration() or 0.0))

    def _values(self) -> dict[str, Any]:
        values = super()._values()
        return {**values, "duration": None} if isinstance(self.duration, _Derived) else values

    def _is_timed(self) -> bool:
        return any(value is not None for name, value in self._values().items() if name != "points")

    def _lasting(self, duration: float) -> Path:
        if self.times is None:
            return Waypoints(self.points, duration=duration)
        return self._with(times=self.times * (duration / self.times[-1]))


class _Changed(Path):
    """A path that places or rotates another path."""

    path: Path

    def _finish(self) -> None:
        require("path", self.path, Path, "a path")
        super()._finish()

    def _is_timed(self) -> bool:
        return self.path._is_timed()

    def _lasting(self, duration: float) -> Path:
        return self._with(path=self.path._lasting(duration))

    def _smooth(self) -> Path:
        changed = self._with(path=self.path._smooth())
        return changed._with(time_law="quintic") if "time_law" in self._values() else changed

    def _speed(self) -> float:
        return self.path._speed()


@data
class InPlane(_Changed):
    """A planar path in a plane of space: path.in_plane(plane)."""

    path: Path = parameter("A path of positions in the plane.")
    plane: ArrayField = parameter(
        "Axes of the base frame for x and y of the path, or two perpendicular directions.",
        choices=("xy", "xz", "yx", "yz", "zx", "zy"),
        shape="(2, 3)",
    )

    def _compiled(self) -> CorePath:
        axes = np.eye(3)[["xyz".index(axis) for axis in self.plane]] if isinstance(self.plane, str) else self.plane
        return in_plane(self.path, axes)


@data
class WithRotation(_Changed):
    """A path of positions with a rotation of the tip, from rest to rest over the whole duration."""

    kind = "with_rotation"
    path: Path = parameter("A path of positions.")
    rotation: ArrayField = parameter(
        "Rotation vector along the base frame's axes, or an angle in the plane, from the orientation at the start.",
        shape="() or (3,)",
        unit="rad",
    )
    _: KW_ONLY
    time_law: str = parameter("Time law of the rotation.", default="quintic", choices=TIME_LAWS)


@data
class Sequence(Path):
    """Paths one after another: path.then(next). A Sequence among the paths is replaced by its paths.

    All paths have a duration, or no path has a duration.
    """

    kind = "sequence"
    paths: tuple[Path, ...] = parameter("Paths in their order, at least one.")

    def _finish(self) -> None:
        require("paths", self.paths, (list, tuple), "a sequence of paths")
        for i, each in enumerate(self.paths):
            require("paths", each, Path, "a path", index=i)
        parts = (path.paths if isinstance(path, Sequence) else (path,) for path in self.paths)
        object.__setattr__(self, "paths", sum(parts, ()))
        super()._finish()

    def _is_timed(self) -> bool:
        return are_timed({f"paths[{i}]": path for i, path in enumerate(self.paths)})

    def _lasting(self, duration: float) -> Path:
        shares = [path._duration() or 1.0 for path in self.paths]
        factor = duration / sum(shares)
        return self._with(paths=[path._lasting(factor * share) for path, share in zip(self.paths, shares)])

    def _smooth(self) -> Path:
        return self._with(paths=[path._smooth() for path in self.paths])

    def _speed(self) -> float:
        return min(path._speed() for path in self.paths)


@data
class AtSpeed(Path):
    """A path at a constant tool speed, with ramps from rest and to rest: path.at_speed(speed, acceleration=...).

    The speed is the speed of the tip's position. Orientations follow the positions. Only the geometry of the given path
    counts, not its duration and time law. Where the given path stops, as between the parts of a Sequence, or changes
    its direction abruptly, the tip stops. Without jerk, the acceleration is constant during a ramp. A short path does
    not reach the speed. The duration of each part between stops is rounded up to 0.01 s by longer ramps.
    """

    kind = "at_speed"
    path: Path = parameter("A path that moves the tip in position.")
    speed: float = parameter("Speed along the path.", POSITIVE, unit="m/s", usual=0.1)
    _: KW_ONLY
    acceleration: float = parameter("Largest acceleration along the path.", POSITIVE, unit="m/s^2", usual=0.5)
    jerk: float | None = parameter("Largest jerk along the path.", POSITIVE, default=None, unit="m/s^3")

    def _finish(self) -> None:
        require("path", self.path, Path, "a path")
        super()._finish()

    def _compiled(self) -> CorePath:
        path = self.path if self.path._is_timed() else self.path._lasting(1.0)
        return at_speed(path, self.speed, self.acceleration, self.jerk)

    def _is_timed(self) -> bool:
        return True

    def _lasting(self, duration: float) -> Path:
        return self.path._lasting(duration)

    def _smooth(self) -> Path:
        return self._lasting(self._duration() or 0.0)._smooth()

    def _speed(self) -> float:
        return self.speed


# Paths by the kind in a table, and the options that place and rotate a path, and give it a constant speed.
PATHS: dict[str, type[Path]] = {
    path.kind: path for path in (Circle, Lissajous, Tricuspid, Line, Polyline, Waypoints, AtSpeed)
}
PATH_OPTIONS: dict[str, Parameter] = {
    "in_plane": replace(parameters(InPlane)["plane"], name="in_plane", default=None, usual=None),
    "with_rotation": replace(parameters(WithRotation)["rotation"], name="with_rotation", default=None, usual=None),
    "rotation_time_law": replace(
        parameters(WithRotation)["time_law"], name="rotation_time_law", default=None, usual=None
    ),
    **{
        name: replace(parameters(AtSpeed)[name.removeprefix("at_")], name=name, default=None, usual=None, help=text)
        for name, text in (
            ("at_speed", "Constant speed of the tip along the path; needs at_acceleration."),
            ("at_acceleration", "Largest acceleration along the path, with at_speed."),
            ("at_jerk", "Largest jerk along the path, with at_speed."),
        )
    },
}
