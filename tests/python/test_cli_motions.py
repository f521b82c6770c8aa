"""The commands that move an arm: their output, files and error messages."""

from __future__ import annotations

import csv
import importlib
import os
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fpbm_cpp as fp

pytest.importorskip("click")
pytest.importorskip("matplotlib")
pytest.importorskip("tomlkit")

import click
from click.testing import CliRunner, Result

from fpbm_cpp import viewer
from fpbm_cpp._core import PRESETS, ROBOT_PRESETS
from fpbm_cpp.cli import command
from fpbm_cpp.cli.text import summary
from fpbm_cpp.job import prepare, read_job, write_job
from fpbm_cpp.job.sections import FREE, SECTIONS, known

ROOT = Path(__file__).parents[2]
MODULE = [sys.executable, "-m", "fpbm_cpp"]
MOTIONS = ["track", "compare", "sweep", "tune", "view"]
QUICK = ["--duration", "0.2"]
posix = pytest.mark.skipif(os.name == "nt", reason="POSIX signals")


def call(*arguments: str) -> Result:
    return CliRunner().invoke(command, arguments)


def error_of(*arguments: str) -> str:
    """The one plain line with which a call fails."""
    result = call(*arguments)
    assert result.exit_code == 1, result.output
    (line,) = result.stderr.splitlines()
    assert line.startswith("Error: ")
    return line.removeprefix("Error: ")


def examples(name: str) -> list[str]:
    epilog = command.commands[name].epilog or ""
    return [line.split("  # ")[0].strip() for line in re.findall(r"fpbm-cpp .*", epilog)]


def test_fastest_keeps_the_path_and_writes_its_run(tmp_path):
    out = tmp_path / "fast"
    printed = call("fastest", "panda", "--radius", "0.1", "--tip-speed", "0.3", "--out", str(out), "--also", "csv")
    assert printed.exit_code == 0, printed.output
    assert "panda, circle, mvn" in printed.output
    run = fp.load(out / "run.npz")
    assert run.function is fp.fastest
    assert f"complete, t = {run.t[-1]:g} s" in printed.output
    assert run.max_error() < 1e-7
    again = call("fastest", "--job", str(out / "job.toml"), "--tip-speed", "0.3", "--out", str(tmp_path / "again"))
    assert again.exit_code == 0, again.output
    np.testing.assert_array_equal(fp.load(tmp_path / "again" / "run.npz").q, run.q)
    assert {each.name for each in out.iterdir()} == {"run.png", "run.npz", "run.csv", "job.toml"}


def test_fastest_selects_a_scheme_at_velocity_level():
    assert "panda, circle, wmvn" in call("fastest", "panda", "--weights", "1,2,1,2,1,2,1").output
    assert "panda, circle, mvn" in call("fastest", "panda", "--k", "2").output
    assert "must be at velocity level" in error_of("fastest", "panda", "--scheme", "man")
    assert "can be followed to the fraction" in error_of("fastest", "panda", "--radius", "0.6")
    assert "tip_speed = -2" in error_of("fastest", "panda", "--tip-speed", "-2")
    assert "start_speed = -2" in error_of("fastest", "panda", "--start-speed", "-2")
    assert "end_speed = 9: must be at most" in error_of("fastest", "panda", "--end-speed", "9")
    assert "panda, circle, mvn" in call("fastest", "panda", "--start-speed", "0.2", "--end-speed", "0.1").output
    assert "--also needs --out" in call("fastest", "panda", "--also", "csv").output


PANDA_READY = [0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854]


def run_of(folder: str, *arguments: str) -> fp.Run:
    """The run of a call that succeeds."""
    result = call(*arguments, "--out", folder)
    assert result.exit_code == 0, result.output
    return fp.load(Path(folder) / "run.npz")


@pytest.mark.usefixtures("small_figures")
def test_a_kept_path_without_a_duration_is_as_fast_as_possible() -> None:
    """The job of fastest keeps its path."""
    arm, path = fp.SerialArm.preset("panda"), fp.Circle(0.15).in_plane("yz")
    fast = run_of("fast", "fastest", "panda", "--radius", "0.15", "--task", "pose")
    assert fast.path == path
    assert fast == replace(fp.fastest(arm, path, fp.MVN(), PANDA_READY, task="pose"), options=fast.options)
    kept = run_of("kept", "track", "panda", "--radius", "0.15", "--task", "pose", "--scheme", "mvn", "--keep-path")
    assert kept.path == path
    expected = fp.track(arm, path, fp.MVN(), PANDA_READY, task="pose", keep_path=True, null_damping=0)
    np.testing.assert_array_equal(kept.q, expected.q)
    assert kept.replay() == kept
    for folder in ("fast", "kept"):
        job = read_job(f"{folder}/job.toml")
        assert "duration" not in job["path"]
        assert (job["run"]["keep_path"], job["run"]["reserve"]) == (True, 0.05)
        assert run_of("again", "track", "--job", f"{folder}/job.toml") == kept
    slower = run_of("slower", "track", "--job", "kept/job.toml", "--reserve", "0.5")
    np.testing.assert_allclose(slower.t[-1], 1.5 * fast.t[-1], atol=2.1e-3)
    assert run_of("slow", "track", "--job", "kept/job.toml", "--duration", "2").t[-1] == pytest.approx(2.0)
    assert run_of("free", "track", "--job", "kept/job.toml", "--no-keep-path").t[-1] == pytest.approx(10.0)
    assert "keep_path" not in call("track", "panda", *QUICK).output


def test_paths_of_a_job_are_kept() -> None:
    """If a path of a job has a duration, the other paths have the default duration."""
    result = call("track", "two_pandas", "--task", "left_tip", "--task", "right_tip", "--radius", "0.05", "--keep-path")
    assert result.exit_code == 0, result.output
    assert float(result.output.split("complete, t = ")[1].split()[0]) < 2
    pieces = "[[path]]\nkind = 'line'\ndisplacement = [0, 0.1, 0]\n" * 2
    Path("job.toml").write_text(f"[arm]\nkind = 'preset'\nname = 'panda'\n[run]\nkeep_path = true\n{pieces}")
    fast = run_of("fast", "track", "--job", "job.toml")
    assert fast.path.duration is None
    Path("job.toml").write_text(Path("job.toml").read_text() + "duration = 2.0\n")
    assert run_of("slow", "track", "--job", "job.toml").t[-1] == pytest.approx(12.0)
    for name in ("sweep", "tune"):
        assert error_of(name, "--job", "job.toml").endswith(
            "run.keep_path: must not be given here: use track to keep a path"
        )
    assert "No such option '--keep-path'" in call("sweep", "panda", "--keep-path").stderr
    compared = call("compare", "panda", "--keep-path", "--schemes", "mvn,wmvn")
    assert compared.exit_code == 0, compared.output
    Path("job.toml").write_text(Path("job.toml").read_text().replace("true", "'yes'"))
    assert error_of("track", "--job", "job.toml") == "job.toml: run.keep_path = 'yes': must be true or false"


@pytest.mark.usefixtures("small_figures")
def test_a_path_at_a_constant_speed() -> None:
    speed = ["--at-speed", "0.2", "--at-acceleration", "0.5", "--at-jerk", "20"]
    run = run_of("steady", "track", "panda", "--radius", "0.1", *speed)
    assert run.path == fp.Circle(0.1).in_plane("yz").at_speed(0.2, acceleration=0.5, jerk=20)
    assert run_of("again", "track", "--job", "steady/job.toml") == run
    kept = run_of("kept", "track", "panda", "--radius", "0.1", *speed, "--keep-path")
    speeds = np.linalg.norm(np.diff(kept.x, axis=0), axis=1) / 1e-3
    assert speeds.max() <= 0.2 * (1 + 1e-6)
    assert 0.628 / 0.2 < kept.t[-1] < run.t[-1]  # The joints, not the acceleration of the path, bound the ramps.
    assert 0.628 / 0.2 < run_of("fast", "fastest", "panda", "--radius", "0.1", *speed).t[-1] <= kept.t[-1]
    assert "duration" not in call("track", "panda", *speed).output


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def small_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures are made, and not drawn."""
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", lambda self, file, **_: file.write(b"\x89PNG"))


# Help


def test_every_command_has_one_line_in_the_list() -> None:
    result = call("--help")
    lines = result.output.split("Commands:\n")[1].split("\n\n")[0].splitlines()
    assert [line.split()[0] for line in lines] == list(command.commands)
    assert "..." not in "".join(lines)
    assert result.output.isascii()


@pytest.mark.parametrize("name", MOTIONS)
def test_help_of_a_motion(name: str) -> None:
    result = call(name, "--help")
    assert result.exit_code == 0
    assert result.output.isascii()
    headings = [line for line in result.output.splitlines() if line and line[0] != " " and line.endswith(":")]
    clear = ["Clearance:"] if name in ("track", "compare", "view") else []
    assert headings == ["Options:", "Arm and start:", "Path:", "Scheme:", "Joint limits:", *clear]
    assert 2 <= len(examples(name)) <= 5
    for option in command.commands[name].params:
        assert isinstance(option, click.Argument) or option.help, option.name


def test_every_key_of_a_job_is_an_option() -> None:
    """Except tables within tables, and arms with a description of more than a line."""
    options = {option.name for option in command.commands["track"].params}
    for section in ("path", "scheme", "run", "limits"):
        for kind in SECTIONS[section]:
            assert {f"{section}__{key}" for key in known(section, kind)} - options <= {"path__path"}
    assert {f"{section}__kind" for section in FREE} <= options
    assert {f"clearance__{key}" for key in known("clearance", "urdf")} - options == {
        "clearance__tip",  # The arm's own.
        "clearance__base",
        "clearance__locked",
        "clearance__tips",
        "clearance__obstacles",
        "clearance__postures",  # A list for each posture.
    }


@pytest.mark.usefixtures("small_figures")
@pytest.mark.parametrize("name", ["track", "compare", "sweep"])
def test_examples_of_the_help_run(name: str) -> None:
    if name in ("track", "compare"):
        call("track", "iiwa14", *QUICK, "--save-job", "job.toml")
    for line in examples(name):
        words = shlex.split(line)
        result = call(*words[1:], *([] if "--duration" in words else ["--duration", "5"]))
        assert result.exit_code == 0, (line, result.output)
        if "--out" in words:
            assert list(Path(words[words.index("--out") + 1]).iterdir())


# Track


def test_summary_agrees_with_the_run() -> None:
    arguments = ["--radius", "0.1", "--duration", "2", "--task", "pose", "--hold", "1", "--k1", "7", "--no-limits"]
    result = call("track", "panda", *arguments)
    assert result.exit_code == 0
    run = fp.simulate(
        fp.SerialArm.preset("panda"),
        fp.Circle(0.1, 2.0).in_plane("yz"),
        fp.FPBM(0.6, np.ones(7), 7, 25, null_damping=2),
        [0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854],
        task="pose",
        hold=1.0,
    )
    lines = {re.split(r"  +", line)[0]: line for line in result.stdout.splitlines()}
    assert f"{run.max_error():.1e} m" in lines["largest tip error"]
    assert f"{run.max_orientation_error():.1e} rad" in lines["largest orientation error"]
    k, i = np.unravel_index(np.abs(run.qd).argmax(), run.qd.shape)
    assert f"{abs(run.qd[k, i]):.4g} rad/s" in lines["peak joint velocity"]
    assert f"panda_joint{i + 1} at {run.t[k]:.3g} s" in lines["peak joint velocity"]
    assert f"{run.manipulability().min():.4g} " in lines["least manipulability"]
    assert "complete, t = 3 s" in lines["status"]
    assert result.stdout.splitlines()[0] == "panda, circle, fpbm"
    shown_text = " ".join(result.stdout.split())
    assert "k2 = 25" in shown_text
    assert "k1 = " not in shown_text
    assert max(map(len, result.stdout.splitlines())) <= 100
    assert result.stdout.isascii()


EVERY = [*PRESETS, "planar:1,1,1,1", "planar:0.1,0.1,0.1"]


@pytest.mark.parametrize("arm", EVERY)
@pytest.mark.parametrize("task", ["position", "pose"])
def test_track_keeps_the_limits_and_follows_its_default_circle(arm: str, task: str) -> None:
    if task == "pose" and fp_dof(arm) < 6 and not arm.startswith("planar"):
        pytest.skip("too few joints")
    result = call("track", arm, "--task", task, "--out", "out")
    assert result.exit_code == 0
    assert "joints on a bound" in result.stdout
    assert "complete, t = 10 s" in result.stdout
    run = fp.load("out/run.npz")
    assert run.saturated is not None
    assert run.max_error() < 1e-4
    reach = sum(np.linalg.norm(j.placement[:3, 3]) for j in run.arm.joints) if hasattr(run.arm, "joints") else None
    reach = reach or run.arm.lengths.sum()
    (radius,) = re.findall(r"radius = (\S+),", result.stdout)
    assert 0.04 * reach < float(radius) < 0.13 * reach


def fp_dof(arm: str) -> int:
    return 0 if arm.startswith("planar") else fp.SerialArm.preset(arm).dof


@pytest.mark.parametrize("name", ROBOT_PRESETS)
def test_a_robot_follows_its_default_circles(name: str) -> None:
    tips = fp.Robot.preset(name).frames
    result = call("track", name, *(word for tip in tips for word in ("--task", tip)))
    assert result.exit_code == 0
    assert "joints on a bound" in result.stdout
    assert "complete, t = 10 s" in result.stdout


def test_without_limits_on_request() -> None:
    result = call("track", "panda", *QUICK, "--no-limits", "--save-job", "job.toml")
    assert "joints on a bound" not in result.stdout
    assert "joints on a bound" not in call("track", "--job", "job.toml").stdout
    assert "joints on a bound" in call("track", "--job", "job.toml", "--limits", "--save-job", "job.toml").stdout
    assert "joints on a bound" in call("track", "--job", "job.toml").stdout


def test_the_default_circle_shrinks_until_the_tip_can_follow() -> None:
    """In this posture, the Panda cannot follow a circle of 0.1 m."""
    almost_straight = ["--q0", "0,0,0,-0.1,0,0.5,0"]
    result = call("track", "panda", *almost_straight)
    assert "radius = 0.05" in result.stdout
    assert "complete, t = 10 s" in result.stdout
    result = call("track", "panda", *almost_straight, "--radius", "0.1")
    assert "complete" not in result.stdout


@pytest.mark.parametrize(
    ("arguments", "remedy"),
    [
        (("planar:0.1,0.1,0.1", "--radius", "0.1"), "Make the path smaller, or choose another start posture"),
        (("panda", "--radius", "0.1", "--duration", "0.5"), "Increase the duration to slow the path"),
    ],
)
def test_a_tip_that_left_its_path_is_not_complete(arguments: tuple[str, ...], remedy: str) -> None:
    result = call("track", *arguments, "--out", "out")
    assert result.exit_code == 0
    run = fp.load("out/run.npz")
    assert run.max_error() > 1e-3
    text = " ".join(result.stdout.split())
    assert "complete" not in text
    assert f"the tip was up to {run.max_error():.3g} m from its path" in text
    assert remedy in text
    assert "complete" not in str(run.status)
    assert "complete" not in repr(run)
    drifted = fp.RunStatus(fp.Status.OK, 1.0, run.q[-1], 0.002)
    assert str(drifted).startswith(
        "ended, t = 1 s; the tip was up to 0.002 m from its path. Give the scheme larger gains"
    )


def test_the_comparison_in_python_is_that_of_the_command() -> None:
    result = call(
        "compare", "planar:0.1,0.1,0.1", "--radius", "0.1", "--schemes", "mvn,fpbm", "--limits", "--out", "out"
    )
    runs = {name: fp.load(f"out/{name}.npz") for name in ("mvn", "fpbm")}
    table = fp.comparison(runs)
    assert str(table) in result.stdout
    assert table.complete == {"mvn": "off its path", "fpbm": "off its path"}
    assert table.figures["mvn"]["max_error"] == runs["mvn"].max_error()
    html = table._repr_html_()
    assert "<th>mvn</th><td>off its path</td>" in html
    assert str(fp.comparison(list(runs.values()))).splitlines()[3].startswith("FPBM ")
    with pytest.raises(ValueError, match="at least one run"):
        fp.comparison([])


def test_prismatic_joints_have_metres() -> None:
    joints = "".join(f"[[arm.joints]]\ntype = 'prismatic'\naxis = {axis}\n" for axis in np.eye(3).tolist())
    Path("gantry.toml").write_text(f"[arm]\nkind = 'joints'\n{joints}")
    result = call("track", "--job", "gantry.toml", *QUICK)
    assert re.search(r"peak joint velocity +\S+ m/s ", result.stdout)
    assert re.search(r"final joint acceleration +\S+ m/s\^2 ", result.stdout)


def test_a_motion_that_stops_is_reported_and_exits_with_1() -> None:
    result = call("track", "panda", "--radius", "3", "--no-limits")
    assert result.exit_code == 1
    assert "status" in result.stdout
    assert "stopped after t = " in result.stdout
    assert "Keep the path inside the workspace" in " ".join(result.stdout.split())
    assert result.stderr == "Error: the motion is not complete: the status above has the cause and a remedy\n"


def test_a_motion_without_a_sample() -> None:
    result = call("track", "planar:1,1,1,1", "--q0", "0,0,0,0", "--no-limits")
    assert result.exit_code == 1
    assert "the posture is singular" in result.stdout


def test_out(folder: Path) -> None:
    result = call("track", "panda", *QUICK, "--out", "a/b", "--dark")
    assert result.exit_code == 0, result.output
    assert sorted(os.listdir("a/b")) == ["job.toml", "run.npz", "run.png"]
    assert Path("a/b/run.png").read_bytes().startswith(b"\x89PNG")
    assert result.stdout.splitlines()[-1] == f"Written to {Path('a/b')}: run.png, run.npz, job.toml"
    again = prepare(read_job("a/b/job.toml")).run()
    np.testing.assert_array_equal(np.load("a/b/run.npz")["q"], again.q)
    assert call("track", "--job", "a/b/job.toml").exit_code == 0


@pytest.mark.usefixtures("small_figures")
def test_also_writes_further_formats(monkeypatch: pytest.MonkeyPatch) -> None:
    plot = importlib.import_module("fpbm_cpp.plot")
    monkeypatch.setattr(plot, "animate", lambda run, file, *, dark: file.write_text(f"{len(run.t)} {dark}"))
    result = call("track", "panda", *QUICK, "--out", "out", "--also", "csv", "--also", "gif", "--dark")
    assert result.exit_code == 0, result.output
    assert sorted(os.listdir("out")) == ["job.toml", "run.csv", "run.gif", "run.npz", "run.png"]
    assert Path("out/run.gif").read_text() == "201 True"
    assert call("track", "panda", "--also", "csv").exit_code == 2


def test_limits() -> None:
    bounds = ["--limit-velocity", "0.05", "--limit-acceleration", "5"]
    for arguments in (["--limits", *bounds], bounds):
        result = call("track", "planar:1,1,1,1", "--radius", "0.1", "--duration", "2", *arguments)
        assert result.exit_code == 0
        assert "m from its path: at times, joint limits" in " ".join(result.stdout.split())
        assert "joints on a bound" in result.stdout
        assert re.search(r"peak joint velocity +0\.05 ", result.stdout)
    Path("job.toml").write_text(
        "[arm]\nkind = 'planar'\nlengths = [1, 1, 1]\n[limits]\nvelocity = 0.1\nacceleration = 5"
    )
    assert "joints on a bound" in call("track", "--job", "job.toml").stdout
    assert "joints on a bound" not in call("track", "--job", "job.toml", "--no-limits").stdout
    fast = call(*["track", "panda", "--radius", "0.1", "--duration", "0.4", "--dt", "0.01", "--no-limits"]).stdout
    assert re.search(r"joints beyond a bound +\d +panda_joint.*: --limits keeps the bounds", fast)
    assert "beyond" not in call("track", "panda", "--duration", "5", "--no-limits").stdout
    line = error_of("track", "planar:1,1,1", "--limit-velocity", "1")
    assert line.startswith("--limit-acceleration: is missing, and this arm has no acceleration bounds: 10 (rad/s^2) is")


def test_limits_of_an_arm_without_acceleration_bounds() -> None:
    shutil.copy(ROOT / "examples/04_exported_arm.urdf", "arm.urdf")
    arm = ["arm.urdf", "--tip", "tool", "--duration", "2"]
    shown_text = (
        "is missing, and this arm has no acceleration bounds: 10 (rad/s^2) is usual, for example "
        "--limit-acceleration 10, or acceleration = 10 under [limits] in a job"
    )
    for name in MOTIONS:
        assert error_of(name, *arm, "--limits") == f"--limit-acceleration: {shown_text}"
    Path("job.toml").write_text("[arm]\nkind = 'urdf'\nfile = 'arm.urdf'\ntip = 'tool'\n[limits]\n")
    assert error_of("track", "--job", "job.toml") == f"--limit-acceleration: {shown_text}"
    assert call("track", *arm, "--limit-acceleration", "10").exit_code == 0


def test_sweep_and_tune_keep_limits(folder: Path) -> None:
    limits = ["--limit-velocity", "0.05", "--limit-acceleration", "5"]
    quick = ["planar:1,1,1,1", "--duration", "2", "--dt", "0.01"]
    assert call("sweep", *quick, "--starts", "3", *limits, "--out", "out").exit_code == 0
    rows = list(csv.DictReader(Path("out/sweep.csv").read_text().splitlines()))
    assert {row["status"] for row in rows} <= {"OK", "SLOWED"}
    peaks = [float(row["peak_velocity"]) for row in rows]
    assert max(peaks) <= 0.05 * (1 + 1e-9)
    assert call("sweep", *quick, "--starts", "3", "--out", "free").exit_code == 0
    rows = list(csv.DictReader(Path("free/sweep.csv").read_text().splitlines()))
    assert min(float(row["peak_velocity"]) for row in rows) > 0.05
    result = call("tune", *quick, "--duration", "20", "--trials", "20", *limits, "--out", "out")
    assert result.exit_code == 0, result.output
    assert read_job("out/job.toml")["limits"] == {"velocity": 0.05, "acceleration": 5.0}


# Jobs


def test_options_are_equivalent_to_a_file() -> None:
    arguments = ["planar:1,0.5,0.5", "--path", "lissajous", "--amplitude", "0.05,0.1", "--frequencies", "1,2"]
    arguments += ["--scheme", "balanced", "--alpha", "0.25", "--weights", "2,1,0; 1,2,0; 0,0,1", "--q0", "-0.1,0.5,1e0"]
    result = call("track", *arguments, *QUICK, "--dt", "0.002", "--save-job", "job.toml")
    assert result.exit_code == 0, result.output
    job = read_job("job.toml")
    assert job["arm"]["lengths"] == [1.0, 0.5, 0.5]
    assert job["path"]["amplitude"] == [0.05, 0.1]
    assert job["path"]["frequencies"] == [1, 2]
    assert job["scheme"]["weights"] == [[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 1.0]]
    assert job["run"]["q0"] == [-0.1, 0.5, 1.0]
    again = call("track", "--job", "job.toml")
    assert again.stdout.splitlines()[2:] == result.stdout.split("\n\n", 1)[1].splitlines()


def test_options_override_a_file() -> None:
    write_job({"arm": {"kind": "preset", "name": "panda"}, "path": {"kind": "circle", "duration": 0.2}}, "job.toml")
    for arguments, key, value in (
        (["--radius", "0.05"], "radius", 0.05),
        (["--path", "tricuspid"], "size", 0.05),
        (["--scheme", "man"], "kind", "man"),
        (["gen3"], "name", "gen3"),
    ):
        result = call("track", *arguments, "--job", "job.toml", "--save-job", "other.toml")
        assert result.exit_code == 0, result.output
        job = read_job("other.toml")
        assert value in [job[section].get(key) for section in ("arm", "path", "scheme")]
        assert job["path"]["duration"] == 0.2


def test_several_paths_of_a_file_reject_path_options() -> None:
    Path("job.toml").write_text("[arm]\nkind = 'planar'\nlengths = [1, 1, 1]\n" + "[[path]]\nkind = 'circle'\n" * 2)
    assert error_of("track", "--job", "job.toml", "--radius", "0.1").startswith("--radius: the file has 2 paths")
    assert call("track", "--job", "job.toml", "--path", "circle", "--radius", "0.1", *QUICK).exit_code == 0


def test_a_job_that_fails_is_not_saved() -> None:
    error_of("track", "panda", "--dt", "0.3", "--save-job", "job.toml")
    error_of("track", "panda", "--qd0", "1", "--save-job", "job.toml")
    assert not Path("job.toml").exists()


@pytest.mark.parametrize("name", ["q", "qd", "qdd"])
def test_a_joint_beyond_a_bound_is_reported(name: str) -> None:
    run = prepare({"arm": {"kind": "preset", "name": "panda"}, "run": {"dt": 0.01}}).run()
    values = getattr(run, name).copy()
    values[50, 2] = -20.0
    assert "beyond" not in summary(run)
    shown_text = summary(replace(run, **{name: values}))
    assert re.search("joints beyond a bound +1 +panda_joint3: --limits keeps the bounds", shown_text)


def test_a_motion_without_samples_has_no_animation() -> None:
    result = call("track", "planar:1,1", "--q0", "0,0", "--no-limits", "--out", "out", "--also", "gif")
    assert result.exit_code == 1
    assert result.stderr == (
        "Error: cannot write run.gif: run: has no samples: must have at least one: run.status has the cause\n"
    )


# Errors


TWO_BRANCHES = """<robot name="two"><link name="base"/><link name="camera"/><link name="hand"/>
<joint name="eye" type="fixed"><parent link="base"/><child link="camera"/></joint>
<joint name="arm" type="continuous"><parent link="base"/><child link="hand"/></joint></robot>"""


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (
            ["pnada"],
            "ARM = 'pnada': must be one of panda, fr3, iiwa14, gen3, ur5e, ur10e, xarm7, so101, openarm, z1, "
            "two_pandas, g1_upper_body, planar:1,1,1,1, "
            "a URDF file; did you mean 'panda'?",
        ),
        (["planar:1,a"], "ARM = planar:1,a: must be planar: and the link lengths, as in planar:1,1,1,1"),
        (["planar:1,-1"], "lengths[1] = -1: must be positive and finite"),
        (["none.urdf", "--tip", "tool"], "cannot read none.urdf: No such file or directory"),
        (["none.urdf"], "cannot read none.urdf: No such file or directory"),
        (["two.urdf"], "--tip = '': must be a link; branches end in 'hand', 'camera'"),
        (
            ["two.urdf", "--tip", "hnd"],
            "--tip = 'hnd': must be a link, perhaps 'hand'; branches end in 'hand', 'camera'",
        ),
        (["panda", "--tip", "tool"], "--tip: is not a key of preset: must be one of name"),
        (["panda", "--radius", "-1"], "--radius = -1: must be positive and finite"),
        (["panda", "--alpha", "x"], "--alpha = 'x': must be a number"),
        (["panda", "--scheme", "fbpm"], "minimum_torque; did you mean 'fpbm'?"),
        (["panda", "--scheme", "man", "--alpha", "1"], "--alpha: is not a key of man: must be one of null_damping, "),
        (["panda", "--weights", "1,2"], "--weights has 2 entries: must have 7, one per joint"),
        (["panda", "--q0", "0,0"], "--q0 has 2 entries: must have 7, one per joint"),
        (["panda", "--qd0", "0,0"], "--qd0 has 2 entries: must have 7, one per joint"),
        (["panda", "--dt", "0.3"], "--dt = 0.3: must be a divisor of duration = 10"),
        (["panda", "--task", "pos"], "--task = 'pos': must be one of position, pose; did you mean 'pose'?"),
        (["panda", "--path", "waypoints", "--duration", "1"], "--points: is missing"),
        (["panda", "--path", "waypoints", "--points", "0,0;1,0"], "path: has no duration: give a duration"),
        (["planar:1,1", "--in-plane", "xy"], "path: is in space, and the arm is planar: must be a planar path"),
        (["panda", "--at-speed", "0.1"], "--at-acceleration: is missing: a constant speed needs at_speed and at_accel"),
        (["panda", "--at-jerk", "1"], "--at-speed: is missing: a constant speed needs at_speed and at_acceleration"),
        (["panda", "--at-speed", "-1", "--at-acceleration", "1"], "--at-speed = -1: must be positive and finite"),
        (["panda", "--at-speed", "1", "--at-acceleration", "x"], "--at-acceleration = 'x': must be a number"),
        (["panda", "--reserve", "0.1"], "--reserve: has no effect without keep_path: give keep_path"),
        (["panda", "--keep-path", "--reserve", "-1"], "--reserve = -1: must be finite and not negative"),
        (["panda", "--keep-path", "--qd0", "1,0,0,0,0,0,0"], "--qd0: must be zero with keep_path"),
        (["panda", "--keep-path", "--q0", "0,0"], "--q0 has 2 entries: must have 7, one per joint"),
        (["panda", "--keep-path", "--radius", "0.6"], "path: can be followed to the fraction 0."),
        (["planar:1,1,1", "--keep-path"], "--limit-acceleration[0] = inf: must be finite"),
        (["--job", "none.toml"], "cannot read none.toml: No such file or directory"),
        (["--job", "bad.toml"], "bad.toml: must be valid TOML: "),
        (["--job", "wrong.toml"], "wrong.toml: path.radius = -1: must be positive and finite"),
        (["--job", "wrong.toml", "--radius", "-2"], "--radius = -2: must be positive and finite"),
        (["--job", "wrong.toml", "--radius", "1", "--path", "cirle"], "--path = 'cirle': must be one of "),
    ],
)
def test_invalid_options_are_reported(arguments: list[str], line: str) -> None:
    Path("bad.toml").write_text("[arm")
    Path("two.urdf").write_text(TWO_BRANCHES)
    Path("wrong.toml").write_text("[arm]\nkind = 'preset'\nname = 'panda'\n[path]\nkind = 'circle'\nradius = -1")
    assert line in error_of("track", *arguments, "--out", "out", "--save-job", "job.toml")
    assert sorted(os.listdir()) == ["bad.toml", "two.urdf", "wrong.toml"]


def test_every_invalid_option_is_reported() -> None:
    result = call("track", "panda", "--alpha", "x", "--dt", "y", "--q0", "z")
    assert result.exit_code == 1
    assert [line.split(" = ")[0] for line in result.stderr.splitlines()] == [
        "Error: --alpha",
        "Error: --q0",
        "Error: --dt",
    ]


def test_a_missing_arm_is_reported() -> None:
    result = call("track")
    assert result.exit_code == 2
    assert (
        "Missing argument 'ARM': panda, fr3, iiwa14, gen3, ur5e, ur10e, xarm7, so101, openarm, z1, "
        "two_pandas, g1_upper_body, planar:1,1,1,1 or a URDF file." in result.stderr
    )


def test_a_folder_that_cannot_be_written_to() -> None:
    Path("file").write_text("mine")
    for name in ("sweep",):
        assert error_of(name, "panda", *QUICK, "--out", "file") == "cannot write to file: it is a file: give a folder"
        assert error_of(name, "panda", *QUICK, "--out", "file/below") == "cannot write to file/below: Not a directory"
    line = call("track", "panda", *QUICK, "--save-job", "file/job.toml").stderr
    assert line == "Error: cannot write to file/job.toml: Not a directory\n"
    assert Path("file").read_text() == "mine"
    assert os.listdir() == ["file"]


@pytest.mark.usefixtures("small_figures")
def test_an_unwritable_folder_of_figures_is_reported() -> None:
    Path("file").write_text("mine")
    for name in ("track", "compare"):
        result = call(name, "panda", *QUICK, "--out", "file")
        assert result.exit_code == 1
        assert result.stderr.startswith("Error: cannot write to file")
        assert len(result.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("module", "arguments"),
    [
        ("tomlkit", ["track", "panda"]),
        ("matplotlib", ["track", "panda", "--duration", "0.1", "--out", "out"]),
    ],
)
def test_missing_extra(module: str, arguments: list[str]) -> None:
    shutil.copy(ROOT / "examples/04_exported_arm.urdf", "arm.urdf")
    program = (
        f"import sys; sys.modules['{module}'] = None; sys.argv = {['fpbm-cpp', *arguments]}\n"
        "from fpbm_cpp.__main__ import main; sys.exit(main())"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert result.returncode == 1
    (line,) = result.stderr.splitlines()
    assert f"needs {module}: pip install" in line
    assert os.listdir() == ["arm.urdf"]


# Compare


def test_compare() -> None:
    arguments = ["--radius", "0.1", "--weights", "1,2,3,4", "--alpha", "0.3", "--k", "5", *QUICK]
    result = call("compare", "planar:1,1,1,1", *arguments)
    assert result.exit_code == 0, result.output
    rows = [line.split() for line in result.stdout.split("\n\n")[1].splitlines()[2:]]
    assert [row[0] for row in rows] == ["mvn", "wmvn", "man", "wmvn_acceleration", "balanced", "fpbm"]
    q0, path = [np.pi / 6] * 4, fp.Circle(0.1, 0.2)
    q0 = [0.5236] * 4
    for row, scheme in zip(
        rows,
        [
            fp.MVN(k=5),
            fp.WMVN([1, 2, 3, 4], k=5),
            fp.MAN(null_damping=2),
            fp.WMVNAcceleration([1, 2, 3, 4], null_damping=2),
            fp.Balanced(0.3, [1, 2, 3, 4], null_damping=2),
            fp.FPBM(0.3, [1, 2, 3, 4], 10, 25, null_damping=2),
        ],
    ):
        run = fp.simulate(fp.PlanarArm([1, 1, 1, 1]), path, scheme, q0)
        assert row[1] == "yes"
        assert row[3] == f"{np.abs(run.qd).max():.4g}"


@pytest.mark.usefixtures("small_figures")
def test_compare_writes() -> None:
    result = call("compare", "panda", *QUICK, "--schemes", "mvn,fpbm", "--out", "out")
    assert result.exit_code == 0, result.output
    assert sorted(os.listdir("out")) == ["compare.png", "fpbm.npz", "job.toml", "mvn.npz"]


def test_compare_rejects_invalid_options() -> None:
    assert error_of("compare", "panda", "--schemes", "mvn,fbpm").startswith("--schemes = 'fbpm': must be one of mvn, ")
    assert (
        error_of("compare", "panda", "--weights", "1") == "--weights = 1: must be real numbers of shape (n,) or (n, n)"
    )
    Path("job.toml").write_text("[arm]\nkind = 'preset'\nname = 'panda'\n[scheme]\nkind = 'fpbm'\nalhpa = 1")
    assert "did you mean 'alpha'?" in error_of("compare", "--job", "job.toml", "--schemes", "fpbm")
    result = call("compare", "planar:1,1,1,1", "--q0", "0,0,0,0")
    assert result.exit_code == 1
    assert result.stderr == "Error: no motion is complete: the remarks above have the causes and remedies\n"


# Sweep


def test_sweep() -> None:
    arguments = [
        "sweep",
        "panda",
        "--radius",
        "0.1",
        *QUICK,
        "--vary",
        "alpha=0:1:3",
        "--vary",
        "null-damping=0,2",
        "--starts",
        "5",
    ]
    result = call(*arguments, "--out", "out")
    assert result.exit_code == 0, result.output
    rows = list(csv.DictReader(Path("out/sweep.csv").read_text().splitlines()))
    assert len(rows) == 3 * 2 * 5
    assert [row["alpha"] for row in rows[::10]] == ["0.0", "0.5", "1.0"]
    assert [row["null_damping"] for row in rows[:10:5]] == ["0.0", "2.0"]
    row = rows[-1]
    start = [float(row[key]) for key in row if key.startswith("q0_")]
    scheme = fp.FPBM(1.0, np.ones(7), 10, 25, null_damping=2)
    run = fp.simulate(fp.SerialArm.preset("panda"), fp.Circle(0.1, 0.2).in_plane("yz"), scheme, start)
    assert float(row["peak_velocity"]) == pytest.approx(np.abs(run.qd).max(), rel=1e-9)
    worst = max(float(each["peak_velocity"]) for each in rows[-5:])
    assert f" {worst:.4g} " in result.stdout.splitlines()[-3]
    first = Path("out/sweep.csv").read_text()
    call(*arguments, "--out", "out", "--workers", "1")
    assert Path("out/sweep.csv").read_text() == first
    call(*arguments, "--out", "out", "--seed", "1")
    assert Path("out/sweep.csv").read_text() != first


def test_sweep_rejects_invalid_options() -> None:
    assert error_of("sweep", "panda", "--vary", "alpha").startswith(
        "--vary alpha: must have the form alpha=0,0.6,1 or "
    )
    assert error_of("sweep", "panda", "--vary", "alpha=0:1").startswith("--vary alpha=0:1: must have the form ")
    assert "did you mean 'alpha'?" in error_of("sweep", "panda", "--vary", "alhpa=1")
    assert error_of("sweep", "panda", "--vary", "alpha=2") == "--alpha = 2: must be in [0, 1]"
    assert "remove qd0" in error_of("sweep", "panda", "--qd0", "0,0,0,0,0,0,0")


def test_sweep_reports_motions_that_stop() -> None:
    result = call("sweep", "panda", "--radius", "0.5", "--starts", "3")
    assert result.exit_code == 1
    assert "3 of 3: the tip has left its reference" in result.stdout
    assert result.stderr == "Error: no motion is complete: the remarks above have the causes and remedies\n"


def interrupted(arguments: list[str], after: str, seconds: float) -> tuple[str, str, int]:
    """Later output, errors and exit code of a call that gets Ctrl-C after it prints this text and the delay is over."""

    def restore_interrupts() -> None:  # Background jobs of a shell ignore SIGINT.
        signal.signal(signal.SIGINT, signal.SIG_DFL)

    program = (
        "import signal, sys, threading\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        f"sys.argv = {['fpbm-cpp', *arguments]}\n"
        "from fpbm_cpp.__main__ import main\n"
        "sys.exit(main())"
    )
    start = [sys.executable, "-u", "-c", program]
    with subprocess.Popen(
        start, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=restore_interrupts
    ) as child:
        assert child.stdout is not None
        try:
            while after not in child.stdout.readline():
                assert child.poll() is None
            time.sleep(seconds)
            child.send_signal(signal.SIGINT)
            return (*child.communicate(timeout=60), child.wait())
        finally:
            child.kill()


@posix
def test_ctrl_c_keeps_finished_motions() -> None:
    arguments = ["sweep", "panda", "--duration", "0.5", "--starts", "40000", "--out", "out"]
    out, err, code = interrupted(arguments, "by default", 2.0)
    assert code == 130
    (line,) = err.splitlines()
    done = int(re.fullmatch(r"interrupted after (\d+) of 40000 motions", line)[1])  # type: ignore[index]
    assert f"{done} of 40000" in out
    assert len(Path("out/sweep.csv").read_text().splitlines()) == 1 + done > 1


# Tune, view, bench, completion


def test_tune() -> None:
    result = call(
        "tune", "planar:1,1,1,1", "--duration", "1", "--dt", "0.01", "--trials", "20", "--save-job", "job.toml"
    )
    assert result.exit_code == 0, result.output
    assert "peak_velocity" in result.stdout
    assert error_of("tune", "panda", "--objective", "speed")


@pytest.mark.usefixtures("small_figures")
def test_tune_writes_a_job() -> None:
    arguments = ["planar:1,1,1,1", "--duration", "1", "--dt", "0.01"]
    result = call("tune", *arguments, "--trials", "20", "--out", "out")
    assert result.exit_code == 0, result.output
    tuned, plain = call("track", "--job", "out/job.toml"), call("track", *arguments)
    peaks = [float(re.search(r"peak joint velocity +(\S+)", each.stdout)[1]) for each in (tuned, plain)]  # type: ignore[index]
    assert peaks[0] <= 1.01 * peaks[1]  # The tuner simulates: a tick of 10 ms is not a step of RK4.


class Shown:
    """A viewer that ends immediately."""

    def wait(self) -> None:
        click.echo("waited")


@pytest.mark.parametrize("limits", [(), ("--limits",)])
def test_view(limits: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    """Passes the requested run to a viewer that ends immediately."""
    shown = []
    monkeypatch.setitem(vars(viewer), "Viewer", lambda run, **how: shown.append((run, how)) or Shown())
    result = call("view", "panda", "--task", "pose", "--port", "9000", "--no-browser", "--hold", "1", *limits)
    assert result.exit_code == 0, result.output
    ((run, how),) = shown
    assert (run.arm, run.task, run.t[-1]) == (fp.SerialArm.preset("panda"), "pose", 11.0)
    assert (run.scale is not None) == bool(limits)
    assert how == {"urdf": None, "port": 9000, "open_browser": False}
    assert result.stdout.splitlines()[-1] == "waited"


def test_warnings_have_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(
        vars(viewer), "Viewer", lambda run, **how: warnings.warn("a mesh is missing", stacklevel=1) or Shown()
    )
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        result = call("view", "panda", *QUICK)
    assert (result.exit_code, result.stderr) == (0, "Warning: a mesh is missing\n")


def test_view_on_a_port_in_use() -> None:
    pytest.importorskip("viser")
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        result = call("view", "panda", "--port", str(port), "--no-browser")
    assert result.exit_code == 1
    (line,) = result.stderr.splitlines()
    assert f"port {port} is in use" in line


@posix
def test_ctrl_c_ends_the_viewer_without_an_error() -> None:
    pytest.importorskip("viser")
    out, err, code = interrupted(
        ["view", "panda", *QUICK, "--port", "0", "--no-browser"], ": Ctrl-C stops the server.", 1.0
    )
    assert (code, err, out) == (0, "", "")  # The address of the page is printed once.


@posix
@pytest.mark.parametrize("seconds", [0.0, 0.2, 0.5])
def test_ctrl_c_ends_the_viewer_during_its_start(seconds: float) -> None:
    pytest.importorskip("viser")
    arguments = ["view", "panda", *QUICK, "--port", "0", "--no-browser"]
    _, err, code = interrupted(arguments, "by default", seconds)
    assert (code, err) == (0, "")


# Servo


@pytest.mark.parametrize("task", ["position", "pose"])
def test_servo(task: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Passes the request to a page that ends immediately."""
    shown = []
    monkeypatch.setitem(vars(viewer), "Servo", lambda *what, **how: shown.append((what, how)) or Shown())
    bounds = ["--limit-velocity", "0.5", "--limit-jerk", "1000"]
    result = call("servo", "panda", "--task", task, "--port", "9000", "--no-browser", "--k1", "7", *bounds)
    assert result.exit_code == 0, result.output
    (((arm, scheme, q0), how),) = shown
    panda = fp.SerialArm.preset("panda")
    assert (arm, scheme) == (panda, fp.FPBM(0.6, np.ones(7), 7, 25, null_damping=2))
    assert q0[3] == -2.3562
    limits = how.pop("limits")
    assert how.pop("bounds") == ()
    assert how == {"task": task, "stack": None, "dt": 1e-3, "urdf": None, "port": 9000, "open_browser": False}
    assert (limits.velocity == 0.5).all()
    assert (limits.jerk == 1000).all()
    np.testing.assert_array_equal(limits.acceleration, panda.limits.acceleration)
    lines = result.stdout.splitlines()
    assert (lines[0], lines[-1]) == ("panda, fpbm", "waited")
    assert "radius" not in result.stdout


STACK = """
[arm]
kind = "preset"
name = "panda"

[run]
task = "seam"
dt = 0.01

[path]
kind = "circle"
radius = 0.05
duration = 1.0

[[task]]
kind = "position"
name = "seam"

[[task]]
level = 1
kind = "axis"
name = "torch"
"""


def test_servo_and_view_accept_jobs_of_stacks(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = []
    for page in ("Servo", "Viewer"):
        monkeypatch.setitem(vars(viewer), page, lambda *what, **how: shown.append((what, how)) or Shown())
    Path("stack.toml").write_text(STACK)
    for name in ("servo", "view"):
        result = call(name, "--job", "stack.toml", "--no-browser")
        assert result.exit_code == 0, result.output
    ((_, scheme, _), how), ((run,), _) = shown
    stack = fp.Stack(fp.PositionTask(name="seam"), fp.AxisTask(name="torch"))
    assert how["stack"] == run.stack == stack
    assert (scheme.k1, run.task) == (0, "seam")


def test_servo_accepts_a_stack_of_a_job() -> None:
    """The command accepts the job, and fails later, when it opens the port."""
    pytest.importorskip("viser")
    Path("stack.toml").write_text(STACK)
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = str(server.getsockname()[1])
        assert f"port {port} is in use" in error_of("servo", "--job", "stack.toml", "--port", port, "--no-browser")


def test_servo_has_no_path_options_and_always_limits() -> None:
    result = call("servo", "--help")
    headings = [line for line in result.output.splitlines() if line and line[0] != " " and line.endswith(":")]
    assert headings == ["Options:", "Arm and start:", "Scheme:", "Joint limits:", "Clearance:"]
    assert result.output.isascii()
    assert len(examples("servo")) == 5
    for option in ("--radius", "--hold", "--qd0", "--limits", "--no-limits"):
        assert call("servo", "panda", option, "1").exit_code == 2


def test_servo_reports_invalid_options() -> None:
    shutil.copy(ROOT / "examples/04_exported_arm.urdf", "arm.urdf")
    shown_text = (
        "--limit-acceleration: is missing, and this arm has no acceleration bounds: 10 (rad/s^2) is usual, for example "
        "--limit-acceleration 10, or acceleration = 10 under [limits] in a job"
    )
    assert error_of("servo", "arm.urdf", "--tip", "tool") == shown_text
    assert error_of("servo", "planar:1,1,1", "--limit-velocity", "1") == shown_text
    assert error_of("servo", "panda", "--task", "dance").startswith("--task = 'dance': must be one of")
    assert error_of("servo", "panda", "--q0", "1,2").startswith("--q0 has 2 entries")
    assert error_of("servo", "robot").startswith("ARM = 'robot': must be one of")
    Path("job.toml").write_text("[arm]\nkind = 'preset'\nname = 'panda'\n[run]\nqd0 = [0.1, 0, 0, 0, 0, 0, 0]")
    assert error_of("servo", "--job", "job.toml") == "servo starts at rest: remove qd0, or use track"
    pytest.importorskip("viser")
    assert error_of("servo", "panda", "--q0", "9,0,0,-2,0,2,0") == (
        "--q0[0] = 9: must be within the joint's range, from -2.8973 to 2.8973: positions are in radians, and the "
        "value looks like degrees; multiply it by pi/180, or give recover_start = true, with which the joint returns"
    )
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        assert f"port {port} is in use" in error_of("servo", "panda", "--port", str(port), "--no-browser")


@posix
def test_ctrl_c_ends_servo_without_an_error() -> None:
    pytest.importorskip("viser")
    out, err, code = interrupted(["servo", "panda", "--port", "0", "--no-browser"], ": Ctrl-C stops the server.", 1.0)
    assert (code, err, out) == (0, "", "")


def test_bench_worst() -> None:
    """Each case's longest tick takes longer than its free tick."""
    result = call("bench", "--worst", "--runs", "2")
    assert result.exit_code == 0, result.output
    rows = [line.split() for line in result.output.splitlines() if line.startswith("panda/")]
    assert [row[0] for row in rows] == [
        "panda/pose_jerk", "panda/pose", "panda/position_jerk", "panda/position", "panda/three_levels"
    ]  # fmt: skip
    assert [int(row[-1]) for row in rows] == [42, 21, 42, 21, 126]
    for row in rows:
        free, median, most, worst = (float(each) for each in row[1:5])
        assert free < worst
        assert median <= most <= worst


def test_bench() -> None:
    result = call("bench", "--seconds", "0.01")
    assert result.exit_code == 0, result.output
    rows = {line.split("  ")[0]: re.findall(r"[\d.]+$|[\d.]+ ", line) for line in result.stdout.splitlines()}
    for name in ("MVN", "WMVN", "MAN", "WMVNAcceleration", "Balanced", "FPBM"):
        assert all(0.01 < float(number) < 1000 for number in rows[name])
        assert len(rows[name]) == 3
    assert all(float(number) > 0 for number in rows["motions per second"])
    assert max(map(len, result.stdout.splitlines())) <= 100


@pytest.mark.parametrize(
    ("shell", "mark"), [("bash", "complete -o"), ("zsh", "#compdef"), ("fish", "complete --no-files")]
)
def test_completion(shell: str, mark: str) -> None:
    result = call("completion", shell)
    assert result.exit_code == 0
    assert mark in result.stdout
    assert "_FPBM_CPP_COMPLETE" in result.stdout


@pytest.mark.parametrize(
    ("words", "completed"),
    [
        ("fpbm-cpp tra", "track"),
        ("fpbm-cpp track panda --scheme fp", "fpbm"),
        ("fpbm-cpp track --null-d", "--null-damping"),
    ],
)
def test_words_are_completed(words: str, completed: str) -> None:
    environment = {
        **os.environ,
        "_FPBM_CPP_COMPLETE": "bash_complete",
        "COMP_WORDS": words,
        "COMP_CWORD": str(len(words.split()) - 1),
    }
    result = subprocess.run(MODULE, env=environment, capture_output=True, text=True, check=False)
    assert f"plain,{completed}" in result.stdout
