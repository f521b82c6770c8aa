"""Tuning: never worse than the baseline, equal to the last bit with every executor, and with correct reports."""

import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fpbm_cpp as fp
from fpbm_cpp.tuning import search, tuner
from fpbm_cpp.tuning.search import pareto_front
from fpbm_cpp.tuning.trials import Trials, sensitivity

pytest.importorskip("cmaes")

ARM = fp.PlanarArm([1, 1, 1, 1])
Q0 = np.pi / np.array([12, 12, 15, 15])
CIRCLE = fp.Circle(0.45, 10.0)
PANDA = fp.SerialArm.preset("panda")
READY = np.array([0, -0.3, 0, -2.2, 0, 2.0, 0.785])
KEYS = ("alpha", "weights", "k1", "k2", "null_damping")


def quick(objective="peak_velocity", **options):
    return fp.tune(ARM, CIRCLE, Q0, objective, **{"dt": 0.05, "trials": 40, "workers": 1, **options})


@pytest.fixture(scope="module")
def tuning():
    return quick(trials=120)


def objective_of(tuning, scheme, **options):
    """The objective of a scheme, from simulate() alone."""
    run = fp.simulate(tuning.arm, tuning.path, scheme, tuning.q0, task=tuning.task, **options)
    return {
        "peak_velocity": lambda: np.abs(run.qd).max(),
        "peak_acceleration": lambda: np.abs(run.qdd).max(),
        "final_velocity": lambda: np.abs(run.qd[-1]).max(),
        "energy": lambda: np.mean(np.sum(run.qd**2, axis=1)[[0, -1]]) * run.t[1] + np.sum(run.qd[1:-1] ** 2) * run.t[1],
        "limit_distance": lambda: max(
            abs(q - (low + high) / 2) / ((high - low) / 2)
            for row in run.q
            for q, low, high in zip(row, tuning.arm.limits.lower, tuning.arm.limits.upper)
        ),
        "spread": lambda: np.ptp(run.q),
    }[tuning.objective]()


def spread(run):
    return np.ptp(run.q)


@settings(max_examples=8, deadline=None)
@given(
    objective=st.sampled_from(["peak_velocity", "peak_acceleration", "final_velocity", "energy", spread]),
    seed=st.integers(0, 2**40),
    trials=st.integers(1, 60),
    hold=st.sampled_from([0.0, 1.0]),
)
def test_laws(objective, seed, trials, hold):
    tuning = quick(objective, seed=seed, trials=trials, hold=hold)
    assert len(tuning.trials) == trials + 1
    assert tuning.value <= tuning.baseline_value
    assert tuning.value == tuning.trials.value.min()
    for scheme, value in ((tuning.scheme, tuning.value), (tuning.baseline, tuning.baseline_value)):
        np.testing.assert_allclose(objective_of(tuning, scheme, dt=0.05, hold=hold), value, rtol=1e-9, atol=1e-12)
    peaks, front = tuning.trials.peaks(), tuning.front.peaks()
    assert not any(((peaks <= point).all(axis=1) & (peaks < point).any(axis=1)).any() for point in front)
    assert all((front <= point).all(axis=1).any() for point in peaks)
    assert (np.diff(front[:, 0]) > 0).all()
    assert (np.diff(front[:, 1]) < 0).all()


def test_limit_distance_agrees_with_simulate():
    path = fp.Circle(0.1, 1.0).in_plane("yz")
    tuning = fp.tune(PANDA, path, READY, "limit_distance", dt=0.02, task="pose", trials=20, workers=1)
    np.testing.assert_allclose(tuning.value, objective_of(tuning, tuning.scheme, dt=0.02), rtol=1e-9)
    assert 0 < tuning.value <= tuning.baseline_value


def test_the_range_used_is_one_on_a_bound():
    run = fp.simulate(PANDA, fp.Line([0.0, 0.0, 0.01], 0.1), fp.MVN(), READY, dt=0.01)
    for bound in (PANDA.limits.lower, PANDA.limits.upper):
        run.q[:] = (PANDA.limits.lower + PANDA.limits.upper) / 2
        assert tuner.limit_distance(run) == 0.0
        run.q[3, 5] = bound[5]
        assert tuner.limit_distance(run) == pytest.approx(1.0, abs=1e-14)


def test_tuning_improves_the_baseline(tuning):
    assert tuning.improvement > 0.1
    assert tuning.value == pytest.approx((1 - tuning.improvement) * tuning.baseline_value)
    assert len(tuning.front) >= 2


@pytest.mark.parametrize(
    ("before", "words"), [(-2.0, "50 % below the baseline's -2"), (0.0, "against the baseline's 0")]
)
def test_objectives_need_not_be_positive(before, words):
    def negative_objective(run):
        return before if "null_damping" not in repr(run.scheme) else -3.0

    tuning = quick(negative_objective, trials=2)
    assert tuning.value == -3.0
    assert words in str(tuning)
    assert np.isnan(tuning.improvement) if before == 0 else tuning.improvement == 0.5


def same(a, b):
    """Two tunings are equal to the last bit."""
    for name in ("value", "peak_velocity", "peak_acceleration", "error", "feasible"):
        assert getattr(a.trials, name).tobytes() == getattr(b.trials, name).tobytes(), name
    for name in KEYS:
        assert a.trials.parameters[name].tobytes() == b.trials.parameters[name].tobytes(), name
    assert repr(a.sensitivity) == repr(b.sensitivity)
    assert str(a) == str(b)


def test_workers_change_nothing(tuning):
    same(quick(trials=120, workers=3), tuning)
    with ThreadPoolExecutor(2) as threads:
        same(quick(trials=120, workers=None, executor=threads), tuning)
    with ProcessPoolExecutor(1) as processes:
        same(quick(trials=120, workers=None, executor=processes), tuning)


def test_a_seed_determines_the_result():
    same(quick(seed=3), quick(seed=3))
    assert quick(seed=3).scheme is not quick(seed=4).scheme
    assert quick(seed=3).value != quick(seed=4).value


def test_only_searched_parameters_vary():
    baseline = fp.FPBM(0.3, [2, 2, 4, 4], 5, 7, null_damping=0.5, rest_posture=Q0, null_stiffness=1)
    before = repr(baseline)
    ranges = {"k1": (1, 3), "weights": [(0.5, 0.6), (1, 2), (3, 9)]}
    tuning = quick(search=ranges, baseline=baseline)
    found = tuning.trials.parameters
    assert tuning.baseline is baseline
    assert repr(baseline) == before
    assert [found[name][0] for name in ("alpha", "k1", "k2", "null_damping")] == [0.3, 5.0, 7.0, 0.5]
    assert (found["alpha"] == 0.3).all()
    assert (found["k2"] == 7.0).all()
    assert (found["null_damping"] == 0.5).all()
    assert ((found["k1"][1:] >= 1) & (found["k1"][1:] <= 3)).all()
    assert (found["weights"][1:, 0] == 1).all()
    for i, (low, high) in enumerate(ranges["weights"], 1):
        assert found["weights"][1:, i].min() >= low
        assert found["weights"][1:, i].max() <= high
        assert np.ptp(found["weights"][1:, i]) > 0.3 * (high - low)
    assert all("rest_posture=[0.26" in repr(scheme) for scheme in tuning.trials.schemes)
    assert repr(fp.FPBM(**tuning.parameters, rest_posture=Q0, null_stiffness=1)) == repr(tuning.scheme)


def test_infeasible_schemes_are_never_returned():
    """At steps of 0.25 s RK4 errs, by 3e-5 m to 1e-4 m."""
    bound = 3.25e-5
    tuning = quick("peak_acceleration", dt=0.25, tolerance=bound, trials=80)
    trials = tuning.trials
    assert 5 < trials.feasible.sum() < 75
    assert (trials.error[trials.feasible] <= bound).all()
    assert (trials.error[~trials.feasible] > bound).all()
    assert trials.value[~trials.feasible].min() < tuning.value
    assert fp.simulate(ARM, CIRCLE, tuning.scheme, Q0, dt=0.25).max_error() <= bound
    assert tuning.front.feasible.all()


def test_an_objective_that_is_not_finite_is_infeasible():
    def sometimes_nan(run):
        return np.nan if np.abs(run.qd).max() < 0.3 else np.abs(run.qd).max()

    tuning = quick(sometimes_nan)
    assert 0 < tuning.trials.feasible.sum() < 41
    assert tuning.value >= 0.3
    assert tuning.objective == "sometimes_nan"


def test_a_baseline_that_is_infeasible():
    gains = {"k1": (0.5, 5), "k2": (0.5, 5)}
    tuning = quick(baseline=fp.FPBM(0.0, [1, 1, 1, 1], 0, 0), search=gains, dt=0.25, tolerance=2e-4)
    assert not tuning.trials.feasible[0]
    assert np.isnan(tuning.baseline_value)
    assert np.isnan(tuning.improvement)
    assert "where the baseline is infeasible" in str(tuning)
    assert tuning.trials.feasible[tuning.trials.best()]


def test_tuning_without_feasible_schemes_raises():
    with pytest.raises(RuntimeError, match="none of 9 schemes is feasible: 9 stopped early"):
        fp.tune(ARM, fp.Line([5, 0], 5.0), Q0, dt=0.05, trials=8)
    with pytest.raises(
        RuntimeError, match=r"0 stopped early .* the least error of the other schemes is .*, above tolerance = "
    ):
        quick(dt=0.25, tolerance=1e-12)


def test_sensitivity(tuning):
    parameters = tuning.parameters
    assert list(tuning.sensitivity) == ["alpha", *(f"weights[{i}]" for i in range(4)), "k1", "k2", "null_damping"]
    for i, factor in enumerate((0.9, 1.1)):
        weights = parameters["weights"] * [1, 1, factor, 1]
        value = objective_of(tuning, fp.FPBM(**{**parameters, "weights": weights}), dt=0.05)
        assert tuning.sensitivity["weights[2]"][i] == pytest.approx(value - tuning.value, abs=1e-12)
        alpha = np.clip(parameters["alpha"] + (factor - 1) / 2, 0, 1)
        value = objective_of(tuning, fp.FPBM(**{**parameters, "alpha": alpha}), dt=0.05)
        assert tuning.sensitivity["alpha"][i] == pytest.approx(value - tuning.value, abs=1e-12)
        assert abs(tuning.sensitivity["k1"][i]) < 1e-6


def test_a_parameter_at_its_bound_has_no_sensitivity():
    tuning = quick(search={"weights": (0.5, 2)}, baseline=fp.FPBM(1, [1, 1, 1, 1], 1, 1), trials=4)
    assert np.isnan(tuning.sensitivity["alpha"][1])
    assert np.isfinite(tuning.sensitivity["alpha"][0])
    assert np.isnan(tuning.sensitivity["null_damping"]).all()


def test_a_step_to_an_infeasible_scheme_has_infinite_sensitivity():
    scheme = fp.FPBM(0.5, [1, 2], 1, 1, null_damping=1)

    def run(schemes):
        ones = np.ones(len(schemes))
        return Trials(np.array(schemes, dtype=object), ones, ones, ones, ones, feasible=np.arange(len(ones)) > 0)

    steps = np.concatenate(list(sensitivity(scheme, 1.0, run).values())).tolist()
    assert steps == [np.inf, *[0.0] * (len(steps) - 1)]


def test_trials_are_tracked_within_limits():
    path = fp.Circle(0.1, 1.0).in_plane("yz")
    whole = fp.track(PANDA, path, fp.FPBM(0.6, np.arange(1.0, 8.0), 1, 1), READY, dt=0.01)
    velocity = np.full(7, 0.9 * np.abs(whole.qd).max())
    limits = replace(PANDA.limits, velocity=velocity)
    tuning = fp.tune(
        PANDA, path, READY, "energy", dt=0.01, limits=limits, tolerance=0.05, trials=12, workers=1, integral_gain=0.1
    )
    trials = tuning.trials
    assert trials.peak_velocity.max() <= velocity[0] + 1e-9
    for scheme, value, error in zip(trials.schemes, trials.value, trials.error):
        run = fp.track(PANDA, path, scheme, READY, dt=0.01, limits=limits, integral_gain=0.1)
        assert run.max_error() == pytest.approx(error, abs=1e-9)
        assert tuner.energy(run) == pytest.approx(value, rel=1e-9)


def test_options_of_tracking_need_limits():
    with pytest.raises(ValueError, match="limits: must be given"):
        quick(integral_gain=0.1)


def test_text(tuning):
    text = str(tuning)
    assert "peak_velocity of PlanarArm(lengths=[1, 1, 1, 1]) along Circle(radius=0.45" in text
    assert f"{tuning.value:.5g} rad/s, " in text
    assert "121 schemes tried, 121 feasible" in text
    rows = [line.split() for line in text.splitlines()]
    assert ["baseline", "tuned", "-10", "%", "+10", "%"] in rows
    assert [row[:2] for row in rows if row[:1] == ["alpha"]] == [["alpha", "0.6"]]
    assert repr(tuning.scheme) in repr(tuning)


def test_progress():
    reports = []
    quick(progress=lambda done, total: reports.append((done, total)))
    assert reports == sorted(set(reports))
    assert reports[-1] == (41 + 16, 41 + 16)


@pytest.mark.parametrize("after", [20, 41])
def test_interruption_keeps_finished_trials(after):
    def interrupt(done, total):
        if done >= after:
            raise KeyboardInterrupt

    whole = quick()
    with pytest.raises(fp.TuneInterrupted, match=r"interrupted after \d+ schemes") as caught:
        quick(progress=interrupt)
    part = caught.value.tuning
    assert isinstance(caught.value, KeyboardInterrupt)
    assert after <= len(part.trials) <= 41
    assert part.trials.value.tobytes() == whole.trials.value[: len(part.trials)].tobytes()
    assert part.sensitivity == {}
    assert "tuned" in str(part)


def test_interruption_within_an_objective():
    def interrupt(run):
        raise KeyboardInterrupt

    with pytest.raises(fp.TuneInterrupted, match="after 0 schemes") as caught:
        quick(interrupt)
    assert caught.value.tuning is None


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"objective": "speed"}, "objective = 'speed': must be one of 'peak_velocity', 'peak_acceleration', .*, or a"),
        (
            {"objective": "limit_distance"},
            "objective = 'limit_distance': must have a joint with two bounds, and the arm",
        ),
        ({"search": {"beta": (0, 1)}}, "search: 'beta' must be one of 'alpha', 'weights', 'k1', 'k2', 'null_damping'"),
        ({"search": {}}, "search: must name at least one parameter"),
        ({"search": {"alpha": (0.8, 0.2)}}, r"search\['alpha'\] = \(0.8, 0.2\): must be finite, with low < high"),
        ({"search": {"alpha": (0.8, 1.2)}}, r"search\['alpha'\] = \(0.8, 1.2\): must be in \[0, 1\]"),
        ({"search": {"k1": (0, 10)}}, r"search\['k1'\] = \(0, 10\): must be positive, since it is searched on a log"),
        ({"search": {"k1": 10}}, r"search\['k1'\] = 10: must be a pair \(low, high\)"),
        ({"search": {"k1": "low"}}, r"search\['k1'\] = 'low': must be a pair \(low, high\)"),
        ({"search": {"weights": [(1, 2)] * 4}}, r"search\['weights'\].*: must be a pair \(low, high\), or 3 pairs"),
        ({"search": {"weights": (1, np.inf)}}, r"search\['weights'\].*: must be finite"),
        ({"baseline": fp.FPBM(0.5, np.eye(4), 1, 1)}, "baseline = .*: W must be diagonal, of 4 weights"),
        ({"baseline": fp.FPBM(0.5, [1, 2, 3], 1, 1)}, "baseline = .*: W must be diagonal, of 4 weights"),
        ({"trials": 0}, "trials = 0: must be a whole number, at least 1"),
        ({"trials": 2.5}, "trials = 2.5: must be a whole number, at least 1"),
        ({"seed": -1}, "seed = -1: must be a whole number, not negative"),
        ({"tolerance": 0}, "tolerance = 0: must be positive and finite"),
        ({"q0": [0, 0, 0]}, r"q0 = \[0, 0, 0\]: must be .* of shape \(4,\)"),
        ({"q0": [0, 0, 0, np.nan]}, r"q0\[3\] = nan: must be finite"),
        ({"dt": 0.003}, "dt = 0.003: must be a divisor of duration = 10"),
        ({"hold": -1}, "hold = -1"),
        ({"task": "speed"}, "task = 'speed': must be 'position' or 'pose'"),
        ({"workers": 0}, "workers = 0: must be at least 1"),
    ],
)
def test_bad_arguments(change, words):
    def fail(done, total):
        raise AssertionError("something was run")

    arguments = {"q0": Q0, "objective": "peak_velocity", "trials": 8, "progress": fail} | change
    with pytest.raises(ValueError, match=words):
        fp.tune(ARM, CIRCLE, **arguments)


def test_a_baseline_of_another_kind():
    with pytest.raises(TypeError, match="baseline: must be an FPBM, got MAN"):
        quick(baseline=fp.MAN())


def test_missing_libraries(tuning, monkeypatch):
    monkeypatch.setitem(sys.modules, "cmaes", None)
    with pytest.raises(ImportError, match=r'tuning needs cmaes: pip install "fpbm_cpp\[tune\]"'):
        quick()
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for name in [
        name for name in sys.modules if name.startswith(("matplotlib.", "fpbm_cpp.plot", "fpbm_cpp.tuning.f"))
    ]:
        monkeypatch.delitem(sys.modules, name)
    with pytest.raises(ImportError, match=r'plotting needs matplotlib: pip install "fpbm_cpp\[plot\]"'):
        tuning.plot()


def test_the_package_does_not_import_optional_libraries():
    code = "import sys, fpbm_cpp; assert not {'cmaes', 'matplotlib', 'scipy'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_figure(tuning):
    pytest.importorskip("matplotlib")
    partial = fp.Tuning(**{**vars(tuning), "sensitivity": {}, "trials": tuning.trials[:1]})
    for shown in (tuning, partial):
        light, dark = shown.plot(), shown.plot(dark=True)
        for figure in (light, dark):
            figure.canvas.draw()
            assert [axes.get_title(loc="left") for axes in figure.axes] == [
                "(a) Pareto front",
                "(b) Sensitivity",
                "(c) Convergence",
            ]
        assert light.get_facecolor() != dark.get_facecolor()
    (front,) = (line for line in tuning.plot().axes[0].get_lines() if line.get_label() == "front")
    assert set(map(tuple, tuning.front.peaks())) == set(zip(*front.get_data()))


points = st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), max_size=20)


@given(points)
def test_pareto_front(pairs):
    x, y = np.array(pairs, float).reshape(-1, 2).T
    kept = pareto_front(x, y)
    beaten = [any(a <= x[i] and b <= y[i] and (a, b) != (x[i], y[i]) for a, b in pairs) for i in range(len(pairs))]
    assert {pairs[i] for i in kept} == {pair for pair, loses in zip(pairs, beaten) if not loses}
    assert len({pairs[i] for i in kept}) == len(kept)


def test_a_search_finds_the_minimum():
    goal = np.array([0.2, 0.9, 0.5])
    seeking, scored = search.least(3, 0), []
    points = next(seeking)
    for _ in range(30):
        assert ((points >= 0) & (points <= 1)).all()
        scores = np.sum((points - goal) ** 2, axis=1) + 1
        scores[points[:, 0] < 0.1] = np.nan  # Infeasible region.
        scored += scores.tolist()
        points = seeking.send(scores)
    assert np.nanmin(scored) < 1.001


def test_a_converged_search_restarts_at_another_point():
    seeking = search.least(2, 0)
    next(seeking)
    begun = [seeking.send(np.ones(16)).mean(axis=0) for _ in range(40)]
    assert np.std(begun, axis=0).min() > 0.1


def test_a_search_finds_a_concave_front():
    """The problem of Fonseca and Fleming: weighted sums of both objectives find only the ends of this front."""
    seeking, scored = search.front(2, 0), []
    points = next(seeking)
    for _ in range(20):
        x = 4 * points - 2
        scores = np.column_stack([1 - np.exp(-np.sum((x + side / np.sqrt(2)) ** 2, axis=1)) for side in (-1, 1)])
        scored += scores.tolist()
        points = seeking.send(scores)
    f, g = np.array(scored).T
    kept = pareto_front(f, g)
    on_front = 1 - np.exp(-((2 - np.sqrt(-np.log(1 - f[kept]))) ** 2))
    assert np.quantile(np.abs(g[kept] - on_front), 0.9) < 0.02
    late = np.abs(f - g)[-160:]
    assert np.mean(late < 0.6) > 0.3
    assert np.mean(late > 0.6) > 0.3
