"""Secondary objectives against the textbook formulas with explicit pseudoinverses, and in whole motions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fpbm_cpp as fp

PANDA = fp.SerialArm.preset("panda")
READY = np.array([0.1, -0.5, 0.2, -2.0, 0.1, 1.8, 0.7])
PLANAR = fp.PlanarArm([1.0, 0.8, 0.6, 0.4])
PLANAR_ELBOW = fp.PlanarArm([1.0, 0.8])

GAINS = st.floats(0.0, 5.0)
FEW = settings(max_examples=60)
SCHEMES = {
    "MVN": lambda n, **options: fp.MVN(**options),
    "WMVN": lambda n, **options: fp.WMVN(np.arange(1.0, n + 1), **options),
    "MAN": lambda n, **options: fp.MAN(**options),
    "WMVNAcceleration": lambda n, **options: fp.WMVNAcceleration(np.arange(1.0, n + 1), **options),
    "Balanced": lambda n, **options: fp.Balanced(0.3, np.arange(1.0, n + 1), **options),
    "FPBM": lambda n, **options: fp.FPBM(0.6, np.arange(1.0, n + 1), 2.0, 3.0, **options),
}


class Case:
    """An arm in a random state, and a reference of its tip."""

    def __init__(self, name, arm, task, seed):
        rng = np.random.default_rng(seed)
        self.make = lambda **options: SCHEMES[name](arm.dof, **options)
        self.arm, self.task, self.velocity = arm, task, "acceleration" not in self.make().level
        self.q, self.qd = rng.uniform(-1.2, 1.2, (2, arm.dof))
        self.known = arm.kinematics(self.q, self.qd, task=task)
        self.J = self.known.J
        self.xd, self.xdd = rng.uniform(-0.5, 0.5, (2, len(self.J)))
        self.N = np.eye(arm.dof) - np.linalg.pinv(self.J) @ self.J
        self.W = np.eye(arm.dof) if name in ("MVN", "MAN") else np.diag(np.arange(1.0, arm.dof + 1))

    def resolve(self, **options):
        arguments = (self.q, self.qd, self.known.tip, self.xd, self.xdd)
        return self.make(**options).resolve(self.arm, *arguments, task=self.task)


@st.composite
def cases(draw, spatial=None):
    name, seed = draw(st.sampled_from(sorted(SCHEMES))), draw(st.integers(0, 2**32 - 1))
    arms = [(PANDA, "position"), (PANDA, "pose")] if spatial else [(PLANAR, "position"), (PLANAR, "pose")]
    arm, task = draw(st.sampled_from(arms if spatial is not None else [*arms, (PANDA, "position"), (PANDA, "pose")]))
    return Case(name, arm, task, seed)


def weighted_projector(J, W):
    WinvJt = np.linalg.inv(W) @ J.T
    return np.eye(len(W)) - WinvJt @ np.linalg.inv(J @ WinvJt) @ J


def close(actual, expected):
    np.testing.assert_allclose(actual, expected, atol=1e-8 * (1 + np.abs(expected).max()))


@FEW
@given(cases(spatial=True), st.floats(0.1, 10.0))
def test_joint_centring(case, gain):
    lower, upper = PANDA.limits.lower, PANDA.limits.upper
    z = -gain * (case.q - (lower + upper) / 2) / (upper - lower) ** 2
    close(case.resolve(joint_centring=gain), case.resolve() + weighted_projector(case.J, case.W) @ z)


def test_joint_centring_has_no_effect_without_bounds():
    case = Case("FPBM", PLANAR, "position", 3)
    np.testing.assert_array_equal(case.resolve(joint_centring=2.0), case.resolve())


@FEW
@given(cases(), st.floats(0.1, 10.0))
def test_manipulability_ascent(case, gain):
    def w(q):
        J = case.arm.jacobian(q, task=case.task)
        return np.sqrt(np.linalg.det(J @ J.T))

    steps = 1e-5 * np.eye(case.arm.dof)
    slope = np.array([w(case.q + step) - w(case.q - step) for step in steps]) / 2e-5
    added = case.resolve(manipulability_gain=gain) - case.resolve()
    np.testing.assert_allclose(added, gain * case.N @ slope, atol=1e-6 * gain)
    np.testing.assert_allclose(case.J @ added, 0, atol=1e-10 * gain)


CIRCLE = fp.Circle(0.05, 10.0)
BENT = np.array([0.2, 2.0, -1.8, 1.8])  # Both tasks are far from singular.


def largest_displacement(run, of):
    return np.linalg.norm([of(q) for q in run.q] - of(run.q[0]), axis=1).max()


@pytest.mark.parametrize("scheme", ["MVN", "Balanced"])
def test_an_elbow_stays_while_the_tip_moves_along_a_circle(scheme):
    options = {} if scheme == "MVN" else {"null_damping": 5.0}
    stack = fp.Stack(fp.PositionTask(name="tip"), fp.PositionTask("joint_3", name="elbow"))
    free = fp.simulate(PLANAR, CIRCLE, SCHEMES[scheme](4, **options), BENT, dt=1e-2)
    held = fp.simulate(PLANAR, CIRCLE, SCHEMES[scheme](4, **options), BENT, dt=1e-2, stack=stack, task="tip")
    assert largest_displacement(free, lambda q: PLANAR_ELBOW.forward(q[:2])) > 1e-2
    assert largest_displacement(held, lambda q: PLANAR_ELBOW.forward(q[:2])) < 1e-7
    assert held.max_error() < 1e-7


def test_an_axis_stays_while_the_tip_moves_along_a_circle():
    circle = fp.Circle(0.05, 5.0)
    scheme = fp.Balanced(0.6, np.ones(7), null_damping=5.0)
    free = fp.simulate(PANDA, circle, scheme, READY, dt=1e-2)
    held = fp.simulate(PANDA, circle, scheme, READY, dt=1e-2, stack=fp.Stack(fp.PositionTask(), fp.AxisTask()))
    assert largest_displacement(free, lambda q: PANDA.forward(q)[:3, 2]) > 1e-2
    assert largest_displacement(held, lambda q: PANDA.forward(q)[:3, 2]) < 1e-7
    assert held.max_error() < 1e-7


def test_manipulability_rises_in_a_motion():
    options = {"null_damping": 3.0}
    circle = fp.Circle(0.05, 5.0)
    free = fp.simulate(PANDA, circle, fp.FPBM(0.6, np.ones(7), 10, 25, **options), READY, dt=1e-2, hold=5.0)
    options["manipulability_gain"] = 2.0
    climbed = fp.simulate(PANDA, circle, fp.FPBM(0.6, np.ones(7), 10, 25, **options), READY, dt=1e-2, hold=5.0)
    assert climbed.manipulability()[-1] > 1.005 * free.manipulability()[-1]
    assert climbed.max_error() < 1e-7


def test_joint_centring_in_a_motion():
    lower, upper = PANDA.limits.lower, PANDA.limits.upper

    def cost(run):
        return np.sum(((run.q[-1] - (lower + upper) / 2) / (upper - lower)) ** 2)

    circle = fp.Circle(0.05, 5.0)
    free = fp.simulate(PANDA, circle, fp.MVN(k=5.0), READY, dt=1e-2)
    centred = fp.simulate(PANDA, circle, fp.MVN(k=5.0, joint_centring=10.0), READY, dt=1e-2)
    assert cost(centred) < 0.9 * cost(free)
    assert centred.max_error() < 1e-5


@pytest.mark.parametrize("name", sorted(SCHEMES))
def test_singular_postures_are_damped_on_request(name):
    straight, zero = np.zeros(4), np.zeros(4)
    arguments = (straight, zero, PLANAR.forward(straight), [0.1, 0.0], [0.1, 0.0])
    with pytest.raises(fp.ResolutionError):
        SCHEMES[name](4).resolve(PLANAR, *arguments)
    damped = SCHEMES[name](4, singular_radius=0.02).resolve(PLANAR, *arguments)
    assert np.linalg.norm(damped) < 10


def test_a_damped_motion_is_complete():
    """To a nearly straight arm and back: there the radius has an effect."""
    path = fp.Line([0.055, 0.0], 2.0)
    q0 = np.array([-0.3, 0.6, -0.6, 0.6])
    run = fp.simulate(PLANAR, path, fp.FPBM(0.6, np.ones(4), 10, 25, singular_radius=0.05, null_damping=2.0), q0)
    assert run.status.code is fp.Status.DAMPED
    assert run.status
    assert not fp.failed(run.status.code)
    assert "complete" in str(run.status)
    assert "damped" in str(run.status)


def test_failed_statuses_are_listed():
    assert [status.name for status in fp.Status if fp.failed(status)] == ["SINGULAR", "TASK_LOST", "NOT_FINITE"]


def test_repr():
    assert repr(fp.MVN(k=5e-324)) == "MVN(k=5e-324)"
    scheme = fp.MVN(joint_centring=1, manipulability_gain=2, singular_radius=0.02)
    assert repr(scheme) == "MVN(joint_centring=1, manipulability_gain=2, singular_radius=0.02)"


@pytest.mark.parametrize("options", [{"joint_centring": 1.0}, {"manipulability_gain": 1.0}], ids=str)
def test_arm_objectives_reject_kinematics(options):
    known = PANDA.kinematics(READY, 0 * READY)
    with pytest.raises(ValueError, match="need an arm"):
        fp.MVN(**options).resolve(known, READY, 0 * READY, known.tip, np.zeros(3))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fp.MVN(joint_centring=-1), "joint_centring = -1: must be finite and not negative"),
        (lambda: fp.MAN(joint_centring=np.nan), "joint_centring = nan: must be finite and not negative"),
        (lambda: fp.MVN(manipulability_gain=-1), "manipulability_gain = -1: must be finite and not negative"),
        (lambda: fp.MVN(manipulability_gain=np.inf), "manipulability_gain = inf: must be finite and not negative"),
        (lambda: fp.MVN(singular_radius=1.5), r"singular_radius = 1.5: must be in \[0, 1\]"),
        (lambda: fp.MVN(singular_radius=0.1, singular_brake=-1), "singular_brake = -1: must be finite"),
    ],
)
def test_bad_objectives(make, words):
    with pytest.raises(ValueError, match=words):
        make()
