"""Tasks in strict priority within bounds, against linear programs (HiGHS)."""

import os

import numpy as np
import pytest
from scipy.optimize import linprog

import fpbm_cpp as fp

PROBLEMS = int(os.environ.get("FPBM_PROBLEMS", "150"))


def random_problem(rng):
    """2 to 64 joints, 1 to 6 levels of sizes from 1e-4 to 1e4, with rows that are zero, repeat or depend on others."""
    n = int(rng.integers(2, 65))
    lower, upper = -rng.uniform(0.1, 1.1, n), rng.uniform(0.1, 1.1, n)
    levels = []
    for _ in range(rng.integers(1, 7)):
        J = rng.normal(size=(int(rng.integers(1, min(n, 6) + 1)), n)) * 10 ** rng.uniform(-4, 4)
        kind = rng.integers(6)
        if kind == 0:
            J[0] = 0
        if kind == 1:
            J[0] = 2 * J[-1]
        if kind == 2 and levels:
            J[0] = levels[0][0][0]
        u = rng.uniform(lower, upper)
        u[rng.random(n) < 0.2] = 0.1
        levels.append((J, J @ u / (rng.uniform(0.1, 0.9) if rng.random() < 0.4 else 1)))
    return lower, upper, levels


def problem_of_sns_ik(rng):
    """3 to 9 joints and 3 to 6 tasks, as sns_ik's runTest_snsIk_acc_mt.m draws them (Rethink Robotics, 2018)."""
    n = int(rng.integers(3, 10))
    lower, upper = -rng.uniform(0.1, 1.1, n), rng.uniform(0.1, 1.1, n)
    levels = []
    for _ in range(rng.integers(3, 7)):
        J = rng.normal(size=(int(rng.integers(1, n + 1)), n))
        u = rng.uniform(lower, upper)
        on_bound = rng.random(n) < 0.2
        u[on_bound] = np.where(rng.random(n) < 0.5, lower, upper)[on_bound]
        drift = rng.normal(size=len(J))
        scale = rng.uniform(0.1, 0.9) if rng.random() < 0.4 else 1.0
        levels.append((J, (J @ u + drift) / scale - drift))
    return lower, upper, levels


def null_space(rows, n):
    """An orthonormal basis of the null space of rows, each at length 1 first."""
    lengths = np.linalg.norm(rows, axis=1)
    rows = rows[lengths > 0] / lengths[lengths > 0, None]
    if len(rows) == 0:
        return np.eye(n)
    _, sigma, V = np.linalg.svd(rows)
    return V[np.sum(sigma > 1e-9) :].T


@pytest.mark.parametrize("draw", [random_problem, problem_of_sns_ik])
def test_every_scale_is_the_largest(draw):
    rng = np.random.default_rng(1)
    levels = limited = missed = 0
    for _ in range(PROBLEMS):
        lower, upper, tasks = draw(rng)
        n = len(lower)
        unit = (upper - lower) / 2
        before = np.clip(np.zeros(n), lower, upper)
        above = np.zeros((0, n))
        whole = fp.saturate(tasks, lower, upper)
        for k, (J, b) in enumerate(tasks):
            found = fp.saturate(tasks[: k + 1], lower, upper)
            assert (found.u >= lower).all()
            assert (found.u <= upper).all()
            assert found.scale[k] == whole.scale[k]
            if J.any():  # Lower levels do not disturb this level.
                assert np.linalg.norm(J @ (whole.u - found.u)) <= 1e-10 * np.linalg.norm(J)
            Z = null_space(above * unit, n)
            A = J * unit @ Z
            step = np.zeros(n)
            if np.linalg.norm(A) > 1e-9 * np.linalg.norm(J * unit):
                # As a share of the largest singular value.
                least = 1e-9 * np.linalg.norm(J * unit) / np.linalg.norm(A, 2)
                step = unit * (Z @ np.linalg.lstsq(A, b - J @ before, rcond=least)[0])
            above = np.vstack([above, J])
            levels += 1
            if np.linalg.norm(step) > 1e-9:
                size = np.linalg.norm(above, axis=1)
                rows = above[size > 0] / size[size > 0, None]
                best = linprog(
                    np.r_[np.zeros(n), -1],
                    A_eq=np.c_[rows, -rows @ step],
                    b_eq=rows @ before,
                    bounds=[*zip(lower, upper), (0, 1)],
                    method="highs",
                )
                limited += found.scale[k] < 1
                missed += best.status == 0 and -best.fun - found.scale[k] > 1e-6
            before = found.u
    print(f"{levels} levels, {limited} limited, {missed} below the largest scale by more than 1e-6")
    assert limited > levels / 10
    assert missed <= 1e-3 * levels


def test_problems_of_sns_ik_are_solved():
    """A task that is feasible with a known scale, and a posture below it, as in sns_ik's basic_with_secondary_goal.

    In sns_ik, the scale s applies to the acceleration xdd only: J u + drift = s xdd. Here, s is an additional joint
    from 0 to 1, and the second level maximises s.
    """
    rng = np.random.default_rng(4)
    error = 0.0
    for _ in range(PROBLEMS):
        m = int(rng.integers(1, 7))
        n = int(rng.integers(m, m + 5))
        J = rng.uniform(-3, 3, (m, n))
        lower, upper = rng.uniform(-3, -1, n), rng.uniform(1, 3, n)
        drift = rng.uniform(-1, 1, m)
        scale = min(1.0, rng.uniform(0.2, 1.2))
        xdd = (J @ rng.uniform(lower, upper) + drift) / scale
        posture = rng.uniform(lower, upper)
        levels = [
            (np.c_[J, -xdd], -drift),
            (np.eye(1, n + 1, n), [1.0]),
            (np.eye(n, n + 1), posture),
        ]
        found = fp.saturate(levels, np.r_[lower, 0], np.r_[upper, 1])
        u, s = found.u[:n], found.u[n]
        assert (u >= lower).all()
        assert (u <= upper).all()
        assert found.scale[0] == 1
        assert s >= scale - 1e-10
        error = max(error, np.max(np.abs(J @ u + drift - s * xdd)))
    print(f"{PROBLEMS} problems, all with the known scale or a larger one; the task is off by {error:.1e} at most")
    assert error <= 1e-10


def test_one_level_within_the_bounds_equals_the_pseudoinverse():
    rng = np.random.default_rng(2)
    J, b = rng.normal(size=(3, 7)), rng.normal(size=3)
    found = fp.saturate([(J, b)], np.full(7, -np.inf), np.full(7, np.inf))
    np.testing.assert_allclose(found.u, np.linalg.pinv(J) @ b, atol=1e-14)
    assert found.scale.tolist() == [1.0]
    assert not found.saturated.any()


def test_joints_without_range_do_not_scale_the_task():
    rng = np.random.default_rng(3)
    for _ in range(50):
        lower, upper = -rng.uniform(0.5, 1, 6), rng.uniform(0.5, 1, 6)
        lower[0] = upper[0] - 1e-10
        lower[1] = upper[1] = 0
        lower[2], upper[3] = -np.inf, np.inf
        J = rng.normal(size=(2, 6))
        u = rng.uniform(-0.5, 0.5, 6)
        u[:2] = upper[:2]
        found = fp.saturate([(J, J @ u)], lower, upper)
        np.testing.assert_allclose(found.scale, 1)
        np.testing.assert_allclose(J @ found.u, J @ u, atol=1e-9)
        assert found.u[1] == 0


def test_three_tasks_have_the_scales_of_a_hand_calculation():
    """The first level is scaled by one half, the second uses the remaining range, the third contradicts the first."""
    found = fp.saturate(
        [([[1, 0, 0]], [2]), ([[0, 1, 1]], [1.5]), ([[1, 0, 0]], [0])], lower=[-1, -0.5, -1], upper=[1, 0.5, 1]
    )
    np.testing.assert_allclose(found.u, [1, 0.5, 1], atol=1e-15)
    np.testing.assert_allclose(found.scale, [0.5, 1, 1])
    assert found.saturated.all()


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"levels": []}, "levels: must have at least one level"),
        ({"levels": [([[1, 0]], [1, 2])]}, r"levels\[0\]'s b"),
        ({"levels": [([[1, 0, 0]], [1])]}, r"levels\[0\]'s J"),
        ({"levels": [([[1, np.nan]], [1])]}, "finite"),
        ({"levels": [(np.zeros((65, 2)), np.zeros(65))]}, "number of rows"),
        ({"lower": [0, 2]}, r"lower\[1\] = 2: must be at most upper = 1"),
        ({"upper": [1, np.nan]}, r"upper\[1\]"),
        ({"rest": [0, 3]}, r"rest\[1\] = 3: must be from lower to upper"),
        ({"unit": [1, 0]}, r"unit\[1\] = 0: must be positive"),
    ],
)
def test_invalid_arguments_are_named(changed, message):
    arguments = {"levels": [([[1, 0]], [1])], "lower": [-1, -1], "upper": [1, 1]} | changed
    with pytest.raises(fp.ParameterError, match=message):
        fp.saturate(**arguments)
