"""The viable accelerations of a joint against TSID's bounds (Del Prete 2018), for random joints in random states."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from fpbm_cpp._types import Array

pin = pytest.importorskip("pinocchio")
tsid = pytest.importorskip("tsid.tsid_pywrap", exc_type=ImportError)

ROOT = Path(__file__).parents[2]
EIGEN = Path("/usr/include/eigen3")
JOINTS = 100
ROUNDS = 20  # 1000 for the figures in docs/limits.md.

PROGRAM = """
#include <cstdio>
#include "fpbm/limits/limits.hpp"

int main() {
  double lower, upper, velocity, acceleration, tick, q, qd;
  while (std::scanf("%lf %lf %lf %lf %lf %lf %lf", &lower, &upper, &velocity, &acceleration, &tick, &q, &qd) == 7) {
    auto bounds = fpbm::JointLimits<1>::none(1);
    bounds.set(0, {lower, upper, velocity, acceleration});
    const fpbm::Limits<fpbm::Level::kAcceleration, 1> limits(bounds, tick);
    const fpbm::State<1> state{fpbm::Vector<1>(q), fpbm::Vector<1>(qd)};
    const auto box = limits.box(state);
    bool viable = true;
    try {
      limits.require_viable(state);
    } catch (const std::invalid_argument&) {
      viable = false;
    }
    std::printf("%.17g %.17g %d\\n", box.lower(0), box.upper(0), viable);
  }
}
"""


def our_bounds(states: Array, folder: Path) -> Array:
    """Lower and upper acceleration, and whether the state is viable: a column each."""
    (folder / "main.cpp").write_text(PROGRAM)
    includes = ["-I", str(ROOT / "cpp/include"), "-isystem", str(EIGEN)]
    subprocess.run(["g++", "-std=c++17", "-O1", *includes, "main.cpp", "-o", "main"], cwd=folder, check=True)
    text = "\n".join(" ".join(map(repr, row)) for row in states.tolist())
    printed = subprocess.run([folder / "main"], input=text.encode(), capture_output=True, check=True).stdout
    return np.array(printed.split(), dtype=float).reshape(-1, 3)


def their_bounds(states: Array, tick: float) -> Array:
    """Lower and upper acceleration by TSID, a column each, for a robot with one joint for each state."""
    model = pin.Model()
    parent = 0
    for i in range(len(states)):
        parent = model.addJoint(parent, pin.JointModelPX(), pin.SE3.Identity(), f"joint {i}")
    robot = tsid.RobotWrapper(model, tsid.RootJointType.FIXED_BASE_SYSTEM, False)
    # The constructor doubles the tick, and setTimeStep() does not change all values that depend on the tick.
    task = tsid.TaskJointPosVelAccBounds("bounds", robot, tick / 2, False)
    lower, upper, velocity, acceleration, _, q, qd = np.ascontiguousarray(states.T)
    task.setPositionBounds(lower, upper)
    task.setVelocityBounds(velocity)
    task.setAccelerationBounds(acceleration)
    constraint = task.compute(0.0, q, qd, pin.Data(model))
    return np.stack((constraint.lowerBound, constraint.upperBound), axis=1)


def random_states(rng: np.random.Generator, tick: float) -> Array:
    """Joints and states: a row each, many of them at the limit of stopping in continuous time."""
    middle, half_range = rng.uniform(-3, 3, JOINTS), 10 ** rng.uniform(-1, 0.5, JOINTS)
    lower, upper = middle - half_range, middle + half_range
    velocity, acceleration = 10 ** rng.uniform(-1, 1, JOINTS), 10 ** rng.uniform(0, 2, JOINTS)
    q = lower + rng.uniform(0, 1, JOINTS) ** rng.choice([1, 4], JOINTS) * (upper - lower)
    fastest = np.minimum(velocity, np.sqrt(2 * acceleration * (upper - q)))
    slowest = -np.minimum(velocity, np.sqrt(2 * acceleration * (q - lower)))
    share = np.where(np.arange(JOINTS) % 2, rng.uniform(0, 1, JOINTS), rng.choice([0.0, 1.0], JOINTS))
    share = np.clip(share + rng.uniform(-1, 1, JOINTS) * rng.choice([0, 0.02], JOINTS), 0, 1)
    qd = slowest + share * (fastest - slowest)
    return np.stack((lower, upper, velocity, acceleration, np.full(JOINTS, tick), q, qd), axis=1)


@pytest.mark.skipif(not shutil.which("g++") or not EIGEN.exists(), reason="needs g++ and Eigen")
def test_bounds_are_within_those_of_tsid(tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    blocks = [random_states(rng, 10 ** rng.uniform(-4, -2)) for _ in range(ROUNDS)]
    theirs = np.concatenate([their_bounds(block, float(block[0, 4])) for block in blocks])
    states = np.concatenate(blocks)
    ours = our_bounds(states, tmp_path)
    acceleration, viable = states[:, 3], ours[:, 2] == 1
    theirs = np.clip(theirs, -acceleration[:, None], acceleration[:, None])
    beyond = np.maximum(ours[:, 1] - theirs[:, 1], theirs[:, 0] - ours[:, 0]) / acceleration
    width = (ours[:, 1] - ours[:, 0]) / (2 * acceleration)
    less = (theirs[:, 1] - theirs[:, 0]) / (2 * acceleration) - width
    some = viable & (less > 1e-6)
    print(
        f"{len(states)} states, {viable.sum()} viable here; wider than TSID there by {beyond[viable].max():.1e} A, "
        f"elsewhere in {(beyond[~viable] > 1e-6).sum()} states by at most {beyond[~viable].max():.2f} A; "
        f"narrower in {some.sum()}, by {np.median(less[some]):.2f} (median), {less[some].max():.2f} (most) of 2 A"
    )
    assert viable.sum() > len(states) / 2
    assert (ours[:, 0] <= ours[:, 1]).all()
    assert beyond[viable].max() <= 1e-6
