"""Torques of ticks and runs, and where they are shown: figures, tables, jobs, the command line and the servo."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fpbm_cpp as fp
from fpbm_cpp._types import Array
from fpbm_cpp.bounds import largest_torques
from fpbm_cpp.joints import Joint
from fpbm_cpp.skeleton import dry_friction

PANDA = fp.SerialArm.preset("panda")
HEAVY = PANDA.with_payload(3.0, com=[0.0, 0.0, 0.1])
READY = np.array([0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785])
FPBM = fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=2)
EFFORT = np.array([87.0] * 4 + [12.0] * 3)
MASSLESS = fp.PlanarArm([1, 1, 1])
CIRCLE = fp.Circle(0.1, 1.0).in_plane("yz")


def moved(x: Array, displacement: float) -> Array:
    x = np.array(x)
    x[1, 3] += displacement
    return x


def dynamics(arm: Any, q: Array, qd: Array, qdd: Array) -> Array:
    """M(q) qdd + h(q, qd), from other methods than the torques of ticks."""
    return np.asarray(arm.mass_matrix(q) @ qdd + arm.bias(q, qd))


def expect_torque(tick: fp.Tick, arm: Any, q: Array, qd: Array) -> None:
    assert tick.torque is not None
    np.testing.assert_allclose(tick.torque, dynamics(arm, q, qd, tick.qdd), rtol=0, atol=1e-11)


# Ticks


def to_a_point(tracker: fp.Tracker) -> Callable[[], fp.Tick]:
    x = moved(tracker.tip, 0.1)
    return lambda: tracker.tick(x)


def along_a_path(tracker: fp.Tracker) -> Callable[[], fp.Tick]:
    follower = tracker.follow(CIRCLE)
    return lambda: tracker.tick(follower)


def toward_a_filter(tracker: fp.Tracker) -> Callable[[], fp.Tick]:
    filtered = fp.TargetFilter(
        tracker.tip,
        velocity=1.0,
        acceleration=5.0,
        jerk=100.0,
        angular_velocity=1.0,
        angular_acceleration=5.0,
        angular_jerk=100.0,
        dt=1e-3,
    )
    filtered.push(moved(tracker.tip, 0.1), 0.0)
    return lambda: tracker.tick(filtered)


@pytest.mark.parametrize("source", [to_a_point, along_a_path, toward_a_filter])
@pytest.mark.parametrize("arm", [PANDA, HEAVY])
def test_the_torque_of_a_tick_is_for_the_state_at_its_start(source: Any, arm: fp.SerialArm) -> None:
    tracker = fp.Tracker(arm, FPBM, READY, task="pose")
    tick = source(tracker)
    for k in range(200):
        q, qd = tracker.q, tracker.qd
        expect_torque(tick(), arm, q, qd)
        if k == 100:
            assert np.abs(qd).max() > 0.01
            tracker.stop()


def test_the_torque_of_a_tick_outlives_the_tracker() -> None:
    arm = PANDA.with_payload(2.0, com=[0, 0, 0])
    tracker = fp.Tracker(arm, FPBM, READY, task="pose")
    tick = tracker.tick(moved(tracker.tip, 0.1))
    expected = dynamics(arm, READY, 0 * READY, tick.qdd)
    del tracker, arm
    np.testing.assert_allclose(tick.torque, expected, rtol=0, atol=1e-11)


def test_torques_of_a_stack() -> None:
    robot = fp.Robot.preset("two_pandas")
    q0 = np.tile(READY, 2)
    stack = fp.Stack(fp.PoseTask("left_tip", name="left"), fp.PostureTask(q0, k1=4, k2=4))
    tracker = fp.Tracker(robot, fp.FPBM(0.6, np.ones(14), 0, 0), q0, stack=stack)
    goal = moved(tracker.tip["left"], 0.1)
    for _ in range(50):
        q, qd = tracker.q, tracker.qd
        expect_torque(tracker.tick({"left": goal}), robot, q, qd)
    q, qd = q0 + 0.01, np.full(14, 0.1)
    expect_torque(tracker.resolve_measured(q, qd, {"left": goal}), robot, q, qd)


def test_torques_of_a_measured_state() -> None:
    tracker = fp.Tracker(HEAVY, FPBM, READY, task="pose")
    q, qd = READY + 0.02, np.linspace(-0.3, 0.3, 7)
    tick = tracker.resolve_measured(q, qd, moved(tracker.tip, 0.05))
    expect_torque(tick, HEAVY, q, qd)


def test_ticks_without_torques() -> None:
    at_velocity_level = fp.Tracker(PANDA, fp.MVN(k=5), READY, task="pose")
    assert at_velocity_level.tick(at_velocity_level.tip).torque is None
    limits = fp.JointLimits(lower=[-3] * 3, upper=3, velocity=2, acceleration=10)
    one_drive_without_mass = fp.SerialArm([Joint(mass=1, axis=(1, 0, 0)), *[Joint(), Joint(axis=(0, 1, 0))]], np.eye(4))
    for arm in (MASSLESS, one_drive_without_mass):
        assert not arm.has_dynamics
        tracker = fp.Tracker(arm, fp.MAN(null_damping=1), [0.3, 0.4, 0.5], limits=limits)
        assert tracker.tick(tracker.tip).torque is None
        with pytest.raises(fp.ParameterError, match="moves no mass"):
            arm.bias([0, 0, 0], [0, 0, 0])


# Runs


def a_run(arm: Any = HEAVY, scheme: Any = FPBM, **options: Any) -> fp.Run:
    return fp.track(arm, CIRCLE, scheme, READY, task="pose", hold=0.1, dt=5e-3, **options)


@pytest.fixture(scope="module")
def heavy() -> fp.Run:
    return a_run()


@pytest.fixture(scope="module")
def bounded() -> fp.Run:
    return a_run(bounds=[fp.TorqueBounds(fraction=0.6)])


@pytest.mark.parametrize("scheme", [FPBM, fp.MVN(k=5)])
def test_the_torque_of_a_run(scheme: Any) -> None:
    """Also at velocity level: the accelerations of the run are known."""
    run = a_run(scheme=scheme)
    assert run.torque is not None
    for k in range(0, len(run.t), 10):
        expected = dynamics(HEAVY, run.q[k], run.qd[k], run.qdd[k])
        np.testing.assert_allclose(run.torque[k], expected, rtol=0, atol=1e-11)
    light = fp.simulate(PANDA, CIRCLE, FPBM, READY, task="pose", dt=5e-3)
    assert light.torque is not None
    assert light.torque.shape == light.q.shape


def test_runs_without_torques() -> None:
    run = fp.simulate(MASSLESS, fp.Circle(0.1, 1.0), fp.MVN(k=5), [0.3, 0.4, 0.5], dt=0.01)
    assert run.torque is None
    assert "torque" not in run.bound_ratios()


def test_a_panel_of_torques_needs_torques() -> None:
    pytest.importorskip("matplotlib")
    run = fp.simulate(MASSLESS, fp.Circle(0.1, 1.0), fp.MVN(k=5), [0.3, 0.4, 0.5], dt=0.01)
    with pytest.raises(ValueError, match="no data in this run"):
        run.plot(panels=["torques"])


def test_ratios_to_the_efforts_and_to_torque_bounds(heavy: fp.Run, bounded: fp.Run) -> None:
    assert heavy.torque is not None
    assert bounded.torque is not None
    np.testing.assert_allclose(heavy.bound_ratios()["torque"], np.abs(heavy.torque) / EFFORT, rtol=1e-15)
    np.testing.assert_allclose(bounded.bound_ratios()["torque"], np.abs(bounded.torque) / (0.6 * EFFORT), rtol=1e-15)
    assert heavy.bound_ratios()["torque"].max() > 0.62
    assert 0.9 < bounded.bound_ratios()["torque"].max() <= 1.0


def test_dry_friction_reduces_the_bounds() -> None:
    leader, follower = Joint(effort=20.0, friction=1.0), Joint(mimic=(0, -0.5, 0.0), friction=2.0, effort=50.0)
    arm = fp.SerialArm([leader, follower, Joint(mass=1.0, friction=3.0, effort=5.0)])
    assert dry_friction(arm).tolist() == [2.0, 3.0]
    assert largest_torques(arm, arm.limits, ()).tolist() == [18.0, 2.0]
    given = [fp.TorqueBounds(effort=[10.0, np.inf], fraction=0.5)]
    assert largest_torques(arm, arm.limits, given).tolist() == [3.0, np.inf]
    assert largest_torques(arm, arm.limits, [fp.TorqueBounds(effort=8)]).tolist() == [6.0, 5.0]
    # An effort below the friction is not a bound.
    assert largest_torques(arm, arm.limits.replace(effort=2.5), ()).tolist() == [0.5, np.inf]


def test_a_run_from_a_file_has_the_torques(bounded: fp.Run, tmp_path: Path) -> None:
    bounded.save(tmp_path / "run.npz")
    again = fp.load(tmp_path / "run.npz")
    assert again == bounded
    np.testing.assert_array_equal(again.torque, bounded.torque)
    np.testing.assert_array_equal(again.largest_torques, bounded.largest_torques)


# Figures and tables


def drawn(axes: Any, label: str) -> list[float]:
    return sorted({line.get_ydata()[0] for line in axes.get_lines() if line.get_label() in (label, f"_{label}")})


def test_the_panel_of_torques(heavy: fp.Run, bounded: fp.Run) -> None:
    pytest.importorskip("matplotlib")
    from fpbm_cpp.plot import OVERVIEW, PANELS
    from fpbm_cpp.plot.panels import choose

    (axes,) = heavy.plot(panels="torques", bounds=True).axes
    assert axes.get_title(loc="left") == "Joint torques"
    assert axes.get_ylabel() == r"$\tau$ [Nm]"
    lines = [line for line in axes.get_lines() if len(line.get_ydata()) == len(heavy.t)]
    np.testing.assert_array_equal(np.array([line.get_ydata() for line in lines]).T, heavy.torque)
    assert drawn(axes, "bound") == [-87.0, -12.0, 12.0, 87.0]
    (axes,) = bounded.plot(panels="torques").axes
    assert set(drawn(axes, "bound")) <= {-0.6 * 87.0, -0.6 * 12.0, 0.6 * 12.0, 0.6 * 87.0}
    assert drawn(axes, "bound")
    # Among the usual panels only if the torques have bounds.
    assert "torques" not in OVERVIEW
    assert "torques" not in choose(heavy, None)
    assert "torques" in choose(bounded, None)
    # A figure of most panels has them all.
    run = replace(bounded, clearance=np.ones(len(bounded.t)))
    everything = {name: PANELS[name].heading for name in PANELS if PANELS[name].fits(run)}
    assert len(everything) == 13
    titles = [axes.get_title(loc="left").split(") ")[-1] for axes in run.plot(panels=list(everything)).axes]
    assert set(everything.values()) <= set(titles)


def rail() -> fp.Run:
    """An arm on a rail."""
    slide = Joint("prismatic", axis=(0, 1, 0), name="rail", effort=500.0)
    arm = fp.SerialArm([slide, *PANDA.joints], PANDA.tip)
    q0 = [0.1, 0, -0.8, 0, -2.4, 0, 1.6, 0.8]
    return fp.simulate(arm, CIRCLE, fp.FPBM(0.5, np.ones(8), 20, 100), q0, task="pose", dt=0.01)


def test_columns_of_torques(tmp_path: Path) -> None:
    run = rail()
    assert run.torque is not None
    run.to_csv(tmp_path / "run.csv")
    with open(tmp_path / "run.csv", newline="", encoding="utf-8") as file:
        heads, *rows = csv.reader(file)
    first = heads.index("torque_rail [N]")
    assert heads[first + 1] == f"torque_{PANDA.joint_names[0]} [Nm]"
    np.testing.assert_array_equal(np.array(rows, dtype=float)[:, first : first + 8], run.torque)


def test_arrays_of_torques() -> None:
    pytest.importorskip("xarray")
    run = rail()
    dataset = run.to_xarray()
    np.testing.assert_array_equal(dataset["torque"], run.torque)
    assert dataset["torque"].attrs["units"] == "Nm, N"


def test_efforts_of_a_bag(bounded: fp.Run, tmp_path: Path) -> None:
    rosbag2 = pytest.importorskip("rosbags.rosbag2")
    typesys = pytest.importorskip("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    bounded.to_rosbag(tmp_path / "bag", trajectory=True)
    efforts: dict[str, list[Any]] = {}
    with rosbag2.Reader(tmp_path / "bag") as reader:
        for connection, _, data in reader.messages():
            message = store.deserialize_cdr(data, connection.msgtype)
            efforts.setdefault(connection.topic, []).append(message)
    np.testing.assert_array_equal([each.effort for each in efforts["/joint_states"]], bounded.torque)
    (trajectory,) = efforts["/joint_trajectory"]
    np.testing.assert_array_equal([each.effort for each in trajectory.points], bounded.torque)


# Jobs and the command line

JOB: dict[str, Any] = {
    "arm": {"kind": "preset", "name": "panda", "payload": {"mass": 3.0, "com": [0.0, 0.0, 0.1]}},
    "path": {"kind": "circle", "radius": 0.1, "duration": 1.0},
    "run": {"q0": READY.tolist(), "task": "pose", "dt": 5e-3},
    "bounds": [{"kind": "torque_bounds", "fraction": 0.7}],
}


def test_a_job_with_a_payload_and_torque_bounds(tmp_path: Path) -> None:
    job = pytest.importorskip("fpbm_cpp.job")
    motion = job.prepare(JOB)
    assert motion.arm == HEAVY
    assert motion.bounds == (fp.TorqueBounds(fraction=0.7),)
    run = motion.run()
    assert 0.9 < run.bound_ratios()["torque"].max() <= 1.0
    motion.save(tmp_path / "job.toml")
    again = job.prepare(job.read_job(tmp_path / "job.toml"))
    assert again.arm == motion.arm
    assert again.bounds == motion.bounds
    assert again.run() == run


def test_a_payload_of_a_robot_of_a_job() -> None:
    sections = pytest.importorskip("fpbm_cpp.job.sections")
    arm = {"kind": "preset", "name": "two_pandas", "payload": {"mass": 2.0, "frame": "left_tip"}}
    expected = fp.Robot.preset("two_pandas").with_payload(2.0, com=[0, 0, 0], frame="left_tip")
    assert sections.arm_of({"arm": arm}) == expected


def test_a_payload_of_a_file(tmp_path: Path) -> None:
    """Also if limits of the job replace limits of the file."""
    sections = pytest.importorskip("fpbm_cpp.job.sections")
    file = tmp_path / "r.urdf"
    file.write_text(
        '<robot name="r"><link name="base"/><link name="arm"><inertial><mass value="2"/></inertial></link>'
        '<joint name="j" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>'
        '<limit lower="-1" upper="1"/></joint></robot>'
    )
    arm = {"kind": "urdf", "file": str(file), "tip": "arm", "payload": {"mass": 1.0, "com": [0.5, 0, 0]}}
    for limits in ({}, {"limits": {"velocity": 3.0}}):
        read = sections.arm_of({"arm": dict(arm), **limits})
        assert read.mass_matrix([0.0]) == pytest.approx(0.25)


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        ({"mass": -1.0}, "arm.payload.mass = -1: must be finite and not negative"),
        ({"com": [0, 0, 0]}, "arm.payload.mass: is missing"),
        ({"mass": 1.0, "com": [0, 0]}, r"arm.payload.com = .*must be real numbers of shape \(3,\)"),
        ({"mass": 1.0, "frame": "hand"}, "arm.payload.frame = 'hand': must be a frame"),
        ({"mass": 1.0, "weight": 1.0}, "arm.payload.weight: is not a key of"),
        (3.0, "arm.payload = 3.0: must be a table"),
    ],
)
def test_a_wrong_payload(payload: Any, message: str) -> None:
    job = pytest.importorskip("fpbm_cpp.job")
    with pytest.raises(job.JobError, match=message):
        job.prepare({**JOB, "arm": {**JOB["arm"], "payload": payload}})


@pytest.fixture
def call() -> Callable[..., Any]:
    pytest.importorskip("click")
    from click.testing import CliRunner

    from fpbm_cpp.cli import command

    return lambda *arguments: CliRunner().invoke(command, arguments)


def test_options_of_track(call: Callable[..., Any], tmp_path: Path) -> None:
    job = pytest.importorskip("fpbm_cpp.job")
    file = str(tmp_path / "job.toml")
    where = ",".join(map(str, READY.tolist()))
    motion = ["track", "panda", f"--q0={where}", "--radius", "0.1", "--duration", "1", "--dt", "0.005"]
    options = ["--payload", "3,0,0,0.1", "--torque-bounds", "0.7"]
    result = call(*motion, *options, "--save-job", file)
    assert result.exit_code == 0, result.output
    (row,) = [line for line in result.output.splitlines() if line.startswith("largest torque / bound")]
    read = job.prepare(job.read_job(file))
    assert read.arm == HEAVY
    assert read.bounds == (fp.TorqueBounds(fraction=0.7),)
    run = read.run()
    ratios = run.bound_ratios()["torque"]
    k, i = np.unravel_index(ratios.argmax(), ratios.shape)
    assert float(row.split()[4]) == pytest.approx(ratios.max(), rel=1e-3)
    assert row.endswith(f"{run.arm.joint_names[i]} at {run.t[k]:.3g} s")
    # Options override the file, key by key.
    result = call("track", "--job", file, "--payload", "1", "--torque-bounds", "0.9", "--save-job", file)
    assert result.exit_code == 0, result.output
    again = job.read_job(file)
    assert again["arm"]["payload"] == {"mass": 1.0, "com": [0.0, 0.0, 0.1]}
    assert again["bounds"] == [{"kind": "torque_bounds", "fraction": 0.9}]
    without = call("track", "planar:1,1,1", "--duration", "0.2")
    assert "largest torque" not in without.output


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--payload", "-1"], "--payload: mass = -1: must be finite and not negative"),
        (["--payload", "1,2"], "--payload: com = [2.0]: must be real numbers of shape (3,)"),
        (["--payload", "heavy"], "--payload: mass = 'heavy': must be a number"),
        (["--torque-bounds", "2"], "--torque-bounds = 2: must be in [0, 1]"),
        (["--torque-bounds", "1", "--scheme", "mvn"], "must be given with a scheme at acceleration level"),
        (["--payload", "30", "--torque-bounds", "1"], "Error: joint 'panda_joint2': torque at rest = 92"),
    ],
)
def test_wrong_options(call: Callable[..., Any], options: list[str], message: str) -> None:
    result = call("track", "panda", "--duration", "0.5", *options)
    assert result.exit_code == 1
    assert message in result.stderr


# The servo


def test_the_strip_has_the_largest_torque() -> None:
    from fpbm_cpp.viewer.loop import ServoLoop, Strip

    clock = iter(np.arange(0.0, 100.0, 1.0 / 30.0))
    for bounds in ((), (fp.TorqueBounds(fraction=0.6),)):
        loop = ServoLoop(HEAVY, FPBM, READY, task="pose", bounds=bounds, clock=lambda: float(next(clock)))
        loop.push(moved(HEAVY.forward(READY), 0.5))
        ticks = [tick for _ in range(30) for tick in loop.advance()]
        effort = (0.6 if bounds else 1.0) * EFFORT
        torques = [dynamics(HEAVY, tick.q, tick.qd, tick.qdd) for tick in ticks]
        assert loop.strip.bounded == (True, True, True, True)
        np.testing.assert_allclose(loop.strip.shares[3], np.max(np.abs(torques) / effort, axis=1), rtol=1e-9)
        assert 0.4 < loop.strip.shares[3].max() < (1.0 + 1e-9 if bounds else np.inf)
    for arm, effort in ((MASSLESS, 10.0), (PANDA, np.inf)):
        strip = Strip(arm, arm.limits.replace(effort=np.full(arm.dof, effort)), 1e-3)
        assert len(strip.bounded) == 3
        assert strip.shares.shape == (4, 0)


def test_the_readout_has_the_largest_torque() -> None:
    pytest.importorskip("viser")
    from fpbm_cpp.viewer.loop import ServoLoop
    from fpbm_cpp.viewer.readout import _rows

    loop = ServoLoop(HEAVY, FPBM, READY, task="pose", clock=iter(np.arange(0.0, 9.0, 0.1)).__next__)
    loop.advance()
    (row,) = [row for row in _rows(loop) if row[1] == "joint torque"]
    assert row[2].endswith(" %")
    assert float(row[2][:-2]) > 10
