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
    "Clearance",
    "InverseKinematics",
    "JointStream",
    "Kinematics",
    "Limiter",
    "MAX_DOF",
    "Model",
    "Nearest",
    "PRESETS",
    "Path",
    "PathFollower",
    "PoseStream",
    "Posture",
    "Postures",
    "ROBOT_PRESETS",
    "Robot",
    "SaturatedLevels",
    "SaturatedMotion",
    "Scheme",
    "Shape",
    "Status",
    "Stop",
    "Stream",
    "TIME_LAWS",
    "TargetFilter",
    "Task",
    "Tick",
    "Tracker",
    "advice",
    "at_speed",
    "check_sweep",
    "circle",
    "dh",
    "failed",
    "fastest",
    "in_plane",
    "line",
    "link_frames",
    "lissajous",
    "message",
    "named_frames",
    "not_run",
    "polyline",
    "preset",
    "preset_capsules",
    "processor_kinds",
    "robot_preset",
    "rollout",
    "rotation",
    "rotation_vector",
    "saturate",
    "sequence",
    "sweep_chunk",
    "tricuspid",
    "untimed",
    "use_lanes",
    "waypoints",
    "with_rotation",
]

class Model:
    """
    The compiled part of a robot or an arm: its joints and frames.
    """
    def bias(self, q: numpy.typing.ArrayLike, qd: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torques for a motion without acceleration: h(q, qd) = C(q, qd) qd + g(q) + damping qd, shape (n,) [Nm].

        h = inverse_dynamics(q, qd, 0): Coriolis and centrifugal torques, gravity and viscous friction. q, qd: shape (n,)
        [rad], [rad/s], or (K, n) for a result of shape (K, n).

        Raises ParameterError as inverse_dynamics() does.
        """
    def bounds(self) -> dict[str, numpy.typing.NDArray[numpy.float64]]:
        """
        Bounds of the joints by name, as in JointLimits, shape (n,) each; infinite if there is no bound.
        """
    def gravity(self, q: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torques that hold the robot at rest: g(q) = inverse_dynamics(q, 0, 0), shape (n,) [Nm].

        g is the gradient of potential_energy(). q: shape (n,) [rad], or (K, n) for a result of shape (K, n).

        Raises ParameterError as inverse_dynamics() does.
        """
    def inverse(
        self,
        target: typing.Any,
        start: numpy.typing.ArrayLike | None = None,
        *,
        task: str = "pose",
        stack: typing.Any = None,
        limits: typing.Any = None,
        bounds: typing.Any = (),
        tolerance: typing.SupportsFloat | typing.SupportsIndex = 1e-06,
        starts: typing.SupportsInt | typing.SupportsIndex = 64,
        seed: typing.SupportsInt | typing.SupportsIndex = 0,
    ) -> Posture | Postures:
        """
        A posture for a target: InverseKinematics(arm, ...).solve(target, start).
        """
    def inverse_all(
        self,
        target: typing.Any,
        start: numpy.typing.ArrayLike | None = None,
        count: typing.SupportsInt | typing.SupportsIndex = 16,
        *,
        rank: str = "distance",
        task: str = "pose",
        stack: typing.Any = None,
        limits: typing.Any = None,
        bounds: typing.Any = (),
        tolerance: typing.SupportsFloat | typing.SupportsIndex = 1e-06,
        starts: typing.SupportsInt | typing.SupportsIndex = 256,
        seed: typing.SupportsInt | typing.SupportsIndex = 0,
    ) -> list[Posture]:
        """
        Distinct postures for a target, sorted by rank: InverseKinematics(arm, ...).solve_all(target, start, count, rank=rank).
        """
    def inverse_dynamics(
        self, q: numpy.typing.ArrayLike, qd: numpy.typing.ArrayLike, qdd: numpy.typing.ArrayLike
    ) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torques of the drives for a motion: M(q) qdd + h(q, qd), shape (n,) [Nm], [N] for prismatic joints.

        By the recursive Newton-Euler algorithm (Featherstone, Rigid Body Dynamics Algorithms, 2008, table 5.1), with the
        inertia of the rotors and viscous friction, without dry friction. q, qd, qdd: shape (n,) [rad], [rad/s], [rad/s^2], or
        K rows, shape (K, n), for a result of shape (K, n).

        Raises ParameterError if a drive moves no mass, an inertia is not physical, or an argument has a wrong shape.
        """
    def kinetic_energy(
        self, q: numpy.typing.ArrayLike, qd: numpy.typing.ArrayLike
    ) -> float | numpy.typing.NDArray[numpy.float64]:
        """
        Kinetic energy 1/2 qd^T M(q) qd [J], rotors included.

        q, qd: shape (n,) [rad], [rad/s], or (K, n) for a result of shape (K,).

        Raises ParameterError as inverse_dynamics() does.
        """
    def locate(self, frame: str) -> tuple[int, numpy.typing.NDArray[numpy.float64]]:
        """
        Number of the link of a frame, and the frame in the frame of the link, shape (4, 4).
        """
    def mass_matrix(self, q: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        Joint-space inertia matrix M(q), shape (n, n) [kg m^2], symmetric and positive definite.

        By the composite-rigid-body algorithm (Featherstone 2008, table 6.2). M is the derivative of inverse_dynamics() with
        respect to qdd, and includes the inertia of the rotors. q: shape (n,) [rad], or (K, n) for a result of shape (K, n, n).

        Raises ParameterError as inverse_dynamics() does.
        """
    def potential_energy(self, q: numpy.typing.ArrayLike) -> float | numpy.typing.NDArray[numpy.float64]:
        """
        Potential energy of the links in the field of gravity [J], zero for links at the origin of the base frame.

        The base does not count. q: shape (n,) [rad], or (K, n) for a result of shape (K,).

        Raises ParameterError as inverse_dynamics() does.
        """
    @property
    def dof(self) -> int:
        """
        Number of joints n that have a drive.
        """
    @property
    def has_dynamics(self) -> bool:
        """
        Whether every drive moves a mass and all inertias are physical, so that torques are known.
        """
    @property
    def joint_names(self) -> list[str]:
        """
        Names of the joints that have a drive, from the base on.
        """

class Robot(Model):
    """
    The compiled part of a robot.
    """
    def __init__(
        self,
        joints: list[typing.Any],
        frames: list[typing.Any],
        base_mass: typing.SupportsFloat | typing.SupportsIndex,
        base_center: numpy.typing.ArrayLike,
        gravity: numpy.typing.ArrayLike,
    ) -> None: ...
    def center_of_mass(self, q: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        Centre of mass in the base frame, shape (3,) [m], including the base. q: (n,) [rad].

        Raises ParameterError if the robot has no mass.
        """
    def forward(self, q: numpy.typing.ArrayLike, frame: str) -> numpy.typing.NDArray[numpy.float64]:
        """
        Pose of a frame in the base frame [m], a homogeneous matrix, shape (4, 4). q: (n,) [rad].
        """
    def jacobian(
        self, q: numpy.typing.ArrayLike, frame: str, *, task: str = "pose"
    ) -> numpy.typing.NDArray[numpy.float64]:
        """
        Jacobian of a frame, shape (m, n): the frame moves at J qd, linear rows first, then angular, in the base
        frame's axes. task: 'position', 'orientation' or 'pose'. q: (n,) [rad].
        """
    def jacobian_dot(
        self, q: numpy.typing.ArrayLike, qd: numpy.typing.ArrayLike, frame: str, *, task: str = "pose"
    ) -> numpy.typing.NDArray[numpy.float64]:
        """
        dJ/dt along qd, shape (m, n): the frame's acceleration is J qdd + Jd qd. q, qd: (n,) [rad], [rad/s].
        """

class Kinematics:
    """
    Tip, J and Jd of an arm in one state: the input of a scheme.

    From kinematics() of an arm, or from another library (Pinocchio, Drake, MuJoCo, ...).

    Parameters
    ----------
    tip : array_like, shape (2,), (3,) or (4, 4)
        f(q) in the base frame [m]: a position, (x, y, angle) of a pose in the plane, or a homogeneous matrix.
    J : array_like, shape (m, n)
        Task Jacobian, linear rows first, then angular, along the base frame's axes (Pinocchio's LOCAL_WORLD_ALIGNED).
    Jd : array_like, shape (m, n), optional
        dJ/dt along qd; not needed by velocity-level schemes.
    task : str
        Meaning of three numbers in tip: a 'position' in space, or a 'pose' in the plane.

    Raises
    ------
    ParameterError
        If a number is not finite, or shapes do not match.
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
    def J(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Task Jacobian, shape (m, n).
        """
    @property
    def Jd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        dJ/dt along qd, shape (m, n).
        """
    @property
    def tip(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        f(q) in the base frame [m], shape (2,), (3,) or (4, 4).
        """

class Arm(Model):
    """
    The compiled part of an arm: planar, from link lengths, or in space, from joints.
    """
    def __init__(
        self,
        joints: list[typing.Any],
        tip: numpy.typing.ArrayLike,
        gravity: numpy.typing.ArrayLike,
        lengths: numpy.typing.ArrayLike | None = None,
    ) -> None: ...
    def forward(self, q: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        Tip f(q) in the base frame [m]: for a planar arm, a position, shape (2,); for an arm in space, a
        homogeneous matrix, shape (4, 4). q: shape (n,) [rad].
        """
    def jacobian(self, q: numpy.typing.ArrayLike, *, task: str = "position") -> numpy.typing.NDArray[numpy.float64]:
        """
        Task Jacobian J(q), shape (m, n): the tip's velocity is J qd, linear rows first, then angular. q: (n,) [rad].
        """
    def jacobian_dot(
        self, q: numpy.typing.ArrayLike, qd: numpy.typing.ArrayLike, *, task: str = "position"
    ) -> numpy.typing.NDArray[numpy.float64]:
        """
        dJ/dt along qd, shape (m, n): the tip's acceleration is J qdd + Jd qd. q, qd: (n,) [rad], [rad/s].
        """
    def kinematics(
        self, q: numpy.typing.ArrayLike, qd: numpy.typing.ArrayLike, *, task: str = "position"
    ) -> Kinematics:
        """
        Tip, J and Jd of a task, 'position' or 'pose', at q, qd, shape (n,) [rad], [rad/s].
        """

class Path:
    """
    The compiled part of a path.
    """
    def __init__(self, path: Path) -> None: ...
    def _duration(self) -> float | None: ...
    def _require_duration(self) -> None: ...
    def sample(
        self, t: typing.SupportsFloat | typing.SupportsIndex
    ) -> tuple[
        numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]
    ]:
        """
        (x, xd, xdd) at t [s], as a displacement from the start of the tip [m, m/s, m/s^2].

        x has shape (2,) or (3,); if the path rotates the tip, shape (4, 4) in space, (x, y, angle) in the plane. xd and xdd
        have shape (m,), linear rows first, then angular. Outside 0 <= t <= T, the reference is at rest at the path's ends.
        """

class Status(enum.Enum):
    """
    Result of an evaluation or a rollout.
    """

    BLOCKED = ...
    COARSE = ...
    DAMPED = ...
    NOT_FINITE = ...
    NOT_FOUND = ...
    OK = ...
    RECOVERING = ...
    SINGULAR = ...
    SLOWED = ...
    STALLED = ...
    TASK_LOST = ...

class Scheme:
    """
    The compiled part of a scheme: the law of a level with its parameters.
    """
    def __init__(self, level: str, parameters: dict[str, typing.Any]) -> None: ...
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
        out: numpy.typing.NDArray[numpy.float64] | None = None,
    ) -> numpy.typing.NDArray[numpy.float64]:
        """
        Joint motion of the scheme in a state, or in each of k states.

        Parameters
        ----------
        arm : Arm
            The arm.
        q, qd : array_like, shape (n,) or (k, n)
            Joint state [rad], [rad/s]. If q has k rows, each other argument has k entries along a leading axis, or one entry
            for all states.
        x : array_like, shape (2,), (3,) or (4, 4)
            Reference of the tip in the base frame [m]; a pose is (x, y, angle) in the plane, a homogeneous matrix in space.
        xd, xdd : array_like, shape (m,)
            Velocity and acceleration of the reference, linear rows first, then angular [m/s, rad/s]; xdd is optional at
            velocity level.
        task : str
            'position' or 'pose'.
        out : numpy.ndarray, shape (n,) or (k, n), optional
            Array of float64, C-contiguous, for the result.

        Returns
        -------
        numpy.ndarray, shape (n,) or (k, n)
            qd [rad/s] at velocity level, qdd [rad/s^2] at acceleration level: out, or a new array.

        Raises
        ------
        ParameterError
            If an argument is not finite or has a wrong shape.
        ResolutionError
            If the posture is singular or the result is not finite.
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
        *,
        out: numpy.typing.NDArray[numpy.float64] | None = None,
    ) -> numpy.typing.NDArray[numpy.float64]:
        """
        Joint motion of the scheme for tip, J and Jd from another library, as a Kinematics.
        """

class Shape:
    """
    The compiled part of a shape.
    """
    @typing.overload
    def __init__(
        self,
        *,
        a: numpy.typing.ArrayLike,
        b: numpy.typing.ArrayLike,
        radius: typing.SupportsFloat | typing.SupportsIndex,
        link: typing.SupportsInt | typing.SupportsIndex,
    ) -> None: ...
    @typing.overload
    def __init__(
        self, *, normal: numpy.typing.ArrayLike, offset: typing.SupportsFloat | typing.SupportsIndex
    ) -> None: ...
    @typing.overload
    def __init__(self, *, pose: numpy.typing.ArrayLike, half: numpy.typing.ArrayLike) -> None: ...

class Nearest:
    """
    The nearest checked pair of shapes.
    """
    def __repr__(self) -> str: ...
    @property
    def distance(self) -> float:
        """
        Distance [m]; if negative, the penetration depth.
        """
    @property
    def pair(self) -> tuple[str, str]:
        """
        Names: of a capsule of the arm, and of the other shape.
        """
    @property
    def points(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Nearest points on the surfaces of both shapes in the base frame, shape (2, 3) [m].
        """

class Clearance:
    """
    The compiled part of a clearance, for one robot.
    """
    def __init__(self, arm: Model, clearance: typing.Any) -> None: ...
    def excluded_pairs(self) -> list[tuple[str, str]]: ...
    def nearest(self, q: numpy.typing.ArrayLike) -> Nearest | None: ...
    def pairs(self) -> list[tuple[str, str]]: ...

class Stop:
    """
    Stops all motions of a sweep in this process within a sample.
    """
    def __init__(self) -> None: ...
    def set(self) -> None:
        """
        Callable from any thread.
        """

class SaturatedMotion:
    """
    A motion of one tick within limits.
    """
    @property
    def saturated(self) -> numpy.typing.NDArray[numpy.bool]:
        """
        Which joints are on a bound, shape (n,).
        """
    @property
    def scale(self) -> float:
        """
        Task scale, from 0 to 1.
        """
    @property
    def u(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Accelerations [rad/s^2], or velocities [rad/s] at velocity level, shape (n,).
        """

class Limiter:
    """
    Keeps joint limits in your own control loop, for any Jacobian.

    A motion is unchanged if it keeps every bound over the next tick, and the joints can then stop within the bounds.
    Otherwise, other joints replace joints on their bounds in the null space of J. If null-space motion is not sufficient,
    the task is scaled without a change of direction.

    Parameters
    ----------
    limits : JointLimits
        Bounds of the joints, none missing: limits.of(arm) completes limits. A bounded joint needs a bound on acceleration,
        except at velocity level.
    dt : float
        Length of a tick [s].
    level : str
        Level of the limited motion: 'acceleration' or 'velocity'.

    Raises
    ------
    ParameterError
        If an argument is out of range or a bound is missing.
    """
    def __init__(
        self, limits: typing.Any, dt: typing.SupportsFloat | typing.SupportsIndex, *, level: str = "acceleration"
    ) -> None: ...
    def brake(
        self, q: numpy.typing.ArrayLike, qd: numpy.typing.ArrayLike, *, last: numpy.typing.ArrayLike | None = None
    ) -> SaturatedMotion:
        """
        The motion that brings every joint to rest; arguments and result as for motion.
        """
    def motion(
        self,
        J: numpy.typing.ArrayLike,
        q: numpy.typing.ArrayLike,
        qd: numpy.typing.ArrayLike,
        desired: numpy.typing.ArrayLike,
        *,
        last: numpy.typing.ArrayLike | None = None,
        rows: tuple[numpy.typing.ArrayLike, numpy.typing.ArrayLike] | None = None,
    ) -> SaturatedMotion:
        """
        Motion u of the next tick for a desired motion: J u = J r + s J (desired - r), with a braking motion r and
        the largest s <= 1 within the limits. If s is near zero, u is a motion that still moves the tip toward the target.

        J has shape (m, n); q, qd and desired (n,) [rad, rad/s, and rad/s^2 or rad/s]. At velocity level, qd is the last
        command. last is the acceleration of the previous tick [rad/s^2], for bounds on jerk; default: zero. rows is a pair
        (G, b), shapes (p, n) and (p,), of at most 16 further bounds G u <= b, kept as far as the limits admit. Raises
        ParameterError if a shape is wrong, or a number is not finite.
        """

class SaturatedLevels:
    """
    Motion of several task levels in strict priority within bounds.
    """
    @property
    def saturated(self) -> numpy.typing.NDArray[numpy.bool]:
        """
        Which joints are on a bound, shape (n,).
        """
    @property
    def scale(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Task scale of each level, from 0 to 1, shape (levels,).
        """
    @property
    def u(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        The motion within the bounds, shape (n,).
        """

class TargetFilter:
    """
    Computes a smooth reference from targets that arrive at any rate, late, twice or never.

    Along each axis of the base frame, the reference moves to the target in minimum time within the bounds, relative to the
    moving target: without overshoot for a target at rest, without lag for a target with constant velocity. The velocity of
    the target is estimated from the received points. If no message arrives within the timeout, the target stops. From rest,
    an orientation rotates about a constant axis, and its largest angle changes in minimum time.

    Parameters
    ----------
    x0 : array_like, shape (2,), (3,) or (4, 4)
        Start of the reference, at rest, in the base frame [m, rad].
    velocity, acceleration, jerk : float
        Bounds of each axis of the base frame, [m/s], [m/s^2] and [m/s^3].
    angular_velocity, angular_acceleration, angular_jerk : float
        Bounds of the angle about each axis [rad/s], [rad/s^2] and [rad/s^3]; required for poses.
    task : str
        'position' or 'pose'. With 'pose', shape (3,) is a pose in the plane.
    dt : float
        Length of a tick [s].
    timeout : float
        Time without a message after which a target stops and a twist ends [s].
    start : float, optional
        Time of the first tick on the clock of the stamps [s]. Default: estimated from the stamps; the least delayed stamp
        counts as not delayed.

    Raises
    ------
    ParameterError
        If an argument is out of range.
    """
    def __init__(
        self,
        x0: numpy.typing.ArrayLike,
        *,
        velocity: typing.SupportsFloat | typing.SupportsIndex,
        acceleration: typing.SupportsFloat | typing.SupportsIndex,
        jerk: typing.SupportsFloat | typing.SupportsIndex,
        angular_velocity: typing.SupportsFloat | typing.SupportsIndex | None = None,
        angular_acceleration: typing.SupportsFloat | typing.SupportsIndex | None = None,
        angular_jerk: typing.SupportsFloat | typing.SupportsIndex | None = None,
        task: str = "position",
        dt: typing.SupportsFloat | typing.SupportsIndex = 0.001,
        timeout: typing.SupportsFloat | typing.SupportsIndex = 0.2,
        start: typing.SupportsFloat | typing.SupportsIndex | None = None,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def advance(self) -> None:
        """
        Advances by one tick; Tracker.tick calls advance.
        """
    def push(self, x: numpy.typing.ArrayLike, stamp: typing.SupportsFloat | typing.SupportsIndex | None = None) -> bool:
        """
        Adds a target with its stamp [s] on any clock; default: now.

        Returns False for a rejected message, which has no effect: x or the stamp is not finite, R deviates from a rotation by
        more than 1e-4, or the stamp is not newer than all previous stamps or is from the future. An accepted R becomes the
        nearest rotation. Raises ParameterError if x has another shape than x0.
        """
    def push_twist(
        self, v: numpy.typing.ArrayLike, stamp: typing.SupportsFloat | typing.SupportsIndex | None = None
    ) -> bool:
        """
        Sets a desired velocity [m/s, rad/s] until the timeout, within the bounds.

        v has shape (m,), linear rows first, along the base frame's axes. Returns whether v is accepted, as push.
        """
    def reset(self, x: numpy.typing.ArrayLike) -> None:
        """
        Restarts at rest at x, with the same speed; an estimated clock is discarded.
        """
    def set_speed(self, fraction: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        Reduces the bounds on velocity to a fraction in (0, 1] of the given bounds, until the next call.

        A faster reference decelerates within the bounds on acceleration and jerk. A faster target is followed with a lag.
        """
    @property
    def speed(self) -> float:
        """
        Fraction of the bounds on velocity that set_speed has set.
        """
    @property
    def x(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Reference at the start of the next tick, shape (2,), (3,) or (4, 4) [m, rad].
        """
    @property
    def xd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Velocity of the reference, shape (m,), linear rows first [m/s, rad/s].
        """
    @property
    def xdd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Acceleration of the reference, shape (m,) [m/s^2, rad/s^2].
        """

class Stream:
    """
    A stream of points: JointStream or PoseStream.
    """

class JointStream(Stream):
    """
    Computes a smooth reference of postures from chunks of a policy, trajectories or single postures.

    Chunks may be late, early, overlapping, duplicate, out of order, or missing. The reference keeps the range and the bounds
    on velocity, acceleration and jerk of each joint, joins a chunk in minimum time without overshoot, and rests at the last
    point of the last chunk.

    Parameters
    ----------
    arm : SerialArm or Robot
        The arm, whose limits apply.
    q0 : array_like, shape (n,)
        Start of the reference, at rest [rad, m].
    limits : JointLimits, optional
        Other limits. For a Tracker, use accelerations and jerks that are 5 % below the limits of the tracker.
    dt : float
        Length of a tick [s].
    timeout : float
        Time without a message after which the reference of single postures stops [s].
    delay : float
        Time after which the reference passes the postures of push [s]: the period of the stream plus its jitter. With 0, the
        reference follows a prediction from the last three postures.
    blend : float
        Least time in which the target changes from a chunk to the next [s]: gentle corrections for noisy policies. With 0, a chunk
        that does not continue the chunk before is joined in minimum time.
    start : float, optional
        Time of the first tick on the clock of the stamps [s]. Default: estimated from the stamps.

    Raises
    ------
    ParameterError
        If an argument is out of range.
    """
    def __init__(
        self,
        arm: Model,
        q0: numpy.typing.ArrayLike,
        *,
        limits: typing.Any = None,
        dt: typing.SupportsFloat | typing.SupportsIndex = 0.001,
        timeout: typing.SupportsFloat | typing.SupportsIndex = 0.2,
        delay: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        blend: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        start: typing.SupportsFloat | typing.SupportsIndex | None = None,
    ) -> None: ...
    def advance(self) -> None:
        """
        Advances by one tick; Tracker.tick calls advance.
        """
    def push(self, q: numpy.typing.ArrayLike, stamp: typing.SupportsFloat | typing.SupportsIndex | None = None) -> bool:
        """
        Adds a point that was observed at a time `stamp` [s] on any clock; default: now.

        The reference passes the point `delay` later, and continues after the newest point at constant velocity until the
        timeout. Returns False for a rejected point, which has no effect: a number is not finite, or the stamp is not newer than
        all previous stamps or is from the future. Raises ParameterError for a wrong shape, and for a posture that is outside the
        range of a joint by more than a tenth of its width; within this tenth, the joint moves to the end of its range.
        """
    def push_chunk(
        self,
        postures: numpy.typing.ArrayLike,
        *,
        period: typing.SupportsFloat | typing.SupportsIndex | None = None,
        times: numpy.typing.ArrayLike | None = None,
        stamp: typing.SupportsFloat | typing.SupportsIndex | None = None,
        first: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        velocities: numpy.typing.ArrayLike | None = None,
        accelerations: numpy.typing.ArrayLike | None = None,
    ) -> bool:
        """
        Replaces all points from the first point of a chunk on.

        Point k is for the time stamp + first + k period, or stamp + first + times[k] [s]. Points whose time has passed have no
        effect, so a late chunk is joined where it should be now. velocities and accelerations, one row for each point, are
        estimated from the points if they are not given. After the last point, the reference rests at this point. Returns False
        for a rejected chunk, as push. Raises ParameterError for wrong shapes and times.
        """
    def reset(self, q: numpy.typing.ArrayLike) -> None:
        """
        Restarts at rest, with the same speed; chunks and an estimated clock are discarded.
        """
    def set_speed(self, fraction: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        Reduces the bounds on velocity to a fraction in (0, 1] of the given bounds, until the next call.
        """
    @property
    def age(self) -> float:
        """
        Time since the newest stamp [s].
        """
    @property
    def gap(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Displacement from the reference to the target [rad, m].
        """
    @property
    def q(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Reference at the start of the next tick.
        """
    @property
    def qd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Velocity of the reference.
        """
    @property
    def qdd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Acceleration of the reference.
        """
    @property
    def speed(self) -> float:
        """
        Fraction of the bounds on velocity that set_speed has set.
        """

class PoseStream(Stream):
    """
    Computes a smooth reference of a pose from chunks of poses or single poses, as JointStream does.

    Parameters
    ----------
    x0 : array_like, shape (4, 4)
        Start of the reference, at rest, in the base frame [m].
    velocity, acceleration, jerk : float
        Bounds of each axis of the base frame, [m/s], [m/s^2] and [m/s^3].
    angular_velocity, angular_acceleration, angular_jerk : float
        Bounds of the angle about each axis [rad/s], [rad/s^2] and [rad/s^3].
    dt, timeout, delay, blend, start
        As for JointStream.

    Raises
    ------
    ParameterError
        If an argument is out of range.
    """
    def __init__(
        self,
        x0: numpy.typing.ArrayLike,
        *,
        velocity: typing.SupportsFloat | typing.SupportsIndex,
        acceleration: typing.SupportsFloat | typing.SupportsIndex,
        jerk: typing.SupportsFloat | typing.SupportsIndex,
        angular_velocity: typing.SupportsFloat | typing.SupportsIndex,
        angular_acceleration: typing.SupportsFloat | typing.SupportsIndex,
        angular_jerk: typing.SupportsFloat | typing.SupportsIndex,
        dt: typing.SupportsFloat | typing.SupportsIndex = 0.001,
        timeout: typing.SupportsFloat | typing.SupportsIndex = 0.2,
        delay: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        blend: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        start: typing.SupportsFloat | typing.SupportsIndex | None = None,
    ) -> None: ...
    def advance(self) -> None:
        """
        Advances by one tick; Tracker.tick calls advance.
        """
    def push(self, x: numpy.typing.ArrayLike, stamp: typing.SupportsFloat | typing.SupportsIndex | None = None) -> bool:
        """
        Adds a point that was observed at a time `stamp` [s] on any clock; default: now.

        The reference passes the point `delay` later, and continues after the newest point at constant velocity until the
        timeout. Returns False for a rejected point, which has no effect: a number is not finite, or the stamp is not newer than
        all previous stamps or is from the future. Raises ParameterError for a wrong shape, and for a posture that is outside the
        range of a joint by more than a tenth of its width; within this tenth, the joint moves to the end of its range.
        """
    def push_chunk(
        self,
        poses: numpy.typing.ArrayLike,
        *,
        period: typing.SupportsFloat | typing.SupportsIndex | None = None,
        times: numpy.typing.ArrayLike | None = None,
        stamp: typing.SupportsFloat | typing.SupportsIndex | None = None,
        first: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        velocities: numpy.typing.ArrayLike | None = None,
        accelerations: numpy.typing.ArrayLike | None = None,
    ) -> bool:
        """
        Replaces all points from the first point of a chunk on.

        Point k is for the time stamp + first + k period, or stamp + first + times[k] [s]. Points whose time has passed have no
        effect, so a late chunk is joined where it should be now. velocities and accelerations, one row for each point, are
        estimated from the points if they are not given. After the last point, the reference rests at this point. Returns False
        for a rejected chunk, as push. Raises ParameterError for wrong shapes and times.
        """
    def reset(self, x: numpy.typing.ArrayLike) -> None:
        """
        Restarts at rest, with the same speed; chunks and an estimated clock are discarded.
        """
    def set_speed(self, fraction: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        Reduces the bounds on velocity to a fraction in (0, 1] of the given bounds, until the next call.
        """
    @property
    def age(self) -> float:
        """
        Time since the newest stamp [s].
        """
    @property
    def gap(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Displacement from the reference to the target [rad, m].
        """
    @property
    def speed(self) -> float:
        """
        Fraction of the bounds on velocity that set_speed has set.
        """
    @property
    def x(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Reference at the start of the next tick.
        """
    @property
    def xd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Velocity of the reference.
        """
    @property
    def xdd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Acceleration of the reference.
        """

class Task:
    """
    The compiled part of a task.
    """
    def __init__(self, kind: str) -> None: ...

class Tick:
    """
    Result of one tick of a control loop.
    """
    def __repr__(self) -> str: ...
    @property
    def error(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        x - f(q) at the tick's start [m, rad], shape (m,).
        """
    @property
    def errors(self) -> dict[str, numpy.typing.NDArray[numpy.float64]] | None:
        """
        For a stack: x - f(q) of each task by name, zero in rows that the task does not select; else None.
        """
    @property
    def nearest(self) -> Nearest | None:
        """
        The nearest checked pair of shapes at the tick's start; None without a clearance.
        """
    @property
    def q(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Joint command for the end of the tick [rad], or [m] for a prismatic joint, shape (n,).
        """
    @property
    def qd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Velocity of the command [rad/s], shape (n,).
        """
    @property
    def qdd(self) -> numpy.typing.NDArray[numpy.float64]:
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
        Task scale that the limits admit, from 0 to 1.
        """
    @property
    def scales(self) -> numpy.typing.NDArray[numpy.float64] | None:
        """
        For a stack: task scale of each level, from 0 to 1, shape (levels,); else None.
        """
    @property
    def status(self) -> Status:
        """
        Status of the tick; if the tick failed, the reason why the arm brakes.
        """
    @property
    def torque(self) -> numpy.typing.NDArray[numpy.float64] | None:
        """
        Torques of inverse dynamics [Nm], or [N] for a prismatic joint, for qdd in the state at the tick's start, without
        dry friction, shape (n,): the feed-forward torques. None at velocity level, and if the arm has no dynamics.
        """

class PathFollower:
    """
    A path from the tip, with a clock that can pause, resume and run slower; the result of Tracker.follow.
    """
    def __repr__(self) -> str: ...
    def pause(self) -> None:
        """
        Stops on the path within the ramp time.
        """
    def resume(self) -> None:
        """
        Continues along the path.
        """
    def set_speed(self, fraction: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        Changes the speed to a fraction in (0, 1] of the path's speed, within the ramp time; during a pause, after resume().
        """
    @property
    def done(self) -> bool:
        """
        Whether path time is at the path's end.
        """
    @property
    def speed(self) -> float:
        """
        Fraction of the path's speed that set_speed has set.
        """
    @property
    def time(self) -> float:
        """
        Path time [s].
        """

class Tracker:
    """
    Moves an arm tick by tick under a scheme, within joint limits and through singular postures. If the target is
    unreachable, the arm stops.

    tick advances the tracker's own state; the result is the command for an arm with position or velocity control.
    resolve_measured computes the acceleration for a torque controller from a measured state.
    Never pass a measured state to tick. The limits hold at velocity level and at acceleration level.

    Parameters
    ----------
    arm, scheme
        The arm and its scheme.
    q0 : array_like, shape (n,)
        Joint positions at the start [rad], within the limits.
    qd0, qdd0 : array_like, shape (n,), optional
        Joint velocities at the start [rad/s], and accelerations just before the start [rad/s^2], for bounds on jerk;
        default: zero.
    task : str
        Task of the tip: 'position' or 'pose'.
    stack : Stack, optional
        Several tasks in strict priority, which replace task. The argument of tick is then a dictionary of references.
    dt : float
        Length of a tick [s].
    limits : JointLimits, optional
        Changes of the limits of the arm, or all limits. A bounded joint needs a bound on acceleration, except at velocity
        level.
    error_bound : float
        Largest tip error that the feedback uses: of the position in arm lengths (from the first joint to the tip, along the
        links), of the orientation [rad]. The limits determine the largest error of the joints of a PostureTask.
    integral_gain, integral_bound : float
        Gain of the integral of the error, [1/s^3] or [1/s^2] at velocity level; 0: no integral. Largest contribution of the
        integral [arm lengths and radians per s^2, or per s]. A gain below k1 k2 is stable.
    stall_time : float
        If an arm is slowed, or farther than error_bound from its target, and makes no progress for this time [s], the arm
        stops until the target moves, or until resume(). math.inf: a lack of progress never stops the arm.
    singular_radius, singular_brake : float
        Damping near singular postures, if the scheme has none; 0: no damping.
    null_damping : float
        Null-space damping [1/s], if a scheme of acceleration level has none; without damping, the self-motion never stops.
        0: no damping.
    recovery : bool
        Whether a stalled arm may move to a remembered posture from which the target is reachable.
    keep_first_level : bool
        Whether the first level of a stack, for example a grasp of two arms, has priority over speed. The lower levels leave
        the first level a reserve of the limits: 0.7 of each bound on acceleration and 0.35 of each bound on velocity. stop
        keeps the first level: its references are held at rest, and the joints stop in its null space. A task that
        is farther than 0.001 characteristic lengths, or 0.001 rad, from its reference stays at its current point.
    measured_delay : int
        Largest age of the states for resolve_measured [ticks]: the time from the measurement to the start of the tick in
        which the robot realises the result. 0: exact present states, as in a simulation.
    bounds : sequence of Clearance and TaskBounds
        A Clearance: self-collision and obstacles that the arm avoids. While obstacles are at rest, no checked pair comes
        closer than the margin, for every reference. TaskBounds: walls for points of links, cones for axes, speeds. A tick is
        executed only if the arm can then stop within all bounds; otherwise the arm brakes immediately.
    recover_start : bool
        Whether the start may be outside the joints' ranges, or too fast for their bounds. The joints then return within the
        bounds on velocity, acceleration and jerk, and the other joints follow the task.

    Raises
    ------
    ParameterError
        If an argument is out of range, a limit is missing, or the start violates a limit or a bound; with recover_start,
        the start may violate limits.
    """
    def __init__(
        self,
        arm: Model,
        scheme: Scheme,
        q0: numpy.typing.ArrayLike,
        *,
        qd0: numpy.typing.ArrayLike | None = None,
        qdd0: numpy.typing.ArrayLike | None = None,
        task: str = "position",
        stack: typing.Any = None,
        dt: typing.SupportsFloat | typing.SupportsIndex = 0.001,
        limits: typing.Any = None,
        error_bound: typing.SupportsFloat | typing.SupportsIndex = 0.1,
        integral_gain: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        integral_bound: typing.SupportsFloat | typing.SupportsIndex = 1.0,
        stall_time: typing.SupportsFloat | typing.SupportsIndex = 2.0,
        singular_radius: typing.SupportsFloat | typing.SupportsIndex = 0.02,
        singular_brake: typing.SupportsFloat | typing.SupportsIndex = 10.0,
        null_damping: typing.SupportsFloat | typing.SupportsIndex = 2.0,
        recovery: bool = True,
        keep_first_level: bool = False,
        measured_delay: typing.SupportsInt | typing.SupportsIndex = 3,
        bounds: typing.Any = (),
        recover_start: bool = False,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def enable(self, level: typing.SupportsInt | typing.SupportsIndex, on: bool) -> None:
        """
        Enables or disables a level of a stack below the first; levels are counted from 0.

        Commands stay within all bounds.
        """
    @typing.overload
    def follow(
        self,
        paths: dict[str, typing.Any],
        *,
        ramp: typing.SupportsFloat | typing.SupportsIndex = 0.5,
        keep_path: bool = False,
        reserve: typing.SupportsFloat | typing.SupportsIndex = 0.05,
    ) -> PathFollower:
        """
        Paths of several tasks of a stack, by task name, with one clock; options as for one path.
        """
    @typing.overload
    def follow(
        self,
        path: Path,
        *,
        ramp: typing.SupportsFloat | typing.SupportsIndex = 0.5,
        task: str | None = None,
        keep_path: bool = False,
        reserve: typing.SupportsFloat | typing.SupportsIndex = 0.05,
    ) -> PathFollower:
        """
        A path from the present tip, for tick.

        For a stack, a path from the task of that name; the name is optional if only one task is a position or a pose.

        Parameters
        ----------
        path : Path
            The path. With keep_path, the duration of the path is a lower bound on the duration of the motion.
        ramp : float
            Duration of a pause or a resumption [s].
        task : str, optional
            Task of a stack.
        keep_path : bool
            Whether the tip stays on the path if the path is faster than the limits allow (docs: Paths in the least time). The
            clock of fastest(), slowed by the reserve, replaces the time law. Obstacles, other targets and disturbances, which
            the plan does not know, slow the clock further. The ramp is extended until no change of the speed exceeds a bound.
            With keep_first_level, stop stops the arm on the path. Needs an arm at rest; takes some 50 ms, at acceleration level
            some 150 ms.
        reserve : float
            Fraction by which the motion lasts longer than the least time.

        Raises ParameterError if the arm cannot follow the path within its limits and bounds.
        """
    def frame(self, task: str) -> numpy.typing.NDArray[numpy.float64]:
        """
        For a stack: the frame of the task of that name, in the base frame, shape (4, 4); for an axis task, z is the axis.
        """
    def move(self, name: str, shape: Shape, velocity: numpy.typing.ArrayLike = (0, 0, 0)) -> None:
        """
        Moves an obstacle of the clearance to its present place; velocity [m/s] is the expected velocity.

        shape must have the kind of the given obstacle; place and size may change. Raises ParameterError if no obstacle has
        that name, or if the shape has another kind.
        """
    def reorder(self, order: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex]) -> None:
        """
        Reorders the levels of a stack: the new level k is the old level order[k].

        The tasks keep their targets; tick.scales and enable() use the new levels. Commands stay within all bounds.
        """
    @typing.overload
    def resolve_measured(
        self, q: numpy.typing.ArrayLike, qd: numpy.typing.ArrayLike, references: dict[str, typing.Any]
    ) -> Tick:
        """
        The tick of a stack for a measured state; references as for tick.
        """
    @typing.overload
    def resolve_measured(
        self,
        q: numpy.typing.ArrayLike,
        qd: numpy.typing.ArrayLike,
        x: numpy.typing.ArrayLike,
        xd: numpy.typing.ArrayLike | None = None,
        xdd: numpy.typing.ArrayLike | None = None,
    ) -> Tick:
        """
        The tick for a measured state: its qdd [rad/s^2] is the acceleration for a torque controller.

        The state may be up to measured_delay ticks old.
        """
    def resume(self) -> None:
        """
        Follows references again.
        """
    def set_speed(self, fraction: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        Sets the speed of the paths and filters of the following ticks to a fraction in (0, 1]: PathFollower.set_speed
        and TargetFilter.set_speed, for an operator's slider. Targets without a filter are not slowed.
        """
    def stop(self) -> None:
        """
        Brings every joint to rest as fast as the limits allow, until resume; with keep_first_level, in the null
        space of the first level.
        """
    @typing.overload
    def tick(self, follower: PathFollower) -> Tick:
        """
        One tick along a path. The clock of the path advances by one tick.
        """
    @typing.overload
    def tick(self, filter: TargetFilter) -> Tick:
        """
        One tick toward the reference of a filter. The filter advances by one tick, also after stop.
        """
    @typing.overload
    def tick(self, stream: Stream) -> Tick:
        """
        One tick of a stack of one task toward the reference of a stream. The stream advances by one tick.
        """
    @typing.overload
    def tick(self, references: dict[str, typing.Any]) -> Tick:
        """
        One tick of a stack toward references: a dictionary by task name.

        Each value is a point x, (x, xd) or (x, xd, xdd), for positions and poses also a PathFollower or a TargetFilter, and
        for postures and poses also a JointStream or PoseStream. x
        has shape (3,) for a position, (3, 3) for an orientation, (4, 4) for a pose, (3,) for an axis, (joints,) for a posture
        [m, rad]. A task that is not in the dictionary keeps its last target, at rest; the first target is the start of the
        task.
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
        if there is no motion, the arm brakes, and the status of the tick is the cause.
        """
    @property
    def q(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Joint positions of the tracker's own state [rad].
        """
    @property
    def qd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Joint velocities of the tracker's own state [rad/s].
        """
    @property
    def qdd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Joint accelerations of the last tick [rad/s^2].
        """
    @property
    def sigma(self) -> float:
        """
        Lower bound on the least singular value of J of the tracker's own state, tight within a factor sqrt(m); for a stack, of the first level.
        """
    @property
    def tip(self) -> typing.Any:
        """
        Tip of the tracker's own state in the base frame [m]; for a stack, the point of each task by name.
        """

class Posture:
    """
    A posture for a target: the result of inverse kinematics.
    """
    def __repr__(self) -> str: ...
    @property
    def error(self) -> float:
        """
        Largest distance [m] or angle [rad] from the target.
        """
    @property
    def q(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        The posture, or the nearest posture found [rad], or [m] for a prismatic joint, shape (n,).
        """
    @property
    def rank_value(self) -> float | None:
        """
        The value by which inverse_all ranks; otherwise None.
        """
    @property
    def solved(self) -> bool:
        """
        Whether the target is reached within the tolerance, the ranges and the bounds.
        """
    @property
    def starts(self) -> int:
        """
        Number of start postures used.
        """
    @property
    def status(self) -> Status:
        """
        OK or NOT_FOUND.
        """

class Postures:
    """
    Postures for K targets.
    """
    @property
    def error(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Largest distance [m] or angle [rad] from each target, shape (K,).
        """
    @property
    def q(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        The postures, shape (K, n) [rad or m].
        """
    @property
    def solved(self) -> numpy.typing.NDArray[numpy.bool]:
        """
        Whether each target is reached, shape (K,).
        """
    @property
    def starts(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        Number of start postures used for each target, shape (K,).
        """
    @property
    def status(self) -> list[Status]:
        """
        OK or NOT_FOUND, for each target.
        """

class InverseKinematics:
    """
    Postures for targets, within the ranges of the joints: inverse kinematics.

    From the given start, and then from start postures that fill the ranges evenly, a search makes damped Newton steps until
    the target is reached. The result depends on the arguments only.

    Parameters
    ----------
    arm : Arm or Robot
        A Robot needs a stack.
    task : str
        Task of the tip: 'position' or 'pose'.
    stack : Stack, optional
        Several tasks in strict priority, which replace task. The tasks of the first level, and all tasks except postures,
        must reach their targets; a PostureTask below the first level is approached as far as the other tasks allow.
    limits : JointLimits, optional
        Changes of the limits of the arm, or all limits. Only the ranges are used.
    bounds : sequence of Clearance and TaskBounds
        Bounds that the postures keep: obstacles, self-collision, walls, cones.
    tolerance : float
        Largest distance [m] and angle [rad] from a target.
    starts : int
        Largest number of start postures, the given start included.
    seed : int
        Selects the start postures after the given start.

    Raises
    ------
    ParameterError
        If an argument is out of range, or a task or a bound does not suit the arm.
    """
    def __init__(
        self,
        arm: Model,
        *,
        task: str = "pose",
        stack: typing.Any = None,
        limits: typing.Any = None,
        bounds: typing.Any = (),
        tolerance: typing.SupportsFloat | typing.SupportsIndex = 1e-06,
        starts: typing.SupportsInt | typing.SupportsIndex = 64,
        seed: typing.SupportsInt | typing.SupportsIndex = 0,
    ) -> None: ...
    def solve(self, target: typing.Any, start: numpy.typing.ArrayLike | None = None) -> Posture | Postures:
        """
        A posture for a target: a Posture, or Postures for several targets.

        target: shape (4, 4) for a pose, (3,) for a position, (x, y, angle) or (2,) for a planar arm [m, rad]; for a stack, a
        dictionary by task name. With a leading axis of K entries, K targets, which are computed on all cores. start: the first
        posture from which the search starts, shape (n,) or (K, n), moved into the ranges; by default, the middle of the ranges.
        A target that is not reached raises nothing: see Posture.solved.
        """
    def solve_all(
        self,
        target: typing.Any,
        start: numpy.typing.ArrayLike | None = None,
        count: typing.SupportsInt | typing.SupportsIndex = 16,
        *,
        rank: str = "distance",
    ) -> list[Posture]:
        """
        Up to `count` distinct postures for a target, from all start postures, sorted by rank.

        rank: 'distance', the nearest to the start first; 'manipulability', the largest sqrt(det(J J')) of the task or of the
        first level of the stack; 'ranges', the largest distance from the ends of the ranges, as a fraction of the range;
        'clearance', the largest distance of the nearest checked pair, which needs a Clearance in bounds.
        """

def advice(status: Status) -> str:
    """
    Advice for the status in one sentence; empty for OK.
    """

def at_speed(
    path: Path,
    speed: typing.SupportsFloat | typing.SupportsIndex,
    acceleration: typing.SupportsFloat | typing.SupportsIndex,
    jerk: typing.SupportsFloat | typing.SupportsIndex | None,
) -> Path: ...
def check_sweep(
    arm: Model,
    path: Path,
    schemes: collections.abc.Sequence[Scheme],
    q0s: numpy.typing.ArrayLike,
    dt: typing.SupportsFloat | typing.SupportsIndex,
    hold: typing.SupportsFloat | typing.SupportsIndex,
    task: str,
    limit_options: typing.Any = None,
    stack_tasks: typing.Any = None,
) -> tuple[numpy.typing.NDArray[numpy.float64], int]: ...
def circle(
    radius: typing.SupportsFloat | typing.SupportsIndex,
    duration: typing.SupportsFloat | typing.SupportsIndex,
    time_law: str,
) -> Path: ...
def dh(
    table: numpy.typing.ArrayLike, convention: str, types: collections.abc.Sequence[str]
) -> tuple[list[dict[str, typing.Any]], numpy.typing.NDArray[numpy.float64]]: ...
def failed(status: Status) -> bool:
    """
    Whether the status means that there is no result.
    """

def fastest(
    arm: Model,
    path: Path,
    scheme: Scheme,
    q0: numpy.typing.ArrayLike,
    dt: typing.SupportsFloat | typing.SupportsIndex,
    task: str,
    limits: typing.Any,
    tip_speed: typing.SupportsFloat | typing.SupportsIndex,
    tip_acceleration: typing.SupportsFloat | typing.SupportsIndex,
    bounds: typing.Any,
    stack_tasks: typing.Any = None,
    end_speeds: typing.Annotated[
        collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"
    ] = [0.0, 0.0],
) -> tuple[Status, float, int, dict[str, numpy.ndarray]]: ...
def in_plane(path: Path, axes: numpy.typing.ArrayLike) -> Path: ...
def line(
    displacement: numpy.typing.ArrayLike, duration: typing.SupportsFloat | typing.SupportsIndex, time_law: str
) -> Path: ...
def link_frames(model: Model, q: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
    """
    Frames of the base and of all links in postures q, shape (K, links, 4, 4).
    """

def lissajous(
    amplitude: numpy.typing.ArrayLike,
    duration: typing.SupportsFloat | typing.SupportsIndex,
    frequencies: numpy.typing.ArrayLike,
    phase: typing.SupportsFloat | typing.SupportsIndex,
    time_law: str,
) -> Path: ...
def message(status: Status) -> str:
    """
    Description of the status in one sentence.
    """

def named_frames(model: Model, q: numpy.typing.ArrayLike, frame: str) -> numpy.typing.NDArray[numpy.float64]:
    """
    A frame in postures q, shape (K, 1, 4, 4).
    """

def not_run(count: typing.SupportsInt | typing.SupportsIndex) -> numpy.ndarray: ...
def polyline(
    points: numpy.typing.ArrayLike,
    duration: typing.SupportsFloat | typing.SupportsIndex,
    blend: typing.SupportsFloat | typing.SupportsIndex,
    time_law: str,
) -> Path: ...
def preset(name: str) -> tuple[list[dict[str, typing.Any]], numpy.typing.NDArray[numpy.float64]]: ...
def preset_capsules(
    name: str,
) -> tuple[
    list[tuple[int, numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], float, str]],
    list[tuple[str, str]],
]: ...
def processor_kinds() -> list[str]: ...
def robot_preset(
    name: str,
) -> tuple[
    list[tuple[dict[str, typing.Any], int]],
    list[tuple[str, int, numpy.typing.NDArray[numpy.float64]]],
    float,
    numpy.typing.NDArray[numpy.float64],
]: ...
def rollout(
    arm: Model,
    path: Path,
    scheme: Scheme,
    q0: numpy.typing.ArrayLike,
    qd0: numpy.typing.ArrayLike,
    dt: typing.SupportsFloat | typing.SupportsIndex,
    hold: typing.SupportsFloat | typing.SupportsIndex,
    task: str,
    limit_options: typing.Any = None,
    stack_tasks: typing.Any = None,
    kept: tuple[typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex] = ...,
) -> tuple[Status, float, int, dict[str, numpy.ndarray]]: ...
def rotation(r: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
    """
    Rotation matrix, shape (3, 3), of a rotation vector r [rad]: by |r| about r/|r|.
    """

def rotation_vector(R: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
    """
    Rotation vector of a rotation matrix, shape (3,), of length at most pi [rad].
    """

def saturate(
    levels: collections.abc.Sequence[tuple[numpy.typing.ArrayLike, numpy.typing.ArrayLike]],
    lower: numpy.typing.ArrayLike,
    upper: numpy.typing.ArrayLike,
    *,
    rest: numpy.typing.ArrayLike | None = None,
    unit: numpy.typing.ArrayLike | None = None,
) -> SaturatedLevels:
    """
    Resolves tasks J u = b in strict priority within lower <= u <= upper.

    From u_0 = rest, level by level,

        d = u_{k-1} + Z_{k-1} pinv(J_k Z_{k-1}) (b_k - J_k u_{k-1})
        u_k = u_{k-1} + s_k (d - u_{k-1}) + Z_k g,    lower <= u_k <= upper,    0 <= s_k <= 1 as large as possible,

    where the columns of Z_k are a basis of the null space of J_1 ... J_k, and the null-space motion g replaces joints on
    their bounds by other joints. A lower level never changes J u of a higher level. Each scale s_k is the optimum of a
    linear program.

    Parameters
    ----------
    levels : sequence of (J, b)
        The task levels, highest priority first: J of shape (m, n), b of shape (m,), m at most MAX_DOF. Rows may be linearly
        dependent. If the higher levels contradict a task, d is the least-squares solution.
    lower, upper : array_like, shape (n,)
        Bounds of each joint's motion; infinite if there is none.
    rest : array_like, shape (n,), optional
        Initial motion within the bounds, such as the braking motion of a control loop. Default: the motion nearest to zero.
    unit : array_like, shape (n,), optional
        Unit of each joint's motion: the norm that d and g minimise is measured in these units. Default: half the distance
        between the bounds, but at least 1e-3 of the largest unit.

    Raises
    ------
    ParameterError
        If a shape does not fit, a number is not finite, lower exceeds upper, or rest is outside the bounds.
    """

def sequence(paths: collections.abc.Sequence[Path]) -> Path: ...
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
    limit_options: typing.Any,
    stack_tasks: typing.Any,
    stop: Stop,
) -> tuple[numpy.ndarray, list[dict[str, numpy.ndarray]]]: ...
def tricuspid(
    size: typing.SupportsFloat | typing.SupportsIndex,
    duration: typing.SupportsFloat | typing.SupportsIndex,
    time_law: str,
) -> Path: ...
def untimed(path: Path) -> Path: ...
def use_lanes(code: typing.Any) -> int: ...
def waypoints(
    points: numpy.typing.ArrayLike,
    duration: typing.SupportsFloat | typing.SupportsIndex | None,
    times: numpy.typing.ArrayLike | None,
    velocity: typing.SupportsFloat | typing.SupportsIndex | None,
    acceleration: typing.SupportsFloat | typing.SupportsIndex | None,
    angular_velocity: typing.SupportsFloat | typing.SupportsIndex | None,
    angular_acceleration: typing.SupportsFloat | typing.SupportsIndex | None,
    jerk: typing.SupportsFloat | typing.SupportsIndex | None,
    angular_jerk: typing.SupportsFloat | typing.SupportsIndex | None,
) -> Path: ...
def with_rotation(path: Path, rotation: numpy.typing.ArrayLike, time_law: str) -> Path: ...

MAX_DOF: int = 64
PRESETS: tuple[str, ...] = ("panda", "fr3", "iiwa14", "gen3", "ur5e", "ur10e", "xarm7", "so101", "openarm", "z1")
ROBOT_PRESETS: tuple[str, ...] = ("two_pandas", "g1_upper_body")
TIME_LAWS: tuple[str, ...] = ("sin_squared", "quintic", "constant_speed")
__version__: str = "0.1.0"
