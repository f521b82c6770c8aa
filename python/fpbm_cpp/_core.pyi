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
    "Kinematics",
    "LimitedMotion",
    "Limiter",
    "MAX_DOF",
    "Model",
    "Nearest",
    "PRESETS",
    "Path",
    "PathFollower",
    "ROBOT_PRESETS",
    "Robot",
    "SaturatedLevels",
    "Scheme",
    "Shape",
    "Status",
    "Stop",
    "TIME_LAWS",
    "TargetFilter",
    "Tick",
    "Tracker",
    "advice",
    "check_sweep",
    "circle",
    "dh",
    "failed",
    "in_plane",
    "line",
    "lissajous",
    "message",
    "not_run",
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
    "use_lanes",
    "waypoints",
    "with_rotation",
]

class Model:
    """
    The compiled part of a robot or an arm: its joints and frames.
    """
    def bounds(self) -> dict[str, numpy.typing.NDArray[numpy.float64]]:
        """
        The bounds of the joints by name, as JointLimits has them, shape (n,) each; infinite where there is none.
        """
    @property
    def dof(self) -> int:
        """
        Number of joints n that have a drive.
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
    ) -> None: ...
    def center_of_mass(self, q: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        Centre of mass in the base frame, shape (3,) [m], the base included. q: (n,) [rad].

        Raises ParameterError where the robot has no mass.
        """
    def forward(self, q: numpy.typing.ArrayLike, frame: str) -> numpy.typing.NDArray[numpy.float64]:
        """
        Pose of a frame in the base frame [m], a homogeneous matrix, shape (4, 4). q: (n,) [rad].
        """
    def jacobian(
        self, q: numpy.typing.ArrayLike, frame: str, *, task: str = "pose"
    ) -> numpy.typing.NDArray[numpy.float64]:
        """
        Jacobian of a frame, shape (m, n): its velocity is J qd, linear rows first, then angular, in the base
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
    ParameterError
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
    The compiled part of an arm: in the plane, of link lengths, or in space, of joints.
    """
    @typing.overload
    def __init__(self, lengths: numpy.typing.ArrayLike) -> None: ...
    @typing.overload
    def __init__(self, joints: list[typing.Any], tip: numpy.typing.ArrayLike) -> None: ...
    def forward(self, q: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """
        Tip f(q) in the base frame [m]: a position, shape (2,), of an arm in the plane, a pose as a homogeneous
        matrix, shape (4, 4), of one in space. q: shape (n,) [rad].
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
    def _duration(self) -> float: ...
    def sample(
        self, t: typing.SupportsFloat | typing.SupportsIndex
    ) -> tuple[
        numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]
    ]:
        """
        (x, xd, xdd) at t [s], as a displacement from where the tip starts [m, m/s, m/s^2].

        x has shape (2,) or (3,), or (4, 4) where the path rotates the tip in space (in the plane: x, y, angle); xd and xdd have
        shape (m,), linear rows first, then angular. At rest on the path's ends outside 0 <= t <= T.
        """

class Status(enum.Enum):
    """
    What became of an evaluation or a rollout.
    """

    BLOCKED = ...
    COARSE = ...
    DAMPED = ...
    NOT_FINITE = ...
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
        Joint motion that the scheme asks for in a state, or in each of k states.

        Parameters
        ----------
        arm : Arm
            The arm.
        q, qd : array_like, shape (n,) or (k, n)
            Joint state [rad], [rad/s]. Where q has k rows, each of the others has k, along a leading axis, or is one for all.
        x : array_like, shape (2,), (3,) or (4, 4)
            Where the tip is to be in the base frame [m]; a pose is (x, y, angle) in the plane, a homogeneous matrix in space.
        xd, xdd : array_like, shape (m,)
            Its velocity and acceleration, linear rows first, then angular [m/s, rad/s]; xdd may be left out at velocity level.
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
        *,
        out: numpy.typing.NDArray[numpy.float64] | None = None,
    ) -> numpy.typing.NDArray[numpy.float64]:
        """
        The same for an arm whose tip, J and Jd you have from elsewhere, as a Kinematics.
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
    The two shapes of an arm and its surroundings that are nearest to one another.
    """
    def __repr__(self) -> str: ...
    @property
    def distance(self) -> float:
        """
        How far they are apart [m]; below zero, how deep one is in the other.
        """
    @property
    def pair(self) -> tuple[str, str]:
        """
        Their names: of a capsule of the arm, and of the other.
        """

class Clearance:
    """
    The compiled part of a clearance, for one robot.
    """
    def __init__(self, arm: Model, clearance: typing.Any) -> None: ...
    def left_out(self) -> list[tuple[str, str]]: ...
    def nearest(self, q: numpy.typing.ArrayLike) -> Nearest | None: ...
    def pairs(self) -> list[tuple[str, str]]: ...

class Stop:
    """
    Ends all motions of a sweep in this process, within a sample.
    """
    def __init__(self) -> None: ...
    def set(self) -> None:
        """
        From any thread.
        """

class LimitedMotion:
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
        How much of the task is left, from 0 to 1.
        """
    @property
    def u(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Accelerations [rad/s^2], or velocities [rad/s] at that level, shape (n,).
        """

class Limiter:
    """
    Keeps joint limits in a loop of one's own, with a Jacobian from anywhere.

    A motion that keeps every bound over the next tick, and can be brought to rest within them, passes unchanged. Otherwise
    other joints take over in the null space of J; where they cannot, the task is scaled down along its direction.

    Parameters
    ----------
    limits : JointLimits
        Bounds of the joints; one with bounds needs one on its acceleration, except at velocity level.
    dt : float
        Length of a tick [s].
    level : str
        'acceleration' or 'velocity': what is limited.

    Raises
    ------
    ParameterError
        Where an argument is out of range or a bound is missing.
    """
    def __init__(
        self, limits: typing.Any, dt: typing.SupportsFloat | typing.SupportsIndex, *, level: str = "acceleration"
    ) -> None: ...
    def brake(
        self, q: numpy.typing.ArrayLike, qd: numpy.typing.ArrayLike, *, last: numpy.typing.ArrayLike | None = None
    ) -> LimitedMotion:
        """
        The motion that brings every joint to rest, as motion.
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
    ) -> LimitedMotion:
        """
        The motion u of the next tick for a desired one: J u = J r + s J (desired - r), with a motion r that slows the arm
        down and s <= 1 as large as the limits allow; where s comes near zero, a motion that still brings the tip nearer.

        J has shape (m, n); q, qd and desired (n,) [rad, rad/s, and rad/s^2 or rad/s]. At velocity level qd is the last command.
        last is the acceleration of the tick before [rad/s^2], from which bounds on jerk start: zero unless given. rows is a pair
        (G, b), shapes (p, n) and (p,), of further bounds G u <= b, 16 at most, kept as far as the limits admit. Raises
        ParameterError where a shape is another, or a number is not finite.
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
    Makes a smooth reference of targets that come at any rate, late, twice or not at all.

    Each axis of the base frame goes to the target in the least time within its bounds, in the frame of a target that moves:
    without overshoot to one at rest, without lag behind one that moves evenly. The target's velocity is estimated from the
    points that come. One without news for a timeout comes to rest. From rest, an orientation turns about one axis, its largest
    angle in the least time.

    Parameters
    ----------
    x0 : array_like, shape (2,), (3,) or (4, 4)
        Where it starts, at rest, in the base frame [m, rad].
    velocity, acceleration, jerk : float
        Bounds of each axis of the base frame, [m/s], [m/s^2] and [m/s^3].
    angular_velocity, angular_acceleration, angular_jerk : float
        The same of each axis' angle [rad/s], [rad/s^2] and [rad/s^3]; needed for poses.
    task : str
        'pose' makes (3,) a pose in the plane.
    dt : float
        Length of a tick [s].
    timeout : float
        How long a target moves on, and a twist holds, without news [s].
    start : float, optional
        Time at the first tick on the stamps' clock [s]. Unless given the clock is learnt: the least delayed stamp counts as
        not delayed.

    Raises
    ------
    ParameterError
        Where an argument is out of range.
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
    def advance(self) -> None:
        """
        Goes one tick on; Tracker.tick does so by itself.
        """
    def push(self, x: numpy.typing.ArrayLike, stamp: typing.SupportsFloat | typing.SupportsIndex | None = None) -> bool:
        """
        A target, seen at a stamp [s] on any clock, or now.

        Returns False for a rejected message, which changes nothing: x or the stamp is not finite, R deviates from a rotation by
        more than 1e-4, or the stamp is not newer than all before or from the future. An accepted R becomes the nearest rotation.
        Raises ParameterError where x has another shape than x0.
        """
    def push_twist(
        self, v: numpy.typing.ArrayLike, stamp: typing.SupportsFloat | typing.SupportsIndex | None = None
    ) -> bool:
        """
        A velocity [m/s, rad/s] to go at, as far as the bounds allow, until the timeout.

        v has shape (m,), linear rows first, in the base frame's axes. Returns whether it is taken, as push does.
        """
    def reset(self, x: numpy.typing.ArrayLike) -> None:
        """
        Starts anew, at rest at x; a clock that was learnt is forgotten.
        """
    @property
    def x(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Reference at the start of the coming tick, shape (2,), (3,) or (4, 4) [m, rad].
        """
    @property
    def xd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Its velocity, shape (m,), linear rows first [m/s, rad/s].
        """
    @property
    def xdd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Its acceleration, shape (m,) [m/s^2, rad/s^2].
        """

class Tick:
    """
    What one tick of a control loop did.
    """
    @property
    def error(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        x - f(q) at the tick's start [m, rad], shape (m,).
        """
    @property
    def errors(self) -> dict[str, numpy.typing.NDArray[numpy.float64]] | None:
        """
        Of a stack: x - f(q) of each task by its name, zero where a task does not select a row; else None.
        """
    @property
    def nearest(self) -> Nearest | None:
        """
        The two shapes that are to be kept apart and were nearest to one another at the tick's start; None
        without a clearance.
        """
    @property
    def q(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Command for the tick's end [rad], or [m] for a prismatic joint, shape (n,).
        """
    @property
    def qd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Its velocity [rad/s], shape (n,).
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
        How much of the task the limits left, from 0 to 1.
        """
    @property
    def scales(self) -> numpy.typing.NDArray[numpy.float64] | None:
        """
        Of a stack: how much of each level the limits left, from 0 to 1, shape (levels,); else None.
        """
    @property
    def sigma(self) -> float:
        """
        Lower bound on the least singular value of J at the tick's start, tight within a factor sqrt(m).
        """
    @property
    def status(self) -> Status:
        """
        What became of it; where it failed, why the arm brakes.
        """

class PathFollower:
    """
    A path laid out from a tip, with a clock that can pause and resume; made by Tracker.follow.
    """
    def pause(self) -> None:
        """
        Comes to rest on the path, within the ramp.
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
    resolve_measured answers for a measured state, with the acceleration that a torque controller is to realise.
    Never feed a measured state to tick. A scheme of velocity level is kept within the same limits.

    Parameters
    ----------
    arm, scheme
        What moves, and how.
    q0 : array_like, shape (n,)
        Joint positions at the start [rad], within the limits.
    qd0, qdd0 : array_like, shape (n,), optional
        Joint velocities at the start [rad/s], and accelerations just before it [rad/s^2], from which bounds on jerk start;
        zero unless given.
    task : str
        'position' or 'pose', of the tip.
    stack : Stack, optional
        Several tasks in strict priority, which replace task. tick then takes a dictionary of references.
    dt : float
        Length of a tick [s].
    limits : JointLimits, optional
        The arm's own unless given. A joint with bounds needs one on its acceleration, except at velocity level.
    error_bound : float
        Largest tip error that the feedback acts on: a larger one counts as this. Of the position, in arm lengths (the way
        from the first joint to the tip); of the orientation [rad].
    integral_gain, integral_bound : float
        Gain of the integral of the error, [1/s^3] or [1/s^2] at velocity level, off by default, and the most that it adds
        [arm lengths and radians per s^2, or per s]. Stable below k1 k2.
    stall_time : float
        An arm that is slowed, or farther than error_bound from its target, and comes no nearer for this time [s] rests
        until its target moves, or until resume(). math.inf: it never gives up.
    singular_radius, singular_brake : float
        Damping near singular postures, where the scheme has none; 0 switches it off.
    null_damping : float
        Damping of the null space [1/s], where a scheme of acceleration level has none, as self-motion would never come to
        rest; 0 switches it off.
    recovery : bool
        Whether a stalled arm may move to a posture that it remembers, if the target can be reached from there.
    keep_first_level : bool
        Whether the first level of a stack, such as a grasp of two arms, comes before speed: the lower levels leave it a
        reserve of the limits, 0.7 of each bound on acceleration and 0.35 of each bound on velocity, and stop keeps it: its
        references are held at rest, and the joints come to rest in its null space. A task that is farther than 0.001
        characteristic lengths, or 0.001 rad, from its reference stays where it is.
    measured_delay : int
        Largest age of the states that resolve_measured is given [ticks]: the time from the measurement to the start of the
        tick in which the robot realises the answer. 0: exact states of this moment, as a simulation has them.
    clearance : Clearance, optional
        What the arm is to keep clear of: no two shapes ever come nearer than its margin, whatever the reference, as long as
        obstacles are at rest. A tick is taken only if from its end the arm can stop clear of all; else it brakes at once.
    bounds : sequence of TaskBounds
        Bounds on coordinates of tasks: walls for points of links, cones for axes, speeds.

    Raises
    ------
    ParameterError
        Where an argument is out of range, a limit is missing, or the start is beyond a limit or a bound, or not clear.
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
        clearance: typing.Any = None,
        bounds: typing.Any = (),
    ) -> None: ...
    def enable(self, level: typing.SupportsInt | typing.SupportsIndex, on: bool) -> None:
        """
        Resolves a level of a stack below the first, counted from 0, or leaves it out.

        Commands stay within all bounds.
        """
    def follow(
        self, path: Path, *, ramp: typing.SupportsFloat | typing.SupportsIndex = 0.5, task: str | None = None
    ) -> PathFollower:
        """
        A path laid out from where the tip is now; ramp is how long a pause or a resumption takes [s].

        Of a stack, from where the task of that name is; it may be left out if one task alone is a position or a pose.
        """
    def frame(self, task: str) -> numpy.typing.NDArray[numpy.float64]:
        """
        Of a stack: the frame of the task of that name, in the base frame, shape (4, 4); of an axis task, z is the axis.
        """
    def move(self, name: str, shape: Shape, velocity: numpy.typing.ArrayLike = (0, 0, 0)) -> None:
        """
        Moves an obstacle of the clearance: where it is now, and the velocity [m/s] at which it is expected to go on.

        shape must be of the kind that the obstacle was given as: its place changes, and its size may. Raises ParameterError
        where no obstacle has that name, or the shape is of another kind.
        """
    def reorder(self, order: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex]) -> None:
        """
        Reorders the levels of a stack: level k becomes what was level order[k].

        The tasks keep their targets; tick.scales and enable() count the new levels. Commands stay within all bounds.
        """
    @typing.overload
    def resolve_measured(
        self, q: numpy.typing.ArrayLike, qd: numpy.typing.ArrayLike, references: dict[str, typing.Any]
    ) -> Tick:
        """
        The same of a stack.
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
        The tick for a measured state: its qdd [rad/s^2] is the acceleration for a torque controller to realise.

        The state may be up to measured_delay ticks old.
        """
    def resume(self) -> None:
        """
        Follows references again.
        """
    def stop(self) -> None:
        """
        Brings every joint to rest as fast as the limits allow, until resume; with keep_first_level, in the null
        space of the first level.
        """
    @typing.overload
    def tick(self, follower: PathFollower) -> Tick:
        """
        One tick along a path, whose clock advances with it.
        """
    @typing.overload
    def tick(self, filter: TargetFilter) -> Tick:
        """
        One tick behind a filter of targets, which goes on, also after stop.
        """
    @typing.overload
    def tick(self, references: dict[str, typing.Any]) -> Tick:
        """
        One tick of a stack toward references: a dictionary by the names of the tasks.

        Each value is a point x, (x, xd) or (x, xd, xdd), and of positions and poses also a PathFollower or a TargetFilter. x has
        shape (3,) of a position, (3, 3) of an orientation, (4, 4) of a pose, (3,) of an axis, (joints,) of a posture [m, rad]. A
        task that is not in the dictionary keeps its last target, at rest; at first, the point where it starts.
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
    def q(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Joint positions of its own state [rad].
        """
    @property
    def qd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Joint velocities of its own state [rad/s].
        """
    @property
    def qdd(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Joint accelerations of its last tick [rad/s^2].
        """
    @property
    def tip(self) -> typing.Any:
        """
        Where the tip of its own state is, in the base frame [m]; of a stack, where each task is, by name.
        """

def advice(status: Status) -> str:
    """
    One sentence: what to do about it; empty for OK.
    """

def check_sweep(
    arm: Model,
    path: Path,
    schemes: collections.abc.Sequence[Scheme],
    q0s: numpy.typing.ArrayLike,
    dt: typing.SupportsFloat | typing.SupportsIndex,
    hold: typing.SupportsFloat | typing.SupportsIndex,
    task: str,
    limited: typing.Any = None,
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
    Whether there is no result.
    """

def in_plane(path: Path, axes: numpy.typing.ArrayLike) -> Path: ...
def line(
    displacement: numpy.typing.ArrayLike, duration: typing.SupportsFloat | typing.SupportsIndex, time_law: str
) -> Path: ...
def lissajous(
    amplitude: numpy.typing.ArrayLike,
    duration: typing.SupportsFloat | typing.SupportsIndex,
    frequencies: numpy.typing.ArrayLike,
    phase: typing.SupportsFloat | typing.SupportsIndex,
    time_law: str,
) -> Path: ...
def message(status: Status) -> str:
    """
    One sentence: what happened.
    """

def not_run(count: typing.SupportsInt | typing.SupportsIndex) -> numpy.ndarray: ...
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
    list[tuple[dict[str, typing.Any], int, float, numpy.typing.NDArray[numpy.float64]]],
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
    limited: typing.Any = None,
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
    their bounds by others. A lower level never changes J u of a higher one. Each scale s_k is the optimum of a linear program.

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
        between the bounds, but at least 1e-3 of the largest.

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
    limited: typing.Any,
    stop: Stop,
) -> tuple[numpy.ndarray, list[dict[str, numpy.ndarray]]]: ...
def tricuspid(
    size: typing.SupportsFloat | typing.SupportsIndex,
    duration: typing.SupportsFloat | typing.SupportsIndex,
    time_law: str,
) -> Path: ...
def use_lanes(code: typing.Any) -> int: ...
def waypoints(
    points: numpy.typing.ArrayLike,
    duration: typing.SupportsFloat | typing.SupportsIndex | None,
    times: numpy.typing.ArrayLike | None,
    velocity: typing.SupportsFloat | typing.SupportsIndex | None,
    acceleration: typing.SupportsFloat | typing.SupportsIndex | None,
    angular_velocity: typing.SupportsFloat | typing.SupportsIndex | None,
    angular_acceleration: typing.SupportsFloat | typing.SupportsIndex | None,
) -> Path: ...
def with_rotation(path: Path, rotation: numpy.typing.ArrayLike, time_law: str) -> Path: ...

MAX_DOF: int = 64
PRESETS: tuple[str, ...] = ("panda", "fr3", "iiwa14", "gen3", "ur5e", "ur10e")
ROBOT_PRESETS: tuple[str, ...] = ("two_pandas", "g1_upper_body")
TIME_LAWS: tuple[str, ...] = ("sin_squared", "quintic", "constant_speed")
__version__: str = "0.1.0"
