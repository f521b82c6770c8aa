"""Jobs: the library makes the objects of a file, and errors name the key."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fpbm_cpp as fp

pytest.importorskip("tomlkit")

import tomlkit

from fpbm_cpp.job import JobError, prepare, read_job, write_job
from fpbm_cpp.job.motion import ready
from fpbm_cpp.job.sections import known
from fpbm_cpp.parameter import parameters
from fpbm_cpp.paths import PATH_OPTIONS, PATHS
from fpbm_cpp.schemes import SCHEMES

ROOT = Path(__file__).parents[2]
PANDA = {"kind": "preset", "name": "panda"}
PLANAR = {"kind": "planar", "lengths": [1, 1, 1, 1]}
READY = [0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854]
DH = [[0, np.pi / 2, 0.3, 0], [0.4, 0, 0, 0.1], [0.3, -0.2, 0.1, 0], [0.1, 0.5, 0, 0]]


def job_of(text: str) -> dict[str, Any]:
    return tomlkit.parse(text).unwrap()


def errors_of(text: str) -> list[str]:
    with pytest.raises(JobError) as caught:
        prepare(job_of(text))
    return str(caught.value).splitlines()


# The library makes the objects of a job.


@pytest.mark.parametrize(
    ("table", "arm"),
    [
        (PANDA, fp.SerialArm.preset("panda")),
        (PLANAR, fp.PlanarArm([1, 1, 1, 1])),
        (
            {"kind": "urdf", "file": str(ROOT / "examples/04_exported_arm.urdf"), "tip": "tool"},
            fp.SerialArm.from_urdf(ROOT / "examples/04_exported_arm.urdf", "tool"),
        ),
        (
            {"kind": "dh", "table": DH, "convention": "modified", "names": list("abcd"), "lower": [-1] * 4},
            fp.SerialArm.from_dh(DH, "modified", names=list("abcd"), lower=[-1] * 4),
        ),
        (
            {
                "kind": "joints",
                "joints": [{"type": "prismatic", "axis": [0, 1, 0], "upper": 1.0}, {}, {"name": "last"}],
                "tip": [[1, 0, 0, 0.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
            },
            fp.SerialArm(
                [fp.Joint("prismatic", axis=(0, 1, 0), upper=1.0), fp.Joint(), fp.Joint(name="last")],
                [[1, 0, 0, 0.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
            ),
        ),
    ],
    ids=["preset", "planar", "urdf", "dh", "joints"],
)
def test_arms(table: dict[str, Any], arm: Any) -> None:
    assert prepare({"arm": table}).arm == arm


@pytest.mark.parametrize(
    ("text", "path"),
    [
        ("kind = 'circle'\nradius = 0.2\nduration = 3", fp.Circle(0.2, 3.0)),
        ("kind = 'circle'\nradius = 0.2\ntime_law = 'quintic'", fp.Circle(0.2, 10.0, time_law="quintic")),
        (
            "kind = 'lissajous'\namplitude = [0.1, 0.2]\nfrequencies = [1, 2]\nphase = 0.5",
            fp.Lissajous((0.1, 0.2), 10.0, frequencies=(1, 2), phase=0.5),
        ),
        ("kind = 'tricuspid'\nsize = 0.1", fp.Tricuspid(0.1, 10.0)),
        ("kind = 'line'\ndisplacement = [0.1, 0.2, 0.3]", fp.Line([0.1, 0.2, 0.3], 10.0)),
        (
            "kind = 'waypoints'\npoints = [[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0]]\nduration = 3",
            fp.Waypoints([[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0]], duration=3.0),
        ),
        (
            "kind = 'waypoints'\npoints = [[0, 0], [0.1, 0], [0.1, 0.1]]\nvelocity = 0.1\nacceleration = 0.2",
            fp.Waypoints([[0, 0], [0.1, 0], [0.1, 0.1]], velocity=0.1, acceleration=0.2),
        ),
        (
            "kind = 'polyline'\npoints = [[0, 0], [0.1, 0], [0.1, 0.1]]\nblend = 0.01",
            fp.Polyline([[0, 0], [0.1, 0], [0.1, 0.1]], 10.0, blend=0.01),
        ),
        (
            "kind = 'at_speed'\nspeed = 0.2\n[path]\nkind = 'circle'\nradius = 0.2\nin_plane = 'xz'",
            fp.Circle(0.2, 10.0).in_plane("xz").at_speed(0.2, acceleration=0.5),
        ),
        (
            "kind = 'circle'\nradius = 0.2\nin_plane = 'xz'\nat_speed = 0.2\nat_acceleration = 0.5\nat_jerk = 5",
            fp.Circle(0.2).in_plane("xz").at_speed(0.2, acceleration=0.5, jerk=5),
        ),
        (
            "kind = 'circle'\nin_plane = 'xy'\nwith_rotation = [0, 0, 1]\nrotation_time_law = 'sin_squared'",
            fp.Circle(0.1, 10.0).in_plane("xy").with_rotation([0, 0, 1], time_law="sin_squared"),
        ),
        ("kind = 'circle'\nin_plane = [[0, 1, 0], [1, 0, 0]]", fp.Circle(0.1, 10.0).in_plane([[0, 1, 0], [1, 0, 0]])),
    ],
)
def test_paths(text: str, path: fp.Path) -> None:
    flat = len(path.sample(0.0)[0]) == 2
    assert prepare({"arm": PANDA, "path": job_of(text), "run": {"task": "pose"}}).path == (
        path.in_plane("yz") if flat else path
    )


def test_paths_follow_one_another() -> None:
    lines = [{"kind": "line", "displacement": [0.1, 0.0, z], "duration": 1.0} for z in (0.1, -0.1)]
    made = prepare({"arm": PANDA, "path": lines}).path
    np.testing.assert_allclose(made.sample(2.0)[0], [0.2, 0.0, 0.0], atol=1e-15)
    assert made.duration == 2.0


@pytest.mark.parametrize("kind", SCHEMES)
def test_schemes_have_every_option_of_the_library(kind: str) -> None:
    assert set(known("scheme", kind)) == set(inspect.signature(SCHEMES[kind]).parameters)


def test_shapes_and_arms_have_every_option_of_the_library() -> None:
    for kind, shape in PATHS.items():
        assert set(known("path", kind)) - set(PATH_OPTIONS) == set(inspect.signature(shape).parameters)
    assert set(known("arm", "dh")) - {"payload"} == set(inspect.signature(fp.SerialArm.from_dh).parameters)
    assert set(known("limits")) == set(parameters(fp.JointLimits))


def test_a_scheme_with_everything() -> None:
    text = """
        [arm]
        kind = "planar"
        lengths = [1, 1, 1, 1]
        [scheme]
        kind = "fpbm"
        alpha = 0.25
        weights = [[2, 0, 0, 0], [0, 1, 0.5, 0], [0, 0.5, 1, 0], [0, 0, 0, 3]]
        k1 = 3
        k2 = 4
        null_damping = 1
        rest_posture = [0.1, 0.2, 0.3, 0.4]
        null_stiffness = 2
        c = [0, 0, 0, 1]
        joint_centring = 0.1
        manipulability_gain = 0.2
        singular_radius = 0.02
        singular_brake = 5
    """
    W = [[2, 0, 0, 0], [0, 1, 0.5, 0], [0, 0.5, 1, 0], [0, 0, 0, 3]]
    same = fp.FPBM(
        0.25,
        W,
        3,
        4,
        null_damping=1,
        rest_posture=[0.1, 0.2, 0.3, 0.4],
        null_stiffness=2,
        c=[0, 0, 0, 1],
        joint_centring=0.1,
        manipulability_gain=0.2,
        singular_radius=0.02,
        singular_brake=5,
    )
    motion = prepare(job_of(text))
    q, qd = np.array([0.3, 0.4, 0.5, 0.6]), np.array([0.1, 0.0, -0.1, 0.2])
    answers = [scheme.resolve(motion.arm, q, qd, [1, 2], [0.1, 0], [0, 0.1]) for scheme in (motion.scheme, same)]
    np.testing.assert_array_equal(*answers)


def test_tasks() -> None:
    text = """
        [arm]
        kind = "preset"
        name = "ur5e"
        [path]
        kind = "circle"
        duration = 1.0
        [run]
        task = "seam"
        [[task]]
        kind = "position"
        name = "seam"
        [[task]]
        kind = "axis"
        name = "torch"
        x = [0, 0, -1]
        [[task]]
        level = 1
        kind = "posture"
        k1 = 4
        k2 = 4
    """
    stack = fp.Stack(
        [fp.PositionTask(name="seam"), fp.AxisTask(name="torch", x=[0, 0, -1])], fp.PostureTask(k1=4, k2=4)
    )
    motion = prepare(job_of(text))
    assert motion.stack == stack
    arm, path = fp.SerialArm.preset("ur5e"), fp.Circle(0.1, 1.0).in_plane("yz")
    scheme = fp.FPBM(0.6, np.ones(6), 0, 0, null_damping=2)
    run = fp.simulate(arm, path, scheme, motion.q0, stack=stack, task="seam")
    assert motion.run() == run
    limited = prepare({**motion.job, "limits": {}})
    same = fp.track(arm, path, scheme, motion.q0, stack=stack, task="seam", limits=arm.limits, null_damping=0)
    assert limited.run() == same
    assert "task" not in motion.taken


def test_bounds() -> None:
    table = {
        "task": {"kind": "axis", "x": [0, 0, -1], "name": "cone"},
        "upper": 0.3,
        "velocity": 0.5,
    }
    path = {"kind": "line", "displacement": [0.0, 0.4, 0.0], "duration": 1.0}
    motion = prepare({"arm": PANDA, "path": path, "bounds": [table]})
    bounds = (fp.TaskBounds(fp.AxisTask(x=[0, 0, -1], name="cone"), upper=0.3, velocity=0.5),)
    assert motion.bounds == bounds
    scheme = fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=2)
    arm = fp.SerialArm.preset("panda")
    run = fp.track(arm, fp.Line([0.0, 0.4, 0.0], 1.0), scheme, READY, bounds=bounds, null_damping=0, limits=arm.limits)
    np.testing.assert_array_equal(motion.run().q, run.q)
    assert np.arccos(-run.arm.forward(run.q[-1])[2, 2]) <= 0.3 + 1e-9


def test_a_run_equals_that_of_the_library() -> None:
    motion = prepare(
        {"arm": PANDA, "path": {"kind": "circle", "radius": 0.1, "duration": 1.0}, "run": {"task": "pose"}}
    )
    scheme = fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=2)
    run = fp.simulate(motion.arm, fp.Circle(0.1, 1.0).in_plane("yz"), scheme, READY, task="pose")
    np.testing.assert_array_equal(motion.run().q, run.q)


def test_a_motion_that_stops_early_is_kept() -> None:
    run = prepare({"arm": PANDA, "path": {"kind": "circle", "radius": 3.0}}).run()
    assert not run.status
    assert 0 < run.status.time < 10


def test_limits_are_kept() -> None:
    table = {"arm": PANDA, "path": {"kind": "circle", "duration": 1.0}, "limits": {"velocity": 0.5}}
    motion = prepare(table)
    run = motion.run()
    assert np.abs(run.qd).max() <= 0.5 + 1e-9
    assert run.saturated is not None
    np.testing.assert_array_equal(motion.limits.upper, motion.arm.limits.upper)


def test_a_scheme_has_the_damping_of_the_job() -> None:
    table = {"arm": PANDA, "path": {"kind": "circle", "duration": 1.0}, "limits": {}, "run": {"hold": 9.0}}
    assert prepare(table).scheme.null_damping == 2.0
    assert np.abs(prepare(table).run().qd[-1]).max() < 1e-6
    undamped = prepare({**table, "scheme": {"kind": "fpbm", "null_damping": 0.0}})
    assert np.abs(undamped.run().qd[-1]).max() > 1e-3


# Omitted keys


def test_default_values_are_reported() -> None:
    motion = prepare({"arm": PANDA, "scheme": {"kind": "fpbm", "k1": 3.0}})
    defaults = {text for texts in motion.taken.values() for text in texts}
    assert "k1 = 3" not in defaults
    assert {"k2 = 25", "radius = 0.1", "in_plane = yz", "weights = 1 for each", "null_damping = 2"} <= defaults
    assert not prepare(motion.job).taken


def test_planar_paths_have_a_plane_for_arms_in_space_only() -> None:
    assert prepare({"arm": PLANAR}).job["path"].get("in_plane") is None
    assert prepare({"arm": PANDA}).job["path"]["in_plane"] == "yz"
    line = {"kind": "line", "displacement": [0.1, 0, 0]}
    assert prepare({"arm": PANDA, "path": line}).job["path"].get("in_plane") is None


@pytest.mark.parametrize("name", ["panda", "iiwa14", "gen3", "ur5e", "ur10e", "xarm7"])
@pytest.mark.parametrize("task", ["position", "pose"])
def test_every_preset_follows_the_default_path(name: str, task: str) -> None:
    motion = prepare({"arm": {"kind": "preset", "name": name}, "run": {"task": task}})
    assert motion.run().max_error() < 1e-9
    if name != "gen3":
        np.testing.assert_allclose(motion.arm.forward(motion.q0)[:3, 2], [0, 0, -1], atol=1e-3)  # The hand points down.


@pytest.mark.parametrize("links", range(2, 11))
def test_planar_arms_follow_the_default_path(links: int) -> None:
    assert prepare({"arm": {"kind": "planar", "lengths": [1.0] * links}}).run().max_error() < 1e-9


@given(seed=st.integers(0, 1 << 30), dof=st.integers(6, 8), task=st.sampled_from(["position", "pose"]))
def test_postures_of_unknown_arms(seed: int, dof: int, task: str) -> None:
    """Within the limits, with a condition number that is not much larger than in the middle of the ranges."""
    rng = np.random.default_rng(seed)
    table = rng.uniform(-1, 1, (dof, 4))
    lower, upper = -rng.uniform(0.1, 3, dof), rng.uniform(0.1, 3, dof)
    arm = fp.SerialArm.from_dh(table, "classic", lower=lower, upper=upper)
    q = np.array(ready(arm, task))
    assert np.all((q > lower) & (q < upper))
    assert inverse_condition(arm, q, task) > 0.8 * inverse_condition(arm, (lower + upper) / 2, task) - 1e-4


@given(seed=st.integers(0, 1 << 30), dof=st.integers(6, 8), task=st.sampled_from(["position", "pose"]))
def test_postures_of_unknown_arms_are_far_from_singular_ones(seed: int, dof: int, task: str) -> None:
    """The inverse condition number is at least 0.75 times the largest value of a hundred random postures."""
    rng = np.random.default_rng(seed)
    arm = fp.SerialArm.from_dh(rng.uniform(-1, 1, (dof, 4)), "classic")
    bends = rng.integers(-1, 2, (100, min(dof, 7)))
    best = max(inverse_condition(arm, np.concatenate([np.zeros(dof - len(bend)), bend]), task) for bend in bends)
    assert inverse_condition(arm, ready(arm, task), task) > 0.75 * best


def inverse_condition(arm: fp.Arm, q: Any, task: str) -> float:
    sigma = np.linalg.svd(arm.jacobian(q, task=task), compute_uv=False)
    return float(sigma[-1] / sigma[0])


def test_a_straight_chain_is_bent() -> None:
    arm = fp.SerialArm.from_dh([[0.3, (-1) ** i * np.pi / 2, 0, 0] for i in range(7)], "classic")
    assert np.linalg.svd(arm.jacobian(np.zeros(7), task="pose"), compute_uv=False)[-1] < 1e-9
    assert np.linalg.svd(arm.jacobian(ready(arm, "pose"), task="pose"), compute_uv=False)[-1] > 0.01


# Files


@pytest.mark.parametrize("file", sorted((ROOT / "examples/jobs").glob("*.toml")), ids=lambda file: file.stem)
def test_examples(file: Path, tmp_path: Path) -> None:
    motion = prepare(read_job(file))
    run = motion.run()
    assert run.status
    assert run.max_error() < 1e-3
    write_job(motion.job, tmp_path / "again.toml")
    assert prepare(read_job(tmp_path / "again.toml")).job == motion.job


numbers = st.floats(0.0, 1e3)


@given(
    alpha=st.floats(0.0, 1.0), k1=numbers, k2=numbers, weights=st.lists(st.floats(1e-3, 1e3), min_size=4, max_size=4)
)
def test_numbers_are_written_exactly(
    tmp_path_factory: pytest.TempPathFactory, alpha: float, k1: float, k2: float, weights: list[float]
) -> None:
    scheme = {"kind": "fpbm", "alpha": alpha, "k1": k1, "k2": k2, "weights": weights}
    job = {"arm": PLANAR, "scheme": scheme}
    file = tmp_path_factory.getbasetemp() / "numbers.toml"
    write_job(job, file)
    assert read_job(file) == job


def test_a_file_has_readable_tables(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    write_job(prepare({"arm": PLANAR}).job, file)
    assert file.read_text().splitlines()[:7] == [
        "# fpbm-cpp track --job mine.toml",
        "",
        "[arm]",
        'kind = "planar"',
        "lengths = [1, 1, 1, 1]",
        "",
        "[path]",
    ]
    lines = [line.split(" =")[0] for line in file.read_text().splitlines()]
    assert lines[lines.index("[scheme]") :][:7] == ["[scheme]", "kind", "alpha", "weights", "k1", "k2", "null_damping"]


def test_file_names_are_relative_to_the_folder_of_the_job(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "arms").mkdir()
    (tmp_path / "jobs").mkdir()
    (tmp_path / "arms/my.urdf").write_text((ROOT / "examples/04_exported_arm.urdf").read_text())
    monkeypatch.chdir(tmp_path)
    job = {"arm": {"kind": "urdf", "file": "arms/my.urdf", "tip": "tool"}}
    write_job(job, "jobs/job.toml")
    assert 'file = "../arms/my.urdf"' in Path("jobs/job.toml").read_text()
    monkeypatch.chdir("jobs")
    assert prepare(read_job("job.toml")).arm.dof == 7
    monkeypatch.chdir("/")
    assert prepare(read_job(tmp_path / "jobs/job.toml")).arm.dof == 7


def test_invalid_files_are_rejected(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_job(tmp_path / "none.toml")
    for content in (b"[arm", b"a = ", b"\xff", b"[arm]\n[arm]\n"):
        (tmp_path / "bad.toml").write_bytes(content)
        with pytest.raises(JobError, match="must be valid TOML: "):
            read_job(tmp_path / "bad.toml")


# Errors

ARM = "[arm]\nkind = 'preset'\nname = 'panda'\n"
SHAPES = "circle, lissajous, tricuspid, line, polyline, waypoints, at_speed"
KINDS = "mvn, wmvn, man, wmvn_acceleration, balanced, fpbm, minimum_energy, minimum_torque"
LAWS = "sin_squared, quintic, constant_speed"


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("", "arm: is missing"),
        ("arm = 3", "arm = 3: must be a table"),
        ("[arm]\nname = 'panda'", "arm.kind: is missing: must be one of preset, planar, urdf, dh, joints"),
        ("[arm]\nkind = 'preset'", "arm.name: is missing"),
        (
            "[arm]\nkind = 'preset'\nname = 'pnada'",
            "arm.name = 'pnada': must be one of panda, fr3, iiwa14, gen3, ur5e, ur10e, xarm7, so101, openarm, z1, "
            "two_pandas, g1_upper_body; "
            "did you mean 'panda'?",
        ),
        ("[arm]\nkind = 'planar'\nlengths = [1, -1]", "arm.lengths[1] = -1: must be positive and finite"),
        ("[arm]\nkind = 'joints'\njoints = [{}, {axis = 'x'}]", "arm.joints[1].axis = 'x': must be real numbers"),
        (
            f"{ARM}[pth]",
            "pth: is not a key of a job: must be one of arm, path, scheme, task, run, limits, bounds, clearance; "
            "did you mean 'path'?",
        ),
        (f"{ARM}[path]\nkind = 'cirle'", f"path.kind = 'cirle': must be one of {SHAPES}; did you mean 'circle'?"),
        (f"{ARM}[path]\nradius = 1", f"path.kind: is missing: must be one of {SHAPES}"),
        (f"{ARM}[path]\nkind = 'circle'\nradius = -1", "path.radius = -1: must be positive and finite"),
        (f"{ARM}[path]\nkind = 'circle'\nradius = '1'", "path.radius = '1': must be a number"),
        (f"{ARM}[path]\nkind = 'circle'\nradius = true", "path.radius = True: must be a number"),
        (f"{ARM}[path]\nkind = 'circle'\nradius = nan", "path.radius = nan: must be positive and finite"),
        (f"{ARM}[path]\nkind = 'circle'\nradus = 1", "at_jerk; did you mean 'radius'?"),
        (f"{ARM}[path]\nkind = 'circle'\ntime_law = 'sin'", f"path.time_law = 'sin': must be one of {LAWS}"),
        (
            f"{ARM}[path]\nkind = 'circle'\nin_plane = 'xw'",
            "path.in_plane = 'xw': must be one of xy, xz, yx, yz, zx, zy",
        ),
        (f"{ARM}[path]\nkind = 'circle'\nwith_rotation = [1]", "path.with_rotation"),
        (
            f"{ARM}[path]\nkind = 'lissajous'\nfrequencies = [1, 1.5]",
            "path.frequencies[1] = 1.5: must be a whole number",
        ),
        (f"{ARM}[path]\nkind = 'waypoints'\npoints = [[0, 0], [1, 0]]", "path: has no duration: give a duration"),
        (f"path = []\n{ARM}", "path = []: must have at least one path"),
        (f"{ARM}[[path]]\nkind = 'circle'\n[[path]]\nkind = 'circle'\nradius = 'a'", "path[1].radius = 'a': must be"),
        (f"{ARM}[[path]]\nkind = 'circle'\n[[path]]\nkind = 'circle'\nradius = 0", "path[1].radius = 0: must be"),
        (f"{ARM}[scheme]\nkind = 'fbpm'", f"scheme.kind = 'fbpm': must be one of {KINDS}; did you mean 'fpbm'?"),
        (f"{ARM}[scheme]\nkind = 'FPBM'", f"scheme.kind = 'FPBM': must be one of {KINDS}; did you mean 'fpbm'?"),
        (f"{ARM}[scheme]\nkind = 'wmvn-acceleration'", "did you mean 'wmvn_acceleration'?"),
        (f"{ARM}[scheme]\nkind = 'fpbm'\nalpha = 2", "scheme.alpha = 2: must be in [0, 1]"),
        (f"{ARM}[scheme]\nkind = 'fpbm'\nweights = [1, 2]", "scheme.weights has 2 entries: must have 7, one per joint"),
        (
            f"{ARM}[scheme]\nkind = 'man'\nalpha = 0.5",
            "scheme.alpha: is not a key of man: must be one of null_damping, ",
        ),
        (f"{ARM}[[task]]\nkind = 'posture'", "run.task: must be the name of a position or a pose of the stack"),
        (f"{ARM}[[task]]\nkind = 'pose'\n[run]\ntask = 'seam'", "run.task = 'seam': must be the name of a position or"),
        (f"{ARM}[[task]]\nkind = 'pose'\nlevel = 1", "task.level = 1: level 0 has no task: number the levels from 0"),
        (
            f"{ARM}[[task]]\nkind = 'pose'\nframe = 'hand'",
            "frame = 'hand': must be a frame, or the joint of a link: 'base', 'tip'",
        ),
        (f"task = 1\n{ARM}", "task = 1: must be a table"),
        (f"{ARM}[[bounds]]\nupper = 1", "bounds[0].task: is missing"),
        (f"{ARM}[[bounds]]\ntask = {{kind = 'pose'}}", "bounds[0].task.kind = 'pose': must be one of position, axis"),
        (f"{ARM}[[bounds]]\ntask = {{kind = 'axis'}}\nupper = 1", "task.x: must be given: the bounded angle"),
        (f"{ARM}[run]\ntask = 'pos'", "run.task = 'pos': must be one of position, pose; did you mean 'pose'?"),
        (f"{ARM}[run]\nq0 = [1, 2]", "run.q0 has 2 entries: must have 7, one per joint"),
        (f"{ARM}[run]\ndt = 0.3", "run.dt = 0.3: must be a divisor of duration = 10"),
        (f"{ARM}[limits]\nvelocity = [1, 2]", "limits.velocity has 2 entries"),
        (
            "[arm]\nkind = 'planar'\nlengths = [1, 1]\n[run]\ntask = 'pose'",
            "run.task: has 3 rows, and the arm has 2 joints",
        ),
        (
            "[arm]\nkind = 'planar'\nlengths = [1, 1]\n[path]\nkind = 'circle'\nin_plane = 'xy'",
            "path: is in space",
        ),
    ],
)
def test_an_invalid_value_is_reported(text: str, line: str) -> None:
    (error,) = errors_of(text)
    assert line in error


def test_every_invalid_value_is_reported() -> None:
    text = "[arm]\nkind = 'preset'\nname = 3\n[path]\nkind = 'circle'\nradius = 'x'\n[run]\nq0 = 'x'\ndt = 'x'"
    assert [line.split(" ")[0] for line in errors_of(text)] == ["arm.name", "path.radius", "run.q0", "run.dt"]


def test_a_long_value_is_cut() -> None:
    (line,) = errors_of(f"{ARM}[run]\nq0 = {['x' * 500]}")
    assert len(line) < 130


def test_errors_of_the_run_are_reported() -> None:
    motion = prepare({"arm": PANDA, "run": {"qd0": [1.0]}, "limits": {}})
    with pytest.raises(JobError, match=r"^run\.qd0 has 1 entr"):
        motion.run()
