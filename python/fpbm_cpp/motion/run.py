"""A finished motion as data, with methods for figures, the viewer and files."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._core import Status, advice, failed, message
from .._types import Array
from ..arms import Arm, JointLimits
from ..paths import Path
from ..robots import Robot
from ..schemes import Scheme
from ..shown import html_table, number
from ..skeleton import task_frames
from ..tasks import FrameTask, PoseTask, PositionTask, Stack
from .task_frames import task_jacobians

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

Paths: TypeAlias = Path | Mapping[str, Path]  # Path of one task, or paths of several tasks by name.
ARRAYS = ("t", "q", "qd", "qdd", "x", "x_ref", "error")
LIMITED = ("scale", "saturated", "clearance")  # Arrays of runs within joint limits, or with a clearance.
OF_STACKS = ("scales", "task_errors")


LONGEST = 200  # Characters of a scheme or a path in the HTML form of a run.
ON_PATH = 1e-3  # Largest distance of the tip from its path in a complete motion [m].
SHRINK = "Make the path smaller, or choose another start posture q0"
REMEDIES = {
    Status.OK: "Give the scheme larger gains (k1 and k2, or k), or shorten dt.",
    Status.COARSE: "Shorten dt.",
    Status.DAMPED: f"{SHRINK}, so that the path avoids singular postures.",
    Status.SLOWED: f"Increase the duration to slow the path. {SHRINK}.",
    Status.BLOCKED: "Move the path away from the nearest shape or task bound.",
    Status.RECOVERING: f"{SHRINK}, so that the path is in the workspace.",
    Status.STALLED: f"{SHRINK}, so that the path is in the workspace.",
}


@dataclass(frozen=True)
class RunStatus:
    """End of a motion: status code, time of the last sample [s], and joint positions q [rad], shape (n,).

    If the motion ends at the end of its time, the code is OK, COARSE, DAMPED, SLOWED, BLOCKED or STALLED, and the
    status is true. distance is the largest distance of the tip from its path [m].
    """

    code: Status
    time: float
    q: Array
    distance: float = 0.0

    @property
    def ok(self) -> bool:
        """Whether the motion ends at the end of its time."""
        return not failed(self.code)

    @property
    def left_path(self) -> bool:
        """Whether the tip was farther than 1 mm from its path."""
        return self.distance > ON_PATH

    @property
    def advice(self) -> str:
        """What to do; empty if the code is OK and the tip did not leave its path."""
        return REMEDIES.get(self.code, advice(self.code)) if self.ok and self.left_path else advice(self.code)

    def __bool__(self) -> bool:
        return self.ok

    def __str__(self) -> str:
        if self.ok and self.left_path:
            cause = f": at times, {message(self.code)}" if self.code is not Status.OK else ""
            off = f"the tip was up to {self.distance:.3g} m from its path{cause}. {self.advice}"
            return f"ended, t = {self.time:g} s; {off}"
        if self.ok:
            remark = "" if self.code is Status.OK else f"; at times, {message(self.code)}. {self.advice}"
            return f"complete, t = {self.time:g} s{remark}"
        where = np.array2string(self.q, precision=4, separator=", ")
        return f"stopped after t = {self.time:g} s at q = {where}: {message(self.code)}. {self.advice}"


@dataclass(frozen=True, repr=False, eq=False)
class Run:
    """A motion, one row per sample: N samples of n joints.

    Two runs are equal (==) if arm, path, scheme, task, options and status are equal, and all arrays to the last bit.

    Attributes
    ----------
    t : numpy.ndarray, shape (N,)
        Times [s].
    q, qd, qdd : numpy.ndarray, shape (N, n)
        Joint positions [rad], velocities [rad/s], accelerations [rad/s^2]; for a prismatic joint, read m instead of
        rad. qdd of track() is the mean over the tick that starts at the sample. qdd of simulate() at velocity level is
        from finite differences.
    x, x_ref : numpy.ndarray, shape (N, 2), (N, 3) or (N, 4, 4)
        The tip and its reference in the base frame [m]; for a stack, the point of the task that follows the path. Poses
        are (x, y, angle) in the plane, homogeneous matrices in space.
    error : numpy.ndarray, shape (N, m)
        x_ref minus x: linear rows [m], then, for a pose, angular rows [rad] (in space, a rotation vector).
    status, arm, path, scheme, task, options
        End of the motion, and the arguments that produced it; options are the other keyword arguments: dt, hold, stack,
        ... task is 'position' or 'pose'; for a stack, the name of the task of x, x_ref and error.
    scale, saturated : numpy.ndarray, shapes (N,) and (N, n), or None
        Of track() only: the task scale, from 0 (the arm brakes) to 1 (the whole task), and which joints are on a bound.
    clearance : numpy.ndarray, shape (N,), or None
        Of track() with a clearance: distance between the two nearest shapes [m].
    scales : numpy.ndarray, shape (N, levels), or None
        Of a stack: the task scale of each level, from 0 to 1.
    task_errors : numpy.ndarray, shape (N, ...), or None
        Of a stack: the arrays in `errors`, one task after another.
    provenance : dict
        Of a run from a file: date, machine and versions that produced the run, with its note and seed.
    """

    t: Array
    q: Array
    qd: Array
    qdd: Array
    x: Array
    x_ref: Array
    error: Array
    status: RunStatus
    arm: Arm | Robot
    path: Paths
    scheme: Scheme
    task: str = "position"
    options: dict[str, Any] = field(default_factory=dict)
    scale: Array | None = None
    saturated: NDArray[np.bool_] | None = None
    clearance: Array | None = None
    scales: Array | None = None
    task_errors: Array | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "status", replace(self.status, distance=self.max_error()))

    def max_error(self) -> float:
        """Largest distance of the tip from its reference [m]."""
        return float(self.error_norms()[0].max(initial=0.0))

    def max_orientation_error(self) -> float:
        """Largest angle between the tip's orientation and its reference [rad]; 0 if the orientation is free."""
        return float(self.error_norms()[1].max(initial=0.0))

    def error_norms(self) -> tuple[Array, Array]:
        """Distance of the tip from its reference [m] and angle between their orientations [rad], shape (N,) each."""
        return np.linalg.norm(self.position_error, axis=1), np.linalg.norm(self.orientation_error, axis=1)

    @property
    def position_error(self) -> Array:
        """Linear rows of the error [m], shape (N, 2) or (N, 3)."""
        return self.error[:, : self.positions.shape[1]]

    @property
    def orientation_error(self) -> Array:
        """Angular rows of the error [rad], shape (N, 1) or (N, 3); (N, 0) for a position task."""
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
        return x[:, :2] if self.kind == "pose" else x

    @property
    def stack(self) -> Stack | None:
        """The stack of tasks, or None."""
        return self.options.get("stack")

    @property
    def kind(self) -> str:
        """Kind of the task that follows the path: 'position' or 'pose'."""
        if self.stack is None:
            return self.task
        return "pose" if isinstance(self.path_task, PoseTask) else "position"

    @property
    def paths(self) -> dict[str, Path]:
        """The paths by task name; the first path belongs to the task of x, x_ref and error."""
        given = self.path if isinstance(self.path, Mapping) else {self.task: self.path}
        return {self.task: given[self.task], **given}

    @property
    def path_task(self) -> FrameTask:
        """The task of x, x_ref and error."""
        return PositionTask() if self.stack is None else self.stack.follower(self.task)

    @property
    def tips(self) -> list[FrameTask]:
        """The frames that are drawn as tips: the tip of an arm; the frames of tasks with paths of a Robot."""
        if not isinstance(self.arm, Robot) or self.stack is None:
            return [PositionTask()]
        return [self.stack.follower(name) for name in self.paths]

    @property
    def frames(self) -> dict[str, Array]:
        """For a stack: the frame of each frame task by name, in the base frame [m], shape (N, 4, 4); else empty."""
        tasks = self.stack.tasks if self.stack is not None else ()
        return {task.name: task_frames(self.arm, self.q, task) for task in tasks if isinstance(task, FrameTask)}

    @property
    def errors(self) -> dict[str, Array]:
        """For a stack: the error of each task by name [m, rad], one row per sample, as tick.errors; otherwise empty."""
        if self.stack is None or self.task_errors is None:
            return {}
        sizes = self.stack.error_sizes(self.arm.dof)
        parts = np.split(self.task_errors, np.cumsum(sizes)[:-1], axis=1)
        return {task.name: part for task, part in zip(self.stack.tasks, parts)}

    @property
    def limits(self) -> JointLimits:
        """The joint limits given to track(); otherwise the limits of the arm."""
        return self.options.get("limits") or self.arm.limits

    def manipulability(self) -> Array:
        """sqrt(det(J J')) of the tip, shape (N,): 0 in a singular posture (Yoshikawa, 1985).

        For a Robot, J has the rows of all tasks that follow a path.
        """
        J = self.jacobians()
        return np.asarray(np.sqrt(np.maximum(np.linalg.det(J @ J.transpose(0, 2, 1)), 0.0)))

    def jacobians(self) -> Array:
        """Jacobian of the tip at each sample, shape (N, m, n); for a Robot, of all tasks that follow a path."""
        arm = self.arm
        if isinstance(arm, Robot):
            return np.concatenate([task_jacobians(arm, self.q, task) for task in self.tips], axis=1)
        return np.array([arm.jacobian(q, task=self.kind) for q in self.q]).reshape(-1, self.error.shape[1], arm.dof)

    def arrays(self) -> dict[str, Any]:
        """All arrays by name; the arrays of limits, a clearance and a stack only if the run has them."""
        arrays = {name: getattr(self, name) for name in (*ARRAYS, *LIMITED, *OF_STACKS)}
        return {name: np.asarray(array) for name, array in arrays.items() if array is not None}

    def plot(self, *, panels: str | Sequence[str] | None = None, dark: bool = False, bounds: bool = False) -> Figure:
        """Figure of the motion on one page: arm snapshots, tip error, joints, limits, manipulability.

        A notebook shows the figure. panels: names of other panels, from fpbm_cpp.plot.panels.PANELS. dark: dark
        background. bounds: whether all finite bounds of the joints are shown. Needs matplotlib.
        """
        from ..plot import plot_run

        return plot_run(self, panels=panels, dark=dark, bounds=bounds)

    def view(self, *, urdf: str | os.PathLike[str] | None = None, **how: Any) -> None:
        """Show the motion in the browser until Ctrl-C; urdf, host, port, open_browser and errors as for view()."""
        from ..viewer import Viewer

        Viewer(self, urdf=urdf, **{"open_browser": True, **how}).wait()

    def replay(self) -> Run:
        """Repeat the motion: equal to the last bit with the same build on the same kind of processor.

        Raises ValueError if the options do not hold the arguments of the run.
        """
        from .simulation import simulate, track

        if "dt" not in self.options:
            demand = "must have the arguments of simulate() or track(): make the run with one of these functions"
            raise ValueError(f"options = {self.options}: {demand}")
        q0 = self.q[0] if len(self.q) else self.status.q
        if "error_bound" in self.options:
            return track(self.arm, self.path, self.scheme, q0, task=self.task, **self.options)
        return simulate(self.arm, self.path, self.scheme, q0, task=self.task, partial=True, **self.options)

    def save(
        self, file: str | os.PathLike[str], *, note: str | None = None, seed: int | Sequence[int] | None = None
    ) -> None:
        """Write the run to an .npz file, for fp.load. An existing file is replaced, completely or not at all.

        numpy.load reads the arrays. All other data are JSON text in 'meta'; nothing is pickled. The provenance contains
        the note, any text, and the seed of the run's random numbers.
        """
        from ..io.run_file import save

        save(self, file, note, seed)

    def to_pandas(self) -> pd.DataFrame:
        """Data frame with a row for each sample, and units in frame.attrs["units"]. Needs the extra 'data'.

        Columns t, q_<joint>, qd_<joint>, qdd_<joint>, x, y, z with qx, qy, qz, qw or angle, x_ref and so on, error_x
        and so on, orientation_error_x and so on; scale and saturated_<joint> within limits, and clearance.
        """
        from ..io.tables import to_pandas

        return to_pandas(self)

    def to_csv(self, file: str | os.PathLike[str]) -> None:
        """Write the columns of to_pandas() as CSV, with headings like 'qd_joint_1 [rad/s]'. Needs no extra.

        Numbers read back are equal to the last bit. An existing file is replaced, completely or not at all.
        """
        from ..io.tables import to_csv

        to_csv(self, file)

    def to_xarray(self) -> xr.Dataset:
        """Dataset over time, joint and axis, with units as attributes. Needs the extra 'data'.

        Variables q, qd, qdd, x, x_ref, error; for a pose, orientation (a quaternion) or angle, orientation_ref
        or angle_ref, and orientation_error; scale and saturated within limits, and clearance.
        """
        from ..io.tables import to_xarray

        return to_xarray(self)

    def to_rosbag(
        self, directory: str | os.PathLike[str], *, frame: str = "base_link", trajectory: bool = False
    ) -> None:
        """Write a ROS 2 bag, completely or not at all, with the run's times as stamps.

        Needs the extra 'ros', but no ROS installation. The topics are /joint_states, /tip and /tip_reference
        (JointState, PoseStamped), in the base frame, named `frame`; with trajectory, also /joint_trajectory with one
        message. If the task leaves the orientation free, /tip has the arm's orientation, and /tip_reference has the
        identity. Raises FileExistsError if the directory exists.
        """
        from ..io.rosbag import to_rosbag

        to_rosbag(self, directory, frame, trajectory)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Run) and self._key() == other._key()

    def _key(self) -> tuple[Any, ...]:
        """Key for comparisons."""
        arrays = {name: (array.shape, array.dtype, array.tobytes()) for name, array in self.arrays().items()}
        status = self.status.code, self.status.time, self.status.q.tobytes()
        return self.arm, self.path, self.scheme, self.task, self.options, status, arrays

    def __repr__(self) -> str:
        return (
            f"<Run of {len(self.t)} samples: {self.scheme!r} on {self.arm} along {self.path!r}; "
            f"largest tip error {self.max_error():.3g} m; {self.status}>"
        )

    def _repr_html_(self) -> str:
        rows: list[list[object]] = [
            ["scheme", _brief(self.scheme)],
            ["arm", str(self.arm)],
            ["path", _brief(self.path)],
            ["samples", len(self.t)],
            ["largest tip error", f"{number(self.max_error())} m"],
            ["status", str(self.status)],
        ]
        return html_table("Run", ["", ""], rows)


def _brief(value: object) -> str:
    text = repr(value)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]} …"
