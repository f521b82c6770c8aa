"""Every scheme against the textbook formulas with explicit pseudoinverses."""

import numpy as np
import pytest
import textbook
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import fpbm_cpp as fp

PLANAR_SIZES = [2, 3, 4, 7, 9, 10, fp.MAX_DOF]
UR = [
    [0, np.pi / 2, 0.089, 0],
    [-0.425, 0, 0, 0],
    [-0.392, 0, 0, 0],
    [0, np.pi / 2, 0.109, 0],
    [0, -np.pi / 2, 0.095, 0],
]
ON_RAIL = [fp.Joint("prismatic", axis=[1, 0, 0]), *fp.SerialArm.preset("iiwa14").joints]
COUPLED = list(fp.SerialArm.preset("iiwa14").joints)
COUPLED[5] = fp.Joint("revolute", COUPLED[5].placement, COUPLED[5].axis, mimic=(1, -0.7, 0.3))
IN_SPACE = [
    fp.SerialArm.preset("panda"),
    fp.SerialArm.preset("iiwa14"),
    fp.SerialArm.preset("gen3"),
    fp.SerialArm.from_dh([*UR, [0, 0, 0.082, 0]], "classic"),
    fp.SerialArm.from_joints(ON_RAIL),
    fp.SerialArm.from_joints([*ON_RAIL, *ON_RAIL]),
    fp.SerialArm.from_joints(COUPLED),
]


def random_chain(rng: np.random.Generator) -> fp.SerialArm:
    def frame() -> np.ndarray:
        H = np.eye(4)
        H[:3, :3], H[:3, 3] = fp.rotation(rng.uniform(-1.8, 1.8, 3)), rng.uniform(-0.5, 0.5, 3)
        return H

    types = rng.choice(["revolute", "continuous", "prismatic"], rng.integers(3, 12), p=[0.5, 0.2, 0.3])
    return fp.SerialArm([fp.Joint(kind, frame(), rng.uniform(-1, 1, 3)) for kind in types], frame())


class Case:
    """A random arm, task, state, reference and set of parameters."""

    def __init__(self, arm: fp.Arm, task: str, seed: int, dense: bool) -> None:
        rng = np.random.default_rng(seed)
        self.arm, self.task, n = arm, task, arm.dof
        self.q, self.qd, self.q_rest, self.c = rng.uniform(-1.5, 1.5, (4, n))
        known = arm.kinematics(self.q, self.qd, task=task)
        self.J, self.Jd = known.J, known.Jd
        self.error, self.xd, self.xdd = rng.uniform(-1, 1, (3, len(self.J)))
        if known.tip.ndim == 2:
            self.x = np.eye(4)
            self.x[:3, 3] = known.tip[:3, 3] + self.error[:3]
            self.x[:3, :3] = Rotation.from_rotvec(self.error[3:]).as_matrix() @ known.tip[:3, :3]
        else:
            self.x = known.tip + self.error
        self.alpha, self.k1, self.k2, self.kn, self.kp = rng.uniform(0.05, 0.95, 5)
        if dense:
            root = rng.uniform(-1, 1, (n, n))
            self.weights = self.W = root @ root.T + n * np.eye(n)
        else:
            self.weights = rng.uniform(0.2, 5, n)
            self.W = np.diag(self.weights)

    def resolve(self, scheme: fp.Scheme) -> np.ndarray:
        state = (self.q, self.qd, self.x, self.xd, self.xdd)
        resolved = scheme.resolve(self.arm, *state, task=self.task)
        known = self.arm.kinematics(self.q, self.qd, task=self.task)
        np.testing.assert_array_equal(scheme.resolve(known, *state), resolved)
        return resolved


@st.composite
def cases(draw):
    seed, dense, task = (
        draw(st.integers(0, 2**32 - 1)),
        draw(st.booleans()),
        draw(st.sampled_from(["position", "pose"])),
    )
    kind, rng = draw(st.sampled_from(["named", "chain", "planar"])), np.random.default_rng(seed)
    if kind == "named":
        arm = draw(st.sampled_from(IN_SPACE))
    elif kind == "chain":
        arm = random_chain(rng)
    else:
        arm = fp.PlanarArm(rng.uniform(0.3, 1.5, draw(st.sampled_from(PLANAR_SIZES))))
    assume(arm.dof >= len(arm.jacobian(np.zeros(arm.dof), task=task)))
    case = Case(arm, task, seed, dense)
    assume(np.linalg.cond(case.J) < 100)
    return case


def close(actual, expected):
    np.testing.assert_allclose(actual, expected, atol=1e-9 * (1 + np.abs(expected).max()))


MANY = settings(max_examples=300, suppress_health_check=[HealthCheck.filter_too_much])


@MANY
@given(cases())
def test_velocity_level(case):
    eye = np.eye(len(case.q))
    z = case.c + case.kp * (case.q_rest - case.q)
    options = {"rest_posture": case.q_rest, "null_stiffness": case.kp, "c": case.c}
    close(case.resolve(fp.MVN()), np.linalg.pinv(case.J) @ case.xd)
    close(case.resolve(fp.MVN(c=case.c)), textbook.velocity(case.J, eye, case.xd, case.c))
    close(case.resolve(fp.WMVN(case.weights)), textbook.velocity(case.J, case.W, case.xd, 0 * z))
    v = case.xd + case.k1 * case.error
    close(case.resolve(fp.WMVN(case.weights, k=case.k1, **options)), textbook.velocity(case.J, case.W, v, z))


@MANY
@given(cases())
def test_acceleration_level(case):
    eye = np.eye(len(case.q))
    free = case.xdd - case.Jd @ case.qd
    fed = free + case.k1 * (case.xd - case.J @ case.qd) + case.k2 * case.error
    options = {"null_damping": case.kn, "rest_posture": case.q_rest, "null_stiffness": case.kp, "c": case.c}
    z = case.c - case.kn * case.qd + case.kp * (case.q_rest - case.q)
    zero = 0 * z

    def law(alpha, W, b, z):
        return textbook.acceleration(alpha, case.J, case.Jd, W, b, case.xd, z)

    close(case.resolve(fp.MAN()), np.linalg.pinv(case.J) @ free)
    close(case.resolve(fp.MAN(**options)), law(0.0, eye, free, z))
    close(case.resolve(fp.WMVNAcceleration(case.weights)), law(1.0, case.W, free, zero))
    close(case.resolve(fp.WMVNAcceleration(case.weights, **options)), law(1.0, case.W, free, z))
    for alpha in (0.0, case.alpha, 1.0):
        close(case.resolve(fp.Balanced(alpha, case.weights)), law(alpha, case.W, free, zero))
        close(case.resolve(fp.Balanced(alpha, case.weights, **options)), law(alpha, case.W, free, z))
        close(case.resolve(fp.FPBM(alpha, case.weights, case.k1, case.k2)), law(alpha, case.W, fed, zero))
        close(case.resolve(fp.FPBM(alpha, case.weights, case.k1, case.k2, **options)), law(alpha, case.W, fed, z))


@given(cases(), st.sampled_from([1e-200, 1e-6, 3.7, 1e8, 1e200]))
def test_only_the_ratios_of_the_weights_matter(case, factor):
    close(
        case.resolve(fp.FPBM(case.alpha, case.weights * factor, case.k1, case.k2)),
        case.resolve(fp.FPBM(case.alpha, case.weights, case.k1, case.k2)),
    )


def test_velocity_level_needs_no_xdd(arm, q0):
    qd = fp.MVN().resolve(arm, q0, np.zeros(4), [3, 2], [0.1, 0])
    np.testing.assert_allclose(arm.jacobian(q0) @ qd, [0.1, 0], atol=1e-15)


def test_repr_and_level():
    assert repr(fp.MVN()) == "MVN()"
    assert repr(fp.WMVN([1, 2], k=3)) == "WMVN(weights=[1, 2], k=3)"
    assert repr(fp.MAN(null_damping=2)) == "MAN(null_damping=2)"
    assert repr(fp.FPBM(0.6, [1, 2], 1, 1)) == "FPBM(alpha=0.6, weights=[1, 2], k1=1, k2=1)"
    assert fp.WMVN([1, 2]).level == "velocity"
    assert fp.WMVNAcceleration([[2, 1], [1, 2]]).level == "acceleration"


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fp.WMVN([1, 0]), r"weights\[1\] = 0: must be positive"),
        (lambda: fp.WMVN([1, np.nan]), r"weights\[1\] = nan: must be positive"),
        (lambda: fp.WMVN([]), "weights has 0 entries"),
        (lambda: fp.WMVN(np.ones(65)), "weights has 65 entries"),
        (lambda: fp.WMVN("heavy"), "weights = 'heavy': must be real numbers"),
        (lambda: fp.WMVN(np.ones((2, 2, 2))), r"weights = .*: must be real numbers of shape \(n,\) or \(n, n\)"),
        (lambda: fp.WMVN(np.ones((2, 3))), r"weights = .*: must be real numbers of shape \(n,\) or \(n, n\)"),
        (lambda: fp.WMVN([[1, 2], [0, 1]]), r"weights\[1, 0\] = 0: must be equal to the transposed entry"),
        (lambda: fp.WMVN([[1, 2], [2, 1]]), r"weights\[1, 1\] = 1: must be larger: W is not positive definite"),
        (lambda: fp.WMVN([[1, np.inf], [np.inf, 1]]), r"weights\[0, 1\] = inf: must be finite"),
        (lambda: fp.WMVN([1, 1], k=-1), "k = -1: must be finite and not negative"),
        (lambda: fp.FPBM(1.5, [1, 1], 1, 1), r"alpha = 1.5: must be in \[0, 1\]"),
        (lambda: fp.FPBM(-0.1, [1, 1], 1, 1), r"alpha = -0.1: must be in \[0, 1\]"),
        (lambda: fp.Balanced(np.nan, [1, 1]), r"alpha = nan: must be in \[0, 1\]"),
        (lambda: fp.FPBM(0.5, [1, 1], -1, 1), "k1 = -1: must be finite and not negative"),
        (lambda: fp.FPBM(0.5, [1, 1], 1, np.inf), "k2 = inf: must be finite and not negative"),
        (lambda: fp.MAN(null_damping=-2), "null_damping = -2: must be finite and not negative"),
        (lambda: fp.MAN(rest_posture=[0, 0]), "null_stiffness = 0: must be positive"),
        (lambda: fp.MAN(null_stiffness=1), "null_stiffness = 1: must be 0 without rest_posture"),
        (lambda: fp.MAN(c=[0, np.nan]), r"c\[1\] = nan: must be finite"),
        (lambda: fp.FPBM(0.5, [1, 1], 1, 1, c=[0, 0, 0]), "c has 3 entries: must have 2"),
    ],
)
def test_bad_parameters(make, words):
    with pytest.raises(ValueError, match=words):
        make()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"q": [0, 0, 0]}, "q has 3 entries: must have 4"),
        ({"qd": [0, 0, 0, np.inf]}, r"qd\[3\] = inf"),
        ({"x": [0, 0, 0]}, "x has 3 entries: must have 2"),
        ({"xd": [0, np.nan]}, r"xd\[1\] = nan"),
        ({"xdd": None}, "xdd: must be given for an acceleration-level scheme"),
        ({"task": "pose"}, "x has 2 entries: must have 3"),
        ({"task": "speed"}, "task = 'speed': must be 'position' or 'pose'"),
    ],
)
def test_bad_arguments_of_resolve(arm, q0, change, words):
    arguments = {"q": q0, "qd": np.zeros(4), "x": [3, 2], "xd": [0, 0], "xdd": [0, 0]} | change
    with pytest.raises(ValueError, match=words):
        fp.FPBM(0.6, [1, 2, 3, 4], 1, 1).resolve(arm, **arguments)


def test_a_scheme_for_another_arm_is_rejected(q0):
    with pytest.raises(ValueError, match="weights has 4 entries: must have 3"):
        fp.WMVN([1, 2, 3, 4]).resolve(fp.PlanarArm([1, 1, 1]), q0[:3], q0[:3], [1, 1], [0, 0])


@pytest.mark.parametrize("scheme", [fp.MVN(), fp.MAN(), fp.FPBM(0.6, [1, 2, 3, 4], 1, 1)], ids=repr)
def test_a_singular_posture_is_rejected_with_advice(arm, scheme):
    with pytest.raises(fp.ResolutionError, match=r"posture is singular.*Choose another start") as caught:
        scheme.resolve(arm, np.zeros(4), np.zeros(4), [4, 0], [0.1, 0], [0, 0])
    assert caught.value.status is fp.Status.SINGULAR


SCHEMES = [fp.MVN(k=2.0), fp.MAN(), fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=2, singular_radius=0.02)]


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.kind)
@pytest.mark.parametrize("task", ["position", "pose"])
def test_many_states_are_resolved_like_each_alone(scheme, task):
    arm, rng, k = IN_SPACE[0], np.random.default_rng(6), 50
    q, qd = rng.uniform(-1.5, 1.5, (2, k, 7))
    x = np.array([arm.kinematics(each, each, task=task).tip for each in rng.uniform(-1.5, 1.5, (k, 7))])
    xd, xdd = rng.uniform(-1, 1, (2, k, 3 if task == "position" else 6))
    each = np.array([scheme.resolve(arm, q[i], qd[i], x[i], xd[i], xdd[i], task=task) for i in range(k)])
    many = scheme.resolve(arm, q, qd, x, xd, xdd, task=task)
    assert many.tobytes() == each.tobytes()
    assert scheme.resolve(arm, q.tolist(), qd.tolist(), x.tolist(), xd, xdd, task=task).tobytes() == each.tobytes()
    # An argument without a row per state is for all states.
    held = np.array([scheme.resolve(arm, each, qd[0], x[0], xd[0], xdd[0], task=task) for each in q])
    assert scheme.resolve(arm, q, qd[0], x[0], xd[0], xdd[0], task=task).tobytes() == held.tobytes()
    assert scheme.resolve(arm, q[:0], qd[:0], x[0], xd[0], xdd[0], task=task).shape == (0, 7)


@pytest.mark.parametrize("states", [(), (5,)])
def test_a_result_is_written_to_out(states):
    arm, scheme = IN_SPACE[0], SCHEMES[2]
    rng = np.random.default_rng(7)
    q, qd = rng.uniform(-1.5, 1.5, (2, *states, 7))
    arguments = (arm, q, qd, [0.4, 0.1, 0.3], np.zeros(3), np.zeros(3))
    out = np.empty((*states, 7))
    assert scheme.resolve(*arguments, out=out) is out
    assert out.tobytes() == scheme.resolve(*arguments).tobytes()


def test_a_result_of_custom_kinematics_is_written_to_out(arm, q0):
    kinematics, out = arm.kinematics(q0, q0), np.empty(4)
    known = fp.Kinematics(kinematics.tip, kinematics.J, kinematics.Jd)
    assert fp.MAN().resolve(known, q0, q0, [1, 1], [0, 0], [0, 0], out=out) is out
    assert out.tobytes() == fp.MAN().resolve(arm, q0, q0, [1, 1], [0, 0], [0, 0]).tobytes()


@pytest.mark.parametrize(
    "out",
    [
        np.empty(3),
        np.empty((1, 4)),
        np.empty(4, dtype=np.float32),
        np.empty(8)[::2],
        [0.0] * 4,
        np.broadcast_to(0.0, 4),
    ],
)
def test_invalid_out_is_rejected(arm, q0, out):
    with pytest.raises(ValueError, match=r"out: must be a writeable, C-contiguous array of float64 of shape \(4,\)"):
        fp.MVN().resolve(arm, q0, q0, [1, 1], [0, 0], out=out)


def test_a_scheme_resolves_arms_of_several_sizes():
    one = fp.MVN(k=1)
    for joints in (4, 3, 4, 7, 3):
        arm, q = fp.PlanarArm(np.ones(joints)), np.linspace(0.2, 0.5, joints)
        for task, x in (("position", [1, 1]), ("pose", [1, 1, 0.2])):
            rates = np.zeros(len(x))
            same = fp.MVN(k=1).resolve(arm, q, q, x, rates, rates, task=task)
            assert one.resolve(arm, q, q, x, rates, rates, task=task).tobytes() == same.tobytes()


def test_many_states_of_an_arm_in_the_plane(arm, q0):
    q = q0 + np.linspace(0, 0.1, 5)[:, None]
    many = fp.MVN().resolve(arm, q, 0 * q, [1.0, 1.0], [0.1, 0.2])
    assert many.tobytes() == np.array([fp.MVN().resolve(arm, each, 0 * q0, [1, 1], [0.1, 0.2]) for each in q]).tobytes()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"qd": np.zeros((4, 7))}, r"qd: must have shape \(5, 7\), got \(4, 7\)"),
        ({"qd": np.zeros(6)}, r"qd: must have shape \(7,\), got \(6,\)"),
        ({"q": np.zeros((5, 6))}, r"q: must have shape \(5, 7\), got \(5, 6\)"),
        ({"q": np.full((5, 7), np.nan)}, r"q\[0\] = nan: must be finite"),
        ({"x": np.zeros((5, 4, 4))}, r"x\[0\]: must be a homogeneous matrix"),
        ({"x": np.array([np.eye(4)] * 4 + [2 * np.eye(4) - np.diag([0, 0, 0, 1])])}, r"x\[4\].R: must be a rotation"),
        ({"x": np.zeros((5, 3))}, r"x: must have shape \(4, 4\), got \(5, 3\)"),
        ({"xd": np.zeros((5, 3))}, r"xd: must have shape \(5, 6\), got \(5, 3\)"),
        ({"xdd": None}, "xdd: must be given for an acceleration-level scheme"),
    ],
)
def test_bad_arguments_of_many_states(change, words):
    good = {"q": np.full((5, 7), 0.3), "qd": np.zeros((5, 7)), "x": np.eye(4), "xd": np.zeros(6), "xdd": np.zeros(6)}
    with pytest.raises(fp.ParameterError, match=words):
        fp.MAN().resolve(IN_SPACE[0], **{**good, **change}, task="pose")


def test_the_singular_state_of_many_is_named(arm, q0):
    q = np.array([q0, q0, 0 * q0, q0])
    with pytest.raises(fp.ResolutionError, match=r"state 2: .*posture is singular") as caught:
        fp.MVN().resolve(arm, q, 0 * q, [1, 1], [0, 0])
    assert caught.value.status is fp.Status.SINGULAR


def test_custom_kinematics_are_resolved(q0):
    """The shape of the tip determines the type of the task. If the shape is ambiguous, the argument `task` does."""
    J = np.random.default_rng(1).uniform(-1, 1, (3, 4))
    qd = np.ones(4)
    position = fp.Kinematics([0.0, 0.0, 3.0], J, 0 * J)
    pose = fp.Kinematics([0.0, 0.0, 3.0], J, 0 * J, task="pose")
    scheme = fp.FPBM(0.5, np.ones(4), 1.0, 1.0)
    state = (q0, qd, [0.0, 0.0, -3.0], np.zeros(3), np.zeros(3))
    straight = J @ scheme.resolve(position, *state)
    shorter_rotation = J @ scheme.resolve(pose, *state)
    np.testing.assert_allclose(straight - shorter_rotation, [0, 0, -2 * np.pi], atol=1e-12)

    without_rate = fp.Kinematics([0.0, 0.0, 3.0], J)
    np.testing.assert_allclose(J @ fp.MVN().resolve(without_rate, q0, qd, [0, 0, 0], [1, 2, 3]), [1, 2, 3], atol=1e-12)
    with pytest.raises(ValueError, match="Jd: must be given for an acceleration-level scheme"):
        scheme.resolve(without_rate, *state)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fp.Kinematics([0, 0], np.ones((3, 4))), r"J: must have shape \(2, 4\), got \(3, 4\)"),
        (lambda: fp.Kinematics([0, 0], np.ones((2, 4)), np.ones((2, 3))), r"Jd: must have shape \(2, 4\)"),
        (lambda: fp.Kinematics([0, 0, 0, 0], np.ones((3, 4))), "tip has 4 entries: must have 3"),
        (lambda: fp.Kinematics(2 * np.eye(4), np.ones((6, 7))), r"tip: must be a homogeneous matrix"),
        (lambda: fp.Kinematics(np.diag([1, 1, 2, 1]), np.ones((6, 7))), r"tip.R: must be a rotation matrix"),
        (lambda: fp.Kinematics([0, np.nan], np.ones((2, 4))), r"tip\[1\] = nan: must be finite"),
        (lambda: fp.Kinematics([0, 0], [[1, 2], [3, np.inf]]), r"J\[1, 1\] = inf: must be finite"),
        (lambda: fp.Kinematics([0, 0], np.ones((2, 65))), "a row of J has 65 entries"),
        (lambda: fp.Kinematics("here", np.ones((2, 4))), "tip: must be real numbers"),
    ],
)
def test_bad_kinematics(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_a_task_of_more_rows_than_joints():
    arm = fp.PlanarArm([1, 1])
    with pytest.raises(ValueError, match="task: has 3 rows, and the arm has 2 joints"):
        fp.MVN().resolve(arm, [0.1, 0.2], [0, 0], [0, 0, 0], [0, 0, 0], task="pose")
    with pytest.raises(ValueError, match="task: has 3 rows, and the arm has 2 joints"):
        fp.simulate(arm, fp.Circle(0.1, 1.0), fp.MVN(), [0.1, 0.2], task="pose")
