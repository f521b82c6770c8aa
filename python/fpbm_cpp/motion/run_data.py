"""A finished motion as data."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._core import Status, advice, failed, message
from .._types import Array
from ..arms import Arm
from ..bounds import largest_torques
from ..joints import JointLimits
from ..paths import Path
from ..robots import Robot
from ..schemes import Scheme
from ..skeleton import joint_labels, task_frames, task_jacobians
from ..tasks import FrameTask, PoseTask, PositionTask, Stack

Paths: TypeAlias = Path | Mapping[str, Path]  # Path of one task, or paths of several tasks by name.
ARRAYS = ("t", "q", "qd", "qdd", "x", "x_ref", "error")
LIMITED = ("scale", "saturated", "clearance")  # Arrays of runs within joint limits, or with a clearance.
OF_STACKS = ("scales", "task_errors")


ON_BOUND = 0.99  # Ratio to a bound above which a joint counts as on the bound.
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
class RunData:
    """The data of a Run."""

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
    function: Callable[..., Any] | None = None

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
    def q0(self) -> Array:
        """Joint positions at the start [rad], shape (n,)."""
        return np.asarray(self.q[0]) if len(self.q) else self.status.q

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

    @property
    def torque(self) -> Array | None:
        """Torques of inverse dynamics for q, qd and qdd, without dry friction, shape (N, n) [Nm], [N] for a prismatic
        joint. None if the torques of the arm are not known: arm.bias() then raises an error with the cause.
        """
        return self.arm.inverse_dynamics(self.q, self.qd, self.qdd) if self.arm.has_dynamics else None

    @property
    def largest_torques(self) -> Array:
        """Bounds on run.torque [Nm], shape (n,): of TorqueBounds, or the efforts in run.limits, minus the dry friction;
        infinite without a bound.
        """
        return largest_torques(self.arm, self.limits, self.options.get("bounds") or ())

    def bound_ratios(self) -> dict[str, Array]:
        """Ratios of the velocity, acceleration and jerk of each joint to their bounds in run.limits, shape (N, n) each.

        If the torques of the arm are known, also the ratios of run.torque to run.largest_torques, as "torque".

        The jerk of a sample is the difference to the acceleration of the next sample; 0 at the last sample. Without a
        bound, a ratio is 0.
        """
        limits = self.limits
        steps = np.diff(self.t)[:, None]
        jerk = np.zeros_like(self.qdd)
        jerk[:-1] = np.diff(self.qdd, axis=0) / steps
        motions = {"velocity": self.qd, "acceleration": self.qdd, "jerk": jerk}
        ratios = {name: np.abs(motion) / getattr(limits, name) for name, motion in motions.items()}
        torque = self.torque
        return ratios if torque is None else {**ratios, "torque": np.abs(torque) / self.largest_torques}

    @property
    def bottleneck(self) -> NDArray[np.str_]:
        """The bound that limits the motion at each sample, shape (N,), for example 'torque of panda_joint2'; '' if no
        velocity, acceleration, jerk or torque is within 1 % of its bound, or beyond.
        """
        ratios = self.bound_ratios()
        names = np.array([f"{kind} of {joint}" for kind in ratios for joint in joint_labels(self.arm)])
        table = np.concatenate(list(ratios.values()), axis=1)
        return np.where(table.max(axis=1) > ON_BOUND, names[table.argmax(axis=1)], "")

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

    def __eq__(self, other: object) -> bool:
        return isinstance(other, RunData) and self._key() == other._key()

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
