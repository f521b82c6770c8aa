"""Solvers of Pink and Mink that keep the capsules of an arm apart, for bench/clearance_peers.py."""

from __future__ import annotations

import logging
import warnings
from typing import Any

import numpy as np
from clearance_robots import MARGIN, Array, capsule_frame, coal_shape

import fpbm_cpp as fp

SOLVER = "daqp"


class Scene:
    """An arm with its capsules and obstacles, in Pinocchio and Coal, and as MJCF for MuJoCo."""

    def __init__(self, arm: fp.SerialArm, limits: fp.JointLimits, clearance: fp.Clearance) -> None:
        import pinocchio as pin

        self.arm, self.limits, self.shapes = arm, limits, [*clearance.capsules, *clearance.obstacles]
        capsules = clearance.capsules
        allowed = {frozenset(pair) for pair in clearance.allowed}
        self.pairs = [
            (i, j)
            for i, a in enumerate(capsules)
            for j, b in enumerate(self.shapes)
            if (a.link > 0 if j >= len(capsules) else a.link > b.link + 1)
            and frozenset((a.name, b.name)) not in allowed
        ]
        assert len(self.pairs) == len(clearance.pairs(arm))
        self.pin, self.model, self.geometry, joint = pin, pin.Model(), pin.GeometryModel(), 0
        for i, link in enumerate(arm.joints):
            place = pin.SE3(np.asarray(link.placement))
            bounds = [np.array([each[i]]) for each in (limits.velocity, limits.lower, limits.upper)]
            effort = np.array([1.0])
            joint = self.model.addJoint(joint, pin.JointModelRZ(), place, f"joint_{i}", effort, *bounds)
        self.model.addFrame(pin.Frame("tip", joint, 0, pin.SE3(arm.tip), pin.FrameType.OP_FRAME))
        for i, shape in enumerate(self.shapes):
            solid, pose = coal_shape(shape)
            self.geometry.addGeometryObject(
                pin.GeometryObject(f"shape_{i}", getattr(shape, "link", 0), pin.SE3(pose), solid)
            )
        for i, j in self.pairs:
            self.geometry.addCollisionPair(pin.CollisionPair(i, j))
        self.data, self.state = self.model.createData(), self.geometry.createData()

    def distance(self, q: Array) -> float:
        """Smallest distance of all pairs [m]."""
        self.pin.computeDistances(self.model, self.data, self.geometry, self.state, q)
        return min(float(each.min_distance) for each in self.state.distanceResults)

    def mjcf(self) -> str:
        bodies = ["".join(self._geoms(0))]
        for i, joint in enumerate(self.arm.joints):
            ends = f'range="{self.limits.lower[i]} {self.limits.upper[i]}"'
            bodies.append(f'<body {placed(joint.placement)}><joint name="joint_{i}" axis="0 0 1" {ends}/>')
            bodies.append('<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>' + "".join(self._geoms(i + 1)))
        site = f'<site name="tip" {placed(self.arm.tip)}/>'
        ends = "</body>" * self.arm.dof
        return f'<mujoco><compiler angle="radian"/><worldbody>{"".join(bodies)}{site}{ends}</worldbody></mujoco>'

    def _geoms(self, link: int) -> list[str]:
        found = []
        for i, shape in enumerate(self.shapes):
            if getattr(shape, "link", 0) != link:
                continue
            if isinstance(shape, fp.Capsule):
                frame, length = capsule_frame(shape)
                kind, size = ("capsule", [shape.radius, length / 2]) if length > 0 else ("sphere", [shape.radius])
            else:
                assert isinstance(shape, fp.Cuboid)
                frame, kind, size = shape.pose, "box", list(shape.half)
            found.append(f'<geom name="shape_{i}" type="{kind}" size="{" ".join(map(str, size))}" {placed(frame)}/>')
        return found


def placed(frame: Array) -> str:
    axes = np.asarray(frame)[:3, :2].T.ravel()
    return f'pos="{" ".join(map(str, frame[:3, 3]))}" xyaxes="{" ".join(map(str, axes))}"'


class Pink:
    """Pink with a SelfCollisionBarrier over all pairs."""

    def __init__(self, scene: Scene, q: Array, dt: float, gain: float = 1.0, acceleration: Array | None = None) -> None:
        import pink
        from pink.barriers import SelfCollisionBarrier
        from pink.exceptions import NoSolutionFound

        logging.getLogger().setLevel(logging.ERROR)
        self.pink, self.dt, self.none, self.pin = pink, dt, NoSolutionFound, scene.pin
        model = scene.model
        self.configuration = pink.Configuration(
            model,
            model.createData(),
            q,
            collision_model=scene.geometry,
            collision_data=scene.geometry.createData(),
        )
        self.frame = pink.FrameTask("tip", position_cost=50.0, orientation_cost=0.0, gain=gain)
        posture = pink.PostureTask(cost=1e-3)
        posture.set_target(q)
        self.tasks = [self.frame, posture]
        self.limits: list[Any] = [pink.limits.ConfigurationLimit(model), pink.limits.VelocityLimit(model)]
        self.acceleration = None
        if acceleration is not None:
            self.acceleration = pink.limits.AccelerationLimit(model, acceleration)
            self.limits.append(self.acceleration)
        pairs = len(scene.pairs)
        self.barrier = SelfCollisionBarrier(pairs, gain=20.0, safe_displacement_gain=1.0, d_min=MARGIN)

    def step(self, x: Array, xd: Array, xdd: Array) -> tuple[Array, bool]:
        self.frame.set_target(self.pin.SE3(np.eye(3), x))
        velocity, found = np.zeros(self.configuration.model.nv), True
        try:
            velocity = self.pink.solve_ik(
                self.configuration,
                self.tasks,
                self.dt,
                SOLVER,
                limits=self.limits,
                barriers=[self.barrier],
                safety_break=False,
            )
        except self.none:
            found = False
        if self.acceleration is not None:
            self.acceleration.set_last_integration(velocity, self.dt)
        self.configuration.integrate_inplace(velocity, self.dt)
        return self.configuration.q, found


class Mink:
    """Mink with a CollisionAvoidanceLimit over all pairs."""

    def __init__(self, scene: Scene, q: Array, dt: float, gain: float = 1.0) -> None:
        import mink
        import mujoco

        logging.getLogger().setLevel(logging.ERROR)
        self.mink, self.dt = mink, dt
        model = mujoco.MjModel.from_xml_string(scene.mjcf())
        self.configuration = mink.Configuration(model, q)
        self.frame = mink.FrameTask("tip", "site", position_cost=1.0, orientation_cost=0.0, gain=gain, lm_damping=1.0)
        posture = mink.PostureTask(model, cost=1e-3)
        posture.set_target(q)
        self.tasks = [self.frame, posture]
        speeds = {f"joint_{i}": np.array([speed]) for i, speed in enumerate(scene.limits.velocity)}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            apart = mink.CollisionAvoidanceLimit(
                model,
                [([f"shape_{i}"], [f"shape_{j}"]) for i, j in scene.pairs],
                minimum_distance_from_collisions=MARGIN,
                collision_detection_distance=2 * MARGIN,
            )
        self.limits = [mink.ConfigurationLimit(model), mink.VelocityLimit(model, speeds), apart]

    def step(self, x: Array, xd: Array, xdd: Array) -> tuple[Array, bool]:
        self.frame.set_target(self.mink.SE3.from_translation(x))
        velocity, found = np.zeros(self.configuration.nv), True
        try:
            velocity = self.mink.solve_ik(
                self.configuration, self.tasks, self.dt, SOLVER, damping=1e-3, limits=self.limits
            )
        except self.mink.NoSolutionFound:
            found = False
        self.configuration.integrate_inplace(velocity, self.dt)
        return self.configuration.q.copy(), found
