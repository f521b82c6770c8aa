"""The loop behind the handle: for every input, the arm keeps its limits, follows if possible and stops."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fpbm_cpp as fp
from fpbm_cpp.viewer.loop import MOST, ServoLoop

PANDA = fp.SerialArm.preset("panda")
READY = np.array([0, -0.3, 0, -2.2, 0, 2.0, 0.785])
PLANAR = fp.PlanarArm([1, 1, 1, 1])
BENT = np.pi / np.array([12, 12, 15, 15])
FRAME = 1 / 30


def bounds(n=4, jerk=200.0):
    wide = np.full(n, 2.5)
    return fp.JointLimits(lower=-wide, upper=wide, velocity=wide, acceleration=4 * wide, jerk=np.full(n, jerk))


class Clock:
    """A clock that the test advances."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        self.now += 1e-9  # Two targets never arrive at the same time.
        return self.now


def fpbm(n, **options):
    return fp.FPBM(0.6, np.ones(n), 10, 25, **{"null_damping": 2, **options})


def a_loop(which="panda", task="pose", scheme=None, **how):
    arm, q0, limits = (PANDA, READY, None) if which == "panda" else (PLANAR, BENT, bounds())
    clock = Clock()
    how = {"limits": limits, "task": task, **how}
    return ServoLoop(arm, scheme or fpbm(arm.dof), q0, clock=clock, **how), clock


def play(loop, clock, seconds, frame=FRAME):
    ticks = []
    for _ in range(round(seconds / frame)):
        clock.now += frame
        ticks += loop.advance()
    return ticks


def moved(x, displacement):
    """A target, moved by so much [m]."""
    x = np.array(x)
    if x.shape == (4, 4):
        x[: len(displacement), 3] += displacement
    else:
        x[: len(displacement)] += displacement
    return x


def kept(loop, q0, ticks):
    """Every bound, by differences of the positions and velocities that were sent."""
    limits, h = loop.limits, loop.dt
    q, qd = np.array([q0, *(t.q for t in ticks)]), np.array([0 * q0, *(t.qd for t in ticks)])
    qdd = np.diff(qd, axis=0) / h
    jerk = np.diff(qdd, axis=0, prepend=0 * q0[None]) / h
    assert ((q >= limits.lower - 1e-9) & (q <= limits.upper + 1e-9)).all()
    assert (np.abs(qd) <= limits.velocity * (1 + 1e-9)).all()
    assert (np.abs(np.diff(q, axis=0)) <= h * limits.velocity * (1 + 1e-9)).all()
    assert (np.abs(qdd) <= limits.acceleration * (1 + 1e-9)).all()
    assert (np.abs(jerk) <= limits.jerk * (1 + 1e-9) + 1e-9 / h**2).all()


KINDS = [("panda", "pose"), ("panda", "position"), ("planar", "pose"), ("planar", "position")]


@pytest.mark.parametrize(("which", "task"), KINDS)
@settings(max_examples=15, deadline=None)
@given(data=st.data())
def test_limits_are_kept_for_any_handle_jump(which, task, data):
    """Near, unreachable, through the base; with frames of any length, stops, and other schemes."""
    loop, clock = a_loop(which, task)
    q0, start, ticks = loop.q, loop.target, []
    size = 3 if which == "panda" else 2
    schemes = [fp.MAN(null_damping=1), fpbm(len(q0), joint_centring=1), fp.WMVN(np.arange(1, len(q0) + 1), k=5)]
    for _ in range(data.draw(st.integers(3, 12))):
        displacement = np.array(data.draw(st.lists(st.floats(-1, 1), min_size=size, max_size=size)))
        assert loop.push(moved(start, data.draw(st.sampled_from([0.1, 0.5, 5.0])) * displacement))
        action = data.draw(st.sampled_from(["", "", "stop", "resume", "scheme"]))
        if action == "scheme":
            loop.scheme = data.draw(st.sampled_from(schemes))
        elif action:
            getattr(loop, action)()
        ticks += play(loop, clock, 0.6, data.draw(st.sampled_from([0.0005, 0.01, FRAME, 0.1])))
    kept(loop, q0, ticks)
    shares = loop.strip.shares
    assert (shares[:3] <= 1 + 1e-6).all()
    assert ((shares[-1] >= 0) & (shares[-1] <= 1)).all()


@pytest.mark.parametrize(("which", "task"), KINDS)
def test_the_arm_stops_at_a_released_handle(which, task):
    loop, clock = a_loop(which, task)
    q0, start, ticks = loop.q, loop.target, []
    for share in np.linspace(0, 1, 20):
        loop.push(moved(start, share * np.array([-0.1, 0.15])))
        ticks += play(loop, clock, 0.05, 0.05)
    ticks += play(loop, clock, 8)
    kept(loop, q0, ticks)
    np.testing.assert_allclose(loop.tip, moved(start, [-0.1, 0.15]), atol=1e-6)
    assert np.abs(loop.tick.qd).max() < 1e-3
    assert loop.status is fp.Status.OK


@pytest.mark.parametrize(("which", "task"), KINDS)
def test_unreachable_target_stops_and_returns(which, task):
    loop, clock = a_loop(which, task)
    q0, start = loop.q, loop.target
    loop.push(moved(start, [0.0, 5.0]))
    ticks = play(loop, clock, 40)
    assert loop.status is fp.Status.STALLED
    assert np.abs(loop.tick.qd).max() < 1e-6
    assert {tick.status for tick in ticks} >= {fp.Status.OK, fp.Status.SLOWED, fp.Status.STALLED}
    loop.push(start)
    ticks += play(loop, clock, 15)
    np.testing.assert_allclose(loop.tip, start, atol=1e-4)
    assert loop.status is fp.Status.OK
    kept(loop, q0, ticks)


def test_the_status_is_the_worst_of_a_quarter_of_a_second():
    loop, clock = a_loop("planar", "position")
    loop.push([1.0, 3.0])
    ticks, mixed = [], 0
    for _ in range(100):
        ticks += play(loop, clock, FRAME)
        recent = [tick.status for tick in ticks[-250:]]
        mixed += len(set(recent)) > 1
        assert loop.status is max(recent, key=lambda status: status.value)
    assert mixed


def test_a_singular_posture_is_crossed():
    """The handle moves from one side of a planar arm's base to the other, through the stretched posture's line."""
    loop, clock = a_loop("planar", "position")
    q0, ticks = loop.q, []
    for share in np.linspace(0, 1, 100):
        loop.push([4.2 * np.cos(2 * share), 4.2 * np.sin(2 * share)])  # The reach is 4 m.
        ticks += play(loop, clock, 0.05, 0.05)
    assert {tick.status for tick in ticks} & {fp.Status.DAMPED, fp.Status.SLOWED}
    loop.push([-1.0, 2.0])
    ticks += play(loop, clock, 15)
    np.testing.assert_allclose(loop.tip, [-1.0, 2.0], atol=1e-4)
    kept(loop, q0, ticks)


def test_a_motion_stops_and_resumes():
    loop, clock = a_loop()
    q0, target = loop.q, moved(loop.target, [0.1, 0.2])
    loop.push(target)
    ticks = play(loop, clock, 0.3)
    assert np.abs(loop.tick.qd).max() > 0.1
    loop.stop()
    assert loop.stopped
    ticks += play(loop, clock, 1)
    assert np.abs(loop.tick.qd).max() == 0
    stopped = loop.q
    ticks += play(loop, clock, 1)
    np.testing.assert_array_equal(loop.q, stopped)
    loop.scheme = fpbm(7, joint_centring=1)  # The arm stays stopped.
    ticks += play(loop, clock, 0.2)
    np.testing.assert_array_equal(loop.q, stopped)
    loop.scheme = fpbm(7)
    loop.resume()
    ticks += play(loop, clock, 8)
    np.testing.assert_allclose(loop.tip, target, atol=1e-6)
    kept(loop, q0, ticks)


def test_a_restart_returns_to_the_start():
    loop, clock = a_loop()
    loop.push(moved(loop.target, [0.1, 0.2]))
    play(loop, clock, 0.5)
    loop.stop()
    loop.restart()
    assert not loop.stopped
    assert (loop.tick, loop.time, loop.status) == (None, 0.0, fp.Status.OK)
    assert loop.strip.shares.shape == (5, 0)
    ticks = play(loop, clock, 1)
    np.testing.assert_allclose(loop.q, READY, atol=1e-9)
    kept(loop, READY, ticks)


@pytest.mark.parametrize("frame", [1e-4, 7e-4, 0.01, FRAME, MOST])
def test_simulated_time_keeps_pace_with_the_clock(frame):
    loop, clock = a_loop()
    assert len(play(loop, clock, 0.5, frame)) == pytest.approx(round(0.5 / frame) * frame / loop.dt, abs=1)
    assert loop.time == pytest.approx(round(0.5 / frame) * frame, abs=loop.dt)


def test_a_slow_machine_drops_time():
    loop, clock = a_loop()
    for seconds in (0.5, 3600.0):
        clock.now += seconds
        assert len(loop.advance()) == pytest.approx(MOST / loop.dt, abs=1)
    target = moved(loop.target, [0.0, 0.1])
    loop.push(target)
    for _ in range(100):  # A frame takes five times as long as the simulated time.
        clock.now += 5 * MOST
        loop.push(target)
        ticks = loop.advance()
        assert len(ticks) <= MOST / loop.dt + 1
    np.testing.assert_allclose(loop.tip, target, atol=1e-6)


def test_the_strip_records_the_ticks():
    limits = bounds()
    loop, clock = a_loop("planar", "position", limits=limits)
    loop.push([1.0, 2.0])
    ticks = play(loop, clock, 3)
    qd, qdd = np.array([t.qd for t in ticks]), np.array([t.qdd for t in ticks])
    jerk = np.diff(qdd, axis=0, prepend=0) / loop.dt
    expected = [np.abs(qd / limits.velocity), np.abs(qdd / limits.acceleration), np.abs(jerk / limits.jerk)]
    expected = np.array([*(each.max(axis=1) for each in expected), [t.scale for t in ticks]])
    np.testing.assert_allclose(loop.strip.shares, expected)
    t, worst = loop.strip.curves()
    there = ~np.isnan(worst[0])
    assert t[-1] == pytest.approx(3.0, abs=0.06)
    np.testing.assert_allclose(worst[:3, there].max(axis=1), expected[:3].max(axis=1), rtol=1e-12)
    assert worst[3, there].min() == expected[3].min()
    first = worst[:, there]
    play(loop, clock, 0.52, 0.013)  # A peak keeps its height while it moves along the strip.
    later = loop.strip.curves()[1]
    np.testing.assert_array_equal(later[:, ~np.isnan(later[0])][:, : first.shape[1]], first)
    play(loop, clock, 20)
    t, worst = loop.strip.curves()
    assert (t[-1] - t[0], worst.shape) == (pytest.approx(9.95), (4, 200))
    assert worst[0].max() < 0.01


def test_unbounded_quantities_have_no_share():
    loop, clock = a_loop("planar", "position", limits=None)
    loop.push([1.0, 2.0])
    play(loop, clock, 1)
    assert loop.strip.bounded == (False, False, False)
    assert (loop.strip.shares[:3] == 0).all()
    assert ServoLoop(PANDA, fpbm(7), READY).strip.bounded == (True, True, True, True)


def test_a_target_filter_bounds_the_speed_of_the_tip():
    tip = fp.Tracker(PANDA, fpbm(7), READY).tip
    targets = fp.TargetFilter(tip, velocity=0.02, acceleration=1, jerk=10)
    loop, clock = a_loop("panda", "position", targets=targets)
    loop.push(moved(tip, [0.2]))
    tips = []
    for _ in range(60):
        play(loop, clock, FRAME)
        tips.append(loop.tip)
    assert np.abs(np.diff(tips, axis=0)).max() / FRAME < 0.021


@pytest.mark.parametrize(("which", "task"), KINDS)
def test_the_speed_of_the_handle_is_reduced_in_motion(which, task):
    loop, clock = a_loop(which, task)
    q0, target = loop.q, moved(loop.target, [-0.3, 0.3])
    assert loop.speed == 1.0
    loop.push(target)
    ticks = play(loop, clock, 0.3)
    loop.set_speed(0.05)
    assert loop.speed == 0.05
    ticks += play(loop, clock, 0.5)
    before = np.array(loop.tip)
    ticks += play(loop, clock, 0.5)
    assert (
        0 < np.abs(np.array(loop.tip) - before).max() < 0.05 * 4 * 0.55
    )  # The bound is the length of the arm per second.
    loop.restart()
    assert loop.speed == 0.05
    loop.set_speed(1.0)
    loop.push(target)
    play(loop, clock, 8)
    np.testing.assert_allclose(loop.tip, target, atol=1e-6)
    kept(loop, q0, ticks)


def post(x=2.2, y=0.3):
    return fp.Capsule(0, [x, y, -1], [x, y, 1], 0.1, "post")


def a_clear_loop(**how):
    links = [fp.Capsule(i, [0, 0, 0], [1, 0, 0], 0.05, f"link {i}") for i in range(1, 5)]
    return a_loop("planar", "position", bounds=[fp.Clearance(links, [post()])], **how)


@settings(max_examples=15, deadline=None)
@given(st.lists(st.tuples(st.floats(-4, 4), st.floats(-4, 4)), min_size=1, max_size=5))
def test_no_shape_is_touched_for_any_handle_jump(places):
    loop, clock = a_clear_loop()
    for place in places:
        loop.push(place)
        for tick in play(loop, clock, 1):
            assert tick.nearest.distance >= loop.clearance.margin - 1e-9
            assert (np.abs(tick.qd) <= loop.limits.velocity + 1e-9).all()


def test_a_dragged_obstacle_moves_at_a_bounded_speed():
    loop, clock = a_clear_loop()
    loop.push([2.6, 2.4])
    play(loop, clock, 3)
    there = loop.tip
    for displacement in ([0.0, 0.6, 0.0], [-0.3, 0.6, 0.0], [0.0, 0.0, 0.0]):
        before = loop.clearance.obstacles[0].a
        loop.drag("post", displacement)
        for _ in range(60):
            nearest = [tick.nearest.distance for tick in play(loop, clock, FRAME)]
            now = loop.clearance.obstacles[0].a
            assert np.linalg.norm(now - before) <= 0.3 * len(nearest) * loop.dt + 1e-9
            assert min(nearest) >= loop.clearance.margin - 1e-3
            before = now
        play(loop, clock, 2)
        np.testing.assert_allclose(loop.clearance.obstacles[0].a, post().a + displacement, atol=1e-12)
    play(loop, clock, 3)
    np.testing.assert_allclose(loop.tip, there, atol=1e-4)


def test_obstacles_outlast_a_scheme_change_and_return_at_a_restart():
    loop, clock = a_clear_loop()
    loop.drag("post", [0.3, 0.0, 0.0])
    play(loop, clock, 2)
    loop.scheme = fp.MVN(k=5)
    tick = play(loop, clock, FRAME)[-1]
    expected = loop.clearance.nearest(PLANAR, loop.q)
    assert loop.clearance.obstacles[0] == post(2.5)
    assert tick.nearest.pair == expected.pair
    assert tick.nearest.distance == pytest.approx(expected.distance, abs=1e-9)
    loop.drag("post", [-1.0, 0.0, 0.0])
    loop.restart()
    play(loop, clock, 1)
    assert loop.clearance.obstacles[0] == post()
    with pytest.raises(ValueError, match=r"name = 'wall': must be one of the obstacles: post"):
        loop.drag("wall", [0, 0, 0])


def test_invalid_arguments_are_rejected():
    bent = fp.PlanarArm([1, 1, 1])
    limits = fp.JointLimits(lower=[-3] * 3, upper=[3] * 3, velocity=[1] * 3, acceleration=[np.inf] * 3)
    with pytest.raises(ValueError, match=r"limits.acceleration\[0\] = inf: must be finite"):
        ServoLoop(bent, fpbm(3), [0.1, 1, 1], limits=limits)
    other = fp.TargetFilter([0, 0, 0], velocity=1, acceleration=1, jerk=1)
    with pytest.raises(ValueError, match="is for another task"):
        a_loop("panda", "pose", targets=other)
    with pytest.raises(ValueError, match="dt"):
        a_loop("panda", "position", targets=other, dt=0.002)
    loop, clock = a_loop()
    for invalid in (np.full((4, 4), np.nan), np.zeros((4, 4)), np.diag([1, 1, -1, 1.0])):
        assert not loop.push(invalid)
    with pytest.raises(ValueError, match="shape"):
        loop.push([0, 0, 0])
    scheme = loop.scheme
    with pytest.raises(ValueError, match="weights has 3 entries"):
        loop.scheme = fp.WMVN([1, 2, 3])
    assert loop.scheme is scheme
    play(loop, clock, 1)
    np.testing.assert_allclose(loop.q, READY, atol=1e-9)


def test_simultaneous_threads_are_safe():
    loop = ServoLoop(PANDA, fpbm(7), READY)  # By the true clock.
    start, errors = loop.target, []
    actions = [loop.advance, loop.stop, loop.resume, lambda: loop.push(start), lambda: loop.status, loop.restart]

    def work(action):
        try:
            for _ in range(200):
                action()
        except Exception as error:
            errors.append(error)

    threads = [threading.Thread(target=work, args=(action,)) for action in actions]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not errors


def differences(q, others):
    """Largest difference of a joint from each of the other postures, modulo whole turns."""
    return [np.max(np.abs(np.angle(np.exp(1j * (q - other))))) for other in others]


def test_another_posture_has_the_same_tip():
    arm = fp.SerialArm.preset("ur5e")
    loop = ServoLoop(arm, fp.MVN(k=5), [0.3, -1.1, 1.4, -0.9, 1.2, 0.4], task="pose", clock=Clock())
    start, seen = arm.forward(loop.q), [loop.q]
    for _ in range(7):
        assert loop.change_posture()
        assert arm.forward(loop.q) == pytest.approx(start, abs=1e-5)
        assert min(differences(loop.q, seen)) > 0.5  # All eight branches, each once.
        seen.append(loop.q)
    assert loop.change_posture()  # A branch of before.
    assert min(differences(loop.q, seen)) < 1e-3
    loop.restart()
    assert (loop.q == seen[0]).all()


def test_a_planar_arm_of_two_joints_has_one_other_posture():
    loop = ServoLoop(
        fp.PlanarArm([1, 1]), fp.MVN(k=5), [0.3, 1.0], limits=fp.JointLimits(acceleration=10), clock=Clock()
    )
    assert loop.change_posture()
    assert loop.q == pytest.approx([1.3, -1.0], abs=1e-5)
