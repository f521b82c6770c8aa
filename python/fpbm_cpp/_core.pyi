"""
The compiled part of fpbm_cpp.
"""

from __future__ import annotations
import enum
import numpy
import numpy.typing
import typing

__all__: list[str] = [
    "Balanced",
    "Circle",
    "FPBM",
    "JointLimits",
    "Line",
    "Lissajous",
    "MAN",
    "MAX_DOF",
    "MVN",
    "Path",
    "PlanarArm",
    "Scheme",
    "Status",
    "Tricuspid",
    "WMVN",
    "WMVNAcceleration",
    "advice",
    "message",
    "simulate",
]

class JointLimits:
    """
    Bounds of each joint's motion, infinite where there is none.
    """
    def __repr__(self) -> str: ...
    @property
    def acceleration(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Highest joint accelerations [rad/s^2], shape (n,).
        """
    @property
    def lower(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Lowest joint positions [rad], shape (n,).
        """
    @property
    def upper(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Highest joint positions [rad], shape (n,).
        """
    @property
    def velocity(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Highest joint speeds [rad/s], shape (n,).
        """

class PlanarArm:
    """
    Planar arm of n revolute joints.

    f(q) = sum_i l_i (cos th_i, sin th_i) with th_i = q_1 + ... + q_i: joint angles are relative [rad], the first
    from the base frame's x axis.

    Parameters
    ----------
    lengths : array_like, shape (n,)
        Link lengths [m], 2 to MAX_DOF of them, positive. Up to 10 joints run in code made for just that number.

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
    def forward(self, q: numpy.typing.ArrayLike) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[2, 1]"]:
        """
        Tip position f(q) in the base frame [m], shape (2,). q: shape (n,) [rad].
        """
    def jacobian(
        self, q: numpy.typing.ArrayLike, *, task: str = "position"
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        Task Jacobian J(q), shape (2, n) [m/rad]: tip velocity is J qd. q: shape (n,) [rad].
        """
    def jacobian_dot(
        self, q: numpy.typing.ArrayLike, qd: numpy.typing.ArrayLike, *, task: str = "position"
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        dJ/dt along qd, shape (2, n): tip acceleration is J qdd + Jd qd. q, qd: shape (n,) [rad], [rad/s].
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
    def lengths(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Link lengths [m], shape (n,).
        """
    @property
    def limits(self) -> JointLimits:
        """
        Joint limits: a planar arm has none.
        """

class Path:
    """
    A shape run through under a time law in T seconds, then held.

    A displacement from where the tip starts, so that x(0) = f(q0). The time laws give the fraction done, with tau = t/T:
    'sin_squared', the paper's sin^2(pi tau / 2); 'quintic', 10 tau^3 - 15 tau^4 + 6 tau^5; 'constant_speed', tau.
    """
    def __repr__(self) -> str: ...
    def sample(
        self, t: typing.SupportsFloat | typing.SupportsIndex
    ) -> tuple[
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[2, 1]"],
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[2, 1]"],
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[2, 1]"],
    ]:
        """
        (x, xd, xdd) at t [s], each of shape (2,) [m, m/s, m/s^2]; at rest on the path's ends outside 0 <= t <= T.
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
    displacement : array_like, shape (2,)
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

class Status(enum.Enum):
    """
    What became of an evaluation or a rollout.
    """

    NOT_FINITE = ...
    OK = ...
    SINGULAR = ...
    TASK_LOST = ...

class Scheme:
    """
    A redundancy resolution scheme: what all of them can do.
    """
    def __repr__(self) -> str: ...
    def resolve(
        self,
        arm: PlanarArm,
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
        arm : PlanarArm
            The arm.
        q, qd : array_like, shape (n,)
            Joint state [rad], [rad/s].
        x, xd, xdd : array_like, shape (2,)
            Where the tip is to be in the base frame [m], its velocity [m/s] and acceleration [m/s^2]; xdd may be left out at
            velocity level.
        task : str
            'position'.

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
    @property
    def level(self) -> str:
        """
        'velocity' where resolve returns qd, 'acceleration' where it returns qdd.
        """

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
    ) -> None: ...

def advice(status: Status) -> str:
    """
    One sentence: what to do about it; empty for OK.
    """

def message(status: Status) -> str:
    """
    One sentence: what happened.
    """

def simulate(
    arm: PlanarArm,
    path: Path,
    scheme: Scheme,
    q0: numpy.typing.ArrayLike,
    qd0: numpy.typing.ArrayLike,
    dt: typing.SupportsFloat | typing.SupportsIndex,
    hold: typing.SupportsFloat | typing.SupportsIndex,
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

MAX_DOF: int = 32
__version__: str = "0.1.0"
