"""Motions of a tray that two Pandas hold, by one library. bench/grasp_peers.py runs this file for each library.

The motions equal the motions of bench/grasp.cpp, from the same random numbers. Prints JSON.
"""

from __future__ import annotations

import json
import logging
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from stack_solvers import rpy

import fpbm_cpp as fp

Array = NDArray[np.float64]

DT = 1e-3
TICKS, MOVE, MOVES, HOLD = 3000, 600, 4, 1000
HOME = np.array([0.0, -0.6, 0.0, -2.4, 0.0, 1.8, 0.785])
PLACES = {"right": -0.4, "left": 0.4}  # Along y [m].
# Costs of the relative pose, of the pose of the object and of the posture. The costs of the object and of the posture
# are from the examples of Pink and Mink. The quadratic programs contain the squares of the costs.
COSTS = (100.0, 1.0, 1e-3)
TOLERANCE = 1e-10  # Tolerance of quadratic programs, as in bench/stack_solvers.py.


class Random:
    """SplitMix64, as in bench/grasp.cpp."""

    def __init__(self, seed: int) -> None:
        self.state = seed

    def uniform(self, size: float) -> float:
        mask = (1 << 64) - 1
        self.state = (self.state + 0x9E3779B97F4A7C15) & mask
        z = self.state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
        return size * (2.0 * ((z ^ (z >> 31)) >> 11) * 2.0**-53 - 1.0)

    def vector(self, n: int, size: float) -> Array:
        return np.array([self.uniform(size) for _ in range(n)])


class ObjectPath:
    """Quintic motions of the object between waypoints, faster than the arms."""

    def __init__(self, random: Random) -> None:
        self.at = [(np.zeros(3), np.zeros(3))]
        self.at += [(random.vector(3, 0.5), random.vector(3, 0.8)) for _ in range(MOVES)]

    def __call__(self, tick: int, start: Array) -> tuple[Array, Array, Array]:
        """Pose of the object, and the velocity and acceleration of its position, with zeros for the rotation."""
        k = min(tick // MOVE, MOVES - 1)
        duration, s = MOVE * DT, min((tick - k * MOVE) / MOVE, 1.0)
        part = s**3 * (10.0 + s * (6.0 * s - 15.0))
        (p, r), (p_next, r_next) = self.at[k], self.at[k + 1]
        pose, twist, change = start.copy(), np.zeros(6), np.zeros(6)
        pose[:3, 3] += p + part * (p_next - p)
        pose[:3, :3] = fp.rotation(r + part * (r_next - r)) @ start[:3, :3]
        twist[:3] = 30.0 * s**2 * (1.0 - s) ** 2 / duration * (p_next - p)
        change[:3] = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / duration**2 * (p_next - p)
        return pose, twist, change


def origin(frame: Array) -> str:
    numbers = [" ".join(repr(float(v)) for v in values) for values in (frame[:3, 3], rpy(frame[:3, :3]))]
    return f'<origin xyz="{numbers[0]}" rpy="{numbers[1]}"/>'


def placed(side: str, i: int) -> Array:
    """Placement of joint i of an arm in the frame of the previous joint. i = 7: placement of the tip."""
    arm = fp.SerialArm.preset("panda")
    frame = np.array(arm.joints[i].placement if i < arm.dof else arm.tip)
    frame[1, 3] += PLACES[side] if i == 0 else 0.0
    return frame


def urdf(limits: fp.JointLimits) -> str:
    # Pinocchio orders joints by name.
    mass = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    parts = [f'<link name="base">{mass}</link>']
    for a, side in enumerate(PLACES):
        for i in range(8):
            name = f"arm{a}_{i + 1}" if i < 7 else f"{side}_tip"
            parent = f"arm{a}_{i}" if i else "base"
            kind, bounds = "fixed", ""
            if i < 7:
                j = 7 * a + i
                ends = f'lower="{limits.lower[j]}" upper="{limits.upper[j]}" velocity="{limits.velocity[j]}"'
                kind, bounds = "revolute", f'<axis xyz="0 0 1"/><limit {ends} effort="100"/>'
            parts.append(f'<link name="{name}">{mass}</link><joint name="{name}_joint" type="{kind}">')
            parts.append(f'{origin(placed(side, i))}<parent link="{parent}"/><child link="{name}"/>{bounds}</joint>')
    return f'<robot name="pandas">{"".join(parts)}</robot>'


def mjcf(limits: fp.JointLimits) -> str:
    def place(frame: Array) -> str:
        numbers = [" ".join(repr(float(v)) for v in values) for values in (frame[:3, 3], frame[:3, :2].T.ravel())]
        return f'pos="{numbers[0]}" xyaxes="{numbers[1]}"'

    bodies = []
    for a, side in enumerate(PLACES):
        for i in range(7):
            ends = f'range="{limits.lower[7 * a + i]} {limits.upper[7 * a + i]}"'
            bodies.append(f'<body {place(placed(side, i))}><joint name="{side}_{i + 1}_joint" axis="0 0 1" {ends}/>')
            bodies.append('<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>')
        bodies.append(f'<site name="{side}_tip" {place(placed(side, 7))}/>' + "</body>" * 7)
    return f'<mujoco><compiler angle="radian"/><worldbody>{"".join(bodies)}</worldbody></mujoco>'


class Options(NamedTuple):
    gain: float = 1.0  # Fraction of the object's error that the other libraries correct in a tick.
    acceleration: bool = False  # Whether accelerations have bounds, for libraries with these bounds.
    grasp_gain: float = 1.0


class Solver(Protocol):
    def reset(self, q: Array, grasp: Array) -> None: ...
    def step(self, path: Callable[[int], tuple[Array, Array, Array]], tick: int) -> tuple[Array, bool]:
        """The posture after a tick, and whether a solution was found. Without a solution, the robot does not move."""


class Ours:
    """fpbm_cpp with three levels: relative pose, object, posture."""

    def __init__(self, limits: fp.JointLimits, options: Options) -> None:
        self.robot = fp.Robot.preset("two_pandas")

    def reset(self, q: Array, grasp: Array) -> None:
        stack = fp.Stack(
            fp.RelativePoseTask("left_tip", "right_tip", name="grasp", k1=500, k2=62_500),
            fp.PoseTask("right_tip", name="object", k1=10, k2=25),
            fp.PostureTask(q, k1=4, k2=4),
        )
        scheme = fp.Balanced(0, np.ones(14), null_damping=2)
        self.tracker = fp.Tracker(self.robot, scheme, q, stack=stack, keep_first_level=True)

    def step(self, path: Callable[[int], tuple[Array, Array, Array]], tick: int) -> tuple[Array, bool]:
        return np.array(self.tracker.tick({"object": path(tick)}).q), True


class Pink:
    def __init__(self, limits: fp.JointLimits, options: Options) -> None:
        import pink
        import pinocchio as pin

        logging.getLogger().setLevel(logging.ERROR)
        self.pink, self.pin = pink, pin
        self.model = pin.buildModelFromXML(urdf(limits))
        self.acceleration = np.asarray(limits.acceleration)
        self.options = options
        grasp, tray, posture = COSTS
        self.grasp = pink.tasks.RelativeFrameTask("left_tip", "right_tip", grasp, grasp, gain=options.grasp_gain)
        self.tray = pink.FrameTask("right_tip", tray, tray, gain=options.gain)
        self.posture = pink.PostureTask(cost=posture)

    def reset(self, q: Array, grasp: Array) -> None:
        self.configuration = self.pink.Configuration(self.model, self.model.createData(), q)
        self.grasp.set_target(self.pin.SE3(grasp))
        self.posture.set_target(q)
        self.last = self.pink.limits.AccelerationLimit(self.model, self.acceleration)
        limits = self.pink.limits
        self.limits = [limits.ConfigurationLimit(self.model), limits.VelocityLimit(self.model)]
        self.limits += [self.last] if self.options.acceleration else []

    def step(self, path: Callable[[int], tuple[Array, Array, Array]], tick: int) -> tuple[Array, bool]:
        self.tray.set_target(self.pin.SE3(path(tick + 1)[0]))
        velocity, found = np.zeros(14), True
        try:
            velocity = self.pink.solve_ik(
                self.configuration,
                [self.grasp, self.tray, self.posture],
                DT,
                "daqp",
                limits=self.limits,
                safety_break=False,
                primal_tol=TOLERANCE,
            )
        except self.pink.exceptions.NoSolutionFound:
            found = False
        self.last.set_last_integration(velocity, DT)
        self.configuration.integrate_inplace(velocity, DT)
        return self.configuration.q.copy(), found


class Mink:
    def __init__(self, limits: fp.JointLimits, options: Options) -> None:
        import mink
        import mujoco

        logging.getLogger().setLevel(logging.ERROR)
        self.mink = mink
        self.model = mujoco.MjModel.from_xml_string(mjcf(limits))
        grasp, tray, posture = COSTS
        self.grasp = mink.RelativeFrameTask("left_tip", "site", "right_tip", "site", grasp, grasp)
        self.tray = mink.FrameTask("right_tip", "site", tray, tray, gain=options.gain)
        self.posture = mink.PostureTask(self.model, cost=posture)
        names = [f"{side}_{i + 1}_joint" for side in PLACES for i in range(7)]
        speeds = {name: np.array([speed]) for name, speed in zip(names, limits.velocity, strict=True)}
        self.limits = [mink.ConfigurationLimit(self.model), mink.VelocityLimit(self.model, speeds)]

    def reset(self, q: Array, grasp: Array) -> None:
        self.configuration = self.mink.Configuration(self.model, q)
        self.grasp.set_target(self.mink.SE3.from_matrix(grasp))
        self.posture.set_target(q)

    def step(self, path: Callable[[int], tuple[Array, Array, Array]], tick: int) -> tuple[Array, bool]:
        mink = self.mink
        self.tray.set_target(mink.SE3.from_matrix(path(tick + 1)[0]))
        tasks = [self.grasp, self.tray, self.posture]
        velocity, found = np.zeros(14), True
        try:
            velocity = mink.solve_ik(self.configuration, tasks, DT, "daqp", limits=self.limits, primal_tol=TOLERANCE)
        except mink.NoSolutionFound:
            found = False
        self.configuration.integrate_inplace(velocity, DT)
        return self.configuration.q.copy(), found


class Placo:
    """PlaCo with the relative pose as a `hard` task, which is an equality. The other tasks are soft."""

    def __init__(self, limits: fp.JointLimits, options: Options) -> None:
        import placo

        self.gain = options.gain
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "pandas.urdf"
            file.write_text(urdf(limits))
            self.robot = placo.RobotWrapper(str(file), placo.Flags.ignore_collisions)
        self.solver = placo.KinematicsSolver(self.robot)
        self.solver.mask_fbase(True)
        self.solver.dt = DT
        self.names = [f"arm{a}_{i + 1}_joint" for a in range(2) for i in range(7)]
        self.grasp = self.solver.add_relative_frame_task("right_tip", "left_tip", np.eye(4))
        self.grasp.configure("grasp", "hard", 1.0, 1.0)
        self.tray = self.solver.add_frame_task("right_tip", np.eye(4))
        self.tray.configure("object", "soft", COSTS[1] ** 2, COSTS[1] ** 2)
        self.posture = self.solver.add_joints_task()
        self.posture.configure("posture", "soft", COSTS[2] ** 2)
        self.solver.enable_joint_limits(True)
        self.solver.enable_velocity_limits(True)

    def reset(self, q: Array, grasp: Array) -> None:
        for name, value in zip(self.names, q, strict=True):
            self.robot.set_joint(name, float(value))
        self.robot.update_kinematics()
        self.grasp.T_a_b = grasp
        self.posture.set_joints(dict(zip(self.names, q.tolist(), strict=True)))
        self.q = q.copy()

    def step(self, path: Callable[[int], tuple[Array, Array, Array]], tick: int) -> tuple[Array, bool]:
        self.tray.T_world_frame = partly(self.robot.get_T_world_frame("right_tip"), path(tick + 1)[0], self.gain)
        try:
            self.solver.solve(True)
            self.robot.update_kinematics()
        except RuntimeError:
            return self.q, False
        self.q = np.array([self.robot.get_joint(name) for name in self.names])
        return self.q, True


class Roboplan:
    """roboplan with the relative pose of the left tip in the frame of the right tip. All tasks have the same priority:
    with the priorities 1, 2 and 3, the relative pose differed by 0.1 m."""

    def __init__(self, limits: fp.JointLimits, options: Options) -> None:
        import roboplan.core as core
        import roboplan.optimal_ik as ik

        self.core, self.ik = core, ik
        self.given = limits
        self.options = options
        self.scene = core.Scene("pandas", core.loadUrdfSceneDescriptionFromXml(urdf(limits)))

    def reset(self, q: Array, grasp: Array) -> None:
        core, ik = self.core, self.ik
        self.oink = ik.Oink(self.scene)

        def frame(reference: str, name: str, pose: Array, gain: float, cost: float) -> Any:
            options = ik.FrameTaskOptions(position_cost=cost, orientation_cost=cost, task_gain=gain)
            target = core.CartesianConfiguration(reference, name, np.asfortranarray(pose))
            return ik.FrameTask(self.oink, self.scene, target, options)

        self.tray = frame("base", "right_tip", np.eye(4), self.options.gain, COSTS[1])
        posture = ik.ConfigurationTask(self.oink, q, COSTS[2] * np.ones(14), ik.ConfigurationTaskOptions())
        self.tasks = [frame("right_tip", "left_tip", grasp, self.options.grasp_gain, COSTS[0]), self.tray, posture]
        self.last = ik.AccelerationLimit(self.oink, DT, np.asarray(self.given.acceleration))
        velocity = ik.VelocityLimit(self.oink, DT, np.asarray(self.given.velocity))
        self.limits = [ik.PositionLimit(self.oink), velocity]
        self.limits += [self.last] if self.options.acceleration else []
        self.q, self.change = q.copy(), np.zeros(14)

    def step(self, path: Callable[[int], tuple[Array, Array, Array]], tick: int) -> tuple[Array, bool]:
        self.tray.setTargetFrameTransform(np.asfortranarray(path(tick + 1)[0]))
        found = True
        try:
            self.oink.solveIk(self.q, self.tasks, self.limits, [], self.change)
        except RuntimeError:
            self.change[:] = 0.0
            found = False
        self.last.setLastVelocity(self.change / DT)
        self.q = self.q + self.change
        return self.q, found


SOLVERS: dict[str, Any] = {"fpbm_cpp": Ours, "Pink": Pink, "Mink": Mink, "PlaCo": Placo, "roboplan": Roboplan}


def log(R: Array) -> Array:
    """Rotation vector of a rotation by less than half a turn."""
    axis = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
    sine = np.linalg.norm(axis)
    return axis if sine < 1e-9 else axis * (np.arctan2(sine, (np.trace(R) - 1) / 2) / sine)


def partly(now: Array, target: Array, gain: float) -> Array:
    """Pose at the fraction `gain` from `now` to `target`, for tasks without a gain."""
    pose = now.copy()
    pose[:3, 3] += gain * (target[:3, 3] - now[:3, 3])
    pose[:3, :3] = fp.rotation(gain * log(target[:3, :3] @ now[:3, :3].T)) @ now[:3, :3]
    return pose


def excess(limits: fp.JointLimits, q: Array) -> list[float]:
    """Excess of positions [rad], and of velocities and accelerations relative to the bounds, by differences of q."""
    shares = [
        float((np.abs(np.diff(q, k, axis=0)) / DT**k / bound).max() - 1)
        for k, bound in ((1, limits.velocity), (2, limits.acceleration))
    ]
    return [float(max((limits.lower - q).max(), (q - limits.upper).max())), *shares]


def motion(robot: fp.Robot, solver: Solver, seed: int) -> dict[str, Any]:
    random = Random(seed)
    q0 = np.tile(HOME, 2) + random.vector(14, 0.3)
    path = ObjectPath(random)
    start = robot.forward(q0, "right_tip")
    grasp = np.linalg.inv(start) @ robot.forward(q0, "left_tip")
    solver.reset(q0, grasp)
    q, failed, spent = [q0, q0, q0], 0, 0
    for k in range(TICKS + HOLD):
        begin = time.process_time_ns()
        now, found = solver.step(lambda tick: path(tick, start), k)
        spent += time.process_time_ns() - begin
        q.append(np.array(now))
        failed += not found
    poses = [(robot.forward(each, "right_tip"), robot.forward(each, "left_tip")) for each in q]
    relative = [np.linalg.inv(right) @ left for right, left in poses]
    errors = [np.linalg.norm([x[:3, 3] - grasp[:3, 3], log(x[:3, :3] @ grasp[:3, :3].T)], axis=1) for x in relative]
    away = [right[:3, 3] - path(max(k - 2, 0), start)[0][:3, 3] for k, (right, _) in enumerate(poses)]
    return {
        "grasp": np.max(errors, axis=0).tolist(),
        "object": float(np.sqrt(np.mean(np.square(away).sum(axis=1)))),
        "excess": excess(robot.limits, np.array(q)),
        "failed": failed,
        "time": spent / (TICKS + HOLD) / 1e3,
    }


def main() -> None:
    name, motions, first = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    options = Options(*json.loads(sys.argv[4]))
    robot = fp.Robot.preset("two_pandas")
    solver = SOLVERS[name](robot.limits, options)
    print(json.dumps([motion(robot, solver, seed) for seed in range(first, first + motions)]))


if __name__ == "__main__":
    main()
