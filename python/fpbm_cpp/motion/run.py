"""A finished motion, as data."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._types import Array
from ..arms import Arm, JointLimits
from ..paths import Path
from ..schemes import Scheme
from .conveniences import Conveniences
from .run_status import RunStatus

ARRAYS = ("t", "q", "qd", "qdd", "x", "x_ref", "error")
LIMITED = ("scale", "saturated")  # Of runs that kept the joints' limits.


@dataclass(frozen=True, repr=False, eq=False)
class Run(Conveniences):
    """A motion, one row per sample: N samples of n joints.

    Two runs are equal (==) if they are of the same things and all arrays are the same to the last bit.

    Attributes
    ----------
    t : numpy.ndarray, shape (N,)
        Times [s].
    q, qd, qdd : numpy.ndarray, shape (N, n)
        Joint positions [rad], velocities [rad/s], accelerations [rad/s^2]; m for rad where a joint is prismatic.
        Velocity-level schemes give no accelerations: there simulate() puts finite differences of qd. In a run of
        track(), qdd is the mean over the tick that begins at the sample.
    x, x_ref : numpy.ndarray, shape (N, 2), (N, 3) or (N, 4, 4)
        The tip and its reference in the base frame [m]. Poses are (x, y, angle) in the plane, homogeneous matrices in
        space.
    error : numpy.ndarray, shape (N, m)
        x_ref minus x: linear rows [m], then, for a pose, angular ones [rad] (in space, a rotation vector).
    status : RunStatus
        How the motion ended.
    arm, path, scheme, task
        What it was made of.
    options : dict
        The other keyword arguments that it was made with: dt, hold, qd0, and those of track().
    scale : numpy.ndarray, shape (N,), or None
        Of track() alone: the share of the task that the limits left, from 0 (the arm braked) to 1 (all of it).
    saturated : numpy.ndarray of bool, shape (N, n), or None
        Of track() alone: which joints were on a bound.
    provenance : dict
        Of a run from a file: when, where and by which versions it was made, with the note and seed saved with it.
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
    provenance: dict[str, Any] = field(default_factory=dict)

    def max_error(self) -> float:
        """Largest distance of the tip from its reference [m]."""
        return float(np.linalg.norm(self.position_error, axis=1).max(initial=0.0))

    def max_orientation_error(self) -> float:
        """Largest angle between the tip's orientation and its reference [rad]; 0 where the task leaves it free."""
        return float(np.linalg.norm(self.orientation_error, axis=1).max(initial=0.0))

    @property
    def position_error(self) -> Array:
        """Linear rows of the error [m], shape (N, 2) or (N, 3)."""
        return self.error[:, : self.positions.shape[1]]

    @property
    def orientation_error(self) -> Array:
        """Angular rows of the error [rad], shape (N, 1) or (N, 3); (N, 0) for a task of position."""
        return self.error[:, self.positions.shape[1] :]

    @property
    def positions(self) -> Array:
        """Positions of the tip [m], shape (N, 2) or (N, 3): x without the orientation."""
        return self._positions(self.x)

    @property
    def reference_positions(self) -> Array:
        """Positions of the reference [m], shape (N, 2) or (N, 3): x_ref without the orientation."""
        return self._positions(self.x_ref)

    def _positions(self, x: Array) -> Array:
        if x.ndim == 3:
            return x[:, :3, 3]
        return x[:, :2] if self.task == "pose" else x

    @property
    def limits(self) -> JointLimits:
        """The joints' limits that track() was given; otherwise the arm's own."""
        given: JointLimits | None = self.options.get("limits")
        return self.arm.limits if given is None else given

    def manipulability(self) -> Array:
        """sqrt(det(J J')) of the task, shape (N,): 0 where the posture is singular (Yoshikawa, 1985)."""
        J = np.array([self.arm.jacobian(q, task=self.task) for q in self.q])
        return np.sqrt(np.maximum(np.linalg.det(J @ J.transpose(0, 2, 1)), 0.0)) if len(J) else np.zeros(0)

    def arrays(self) -> dict[str, Any]:
        """All arrays by name; scale and saturated only where the limits were kept."""
        arrays = {name: getattr(self, name) for name in (*ARRAYS, *LIMITED)}
        return {name: np.asarray(array) for name, array in arrays.items() if array is not None}

    def _things(self) -> tuple[Any, ...]:
        """All but the arrays, to be compared."""
        status = self.status.code, self.status.time, self.status.q.tobytes()
        return self.arm, self.path, self.scheme, self.task, self.options, status

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Run):
            return NotImplemented
        here, there = self.arrays(), other.arrays()
        return (
            here.keys() == there.keys()
            and self._things() == other._things()
            and all(
                (one.shape, one.dtype, one.tobytes()) == (there[name].shape, there[name].dtype, there[name].tobytes())
                for name, one in here.items()
            )
        )

    def __repr__(self) -> str:
        return (
            f"<Run of {len(self.t)} samples: {self.scheme!r} on {self.arm} along {self.path!r}; "
            f"largest tip error {self.max_error():.3g} m; {self.status}>"
        )
