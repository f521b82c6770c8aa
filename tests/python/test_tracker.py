"""The tracker from Python: its references and bounds, and its saturation compared with a solver."""

from dataclasses import replace

import numpy as np
import pytest

import fpbm_cpp as fp

DT = 1e-3
BENT = np.array([0.0, -0.3, 0.0, -1.8, 0.0, 1.6, 0.8])


@pytest.fixture(scope="module")
def panda():
    return fp.SerialArm.preset("panda")


@pytest.fixture
def settling():
    return fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=4, rest_posture=BENT, null_stiffness=4)


def is_viable(limits, q, qd):
    """Whether each joint can still stop in time, by the envelope -A h/2 + sqrt(2 A (d + A h^2/8)) at distance d."""
    c = limits.acceleration * DT / 2

    def stops(distance, speed):
        p = speed + c
        return (distance >= 0) & (
            (p <= 0) | (p**2 <= 2 * limits.acceleration * (distance + c**2 / (2 * limits.acceleration)))
        )

    return (np.abs(qd) <= limits.velocity) & stops(limits.upper - q, qd) & stops(q - limits.lower, -qd)


def box(limits, q, qd):
    """The accelerations of each joint that lead to a viable state, by bisection from a viable acceleration."""
    stop = np.clip(-qd / DT, -limits.acceleration, limits.acceleration)
    ends = []
    for far in (-limits.acceleration, limits.acceleration):
        good, bad = stop.copy(), far.copy()
        for _ in range(60):
            a = (good + bad) / 2
            viable = is_viable(limits, q + DT * (qd + DT / 2 * a), qd + DT * a)
            good, bad = np.where(viable, a, good), np.where(viable, bad, a)
        ends.append(np.where(is_viable(limits, q + DT * (qd + DT / 2 * far), qd + DT * far), far, good))
    return ends


def random_viable(rng, limits, speed):
    while True:
        q = rng.uniform(limits.lower, limits.upper)
        qd = speed * rng.uniform(-limits.velocity, limits.velocity)
        if is_viable(limits, q, qd).all():
            return q, qd


def random_demands(rng, limits, m):
    """Viable q, qd, with xd, xdd of m rows and the ends of the box, all boxes in one bisection."""
    while True:
        states, demands = [], []
        for _ in range(500):
            states.append(random_viable(rng, limits, speed=rng.uniform(0, 0.4)))
            demands.append(rng.uniform(-1, 1, (2, m)) * rng.uniform(0, 1))
        q, qd = np.swapaxes(states, 0, 1)
        yield from zip(q, qd, *np.swapaxes(demands, 0, 1), *box(limits, q, qd))


def narrow_limits():
    return fp.JointLimits(
        lower=[-2, -1.5, -1.5, -2], upper=[2, 1.5, 1.8, 2], velocity=[1, 1.5, 2, 2], acceleration=[5, 8, 10, 12]
    )


@pytest.mark.parametrize("case", ["panda pose", "panda position", "planar position"])
def test_saturation_finds_the_task_feasible_when_a_solver_does(case, panda):
    """If HiGHS finds a qdd in the box for the whole task, the tracker finds a solution, up to round-off."""
    optimize = pytest.importorskip("scipy.optimize")
    rng = np.random.default_rng(3)
    task = case.split()[-1]
    arm = panda if "panda" in case else fp.PlanarArm([1, 1, 1, 1])
    limits = replace(arm.limits, jerk=None) if "panda" in case else narrow_limits()
    n = arm.dof
    middle = (limits.lower + limits.upper) / 2
    scheme = fp.FPBM(0.6, rng.uniform(1, 4, n), 10, 25, null_damping=2, singular_radius=0.02)
    tracker = fp.Tracker(arm, scheme, middle, task=task, limits=limits, error_bound=1e9, measured_delay=0)
    met = feasible = agreed = 0
    demands = random_demands(rng, limits, len(arm.jacobian(middle, task=task)))
    while feasible < 300:
        q, qd, xd, xdd, lower, upper = next(demands)
        x = arm.forward(q) if task == "pose" else np.asarray(arm.forward(q))[..., :3, 3] if n == 7 else arm.forward(q)
        tick = tracker.resolve_measured(q, qd, x, xd, xdd)
        assert (tick.qdd >= lower - 1e-6).all()
        assert (tick.qdd <= upper + 1e-6).all()
        desired = scheme.resolve(arm, q, qd, x, xd, xdd, task=task)
        if ((lower <= desired) & (desired <= upper)).all():
            continue
        met += 1
        J = arm.jacobian(q, task=task)
        answer = optimize.linprog(
            np.zeros(n), A_eq=J, b_eq=J @ desired, bounds=np.column_stack([lower, upper]), method="highs"
        )
        if answer.status != 0:
            assert tick.scale < 1 + 1e-9
            continue
        feasible += 1
        if tick.scale == 1:
            agreed += 1
            assert np.abs(J @ (tick.qdd - desired)).max() < 1e-9 * max(1, np.abs(J @ desired).max())
            assert tick.status in (fp.Status.OK, fp.Status.DAMPED)
    print(f"{case}: {met} states met a limit, in {feasible} the task is feasible, in {agreed} of these it was done")
    assert agreed >= 0.99 * feasible


def test_an_operator_changes_the_speed_on_the_path(panda, settling):
    """The tip stays on the path, at the fraction of its speed after the ramp; wrong fractions have no effect."""
    tracker = fp.Tracker(panda, settling, BENT, task="pose")
    start = tracker.tip[:3, 3].copy()
    follower = tracker.follow(fp.Circle(0.1, 5.0, time_law="quintic").in_plane("yz"), ramp=0.4)
    assert follower.speed == 1.0
    random = np.random.default_rng(4)
    error = 0.0
    while not follower.done:
        if random.random() < 0.002:
            follower.set_speed(random.uniform(0.05, 1.0))
        tick = tracker.tick(follower)
        assert tick.status is fp.Status.OK
        error = max(error, np.abs(tick.error).max())
    assert error < 1e-6
    np.testing.assert_allclose(tracker.tip[:3, 3], start, atol=1e-6)
    for wrong in (0, -1, 1.01, np.nan, np.inf):
        before = follower.speed
        with pytest.raises(fp.ParameterError, match="fraction = "):
            follower.set_speed(wrong)
        assert follower.speed == before


def test_a_path_is_followed_paused_resumed_and_finished(panda, settling):
    tracker = fp.Tracker(panda, settling, BENT, task="pose")
    follower = tracker.follow(fp.Circle(0.05, 2.0).in_plane("yz"), ramp=0.2)
    for i in range(4000):
        if i == 500:
            follower.pause()
        if i == 1000:
            follower.resume()
        tick = tracker.tick(follower)
        assert tick.status is fp.Status.OK
        assert np.abs(tick.error).max() < 1e-5
    assert follower.done
    assert np.abs(tracker.qd).max() < 1e-2
    np.testing.assert_array_equal(tick.q, tracker.q)


def test_a_motion_stops_and_resumes(panda, settling):
    tracker = fp.Tracker(panda, settling, BENT, task="position")
    target = tracker.tip + np.array([0, 0.2, 0])
    for _ in range(300):
        tracker.tick(target)
    assert np.abs(tracker.qd).max() > 0.05
    tracker.stop()
    for _ in range(300):
        assert tracker.tick(target).scale == 0
    assert (tracker.qd == 0).all()
    tracker.resume()
    for _ in range(5000):
        tick = tracker.tick(target)
    assert np.abs(tick.error).max() < 1e-9


@pytest.mark.parametrize("jerk", [np.inf, 1.0, 0.2])
@pytest.mark.parametrize("level", ["velocity", "acceleration"])
def test_unreachable_target_stops_and_returns(panda, settling, level, jerk):
    """Limits keep the elbow from passing its outstretched posture, as docs/limits.md says."""
    stretched = np.array([np.inf, np.inf, np.inf, -0.47, np.inf, np.inf, np.inf])
    limits = replace(panda.limits, upper=np.minimum(panda.limits.upper, stretched), jerk=jerk * panda.limits.jerk)
    scheme = settling if level == "acceleration" else fp.MVN(k=5, rest_posture=BENT, null_stiffness=1)
    tracker = fp.Tracker(panda, scheme, BENT, task="position", limits=limits)
    home = tracker.tip
    last = tracker.qdd
    seen = set()
    for target, ticks in ((home + np.array([0.6, 0, 0]), 8000), (home, 6000)):
        for _ in range(ticks):
            tick = tracker.tick(target)
            seen.add(tick.status)
            assert (np.abs(tick.qdd) <= limits.acceleration + 1e-9).all()
            assert (np.abs(tick.qdd - last) <= limits.jerk * DT * (1 + 1e-9)).all()
            last = tick.qdd
            assert (np.abs(tick.qd) <= limits.velocity + 1e-9).all()
            assert (tick.q <= limits.upper + 1e-9).all()
            assert (tick.q >= limits.lower - 1e-9).all()
        assert np.abs(tick.qd).max() < 1e-3
    assert np.abs(tick.error).max() < 1e-9
    assert seen - {fp.Status.SLOWED} == {fp.Status.OK, fp.Status.DAMPED, fp.Status.STALLED}


def test_manipulability_gain_increases_manipulability(panda):
    scheme = fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=4, manipulability_gain=1.0)
    tracker = fp.Tracker(panda, scheme, BENT, task="position")
    start = tracker.tip
    before = np.linalg.svd(panda.jacobian(BENT))[1].prod()
    for _ in range(3000):
        tick = tracker.tick(start)
    assert np.abs(tick.error).max() < 1e-9
    assert np.linalg.svd(panda.jacobian(tracker.q))[1].prod() > before


@pytest.mark.parametrize("make", [fp.MAN, lambda **how: fp.FPBM(0.6, np.ones(7), 10, 25, **how)], ids=["MAN", "FPBM"])
def test_self_motion_comes_to_rest(panda, make):
    def speed(scheme, **options):
        """Speed of the fastest joint after a motion and 10 s at rest."""
        tracker = fp.Tracker(panda, scheme, BENT, task="pose", **options)
        follower = tracker.follow(fp.Circle(0.1, 5.0, time_law="quintic").in_plane("yz"))
        for _ in range(15_000):
            tick = tracker.tick(follower)
        return np.abs(tick.qd).max()

    assert speed(make()) < 1e-6
    assert speed(make(), null_damping=0) > 1e-3
    own = make(null_damping=4)
    assert speed(own) == speed(own, null_damping=0) == speed(make(), null_damping=4)


@pytest.mark.parametrize(
    ("scheme", "options", "words"),
    [
        (fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=3000), {}, "null_damping = 3000: must be at most 999"),
        (
            fp.FPBM(0.6, np.ones(7), 10, 25),
            {"null_damping": 200, "dt": 0.02},
            "null_damping = 200: must be at most 49",
        ),
        (fp.WMVN(np.ones(7), k=3000), {}, "k = 3000: must be at most 2785"),
        (fp.FPBM(0.6, np.ones(7), 5000, 6.25e6), {}, "k1 = 5000: must be at most 3192 with k2 = "),
        (
            fp.FPBM(0.6, np.ones(7), 10, 25, rest_posture=BENT, null_stiffness=1e6),
            {},
            "null_stiffness = 1000000: must be",
        ),
        (fp.FPBM(0.6, np.ones(7), 10, 25), {"integral_gain": 300}, "integral_gain = 300: must be at most 246"),
    ],
)
def test_unstable_gains_are_rejected(panda, scheme, options, words):
    with pytest.raises(fp.ParameterError, match=words) as caught:
        fp.Tracker(panda, scheme, BENT, **options)
    assert caught.value.name == words.partition(" ")[0]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"dt": 0}, "dt = 0: must be positive"),
        ({"error_bound": -1}, "error_bound = -1: must be positive"),
        ({"integral_gain": -1}, "integral_gain = -1"),
        ({"stall_time": 0}, "stall_time = 0: must be positive, or infinite"),
        ({"singular_radius": 2}, "singular_radius = 2"),
        ({"null_damping": -1}, "null_damping = -1"),
        ({"task": "dance"}, "task = 'dance'"),
        ({"limits": narrow_limits()}, "limits has 4 entries"),
        ({"qd0": [9] * 7}, r"qd0\[0\] = 9: must be slow enough"),
    ],
)
def test_bad_arguments(panda, settling, options, words):
    with pytest.raises(ValueError, match=words):
        fp.Tracker(panda, settling, BENT, **options)


def test_a_missing_limit_is_named(panda, settling):
    arm = replace(panda, joints=[replace(joint, acceleration=np.inf) for joint in panda.joints])
    with pytest.raises(ValueError, match=r"limits.acceleration\[0\] = inf: must be finite"):
        fp.Tracker(arm, settling, BENT)


def test_bad_references(panda, settling):
    tracker = fp.Tracker(panda, settling, BENT)
    with pytest.raises(ValueError, match="x has 2 entries"):
        tracker.tick([0, 0])
    with pytest.raises(ValueError, match=r"xd\[1\] = nan"):
        tracker.tick([0, 0, 0], [0, np.nan, 0])
    other = fp.Tracker(panda, settling, BENT, task="pose")
    with pytest.raises(ValueError, match="follower: is for another task"):
        tracker.tick(other.follow(fp.Circle(0.1, 1.0).in_plane("xy")))
    slow = fp.Tracker(panda, fp.MVN(), BENT)
    with pytest.raises(ValueError, match="must be at acceleration level"):
        slow.resolve_measured(BENT, np.zeros(7), slow.tip)


@pytest.mark.parametrize("task", ["position", "pose"])
@pytest.mark.parametrize("name", ["panda", "ur5e", "gen3"])
def test_a_tick_without_active_limits_is_a_step_of_rk4(name, task):
    """The same bits as with limits that are a hundred times as wide; other bits in ticks with active limits."""
    arm = fp.SerialArm.preset(name)
    limits = replace(arm.limits, jerk=None)
    wide = replace(limits, velocity=100 * limits.velocity, acceleration=100 * limits.acceleration)
    q0 = np.array([0.3, 0.5, 0.2, -1.5, 0.1, 1.2, 0.4])[: arm.dof]
    scheme = fp.FPBM(0.6, np.ones(arm.dof), k1=10, k2=25, null_damping=2)
    for speed, same in ((0.01, True), (5.0, False)):  # [m/s], of a target that leaves the tip immediately.
        trackers = [fp.Tracker(arm, scheme, q0, task=task, limits=each) for each in (limits, wide)]
        x, xd = np.array(trackers[0].tip), np.zeros(6 if task == "pose" else 3)
        xd[0] = speed
        ticks = []
        for k in range(100):
            moved = x.copy()
            moved[(0, 3) if task == "pose" else 0] += speed * DT * k
            ticks.append([tracker.tick(moved, xd).q.tobytes() for tracker in trackers])
        assert all(ours == others for ours, others in ticks) == same
