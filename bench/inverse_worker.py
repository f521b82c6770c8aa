"""Inverse kinematics by one library, for bench/inverse_peers.py: `inverse_worker.py SOLVER PROBLEM.npz ANSWER.npz N C`.

Solves the first N problems of the file on C processor cores. The answer file has the answers (NaN: no answer), the
time of each call [s], and the number of answers of each call. SOLVER "forward": poses of the answers, by Pinocchio.
The solvers have the bounds of bench/inverse_peers.py: 256 starts, or 50 ms for solvers that stop by time.
"""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STARTS, SECONDS = 256, 0.05  # Bounds on a call.
ERROR = 1e-7  # Largest error of the solvers: below the tolerance of the check, 1e-6.


class Problem:
    """The arm of a problem file, and random starts."""

    def __init__(self, path: str) -> None:
        file = np.load(path)
        self.name, self.urdf = str(file["name"]), str(file["urdf"])
        self.targets, self.starts, self.home = file["targets"], file["starts"], file["home"]
        self.frames, self.tip = file["frames"], file["tip"]
        self.lower, self.upper = file["lower"], file["upper"]
        self.random = np.random.default_rng(0)

    def start(self) -> Array:
        return self.random.uniform(self.lower, self.upper)

    def inside(self, q: Array) -> Array | None:
        """The posture with each angle in the range of the joint, or None."""
        q = q - 2 * np.pi * np.ceil((q - self.upper) / (2 * np.pi))
        return q if np.all(q >= self.lower) else None


class Solver(Protocol):
    def __init__(self, problem: Problem) -> None: ...
    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        """The arguments of solve(), in the types of the library."""

    def solve(self, *given: Any) -> tuple[Array | None, int]:
        """The answer, and the number of answers that the library found."""


def counted(q: Any) -> tuple[Array | None, int]:
    return (None, 0) if q is None else (np.asarray(q, dtype=float), 1)


class Optik:
    """OptIK on one thread. tol_f is the square of the error."""

    def __init__(self, problem: Problem) -> None:
        import optik

        self.robot = optik.Robot.from_urdf_file(problem.urdf, "link0", "tip")
        self.robot.set_parallelism(1)
        self.config = optik.SolverConfig("speed", max_time=0.0, max_restarts=STARTS, tol_f=ERROR**2)

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return self.config, target.tolist(), start.tolist()

    def solve(self, *given: Any) -> tuple[Array | None, int]:
        found = self.robot.ik(*given)
        return counted(found and found[0])


class TracIk:
    """TRAC-IK, which stops by time. TRAC-IK always runs two threads: Newton's method of KDL, and SQP of NLopt."""

    def __init__(self, problem: Problem) -> None:
        from trac_ik import TracIK

        self.robot = TracIK("link0", "tip", problem.urdf, timeout=SECONDS, epsilon=ERROR)
        self.robot.joint_limits = problem.lower, problem.upper  # TRAC-IK rounds the ranges of the URDF to float.

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return target[:3, 3], target[:3, :3], start

    def solve(self, *given: Any) -> tuple[Array | None, int]:
        return counted(self.robot.ik(*given))


class Toolbox:
    """ik_LM of the Robotics Toolbox, in C++. Its tolerance is half of the square of the error."""

    def __init__(self, problem: Problem) -> None:
        import roboticstoolbox as rtb

        self.ets = rtb.Robot.URDF(problem.urdf).ets(start="link0", end="tip")

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return target, start

    def solve(self, *given: Any) -> tuple[Array | None, int]:
        found = self.ets.ik_LM(*given, slimit=STARTS, tol=ERROR**2 / 2, joint_limits=True)
        return counted(found.q if found.success else None)


class KdlLma:
    """Levenberg-Marquardt method of KDL, with random starts in Python. KDL does not know the ranges."""

    def __init__(self, problem: Problem) -> None:
        sys.path.append("/usr/lib/python3/dist-packages")  # Of the Debian package python3-pykdl.
        import PyKDL as kdl

        self.kdl, self.problem = kdl, problem
        self.chain = kdl.Chain()
        self.chain.addSegment(kdl.Segment(kdl.Joint(), self.frame(problem.frames[0])))
        for frame in [*problem.frames[1:], problem.tip]:
            self.chain.addSegment(kdl.Segment(kdl.Joint(kdl.Joint.RotZ), self.frame(frame)))
        self.out = kdl.JntArray(len(problem.lower))
        self.build()

    def build(self) -> None:
        self.solver = self.kdl.ChainIkSolverPos_LMA(self.chain, np.ones(6), ERROR, 100)

    def frame(self, pose: Array) -> Any:
        return self.kdl.Frame(self.kdl.Rotation(*pose[:3, :3].ravel()), self.kdl.Vector(*pose[:3, 3]))

    def joints(self, q: Array) -> Any:
        joints = self.kdl.JntArray(len(q))
        for i, angle in enumerate(q):
            joints[i] = angle
        return joints

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return self.frame(target), self.joints(start)

    def solve(self, *given: Any) -> tuple[Array | None, int]:
        target, start = given
        for _ in range(STARTS):
            if self.solver.CartToJnt(start, target, self.out) >= 0:
                q = self.problem.inside(np.array([self.out[i] for i in range(self.out.rows())]))
                if q is not None:
                    return q, 1
            start = self.joints(self.problem.start())
        return None, 0


class KdlNewton(KdlLma):
    """Newton's method of KDL with joint ranges, with random starts in Python."""

    def build(self) -> None:
        kdl, lower, upper = self.kdl, self.joints(self.problem.lower), self.joints(self.problem.upper)
        self.parts = kdl.ChainFkSolverPos_recursive(self.chain), kdl.ChainIkSolverVel_pinv(self.chain)
        self.solver = kdl.ChainIkSolverPos_NR_JL(self.chain, lower, upper, *self.parts, 100, ERROR)


class Pinocchio:
    """Levenberg-Marquardt method with kinematics of Pinocchio; the loop is in Python."""

    def __init__(self, problem: Problem) -> None:
        import pinocchio as pin

        self.pin, self.problem = pin, problem
        self.model = pin.buildModelFromUrdf(problem.urdf)
        self.data = self.model.createData()
        self.tip = self.model.getFrameId("tip")
        self.turn = np.where(problem.upper - problem.lower > 6.28, 2 * np.pi, 1e9)

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return self.pin.SE3(target), start

    def pose(self, q: Array) -> Any:
        self.pin.forwardKinematics(self.model, self.data, q)
        return self.pin.updateFramePlacement(self.model, self.data, self.tip)

    def solve(self, *given: Any) -> tuple[Array | None, int]:
        target, q = given
        for _ in range(STARTS):
            for _ in range(50):
                error = self.pin.log6(self.pose(q).actInv(target)).vector
                square = error @ error
                if square < ERROR**2:
                    return q, 1
                J = self.pin.computeFrameJacobian(self.model, self.data, q, self.tip, self.pin.LOCAL)
                step = J.T @ np.linalg.solve(J @ J.T + (0.01 * square + 1e-9) * np.eye(6), error)
                step *= min(1.0, 1.0 / np.abs(step).max())
                q = q + step - self.turn * np.round((q + step) / self.turn)
                q = np.clip(q, self.problem.lower, self.problem.upper)
            q = self.problem.start()
        return None, 0


class Roboplan:
    """SimpleIk of roboplan. Its default step, 0.25, needs more iterations than a step of 1."""

    def __init__(self, problem: Problem) -> None:
        import roboplan.core as core
        import roboplan.simple_ik as ik

        self.core = core
        scene = core.Scene("arm", core.loadUrdfSceneDescription(problem.urdf))
        self.names = [f"joint{i + 1}" for i in range(len(problem.lower))]
        bounds = {"max_linear_error_norm": ERROR, "max_angular_error_norm": ERROR, "max_time": SECONDS}
        options = ik.SimpleIkOptions("", max_restarts=STARTS, step_size=1.0, check_collisions=False, **bounds)
        self.solver, self.scene = ik.SimpleIk(scene, options), scene

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        goal = self.core.CartesianConfiguration("link0", "tip", np.asfortranarray(target))
        return goal, self.core.JointConfiguration(self.names, start), self.core.JointConfiguration()

    def solve(self, *given: Any) -> tuple[Array | None, int]:
        return counted(given[2].positions if self.solver.solveIk(*given) else None)


class IkPy:
    """IKPy (scipy.optimize.least_squares), with random starts in Python."""

    def __init__(self, problem: Problem) -> None:
        from ikpy.chain import Chain

        mask = [False] + [True] * len(problem.lower) + [False]
        self.chain = Chain.from_urdf_file(problem.urdf, ["link0"], active_links_mask=mask)
        self.problem = problem

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return target, start

    def solve(self, *given: Any) -> tuple[Array | None, int]:
        target, start = given
        end = time.perf_counter() + 100 * SECONDS
        while time.perf_counter() < end:
            padded = np.concatenate([[0.0], start, [0.0]])
            found = self.chain.inverse_kinematics_frame(target, padded, orientation_mode="all", tol=1e-14)
            if np.abs(self.chain.forward_kinematics(found) - target).max() < ERROR:
                return found[1:-1], 1
            start = self.problem.start()
        return None, 0


class Eaik:
    """EAIK: all answers of an arm with six joints, in closed form. EAIK does not read the tip of the URDF."""

    def __init__(self, problem: Problem) -> None:
        from eaik.IK_URDF import UrdfRobot

        self.robot, self.problem = UrdfRobot(problem.urdf), problem
        self.tool = np.linalg.solve(problem.home, self.robot.fwdKin(np.zeros(6)))

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return (target @ self.tool,)

    def solve(self, *given: Any) -> tuple[Array | None, int]:
        found = self.robot.IK(given[0])
        inside = [self.problem.inside(q) for q, estimate in zip(found.Q, found.is_LS) if not estimate]
        answers = [q for q in inside if q is not None]
        return (answers[0], len(answers)) if answers else (None, 0)


class Ssik:
    """ssik with the code of `ssik build`: the answer nearest to the start."""

    most: int | None = 1

    def __init__(self, problem: Problem) -> None:
        path = Path(problem.urdf).with_name(f"{problem.name}_ssik.py")
        command = [str(Path(sys.executable).with_name("ssik")), "build", problem.urdf, "--base", "link0", "--ee", "tip"]
        subprocess.run([*command, "--no-validate", "--out", str(path)], check=True, capture_output=True)
        spec = importlib.util.spec_from_file_location("arm", path)
        assert spec and spec.loader
        self.arm = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(self.arm)

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return target, start

    def solve(self, *given: Any) -> tuple[Array | None, int]:
        found = self.arm.solve(given[0], q_seed=given[1], max_solutions=self.most)
        return (found[0].q, len(found)) if found else (None, 0)


class SsikAll(Ssik):
    """ssik: all answers, for arms with seven joints at samples of the redundancy."""

    most = None


class Frankik:
    """frankik for Panda and FR3, in closed form at samples of joint 7. For FR3, its ranges are smaller."""

    def __init__(self, problem: Problem) -> None:
        import frankik

        self.frankik, self.fr3 = frankik, problem.name == "fr3"

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return target, start, self.fr3, STARTS, 360.0, True

    def solve(self, *given: Any) -> tuple[Array | None, int]:
        answers = [q for q in self.frankik.ik_sample_q7(*given) if not np.isnan(q).any()]
        return (answers[0], len(answers)) if answers else (None, 0)


def forward(problem: Problem, out: str) -> None:
    """Add the poses of the answers, by Pinocchio, to the answer file."""
    arm, file = Pinocchio(problem), dict(np.load(out))
    poses = [np.full((4, 4), np.nan) if np.isnan(q).any() else arm.pose(q).homogeneous for q in file["q"]]
    np.savez(out, **{**file, "poses": np.array(poses)})


def main() -> None:
    name, path, out, count, cores = sys.argv[1:]
    problem = Problem(path)
    if name == "forward":
        return forward(problem, out)
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[-int(cores) :])
    solver: Solver = globals()[name](problem)
    pairs = list(zip(problem.targets, problem.starts))[: int(count)]
    solver.solve(*solver.prepare(*pairs[0]))
    q, times, found = np.full((len(pairs), len(problem.lower)), np.nan), [], []
    for i, (target, start) in enumerate(pairs):
        given = solver.prepare(target, start)
        before = time.perf_counter()
        answer, answers = solver.solve(*given)
        times.append(time.perf_counter() - before)
        found.append(answers)
        if answer is not None:
            q[i] = answer
    np.savez(out, q=q, times=np.array(times), found=np.array(found))


if __name__ == "__main__":
    main()
