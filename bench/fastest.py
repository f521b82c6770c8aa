"""Motions in the least time on random paths: `python bench/fastest.py [--count 30] [--level velocity]` prints tables.

For each preset arm, the paths are splines through 4 to 8 random points from random postures, under MVN with a constant
orientation (position tasks with 6 joints). Paths that leave the workspace or the range of a joint are drawn again.

1. Kept: largest ratios of velocities, accelerations and jerks, by differences at 1 kHz, to their bounds, largest
   distance from the path, and processor time of fp.fastest() per second of motion.
2. TOPP-RA (`pip install toppra`) on the same joint paths and bounds: without bounds on jerk, and the duration with
   bounds on jerk relative to the duration of TOPP-RA, which has no bounds on jerk.
3. Trackers with keep_path, under MVN or, at acceleration level, FPBM, on paths that last half of the least duration:
   alone, while an operator changes the speed, pauses, stops and resumes at random moments, and with a ball that is put
   into the path for 2 s. The largest errors, the ratios to the bounds, and the duration relative to the least duration.
4. Ruckig (`pip install ruckig`) on straight lines of a gantry, from rest to rest: the duration relative to Ruckig.
5. Weights: the duration under WMVN with the weights 1/A^2, A the bounds on acceleration, relative to MVN.
6. Torques: arms with payloads, and a fraction of their efforts. Largest ratio of a torque to its bound, by inverse
   dynamics at the samples and at both ends of each tick, the duration relative to the duration without bounds on
   torques and, without bounds on jerk, relative to TOPP-RA, and trackers as in 3, alone.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import defaultdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

import fpbm_cpp as fp

ARMS = ("panda", "fr3", "iiwa14", "gen3", "ur5e", "xarm7")
# Arms whose makers publish no bound [rad/s^3].
JERK = {"iiwa14": 500.0, "gen3": 200.0, "ur5e": 200.0, "ur10e": 200.0, "xarm7": 1000.0}
DT = 1e-3
LOADS = {"panda": (3.0, 0.7), "ur10e": (10.0, 0.8), "iiwa14": (12.0, 0.7)}  # Payload [kg], fraction of the efforts.

Array = NDArray[np.float64]


def limits_of(arm: fp.SerialArm, name: str, jerk: bool) -> fp.JointLimits:
    given = arm.limits
    most = np.full(arm.dof, JERK[name]) if name in JERK else given.jerk
    return fp.JointLimits(
        lower=given.lower,
        upper=given.upper,
        velocity=given.velocity,
        acceleration=given.acceleration,
        jerk=most if jerk else np.full(arm.dof, np.inf),
    )


def random_run(
    arm: fp.SerialArm, limits: fp.JointLimits, random: np.random.Generator, bounds: tuple[fp.TorqueBounds, ...] = ()
) -> tuple[fp.Run, float]:
    """A motion along a random path, and the processor time of fp.fastest() [s]."""
    low, high = np.maximum(limits.lower, -2.8), np.minimum(limits.upper, 2.8)
    while True:
        q0 = low + (high - low) * random.uniform(0.2, 0.8, arm.dof)
        steps = random.normal(0.0, 0.08, (random.integers(3, 8), 3))
        path = fp.Waypoints(np.vstack([np.zeros(3), np.cumsum(steps, axis=0)]), duration=1.0)
        begin = time.process_time()
        try:
            task = "pose" if arm.dof > 6 else "position"
            run = fp.fastest(arm, path, fp.MVN(), q0, dt=DT, task=task, limits=limits, bounds=bounds)
        except fp.ParameterError:
            continue
        return run, time.process_time() - begin


def ratios(run: fp.Run) -> list[float]:
    """Largest ratios of velocities, accelerations and jerks to their bounds, from rest to rest."""
    q = np.vstack([run.q[:1]] * 3 + [run.q] + [run.q[-1:]] * 3)
    bounds = (run.limits.velocity, run.limits.acceleration, run.limits.jerk)
    return [float(np.max(np.abs(np.diff(q, k, axis=0)) / DT**k / bound)) for k, bound in enumerate(bounds, 1)]


def toppra_duration(run: fp.Run) -> float:
    """Duration of TOPP-RA along the joint path of a run, within its bounds on velocity, acceleration and torque [s]."""
    import toppra
    from toppra.algorithm import TOPPRA
    from toppra.constraint import JointAccelerationConstraint, JointVelocityConstraint, SecondOrderConstraint

    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(run.q, axis=0), axis=1))])
    even = np.linspace(0.0, length[-1], 601)
    nodes = np.array([np.interp(even, length, q) for q in run.q.T]).T
    path = toppra.SplineInterpolator(even, nodes)
    velocity, acceleration = run.limits.velocity, run.limits.acceleration
    bounds = [
        JointVelocityConstraint(np.stack([-velocity, velocity], axis=1)),
        JointAccelerationConstraint(np.stack([-acceleration, acceleration], axis=1)),
    ]
    if run.options["bounds"]:
        most, none = run.largest_torques, np.zeros(run.arm.dof)
        dynamics, sides = run.arm.inverse_dynamics, np.stack([-most, most], axis=1)
        bounds.append(SecondOrderConstraint.joint_torque_constraint(dynamics, sides, none))
    solver = TOPPRA(bounds, path, gridpoints=even, solver_wrapper="seidel")
    solver.compute_parameterization(0.0, 0.0)
    sd = solver.problem_data.sd_vec
    return float(np.sum(2.0 * np.diff(even) / (sd[1:] + sd[:-1])))


def duration_with_weights(run: fp.Run, weights: Array) -> float:
    """Duration of the motion under WMVN [s]; NaN if WMVN does not follow the path within the ranges."""
    try:
        again = fp.fastest(
            run.arm, run.path, fp.WMVN(weights / weights.min()), run.q0, dt=DT, task=run.task, limits=run.limits
        )
    except fp.ParameterError:
        return float("nan")
    return float(again.t[-1])


FAR = (0.0, 0.0, 5.0)


def ball(centre: Any) -> fp.Capsule:
    return fp.Capsule(0, a=centre, b=centre, radius=0.05, name="ball")


class Ride:
    """A motion of a tracker along a kept path, which lasts half of the least duration, tick by tick."""

    def __init__(self, run: fp.Run, level: str, bounds: list[fp.Clearance | fp.TorqueBounds]) -> None:
        assert isinstance(run.path, fp.Waypoints)
        self.tracker = fp.Tracker(
            run.arm,
            fp.MVN(k=5.0) if level == "velocity" else fp.FPBM(0.6, np.ones(run.arm.dof), 20.0, 100.0),
            run.q0,
            task=run.task,
            limits=run.limits,
            singular_radius=0.0,
            keep_first_level=True,
            bounds=bounds,
        )
        path = fp.Waypoints(run.path.points, duration=float(run.t[-1]) / 2)
        self.follower = self.tracker.follow(path, keep_path=True)
        self.q = [self.tracker.q]
        self.error = 0.0
        self.waited = self.blocked = 0

    def tick(self) -> bool:
        tick = self.tracker.tick(self.follower)
        self.q.append(tick.q)
        self.error = max(self.error, float(np.abs(tick.error).max()))
        self.waited += bool(np.abs(tick.qd).max() < 1e-5)
        self.blocked += tick.status is fp.Status.BLOCKED
        return not self.follower.done

    def ratios(self, limits: fp.JointLimits) -> list[float]:
        q = np.vstack([self.q[:1]] * 3 + [np.array(self.q)])
        bounds = (limits.velocity, limits.acceleration, limits.jerk)
        return [float(np.max(np.abs(np.diff(q, k, axis=0)) / DT**k / bound)) for k, bound in enumerate(bounds, 1)]


def with_operator(ride: Ride, random: np.random.Generator) -> None:
    """Changes the speed, pauses, stops and resumes at random moments."""
    tracker, follower = ride.tracker, ride.follower
    actions = (follower.pause, follower.resume, tracker.stop, tracker.resume)
    change = int(random.integers(50, 400))
    k = 0
    while ride.tick():
        k += 1
        if k % 5000 == 0:
            change = k + 2000
            tracker.resume()
            follower.resume()
            tracker.set_speed(1.0)
        elif k >= change:
            change = k + int(random.integers(20, 600))
            which = int(random.integers(6))
            if which < 4:
                actions[which]()
            else:
                tracker.set_speed(float(random.uniform(0.05, 1.0)) if which == 4 else 1.0)


def with_ball(ride: Ride, place: Any) -> bool:
    """Puts a ball into the path for 2 s after 0.05 s. Returns whether the arm had to wait."""
    k = 0
    more = True
    while more and k < 60_000:
        if k in (50, 2050):
            ride.tracker.move("ball", ball(place if k == 50 else FAR))
        more = ride.tick()
        k += 1
    return ride.waited > 100


def kept_rides(name: str, run: fp.Run, level: str, random: np.random.Generator) -> dict[str, list[float]]:
    """For each kind of ride: error, ratios to the bounds, duration relative to the least duration."""
    found = {}
    for kind in ("alone", "operator", "ball"):
        place, bounds = None, []
        if kind == "ball":
            end = run.x[-1][:3, 3] if run.x.ndim == 3 else run.x[-1]
            place = end + random.uniform(-0.05, 0.05, 3)
            try:
                bounds = [fp.Clearance.preset(name, obstacles=[ball(FAR)])]
                near = fp.Clearance.preset(name, obstacles=[ball(place)]).nearest(run.arm, run.q0)
                ride = Ride(run, level, bounds)
            except fp.ParameterError:  # No capsules, or the start is too close to a self-collision.
                continue
            if near is None or near.distance < 0.05:
                continue
            if not with_ball(ride, place):
                continue
        else:
            try:
                ride = Ride(run, level, bounds)
            except fp.ParameterError:  # At acceleration level, the joint path is another one, and may leave a range.
                continue
            if kind == "operator":
                with_operator(ride, random)
            else:
                while ride.tick():
                    pass
        found[kind] = [ride.error, *ride.ratios(run.limits), (len(ride.q) - 1) * DT / float(run.t[-1])]
    return found


def ruckig_ratios(count: int, random: np.random.Generator) -> list[float]:
    """Durations of straight lines of a gantry from rest to rest, relative to Ruckig's with one coordinate."""
    from ruckig import InputParameter, Ruckig, Trajectory

    gantry = fp.SerialArm([fp.Joint("prismatic", axis=axis) for axis in np.eye(3)])
    ratios = []
    for _ in range(count):
        line = random.uniform(-1.0, 1.0, 3)
        velocity, acceleration, jerk = (random.uniform(0.3, 1.0, 3) * most for most in (1.0, 5.0, 100.0))
        free = np.full(3, 10.0)
        limits = fp.JointLimits(lower=-free, upper=free, velocity=velocity, acceleration=acceleration, jerk=jerk)
        run = fp.fastest(gantry, fp.Line(line), fp.MVN(), np.zeros(3), limits=limits)
        given = InputParameter(1)
        given.target_position = [1.0]
        given.max_velocity = [float(np.min(velocity / abs(line)))]
        given.max_acceleration = [float(np.min(acceleration / abs(line)))]
        given.max_jerk = [float(np.min(jerk / abs(line)))]
        trajectory = Trajectory(1)
        Ruckig(1).calculate(given, trajectory)
        ratios.append(float(run.t[-1]) / trajectory.duration)
    return ratios


def torque_row(name: str, count: int, random: np.random.Generator) -> list[str]:
    """Row of the table for motions of an arm with a payload within bounds on torques."""
    mass, fraction = LOADS[name]
    arm = fp.SerialArm.preset(name).with_payload(mass, com=(0.0, 0.0, 0.1))
    bound = fp.TorqueBounds(fraction=fraction)
    found = []
    while len(found) < count:
        run, seconds = random_run(arm, limits_of(arm, name, True), random, (bound,))
        mean = np.diff(run.qd, axis=0) / DT
        states = (run.q, run.qd, run.qdd), (run.q[:-1], run.qd[:-1], mean), (run.q[1:], run.qd[1:], mean)
        torque = max(np.max(np.abs(arm.inverse_dynamics(*state)) / run.largest_torques) for state in states)
        given: dict[str, Any] = {"dt": DT, "task": run.task}
        free = fp.fastest(arm, run.path, run.scheme, run.q0, limits=run.limits, **given)
        loose = fp.fastest(
            arm, run.path, run.scheme, run.q0, limits=limits_of(arm, name, False), bounds=[bound], **given
        )
        try:
            ride = Ride(run, "acceleration", [bound])
        except fp.ParameterError:  # Another joint path, or too little torque for the reserve.
            continue
        while ride.tick():
            pass
        durations = [run.t[-1] / free.t[-1], loose.t[-1] / toppra_duration(loose), len(ride.q) * DT / run.t[-1]]
        found.append([torque, *durations, ride.error, ride.blocked / len(ride.q), 1e3 * seconds])
    torques, slower, peer, longer, error, blocked, ms = np.array(found).T
    pairs = [f"{np.median(x):.3f}, {x.max():.3f}" for x in (slower, peer, longer)]
    shares = f"{np.mean(error <= 1e-5):.1%}, {error.max():.1e}"
    return [
        name,
        f"{torques.max():.9f}",
        *pairs,
        shares,
        f"{blocked.mean():.2%}",
        f"{np.median(ms):.0f}, {ms.max():.0f}",
    ]


def print_table(headings: list[str], rows: list[list[Any]]) -> None:
    print("| " + " | ".join(headings) + " |\n|" + "---|" * len(headings))
    for row in rows:
        print("| " + " | ".join(str(each) for each in row) + " |")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=30, help="paths for each arm")
    parser.add_argument("--level", choices=("velocity", "acceleration"), default="velocity", help="of the trackers")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    worst: dict[str, list[list[float]]] = defaultdict(list)
    against: dict[str, list[list[float]]] = defaultdict(list)
    rides: dict[str, list[list[float]]] = defaultdict(list)
    for name in ARMS:
        random = np.random.default_rng(given.seed)
        arm = fp.SerialArm.preset(name)
        bounded, free = limits_of(arm, name, True), limits_of(arm, name, False)
        for _ in range(given.count):
            run, seconds = random_run(arm, bounded, random)
            worst[name].append([*ratios(run), np.abs(run.error).max(), 1e3 * seconds, run.t[-1]])
            loose = fp.fastest(arm, run.path, run.scheme, run.q0, dt=DT, task=run.task, limits=free)
            reference = toppra_duration(loose)
            for kind, values in kept_rides(name, run, given.level, random).items():
                rides[kind].append(values)
            weighted = duration_with_weights(run, 1.0 / bounded.acceleration**2)
            against[name].append([loose.t[-1] / reference, run.t[-1] / reference, weighted / run.t[-1]])
    rows = []
    for name, found in worst.items():
        v, a, j, off, ms, duration = np.array(found).T
        kept = (f"{each.max():.9f}" for each in (v, a, j))
        times = f"{np.median(ms):.0f}, {ms.max():.0f}"
        rows.append([name, *kept, f"{off.max():.1e}", times, f"{duration.mean():.2f}"])
    head = ["arm", "velocity", "acceleration", "jerk", "off the path [m, rad]", "planning: median, longest [ms]"]
    print_table([*head, "mean duration [s]"], rows)
    print()
    rows = []
    for name, pairs in against.items():
        *peers, weighted = np.array(pairs).T
        rows.append([name, *(f"{np.median(x):.3f}, {x.max():.3f}" for x in peers), f"{np.nanmedian(weighted):.3f}"])
    head = ["arm", "without jerk bounds / TOPP-RA: median, largest", "with jerk bounds / TOPP-RA without"]
    print_table([*head, "weights / MVN: median"], rows)
    ratios_of_ruckig = np.array(ruckig_ratios(given.count, np.random.default_rng(given.seed)))
    median, most = np.median(ratios_of_ruckig), ratios_of_ruckig.max()
    print(f"\nstraight lines of a gantry / Ruckig: median {median:.4f}, largest {most:.4f}\n")
    rows = []
    for kind, values in rides.items():
        error, *most, longer = np.array(values).T
        shares = (f"{np.mean(error <= bound):.1%}" for bound in (1e-5, 1e-4, 1e-3))
        durations = f"{np.median(longer):.3f}" if kind == "alone" else ""
        rows.append(
            [kind, len(error), *shares, f"{error.max():.1e}", *(f"{each.max():.6f}" for each in most), durations]
        )
    head = ["kept in the loop", "motions", "within 1e-5 m, rad", "1e-4", "1e-3", "largest"]
    print_table([*head, "velocity", "acceleration", "jerk", "duration / least: median"], rows)
    print()
    head = ["arm", "torque", "duration / without torque bounds", "without jerk bounds / TOPP-RA", "kept / least"]
    head += ["kept within 1e-5 m, largest", "ticks refused", "planning: median, longest [ms]"]
    print_table(head, [torque_row(name, given.count, np.random.default_rng(given.seed)) for name in LOADS])
    return 0


if __name__ == "__main__":
    sys.exit(main())
