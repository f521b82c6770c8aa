"""Simulation of a whole motion."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._core import failed
from .._core import simulate as rollout
from ..arms import Arm
from ..errors import ResolutionError
from ..paths import Path
from ..schemes import Scheme
from .run import Run
from .run_status import RunStatus


def simulate(
    arm: Arm,
    path: Path,
    scheme: Scheme,
    q0: ArrayLike,
    *,
    dt: float = 1e-3,
    hold: float = 0.0,
    qd0: ArrayLike | None = None,
    task: str = "position",
    partial: bool = False,
) -> Run:
    """Move an arm along a path under a scheme, by RK4 at fixed steps.

    The path is a displacement from where the tip starts, f(q0). Velocity-level schemes integrate q, acceleration-level
    schemes q and qd. Runs without the interpreter's lock.

    Parameters
    ----------
    arm, path, scheme
        What moves, along what, and how.
    q0 : array_like, shape (n,)
        Joint positions at the start [rad].
    dt : float
        Step [s]; it must divide the path's duration and the hold.
    hold : float
        Time to stay at rest on the path's end afterwards [s].
    qd0 : array_like, shape (n,), optional
        Joint velocities at the start [rad/s], zero by default; velocity-level schemes do not read them.
    task : str
        'position', or 'pose' to track the tip's orientation as well.
    partial : bool
        If the motion must stop early, return what was done instead of raising.

    Returns
    -------
    Run
        The motion; run.status says how it ended.

    Raises
    ------
    ValueError
        If an argument is out of range, not finite, or of the wrong shape; nothing is run.
    ResolutionError
        If the motion must stop early; the exception's run holds the part before.
    """
    options = motion_options(arm, dt, hold, qd0)
    outcome = rollout(arm, path, scheme, q0, options["qd0"], dt, hold, task)
    run = make_run(*outcome, q0, arm, path, scheme, task, options)
    if failed(run.status.code) and not partial:
        raise ResolutionError(run.status.code, str(run.status), run)
    return run


def motion_options(arm: Arm, dt: float, hold: float, qd0: ArrayLike | None = None) -> dict[str, Any]:
    """The keyword arguments that every motion has, as its run keeps them."""
    start = np.zeros(arm.dof) if qd0 is None else np.array(qd0, dtype=float)
    return {"dt": float(dt), "hold": float(hold), "qd0": start.ravel().tolist()}


def make_run(
    code: Any,
    time: float,
    samples: int,
    arrays: tuple[Any, ...],
    q0: ArrayLike,
    arm: Arm,
    path: Path,
    scheme: Scheme,
    task: str,
    options: dict[str, Any],
) -> Run:
    """A run of what the compiled part gives: arrays of which the first `samples` rows are filled.

    The last two arrays, scale and saturated, are there only if the motion kept its joints' limits.
    """
    t, q, qd, qdd, x, x_ref, error, *limited = (
        array if samples == len(array) else array[:samples].copy() for array in arrays
    )
    if scheme.level == "velocity" and samples > 1 and not limited:
        qdd = np.gradient(qd, t, axis=0)
    status = RunStatus(code, time, q[-1].copy() if samples else np.array(q0, dtype=float))
    return Run(t, q, qd, qdd, x, x_ref, error, status, arm, path, scheme, task, options, *limited)
