"""A whole motion: simulated without limits, or tracked within the joint limits."""

from collections.abc import Callable, Mapping, Sequence
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .._core import failed, rollout
from ..arms import Arm
from ..bounds import Bound, bounds_of
from ..errors import ResolutionError, not_one_of, require, wrong
from ..joints import JointLimits, limits_of
from ..paths import Path, are_timed
from ..robots import Robot
from ..schemes import Scheme
from ..tasks import PoseTask, Stack
from .run import Run
from .run_data import Paths, RunStatus


class LimitOptions(NamedTuple):
    """Options of a motion within joint limits; the fields are arguments of track()."""

    limits: JointLimits | None = None
    error_bound: float = 0.1
    integral_gain: float = 0.0
    integral_bound: float = 1.0
    stall_time: float = 2.0
    singular_radius: float = 0.02
    singular_brake: float = 10.0
    null_damping: float = 2.0
    bounds: Sequence[Bound] = ()
    recover_start: bool = False
    keep_path: bool = False
    reserve: float = 0.05


class StackTasks(NamedTuple):
    """The tasks of a motion with a stack."""

    stack: Stack
    task: str  # Task of the run's x, x_ref and error.
    other_paths: Mapping[str, Path] = {}  # Paths of the other tasks, by name.


def simulate(
    arm: Arm | Robot,
    path: Paths,
    scheme: Scheme,
    q0: ArrayLike,
    *,
    dt: float = 1e-3,
    hold: float = 0.0,
    qd0: ArrayLike | None = None,
    task: str | None = None,
    stack: Stack | None = None,
    partial: bool = False,
) -> Run:
    """Move an arm along a path under a scheme, by RK4 with fixed steps.

    The path is a displacement from the start of the tip, f(q0). A velocity-level scheme integrates q, an
    acceleration-level scheme q and qd. The function runs without the interpreter's lock. run.status is the status at
    the end of the motion.

    Raises ValueError if an argument is out of range, not finite, or of the wrong shape; nothing is run then. Raises
    ResolutionError if the motion stops early; the run of the error has the motion before the stop.

    Parameters
    ----------
    arm, path, scheme
        The arm, its path and its scheme. A Robot needs a stack. For a stack, path may be a dictionary of paths by task
        name: the motion is as long as the longest path.
    q0 : array_like, shape (n,)
        Joint positions at the start [rad].
    dt : float
        Step [s]; it must divide the path's duration and the hold.
    hold : float
        Time at rest at the end of the path [s].
    qd0 : array_like, shape (n,), optional
        Joint velocities at the start [rad/s], zero by default; velocity-level schemes do not read them.
    task : str
        'position' (default), or 'pose' to track the tip's orientation too. For a stack: the name of the task that
        follows the path, which is optional if only one task is a position or a pose. For several paths: the name of
        the task of the run's x, x_ref and error; default: the task of the first path.
    stack : Stack, optional
        Several tasks in strict priority. The path is a displacement from the start of one task; the other tasks have
        their targets x or q. Directions that are nearly singular or in conflict with higher levels are damped.
    partial : bool
        If the motion stops early, return the run before the stop instead of raising.
    """
    require_motion(arm, path, scheme)
    options = motion_options(arm, dt, hold, qd0)
    name, kind, followed, tasks = task_and_paths(path, task, stack)
    outcome = rollout(arm, followed, scheme, q0, options["qd0"], dt, hold, kind, None, tasks)
    if stack is not None:
        options["stack"] = stack
    run = make_run(outcome, q0, arm, path, scheme, name, options, simulate)
    if failed(run.status.code) and not partial:
        raise ResolutionError(run.status.code, str(run.status), run)
    return run


def track(
    arm: Arm | Robot,
    path: Paths,
    scheme: Scheme,
    q0: ArrayLike,
    *,
    dt: float = 1e-3,
    hold: float = 0.0,
    qd0: ArrayLike | None = None,
    task: str | None = None,
    stack: Stack | None = None,
    limits: JointLimits | None = None,
    error_bound: float = 0.1,
    integral_gain: float = 0.0,
    integral_bound: float = 1.0,
    stall_time: float = 2.0,
    singular_radius: float = 0.02,
    singular_brake: float = 10.0,
    null_damping: float = 2.0,
    bounds: Sequence[Bound] = (),
    recover_start: bool = False,
    keep_path: bool = False,
    reserve: float = 0.05,
) -> Run:
    """Move an arm along a path under a scheme, within its joints' limits and through singular postures.

    A Tracker moves the arm: every joint keeps its bounds, the motion is damped near singular postures, and the
    motion never stops early. Sample k has the state and the tip's error at t_k. The mean acceleration, the task scale
    and the joints on a bound belong to the tick that starts at t_k. The status is the worst of all ticks: OK,
    DAMPED, SLOWED, BLOCKED or STALLED; without damping, the status may be SINGULAR, if the arm brakes at a singular
    posture. Raises ValueError as simulate() does, and if a limit is missing, or if the start violates a limit or a
    bound.

    Parameters
    ----------
    arm, path, scheme, q0, dt, hold, qd0, task, stack
        As for simulate(); q0 and qd0 must be within the limits. If the limits delay the arm, a longer hold gives
        it time to arrive.
    limits, error_bound, integral_gain, integral_bound, stall_time
        As for Tracker.
    singular_radius, singular_brake, null_damping, bounds, recover_start
        As for Tracker.
    keep_path, reserve
        Whether the tip stays on the path if the path is faster than the limits allow: the path then lasts (1 + reserve)
        times the duration of fastest(). Needs a scheme at velocity level, and a start at rest. The durations and time
        laws of shapes have no effect, except that the motion is not shorter than the path. The speed of a path
        at_speed() is a bound. Nearly singular postures are not damped: the bounds on the joints limit the motion there.
    """
    require_motion(arm, path, scheme, timed=not keep_path)
    options = motion_options(arm, dt, hold, qd0)
    geometry, speed, shortest = kept_paths(path, task) if keep_path else (path, inf, 0.0)
    name, kind, followed, tasks = task_and_paths(geometry, task, stack)
    limited = LimitOptions(
        limits_of(arm, limits),
        error_bound,
        integral_gain,
        integral_bound,
        stall_time,
        0.0 if keep_path else singular_radius,  # Damping would move the arm away from its joint path.
        singular_brake,
        null_damping,
        bounds_of(bounds),
        bool(recover_start),
        bool(keep_path),
        reserve,
    )
    outcome = rollout(arm, followed, scheme, q0, options["qd0"], dt, hold, kind, limited, tasks, (speed, shortest))
    options |= {**limited._asdict(), "stack": stack}
    return make_run(outcome, q0, arm, path, scheme, name, options, track)


def require_motion(arm: object, path: Any, *schemes: object, timed: bool = True) -> None:
    """Raise ParameterError unless the arguments of a motion are an arm, a path and schemes.

    timed: whether each path must have a duration.
    """
    require("arm", arm, (Arm, Robot), "an arm or a Robot")
    require("path", path, (Path, Mapping), "a path, or a dictionary of paths by task name")
    for name, each in by_task(path).items():
        require(f"path[{name!r}]", each, Path, "a path")
        if timed:
            each._require_duration()
    for scheme in schemes:
        require("scheme", scheme, Scheme, "a scheme")


def by_task(path: Paths) -> Mapping[str, Path]:
    """Paths by task name; the name of a single path is ''."""
    return path if isinstance(path, Mapping) else {"": path}


def kept_paths(path: Paths, task: str | None) -> tuple[Paths, float, float]:
    """Paths for a motion that keeps them, bound on the speed of the tip [m/s], and least duration [s]: Path._kept()."""
    are_timed({f"path[{name!r}]": each for name, each in by_task(path).items()})
    if isinstance(path, Path):
        return path._kept()
    kept = {name: each._kept() for name, each in path.items()}
    main = next(iter(kept), "") if task is None else task
    for name, (_, speed, _) in kept.items():
        if speed < inf and name != main:
            raise wrong("path", path, f"[{name!r}]: has a speed; only the path of the run's task may have a speed")
    speed = kept[main][1] if main in kept else inf
    durations = (duration for _, _, duration in kept.values())
    return {name: each for name, (each, _, _) in kept.items()}, speed, max(durations, default=0.0)


def path_task(task: str | None, stack: Stack | None) -> tuple[str, str]:
    """Name and kind of the task that follows the path; the kind is 'position' or 'pose'."""
    if stack is None:
        return task or "position", task or "position"
    require("stack", stack, Stack, "a Stack")
    followed = stack.follower(task)
    return followed.name, "pose" if isinstance(followed, PoseTask) else "position"


def task_and_paths(path: Paths, task: str | None, stack: Stack | None) -> tuple[str, str, Path, StackTasks | None]:
    """Name and kind of the run's task, its path, and the tasks of a stack. Raises ParameterError."""
    if not isinstance(path, Mapping):
        name, kind = path_task(task, stack)
        return name, kind, path, None if stack is None else StackTasks(stack, name)
    if stack is None or not path:
        raise wrong("path", path, f" = {path!r:.80}: must be one path, or paths by task names of a stack")
    for each in path:
        path_task(each, stack)
    name = next(iter(path)) if task is None else task
    if name not in path:
        raise not_one_of("task", name, path)
    others = {each: followed for each, followed in path.items() if each != name}
    return *path_task(name, stack), path[name], StackTasks(stack, name, others)


def one_path(path: Paths, task: str | None, stack: Stack | None) -> tuple[Path, str | None]:
    """The path and its task, for functions of one path. A dictionary of one path names the task."""
    name, _, followed, tasks = task_and_paths(path, task, stack)
    if tasks is not None and tasks.other_paths:
        many = f" has paths of {1 + len(tasks.other_paths)} tasks"
        raise wrong("path", path, f"{many}: must be one path; simulate() and track() accept more")
    return followed, name if isinstance(path, Mapping) else task


def motion_options(arm: Arm | Robot, dt: float, hold: float, qd0: ArrayLike | None = None) -> dict[str, Any]:
    """The keyword arguments of every motion, as options of its run."""
    start = np.zeros(arm.dof) if qd0 is None else np.array(qd0, dtype=float)
    return {"dt": float(dt), "hold": float(hold), "qd0": start.ravel().tolist()}


def make_run(
    outcome: Any,
    q0: ArrayLike,
    arm: Arm | Robot,
    path: Paths,
    scheme: Scheme,
    task: str,
    options: dict[str, Any],
    function: Callable[..., Run],
) -> Run:
    """A run from the compiled part's result: status, time, number of samples, and arrays of at least this length."""
    code, time, samples, given = outcome
    arrays = {name: array if samples == len(array) else array[:samples].copy() for name, array in given.items()}
    if function is simulate and scheme.level == "velocity" and samples > 1:
        arrays["qdd"] = np.gradient(arrays["qd"], arrays["t"], axis=0)
    status = RunStatus(code, time, arrays["q"][-1].copy() if samples else np.array(q0, dtype=float))
    how: dict[str, Any] = {"task": task, "options": options, "function": function}
    return Run(**arrays, status=status, arm=arm, path=path, scheme=scheme, **how)
