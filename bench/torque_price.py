"""Time until targets are reached with bounds on torque, for bench/torque.py."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from importlib.util import find_spec
from typing import Any, NamedTuple

import numpy as np
from torque_robots import Array, Machine, machine
from torque_rollouts import held_posture

import fpbm_cpp as fp

DT = 1e-3
SECONDS = 10.0
NEAR, SLOW = 0.01, 0.05  # A target is reached within these errors [rad], [rad/s].
STIFFNESS, DAMPING = 36.0, 12.0  # Of the postures, also of TSID [1/s^2], [1/s].
SHARES = (0.6, 1.0)  # Parts of the efforts.
EXCEEDED, OUTSIDE = 0.01, 1e-4  # An excess over a bound, relative, and over a range [rad], that counts.
ROBOTS = ("panda", "ur10e", "z1")


def pairs(name: str, share: float, count: int, seed: int) -> Iterator[tuple[Machine, Array, Array]]:
    """Robots with random payloads, and two postures that the share of the efforts can hold."""
    rng = np.random.default_rng([seed, 7])
    found = 0
    while found < count:
        made = machine(name, rng.uniform(0.0, 3.0))
        start, target = (held_posture(made, 0.9 * share, rng, most=100) for _ in range(2))
        if start is not None and target is not None:
            found += 1
            yield made, start, target


def without_jerk(limits: fp.JointLimits) -> fp.JointLimits:
    return replace(limits, jerk=np.full(len(limits.lower), np.inf))


def reached(q: Array, qd: Array, target: Array) -> bool:
    return bool(np.max(np.abs(q - target)) < NEAR and np.max(np.abs(qd)) < SLOW)


def our_time(made: Machine, start: Array, target: Array, share: float | None) -> float:
    """Time until the target is reached [s], infinite if it is not; share: of the efforts, None for no bounds."""
    stack = fp.Stack(fp.PostureTask(start, name="posture", k1=DAMPING, k2=STIFFNESS))
    tracker = fp.Tracker(
        made.arm,
        fp.Balanced(0.0, np.ones(made.arm.dof)),
        start,
        stack=stack,
        dt=DT,
        limits=without_jerk(made.limits),
        stall_time=np.inf,
        bounds=[] if share is None else [fp.TorqueBounds(fraction=share)],
    )
    for k in range(int(SECONDS / DT)):
        tick = tracker.tick({"posture": target})
        if reached(tick.q, tick.qd, target):
            return (k + 1) * DT
    return np.inf


class TsidResult(NamedTuple):
    time: float  # Until the target is reached [s], infinite if it is not.
    infeasible: bool  # Whether a QP has no solution; the motion ends there.
    excess: float  # Largest excess over a bound, relative: of torques, velocities and accelerations.
    outside: float  # Largest excess over a bound on position [rad].


def tsid_motion(made: Machine, start: Array, target: Array, share: float) -> TsidResult:
    """The motion of TSID with bounds on torque, position, velocity and acceleration."""
    import tsid

    n, limits, effort = made.arm.dof, made.limits, share * made.arm.limits.effort
    robot = tsid.RobotWrapper(made.torques.model, tsid.RootJointType.FIXED_BASE_SYSTEM, False)
    problem = tsid.InverseDynamicsFormulationAccForce("tsid", robot, False)
    problem.computeProblemData(0.0, start, np.zeros(n))
    posture = tsid.TaskJointPosture("posture", robot)
    posture.setKp(np.full(n, STIFFNESS))
    posture.setKd(np.full(n, DAMPING))
    posture.setReference(tsid.TrajectoryEuclidianConstant("target", target).computeNext())
    torque = tsid.TaskActuationBounds("torque", robot)
    torque.setBounds(-effort, effort)
    joints = tsid.TaskJointPosVelAccBounds("joints", robot, DT, False)
    joints.setPositionBounds(limits.lower, limits.upper)
    joints.setVelocityBounds(limits.velocity)
    joints.setAccelerationBounds(limits.acceleration)
    problem.addMotionTask(posture, 1.0, 1, 0.0)
    problem.addActuationTask(torque, 1.0, 0, 0.0)
    problem.addMotionTask(joints, 1.0, 0, 0.0)
    solver = tsid.SolverHQuadProgFast("solver")
    solver.resize(problem.nVar, problem.nEq, problem.nIn)
    q, qd, excess, outside = start.copy(), np.zeros(n), 0.0, 0.0
    for k in range(int(SECONDS / DT)):
        solution = solver.solve(problem.computeProblemData(k * DT, q, qd))
        if solution.status != 0:
            return TsidResult(np.inf, True, excess, outside)
        qdd = problem.getAccelerations(solution)
        after = q + DT * (qd + DT / 2 * qdd), qd + DT * qdd
        ratios = [np.abs(made.torques(*state, qdd)) / effort for state in ((q, qd), after)]
        q, qd = after
        ratios += [np.abs(qd) / limits.velocity, np.abs(qdd) / limits.acceleration]
        excess = max(excess, float(np.max(ratios)) - 1.0)
        outside = max(outside, float(np.max([q - limits.upper, limits.lower - q])))
        if reached(q, qd, target):
            return TsidResult((k + 1) * DT, False, excess, outside)
    return TsidResult(np.inf, False, excess, outside)


def spread(ratios: Array) -> str:
    """Median and largest of the finite ratios."""
    found = ratios[np.isfinite(ratios)]
    return f"{np.median(found):.3f}, {found.max():.3f}" if len(found) else "-"


def own_row(name: str, share: float, count: int, seed: int) -> tuple[list[Any], list[Any]]:
    """Rows of both tables: bounds on torque relative to none, and relative to TSID."""
    ratios, to_tsid, missed, infeasible, beyond, compared = [], [], 0, 0, 0, 0
    for made, start, target in pairs(name, share, count, seed):
        bounded, free = (our_time(made, start, target, each) for each in (share, None))
        if np.isfinite(free):
            missed += not np.isfinite(bounded)
            ratios.append(bounded / free)
        if find_spec("tsid") is None or np.any(made.friction) or np.any(made.torques.damping):
            continue  # TSID does not know friction.
        compared += 1
        result = tsid_motion(made, start, target, share)
        exceeds = result.excess > EXCEEDED or result.outside > OUTSIDE
        infeasible += result.infeasible
        beyond += exceeds and not result.infeasible
        if np.isfinite(result.time) and not exceeds:
            to_tsid.append(bounded / result.time)
    missed_by_us = sum(not np.isfinite(each) for each in to_tsid)
    own = [name, f"{share:.0%}", len(ratios), spread(np.array(ratios)), missed]
    if not compared:
        return own, []
    share_of = (f"{each / compared:.0%}" for each in (infeasible, beyond))
    return own, [name, f"{share:.0%}", compared, *share_of, len(to_tsid), spread(np.array(to_tsid)), missed_by_us]


def price_tables(count: int, seed: int) -> Iterator[tuple[list[str], list[list[Any]]]]:
    rows = [own_row(name, share, count, seed) for share in SHARES for name in ROBOTS]
    head = ["robot", "efforts", "motions"]
    ours = "time with / without bounds on torque: median, largest"
    yield [*head, ours, "only without bounds reached"], [own for own, _ in rows]
    yield (
        [
            *head,
            "TSID infeasible",
            "TSID exceeds a bound",
            "compared",
            "time / TSID: median, largest",
            "only TSID reaches",
        ],
        [peer for _, peer in rows if peer],
    )
