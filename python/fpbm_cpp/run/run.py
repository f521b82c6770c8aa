"""A finished motion."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._core import PlanarArm
from .._types import Array
from .status import RunStatus

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

    from .._core import Arm, Path, Scheme


@dataclass(frozen=True, repr=False, eq=False)
class Run:
    """A motion, one row per sample: N samples of n joints.

    PlainPair runs are equal (==) where they are of the same things and all arrays are the same to the last bit.

    Attributes
    ----------
    t : numpy.ndarray, shape (N,)
        Times [s].
    q, qd, qdd : numpy.ndarray, shape (N, n)
        Joint positions [rad], velocities [rad/s], accelerations [rad/s^2], with m for rad where a joint slides.
        Velocity-level schemes give no accelerations: there qdd holds finite differences of qd. In a run of track() it
        is the mean of the tick that begins at the sample.
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
        The other keyword arguments that the motion was made with: dt, hold, qd0, and those of track().
    scale : numpy.ndarray, shape (N,), or None
        Where the joints' limits were kept: how much of the task they left, 1 all of it, 0 where the arm braked.
    saturated : numpy.ndarray of bool, shape (N, n), or None
        Where the joints' limits were kept: which joints were on a bound.
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
        return float(np.linalg.norm(self.error[:, : self.positions.shape[1]], axis=1).max(initial=0.0))

    def max_orientation_error(self) -> float:
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

    def plot(self, *, panels: Sequence[str] | None = None, dark: bool = False) -> Figure:
        """Figure of the motion on one page: arm snapshots, tip error, joints, limits, manipulability.

        panels are the names of those wanted instead, from fpbm_cpp.plot.PANELS; dark draws on black. Raises ValueError
        for a name that is not there, and ImportError, with what to install, where matplotlib is missing.
        """
        from ..plot import plot_run

        return plot_run(self, panels=panels, dark=dark)

    def view(self, *, urdf: str | os.PathLike[str] | None = None, **how: Any) -> None:
        """Show the motion in the browser until Ctrl-C; urdf, host, port and open_browser as for view().

        Raises ImportError, with what to install, where viser is missing.
        """
        from ..viewer import Viewer

        Viewer.of(self, urdf=urdf, **{"open_browser": True, **how}).wait()

    def replay(self) -> Run:
        """The motion made again from arm, path, scheme and options.

        Equal to this run to the last bit in the same build on a processor of the same kind; another compiler,
        C library or kind of processor may round differently.

        Raises ValueError where the options do not say how it was made.
        """
        from .replay import replay

        return replay(self)

    def save(
        self, file: str | os.PathLike[str], *, note: str | None = None, seed: int | Sequence[int] | None = None
    ) -> None:
        """Write all of it to an .npz file, for fp.load; a file of that name is replaced, whole or not at all.

        The arrays are there for numpy.load as well; arm, path, scheme, options, status and provenance are the JSON
        text 'meta'. Nothing is pickled.

        Parameters
        ----------
        file : path
            The file.
        note : str, optional
            Whatever is worth knowing, kept in the provenance.
        seed : int or sequence of int, optional
            What the random numbers behind the run came from, kept there too.
        """
        from .file import save

        save(self, file, note, seed)

    def to_pandas(self) -> pd.DataFrame:
        """Data frame of a row for each sample.

        Columns t, q_<joint>, qd_<joint>, qdd_<joint>, the tip as x, y, z with qx, qy, qz, qw or angle for its
        orientation, the same of its reference as x_ref and so on, error_x and so on, turn_error_x and so on; scale and
        saturated_<joint> where the limits were kept. Their units are in frame.attrs["units"]. Needs the extra 'data'.
        """
        from .tables import to_pandas

        return to_pandas(self)

    def to_csv(self, file: str | os.PathLike[str]) -> None:
        """Write the columns of to_pandas() as CSV, headed like 'qd_joint_1 [rad/s]'; it needs no extra.

        Numbers are exact: read back, they are the same to the last bit. A file of that name is replaced, whole or not
        at all.
        """
        from .tables import to_csv

        to_csv(self, file)

    def to_xarray(self) -> xr.Dataset:
        """Dataset over time, joint and axis, with units as attributes.

        Variables q, qd, qdd, x, x_ref, error; in a pose orientation (a quaternion) or angle, the same with _ref, and
        orientation_error; scale and saturated where the limits were kept. Needs the extra 'data'.
        """
        from .xarray import to_xarray

        return to_xarray(self)

    def to_rosbag(
        self, directory: str | os.PathLike[str], *, frame: str = "base_link", trajectory: bool = False
    ) -> None:
        """Write a ROS 2 bag: the joints, the tip and its reference, stamped with the run's time from 0.

        Topics /joint_states (sensor_msgs/JointState), /tip and /tip_reference (geometry_msgs/PoseStamped). Where the
        task leaves the orientation free, the tip's is the arm's and the reference has none (the identity). Needs the
        extra 'ros', but no ROS.

        Parameters
        ----------
        directory : path
            The bag, written whole or not at all.
        frame : str
            Name of the base frame.
        trajectory : bool
            All of it in one message on /joint_trajectory as well (trajectory_msgs/JointTrajectory).

        Raises
        ------
        FileExistsError
            Where there is something of that name.
        ImportError
            Where the extra is missing.
        """
        from .rosbag import to_rosbag

        to_rosbag(self, directory, frame, trajectory)

    def __eq__(self, other: object) -> bool:
        from .file import same

        return same(self, other) if isinstance(other, Run) else NotImplemented

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
