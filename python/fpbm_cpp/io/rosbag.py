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
from ..motion.run import Run
from .orientation import quaternions

# (topic, time [ns], message)
Stamped = tuple[str, int, Any]


def to_rosbag(run: Run, directory: str | os.PathLike[str], frame: str, trajectory: bool) -> None:
    """Write a run as a bag, whole or not at all."""
    try:
        from rosbags.rosbag2 import Writer
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise ImportError('to_rosbag needs rosbags: pip install "fpbm_cpp[ros]"') from None
    if not len(run.t):
        raise ValueError("the run has no samples: must have one at least to be a bag")
    target = Path(directory)
    if target.exists() or target.is_symlink():
        raise FileExistsError(f"{target}: exists already, and a bag is not written over anything")
    store = get_typestore(Stores.ROS2_HUMBLE)
    # A bag's files have its name, so an unfinished bag is marked by the name of its parent.
    part = Path(tempfile.mkdtemp(prefix=f".{target.name}.", suffix=".part", dir=target.absolute().parent))
    try:
        # ROS 2 Humble cannot parse the qualities of service of version 9; later releases read both.
        with Writer(part / target.name, version=8) as writer:
            topics: dict[str, Any] = {}
            for topic, time, message in _messages(run, store.types, frame, trajectory):
                kind = message.__msgtype__
                if topic not in topics:
                    topics[topic] = writer.add_connection(topic, kind, typestore=store)
                writer.write(topics[topic], time, store.serialize_cdr(message, kind))
        (part / target.name).rename(target)
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _messages(run: Run, types: Any, frame: str, trajectory: bool) -> Iterator[Stamped]:
    """All messages of a run, in order of time."""
    header, time = types["std_msgs/msg/Header"], types["builtin_interfaces/msg/Time"]
    joint_state = types["sensor_msgs/msg/JointState"]
    if trajectory:
        yield "/joint_trajectory", 0, _trajectory(run, types, header(time(0, 0), frame))
    tips = zip(*_poses(run, run.x), *_poses(run, run.x_ref, reference=True))
    nothing = np.zeros(0)
    for t, q, qd, (p, r, p_ref, r_ref) in zip(_nanoseconds(run.t), run.q, run.qd, tips):
        stamp = header(time(*divmod(t, 10**9)), frame)
        yield "/joint_states", t, joint_state(stamp, run.arm.joint_names, q, qd, nothing)
        yield "/tip", t, _pose(types, stamp, p, r)
        yield "/tip_reference", t, _pose(types, stamp, p_ref, r_ref)


def _pose(types: Any, header: Any, position: Array, quaternion: Array) -> Any:
    point, orientation = types["geometry_msgs/msg/Point"], types["geometry_msgs/msg/Quaternion"]
    pose = types["geometry_msgs/msg/Pose"](point(*position.tolist()), orientation(*quaternion.tolist()))
    return types["geometry_msgs/msg/PoseStamped"](header, pose)


def _trajectory(run: Run, types: Any, header: Any) -> Any:
    point, duration = types["trajectory_msgs/msg/JointTrajectoryPoint"], types["builtin_interfaces/msg/Duration"]
    points = [
        point(q, qd, qdd, np.zeros(0), duration(*divmod(t, 10**9)))
        for t, q, qd, qdd in zip(_nanoseconds(run.t), run.q, run.qd, run.qdd)
    ]
    return types["trajectory_msgs/msg/JointTrajectory"](header, run.arm.joint_names, points)


def _nanoseconds(t: Array) -> list[int]:
    whole: list[int] = np.rint(t * 1e9).astype(np.int64).tolist()
    return whole


def _poses(run: Run, x: Array, reference: bool = False) -> tuple[Array, Array]:
    """Positions in space, and quaternions: for a task of position, the arm's, and of the reference the identity.

    A planar arm lies in the xy plane and rotates about z.
    """
    if x.ndim == 3:
        return x[:, :3, 3], quaternions(x[:, :3, :3])
    if isinstance(run.arm, PlanarArm):
        angles = x[:, 2] if run.task == "pose" else np.zeros(len(x)) if reference else run.q.sum(axis=1)
        half, none = angles / 2, np.zeros(len(x))
        return np.column_stack([x[:, :2], none]), np.column_stack([none, none, np.sin(half), np.cos(half)])
    if reference:
        return x, np.tile([0.0, 0.0, 0.0, 1.0], (len(x), 1))
    rotations = [run.arm.forward(q)[:3, :3] for q in run.q]
    return x, quaternions(np.array(rotations).reshape(-1, 3, 3))
