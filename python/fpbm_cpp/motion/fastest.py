"""A motion that keeps its path and takes the least time within the limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._core import advice, failed, message
from .._core import fastest as core_fastest
from ..arms import Arm
from ..bounds import Bound, bounds_of
from ..errors import wrong
from ..joints import JointLimits, limits_of
from ..paths import AtSpeed, InPlane, Path, Waypoints, WithRotation
from ..paths import Sequence as PathSequence
from ..robots import Robot
from ..schemes import Scheme
from ..tasks import Stack
from .run import Run
from .run_data import Paths
from .simulation import make_run, require_motion, task_and_paths

INTERVALS = 600  # The tip is within 1e-9 m of most paths.
MOST_INTERVALS = 9600
ON_BOUND = 0.99  # Ratio to a bound above which a joint counts as on the bound.
ON_PATH = 1e-7  # With a larger distance from the path [m, rad], the number of intervals is doubled.


def fastest(
    arm: Arm | Robot,
    path: Paths,
    scheme: Scheme,
    q0: ArrayLike,
    *,
    dt: float = 1e-3,
    task: str | None = None,
    stack: Stack | None = None,
    limits: JointLimits | None = None,
    tip_speed: float | None = None,
    tip_acceleration: float | None = None,
    bounds: Sequence[Bound] = (),
) -> Run:
    """Move an arm along a path in the least time within its limits; the tip stays on the path.

    The scheme gives the joint positions along the whole path. The clock of the path then minimises the duration within
    the bounds on velocity, acceleration and jerk of all joints, from rest to rest (docs: Paths in the least time). The
    durations and time laws of shapes have no effect: only the geometry counts. Between the parts of a Sequence, the
    arm stops. run.saturated and run.bound_ratios() show which bounds limit the motion.

    Parameters
    ----------
    arm, path, q0, dt, task, stack
        As for simulate(). The motion lasts a multiple of dt.
    scheme
        A scheme at velocity level.
    limits : JointLimits, optional
        Limits of the joints, by default the arm's; each joint needs a bound on its acceleration.
    tip_speed, tip_acceleration : float, optional
        Bounds on the tip; for a stack, on the frame of the task of x [m/s, m/s^2].
    bounds : sequence of Clearance and TaskBounds, optional
        Bounds that the motion must keep. The scheme does not avoid them.

    Raises
    ------
    ParameterError
        If an argument is out of range, or the scheme cannot follow the path within the ranges of the joints and within
        the bounds. The message says at which fraction of the path.
    """
    require_motion(arm, path, scheme)
    if scheme.level != "velocity":
        raise wrong(
            "scheme", scheme, f" = {scheme!r:.80}: must be at velocity level, for example MVN() or WMVN(weights)"
        )
    name, kind, followed, tasks = task_and_paths(_smooth_all(path), task, stack)
    options: dict[str, Any] = {
        "dt": float(dt),
        "limits": limits_of(arm, limits),
        "tip_speed": tip_speed,
        "tip_acceleration": tip_acceleration,
        "bounds": bounds_of(bounds),
        "stack": stack,
    }
    intervals = INTERVALS
    while True:
        most = inf if tip_speed is None else tip_speed, inf if tip_acceleration is None else tip_acceleration
        outcome = core_fastest(
            arm, followed, scheme, q0, dt, intervals, kind, options["limits"], *most, options["bounds"], tasks
        )
        code, fraction, _, arrays = outcome
        if failed(code):
            where = np.array2string(arrays["q"], precision=4, separator=", ")
            raise wrong(
                "path",
                path,
                f": can be followed to the fraction {fraction:.3f} only, q = {where}: {message(code)}. {advice(code)}",
            )
        run = make_run(outcome, q0, arm, path, scheme, name, options, fastest)
        if np.abs(run.error).max() < ON_PATH or intervals >= MOST_INTERVALS:
            ratios = run.bound_ratios()
            return replace(run, saturated=np.max(list(ratios.values()), axis=0) > ON_BOUND)
        intervals *= 2


def _smooth_all(path: Paths) -> Paths:
    return smooth(path) if isinstance(path, Path) else {name: smooth(each) for name, each in path.items()}


def smooth(path: Path) -> Path:
    """The path with time laws that begin and end with zero velocity and acceleration; the geometry is equal."""
    if isinstance(path, PathSequence):
        return replace(path, paths=tuple(smooth(each) for each in path.paths))
    if isinstance(path, InPlane):
        return replace(path, path=smooth(path.path))
    if isinstance(path, WithRotation):
        return replace(path, path=smooth(path.path), time_law="quintic")
    if isinstance(path, AtSpeed):
        return smooth(path.path)
    return path if isinstance(path, Waypoints) else replace(path, time_law="quintic")  # type: ignore[type-var]
