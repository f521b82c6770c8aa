"""A finished motion and how it ended."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ._core import Status, advice, message

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ._core import Path, PlanarArm, Scheme

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RunStatus:
    """How a simulation ended: why, when, and where.

    Attributes
    ----------
    code : Status
        Status.OK when the whole motion is done; otherwise why it stopped.
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
        return self.code is Status.OK

    @property
    def advice(self) -> str:
        """What to do about it; empty when all is well."""
        return advice(self.code)

    def __bool__(self) -> bool:
        return self.ok

    def __str__(self) -> str:
        if self.ok:
            return f"complete, t = {self.time:g} s"
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
        Joint positions [rad], velocities [rad/s], accelerations [rad/s^2]. Velocity-level schemes give no
        accelerations: there qdd holds finite differences of qd.
    x, x_ref : numpy.ndarray, shape (N, 2)
        Where the tip is and where it is to be, in the base frame [m].
    error : numpy.ndarray, shape (N, 2)
        x_ref - x [m].
    status : RunStatus
        How it ended.
    arm, path, scheme
        What moved, along what, and how.
    """

    t: Array
    q: Array
    qd: Array
    qdd: Array
    x: Array
    x_ref: Array
    error: Array
    status: RunStatus
    arm: PlanarArm
    path: Path
    scheme: Scheme

    def max_error(self) -> float:
        """Largest distance of the tip from its reference [m]."""
        return float(np.linalg.norm(self.error, axis=1).max(initial=0.0))

    def plot(self) -> Figure:
        """Figure of the motion: arm snapshots, tip error, joint velocities and accelerations.

        Raises ImportError, with what to install, where matplotlib is missing.
        """
        from .plot import plot_run

        return plot_run(self)

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
