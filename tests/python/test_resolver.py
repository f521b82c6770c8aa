"""Every scheme against the textbook formulas with explicit pseudoinverses."""

import numpy as np
import pytest
import textbook
from hypothesis import assume, given
from hypothesis import strategies as st

import fpbm_cpp as fp

SIZES = [2, 3, 4, 7, 10, 11, fp.MAX_DOF]


class Case:
    """A random arm, state, reference and set of parameters, away from singular postures."""

    def __init__(self, n: int, seed: int, dense: bool) -> None:
        rng = np.random.default_rng(seed)
        self.lengths = rng.uniform(0.3, 1.5, n)
        self.q, self.qd, self.q_rest, self.c = rng.uniform(-1.5, 1.5, (4, n))
        self.x, self.xd, self.xdd = rng.uniform(-1, 1, (3, 2))
        self.alpha, self.k1, self.k2, self.kn, self.kp = rng.uniform(0.05, 0.95, 5)
        if dense:
            root = rng.uniform(-1, 1, (n, n))
            self.weights = self.W = root @ root.T + n * np.eye(n)
        else:
            self.weights = rng.uniform(0.2, 5, n)
            self.W = np.diag(self.weights)
        self.arm = fp.PlanarArm(self.lengths)
        self.J = textbook.jacobian(self.lengths, self.q)
        self.Jd = textbook.jacobian_dot(self.lengths, self.q, self.qd)
        self.error = self.x - textbook.forward(self.lengths, self.q)

    def resolve(self, scheme: fp.Scheme) -> np.ndarray:
        return scheme.resolve(self.arm, self.q, self.qd, self.x, self.xd, self.xdd)


@st.composite
def cases(draw):
    case = Case(draw(st.sampled_from(SIZES)), draw(st.integers(0, 2**32 - 1)), draw(st.booleans()))
    assume(np.linalg.cond(case.J) < 100)
    return case


def close(actual, expected):
    np.testing.assert_allclose(actual, expected, atol=1e-9 * (1 + np.abs(expected).max()))


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
        (lambda: fp.WMVN(np.ones(33)), "weights has 33 entries"),
        (lambda: fp.WMVN("heavy"), "weights: must be real numbers"),
        (lambda: fp.WMVN(np.ones((2, 2, 2))), "weights: must have 1 dimension, got shape"),
        (lambda: fp.WMVN(np.ones((2, 3))), r"weights: must be square, got shape \(2, 3\)"),
        (lambda: fp.WMVN([[1, 2], [0, 1]]), r"weights\[1, 0\] = 0: must be equal to its mirror image"),
        (lambda: fp.WMVN([[1, 2], [2, 1]]), r"weights\[1, 1\] = 1: must be larger: W is not positive definite"),
        (lambda: fp.WMVN([[1, np.inf], [np.inf, 1]]), r"weights\[1, 0\] = inf: must be finite"),
        (lambda: fp.WMVN([1, 1], k=-1), "k = -1: must be finite and not negative"),
        (lambda: fp.FPBM(1.5, [1, 1], 1, 1), r"alpha = 1.5: must be in \[0, 1\]"),
        (lambda: fp.FPBM(-0.1, [1, 1], 1, 1), r"alpha = -0.1: must be in \[0, 1\]"),
        (lambda: fp.Balanced(np.nan, [1, 1]), r"alpha = nan: must be in \[0, 1\]"),
        (lambda: fp.FPBM(0.5, [1, 1], -1, 1), "k1 = -1: must be finite and not negative"),
        (lambda: fp.FPBM(0.5, [1, 1], 1, np.inf), "k2 = inf: must be finite and not negative"),
        (lambda: fp.MAN(null_damping=-2), "null_damping = -2: must be finite and not negative"),
        (lambda: fp.MAN(rest_posture=[0, 0]), "null_stiffness = 0: must be positive"),
        (lambda: fp.MAN(null_stiffness=1), "null_stiffness = 1: must be 0 where no rest_posture is given"),
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
        ({"xdd": None}, "xdd: an acceleration-level scheme needs it"),
        ({"task": "pose"}, "task = 'pose'"),
    ],
)
def test_bad_arguments_of_resolve(arm, q0, change, words):
    arguments = {"q": q0, "qd": np.zeros(4), "x": [3, 2], "xd": [0, 0], "xdd": [0, 0]} | change
    with pytest.raises(ValueError, match=words):
        fp.FPBM(0.6, [1, 2, 3, 4], 1, 1).resolve(arm, **arguments)


def test_a_scheme_for_another_arm(q0):
    with pytest.raises(ValueError, match="weights has 4 entries: must have 3"):
        fp.WMVN([1, 2, 3, 4]).resolve(fp.PlanarArm([1, 1, 1]), q0[:3], q0[:3], [1, 1], [0, 0])


@pytest.mark.parametrize("scheme", [fp.MVN(), fp.MAN(), fp.FPBM(0.6, [1, 2, 3, 4], 1, 1)], ids=repr)
def test_a_singular_posture_is_refused_with_advice(arm, scheme):
    with pytest.raises(fp.ResolutionError, match=r"posture is singular.*Choose another start") as caught:
        scheme.resolve(arm, np.zeros(4), np.zeros(4), [4, 0], [0.1, 0], [0, 0])
    assert caught.value.status is fp.Status.SINGULAR
