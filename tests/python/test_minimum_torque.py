"""MinimumTorque and MinimumEnergy: laws, with M and h of the arm, and the functions that move an arm."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import fpbm_cpp as fp

RODS = fp.PlanarArm([1, 1, 1, 1], masses=[1, 1, 1, 1]).with_gravity((0, -9.81, 0))
PANDA = fp.SerialArm.preset("panda")
READY = np.array([0, -0.3, 0, -2.2, 0, 2, 0.785])
CASES = [(RODS, "position"), (PANDA, "position"), (PANDA, "pose")]
on_arms = pytest.mark.parametrize(("arm", "task"), CASES, ids=["rods", "position", "pose"])


class State:
    """A random state with a reference near the tip, and the command b of a scheme with k1 = 10, k2 = 25."""

    def __init__(self, arm: Any, task: str, seed: int) -> None:
        random = np.random.default_rng(seed)
        self.arm, self.task, n = arm, task, arm.dof
        self.q, self.qd = random.uniform(-1, 1, n), random.uniform(-1, 1, n)
        self.J, self.Jd = arm.jacobian(self.q, task=task), arm.jacobian_dot(self.q, self.qd, task=task)
        self.x = arm.forward(self.q) if task == "pose" or arm is RODS else arm.forward(self.q)[:3, 3]
        self.xd, self.xdd = random.uniform(-0.5, 0.5, (2, len(self.J)))
        self.b = self.xdd - self.Jd @ self.qd + 10 * (self.xd - self.J @ self.qd)
        self.M, self.h = arm.mass_matrix(self.q), arm.bias(self.q, self.qd)
        self.away = random.uniform(-0.1, 0.1, (20, n)) @ (np.eye(n) - np.linalg.pinv(self.J) @ self.J)

    def resolve(self, scheme: fp.Scheme) -> np.ndarray:
        return scheme.resolve(self.arm, self.q, self.qd, self.x, self.xd, self.xdd, task=self.task)

    def least(self, A: np.ndarray, g: np.ndarray, b: np.ndarray) -> np.ndarray:
        """The u with J u = b that minimises ½ u'A u + g'u."""
        m = len(self.J)
        system = np.block([[A, self.J.T], [self.J, np.zeros((m, m))]])
        return np.linalg.solve(system, np.concatenate([-g, b]))[: len(g)]


@on_arms
@pytest.mark.parametrize("seed", range(5))
def test_least_torque(arm: Any, task: str, seed: int) -> None:
    state = State(arm, task, seed)
    qdd = state.resolve(fp.MinimumTorque())
    np.testing.assert_allclose(state.J @ qdd, state.b, atol=1e-9)
    expected = state.least(state.M @ state.M, state.M @ state.h, state.b)
    np.testing.assert_allclose(qdd, expected, rtol=1e-5, atol=1e-5 * np.abs(expected).max())
    torque = arm.inverse_dynamics(state.q, state.qd, qdd)
    for each in state.away:
        assert np.linalg.norm(arm.inverse_dynamics(state.q, state.qd, qdd + each)) >= np.linalg.norm(torque)


@on_arms
@pytest.mark.parametrize("seed", range(5))
def test_least_energy(arm: Any, task: str, seed: int) -> None:
    state = State(arm, task, seed)
    qd = state.resolve(fp.MinimumEnergy(k=5))
    np.testing.assert_allclose(state.J @ qd, state.xd, atol=1e-12)
    np.testing.assert_allclose(qd, state.least(state.M, np.zeros(arm.dof), state.xd), atol=1e-9)
    for each in state.away:
        assert arm.kinetic_energy(state.q, qd + each) >= arm.kinetic_energy(state.q, qd)


@on_arms
def test_the_balance(arm: Any, task: str) -> None:
    state, w = State(arm, task, 7), np.linspace(1, 2, arm.dof)
    torque = state.resolve(fp.MinimumTorque(null_damping=2))
    velocity = state.resolve(fp.FPBM(1, w, null_damping=2))
    for alpha in (0, 0.3, 1):
        balance = state.resolve(fp.MinimumTorque(alpha=alpha, weights=w, null_damping=2))
        np.testing.assert_allclose(balance, (1 - alpha) * torque + alpha * velocity, rtol=1e-10, atol=1e-10)
    equal = state.resolve(fp.MinimumTorque(alpha=0.3, null_damping=2))
    ones = fp.MinimumTorque(alpha=0.3, weights=np.ones(arm.dof), null_damping=2)
    np.testing.assert_allclose(equal, state.resolve(ones), rtol=1e-10, atol=1e-10)


SCHEMES = [fp.MinimumTorque(alpha=0.5, null_damping=5, k1=20, k2=100), fp.MinimumEnergy(k=10)]
every_scheme = pytest.mark.parametrize("scheme", SCHEMES, ids=lambda each: each.kind)
CIRCLE = fp.Circle(0.05, 4, time_law="quintic").in_plane("yz")


@every_scheme
def test_motions(scheme: fp.Scheme) -> None:
    run = fp.simulate(PANDA, CIRCLE, scheme, READY, task="pose", dt=2e-3)
    assert run.max_error() < 1e-5
    assert fp.track(PANDA, CIRCLE, scheme, READY, task="pose").max_error() < 1e-5
    swept = fp.sweep(PANDA, CIRCLE, [scheme, fp.MAN()], [READY], task="pose", dt=2e-3, hold=0.0)
    assert swept.max_error[0, 0] == run.max_error()
    if scheme.level == "velocity":
        assert fp.track(PANDA, CIRCLE, scheme, READY, task="pose", keep_path=True).max_error() < 1e-5
        assert fp.fastest(PANDA, CIRCLE, scheme, READY, task="pose").max_error() < 1e-5
    tracker = fp.Tracker(PANDA, scheme, READY, task="pose")
    follower = tracker.follow(CIRCLE)
    while not follower.done:
        assert np.abs(tracker.tick(follower).error).max() < 1e-5


@every_scheme
def test_the_first_level_of_a_stack(scheme: fp.Scheme) -> None:
    gains = {"k1": 0, "k2": 0} if scheme.level == "acceleration" else {"k": 0}
    law = replace(scheme, **gains)
    stack = fp.Stack(fp.PositionTask(name="tip"), fp.AxisTask(axis="z", name="down"))
    robot = fp.Tracker(PANDA, law, READY, stack=stack)
    follower = robot.follow({"tip": CIRCLE})
    while not follower.done:
        tick = robot.tick({"tip": follower})
        assert np.abs(tick.errors["tip"]).max() < 1e-5
    equal = fp.Balanced(1, np.ones(7)) if law.level == "acceleration" else fp.MVN()
    plain = fp.Tracker(PANDA, equal, READY, stack=stack)
    other = plain.follow({"tip": CIRCLE})
    while not other.done:
        plain.tick({"tip": other})
    assert np.abs(robot.q - plain.q).max() > 1e-3
    with pytest.raises(fp.ParameterError, match="give gains to the tasks of the stack"):
        fp.Tracker(PANDA, replace(scheme, **{name: 1 for name in gains}), READY, stack=stack)


def test_gravity_and_payload_of_the_arm_count() -> None:
    floating = PANDA.with_gravity((0, 0, 0))
    loaded = PANDA.with_payload(3.0, com=(0, 0, 0.1))
    states = [State(arm, "pose", 3) for arm in (PANDA, floating, loaded)]
    results = [state.resolve(fp.MinimumTorque()) for state in states]
    assert np.abs(results[0] - results[1]).max() > 1
    assert np.abs(results[0] - results[2]).max() > 0.1


@every_scheme
def test_an_arm_is_needed(scheme: fp.Scheme) -> None:
    state = State(PANDA, "pose", 1)
    kinematics = fp.Kinematics(state.x, state.J, state.Jd)
    with pytest.raises(fp.ParameterError, match="give an arm, not a Kinematics"):
        scheme.resolve(kinematics, state.q, state.qd, state.x, state.xd, state.xdd)


@every_scheme
def test_an_arm_without_masses_is_refused(scheme: fp.Scheme) -> None:
    arm, q0 = fp.PlanarArm([1, 1, 1, 1]), [0.3] * 4
    half = fp.PlanarArm([1, 1, 1, 1], masses=[1, 1, 1, 0])
    for refused, name in ((arm, "joint_1"), (half, "joint_4")):
        for call in (
            lambda: scheme.resolve(refused, q0, q0, [3, 1], [0, 0], [0, 0]),  # noqa: B023
            lambda: fp.simulate(refused, fp.Circle(0.1, 1), scheme, q0),  # noqa: B023
            lambda: fp.Tracker(refused, scheme, q0),  # noqa: B023
            lambda: fp.sweep(refused, fp.Circle(0.1, 1), [scheme], [q0]),  # noqa: B023
        ):
            with pytest.raises(fp.ParameterError, match=f"joint '{name}' moves no mass"):
                call()


def test_parameters() -> None:
    for scheme in SCHEMES:
        assert eval(repr(scheme), {**vars(fp), "np": np}) == scheme
        assert pickle.loads(pickle.dumps(scheme)) == scheme
    for wrong in ({"alpha": 2}, {"k1": -1}, {"weights": [1, -1]}, {"null_damping": -1}):
        with pytest.raises(fp.ParameterError, match=next(iter(wrong))):
            fp.MinimumTorque(**wrong)
    with pytest.raises(fp.ParameterError, match="weights has 4 entries"):
        State(PANDA, "pose", 1).resolve(fp.MinimumTorque(alpha=0.5, weights=[1, 2, 3, 4]))
