"""A finished motion and how it ended."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._core import PlanarArm, Status, advice, failed, message
from ._types import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ._core import Arm, Path, Scheme


@dataclass(frozen=True)
class RunStatus:
    """How a simulation ended: why, when, and where.

    Attributes
    ----------
    code : Status
        Status.OK, DAMPED or SLOWED when the whole motion is done; otherwise why it stopped.
    time : float
        Time of the last sample [s].
    q : numpy.ndarray, shape (n,)
        Joint positions there [rad].
    """

    code: Status
    time: float
    q: Array

    @property
    def ok(self) -> bool:
        """Whether the whole motion is done."""
        return not failed(self.code)

    @property
    def advice(self) -> str:
        """What to do about it; empty when all is well."""
        return advice(self.code)

    def __bool__(self) -> bool:
        return self.ok

    def __str__(self) -> str:
        if self.ok:
            remark = "" if self.code is Status.OK else f"; at times, {message(self.code)}. {self.advice}"
            return f"complete, t = {self.time:g} s{remark}"
        where = np.array2string(self.q, precision=4, separator=", ")
        return f"stopped after t = {self.time:g} s at q = {where}: {message(self.code)}. {self.advice}"


@dataclass(frozen=True, repr=False)
class Run:
    """A motion, one row per sample: N samples of n joints.

    Attributes
    ----------
    t : numpy.ndarray, shape (N,)
        Times [s].
    q, qd, qdd : numpy.ndarray, shape (N, n)
        Joint positions [rad], velocities [rad/s], accelerations [rad/s^2], with m for rad where a joint slides.
        Velocity-level schemes give no accelerations: there qdd holds finite differences of qd.
    x, x_ref : numpy.ndarray, shape (N, 2), (N, 3) or (N, 4, 4)
        Where the tip is and where it is to be, in the base frame [m]; poses are (x, y, angle) in the plane, homogeneous
        matrices in space.
    error : numpy.ndarray, shape (N, m)
        From x to x_ref: linear rows [m], then, for a pose, angular ones [rad] (in space, a rotation vector).
    status : RunStatus
        How it ended.
    arm, path, scheme, task
        What moved, along what, how, and as what task.
    options : dict
        The other keyword arguments that the motion was made with: dt, hold, qd0.
    scale : numpy.ndarray, shape (N,), or None
        Where the joints' limits were kept: how much of the task they left, 1 all of it, 0 where the arm braked.
    saturated : numpy.ndarray of bool, shape (N, n), or None
        Where the joints' limits were kept: which joints were on a bound.
    """

    t: Array
    q: Array
    qd: Array
    qdd: Array
    x: Array
    x_ref: Array
    error: Array
    status: RunStatus
    arm: Arm
    path: Path
    scheme: Scheme
    task: str = "position"
    options: dict[str, Any] = field(default_factory=dict)
    scale: Array | None = None
    saturated: NDArray[np.bool_] | None = None

    def max_error(self) -> float:
        """Largest distance of the tip from its reference [m]."""
        return float(np.linalg.norm(self.error[:, : self.positions.shape[1]], axis=1).max(initial=0.0))

    def max_turn_error(self) -> float:
        """Largest angle between the tip's orientation and its reference [rad]; 0 where the task leaves it free."""
        return float(np.linalg.norm(self.error[:, self.positions.shape[1] :], axis=1).max(initial=0.0))

    @property
    def positions(self) -> Array:
        """Where the tip is [m], shape (N, 2) or (N, 3): x without the orientation."""
        return _positions(self.x, self.arm)

    @property
    def reference_positions(self) -> Array:
        """Where the tip is to be [m], shape (N, 2) or (N, 3): x_ref without the orientation."""
        return _positions(self.x_ref, self.arm)

    def manipulability(self) -> Array:
        """sqrt(det(J J')) of the task, shape (N,): 0 where the posture is singular (Yoshikawa, 1985)."""
        J = np.array([self.arm.jacobian(q, task=self.task) for q in self.q])
        return np.sqrt(np.maximum(np.linalg.det(J @ J.transpose(0, 2, 1)), 0.0)) if len(J) else np.zeros(0)

    def plot(self) -> Figure:
        """Figure of the motion: arm snapshots, tip error, joint velocities and accelerations.

        Raises ImportError, with what to install, where matplotlib is missing.
        """
        from .plot import plot_run

        return plot_run(self)

    def view(self, *, urdf: str | os.PathLike[str] | None = None, **how: Any) -> None:
        """Show the motion in the browser until Ctrl-C; urdf, host, port and open_browser as for view().

        Raises ImportError, with what to install, where viser is missing.
        """
        from .viewer import Viewer

        Viewer.of(self, urdf=urdf, **{"open_browser": True, **how}).wait()

    def save(self, file: str | os.PathLike[str]) -> None:
        """Write all arrays, the status and a description of arm, path and scheme to an .npz file.

        numpy.load reads it back; a file of that name is replaced.
        """
        np.savez_compressed(
            file,
            **{name: getattr(self, name) for name in ("t", "q", "qd", "qdd", "x", "x_ref", "error")},
            status=str(self.status),
            arm=repr(self.arm),
            path=repr(self.path),
            scheme=repr(self.scheme),
        )

    def __repr__(self) -> str:
        return (
            f"<Run of {len(self.t)} samples: {self.scheme!r} on {self.arm!r} along {self.path!r}; "
            f"largest tip error {self.max_error():.3g} m; {self.status}>"
        )


def _positions(x: Array, arm: Arm) -> Array:
    """The positions among points of a task."""
    if x.ndim == 3:
        return x[:, :3, 3]
    return x[:, :2] if isinstance(arm, PlanarArm) else x
