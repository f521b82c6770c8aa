"""The paths of a job, one kind a class."""

from typing import Annotated, Any, Literal, Optional, Union

from pydantic import Field

from .. import _core
from .section import Numbers, Plane, Section

TimeLaw = Literal["sin_squared", "quintic", "constant_speed"]


class _Path(Section):
    in_plane: Optional[Plane] = Field(
        default=None,
        description="Base axes that a path of the plane is laid along; yz for an arm in space unless given.",
    )
    with_rotation: Optional[Numbers] = Field(
        default=None, description="Rotation vector that the tip is turned by on the way [rad]; one angle in the plane."
    )
    turn_time_law: Optional[TimeLaw] = Field(default=None, description="Time law of the turn; quintic unless given.")

    @property
    def flat(self) -> bool:
        """Whether it is a path of the plane."""
        return True

    def curve(self) -> _core.Path:
        """The path before it is laid into a plane and turned."""
        raise NotImplementedError

    def build(self) -> _core.Path:
        """The path."""
        path = self.curve()
        if self.in_plane is not None:
            path = path.in_plane(self.in_plane)
        if self.with_rotation is not None:
            law: dict[str, Any] = {} if self.turn_time_law is None else {"time_law": self.turn_time_law}
            path = path.with_rotation(self.with_rotation, **law)
        return path

    def _shape(self) -> dict[str, Any]:
        return self.given("in_plane", "with_rotation", "turn_time_law")


class _Shape(_Path):
    duration: float = Field(default=10.0, description="How long the path takes [s].")
    time_law: Optional[TimeLaw] = Field(
        default=None, description="How a shape is run through: sin_squared, the paper's, unless given."
    )


class Circle(_Shape):
    """A circle."""

    kind: Literal["circle"] = "circle"
    radius: float = Field(default=0.1, description="Of a circle [m].")

    def curve(self) -> _core.Path:
        """The circle."""
        return _core.Circle(**self._shape())


class Lissajous(_Shape):
    """A Lissajous figure."""

    kind: Literal["lissajous"] = "lissajous"
    amplitude: Numbers = Field(default=0.1, description="Of a Lissajous figure [m], one number or one for either axis.")
    frequencies: Optional[list[int]] = Field(default=None, description="Of a Lissajous figure, two whole numbers.")
    phase: Optional[float] = Field(default=None, description="Of a Lissajous figure [rad].")

    def curve(self) -> _core.Path:
        """The figure."""
        return _core.Lissajous(**self._shape())


class Tricuspid(_Shape):
    """A tricuspid."""

    kind: Literal["tricuspid"] = "tricuspid"
    size: float = Field(default=0.05, description="Of a tricuspid [m].")

    def curve(self) -> _core.Path:
        """The tricuspid."""
        return _core.Tricuspid(**self._shape())


class Line(_Shape):
    """A straight line."""

    kind: Literal["line"] = "line"
    displacement: Numbers = Field(
        default=[0.1, 0.0], description="Of a line, from its start to its end [m]: 2 or 3 numbers."
    )

    @property
    def flat(self) -> bool:
        """Whether it is a path of the plane."""
        return _entries(self.displacement) == 2

    def curve(self) -> _core.Path:
        """The line."""
        return _core.Line(**self._shape())


class Waypoints(_Path):
    """A smooth path through points."""

    kind: Literal["waypoints"] = "waypoints"
    points: Numbers = Field(description="Points to pass [m], two or more, as in '0,0; 0.1,0; 0.1,0.1'.")
    duration: Optional[float] = None
    times: Optional[Numbers] = Field(default=None, description="When each point is passed [s], the first at 0.")
    speed: Optional[float] = Field(
        default=None, description="How fast the tip may go through points [m/s], in place of a duration."
    )
    acceleration: Optional[float] = Field(default=None, description="The same, of the tip's acceleration [m/s^2].")
    angular_velocity: Optional[float] = Field(default=None, description="The same, of its angular velocity [rad/s].")
    angular_acceleration: Optional[float] = Field(
        default=None, description="The same, of its angular acceleration [rad/s^2]."
    )

    @property
    def flat(self) -> bool:
        """Whether it is a path of the plane."""
        return isinstance(self.points, list) and bool(self.points) and _entries(self.points[0]) == 2

    def curve(self) -> _core.Path:
        """The path through the points."""
        return _core.Waypoints(**self._shape())


def _entries(value: Any) -> int:
    return len(value) if isinstance(value, list) else 0


AnyPath = Annotated[Union[Circle, Lissajous, Tricuspid, Line, Waypoints], Field(discriminator="kind")]
