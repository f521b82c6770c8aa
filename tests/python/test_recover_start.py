"""Starts outside the joints' ranges: recover_start leads the joints back within all bounds, and the error names it."""

from typing import Any

import numpy as np
import pytest

import fpbm_cpp as fp

PANDA = [0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785]


def laws(dof: int) -> dict[str, fp.Scheme]:
    one = np.ones(dof)
    return {"velocity": fp.MVN(), "acceleration": fp.Balanced(0.0, one, null_damping=2)}


def limits_of(arm: Any, jerk: float) -> fp.JointLimits:
    known = arm.limits
    acceleration = np.where(np.isfinite(known.acceleration), known.acceleration, 10.0)
    bounds = {"lower": known.lower, "upper": known.upper, "velocity": known.velocity, "acceleration": acceleration}
    return fp.JointLimits(**bounds, jerk=np.full(arm.dof, jerk))


def check(tracker: Any, tick: Any, limits: fp.JointLimits, dt: float, seconds: float) -> np.ndarray:
    """Moves the joints back, and returns their last positions. The bounds hold in all ticks."""
    q, qd, qdd = tracker.q, tracker.qd, np.zeros(len(tracker.q))
    back = np.zeros(len(q), dtype=bool)
    for _ in range(round(seconds / dt)):
        now = tick()
        u = (now.qd - qd) / dt
        assert (np.abs(now.qd) <= limits.velocity * (1 + 1e-9)).all()
        assert (np.abs(u) <= limits.acceleration * (1 + 1e-9)).all()
        assert (np.abs(u - qdd) <= dt * limits.jerk * (1 + 1e-6)).all()
        q, qd, qdd = now.q, now.qd, u
        beyond = np.maximum(q - limits.upper, limits.lower - q)
        inward = np.where(q > limits.upper, -qd, qd)
        assert (inward[beyond > 1e-9] >= -1e-9).all()
        back |= beyond <= 1e-9
        assert (beyond[back] <= 1e-9).all()
    assert back.all()
    return q


@pytest.mark.parametrize("level", ["velocity", "acceleration"])
@pytest.mark.parametrize("jerk", [np.inf, 400.0])
@pytest.mark.parametrize("dt", [1e-3, 4e-3, 20e-3])
@pytest.mark.parametrize("preset", ["panda", "ur5e", "gen3", "two_pandas"])
def test_joints_return_under_a_stack(preset: str, dt: float, jerk: float, level: str) -> None:
    robot: Any = fp.Robot.preset(preset) if preset == "two_pandas" else fp.SerialArm.preset(preset)
    limits, rng = limits_of(robot, jerk), np.random.default_rng(1)
    low, high = np.maximum(limits.lower, -2.0), np.minimum(limits.upper, 2.0)
    q0 = low + (high - low) * rng.uniform(0.3, 0.7, robot.dof)
    bounded = np.flatnonzero(np.isfinite(limits.lower))
    for i in rng.choice(bounded, min(3, len(bounded)), replace=False):
        q0[i] = limits.upper[i] + 0.2 if rng.random() < 0.5 else limits.lower[i] - 0.2
    frames = ["left_tip", "right_tip"] if preset == "two_pandas" else ["tip"]
    frames = [name for name in frames if preset != "two_pandas" or name in robot.frames] or [robot.frames[0]]
    stack = fp.Stack(*(fp.PositionTask(name, name=name) for name in frames), fp.PostureTask(name="home"))
    tracker = fp.Tracker(
        robot, laws(robot.dof)[level], q0, stack=stack, dt=dt, limits=limits, recover_start=True, stall_time=0.3
    )
    goals = {name: tracker.tip[name] + np.array([0.05, 0.05, -0.05]) for name in frames}
    check(tracker, lambda: tracker.tick(goals), limits, dt, 4.0)


@pytest.mark.parametrize("level", ["velocity", "acceleration"])
def test_joints_return_although_the_target_is_unreachable(level: str) -> None:
    """The arm stalls, but not before its joints are within their ranges."""
    panda = fp.SerialArm.preset("panda")
    slow = fp.JointLimits(
        lower=panda.limits.lower, upper=panda.limits.upper, velocity=[0.05] * 7, acceleration=[1.0] * 7
    )
    q0 = np.array(PANDA)
    q0[3] = panda.limits.lower[3] - 0.3
    tracker = fp.Tracker(panda, laws(7)[level], q0, limits=slow, recover_start=True, stall_time=0.2)
    far = tracker.tip + np.array([3.0, 0, 0])
    check(tracker, lambda: tracker.tick(far), slow, 1e-3, 8.0)


@pytest.mark.parametrize("level", ["velocity", "acceleration"])
@pytest.mark.parametrize("jerk", [np.inf, 400.0])
def test_joints_return_with_a_clearance(level: str, jerk: float) -> None:
    panda = fp.SerialArm.preset("panda")
    limits, q0 = limits_of(panda, jerk), np.array(PANDA)
    q0[0], q0[5] = limits.upper[0] + 0.15, limits.upper[5] + 0.05
    table = fp.HalfSpace([0, 0, 1], -0.05, name="table")
    clearance = fp.Clearance.preset("panda", obstacles=[table], margin=0.01)
    tracker = fp.Tracker(panda, laws(7)[level], q0, limits=limits, bounds=[clearance], recover_start=True)
    goal, nearest = tracker.tip + np.array([0, 0.2, -0.4]), []

    def tick() -> Any:
        now = tracker.tick(goal)
        nearest.append(now.nearest.distance)
        return now

    check(tracker, tick, limits, 1e-3, 4.0)
    assert min(nearest) >= 0.01 - 1e-9
    with pytest.raises(
        fp.ParameterError, match=r"qd0\[0\] = 0.1: must be 0 before a start outside the limits with bounds"
    ):
        fp.Tracker(panda, laws(7)[level], q0, qd0=[0.1] * 7, limits=limits, bounds=[clearance], recover_start=True)


def test_track_and_the_run() -> None:
    panda, law = fp.SerialArm.preset("panda"), fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=2)
    q0 = np.array(PANDA)
    q0[3] = panda.limits.lower[3] - 0.1
    path = fp.Line([0, 0, 0.05], 2.0)
    with pytest.raises(fp.ParameterError, match=r"q0\[3\] = -3.1718: must be within the joint's range.*recover_start"):
        fp.track(panda, path, law, q0)
    run = fp.track(panda, path, law, q0, recover_start=True)
    assert run.options["recover_start"] is True
    assert np.linalg.norm(run.error[-1]) < 1e-3
    assert run.q[-1, 3] >= panda.limits.lower[3] - 1e-9


def test_degrees_are_named() -> None:
    panda = fp.SerialArm.preset("panda")
    with pytest.raises(fp.ParameterError, match=r"q0\[1\] = -20: .*looks like degrees.*recover_start"):
        fp.Tracker(panda, fp.MVN(), [0, -20, 0, -120, 0, 100, 45])
    with pytest.raises(fp.ParameterError, match=r"q0\[1\] = 2: ") as caught:
        fp.Tracker(panda, fp.MVN(), [0, 2, 0, -2, 0, 2, 0])
    assert "degrees" not in str(caught.value)
