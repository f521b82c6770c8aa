"""Simulation of a whole motion."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._core import Arm, Path, Scheme, Status, failed
from ._errors import ResolutionError
from ._types import Array
from .run import Run, RunStatus


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
        How long to stay at rest on the path's end afterwards [s].
    qd0 : array_like, shape (n,), optional
        Joint velocities at the start [rad/s], zero unless given; velocity-level schemes do not read them.
    task : str
        'position', or 'pose' to track the tip's orientation as well.
    partial : bool
        Where the motion must stop early, return the part that was done rather than raise.

    Returns
    -------
    Run
        The motion; run.status says how it ended.

    Raises
    ------
    ValueError
        Where an argument is out of range, not finite, or of the wrong shape; nothing is run.
    ResolutionError
        Where the motion must stop early; the exception's run holds the part before.
    """
    if qd0 is None:
        qd0 = np.zeros(arm.dof)
    code, time, samples, arrays = _core.simulate(arm, path, scheme, q0, qd0, dt, hold, task)
    options = {"dt": float(dt), "hold": float(hold), "qd0": np.array(qd0, dtype=float).ravel().tolist()}
    run = make_run(code, time, samples, arrays, q0, arm, path, scheme, task, options)
    if failed(code) and not partial:
        raise ResolutionError(code, str(run.status), run)
    return run


def make_run(
    code: Status,
    time: float,
    samples: int,
    arrays: tuple[Array, ...],
    q0: ArrayLike,
    arm: Arm,
    path: Path,
    scheme: Scheme,
    task: str,
    options: dict[str, Any],
) -> Run:
    """A run of what the compiled part gives: arrays of which the first `samples` rows are filled."""
    t, q, qd, qdd, x, x_ref, error = (array if samples == len(array) else array[:samples].copy() for array in arrays)
    if scheme.level == "velocity" and samples > 1:
        qdd = np.gradient(qd, t, axis=0)
    status = RunStatus(code, time, q[-1].copy() if samples else np.array(q0, dtype=float))
    return Run(t, q, qd, qdd, x, x_ref, error, status, arm, path, scheme, task, options)
