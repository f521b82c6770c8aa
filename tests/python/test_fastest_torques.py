"""fastest() and keep_path with bounds on torques: torques by inverse dynamics, the least time, and named failures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import fpbm_cpp as fp

DT = 1e-3
MVN = fp.MVN()
PANDA = fp.SerialArm.preset("panda").with_payload(3.0, com=(0, 0, 0.15))
READY = (0, -0.3, 0, -2.2, 0, 2, 0.785)
UP = fp.Line([0, 0, 0.2])
PLANAR = fp.PlanarArm([0.5, 0.4, 0.3], [4, 3, 2]).with_gravity((0, -9.81, 0))
PLANAR_LIMITS = fp.JointLimits(
    lower=np.full(3, -4.0), upper=np.full(3, 4.0), velocity=np.full(3, 3.0), acceleration=np.full(3, 40.0)
)
VISCOUS = fp.SerialArm([replace(joint, damping=2.0) for joint in PANDA.joints], PANDA.tip)
ROBOTS = {  # Robots, and fractions of their efforts at which torques bound most motions.
    "panda": (PANDA, 0.7),
    "ur10e": (fp.SerialArm.preset("ur10e").with_payload(10.0, com=(0, 0, 0.1)), 0.8),
    "iiwa14": (fp.SerialArm.preset("iiwa14").with_payload(12.0, com=(0, 0, 0.1)), 0.7),
    "viscous": (VISCOUS, 0.7),
}


def torque_ratio(arm, bound, q, qd, qdd=None):
    """Largest ratio of a torque to its bound: at the samples, and with the acceleration of each tick at both ends."""
    mean = np.diff(qd, axis=0) / DT
    motions = [(q[:-1], qd[:-1], mean), (q[1:], qd[1:], mean)] + ([] if qdd is None else [(q, qd, qdd)])
    return max(np.max(np.abs(arm.inverse_dynamics(*motion)) / bound) for motion in motions)


def other_ratio(run):
    q = np.vstack([run.q[:1]] * 3 + [run.q] + [run.q[-1:]] * 3)
    limits = run.limits
    bounds = (limits.velocity, limits.acceleration, np.inf if limits.jerk is None else limits.jerk)
    return max(np.max(np.abs(np.diff(q, k, axis=0)) / DT**k / bound) for k, bound in enumerate(bounds, 1))


def bound_of(arm, fraction):
    return fraction * arm.limits.effort - [joint.friction for joint in arm.joints]


def random_paths(arm, seed, count, plan):
    """Results of plan(path, q0) for random paths that the arm can follow and hold."""
    rng = np.random.default_rng(seed)
    low, high = np.maximum(arm.limits.lower, -2.8), np.minimum(arm.limits.upper, 2.8)
    results = []
    for _ in range(200):
        q0 = low + (high - low) * rng.uniform(0.2, 0.8, arm.dof)
        steps = rng.normal(0.0, 0.08, (rng.integers(3, 8), 3))
        try:
            results.append(plan(fp.Waypoints(np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])), q0))
        except fp.ParameterError as error:
            if not any(text in str(error) for text in ("followed to", "leaves the range", "hold its", "at rest")):
                raise
        if len(results) == count:
            return results
    raise AssertionError("too few paths")


@pytest.mark.parametrize("jerk", [True, False])
@pytest.mark.parametrize("name", ROBOTS)
def test_torques_keep_their_bounds_in_the_least_time(name, jerk):
    arm, fraction = ROBOTS[name]
    limits = arm.limits if jerk else replace(arm.limits, jerk=np.full(arm.dof, np.inf))
    task = "pose" if arm.dof > 6 else "position"
    bound = bound_of(arm, fraction)

    def plan(path, q0):
        return [
            fp.fastest(arm, path, MVN, q0, task=task, limits=limits, bounds=bounds)
            for bounds in ([fp.TorqueBounds(fraction=fraction)], [])
        ]

    slowed = 0
    for run, free in random_paths(arm, 2, 6, plan):
        ratio = torque_ratio(arm, bound, run.q, run.qd, run.qdd)
        assert ratio <= 1 + 1e-9
        assert other_ratio(run) <= 1 + 1e-9
        assert max(ratio, other_ratio(run)) > 0.97
        assert np.abs(run.error).max() < 1e-6
        assert run.t[-1] >= free.t[-1] * (1 - 1e-3)
        if torque_ratio(arm, bound, free.q, free.qd, free.qdd) < 0.99:
            assert run.t[-1] <= free.t[-1] * 1.002
        else:
            slowed += run.t[-1] > 1.001 * free.t[-1]
    assert slowed > 0


def test_a_planar_arm_in_a_vertical_plane():
    q0 = [0.4, 0.8, 0.6]
    path = fp.Line([-0.3, 0.2])
    effort = np.array([60.0, 25.0, 8.0])
    free = fp.fastest(PLANAR, path, MVN, q0, limits=PLANAR_LIMITS)
    assert torque_ratio(PLANAR, effort, free.q, free.qd, free.qdd) > 1.2
    run = fp.fastest(PLANAR, path, MVN, q0, limits=PLANAR_LIMITS, bounds=[fp.TorqueBounds(effort=effort)])
    assert 0.97 < torque_ratio(PLANAR, effort, run.q, run.qd, run.qdd) <= 1 + 1e-9
    assert run.t[-1] > free.t[-1]


def test_loose_bounds_have_no_effect():
    free = fp.fastest(PANDA, UP, MVN, READY, task="pose")
    loose = fp.fastest(PANDA, UP, MVN, READY, task="pose", bounds=[fp.TorqueBounds(effort=np.full(7, 1e4))])
    assert abs(loose.t[-1] - free.t[-1]) <= 1e-3 + 1e-9


def test_the_bottleneck_is_named():
    q0 = [0, 0.95, 0, -1.5, 0, 2.45, 0.785]
    run = fp.fastest(PANDA, fp.Line([0, 0, 0.4]), MVN, q0, task="pose", bounds=[fp.TorqueBounds()])
    assert "torque of panda_joint2" in run.bottleneck
    assert np.all(run.saturated[run.bottleneck == "torque of panda_joint2", 1])
    assert set(run.bottleneck) - {""} == {
        f"{kind} of {PANDA.joint_names[i]}"
        for kind, ratios in run.bound_ratios().items()
        for k, i in np.argwhere(ratios > 0.99)
        if ratios[k, i] == max(each[k].max() for each in run.bound_ratios().values())
    }


def test_both_payloads_keep_the_bounds():
    heavy, light = PANDA, fp.SerialArm.preset("panda").with_payload(0.5, com=(0, 0, 0.15))
    bounds = [fp.TorqueBounds(fraction=0.55, lighter=light)]
    run = fp.fastest(heavy, UP, MVN, READY, task="pose", bounds=bounds)
    for mass in (0.5, 1.7, 3.0):
        arm = fp.SerialArm.preset("panda").with_payload(mass, com=(0, 0, 0.15))
        assert torque_ratio(arm, bound_of(arm, 0.55), run.q, run.qd, run.qdd) <= 1 + 1e-9


def test_moving_ends_keep_torques():
    seam = fp.Line([0, 0.3, 0.1])
    bounds = [fp.TorqueBounds(fraction=0.55)]
    ends = {"start_speed": 0.2, "end_speed": 0.3}
    run = fp.fastest(PANDA, seam, MVN, READY, task="pose", bounds=bounds, **ends)
    assert torque_ratio(PANDA, bound_of(PANDA, 0.55), run.q, run.qd, run.qdd) <= 1 + 1e-9
    speeds = [np.linalg.norm((PANDA.jacobian(run.q[k]) @ run.qd[k])[:3]) for k in (0, -1)]
    np.testing.assert_allclose(speeds, [0.2, 0.3], atol=1e-6)
    assert run.t[-1] > fp.fastest(PANDA, seam, MVN, READY, task="pose", **ends).t[-1]


def test_two_arms_keep_torques():
    robot = fp.Robot.preset("two_pandas").with_payload(3.0, com=(0, 0, 0.15), frame="left_tip")
    stack = fp.Stack([fp.PoseTask(f"{side}_tip", name=side, k=5) for side in ("left", "right")])
    paths = {"left": fp.Circle(0.15).in_plane("yz"), "right": fp.Line((0.0, 0.05, 0.1))}
    bound, bounds = 0.55 * robot.limits.effort, [fp.TorqueBounds(fraction=0.55)]
    run = fp.fastest(robot, paths, MVN, [*READY, *READY], stack=stack, bounds=bounds)
    assert 0.97 < torque_ratio(robot, bound, run.q, run.qd, run.qdd) <= 1 + 1e-9


HELD = (
    r"path at the fraction 0\.\d+: joint 'panda_joint2': torque at rest = .* must be at most 39\.15.*hold its posture"
)


def test_a_posture_that_cannot_be_held_is_named():
    bounds = [fp.TorqueBounds(fraction=0.45)]
    circle = fp.Circle(0.15).in_plane("yz")
    start = fp.SerialArm.preset("panda").gravity(np.array(READY))
    assert np.all(np.abs(start) < bound_of(PANDA, 0.45))
    with pytest.raises(fp.ParameterError, match=HELD):
        fp.fastest(PANDA, circle, MVN, READY, task="pose", bounds=bounds)
    scheme = fp.FPBM(0.6, np.ones(7), 10, 25)
    with pytest.raises(fp.ParameterError, match=r"path at the fraction 0\.\d+: joint 1 needs the fraction"):
        fp.track(PANDA, circle, scheme, READY, task="pose", bounds=bounds, keep_path=True)


def test_a_posture_beyond_the_reserve_is_named():
    circle = fp.Circle(0.15).in_plane("yz")
    scheme = fp.FPBM(0.6, np.ones(7), 10, 25)
    bounds = [fp.TorqueBounds(fraction=0.475)]
    with pytest.raises(
        fp.ParameterError, match=r"joint 1 needs the fraction 0\.9\d+ .* at most 0\.95\d+, with the res"
    ):
        fp.track(PANDA, circle, scheme, READY, task="pose", bounds=bounds, keep_path=True)
    run = fp.track(PANDA, circle, scheme, READY, task="pose", bounds=bounds, keep_path=True, reserve=0.01)
    assert torque_ratio(PANDA, bound_of(PANDA, 0.475), run.q, run.qd) <= 1 + 1e-9


def ride(tracker, follower, act=lambda k: None):
    q, qd, error = [tracker.q], [tracker.qd], 0.0
    while not follower.done:
        act(len(q))
        tick = tracker.tick(follower)
        q.append(tick.q)
        qd.append(tick.qd)
        error = max(error, float(np.abs(tick.error).max()))
        assert len(q) < 60_000
    return np.array(q), np.array(qd), error


@pytest.mark.parametrize("name", ["panda", "ur10e", "iiwa14"])
def test_a_tracker_keeps_paths_and_torques(name):
    arm, fraction = ROBOTS[name]
    bound = bound_of(arm, fraction)
    finite = np.all(np.isfinite(arm.limits.jerk))
    limits = replace(arm.limits, jerk=np.minimum(arm.limits.jerk, 1e4) if finite else np.full(arm.dof, 500.0))

    def plan(path, q0):
        tracker = fp.Tracker(
            arm,
            fp.FPBM(0.6, np.linspace(2, 1, arm.dof), k1=20, k2=100),
            q0,
            task="pose" if arm.dof > 6 else "position",
            limits=limits,
            bounds=[fp.TorqueBounds(fraction=fraction)],
            singular_radius=0.0,
            keep_first_level=True,
        )
        return tracker, tracker.follow(path, keep_path=True)

    for tracker, follower in random_paths(arm, 2, 4, plan):
        q, qd, error = ride(tracker, follower)
        assert error < 1e-5
        assert torque_ratio(arm, bound, q, qd) <= 1 + 1e-9
