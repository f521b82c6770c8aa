"""Runs in files: loaded runs equal the saved runs and can be repeated, and other files are rejected."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_data import PANDA, READY, SOME_PATHS, SOME_SCHEMES, expect_same

import fpbm_cpp as fp
from fpbm_cpp.table import to_table

FLAT = fp.PlanarArm([1, 1, 1, 1])
LIMITS = fp.JointLimits(lower=[-3] * 4, upper=[3] * 4, velocity=[0.1, np.inf, 0.1, 0.1], acceleration=[1] * 4)


def through_file(run, tmp_path, **parts):
    """A run with replaced members, saved and loaded."""
    replace(run, **parts).save(tmp_path / "parts.npz")
    return fp.load(tmp_path / "parts.npz")


@pytest.fixture
def run(q0):
    return fp.simulate(FLAT, fp.Circle(0.2, 1.0), fp.FPBM(0.6, [1, 2, 3, 4], 1, 1), q0, dt=0.01)


def bits(run):
    arrays = (run.t, run.q, run.qd, run.qdd, run.x, run.x_ref, run.error, run.scale, run.saturated, run.clearance)
    return [None if array is None else (array.shape, array.dtype, array.tobytes()) for array in arrays]


RUNS = {
    **{
        f"Panda's position, {name}": (PANDA, fp.Circle(0.05, 0.5), SOME_SCHEMES[name], READY, {})
        for name in SOME_SCHEMES
    },
    **{
        f"Panda's pose, {name}": (
            PANDA,
            fp.Line([0, 0, 0.1], 0.5).with_rotation([0, 0, 0.2]),
            scheme,
            READY,
            {"task": "pose"},
        )
        for name, scheme in SOME_SCHEMES.items()
        if scheme.level == "velocity" or "all" not in name
    },
    "paper's": (FLAT, fp.Circle(0.2, 1.0), fp.FPBM(1 / 3, [1, 2, 3, 4], 1, 1), None, {"hold": 0.5}),
    "paper's, from a velocity": (FLAT, fp.Circle(0.2, 1.0), fp.MAN(), None, {"qd0": (0.01, 0, -1 / 300, 0)}),
    "planar pose": (FLAT, fp.Circle(0.2, 1.0).with_rotation(0.2), fp.MVN(), [0.3, 0.9, 0.9, 0.5], {"task": "pose"}),
    "stopped early": (FLAT, fp.Line([5, 0], 5.0), fp.MVN(), None, {"partial": True}),
    "stopped at once": (FLAT, fp.Circle(0.2, 1.0), fp.MAN(), [0, 0, 0, 0], {"partial": True}),
}


@pytest.mark.parametrize("name", RUNS)
def test_a_run_is_loaded_and_replayed(name, tmp_path, q0):
    arm, path, scheme, start, options = RUNS[name]
    run = fp.simulate(arm, path, scheme, q0 if start is None else start, dt=0.01, **options)
    run.save(tmp_path / "run.npz")
    back = fp.load(tmp_path / "run.npz")
    assert bits(back) == bits(run)
    assert back == run
    assert back.arm == run.arm
    assert type(back.scheme) is type(run.scheme)
    assert repr(back) == repr(run)
    assert back.options == run.options
    assert (back.status.code, back.status.time, back.task) == (run.status.code, run.status.time, run.task)
    again = back.replay()
    assert bits(again) == bits(run)
    assert again == run


@pytest.mark.parametrize("scheme", [fp.MVN(k=5), fp.FPBM(0.6, [1, 2, 3, 4], 10, 25, null_damping=2)], ids=repr)
@pytest.mark.parametrize("limits", [None, LIMITS], ids=["free", "limits"])
def test_a_run_within_limits_is_loaded_and_replayed(scheme, limits, tmp_path, q0):
    options = {"dt": 0.01, "hold": 0.2, "limits": limits, "error_bound": 1 / 3, "stall_time": np.inf}
    run = fp.track(FLAT, fp.Circle(0.45, 1.0), scheme, q0, **options)
    run.save(tmp_path / "run.npz")
    back = fp.load(tmp_path / "run.npz")
    assert bits(back) == bits(run)
    assert back == run
    assert back.options == run.options
    assert bits(back.replay()) == bits(run)
    assert back.replay() == run


def test_motions_of_a_sweep_are_replayed(q0):
    sweep = fp.sweep(FLAT, fp.Circle(0.2, 1.0), [fp.MVN(), fp.MAN()], [q0, q0 + 0.1], dt=0.01, hold=0.1, motions=True)
    for run in sweep.motions.ravel():
        assert run.replay() == run


def test_a_run_of_no_function_is_not_replayed(run):
    with pytest.raises(ValueError, match=r"run: must be a result of simulate\(\), track\(\), fastest\(\) or sweep\(\)"):
        replace(run, function=None).replay()


def test_equal_runs_have_equal_bits(run, q0):
    assert run == replace(run, q=run.q.copy(), provenance={"note": "elsewhere"})
    changed = run.q.copy()
    changed[50, 2] = np.nextafter(changed[50, 2], 9)
    zeros = replace(run, error=0 * run.error)
    assert zeros == replace(zeros, error=0 * run.error)
    assert zeros != replace(zeros, error=-np.abs(zeros.error))  # -0.0 is another bit.
    for other in (
        {"q": changed},
        {"path": fp.Circle(0.2, 1.0, time_law="quintic")},
        {"scheme": fp.FPBM(0.6, [1, 2, 3, 5], 1, 1)},
        {"arm": fp.PlanarArm([1, 1, 1, 2])},
        {"options": {**run.options, "hold": 1.0}},
        {"scale": np.ones(len(run.t))},
    ):
        assert replace(run, **other) != run, other
    assert run != 7
    with pytest.raises(TypeError, match="unhashable"):
        hash(run)


def test_provenance(run, tmp_path):
    assert run.provenance == {}
    run.save(tmp_path / "one.npz", note='Grüße, "ends"\0', seed=2**100)
    one = fp.load(tmp_path / "one.npz")
    assert one.provenance["note"] == 'Grüße, "ends"\0'
    assert one.provenance["seed"] == 2**100
    assert one.provenance["fpbm_cpp"] == fp.__version__
    assert one.provenance["numpy"] == np.__version__
    assert one.provenance.keys() == {"date", "fpbm_cpp", "numpy", "python", "system", "processor", "note", "seed"}
    replace(one, provenance={**one.provenance, "date": "then"}).save(tmp_path / "two.npz", seed=np.arange(3))
    two = fp.load(tmp_path / "two.npz")
    assert two.provenance == {**one.provenance, "date": "then", "seed": [0, 1, 2]}
    for seed in (0.5, "seven", [1, 0.5]):
        with pytest.raises(ValueError, match="must be a whole number, or a list of whole numbers"):
            run.save(tmp_path / "one.npz", seed=seed)
    with pytest.raises(ValueError, match="note = 7: must be text"):
        run.save(tmp_path / "one.npz", note=7)


def test_numpy_reads_the_arrays(run, tmp_path):
    run.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as saved:
        np.testing.assert_array_equal(saved["qdd"], run.qdd)
        meta = json.loads(str(saved["meta"]))
    assert meta["path"] == {"kind": "circle", "radius": 0.2, "duration": 1.0, "time_law": "sin_squared"}
    assert meta["status"]["code"] == "OK"


def test_a_file_is_replaced_atomically(run, tmp_path, monkeypatch):
    file = tmp_path / "run"  # The file has this name: no suffix is added.
    run.save(str(file))
    before = file.read_bytes()

    def full(*_):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", full)
        with pytest.raises(OSError, match="No space"):
            run.save(file, note="other")
    assert file.read_bytes() == before
    assert os.listdir(tmp_path) == ["run"]
    run.save(file, note="other")
    assert fp.load(file).provenance["note"] == "other"


def test_another_process_loads_and_replays_a_run(run, tmp_path):
    run.save(tmp_path / "run.npz")
    code = "import sys, fpbm_cpp as fp; run = fp.load(sys.argv[1]); sys.exit(run.replay() != run)"
    subprocess.run([sys.executable, "-c", code, tmp_path / "run.npz"], check=True)


@pytest.mark.parametrize("name", SOME_PATHS)
def test_paths(name, run, tmp_path):
    back = through_file(run, tmp_path, path=SOME_PATHS[name]).path
    expect_same(SOME_PATHS[name], back)
    expect_same(SOME_PATHS[name], through_file(run, tmp_path, path=back).path)


@pytest.mark.parametrize(
    "rotation", [0.1 + 0.2, np.float64(0.3), np.float32(0.3), 1, (0, 0, 1 / 3), np.array([0.1, 0, 0])], ids=repr
)
def test_rotations_keep_their_type(rotation, run, tmp_path):
    planar = np.ndim(rotation) == 0
    path = (fp.Line([1, 0], 1.0) if planar else fp.Line([1, 0, 0], 1.0)).with_rotation(rotation)
    expect_same(path, through_file(run, tmp_path, path=path).path)


def test_a_long_chain_of_paths(run, tmp_path):
    path = fp.Line([0.1, 0], 1.0)
    for i in range(1500):
        path = path.then(fp.Line([0.1, 0.01 * (i % 2)], 1.0))
    back = through_file(run, tmp_path, path=path).path
    assert repr(back) == repr(path)
    assert [x.tobytes() for x in back.sample(1234.5)] == [x.tobytes() for x in path.sample(1234.5)]


def test_arms(tmp_path):
    rail = fp.Joint("prismatic", axis=(0, 1, 0), lower=-1, upper=1, name='rail, "long" ü', mimic=None)
    follower = fp.Joint("revolute", mimic=(0, 2.0, 0.1))
    for arm in (FLAT, fp.PlanarArm([0.1, 1 / 3]), PANDA, fp.SerialArm([rail, *PANDA.joints, follower], PANDA.tip)):
        run = fp.simulate(arm, fp.Circle(0.01, 1.0), fp.MVN(), np.full(arm.dof, 0.3), dt=0.5, partial=True)
        back = through_file(run, tmp_path).arm
        expect_same(arm, back)
        assert back.joint_names == arm.joint_names
        assert back.limits == arm.limits


def test_stacks(tmp_path):
    stack = fp.Stack(fp.PoseTask(), [fp.PositionTask("panda_joint4", name="elbow"), fp.AxisTask(axis=[0, 0, 1 / 3])])
    q0 = [0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785]
    for motion in (fp.simulate, fp.track):
        run = motion(PANDA, fp.Circle(0.05, 1.0), fp.WMVN(np.ones(7)), q0, dt=0.01, stack=stack, task="pose")
        back = through_file(run, tmp_path)
        assert back == run == back.replay()
        assert list(back.errors) == ["pose", "elbow", "axis"]


@given(st.lists(st.floats(allow_nan=False), min_size=4, max_size=4))
def test_numbers_are_exact(numbers):
    run = fp.simulate(FLAT, fp.Circle(0.2, 1.0), fp.MVN(), [0.3, 0.9, 0.9, 0.5], dt=0.05)
    limits = fp.JointLimits(lower=numbers, upper=numbers, velocity=numbers, acceleration=numbers)
    with tempfile.TemporaryDirectory() as folder:
        back = through_file(run, Path(folder), options={"limits": limits}).options["limits"]
    assert back.lower.tobytes() == np.array(numbers).tobytes()


def test_arrays_of_other_libraries_are_saved(q0, run, tmp_path):
    pandas = pytest.importorskip("pandas")
    here = fp.simulate(FLAT, fp.Circle(0.2, 1.0), fp.WMVN(pandas.Series([1.0, 2, 3, 1 / 3])), q0, dt=0.01)
    there = fp.simulate(FLAT, fp.Circle(0.2, 1.0), through_file(here, tmp_path).scheme, q0, dt=0.01)
    assert bits(here) == bits(there)
    with pytest.raises(TypeError, match="must be an object of this package"):
        replace(run, options={"dt": {1, 2}}).save(tmp_path / "run.npz")


# The path in a hostile or damaged file, and the error message.
NO_PATHS = {
    "another module's": ({"kind": "os.system"}, r"path.kind = 'os.system': must be one of circle, .*sequence"),
    "nothing": ({}, "path.kind: is missing"),
    "unhashable": ({"kind": ["circle"]}, "must be a valid run"),
    "wrong numbers": ({"kind": "circle", "radius": -1.0, "duration": 1.0}, "path.radius = -1: must be positive"),
    "wrong kinds": ({"kind": "circle", "radius": "x", "duration": 1.0}, "path.radius = 'x': must be a number"),
    "too many": ({"kind": "circle", "radius": 1.0, "duration": 1.0, "x": 1}, "path.x: is not a key of circle"),
    "too few": ({"kind": "circle", "duration": 1.0}, "path.radius: is missing"),
    "no table": (7, "path = 7: must be a table"),
    "no array": ({"kind": "waypoints", "points": [[0], [1, 1]], "duration": 1}, "path.points = .*: must be real"),
    "no number": ({"kind": "circle", "radius": {"float": "__import__('os')"}, "duration": 1.0}, "must be a number"),
    "of no path": ({"kind": "mvn"}, "path.kind = 'mvn': must be one of"),
}


def rewritten(file, change=None, **members):
    """A saved run with another meta, or with other members."""
    with np.load(file) as saved:
        arrays = {name: saved[name] for name in saved.files}
    meta = json.loads(str(arrays["meta"]))
    meta.update(change or {})
    arrays["meta"] = np.array(json.dumps(meta))
    arrays.update(members)
    np.savez(file, **{name: array for name, array in arrays.items() if array is not None})


def test_a_file_without_bounds_is_loaded(tmp_path, q0):
    run = fp.track(FLAT, fp.Circle(0.45, 1.0), fp.MVN(k=5), q0, dt=0.01, limits=LIMITS)
    run.save(tmp_path / "run.npz")
    options = {name: to_table(value) for name, value in run.options.items() if name != "bounds"}
    for code in ("SLOWED", "STALLED", "SINGULAR"):
        status = {"code": code, "time": 1.0, "q": q0.tolist()}
        rewritten(tmp_path / "run.npz", {"options": options, "status": status})
        back = fp.load(tmp_path / "run.npz")
        assert back.status.code is fp.Status[code]
        assert back.clearance is None
        assert bits(back.replay()) == bits(run)


@pytest.mark.parametrize("what", NO_PATHS)
def test_a_file_with_an_unknown_path_is_rejected(what, run, tmp_path):
    data, words = NO_PATHS[what]
    run.save(tmp_path / "run.npz")
    rewritten(tmp_path / "run.npz", {"path": data})
    with pytest.raises(ValueError, match=words) as caught:
        fp.load(tmp_path / "run.npz")
    assert str(caught.value).startswith(str(tmp_path / "run.npz"))


@pytest.mark.parametrize(
    "table",
    [
        {"arm": {"kind": "urdf", "file": "/etc/passwd", "tip": "tip"}},
    ],
    ids=["arm"],
)
def test_a_file_that_names_other_files_is_rejected(table, run, tmp_path):
    run.save(tmp_path / "run.npz")
    rewritten(tmp_path / "run.npz", table)
    with pytest.raises(ValueError, match="kind = 'urdf': a run's file must not name another file"):
        fp.load(tmp_path / "run.npz")


@pytest.mark.parametrize(
    ("change", "members", "words"),
    [
        ({"version": 4}, {}, r"format 4: must be 3, .*: upgrade fpbm_cpp"),
        ({"version": 2}, {}, r"format 2: must be 3, .*: make the run again"),
        ({"version": "1"}, {}, "has the format 'fpbm_cpp run' '1'"),
        ({"format": "other"}, {}, "has the format 'other' 3"),
        ({"status": {"code": "BORED", "time": 1.0, "q": []}}, {}, "BORED"),
        ({"task": "dance"}, {}, "task = 'dance'"),
        ({"options": 7}, {}, "must be a valid run"),
        ({}, {"meta": None}, "has no arm, path and scheme"),
        ({}, {"meta": np.array("{")}, "must be a complete file from Run.save"),
        ({}, {"meta": np.array("[" * 100_000)}, "must be a complete file from Run.save"),
        ({}, {"q": None}, "must be a valid run .*q"),
        ({}, {"q": np.zeros((101, 3))}, r"q has shape \(101, 3\) and type float64: must have \(101, 4\) and float64"),
        ({}, {"x": np.zeros((101, 3))}, r"x has shape \(101, 3\)"),
        ({}, {"t": np.zeros(100)}, "has shape"),
        ({}, {"t": np.zeros(())}, "must be a valid run"),
        ({}, {"q": np.zeros((101, 4), int)}, "type int64: must have"),
        ({}, {"saturated": np.zeros((101, 4))}, r"saturated has shape \(101, 4\) and type float64"),
    ],
)
def test_an_invalid_file_is_rejected(change, members, words, run, tmp_path):
    run.save(tmp_path / "run.npz")
    rewritten(tmp_path / "run.npz", change, **members)
    with pytest.raises(ValueError, match=words):
        fp.load(tmp_path / "run.npz")


def test_nothing_in_a_file_is_executed(tmp_path):
    class Trap:
        def __reduce__(self):
            return open, (str(tmp_path / "sprung"), "w")

    np.savez(tmp_path / "run.npz", meta=np.array([Trap()], dtype=object))
    with pytest.raises(ValueError, match="allow_pickle=False"):
        fp.load(tmp_path / "run.npz")
    assert os.listdir(tmp_path) == ["run.npz"]


def test_a_file_that_is_not_a_run_is_rejected(run, tmp_path):
    file = tmp_path / "run.npz"
    run.save(file)
    whole = file.read_bytes()
    damaged = bytearray(whole)
    damaged[len(whole) // 2] ^= 0xFF
    pickled, single, archive = io.BytesIO(), io.BytesIO(), io.BytesIO()
    np.savez(pickled, meta=np.array([{"a": 1}], dtype=object))
    np.save(single, run.q)
    with zipfile.ZipFile(archive, "w") as other:
        other.writestr("meta", "{}")
    broken = [pickled.getvalue(), single.getvalue(), archive.getvalue(), bytes(damaged), b"", b"\x80\x04N."]
    for content in (*broken, *(whole[:n] for n in range(1, len(whole), 997)), whole[:-1]):
        file.write_bytes(content)
        with pytest.raises(ValueError, match=r"run\.npz: must be a complete file from Run.save"):
            fp.load(file)
    with pytest.raises(FileNotFoundError):
        fp.load(tmp_path / "none.npz")
