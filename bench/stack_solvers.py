"""A stack of tasks by fpbm_cpp, Pink, Mink, PlaCo and roboplan, for bench/stack_peers.py.

All libraries use the Panda of the preset, as URDF or MJCF. The levels are the pose of the tip, the position of the
elbow (origin of joint 4), and the posture. The other libraries are at velocity level. The bounds are on position,
velocity and, if supported by the library, acceleration.
"""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

import fpbm_cpp as fp

Array = NDArray[np.float64]

DT = 1e-3
GAIN = 10.0  # Gain of tip and elbow [1/s].
POSTURE_GAIN = 1.0
START = np.array([0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785])
ELBOW = 4

# Weights of tip, elbow and posture. The weight of the tip is the default of Pink and Mink. The weight of the posture is
# the value in the examples of Pink and Mink. The weight of the elbow is between these weights. The costs contain the
# squares of the weights.
WEIGHTS = (1.0, 0.1, 1e-3)

# Tolerance of the quadratic programs of Pink and Mink. The default, 1e-6, applies to a displacement. In a tick of 1 ms,
# this tolerance means 1e-3 rad/s and 1 rad/s². roboplan has its default of 1e-6: with 1e-8, the computation of the
# motion of 20 s did not end in 50 s.
TOLERANCE = 1e-10


class Panda(NamedTuple):
    arm: fp.SerialArm
    limits: fp.JointLimits


def panda() -> Panda:
    """The preset without its bounds on jerk, because no other library has bounds on jerk."""
    arm = fp.SerialArm.preset("panda")
    limits = arm.limits
    names = ("lower", "upper", "velocity", "acceleration")
    return Panda(arm, fp.JointLimits(**{name: np.asarray(getattr(limits, name)) for name in names}))


class Targets(NamedTuple):
    """Targets of the tasks for the end of a tick, for solvers that compute displacements."""

    tip: Array
    elbow: Array
    posture: Array


class Solver(Protocol):
    acceleration: bool  # Whether the solver bounds accelerations.

    def reset(self, q: Array) -> None: ...
    def step(self, targets: Targets) -> tuple[Array, bool]:
        """The posture after a tick, and whether a solution was found. Without a solution, the arm does not move."""


class Options(NamedTuple):
    lower: bool = True  # Whether the stack has elbow and posture.
    limits: bool = True


def rpy(R: Array) -> tuple[float, float, float]:
    return (
        float(np.arctan2(R[2, 1], R[2, 2])),
        float(np.arctan2(-R[2, 0], np.hypot(R[0, 0], R[1, 0]))),
        float(np.arctan2(R[1, 0], R[0, 0])),
    )


def urdf(robot: Panda) -> str:
    arm, limits = robot

    def origin(frame: Array) -> str:
        numbers = [" ".join(repr(float(v)) for v in values) for values in (frame[:3, 3], rpy(frame[:3, :3]))]
        return f'<origin xyz="{numbers[0]}" rpy="{numbers[1]}"/>'

    mass = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    names = [f"link{i}" for i in range(arm.dof + 1)] + ["tip", "elbow"]
    parts = [f'<link name="{name}">{mass}</link>' for name in names]
    for i, joint in enumerate(arm.joints):
        limit = f'lower="{limits.lower[i]}" upper="{limits.upper[i]}" velocity="{limits.velocity[i]}" effort="100"'
        ends = f'<parent link="link{i}"/><child link="link{i + 1}"/><axis xyz="0 0 1"/><limit {limit}/>'
        parts.append(f'<joint name="joint{i + 1}" type="revolute">{origin(np.asarray(joint.placement))}{ends}</joint>')
    for name, parent, frame in (("tip", arm.dof, np.asarray(arm.tip)), ("elbow", ELBOW, np.eye(4))):
        ends = f'<parent link="link{parent}"/><child link="{name}"/>'
        parts.append(f'<joint name="{name}_joint" type="fixed">{origin(frame)}{ends}</joint>')
    return f'<robot name="panda">{"".join(parts)}</robot>'


def mjcf(robot: Panda) -> str:
    arm, limits = robot

    def place(frame: Array) -> str:
        axes = np.asarray(frame)[:3, :2].T.ravel()
        return f'pos="{" ".join(map(repr, map(float, frame[:3, 3])))}" xyaxes="{" ".join(map(repr, map(float, axes)))}"'

    bodies = []
    for i, joint in enumerate(arm.joints):
        ends = f'range="{limits.lower[i]} {limits.upper[i]}"'
        bodies.append(f'<body {place(np.asarray(joint.placement))}><joint name="joint{i + 1}" axis="0 0 1" {ends}/>')
        bodies.append('<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>')
        bodies.append('<site name="elbow"/>' if i + 1 == ELBOW else "")
    site = f'<site name="tip" {place(np.asarray(arm.tip))}/>'
    ends = "</body>" * arm.dof
    return f'<mujoco><compiler angle="radian"/><worldbody>{"".join(bodies)}{site}{ends}</worldbody></mujoco>'


class Pink:
    acceleration = True

    def __init__(self, robot: Panda, options: Options) -> None:
        import pink
        import pinocchio as pin

        logging.getLogger().setLevel(logging.ERROR)
        self.pink, self.pin = pink, pin
        model = pin.buildModelFromXML(urdf(robot))
        self.configuration = pink.Configuration(model, model.createData(), START)
        self.tip = pink.FrameTask("tip", position_cost=WEIGHTS[0], orientation_cost=WEIGHTS[0])
        self.elbow = pink.FrameTask("elbow", position_cost=WEIGHTS[1], orientation_cost=0.0)
        self.posture = pink.PostureTask(cost=WEIGHTS[2])
        self.tasks = [self.tip, self.elbow, self.posture] if options.lower else [self.tip]
        self.last = pink.limits.AccelerationLimit(model, np.asarray(robot.limits.acceleration))
        limits = [pink.limits.ConfigurationLimit(model), pink.limits.VelocityLimit(model), self.last]
        self.limits = limits if options.limits else []

    def reset(self, q: Array) -> None:
        self.configuration.update(q)

    def step(self, targets: Targets) -> tuple[Array, bool]:
        self.tip.set_target(self.pin.SE3(targets.tip))
        self.elbow.set_target(self.pin.SE3(np.eye(3), targets.elbow))
        self.posture.set_target(targets.posture)
        velocity, found = np.zeros(7), True
        try:
            velocity = self.pink.solve_ik(
                self.configuration,
                self.tasks,
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
        return self.configuration.q, found


class Mink:
    acceleration = False

    def __init__(self, robot: Panda, options: Options) -> None:
        import mink
        import mujoco

        logging.getLogger().setLevel(logging.ERROR)
        self.mink = mink
        model = mujoco.MjModel.from_xml_string(mjcf(robot))
        self.configuration = mink.Configuration(model, START)
        self.tip = mink.FrameTask("tip", "site", position_cost=WEIGHTS[0], orientation_cost=WEIGHTS[0])
        self.elbow = mink.FrameTask("elbow", "site", position_cost=WEIGHTS[1], orientation_cost=0.0)
        self.posture = mink.PostureTask(model, cost=WEIGHTS[2])
        self.tasks = [self.tip, self.elbow, self.posture] if options.lower else [self.tip]
        speeds = {f"joint{i + 1}": np.array([speed]) for i, speed in enumerate(robot.limits.velocity)}
        limits = [mink.ConfigurationLimit(model), mink.VelocityLimit(model, speeds)]
        self.limits = limits if options.limits else []

    def reset(self, q: Array) -> None:
        self.configuration.update(q)

    def step(self, targets: Targets) -> tuple[Array, bool]:
        mink = self.mink
        self.tip.set_target(mink.SE3.from_matrix(targets.tip))
        self.elbow.set_target(mink.SE3.from_translation(targets.elbow))
        self.posture.set_target(targets.posture)
        velocity, found = np.zeros(7), True
        try:
            velocity = mink.solve_ik(
                self.configuration, self.tasks, DT, "daqp", limits=self.limits, primal_tol=TOLERANCE
            )
        except mink.NoSolutionFound:
            found = False
        self.configuration.integrate_inplace(velocity, DT)
        return self.configuration.q.copy(), found


class Placo:
    """PlaCo with the tip as a `scaled` task, which has strict priority. Elbow and posture are soft tasks. Weights of
    PlaCo are weights of squares."""

    acceleration = False

    def __init__(self, robot: Panda, options: Options) -> None:
        import placo

        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "panda.urdf"
            file.write_text(urdf(robot))
            self.robot = placo.RobotWrapper(str(file), placo.Flags.ignore_collisions)
        self.solver = placo.KinematicsSolver(self.robot)
        self.solver.mask_fbase(True)
        self.solver.dt = DT
        self.names = [f"joint{i + 1}" for i in range(7)]
        self.tip = self.solver.add_frame_task("tip", np.eye(4))
        self.tip.configure("tip", "scaled" if options.limits else "hard", 1.0, 1.0)
        self.lower = options.lower
        if options.lower:
            self.elbow = self.solver.add_position_task("elbow", np.zeros(3))
            self.elbow.configure("elbow", "soft", WEIGHTS[1] ** 2)
            self.posture = self.solver.add_joints_task()
            self.posture.configure("posture", "soft", WEIGHTS[2] ** 2)
        self.solver.enable_joint_limits(options.limits)
        self.solver.enable_velocity_limits(options.limits)
        self.reset(START)

    def reset(self, q: Array) -> None:
        for name, value in zip(self.names, q, strict=True):
            self.robot.set_joint(name, float(value))
        self.robot.update_kinematics()

    def step(self, targets: Targets) -> tuple[Array, bool]:
        self.tip.T_world_frame = targets.tip
        if self.lower:
            self.elbow.target_world = targets.elbow
            self.posture.set_joints(dict(zip(self.names, targets.posture.tolist(), strict=True)))
        found = True
        try:
            self.solver.solve(True)
            self.robot.update_kinematics()
        except RuntimeError:
            found = False
        return self.robot.state.q[-7:].copy(), found


class Roboplan:
    """roboplan with the strict priorities 1, 2 and 3."""

    acceleration = True

    def __init__(self, robot: Panda, options: Options) -> None:
        import roboplan.core as core
        import roboplan.optimal_ik as ik

        self.scene = core.Scene("panda", core.loadUrdfSceneDescriptionFromXml(urdf(robot)))
        self.oink = ik.Oink(self.scene)
        first = ik.FrameTaskOptions(priority=1)
        second = ik.FrameTaskOptions(orientation_cost=0.0, priority=2)

        def frame(name: str, options: Any) -> Any:
            pose = self.scene.forwardKinematics(START, name)
            return ik.FrameTask(self.oink, self.scene, core.CartesianConfiguration("link0", name, pose), options)

        self.tip, self.elbow = frame("tip", first), frame("elbow", second)
        third = ik.ConfigurationTaskOptions(priority=3)
        self.posture = ik.ConfigurationTask(self.oink, START, np.ones(7), third)
        self.tasks = [self.tip, self.elbow, self.posture] if options.lower else [self.tip]
        self.last = ik.AccelerationLimit(self.oink, DT, np.asarray(robot.limits.acceleration))
        velocity = ik.VelocityLimit(self.oink, DT, np.asarray(robot.limits.velocity))
        self.limits = [ik.PositionLimit(self.oink), velocity, self.last] if options.limits else []
        self.elbow_pose = np.asfortranarray(np.eye(4))
        self.change = np.zeros(7)
        self.reset(START)

    def reset(self, q: Array) -> None:
        self.q = np.array(q)

    def step(self, targets: Targets) -> tuple[Array, bool]:
        self.tip.setTargetFrameTransform(targets.tip)
        self.elbow_pose[:3, 3] = targets.elbow
        self.elbow.setTargetFrameTransform(self.elbow_pose)
        self.posture.setTargetConfiguration(targets.posture)
        found = True
        try:
            self.oink.solveIk(self.q, self.tasks, self.limits, [], self.change)
        except RuntimeError:
            self.change[:] = 0.0
            found = False
        self.last.setLastVelocity(self.change / DT)
        self.q = self.q + self.change
        return self.q, found


class Peer(NamedTuple):
    packages: tuple[str, ...]  # Packages to install; the version is the version of the first package.
    make: Callable[[Panda, Options], Solver]


PEERS = {
    "Pink": Peer(("pin-pink", "daqp"), Pink),
    "Mink": Peer(("mink", "daqp"), Mink),
    "PlaCo": Peer(("placo",), Placo),
    "roboplan": Peer(("roboplan",), Roboplan),
}


def ours(robot: Panda, level: str) -> fp.Tracker:
    """A tracker at velocity or acceleration level."""
    tip = fp.PoseTask("tip", name="tip", k=GAIN, k1=2 * GAIN, k2=GAIN**2)
    elbow = fp.PositionTask(f"panda_joint{ELBOW}", name="elbow", k=GAIN, k1=2 * GAIN, k2=GAIN**2)
    posture = fp.PostureTask(START, k=POSTURE_GAIN, k1=2 * POSTURE_GAIN, k2=POSTURE_GAIN**2)
    scheme = fp.MVN() if level == "velocity" else fp.Balanced(0.6, np.ones(7), null_damping=2)
    stack = fp.Stack(tip, elbow, posture)
    # A larger bound on errors than any error: the peers have no bound on errors.
    return fp.Tracker(robot.arm, scheme, START, stack=stack, limits=robot.limits, error_bound=10.0)
