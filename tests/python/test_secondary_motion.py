"""Secondary motion never moves a task: stacks with a rest posture, and motion away from shapes.

FPBM_MOTIONS=100 pytest tests/python/test_secondary_motion.py -s prints the figures of 100 motions of each kind.
"""

import os

import numpy as np
import pytest

import fpbm_cpp as fp

MOTIONS = int(os.environ.get("FPBM_MOTIONS", "8"))
DT = 4e-3
AT_REST = 1e-11  # Largest joint velocity at rest [rad/s].
LARGEST = 1e-9  # Largest error at rest [m] and [rad].
CAPSULES = (
    fp.Capsule(2, [0, 0, -0.06], [0, -0.15, 0], 0.07, "upper arm"),
    fp.Capsule(4, [0, 0, -0.05], [-0.06, 0.1, 0], 0.06, "forearm"),
    fp.Capsule(6, [0, 0, -0.05], [0.08, 0, 0.02], 0.05, "wrist"),
)
GAINS = {"acceleration": {"k1": 10, "k2": 25}, "velocity": {"k": 5}}


def random_posture(arm, rng, straight=False):
    """A posture in the middle part of the ranges. If straight, joints are nearly straight, and the arm is singular."""
    lower, upper = np.maximum(arm.limits.lower, -3), np.minimum(arm.limits.upper, 3)
    q = (lower + upper) / 2 + 0.45 * (upper - lower) * rng.uniform(-1, 1, arm.dof)
    if straight:
        near = np.clip(rng.uniform(-0.02, 0.02, arm.dof), lower + 0.05, upper - 0.05)
        q = np.where(rng.uniform(size=arm.dof) < 0.4, near, q)
    return q


def error_at_rest(tracker, targets, seconds=40):
    """Largest error of all tasks, or None if the arm does not stop with its whole task executed."""
    still = 0
    for _ in range(int(seconds / DT)):
        tick = tracker.tick(targets)
        still = still + 1 if np.abs(tick.qd).max() < AT_REST else 0
        if still > 50:
            break
    if still <= 50 or tick.status not in (fp.Status.OK, fp.Status.DAMPED) or np.min(tick.scale) < 1:
        return None
    errors = tick.errors.values() if isinstance(targets, dict) else [tick.error]
    return max(float(np.abs(error).max()) for error in errors)


def check(name, errors):
    at_rest = [error for error in errors if error is not None]
    print(f"{name}: {len(errors)} motions, {len(at_rest)} at rest, largest error {max(at_rest, default=0):.1e}")
    assert at_rest
    assert max(at_rest) <= LARGEST


@pytest.mark.parametrize("level", ["acceleration", "velocity"])
@pytest.mark.parametrize("name", ["panda", "iiwa14"])
@pytest.mark.parametrize("kind", ["positions", "axis"])
def test_a_rest_posture_moves_no_task_of_a_stack(kind, name, level):
    arm = fp.SerialArm.preset(name)
    errors = []
    for seed in range(MOTIONS):
        rng = np.random.default_rng(seed)
        gains = GAINS[level]
        elbow = fp.PositionTask(arm.joints[3].name, rows=("z",), name="second", **gains)
        if kind == "axis":
            stack = fp.Stack(fp.AxisTask(name="first", **gains), fp.PositionTask(name="second", **gains))
        else:
            stack = fp.Stack(fp.PositionTask(name="first", **gains), elbow)
        rest = {"rest_posture": random_posture(arm, rng), "null_stiffness": rng.uniform(0.3, 2)}
        weights = rng.uniform(0.5, 5, arm.dof) if seed % 2 else np.ones(arm.dof)
        scheme = fp.WMVN(weights, **rest) if level == "velocity" else fp.Balanced(0.6, weights, null_damping=2, **rest)
        goal = fp.Tracker(arm, scheme, random_posture(arm, rng, straight=True), stack=stack, dt=DT).tip
        tracker = fp.Tracker(arm, scheme, random_posture(arm, rng), stack=stack, dt=DT)
        errors.append(error_at_rest(tracker, goal))
    check(f"{kind}, {name}, {level}", errors)


@pytest.mark.parametrize("level", ["acceleration", "velocity"])
def test_motion_away_from_shapes_does_not_move_the_tip(level):
    arm = fp.SerialArm.preset("panda")
    errors = []
    seed = 0
    while len(errors) < MOTIONS:
        seed += 1
        rng = np.random.default_rng(seed)
        q0, rest = random_posture(arm, rng), random_posture(arm, rng)
        place = rng.uniform(-0.6, 0.6, 3)
        obstacle = fp.Capsule(0, place, place + 0.2 * rng.normal(size=3), 0.06, "obstacle")
        clearance = fp.Clearance(CAPSULES, [obstacle], away_gain=20, away_range=0.3)
        near = clearance.nearest(arm, q0)
        if near is None or not clearance.margin < near.distance < 0.3:
            continue
        if level == "velocity":
            scheme = fp.WMVN(np.ones(7), k=5, rest_posture=rest, null_stiffness=1)
        else:
            scheme = fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=2, rest_posture=rest, null_stiffness=1)
        tracker = fp.Tracker(arm, scheme, q0, task="pose", bounds=[clearance], dt=DT)
        errors.append(error_at_rest(tracker, tracker.tip))
    check(f"away from shapes, {level}", errors)
