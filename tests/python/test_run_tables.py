"""Runs as tables and datasets: every number exact, under a name and with a unit."""

from __future__ import annotations

import csv
import os
import subprocess
import sys

import numpy as np
import pytest
from test_track import BENT, PANDA, TIGHT

import fpbm_cpp as fp
from fpbm_cpp.motion.tables import quaternions

FLAT = fp.PlanarArm([1, 1, 1, 1])
RAIL = fp.SerialArm(
    [
        fp.Joint("prismatic", axis=(0, 1, 0), name='rail, "long"', lower=-1, upper=1, velocity=1, acceleration=5),
        *PANDA.joints,
    ],
    PANDA.tip,
)

WALL = fp.HalfSpace([-1, 0, 0], -9)


def in_the_plane(**options):
    return fp.simulate(FLAT, fp.Circle(0.2, 1.0), fp.MVN(), [0.3, 0.9, 0.9, 0.5], dt=1 / 48, **options)


def in_space(task="pose"):
    path = fp.Circle(0.1, 1.0).in_plane("yz")
    path = path.with_rotation([0, 0, 1.0]) if task == "pose" else path
    return fp.simulate(RAIL, path, fp.MVN(), [0, *BENT], dt=0.02, task=task)


def limited(clearance=None):
    start = np.pi / np.array([12, 12, 15, 15])
    scheme = fp.FPBM(0.6, [1, 2, 3, 4], 10, 25)
    return fp.track(
        FLAT, fp.Circle(0.45, 1.0), scheme, start, dt=0.02, limits=TIGHT, bounds=[clearance] if clearance else ()
    )


RUNS = {
    "position in the plane": in_the_plane,
    "pose in the plane": lambda: in_the_plane(task="pose"),
    "position in space": lambda: in_space("position"),
    "pose in space": in_space,
    "within limits": limited,
    "clear of a wall": lambda: limited(fp.Clearance([fp.Capsule(4, [1, 0, 0], [1, 0, 0], 0)], [WALL])),
    "of no sample": lambda: fp.simulate(FLAT, fp.Circle(0.2, 1.0), fp.MAN(), np.zeros(4), partial=True),
    "of no sample, in space": lambda: fp.simulate(
        PANDA, fp.Circle(0.2, 1.0), fp.MAN(), np.zeros(7), task="pose", partial=True
    ),
}


@pytest.fixture(scope="module", params=RUNS)
def run(request):
    return RUNS[request.param]()


def read(file):
    with open(file, newline="", encoding="utf-8") as lines:
        heads, *rows = csv.reader(lines)
    return heads, np.array([[float(entry) for entry in row] for row in rows]).reshape(-1, len(heads))


def expect_columns(columns, run):
    """Asserts that the columns contain all numbers of a run."""
    joints, flat = run.arm.joint_names, isinstance(run.arm, fp.PlanarArm)
    expected = {"t": run.t}
    for name in ("q", "qd", "qdd"):
        expected.update({f"{name}_{joint}": getattr(run, name)[:, i] for i, joint in enumerate(joints)})
    if run.torque is not None:
        expected.update({f"torque_{joint}": run.torque[:, i] for i, joint in enumerate(joints)})
    for ending, x, positions in (("", run.x, run.positions), ("_ref", run.x_ref, run.reference_positions)):
        expected.update({axis + ending: positions[:, i] for i, axis in enumerate("xy" if flat else "xyz")})
        if run.task == "pose" and flat:
            expected[f"angle{ending}"] = x[:, 2]
        elif run.task == "pose":
            orientations = quaternions(x[:, :3, :3])
            expected.update({f"q{axis}{ending}": orientations[:, i] for i, axis in enumerate("xyzw")})
    rows = [f"error_{axis}" for axis in ("xy" if flat else "xyz")]
    if run.task == "pose":
        rows += ["orientation_error"] if flat else ["orientation_error_x", "orientation_error_y", "orientation_error_z"]
    expected.update({name: run.error[:, i] for i, name in enumerate(rows)})
    if run.scale is not None:
        expected["scale"] = run.scale
        expected.update({f"saturated_{joint}": run.saturated[:, i] for i, joint in enumerate(joints)})
    if run.clearance is not None:
        expected["clearance"] = run.clearance
    assert list(columns) == list(expected)
    for name, values in expected.items():
        assert np.asarray(columns[name], float).tobytes() == values.astype(float).tobytes(), name


def test_csv(run, tmp_path):
    run.to_csv(tmp_path / "run.csv")
    heads, numbers = read(tmp_path / "run.csv")
    expect_columns(dict(zip([head.rsplit(" [")[0] for head in heads], numbers.T)), run)
    assert heads[0] == "t [s]"
    assert f"qdd_{run.arm.joint_names[-1]} [rad/s^2]" in heads
    assert "error_y [m]" in heads
    if run.arm is RAIL:
        assert 'qd_rail, "long" [m/s]' in heads


def test_numpy_reads_csv(tmp_path):
    run = limited()
    run.to_csv(str(tmp_path / "run.csv"))
    numbers = np.loadtxt(tmp_path / "run.csv", delimiter=",", skiprows=1)
    assert numbers[:, 1:5].tobytes() == run.q.tobytes()
    np.testing.assert_array_equal(numbers[:, -4:], run.saturated)
    assert run.saturated.any()


def test_csv_is_replaced_atomically(tmp_path, monkeypatch):
    file = tmp_path / "run.csv"
    file.write_text("what was there")
    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", lambda *_: (_ for _ in ()).throw(OSError(28, "No space left on device")))
        with pytest.raises(OSError, match="No space"):
            in_the_plane().to_csv(file)
    assert file.read_text() == "what was there"
    assert os.listdir(tmp_path) == ["run.csv"]
    in_the_plane().to_csv(file)
    assert file.read_text().startswith("t [s],q_joint_1 [rad]")


def test_pandas(run):
    pytest.importorskip("pandas")
    frame = run.to_pandas()
    assert len(frame) == len(run.t)
    expect_columns({name: frame[name].to_numpy() for name in frame.columns}, run)
    assert frame.attrs["units"][f"qd_{run.arm.joint_names[0]}"] == ("m/s" if run.arm is RAIL else "rad/s")
    assert frame.attrs["units"].keys() <= set(frame.columns)
    if run.saturated is not None:
        assert frame["saturated_joint_1"].dtype == bool


def test_xarray(run):
    pytest.importorskip("xarray")
    data = run.to_xarray()
    n, d = run.arm.dof, run.positions.shape[1]
    for name in ("q", "qd", "qdd"):
        assert data[name].dims == ("time", "joint")
        assert data[name].values.tobytes() == getattr(run, name).tobytes()
    np.testing.assert_array_equal(data.time, run.t)
    assert data.time.attrs["units"] == "s"
    assert data.joint.values.tolist() == run.arm.joint_names
    assert data.joint_units.values.tolist() == (["m"] if run.arm is RAIL else []) + ["rad"] * (7 if n > 4 else 4)
    assert data.qdd.attrs["units"] == ("rad/s^2, m/s^2" if run.arm is RAIL else "rad/s^2")
    np.testing.assert_array_equal(data.x.transpose("time", "axis"), run.positions)
    np.testing.assert_array_equal(data.x_ref, run.reference_positions)
    np.testing.assert_array_equal(data.error, run.error[:, :d])
    assert data.axis.values.tolist() == list("xyz"[:d])
    assert ("orientation_error" in data) == (run.task == "pose")
    if "orientation" in data:
        np.testing.assert_array_equal(data.orientation_error, run.error[:, 3:])
        np.testing.assert_array_equal(data.orientation_ref, quaternions(run.x_ref[:, :3, :3]))
    elif "orientation_error" in data:
        np.testing.assert_array_equal(data.orientation_error, run.error[:, 2])
        np.testing.assert_array_equal(data.angle_ref, run.x_ref[:, 2])
    assert ("scale" in data) == ("saturated" in data) == (run.scale is not None)
    if run.scale is not None:
        np.testing.assert_array_equal(data.scale, run.scale)
    assert ("clearance" in data) == (run.clearance is not None)
    if run.clearance is not None:
        np.testing.assert_array_equal(data.clearance, run.clearance)
        assert data.clearance.attrs["units"] == "m"
        np.testing.assert_array_equal(data.saturated, run.saturated)
    assert all("units" in variable.attrs for variable in data.data_vars.values())
    assert data.attrs["scheme"] == repr(run.scheme)


def test_quaternions_are_continuous_and_equal_the_rotations():
    rng = np.random.default_rng(0)
    axis = rng.normal(size=3)
    vectors = np.linspace(0, 4 * np.pi, 500)[:, None] * axis / np.linalg.norm(axis)
    rotations = np.array([fp.rotation(vector) for vector in vectors])
    result = quaternions(rotations)
    np.testing.assert_allclose(np.linalg.norm(result, axis=1), 1, atol=1e-14)
    assert np.abs(np.diff(result, axis=0)).max() < 0.02
    v, w = result[:, :3], result[:, 3]
    p = rng.normal(size=3)
    rotated = p + 2 * np.cross(v, np.cross(v, p) + w[:, None] * p)
    np.testing.assert_allclose(rotated, rotations @ p, atol=1e-13)
    assert quaternions(np.zeros((0, 3, 3))).shape == (0, 4)


@pytest.mark.parametrize(
    ("call", "module", "words"),
    [
        ("to_pandas()", "pandas", 'to_pandas needs pandas: pip install "fpbm_cpp[data]"'),
        ("to_xarray()", "xarray", 'to_xarray needs xarray: pip install "fpbm_cpp[data]"'),
        ("to_rosbag('bag')", "rosbags", 'to_rosbag needs rosbags: pip install "fpbm_cpp[ros]"'),
    ],
    ids=["pandas", "xarray", "rosbags"],
)
def test_a_missing_extra_is_named(call, module, words, tmp_path):
    code = (
        f"import sys; sys.modules[{module!r}] = None\n"
        "import fpbm_cpp as fp\n"
        "run = fp.simulate(fp.PlanarArm([1, 1, 1]), fp.Circle(0.1, 1.0), fp.MVN(), [0.3, 0.9, 0.9], dt=0.1)\n"
        f"try: run.{call}\n"
        "except ImportError as error: print(error)\n"
    )
    shown = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, cwd=tmp_path)
    assert shown.stdout == words + "\n"
    assert not os.listdir(tmp_path)
