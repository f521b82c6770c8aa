"""Runs as ROS 2 bags."""

import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from .._types import Array
from ..arms import PlanarArm
from ..errors import extra
from ..skeleton import task_frames
from .run_data import RunData
from .tables import quaternions


def to_rosbag(
    run: RunData, directory: str | os.PathLike[str], *, frame: str = "base_link", trajectory: bool = False
) -> None:
    """Write a ROS 2 bag, completely or not at all, with the run's times as stamps.

    Needs the extra 'ros', but no ROS installation. The topics are /joint_states, /tip and /tip_reference
    (JointState, PoseStamped), in the base frame, named `frame`; with trajectory, also /joint_trajectory with one
    message. The efforts are run.torque if torques are known. If the task leaves the orientation free, /tip has the
    arm's orientation, and /tip_reference has the identity. Raises FileExistsError if the directory exists.
    """
    rosbag2, typesys = (extra(f"rosbags.{part}", "to_rosbag", "ros") for part in ("rosbag2", "typesys"))
    if not len(run.t):
        raise ValueError("run: has no samples: must have at least one: run.status has the cause")
    target = Path(directory)
    if target.exists() or target.is_symlink():
        raise FileExistsError(f"{target}: exists already: give a new directory, a bag does not replace files")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    # The files of a bag have the name of the bag: only the name of the parent folder can mark an unfinished bag.
    part = Path(tempfile.mkdtemp(prefix=f".{target.name}.", suffix=".part", dir=target.absolute().parent))
    try:
        # ROS 2 Humble cannot parse the QoS profiles of version 9; later releases read both versions.
        with rosbag2.Writer(part / target.name, version=8) as writer:
            topics: dict[str, Any] = {}
            for topic, time, message in _messages(run, store.types, frame, trajectory):
                kind = message.__msgtype__
                if topic not in topics:
                    topics[topic] = writer.add_connection(topic, kind, typestore=store)
                writer.write(topics[topic], time, store.serialize_cdr(message, kind))
        (part / target.name).rename(target)
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _messages(run: RunData, types: Any, frame: str, trajectory: bool) -> Iterator[tuple[str, int, Any]]:
    """Topic, time [ns] and message of all messages of a run, in order of time."""

    def clock(kind: str, t: int) -> Any:
        return types[f"builtin_interfaces/msg/{kind}"](*divmod(t, 10**9))

    def header(t: int) -> Any:
        return types["std_msgs/msg/Header"](clock("Time", t), frame)

    def pose(t: int, position: Array, quaternion: Array) -> Any:
        place = types["geometry_msgs/msg/Point"](*position.tolist())
        turn = types["geometry_msgs/msg/Quaternion"](*quaternion.tolist())
        return types["geometry_msgs/msg/PoseStamped"](header(t), types["geometry_msgs/msg/Pose"](place, turn))

    joints, times = run.arm.joint_names, np.rint(run.t * 1e9).astype(np.int64).tolist()
    torque = run.torque
    efforts = np.zeros((len(times), 0)) if torque is None else torque
    if trajectory:
        point = types["trajectory_msgs/msg/JointTrajectoryPoint"]
        rows = zip(run.q, run.qd, run.qdd, efforts, times)
        points = [point(q, qd, qdd, effort, clock("Duration", t)) for q, qd, qdd, effort, t in rows]
        yield "/joint_trajectory", 0, types["trajectory_msgs/msg/JointTrajectory"](header(0), joints, points)
    tips = zip(*_poses(run, run.x), *_poses(run, run.x_ref, reference=True))
    for t, q, qd, effort, (p, r, p_ref, r_ref) in zip(times, run.q, run.qd, efforts, tips):
        yield "/joint_states", t, types["sensor_msgs/msg/JointState"](header(t), joints, q, qd, effort)
        yield "/tip", t, pose(t, p, r)
        yield "/tip_reference", t, pose(t, p_ref, r_ref)


def _poses(run: RunData, x: Array, reference: bool = False) -> tuple[Array, Array]:
    """Positions in space, and quaternions; for a position task, the arm's orientation, or the reference's identity."""
    if x.ndim == 3:
        return x[:, :3, 3], quaternions(x[:, :3, :3])
    if isinstance(run.arm, PlanarArm):  # A planar arm is in the xy plane.
        angles = x[:, 2] if run.kind == "pose" else np.zeros(len(x)) if reference else run.q.sum(axis=1)
        half, none = angles / 2, np.zeros(len(x))
        return np.column_stack([x[:, :2], none]), np.column_stack([none, none, np.sin(half), np.cos(half)])
    if reference:
        return x, np.tile([0.0, 0.0, 0.0, 1.0], (len(x), 1))
    return x, quaternions(task_frames(run.arm, run.q, run.tips[0])[:, :3, :3])
