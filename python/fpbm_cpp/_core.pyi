"""
The compiled part of fpbm_cpp.
"""

from __future__ import annotations
import collections.abc
import enum
import numpy
import numpy.typing
import typing

__all__: list[str] = [
    "Arm",
    "Balanced",
    "Circle",
    "PathFollower",
    "FPBM",
    "Gaze",
    "JointLimits",
    "Kinematics",
    "Line",
    "Lissajous",
    "MAN",
    "MAX_DOF",
    "MVN",
    "Path",
    "PlanarArm",
    "Scheme",
    "SecondTask",
    "SerialArm",
    "Status",
    "Stop",
    "Tick",
    "Tracker",
    "Tricuspid",
    "WMVN",
    "WMVNAcceleration",
    "Waypoints",
    "advice",
    "check_sweep",
    "dh",
    "failed",
    "message",
    "not_run",
    "preset",
    "processor_kinds",
    "rotation",
    "rotation_vector",
    "simulate",
    "sweep_chunk",
    "use_lanes",
]

class JointLimits:
    """
    Bounds of each joint's motion, infinite where there is none.

    Parameters
    ----------
    lower, upper, velocity, acceleration : array_like, shape (n,)
        Bounds on positions [rad], velocities either way [rad/s] and accelerations either way [rad/s^2]; [m] and so on for
        prismatic joints.

    Raises
    ------
    ValueError
        Where one is not a number, or has another length.
    """
    def __init__(
        self,
        *,
        lower: numpy.typing.ArrayLike,
        upper: numpy.typing.ArrayLike,
        velocity: numpy.typing.ArrayLike,
        acceleration: numpy.typing.ArrayLike,
    ) -> None: ...
    def __repr__(self) -> str: ...
    @property
    def acceleration(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Highest joint accelerations [rad/s^2] or [m/s^2], shape (n,).
        """
    @property
    def lower(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Lowest joint positions [rad] or [m], shape (n,).
        """
    @property
    def upper(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Highest joint positions [rad] or [m], shape (n,).
        """
    @property
    def velocity(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Highest joint speeds [rad/s] or [m/s], shape (n,).
        """

class Kinematics:
    """
    Tip, J and Jd of an arm in one state: all that a scheme knows of it.

    From an arm's kinematics(), or from any library that has these three (Pinocchio, Drake, MuJoCo, ...).

    Parameters
    ----------
    tip : array_like, shape (2,), (3,) or (4, 4)
        f(q) in the base frame [m]: a position, (x, y, angle) of a pose in the plane, or a homogeneous matrix.
    J : array_like, shape (m, n)
        Task Jacobian, linear rows first, then angular, along the base frame's axes (Pinocchio's LOCAL_WORLD_ALIGNED).
    Jd : array_like, shape (m, n), optional
        dJ/dt along qd; velocity-level schemes do without.
    task : str
        Tells what three numbers in tip are: a 'position' in space, or a 'pose' in the plane.

    Raises
    ------
    ValueError
        Where a number is not finite, or shapes do not fit.
    """
    def __init__(
        self,
        tip: numpy.typing.ArrayLike,
        J: numpy.typing.ArrayLike,
        Jd: numpy.typing.ArrayLike | None = None,
        *,
        task: str = "position",
    ) -> None: ...
    @property
    def J(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        Task Jacobian, shape (m, n).
        """
    @property
    def Jd(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        dJ/dt along qd, shape (m, n).
        """
    @property
    def tip(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        f(q) in the base frame [m], shape (2,), (3,) or (4, 4).
        """

class Arm:
    """
    A robot arm: what all kinds of it can do.
    """
    def jacobian(
        self, q: numpy.typing.ArrayLike, *, task: str = "position"
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        Task Jacobian J(q), shape (m, n): tip velocity is J qd. q: shape (n,) [rad]. task: 'position' or 'pose', whose rows are linear first, then
        angular, along the base frame's axes.
        """
    def jacobian_dot(
        self, q: numpy.typing.ArrayLike, qd: numpy.typing.ArrayLike, *, task: str = "position"
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        dJ/dt along qd, shape (m, n): tip acceleration is J qdd + Jd qd. q, qd: shape (n,) [rad], [rad/s]. task: 'position' or 'pose', whose rows are linear first, then
        angular, along the base frame's axes.
        """
    def kinematics(
        self, q: numpy.typing.ArrayLike, qd: numpy.typing.ArrayLike, *, task: str = "position"
    ) -> Kinematics:
        """
        Tip, J and Jd at q, qd, shape (n,) [rad], [rad/s]. task: 'position' or 'pose', whose rows are linear first, then
        angular, along the base frame's axes.
        """
    @property
    def dof(self) -> int:
        """
        Number of joints n.
        """
    @property
    def joint_names(self) -> list[str]:
        """
        Names of the joints, from the base on.
        """
    @property
    def limits(self) -> JointLimits:
        """
        Bounds of the joints' motion.
        """

class PlanarArm(Arm):
    """
    Planar arm of n revolute joints.

    f(q) = sum_i l_i (cos th_i, sin th_i) with th_i = q_1 + ... + q_i: joint angles are relative [rad], the first
    from the base frame's x axis. Its pose is (x, y, th_n).

    Parameters
    ----------
    lengths : array_like, shape (n,)
        Link lengths [m], 2 to MAX_DOF of them, positive. Up to 8 joints run in code made for just that number.

    Raises
    ------
    ValueError
        Where a length is not positive and finite, or there are too few or too many.
    """
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    def __hash__(self) -> int: ...
    def __init__(self, lengths: numpy.typing.ArrayLike) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None: ...
    def forward(self, q: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        Tip position f(q) in the base frame [m], shape (2,). q: shape (n,) [rad].
        """
    @property
    def lengths(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Link lengths [m], shape (n,).
        """

class SerialArm(Arm):
    """
    The compiled part of fpbm_cpp.SerialArm.
    """
    def __init__(self, joints: list[typing.Any], tip: numpy.typing.ArrayLike) -> None: ...
    def forward(self, q: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        Tip pose f(q) in the base frame as a homogeneous matrix [m], shape (4, 4). q: shape (n,) [rad].
        """

class Path:
    """
    Where the tip is to be, over T seconds, from rest to rest; then held.

    A displacement from where the tip starts, so that x(0) = f(q0). Paths of positions in the plane lie in the xy plane
    unless in_plane() lays them elsewhere; paths of positions leave the tip's orientation free under task='position' and
    hold it under task='pose', unless with_rotation() turns it.

    The time laws give the fraction done, with tau = t/T: 'sin_squared', the paper's sin^2(pi tau / 2), whose acceleration
    steps at both ends; 'quintic', 10 tau^3 - 15 tau^4 + 6 tau^5, whose acceleration is zero there; 'constant_speed', tau.
    """
    def __reduce__(self) -> tuple[typing.Any, ...]: ...
    def __repr__(self) -> str: ...
    def in_plane(self, plane: typing.Any) -> Path:
        """
        This path of the plane laid into a plane of space.

        plane: the base frame's axes that its x and y run along, as in 'yz', or any two directions at right angles,
        shape (2, 3).
        """
    def sample(
        self, t: typing.SupportsFloat | typing.SupportsIndex
    ) -> tuple[
        numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]
    ]:
        """
        (x, xd, xdd) at t [s], as a displacement from where the tip starts [m, m/s, m/s^2].

        x has shape (2,) or (3,), or (4, 4) where the path turns the tip in space (in the plane: x, y, angle); xd and xdd have
        shape (m,), linear rows first, then angular. At rest on the path's ends outside 0 <= t <= T.
        """
    def then(self, path: Path) -> Path:
        """
        This path, and from its end another.
        """
    def with_rotation(self, turn: numpy.typing.ArrayLike, *, time_law: str = "quintic") -> Path:
        """
        This path of positions with the tip turned on the way, from rest to rest over its whole duration.

        turn: rotation vector along the base frame's axes [rad], shape (3,), or an angle in the plane, from the orientation that
        the tip starts in. To end in an orientation R: rotation_vector(R @ R0.T). Zero holds the orientation.
        """
    @property
    def duration(self) -> float:
        """
        T [s].
        """

class Circle(Path):
    """
    Circle, counter-clockwise from its rightmost point.

    r (cos phi - 1, sin phi), phi = 2 pi s.

    Parameters
    ----------
    radius : float
        r [m], positive.
    duration : float
        T [s], positive.
    time_law : str
        'sin_squared', 'quintic' or 'constant_speed'.

    Raises
    ------
    ValueError
        Where a number is not positive and finite, or the time law is unknown.
    """
    def __init__(
        self,
        radius: typing.SupportsFloat | typing.SupportsIndex,
        duration: typing.SupportsFloat | typing.SupportsIndex,
        *,
        time_law: str = "sin_squared",
    ) -> None: ...

class Lissajous(Path):
    """
    Lissajous figure.

    (a_x (cos(f_x phi + delta) - cos delta), a_y (sin(f_y phi + delta) - sin delta)), phi = 2 pi s.

    Parameters
    ----------
    amplitude : float or (float, float)
        a [m], one for both axes or one each, positive.
    duration : float
        T [s], positive.
    frequencies : (int, int)
        f, whole and positive, so that the figure closes.
    phase : float
        delta [rad].
    time_law : str
        'sin_squared', 'quintic' or 'constant_speed'.

    Raises
    ------
    ValueError
        Where a number is out of range or not finite, or the time law is unknown.
    """
    def __init__(
        self,
        amplitude: numpy.typing.ArrayLike,
        duration: typing.SupportsFloat | typing.SupportsIndex,
        *,
        frequencies: typing.Annotated[numpy.typing.ArrayLike, numpy.int32, "[2, 1]"] = ...,
        phase: typing.SupportsFloat | typing.SupportsIndex = 0.5235987755982988,
        time_law: str = "sin_squared",
    ) -> None: ...

class Tricuspid(Path):
    """
    Tricuspid (deltoid), from its rightmost cusp.

    a (2 cos phi + cos 2 phi - 3, 2 sin phi - sin 2 phi), phi = 2 pi s.

    Parameters
    ----------
    size : float
        a [m], positive.
    duration : float
        T [s], positive.
    time_law : str
        'sin_squared', 'quintic' or 'constant_speed'.

    Raises
    ------
    ValueError
        Where a number is not positive and finite, or the time law is unknown.
    """
    def __init__(
        self,
        size: typing.SupportsFloat | typing.SupportsIndex,
        duration: typing.SupportsFloat | typing.SupportsIndex,
        *,
        time_law: str = "sin_squared",
    ) -> None: ...

class Line(Path):
    """
    Straight line.

    Parameters
    ----------
    displacement : array_like, shape (2,) or (3,)
        From the start of the line to its end [m].
    duration : float
        T [s], positive.
    time_law : str
        'sin_squared', 'quintic' or 'constant_speed'.

    Raises
    ------
    ValueError
        Where a number is not finite, the duration not positive, or the time law unknown.
    """
    def __init__(
        self,
        displacement: numpy.typing.ArrayLike,
        duration: typing.SupportsFloat | typing.SupportsIndex,
        *,
        time_law: str = "sin_squared",
    ) -> None: ...

class Waypoints(Path):
    """
    A smooth path through points, from rest to rest.

    A quintic spline: of all curves through the points at those times, the one of least jerk. Acceleration is continuous
    everywhere, the ends included. Orientations are splines of quaternions, and turn by the shorter way.

    Parameters
    ----------
    points : array_like, shape (k, 2), (k, 3) or (k, 4, 4)
        Positions [m] or poses, two at least. Only differences from the first matter, since a path starts where the tip is:
        coordinates in the base frame do as well as displacements.
    duration : float
        T [s]; each piece gets its share by its length.
    times : array_like, shape (k,)
        When each point is passed [s], the first at 0.
    speed, acceleration, angular_velocity, angular_acceleration : float
        As fast as these bounds of the tip's motion allow [m/s, m/s^2, rad/s, rad/s^2], to 1 %; T is rounded up to 0.01 s.

    Raises
    ------
    ValueError
        Where not just one of duration, times and bounds is given, a number is out of range or not finite, or two points
        that follow each other are one.
    """
    def __init__(
        self,
        points: numpy.typing.ArrayLike,
        *,
        duration: typing.SupportsFloat | typing.SupportsIndex | None = None,
        times: numpy.typing.ArrayLike | None = None,
        speed: typing.SupportsFloat | typing.SupportsIndex | None = None,
        acceleration: typing.SupportsFloat | typing.SupportsIndex | None = None,
        angular_velocity: typing.SupportsFloat | typing.SupportsIndex | None = None,
        angular_acceleration: typing.SupportsFloat | typing.SupportsIndex | None = None,
    ) -> None: ...

class Status(enum.Enum):
    """
    What became of an evaluation or a rollout.
    """

    DAMPED = ...
    NOT_FINITE = ...
    OK = ...
    SINGULAR = ...
    SLOWED = ...
    TASK_LOST = ...

class Scheme:
    """
    A redundancy resolution scheme: what all of them can do.
    """
    def __reduce__(self) -> tuple[typing.Any, ...]: ...
    def __repr__(self) -> str: ...
    @typing.overload
    def resolve(
        self,
        arm: Arm,
        q: numpy.typing.ArrayLike,
        qd: numpy.typing.ArrayLike,
        x: numpy.typing.ArrayLike,
        xd: numpy.typing.ArrayLike,
        xdd: numpy.typing.ArrayLike | None = None,
        *,
        task: str = "position",
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Joint motion that the scheme asks for in one state.

        Parameters
        ----------
        arm : Arm
            The arm.
        q, qd : array_like, shape (n,)
            Joint state [rad], [rad/s].
        x : array_like, shape (2,), (3,) or (4, 4)
            Where the tip is to be in the base frame [m]; a pose is (x, y, angle) in the plane, a homogeneous matrix in space.
        xd, xdd : array_like, shape (m,)
            Its velocity and acceleration, linear rows first, then angular [m/s, rad/s]; xdd may be left out at velocity level.
        task : str
            'position' or 'pose'.

        Returns
        -------
        numpy.ndarray, shape (n,)
            qd [rad/s] at velocity level, qdd [rad/s^2] at acceleration level.

        Raises
        ------
        ValueError
            Where an argument is not finite or of the wrong shape.
        ResolutionError
            Where the posture is singular or the result not finite.
        """
    @typing.overload
    def resolve(
        self,
        kinematics: Kinematics,
        q: numpy.typing.ArrayLike,
        qd: numpy.typing.ArrayLike,
        x: numpy.typing.ArrayLike,
        xd: numpy.typing.ArrayLike,
        xdd: numpy.typing.ArrayLike | None = None,
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        The same for an arm whose tip, J and Jd you have from elsewhere, as a Kinematics.
        """
    @property
    def level(self) -> str:
        """
        'velocity' where resolve returns qd, 'acceleration' where it returns qdd.
        """

class SecondTask:
    """
    A point for a second arm's tip, in the null space of the first task.

    The second arm is of the first joints of the first one: its tip an elbow, say. The first task comes strictly first.

    Parameters
    ----------
    arm : Arm
        The second arm: PlanarArm(lengths[:k]), or SerialArm.from_joints(joints[:k]).
    x : array_like, shape (2,) or (3,)
        Where its tip is to be, in the base frame [m].
    k1, k2 : float
        Feedback gains on velocity [1/s], which velocity-level schemes do without, and position [1/s^2], or [1/s] at
        velocity level; not negative.

    Raises
    ------
    ValueError
        Where an argument is out of range, not finite, or of the wrong shape.
    """
    def __init__(
        self,
        arm: Arm,
        x: numpy.typing.ArrayLike,
        *,
        k1: typing.SupportsFloat | typing.SupportsIndex = 10.0,
        k2: typing.SupportsFloat | typing.SupportsIndex = 25.0,
    ) -> None: ...
    def __reduce__(self) -> tuple[typing.Any, ...]: ...
    def __repr__(self) -> str: ...

class Gaze:
    """
    A direction for the tip's z axis, in the null space of the first task.

    Of an arm in space; the axis may still turn about itself. The first task comes strictly first.

    Parameters
    ----------
    direction : array_like, shape (3,)
        Where the axis is to point, in the base frame; its length does not matter.
    k1, k2 : float
        Feedback gains on velocity [1/s], which velocity-level schemes do without, and direction [1/s^2], or [1/s] at
        velocity level; not negative.

    Raises
    ------
    ValueError
        Where an argument is out of range, not finite, or of the wrong shape.
    """
    def __init__(
        self,
        direction: numpy.typing.ArrayLike,
        *,
        k1: typing.SupportsFloat | typing.SupportsIndex = 10.0,
        k2: typing.SupportsFloat | typing.SupportsIndex = 25.0,
    ) -> None: ...
    def __reduce__(self) -> tuple[typing.Any, ...]: ...
    def __repr__(self) -> str: ...

class MVN(Scheme):
    """
    Minimum velocity norm, (6): qd = J+ xd; with c the general solution (3).

    Parameters
    ----------
    k : float
        Position feedback gain [1/s]: xd + k (x - f(q)) in place of xd.
    rest_posture, null_stiffness : array_like, shape (n,), and float
        Posture [rad] that the null space is drawn to, and how strongly [1/s].
    c : array_like, shape (n,)
        The free choice in the general solution (3) [rad/s].
    joint_centring : float
        Gain [rad^2/s] down the gradient of 1/2 sum ((q_i - middle_i)/(upper_i - lower_i))^2 over the joints that the
        arm's limits bound both ways (Liegeois, 1977).
    manipulability_gain : float
        Gain [rad^2/s] up the gradient of sqrt(det(J J')) (Yoshikawa, 1985).
    second_task : SecondTask or Gaze
        What the null space does before all else: the rest of these options have what it leaves.
    singular_radius, singular_brake : float
        Damping where a singular value of J falls below singular_radius times the norm of J, in [0, 1]. A radius of 0 is
        none, and refuses singular postures; 0.02 is a good one. The brake damps the null space there [1/s].

    manipulability_gain and second_task run in code of run-time size, which is slower; they and joint_centring need an arm,
    and cannot be resolved from a Kinematics.

    Raises
    ------
    ValueError
        Where a parameter is out of range, not finite, or of the wrong shape.
    """
    def __init__(
        self,
        *,
        k: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        rest_posture: numpy.typing.ArrayLike | None = None,
        null_stiffness: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        c: numpy.typing.ArrayLike | None = None,
        joint_centring: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        manipulability_gain: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        second_task: SecondTask | Gaze | None = None,
        singular_radius: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        singular_brake: typing.SupportsFloat | typing.SupportsIndex = 10.0,
    ) -> None: ...

class WMVN(Scheme):
    """
    Weighted minimum velocity norm, (7): qd = J_W+ xd, of least qd' W qd.

    Parameters
    ----------
    weights : array_like, shape (n,) or (n, n)
        Diagonal of W, all positive, or W itself, symmetric positive definite. Only ratios matter.
    k : float
        Position feedback gain [1/s]: xd + k (x - f(q)) in place of xd.
    rest_posture, null_stiffness : array_like, shape (n,), and float
        Posture [rad] that the null space is drawn to, and how strongly [1/s].
    c : array_like, shape (n,)
        The free choice in the general solution (3) [rad/s].
    joint_centring : float
        Gain [rad^2/s] down the gradient of 1/2 sum ((q_i - middle_i)/(upper_i - lower_i))^2 over the joints that the
        arm's limits bound both ways (Liegeois, 1977).
    manipulability_gain : float
        Gain [rad^2/s] up the gradient of sqrt(det(J J')) (Yoshikawa, 1985).
    second_task : SecondTask or Gaze
        What the null space does before all else: the rest of these options have what it leaves.
    singular_radius, singular_brake : float
        Damping where a singular value of J falls below singular_radius times the norm of J, in [0, 1]. A radius of 0 is
        none, and refuses singular postures; 0.02 is a good one. The brake damps the null space there [1/s].

    manipulability_gain and second_task run in code of run-time size, which is slower; they and joint_centring need an arm,
    and cannot be resolved from a Kinematics.

    Raises
    ------
    ValueError
        Where a parameter is out of range, not finite, or of the wrong shape.
    """
    def __init__(
        self,
        weights: numpy.typing.ArrayLike,
        *,
        k: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        rest_posture: numpy.typing.ArrayLike | None = None,
        null_stiffness: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        c: numpy.typing.ArrayLike | None = None,
        joint_centring: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        manipulability_gain: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        second_task: SecondTask | Gaze | None = None,
        singular_radius: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        singular_brake: typing.SupportsFloat | typing.SupportsIndex = 10.0,
    ) -> None: ...

class MAN(Scheme):
    """
    Minimum acceleration norm, (8): qdd = J+ (xdd - Jd qd); with c the general solution (5).

    Parameters
    ----------
    null_damping : float
        Damping of the self-motion [1/s], which nothing in the paper's schemes damps.
    rest_posture, null_stiffness : array_like, shape (n,), and float
        Posture [rad] that the null space is drawn to, and how strongly [1/s^2].
    c : array_like, shape (n,)
        The free choice in the general solution (5) [rad/s^2].
    joint_centring : float
        Gain [rad^2/s^2] down the gradient of 1/2 sum ((q_i - middle_i)/(upper_i - lower_i))^2 over the joints that the
        arm's limits bound both ways (Liegeois, 1977).
    manipulability_gain : float
        Gain [rad^2/s^2] up the gradient of sqrt(det(J J')) (Yoshikawa, 1985). Wants
        null_damping, without which it swings for ever.
    second_task : SecondTask or Gaze
        What the null space does before all else: the rest of these options have what it leaves.
    singular_radius, singular_brake : float
        Damping where a singular value of J falls below singular_radius times the norm of J, in [0, 1]. A radius of 0 is
        none, and refuses singular postures; 0.02 is a good one. The brake damps the null space there [1/s].

    manipulability_gain and second_task run in code of run-time size, which is slower; they and joint_centring need an arm,
    and cannot be resolved from a Kinematics.

    Raises
    ------
    ValueError
        Where a parameter is out of range, not finite, or of the wrong shape.
    """
    def __init__(
        self,
        *,
        null_damping: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        rest_posture: numpy.typing.ArrayLike | None = None,
        null_stiffness: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        c: numpy.typing.ArrayLike | None = None,
        joint_centring: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        manipulability_gain: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        second_task: SecondTask | Gaze | None = None,
        singular_radius: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        singular_brake: typing.SupportsFloat | typing.SupportsIndex = 10.0,
    ) -> None: ...

class WMVNAcceleration(Scheme):
    """
    Weighted minimum velocity norm at acceleration level, (9), which is (7) differentiated.

    qdd = J_W+ (xdd - Jd qd) + N_W W^-1 Jd' (J W^-1 J')^-1 xd.

    Parameters
    ----------
    weights : array_like, shape (n,) or (n, n)
        Diagonal of W, all positive, or W itself, symmetric positive definite. Only ratios matter.
    null_damping : float
        Damping of the self-motion [1/s], which nothing in the paper's schemes damps.
    rest_posture, null_stiffness : array_like, shape (n,), and float
        Posture [rad] that the null space is drawn to, and how strongly [1/s^2].
    c : array_like, shape (n,)
        The free choice in the general solution (5) [rad/s^2].
    joint_centring : float
        Gain [rad^2/s^2] down the gradient of 1/2 sum ((q_i - middle_i)/(upper_i - lower_i))^2 over the joints that the
        arm's limits bound both ways (Liegeois, 1977).
    manipulability_gain : float
        Gain [rad^2/s^2] up the gradient of sqrt(det(J J')) (Yoshikawa, 1985). Wants
        null_damping, without which it swings for ever.
    second_task : SecondTask or Gaze
        What the null space does before all else: the rest of these options have what it leaves.
    singular_radius, singular_brake : float
        Damping where a singular value of J falls below singular_radius times the norm of J, in [0, 1]. A radius of 0 is
        none, and refuses singular postures; 0.02 is a good one. The brake damps the null space there [1/s].

    manipulability_gain and second_task run in code of run-time size, which is slower; they and joint_centring need an arm,
    and cannot be resolved from a Kinematics.

    Raises
    ------
    ValueError
        Where a parameter is out of range, not finite, or of the wrong shape.
    """
    def __init__(
        self,
        weights: numpy.typing.ArrayLike,
        *,
        null_damping: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        rest_posture: numpy.typing.ArrayLike | None = None,
        null_stiffness: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        c: numpy.typing.ArrayLike | None = None,
        joint_centring: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        manipulability_gain: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        second_task: SecondTask | Gaze | None = None,
        singular_radius: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        singular_brake: typing.SupportsFloat | typing.SupportsIndex = 10.0,
    ) -> None: ...

class Balanced(Scheme):
    """
    Balance of MAN and WMVN without feedback, (16): (1 - alpha) MAN (8) + alpha WMVN (9).

    Parameters
    ----------
    alpha : float
        Share of WMVN, in [0, 1]; MAN has the rest.
    weights : array_like, shape (n,) or (n, n)
        Diagonal of W, all positive, or W itself, symmetric positive definite. Only ratios matter.
    null_damping : float
        Damping of the self-motion [1/s], which nothing in the paper's schemes damps.
    rest_posture, null_stiffness : array_like, shape (n,), and float
        Posture [rad] that the null space is drawn to, and how strongly [1/s^2].
    c : array_like, shape (n,)
        The free choice in the general solution (5) [rad/s^2].
    joint_centring : float
        Gain [rad^2/s^2] down the gradient of 1/2 sum ((q_i - middle_i)/(upper_i - lower_i))^2 over the joints that the
        arm's limits bound both ways (Liegeois, 1977).
    manipulability_gain : float
        Gain [rad^2/s^2] up the gradient of sqrt(det(J J')) (Yoshikawa, 1985). Wants
        null_damping, without which it swings for ever.
    second_task : SecondTask or Gaze
        What the null space does before all else: the rest of these options have what it leaves.
    singular_radius, singular_brake : float
        Damping where a singular value of J falls below singular_radius times the norm of J, in [0, 1]. A radius of 0 is
        none, and refuses singular postures; 0.02 is a good one. The brake damps the null space there [1/s].

    manipulability_gain and second_task run in code of run-time size, which is slower; they and joint_centring need an arm,
    and cannot be resolved from a Kinematics.

    Raises
    ------
    ValueError
        Where a parameter is out of range, not finite, or of the wrong shape.
    """
    def __init__(
        self,
        alpha: typing.SupportsFloat | typing.SupportsIndex,
        weights: numpy.typing.ArrayLike,
        *,
        null_damping: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        rest_posture: numpy.typing.ArrayLike | None = None,
        null_stiffness: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        c: numpy.typing.ArrayLike | None = None,
        joint_centring: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        manipulability_gain: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        second_task: SecondTask | Gaze | None = None,
        singular_radius: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        singular_brake: typing.SupportsFloat | typing.SupportsIndex = 10.0,
    ) -> None: ...

class FPBM(Scheme):
    """
    Feedback-added pseudoinverse-type balanced minimisation, (13).

    The balance (16) with b = xdd - Jd qd + k1 (xd - J qd) + k2 (x - f(q)) in place of xdd - Jd qd, so
    that the tip error e obeys e'' + k1 e' + k2 e = 0 whatever alpha and W.

    Parameters
    ----------
    alpha : float
        Share of WMVN, in [0, 1]; MAN has the rest.
    weights : array_like, shape (n,) or (n, n)
        Diagonal of W, all positive, or W itself, symmetric positive definite. Only ratios matter.
    k1, k2 : float
        Feedback gains on velocity [1/s] and position [1/s^2], not negative.
    null_damping : float
        Damping of the self-motion [1/s], which nothing in the paper's schemes damps.
    rest_posture, null_stiffness : array_like, shape (n,), and float
        Posture [rad] that the null space is drawn to, and how strongly [1/s^2].
    c : array_like, shape (n,)
        The free choice in the general solution (5) [rad/s^2].
    joint_centring : float
        Gain [rad^2/s^2] down the gradient of 1/2 sum ((q_i - middle_i)/(upper_i - lower_i))^2 over the joints that the
        arm's limits bound both ways (Liegeois, 1977).
    manipulability_gain : float
        Gain [rad^2/s^2] up the gradient of sqrt(det(J J')) (Yoshikawa, 1985). Wants
        null_damping, without which it swings for ever.
    second_task : SecondTask or Gaze
        What the null space does before all else: the rest of these options have what it leaves.
    singular_radius, singular_brake : float
        Damping where a singular value of J falls below singular_radius times the norm of J, in [0, 1]. A radius of 0 is
        none, and refuses singular postures; 0.02 is a good one. The brake damps the null space there [1/s].

    manipulability_gain and second_task run in code of run-time size, which is slower; they and joint_centring need an arm,
    and cannot be resolved from a Kinematics.

    Raises
    ------
    ValueError
        Where a parameter is out of range, not finite, or of the wrong shape.
    """
    def __init__(
        self,
        alpha: typing.SupportsFloat | typing.SupportsIndex,
        weights: numpy.typing.ArrayLike,
        k1: typing.SupportsFloat | typing.SupportsIndex,
        k2: typing.SupportsFloat | typing.SupportsIndex,
        *,
        null_damping: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        rest_posture: numpy.typing.ArrayLike | None = None,
        null_stiffness: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        c: numpy.typing.ArrayLike | None = None,
        joint_centring: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        manipulability_gain: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        second_task: SecondTask | Gaze | None = None,
        singular_radius: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        singular_brake: typing.SupportsFloat | typing.SupportsIndex = 10.0,
    ) -> None: ...

class Stop:
    """
    A word to all motions of a sweep in this process: set() ends them within a sample.
    """
    def __init__(self) -> None: ...
    def set(self) -> None:
        """
        From any thread.
        """

class Tick:
    """
    What one tick of a control loop did.
    """
    @property
    def error(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        x - f(q) at the tick's start [m, rad], shape (m,).
        """
    @property
    def q(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Command for the tick's end [rad], or [m] for a prismatic joint, shape (n,).
        """
    @property
    def qd(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Its velocity [rad/s], shape (n,).
        """
    @property
    def qdd(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Mean acceleration over the tick [rad/s^2], shape (n,).
        """
    @property
    def saturated(self) -> numpy.typing.NDArray[numpy.bool]:
        """
        Which joints are on a bound, shape (n,).
        """
    @property
    def scale(self) -> float:
        """
        How much of the task the limits left, from 0 to 1.
        """
    @property
    def sigma(self) -> float:
        """
        Lower bound on the least singular value of J at the tick's start, sqrt(m) times too low at most.
        """
    @property
    def status(self) -> Status:
        """
        What became of it; where it failed, why the arm brakes.
        """

class PathFollower:
    """
    A path laid out from a tip, with a clock that can pause and resume; made by Tracker.course.
    """
    def pause(self) -> None:
        """
        Comes to rest on the path, within the course's ramp.
        """
    def resume(self) -> None:
        """
        Goes on along the path.
        """
    @property
    def done(self) -> bool:
        """
        Whether path time has come to the path's end.
        """
    @property
    def time(self) -> float:
        """
        Path time [s].
        """

class Tracker:
    """
    Moves an arm tick by tick under a scheme, within its joints' limits, through singular postures, to rest.

    tick integrates the tracker's own state by RK4: the command of an arm that is led by positions or velocities.
    resolve_measured answers for a state measured just now, with the acceleration that a torque controller is to realise.
    Never feed a measured state to tick. A scheme of velocity level is kept within the same limits.

    Parameters
    ----------
    arm, scheme
        What moves, and how.
    q0 : array_like, shape (n,)
        Joint positions at the start [rad], within the limits.
    qd0 : array_like, shape (n,), optional
        Joint velocities at the start [rad/s], zero unless given.
    task : str
        'position' or 'pose'.
    dt : float
        Length of a tick [s].
    limits : JointLimits, optional
        The arm's own unless given. A joint with bounds needs one on its acceleration, except at velocity level.
    pull : float
        How far away the target may seem at most [m, rad]: a farther one pulls no harder.
    integral_gain, integral_bound : float
        Gain of the integral of the error, [1/s^3] or [1/s^2] at velocity level, off by default, and the most that it adds
        [m/s^2] or [m/s]. Stable below k1 k2.
    singular_radius, singular_brake : float
        Damping near singular postures, where the scheme has none; 0 switches it off.

    Raises
    ------
    ValueError
        Where an argument is out of range, a limit is missing, or the start breaks one.
    """
    def __init__(
        self,
        arm: Arm,
        scheme: Scheme,
        q0: numpy.typing.ArrayLike,
        *,
        qd0: numpy.typing.ArrayLike | None = None,
        task: str = "position",
        dt: typing.SupportsFloat | typing.SupportsIndex = 0.001,
        limits: JointLimits | None = None,
        pull: typing.SupportsFloat | typing.SupportsIndex = 0.1,
        integral_gain: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        integral_bound: typing.SupportsFloat | typing.SupportsIndex = 1.0,
        singular_radius: typing.SupportsFloat | typing.SupportsIndex = 0.02,
        singular_brake: typing.SupportsFloat | typing.SupportsIndex = 10.0,
    ) -> None: ...
    def course(self, path: Path, *, ramp: typing.SupportsFloat | typing.SupportsIndex = 0.5) -> PathFollower:
        """
        A path laid out from where the tip is now; ramp is how long a pause or a resumption takes [s].
        """
    def resume(self) -> None:
        """
        Follows references again.
        """
    def resolve_measured(
        self,
        q: numpy.typing.ArrayLike,
        qd: numpy.typing.ArrayLike,
        x: numpy.typing.ArrayLike,
        xd: numpy.typing.ArrayLike | None = None,
        xdd: numpy.typing.ArrayLike | None = None,
    ) -> Tick:
        """
        The tick for a state measured now: its qdd [rad/s^2] is what a torque controller is to realise.
        """
    def stop(self) -> None:
        """
        Brings every joint to rest as fast as the limits allow, until resume.
        """
    @typing.overload
    def tick(self, course: PathFollower) -> Tick:
        """
        One tick along a course, whose clock goes on with it.
        """
    @typing.overload
    def tick(
        self,
        x: numpy.typing.ArrayLike,
        xd: numpy.typing.ArrayLike | None = None,
        xdd: numpy.typing.ArrayLike | None = None,
    ) -> Tick:
        """
        One tick toward a reference, at rest unless its velocity and acceleration are given.

        x has shape (2,), (3,) or (4, 4) [m], xd and xdd (m,) [m/s, rad/s], linear rows first, in the base frame. Never fails:
        where no motion can be found the arm brakes, and the tick's status says why.
        """
    @property
    def q(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Joint positions of its own state [rad].
        """
    @property
    def qd(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Joint velocities of its own state [rad/s].
        """
    @property
    def tip(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Where the tip of its own state is, in the base frame [m].
        """

def advice(status: Status) -> str:
    """
    One sentence: what to do about it; empty for OK.
    """

def check_sweep(
    arm: Arm,
    path: Path,
    schemes: collections.abc.Sequence[Scheme],
    q0s: numpy.typing.ArrayLike,
    dt: typing.SupportsFloat | typing.SupportsIndex,
    hold: typing.SupportsFloat | typing.SupportsIndex,
    task: str,
) -> tuple[numpy.typing.NDArray[numpy.float64], int]: ...
def dh(
    table: numpy.typing.ArrayLike, convention: str, types: collections.abc.Sequence[str]
) -> tuple[list[dict[str, typing.Any]], numpy.typing.NDArray[numpy.float64]]: ...
def failed(status: Status) -> bool:
    """
    Whether there is no result.
    """

def message(status: Status) -> str:
    """
    One sentence: what happened.
    """

def not_run(count: typing.SupportsInt | typing.SupportsIndex) -> numpy.ndarray: ...
def preset(name: str) -> tuple[list[dict[str, typing.Any]], numpy.typing.NDArray[numpy.float64]]: ...
def processor_kinds() -> list[str]: ...
def rotation(r: numpy.typing.ArrayLike) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 3]"]:
    """
    Rotation matrix, shape (3, 3), of a rotation vector r [rad]: by |r| about r/|r|.
    """

def rotation_vector(R: numpy.typing.ArrayLike) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
    """
    Rotation vector of a rotation matrix, shape (3,), of length at most pi [rad].
    """

def simulate(
    arm: Arm,
    path: Path,
    scheme: Scheme,
    q0: numpy.typing.ArrayLike,
    qd0: numpy.typing.ArrayLike,
    dt: typing.SupportsFloat | typing.SupportsIndex,
    hold: typing.SupportsFloat | typing.SupportsIndex,
    task: str,
) -> tuple[
    Status,
    float,
    int,
    tuple[
        numpy.typing.NDArray[numpy.float64],
        numpy.typing.NDArray[numpy.float64],
        numpy.typing.NDArray[numpy.float64],
        numpy.typing.NDArray[numpy.float64],
        numpy.typing.NDArray[numpy.float64],
        numpy.typing.NDArray[numpy.float64],
        numpy.typing.NDArray[numpy.float64],
    ],
]: ...
def sweep_chunk(
    arm: Arm,
    path: Path,
    schemes: collections.abc.Sequence[Scheme],
    which: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
    q0s: numpy.typing.ArrayLike,
    dt: typing.SupportsFloat | typing.SupportsIndex,
    hold: typing.SupportsFloat | typing.SupportsIndex,
    task: str,
    motions: bool,
    stop: Stop,
) -> tuple[
    numpy.ndarray,
    list[
        tuple[
            numpy.typing.NDArray[numpy.float64],
            numpy.typing.NDArray[numpy.float64],
            numpy.typing.NDArray[numpy.float64],
            numpy.typing.NDArray[numpy.float64],
            numpy.typing.NDArray[numpy.float64],
            numpy.typing.NDArray[numpy.float64],
            numpy.typing.NDArray[numpy.float64],
        ]
    ],
]: ...
def use_lanes(code: typing.Any) -> int: ...

MAX_DOF: int = 32
__version__: str = "0.1.0"
