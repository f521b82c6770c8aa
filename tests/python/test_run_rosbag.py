"""Runs as ROS 2 bags, read by a library that is independent of ROS."""

from __future__ import annotations

import os

import numpy as np
import pytest
from test_run_tables import RUNS, in_space, in_the_plane

import fpbm_cpp as fp

pytest.importorskip("rosbags")

from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)


def read(bag):
    """Time and message of each message, by topics."""
    messages = {}
    with Reader(bag) as reader:
        for connection, time, data in reader.messages():
            messages.setdefault(connection.topic, []).append((time, STORE.deserialize_cdr(data, connection.msgtype)))
        kinds = {connection.topic: connection.msgtype for connection in reader.connections}
    return kinds, messages


def numbers(part):
    return [getattr(part, name) for name in ("x", "y", "z", "w") if hasattr(part, name)]


@pytest.mark.parametrize("name", [name for name in RUNS if "no sample" not in name])
def test_a_bag_holds_the_run(name, tmp_path):
    run = RUNS[name]()
    run.to_rosbag(tmp_path / "bag", frame="world")
    kinds, messages = read(tmp_path / "bag")
    assert kinds == {
        "/joint_states": "sensor_msgs/msg/JointState",
        "/tip": "geometry_msgs/msg/PoseStamped",
        "/tip_reference": "geometry_msgs/msg/PoseStamped",
    }
    stamps = np.rint(run.t * 1e9).astype(int).tolist()
    for topic in kinds:
        assert [time for time, _ in messages[topic]] == stamps
        for time, message in messages[topic]:
            assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == time
            assert message.header.frame_id == "world"
    for k, (_, joints) in enumerate(messages["/joint_states"]):
        assert joints.name == run.arm.joint_names
        assert joints.position.tobytes() == run.q[k].tobytes()
        assert joints.velocity.tobytes() == run.qd[k].tobytes()
        assert joints.effort.tobytes() == (b"" if run.torque is None else run.torque[k].tobytes())
    for topic, positions in (("/tip", run.positions), ("/tip_reference", run.reference_positions)):
        found = np.array([numbers(message.pose.position) for _, message in messages[topic]])
        d = positions.shape[1]
        assert found[:, :d].tobytes() == positions.tobytes()
        assert (found[:, d:] == 0).all()
    for k in range(0, len(run.t), 10):
        tip, reference = (numbers(messages[topic][k][1].pose.orientation) for topic in ("/tip", "/tip_reference"))
        R = np.eye(4)
        if isinstance(run.arm, fp.PlanarArm):
            R[:3, :3] = fp.rotation([0, 0, run.q[k].sum()])
        else:
            R = run.arm.forward(run.q[k])
        np.testing.assert_allclose(rotation(tip), R[:3, :3], atol=1e-12)
        np.testing.assert_allclose(rotation(reference), R[:3, :3] if run.task == "pose" else np.eye(3), atol=1e-3)


def rotation(quaternion):
    half = np.arctan2(np.linalg.norm(quaternion[:3]), quaternion[3])
    return fp.rotation(2 * np.array(quaternion[:3]) / np.sinc(half / np.pi))


def test_a_trajectory_on_request(tmp_path):
    run = in_space()
    run.to_rosbag(str(tmp_path / "bag"), trajectory=True)
    kinds, messages = read(tmp_path / "bag")
    assert kinds["/joint_trajectory"] == "trajectory_msgs/msg/JointTrajectory"
    ((time, trajectory),) = messages["/joint_trajectory"]
    assert time == 0
    assert trajectory.header.frame_id == "base_link"
    assert trajectory.joint_names == run.arm.joint_names
    for name, rows in (("positions", run.q), ("velocities", run.qd), ("accelerations", run.qdd)):
        assert np.array([getattr(point, name) for point in trajectory.points]).tobytes() == rows.tobytes()
    times = [point.time_from_start.sec + 1e-9 * point.time_from_start.nanosec for point in trajectory.points]
    np.testing.assert_allclose(times, run.t, atol=1e-9)


def test_ros_2_humble_can_read_it(tmp_path):
    in_the_plane().to_rosbag(tmp_path / "my_bag")
    assert sorted(os.listdir(tmp_path / "my_bag")) == ["metadata.yaml", "my_bag.db3"]
    text = (tmp_path / "my_bag" / "metadata.yaml").read_text()
    assert "version: 8" in text
    assert "storage_identifier: sqlite3" in text
    assert "- my_bag.db3" in text


@pytest.mark.parametrize("kind", ["folder", "file", "dangling link"])
def test_an_existing_bag_is_not_changed(kind, tmp_path):
    bag = tmp_path / "bag"
    if kind == "folder":
        bag.mkdir()
    elif kind == "file":
        bag.write_text("dear")
    else:
        bag.symlink_to("nowhere")
    with pytest.raises(FileExistsError, match="bag: exists already"):
        in_the_plane().to_rosbag(bag)
    assert os.listdir(tmp_path) == ["bag"]


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt()], ids=repr)
def test_a_bag_is_written_atomically(error, tmp_path, monkeypatch):
    from rosbags.rosbag2 import Writer

    write, count = Writer.write, []

    def failing_write(self, *message):
        count.append(message)
        if len(count) > 20:
            raise error
        write(self, *message)

    monkeypatch.setattr(Writer, "write", failing_write)
    with pytest.raises(type(error)):
        in_the_plane().to_rosbag(tmp_path / "bag")
    assert os.listdir(tmp_path) == []


def test_a_run_without_samples_is_rejected(tmp_path):
    with pytest.raises(ValueError, match="no samples"):
        RUNS["of no sample"]().to_rosbag(tmp_path / "bag")
    assert os.listdir(tmp_path) == []
