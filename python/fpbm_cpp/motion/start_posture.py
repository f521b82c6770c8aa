"""A posture from which an arm can follow a whole path."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .._core import Status
from .._types import Array
from ..arms import Arm
from ..bounds import Bound, bounds_of
from ..errors import require, wrong
from ..joints import JointLimits
from ..schemes import Scheme
from ..tasks import Stack
from .run import Run
from .run_data import Paths
from .simulation import require_motion, track
from .sweeping import sweep

FAILURES = 3  # Number of postures in StartPosture.fails_at.


class PathFailure(NamedTuple):
    """Where the motion from a start posture leaves the path."""

    q: Array  # Start posture [rad], or [m] for a prismatic joint, shape (n,).
    time: float  # First time at which the tip is farther from the path than the tolerance [s].
    status: Status  # Worst status of the whole motion.
    error: float  # Largest distance [m] or angle [rad] from the path in the whole motion.

    def __str__(self) -> str:
        reason = self.status.name.lower().replace("_", " ")
        return f"leaves the path at {self.time:.3f} s ({reason}); largest error {self.error:.3g} m"


class StartPosture(NamedTuple):
    """Result of start_posture().

    q and run are the posture and the whole motion from it, or None if no motion follows the whole path. In this case,
    fails_at has the time and the cause of the failure for the best postures.
    """

    q: Array | None
    run: Run | None
    fails_at: tuple[PathFailure, ...] = ()


def start_posture(
    arm: Arm,
    path: Paths,
    scheme: Scheme,
    *,
    x0: ArrayLike,
    start: ArrayLike | None = None,
    task: str = "position",
    stack: Stack | None = None,
    count: int = 64,
    tolerance: float = 1e-3,
    dt: float = 1e-3,
    limits: JointLimits | None = None,
    bounds: Sequence[Bound] = (),
    starts: int = 256,
    seed: int = 0,
) -> StartPosture:
    """Find a posture at the start of a path from which the arm follows the whole path within its limits and bounds.

    Up to `count` postures with the tip at x0 are found by inverse kinematics, and the motion from each is tracked along
    the whole path. Of the motions that stay on the path, the result is the motion with the lowest peak joint velocity.

    Parameters
    ----------
    arm, path, scheme, dt, limits, bounds
        As for track().
    x0 : array_like, shape (2,), (3,) or (4, 4)
        Point of the task at the start of the path [m].
    start : array_like, shape (n,), optional
        Posture near which the search begins; default: the middle of the ranges.
    task : str
        'position' or 'pose'.
    stack : Stack, optional
        Several tasks. x0 is then a dictionary of points by task name.
    count : int
        Largest number of postures that are tried.
    tolerance : float
        Largest distance [m] and angle [rad] from the path.
    starts, seed
        As for InverseKinematics.

    Raises
    ------
    ParameterError
        If an argument is out of range, or no posture has the tip at x0.
    """
    require_motion(arm, path, scheme)
    require("arm", arm, Arm, "an arm")
    kept = bounds_of(bounds)
    how: dict[str, Any] = {
        "task": task,
        "stack": stack,
        "limits": limits,
        "bounds": kept,
        "starts": starts,
        "seed": seed,
    }
    found = arm.inverse_all(x0, start, count, **how)
    if not found:
        away = f": no posture found; the nearest is {arm.inverse(x0, start, **how).error:.3g} m or rad away"
        raise wrong("x0", x0, f"{away}: must be a point that the arm reaches")
    q0s = np.array([posture.q for posture in found])
    options: dict[str, Any] = {"dt": dt, "task": None if stack else task, "stack": stack}
    options["limits"] = limits or arm.limits
    figures = sweep(arm, path, scheme, q0s, **options)
    errors = np.maximum(figures.max_error, figures.max_orientation_error)[0]
    failed: list[Run] = []
    for i in np.lexsort((figures.peak_velocity[0], errors > tolerance)):
        if errors[i] > tolerance and len(failed) >= FAILURES:
            break
        run = track(arm, path, scheme, q0s[i], bounds=kept, **options)
        if np.max(deviations(run)) <= tolerance:
            return StartPosture(q0s[i], run)
        failed.append(run)
    failed.sort(key=lambda run: float(np.max(deviations(run))))
    return StartPosture(None, None, tuple(failure(run, tolerance) for run in failed[:FAILURES]))


def deviations(run: Run) -> Array:
    """Distance [m], or angle [rad] if it is larger, from the path at each sample."""
    return np.maximum(*run.error_norms())


def failure(run: Run, tolerance: float) -> PathFailure:
    first = int(np.argmax(deviations(run) > tolerance))
    return PathFailure(run.q[0], float(run.t[first]), run.status.code, float(np.max(deviations(run))))
