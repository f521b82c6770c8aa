"""Published problems of inverse kinematics: `python bench/inverse_problems.py [--count 2000]` prints two tables.

All targets are poses of random postures within the ranges, so that all targets are reachable.

- Pink, issue 59: arms with six joints, from random starts. Pink found 54 % of 200 targets of a Meca500, and about half
  of the targets of other arms, which are not named: here, random arms, one for each target.
- ssik, issue 359: an OpenArm, with ranges of ±45° of the last two joints. Before the fix, ssik found 72 % of 200
  targets. Here, the search starts at the middle of the ranges.
- All branches of a UR5e, compared with the closed-form solutions of EAIK and ssik, which are installed into
  build/inverse_peers. A branch is a solution that forward kinematics confirms, distinct modulo whole turns.

The exit status is 1 if a share is below 99.5 %.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Iterable
from typing import Any

import numpy as np
from inverse_peers import PACKAGES, ROUND_OFF, TOLERANCE, WORK, errors, problem, reason
from inverse_worker import STARTS, Array, Problem
from stack_peers import HERE, Environment, call, table

import fpbm_cpp as fp

REQUIRED = 99.5  # Least share of targets and branches [%].
SAME = 1e-3  # Largest difference of the angles of equal branches [rad].

# Origin [m] and axis of each joint in the frame of the joint before, and range [rad].
# meca_500_r3.urdf.xacro of Mecademic's ROS package (MIT).
MECA500 = (
    ((0.012498, 0, 0.091), (0, 0, 1), -3.05433, 3.05433),
    ((0, 0, 0.044), (0, 1, 0), -1.22173048, 1.5708),
    ((0, 0, 0.135), (0, 1, 0), -2.35619, 1.22173048),
    ((0, 0, 0.038), (1, 0, 0), -2.96706, 2.96706),
    ((0.12, 0, 0), (0, 1, 0), -2.00713, 2.00713),
    ((0.07, 0, 0), (1, 0, 0), -3.14159, 3.14159),
)
# OpenArm v2.0, left arm: openarm_description (Apache-2.0), as in ssik's prebuilt.openarm.left_ik (BSD-3-Clause).
OPENARM = (
    ((0, 0.0625, 0), (0, 1, 0), -3.4907, 1.3963),
    ((0, 0.06, 0), (-1, 0, 0), -3.3161, 0.17453),
    ((0, 0, -0.06625), (0, 0, -1), -1.5708, 1.5708),
    ((0, 0, -0.15375), (0, -1, 0), 0.0, 2.4435),
    ((0, 0, -0.0955), (0, 0, -1), -1.5708, 1.5708),
    ((0, 0, -0.1205), (0, -1, 0), -0.7854, 0.7854),
    ((0, 0, 0), (1, 0, 0), -0.7854, 0.7854),
)


def arm_of(rows: Iterable[tuple[Any, Any, float, float]]) -> fp.SerialArm:
    def joint(origin: Any, axis: Any, lower: float, upper: float) -> fp.Joint:
        placement = np.eye(4)
        placement[:3, 3] = origin
        return fp.Joint(placement=placement, axis=axis, lower=lower, upper=upper)

    return fp.SerialArm.from_joints([joint(*row) for row in rows])


def random_arm(random: np.random.Generator) -> fp.SerialArm:
    """An arm with six joints of any directions, at distances of up to 0.5 m along and between the axes."""
    parameters = random.uniform([0, -np.pi, 0, 0], [0.5, np.pi, 0.5, 0], (6, 4))
    return fp.SerialArm.from_dh(parameters, "classic", lower=-np.pi, upper=np.pi)


def solved(name: str, count: int, arm: fp.SerialArm | None, random_start: bool) -> list[Any]:
    """A row of the first table."""
    random, found, most = np.random.default_rng(0), 0, 0
    for _ in range(count):
        each = arm or random_arm(random)
        lower, upper = each.limits.lower, each.limits.upper
        target = each.forward(random.uniform(lower, upper))
        answer = each.inverse(target, random.uniform(lower, upper) if random_start else None, starts=STARTS)
        found += len(branches_of(each, target, [answer.q]))
        most = max(most, int(answer.starts))
    return [name, count, found, 100 * found / count, most]


def is_in(q: Array, branches: Iterable[Array]) -> bool:
    difference = np.reshape([*branches], (-1, len(q))) - q
    return bool((np.abs(difference - 2 * np.pi * np.round(difference / (2 * np.pi))) < SAME).all(axis=1).any())


def branches_of(arm: fp.SerialArm, target: Array, answers: Iterable[Array]) -> list[Array]:
    """The distinct answers that reach the target within the ranges."""
    branches: list[Array] = []
    for q in answers:
        inside = np.all((q >= arm.limits.lower - ROUND_OFF) & (q <= arm.limits.upper + ROUND_OFF))
        if inside and errors(arm.forward(q)[None], target[None])[0] <= TOLERANCE and not is_in(q, branches):
            branches.append(q)
    return branches


def closed_forms(given: Problem, environment: str, solver: str) -> list[Array]:
    """All answers of a library for each target."""
    python, out = Environment(WORK / environment, PACKAGES[environment]).python, given.path.with_name("all_answers.npz")
    command = python, HERE / "inverse_worker.py", solver, given.path, out, str(len(given.targets)), "1"
    call(*command, stderr=subprocess.PIPE)
    file = np.load(out)
    return np.split(file["all"], np.cumsum(file["found"])[:-1])


def branch_rows(count: int) -> list[list[Any]]:
    """The second table."""
    (WORK / "problems").mkdir(parents=True, exist_ok=True)
    given, arm, rows = problem(WORK / "problems", "ur5e", count, 0), fp.SerialArm.preset("ur5e"), []

    def checked(answers: Iterable[Iterable[Array]]) -> list[list[Array]]:
        return [branches_of(arm, target, each) for target, each in zip(given.targets, answers)]

    ours = checked([posture.q for posture in arm.inverse_all(target, starts=STARTS)] for target in given.targets)
    for name, solver in (("eaik", "Eaik"), ("ssik", "SsikAll")):
        try:
            theirs = checked(closed_forms(given, name, solver))
        except subprocess.SubprocessError as error:
            print(f"Missing: {name}: {reason(error)}")
            continue
        found = sum(is_in(q, mine) for mine, each in zip(ours, theirs) for q in each)
        total = sum(map(len, theirs))
        rows.append([f"UR5e, {name}", total, found, 100 * found / total, sum(map(len, ours)) - found])
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=2000, help="targets of each row")
    count = parser.parse_args().count
    targets = [
        solved("Pink, issue 59: Meca500", count, arm_of(MECA500), random_start=True),
        solved("Pink, issue 59: random arms", count, None, random_start=True),
        solved("ssik, issue 359: OpenArm", count, arm_of(OPENARM), random_start=False),
    ]
    branches = branch_rows(count)
    for heads, rows in (
        (["", "targets", "found", "found [%]", "most starts"], targets),
        ([f"{count} targets", "branches", "found", "found [%]", "only by the search"], branches),
    ):
        texts = [[f"{each:.2f}" if isinstance(each, float) else str(each) for each in row] for row in rows]
        print("\n".join(table(heads, texts)[:-1]))
    sys.exit(any(row[3] < REQUIRED for row in [*targets, *branches]))


if __name__ == "__main__":
    main()
