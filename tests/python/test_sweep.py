"""Sweeps: the same motions as by simulate(), with every executor, and clear messages about missing motions."""

import importlib.util
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest

import fpbm_cpp as fp
from fpbm_cpp.motion._lanes import LANES

FIGURES = [
    "time",
    "max_error",
    "max_orientation_error",
    "peak_velocity",
    "final_velocity",
    "peak_acceleration",
    "final_acceleration",
    "manipulability",
]

PANDA = fp.SerialArm.preset("panda")
READY = np.array([0, -0.3, 0, -2.2, 0, 2.0, 0.785])
TURNED = fp.Circle(0.05, 1.0).in_plane("yz").with_rotation([0.1, 0, 0.2])


def every_scheme(n):
    w = np.linspace(1, 2, n)
    W = np.diag(w) + 0.1
    rest = {"rest_posture": np.full(n, 0.3), "null_stiffness": 1.0}
    return [
        fp.MVN(),
        fp.WMVN(w, k=5, **rest),
        fp.WMVN(W, c=np.full(n, 0.1)),
        fp.MAN(null_damping=1, singular_radius=0.02, singular_brake=5),
        fp.WMVNAcceleration(w),
        fp.Balanced(0.5, W),
        fp.FPBM(0.6, w, 10, 25, null_damping=2, **rest),
        fp.FPBM(0.6, w, 10, 25, joint_centring=0.1, manipulability_gain=0.2, null_damping=2),
    ]


CASES = {
    "planar": (fp.PlanarArm([1, 1, 1, 1]), fp.Circle(0.2, 1.0), "position", np.pi / np.array([12, 12, 15, 15])),
    "planar pose": (fp.PlanarArm([1, 1, 1, 1]), fp.Circle(0.2, 1.0), "pose", np.array([0.3, 0.9, 0.9, 0.5])),
    "planar, 9 joints": (fp.PlanarArm(np.full(9, 0.5)), fp.Circle(0.2, 1.0), "position", np.full(9, 0.2)),
    "panda": (PANDA, fp.Circle(0.05, 1.0), "position", READY),
    "panda pose": (PANDA, TURNED, "pose", READY),
}


def narrow(arm, velocity):
    """Limits with this velocity bound, and with acceleration bounds ten times as large."""
    return fp.JointLimits(
        lower=[-3.5] * arm.dof,
        upper=[4.0] * arm.dof,
        velocity=[velocity] * arm.dof,
        acceleration=[10 * velocity] * arm.dof,
    )


def same(a, b):
    """Two sweeps are equal to the last bit."""
    np.testing.assert_array_equal(a.status, b.status)
    for name in FIGURES:
        assert getattr(a, name).tobytes() == getattr(b, name).tobytes(), name


def expect_run(sweep, i, k, run):
    """Motion i, k of the sweep has the key figures of this run."""
    size = np.abs(run.qd).max(axis=1)
    assert sweep.status[i, k] is run.status.code
    assert sweep.time[i, k] == run.status.time
    expected = {
        "max_error": run.max_error(),
        "max_orientation_error": run.max_orientation_error(),
        "peak_velocity": size.max(),
        "final_velocity": size[-1],
        "peak_acceleration": np.abs(run.qdd).max(),
        "final_acceleration": np.abs(run.qdd[-1]).max(),
        "manipulability": run.manipulability().min(),
    }
    tolerance = 1e-9 if run.scheme.level == "velocity" else 1e-12  # Tolerance of differences of velocities.
    for name, value in expected.items():
        np.testing.assert_allclose(getattr(sweep, name)[i, k], value, rtol=tolerance, atol=1e-15, err_msg=name)


def expect_agreement(lanes, alone):
    """Two sweeps are equal up to round-off."""
    np.testing.assert_array_equal(lanes.status, alone.status)
    for name in FIGURES:
        # At velocity level, accelerations are differences of velocities.
        differences = name in ("peak_acceleration", "final_acceleration")
        tolerance = 1e-10 if differences else 1e-12
        np.testing.assert_allclose(getattr(lanes, name), getattr(alone, name), tolerance, tolerance, err_msg=name)


@pytest.mark.parametrize("within", [None, 1.0, 0.1])
@pytest.mark.parametrize("case", CASES)
def test_motions_in_lanes_agree_with_single_motions(case, within):
    arm, path, task, q0 = CASES[case]
    schemes = every_scheme(arm.dof)
    q0s = q0 + np.random.default_rng(3).uniform(-0.05, 0.05, (11, arm.dof))
    how = {"hold": 0.5, "task": task, "limits": None if within is None else narrow(arm, within)}
    lanes = fp.sweep(arm, path, schemes, q0s, 0.01, **how)
    alone = fp.sweep(arm, path, schemes, q0s, 0.01, motions=True, **how)
    expect_agreement(lanes, alone)
    if within == 0.1:
        assert (lanes.status == fp.Status.SLOWED).all()
        assert lanes.peak_velocity.max() <= 0.1 + 1e-12


@pytest.mark.parametrize("within", [None, 1.0, 0.1])
def test_lanes_do_not_influence_one_another(within):
    arm, path, task, q0 = CASES["panda pose"]
    scheme = every_scheme(7)[-2]
    q0s = q0 + np.random.default_rng(4).uniform(-0.05, 0.05, (LANES + 3, 7))
    bad = q0s.copy()
    bad[1::2] = [0, 0, 0, -0.08, 0, 0.1, 0]  # Outstretched: the path has unreachable points.
    how = {"task": task, "limits": None if within is None else narrow(arm, within)}
    good = fp.sweep(arm, path, scheme, q0s, 0.01, **how)
    mixed = fp.sweep(arm, path, scheme, bad, 0.01, **how)
    for name in FIGURES:
        assert getattr(mixed, name)[0, ::2].tobytes() == getattr(good, name)[0, ::2].tobytes(), name
    assert good.ok.all()
    if within is None:
        assert not mixed.ok[0, 1::2].any()
        expect_run(mixed, 0, 1, fp.simulate(arm, path, scheme, bad[1], dt=0.01, task=task, partial=True))
    else:
        expect_agreement(mixed, fp.sweep(arm, path, scheme, bad, 0.01, motions=True, **how))


@pytest.mark.parametrize("choice", ["none", "avx2", "avx512"])
def test_lanes_can_be_chosen(choice):
    code = "from fpbm_cpp.motion._lanes import LANES; print(LANES)"
    environment = {**os.environ, "FPBM_LANES": choice}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    known = {"none": "1", "avx2": "4", "avx512": "8"}[choice]
    assert run.stdout.strip() in (known, "1")
    # A build from sources has the lanes of this processor's kind only.
    built = importlib.util.find_spec(f"fpbm_cpp._lanes_{choice}") is not None
    if choice in fp._core.processor_kinds() and built:
        assert run.stdout.strip() == known


def test_an_invalid_choice_of_lanes_is_rejected():
    environment = {**os.environ, "FPBM_LANES": "avx1024"}
    run = subprocess.run([sys.executable, "-c", "import fpbm_cpp"], env=environment, capture_output=True, text=True)
    assert run.returncode != 0
    assert "FPBM_LANES = 'avx1024': must be one of 'avx512', 'avx2', 'none', or unset" in run.stderr


@pytest.mark.parametrize("case", CASES)
def test_a_sweep_equals_single_simulations(case):
    arm, path, task, q0 = CASES[case]
    schemes = every_scheme(arm.dof)
    q0s = q0 + np.random.default_rng(0).uniform(-0.05, 0.05, (3, arm.dof))
    sweep = fp.sweep(arm, path, schemes, q0s, 0.01, hold=0.5, task=task, motions=True)
    assert sweep.status.shape == sweep.motions.shape == (8, 3)
    assert sweep.ok.all()
    assert sweep.done.all()
    assert (sweep.max_error > 0).all()
    assert ((sweep.max_orientation_error > 0) == (task == "pose")).all()
    for i, scheme in enumerate(schemes):
        for k, start in enumerate(q0s):
            run = fp.simulate(arm, path, scheme, start, dt=0.01, hold=0.5, task=task)
            expect_run(sweep, i, k, run)
            motion = sweep.motions[i, k]
            assert motion.scheme is scheme
            assert str(motion.status) == str(run.status)
            for name in ("t", "q", "qd", "qdd", "x", "x_ref", "error"):
                assert getattr(motion, name).tobytes() == getattr(run, name).tobytes(), name


def test_one_scheme_and_one_start(arm, circle, q0):
    sweep = fp.sweep(arm, circle, fp.MVN(), q0, 0.01)
    assert sweep.status.shape == sweep.time.shape == (1, 1)
    assert sweep.q0s.shape == (1, 4)
    assert len(sweep.schemes) == 1
    assert sweep.motions is None
    assert sweep.time[0, 0] == 10.0
    assert repr(sweep) == "<Sweep of 1 schemes from 1 starts: 1 complete>"
    assert "MVN(): 1 of 1 complete; tip error up to " in str(sweep)


def large(arm, dt=0.01, **how):
    """Enough motions for many chunks; some stop early, some immediately."""
    rng = np.random.default_rng(1)
    q0s = rng.uniform(-1.5, 1.5, (300, 4))
    q0s[7] = 0.0
    schemes = [fp.MVN(), fp.FPBM(0.6, [1, 2, 3, 4], 10, 25)]
    return fp.sweep(arm, fp.Line([0.4, -0.3], 1.0), schemes, q0s, dt, **how)


@pytest.fixture(scope="module")
def reference(arm):
    sweep = large(arm, workers=1)
    assert 0 < (~sweep.ok).sum() < 300
    assert sweep.done.all()
    return sweep


@pytest.mark.parametrize("workers", [2, 4, None])
def test_workers_change_nothing(arm, reference, workers):
    same(large(arm, workers=workers), reference)


def test_executors_change_nothing(arm, reference):
    with ThreadPoolExecutor(3) as threads:
        same(large(arm, executor=threads), reference)
    with ProcessPoolExecutor(2) as processes:
        same(large(arm, executor=processes), reference)
        same(large(arm, executor=processes), reference)  # The executor stays open.


def test_dask_changes_nothing(arm, reference):
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
        same(large(arm, executor=client.get_executor()), reference)


def test_one_motion_at_a_time_changes_nothing(arm, reference):
    for i, scheme in enumerate(reference.schemes):
        for k in range(0, 300, 29):
            alone = fp.sweep(arm, reference.path, scheme, reference.q0s[k], 0.01)
            assert alone.status[0, 0] is reference.status[i, k]
            for name in FIGURES:
                assert getattr(alone, name)[0, 0].tobytes() == getattr(reference, name)[i, k].tobytes()


def test_whole_motions_from_other_processes(arm, reference):
    with ProcessPoolExecutor(1) as processes:
        sweep = fp.sweep(arm, reference.path, fp.MVN(), reference.q0s[:9], 0.01, executor=processes, motions=True)
    for k, motion in enumerate(sweep.motions[0]):
        run = fp.simulate(arm, reference.path, fp.MVN(), reference.q0s[k], dt=0.01, partial=True)
        assert motion.q.tobytes() == run.q.tobytes()
        assert motion.arm is arm


TIGHT = fp.JointLimits(lower=[-3] * 4, upper=[3] * 4, velocity=[0.3] * 4, acceleration=[2] * 4)
LIMITED = {
    "planar": TIGHT,
    "planar pose": TIGHT,
    "planar, 9 joints": fp.JointLimits(lower=[-3] * 9, upper=[3] * 9, velocity=[0.1] * 9, acceleration=[1] * 9),
    "panda": PANDA.limits,
    "panda pose": PANDA.limits,
}


@pytest.mark.parametrize("case", CASES)
def test_a_sweep_within_limits_equals_single_tracks(case):
    arm, path, task, q0 = CASES[case]
    schemes = every_scheme(arm.dof)
    q0s = q0 + np.random.default_rng(0).uniform(-0.05, 0.05, (2, arm.dof))
    seen = set()
    for gain in (0.0, 0.1):
        # Without feedback an integral is unstable, and refused.
        some = [scheme for scheme in schemes if (gain > 0) == (getattr(scheme, "k", getattr(scheme, "k1", 0)) > 0)]
        how = {"limits": LIMITED[case], "error_bound": 0.05, "integral_gain": gain, "singular_radius": 0.03}
        sweep = fp.sweep(arm, path, some, q0s, 0.01, hold=0.5, task=task, motions=True, **how)
        expect_agreement(fp.sweep(arm, path, some, q0s, 0.01, hold=0.5, task=task, **how), sweep)
        for i, scheme in enumerate(some):
            for k, start in enumerate(q0s):
                run = fp.track(arm, path, scheme, start, dt=0.01, hold=0.5, task=task, **how)
                expect_run(sweep, i, k, run)
                assert sweep.motions[i, k] == run
                assert sweep.motions[i, k].replay() == run
        seen |= set(sweep.status.ravel())
    if "planar" in case:
        assert fp.Status.SLOWED in seen


def test_workers_change_nothing_within_limits(arm, reference):
    starts = reference.q0s[:40]
    how = {"limits": TIGHT, "dt": 0.01}
    alone = fp.sweep(arm, reference.path, reference.schemes, starts, workers=1, **how)
    same(fp.sweep(arm, reference.path, reference.schemes, starts, workers=3, **how), alone)
    with ProcessPoolExecutor(1) as processes:
        same(fp.sweep(arm, reference.path, reference.schemes, starts, executor=processes, **how), alone)
    assert {fp.Status.SLOWED} <= set(alone.status.ravel())
    assert alone.peak_velocity.max() <= 0.3 + 1e-12
    assert np.nanmax(reference.peak_velocity[:, :40]) > 0.3


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"error_bound": 0.05}, "limits: must be given"),
        ({"singular_radius": 0.0}, "limits: must be given"),
        ({"limits": TIGHT, "error_bound": -1}, "error_bound = -1: must be positive"),
        ({"limits": TIGHT, "integral_gain": -1}, "integral_gain = -1"),
        ({"limits": PANDA.limits}, "limits has 7 entries"),
        ({"limits": TIGHT, "q0s": [[0.3] * 4, [0.3, 4, 0, 0]]}, r"q0s\[1\]: q0\[1\] = 4: must be within"),
        (
            {"limits": fp.JointLimits(lower=[-3] * 4, upper=[3] * 4, velocity=[1] * 4, acceleration=[np.inf] * 4)},
            r"limits.acceleration\[0\] = inf: must be finite",
        ),
    ],
)
def test_bad_limits(arm, circle, q0, change, words):
    with pytest.raises(ValueError, match=words):
        fp.sweep(arm, **{"path": circle, "schemes": fp.MAN(), "q0s": q0, **change})


def test_failed_motions_are_reported(arm, q0):
    out = fp.Line([5, 0], 5.0, time_law="quintic")
    sweep = fp.sweep(arm, out, [fp.MVN(), fp.MAN()], [q0, np.zeros(4)], motions=True)
    assert not sweep.ok.any()
    assert sweep.done.all()
    assert (sweep.status[:, 1] == fp.Status.SINGULAR).all()
    for i, scheme in enumerate(sweep.schemes):
        expect_run(sweep, i, 0, fp.simulate(arm, out, scheme, q0, partial=True))
    assert (sweep.time[:, 1] == 0).all()
    assert np.isnan(sweep.max_error[:, 1]).all()
    assert np.isnan(sweep.manipulability[:, 1]).all()
    assert len(sweep.motions[0, 1].t) == 0
    assert "stopped after t = 0 s" in str(sweep.motions[0, 1].status)
    assert repr(sweep) == "<Sweep of 2 schemes from 2 starts: 4 stopped early>"
    assert "0 of 2 complete" in str(sweep)


def test_damped_motions_are_complete():
    arm = fp.PlanarArm([1.0, 0.8, 0.6, 0.4])
    scheme = fp.FPBM(0.6, np.ones(4), 10, 25, singular_radius=0.05, null_damping=2.0)
    q0s = [[-0.3, 0.6, -0.6, 0.6], [-0.6, 1.2, -1.2, 1.2]]
    sweep = fp.sweep(arm, fp.Line([0.055, 0.0], 2.0), scheme, q0s)
    assert list(sweep.status[0]) == [fp.Status.DAMPED, fp.Status.OK]
    assert sweep.ok.all()


def test_progress_is_reported(arm, reference):
    reports = []
    same(large(arm, progress=lambda done, total: reports.append((done, total))), reference)
    assert len(reports) > 10
    assert reports == sorted(set(reports))
    assert reports[-1] == (600, 600)
    assert all(total == 600 for _, total in reports)


def test_progress_bar(arm, reference, capsys, monkeypatch):
    pytest.importorskip("tqdm")
    same(large(arm, progress=True), reference)
    assert "600/600" in capsys.readouterr().err
    same(large(arm, progress=False), reference)
    assert capsys.readouterr().err == ""
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    with pytest.raises(ImportError, match=r'progress=True needs tqdm: pip install "fpbm_cpp\[progress\]"'):
        large(arm, progress=True)


def test_an_exception_of_progress_ends_the_sweep(arm):
    def fail(done, total):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        large(arm, progress=fail)


class Broken(Executor):
    """Runs the first job, and fails at all other jobs."""

    def __init__(self):
        self.futures = []

    def submit(self, function, /, *args, **kwargs):
        future = Future()
        if self.futures:
            future.set_exception(OSError("the network is down"))
        else:
            future.set_result(function(*args, **kwargs))
        self.futures.append(future)
        return future


def test_an_exception_of_an_executor_is_raised(arm):
    with pytest.raises(OSError, match="the network is down"):
        large(arm, executor=Broken())


class AtOnce(Executor):
    """Runs each function when it is submitted."""

    def submit(self, function, /, *args, **kwargs):
        future = Future()
        future.set_result(function(*args, **kwargs))
        return future


def test_interruption_keeps_finished_motions_of_an_executor(arm, reference):
    def interrupt(done, total):
        raise KeyboardInterrupt

    with pytest.raises(fp.SweepInterrupted) as caught:
        large(arm, executor=AtOnce(), progress=interrupt)
    same(caught.value.sweep, reference)


def test_interruption_keeps_finished_motions(arm):
    def interrupt(done, total):
        if done > 100:
            raise KeyboardInterrupt

    dt = 0.001  # The motions take so long that the sweep does not complete before the interruption.
    reference = large(arm, dt, workers=1)
    for how in ({"workers": 2}, {"workers": 1}):
        with pytest.raises(fp.SweepInterrupted, match=r"interrupted after \d+ of 600 motions") as caught:
            large(arm, dt, progress=interrupt, **how)
        sweep = caught.value.sweep
        assert isinstance(caught.value, KeyboardInterrupt)
        assert 100 < sweep.done.sum() < 600
        assert (sweep.status[~sweep.done] == None).all()  # noqa: E711
        assert not sweep.ok[~sweep.done].any()
        assert ("not run" in repr(sweep)) == (not sweep.done.all())
        for name in FIGURES:
            values = getattr(sweep, name)
            assert values[sweep.done].tobytes() == getattr(reference, name)[sweep.done].tobytes()
            assert np.isnan(values[~sweep.done]).all()


class Interrupting(ThreadPoolExecutor):
    """Ctrl-C is pressed in the midst of each submission."""

    submitted = 0

    def submit(self, function, /, *args, **kwargs):
        signal.raise_signal(signal.SIGINT)
        self.submitted += 1
        return super().submit(function, *args, **kwargs)


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_leaves_no_lock_acquired(arm):
    """Ctrl-C ends the sweep after the submission: during the submission, the executor may hold a lock."""
    with Interrupting(2) as threads:
        with pytest.raises(fp.SweepInterrupted):
            large(arm, executor=threads)
        assert threads.submitted == 1
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def interrupted(script, *arguments):
    """Sends Ctrl-C a second after a script prints 'begun'. Returns the number of finished motions, and the sweep."""
    command = [sys.executable, str(script), *map(str, arguments)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as child:
        try:
            assert child.stdout.readline() == "begun\n"
            time.sleep(1.0)
            child.send_signal(signal.SIGINT)
            assert child.wait(60) == 0
        finally:
            child.kill()
        done, sweep = child.stdout.readline().split(maxsplit=1)
    return int(done), sweep


SCRIPT = """
import signal
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import nullcontext
import numpy as np
import fpbm_cpp as fp

def main(executor, hold):
    signal.signal(signal.SIGINT, signal.default_int_handler)  # A background job inherits an ignored SIGINT.
    q0s = np.tile(np.pi / np.array([12, 12, 15, 15]), (50000, 1))
    with eval(executor) as pool:
        if pool is not None:
            pool.submit(int).result()
        print("begun", flush=True)
        try:
            fp.sweep(fp.PlanarArm([1, 1, 1, 1]), fp.Circle(0.45, 10.0), fp.MVN(), q0s, hold=float(hold), executor=pool)
        except fp.SweepInterrupted as interrupted:
            print(interrupted.sweep.done.sum(), repr(interrupted.sweep), flush=True)

if __name__ == "__main__":
    main(*sys.argv[1:])
"""


@pytest.mark.skipif(os.name == "nt", reason="SIGINT cannot be sent to a process on Windows")
@pytest.mark.parametrize(
    ("executor", "hold"),
    [
        ("nullcontext()", 0.0),
        ("nullcontext()", 1000000.0),
        ("ThreadPoolExecutor(2)", 0.0),
        ("ThreadPoolExecutor(2)", 1000000.0),
        ("ProcessPoolExecutor(2)", 0.0),
    ],
)
def test_ctrl_c_stops_immediately(tmp_path, executor, hold):
    """Also during a motion of a billion steps, which takes minutes. The sweep does not wait for other processes."""
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    done, sweep = interrupted(script, executor, hold)
    if hold == 0.0:
        assert 0 < done < 50000, sweep
    else:
        assert done == 0, sweep


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"dt": 0}, "dt = 0: must be positive and finite"),
        ({"dt": 0.003}, r"dt = 0.003: must be a divisor of duration = 10; the nearest is 0.0030003"),
        ({"hold": -1}, "hold = -1"),
        ({"q0s": [0, 0, 0]}, "q0s has 3 entries: must have 4"),
        ({"q0s": [[0, 0, 0]]}, "a row of q0s has 3 entries: must have 4"),
        ({"q0s": np.zeros((0, 4))}, "q0s: must have at least one row"),
        ({"q0s": [[0, 0, 0, 0], [0, 0, 0, np.inf]]}, r"q0s\[1, 3\] = inf: must be finite"),
        ({"q0s": [0, np.nan, 0, 0]}, r"q0s\[1\] = nan: must be finite"),
        ({"q0s": np.zeros((1, 1, 4))}, r"q0s: must have shape \(n,\) or \(K, n\), got shape \(1, 1, 4\)"),
        ({"q0s": "home"}, "q0s: must be real numbers"),
        ({"task": "speed"}, "task = 'speed': must be 'position' or 'pose'"),
        ({"path": fp.Line([1, 2, 3], 1.0)}, "path: is in space, and the arm is planar: must be a planar path"),
        ({"schemes": []}, "schemes: must have at least one scheme"),
        ({"schemes": [fp.MVN(), fp.WMVN([1, 2, 3])]}, r"schemes\[1\]: weights has 3 entries: must have 4"),
        ({"schemes": fp.MAN(c=[0, 0])}, r"schemes\[0\]: c has 2 entries: must have 4"),
        ({"workers": 0}, "workers = 0: must be at least 1"),
        ({"workers": 1, "executor": Broken()}, "workers: must not be given with an executor"),
    ],
)
def test_bad_arguments(arm, circle, q0, change, words):
    arguments = {"path": circle, "schemes": fp.MAN(), "q0s": q0} | change
    with pytest.raises(ValueError, match=words):
        fp.sweep(arm, **arguments)


def test_bad_types(arm, circle, q0):
    with pytest.raises(TypeError, match=r"schemes\[1\]: must be a Scheme, got str"):
        fp.sweep(arm, circle, [fp.MVN(), "MAN"], q0)
    with pytest.raises(ValueError, match="more rows than joints"):
        fp.sweep(fp.PlanarArm([1, 1]), circle, fp.MVN(), [0.1, 0.2], task="pose")
