"""Inverse kinematics by one library. bench/inverse_peers.py runs this file for each library and each arm.

`inverse_worker.py SOLVER PROBLEM.npz ANSWER.npz N C` solves the first N problems of the file on C processor cores.
The answer file contains the first answer of each call (NaN: no answer), the time [s], and the number of answers. On one
core, the time is the processor time, which is independent of other processes. With "forward" as SOLVER, this file adds
the poses of the answers by Pinocchio. A call has at most 256 starts, or 50 ms.
"""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STARTS, SECONDS = 256, 0.05
ERROR = 9e-7  # Largest error in the norm of a solver, below the tolerance of the check, 1e-6.
# TRAC-IK bounds each component and differentiates numerically. Larger: more answers with errors above 1e-6. Smaller:
# longer times and fewer answers. `inverse_peers.py --arms fr3 gen3` with 1e-6, 1e-7, 1e-8 and 1e-9 prints the shares.
TRAC_IK_ERROR = 1e-7


class Problem:
    """The arm, the targets and the starts of a problem file."""

    def __init__(self, path: Path) -> None:
        file = np.load(path)
        self.path, self.name, self.urdf = path, str(file["name"]), str(file["urdf"])
        self.targets, self.starts = file["targets"], file["starts"]
        self.lower, self.upper = file["lower"], file["upper"]
        self.turns = self.upper - self.lower > 6.28  # Joints without bounds, except the range of the angle.
        self.frames = file["frames"]  # Placements of the joints and of the tip, each in the frame before.
        self.home = file["home"]  # Pose of the tip if all angles are zero.
        self.random = np.random.default_rng(0)

    def wrapped(self, q: Array) -> Array:
        """The posture with the angles of full turns in [-pi, pi]."""
        return np.where(self.turns, q - 2 * np.pi * np.round(q / (2 * np.pi)), q)

    def inside(self, q: Array) -> Array | None:
        """The posture with each angle in the range of the joint, or None."""
        q = q - 2 * np.pi * np.ceil((q - self.upper) / (2 * np.pi))
        return q if np.all(q >= self.lower) else None


class Solver:
    """A library for the arm of a problem."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.build(problem)

    def build(self, problem: Problem) -> None:
        raise NotImplementedError

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        """The arguments of solve() in types of the library. The time of a call does not contain this conversion."""
        return target, start

    def solve(self, *given: Any) -> Sequence[Any]:
        """The answers; the first answer is checked."""
        raise NotImplementedError

    def restarted(self, search: Callable[[Array], Array | None], start: Array) -> Sequence[Any]:
        """The first answer of a search from the start, or from random starts."""
        for _ in range(STARTS):
            if (q := search(start)) is not None:
                return [q]
            start = self.problem.random.uniform(self.problem.lower, self.problem.upper)
        return []


class Ours(Solver):
    """fpbm_cpp."""

    def build(self, problem: Problem) -> None:
        import fpbm_cpp as fp

        self.arm: Any = fp.SerialArm.from_urdf(problem.urdf, "tip")

    def solve(self, *given: Any) -> Sequence[Any]:
        found = self.arm.inverse(*given)
        return [found.q] if found.solved else []


class Optik(Solver):
    """OptIK on one thread. tol_f bounds the square of the error."""

    def build(self, problem: Problem) -> None:
        import optik

        self.robot = optik.Robot.from_urdf_file(problem.urdf, "link0", "tip")
        self.robot.set_parallelism(1)
        self.config = optik.SolverConfig("speed", max_time=0.0, max_restarts=STARTS, tol_f=ERROR**2)

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return self.config, target.tolist(), start.tolist()

    def solve(self, *given: Any) -> Sequence[Any]:
        found = self.robot.ik(*given)
        return [found[0]] if found else []


class TracIk(Solver):
    """TRAC-IK, which stops by time, and always has two threads: Newton's method of KDL, and SQP of NLopt."""

    def build(self, problem: Problem) -> None:
        from trac_ik import TracIK

        self.robot = TracIK("link0", "tip", problem.urdf, timeout=SECONDS, epsilon=TRAC_IK_ERROR)
        self.robot.joint_limits = problem.lower, problem.upper  # TRAC-IK rounds the ranges of the URDF to float.

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return target[:3, 3], target[:3, :3], start

    def solve(self, *given: Any) -> Sequence[Any]:
        found = self.robot.ik(*given)
        return [] if found is None else [found]


class Toolbox(Solver):
    """ik_LM of the Robotics Toolbox, in C++. The tolerance bounds half of the square of the error."""

    def build(self, problem: Problem) -> None:
        import roboticstoolbox as rtb

        self.ets = rtb.Robot.URDF(problem.urdf).ets(start="link0", end="tip")

    def solve(self, *given: Any) -> Sequence[Any]:
        found = self.ets.ik_LM(*given, slimit=STARTS, tol=ERROR**2 / 2, joint_limits=True)
        return [found.q] if found.success else []


class KdlLma(Solver):
    """Levenberg-Marquardt method of KDL, with random starts in Python. This method does not know the joint ranges."""

    def build(self, problem: Problem) -> None:
        sys.path.append("/usr/lib/python3/dist-packages")  # Folder of the Debian package python3-pykdl.
        import PyKDL

        kdl = self.kdl = PyKDL
        self.chain, self.out = kdl.Chain(), kdl.JntArray(len(problem.lower))
        for i, pose in enumerate(problem.frames):
            self.chain.addSegment(kdl.Segment(kdl.Joint(kdl.Joint.RotZ) if i else kdl.Joint(), self.frame(pose)))
        self.solver = self.method()

    def method(self) -> Any:
        return self.kdl.ChainIkSolverPos_LMA(self.chain, np.ones(6), ERROR, 100)

    def frame(self, pose: Array) -> Any:
        return self.kdl.Frame(self.kdl.Rotation(*pose[:3, :3].ravel()), self.kdl.Vector(*pose[:3, 3]))

    def joints(self, q: Array) -> Any:
        joints = self.kdl.JntArray(len(q))
        for i, angle in enumerate(q):
            joints[i] = angle
        return joints

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return self.frame(target), start

    def solve(self, *given: Any) -> Sequence[Any]:
        def search(start: Array) -> Array | None:
            if self.solver.CartToJnt(self.joints(start), given[0], self.out) < 0:
                return None
            return self.problem.inside(np.array([self.out[i] for i in range(len(start))]))

        return self.restarted(search, given[1])


class KdlNewton(KdlLma):
    """Newton's method of KDL with joint ranges, with random starts in Python."""

    def method(self) -> Any:
        kdl, ends = self.kdl, [self.joints(each) for each in (self.problem.lower, self.problem.upper)]
        self.parts = kdl.ChainFkSolverPos_recursive(self.chain), kdl.ChainIkSolverVel_pinv(self.chain)
        return kdl.ChainIkSolverPos_NR_JL(self.chain, *ends, *self.parts, 100, ERROR / 2)


class Pinocchio(Solver):
    """Levenberg-Marquardt method in Python, with kinematics by Pinocchio. The damping decreases with the error."""

    def build(self, problem: Problem) -> None:
        import pinocchio as pin

        self.pin = pin
        self.model = pin.buildModelFromUrdf(problem.urdf)
        self.data = self.model.createData()
        self.tip = self.model.getFrameId("tip")

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return self.pin.SE3(target), start

    def pose(self, q: Array) -> Any:
        self.pin.forwardKinematics(self.model, self.data, q)
        return self.pin.updateFramePlacement(self.model, self.data, self.tip)

    def solve(self, *given: Any) -> Sequence[Any]:
        def search(q: Array) -> Array | None:
            for _ in range(50):
                error = self.pin.log6(self.pose(q).actInv(given[0])).vector
                if (square := error @ error) < ERROR**2:
                    return q
                J = self.pin.computeFrameJacobian(self.model, self.data, q, self.tip, self.pin.LOCAL)
                step = J.T @ np.linalg.solve(J @ J.T + (0.01 * square + 1e-9) * np.eye(6), error)
                q = self.problem.wrapped(q + step * min(1.0, 1.0 / np.abs(step).max()))
                q = np.clip(q, self.problem.lower, self.problem.upper)
            return None

        return self.restarted(search, given[1])


class Roboplan(Solver):
    """SimpleIk of roboplan. A step of 1 instead of 0.25, the default, converges within the time of a call."""

    def build(self, problem: Problem) -> None:
        import roboplan.core as core
        import roboplan.simple_ik as ik

        self.core, self.scene = core, core.Scene("arm", core.loadUrdfSceneDescription(problem.urdf))
        self.names = [f"joint{i + 1}" for i in range(len(problem.lower))]
        bounds = {"max_linear_error_norm": ERROR, "max_angular_error_norm": ERROR, "max_time": SECONDS}
        options = ik.SimpleIkOptions("", max_restarts=STARTS, step_size=1.0, check_collisions=False, **bounds)
        self.solver = ik.SimpleIk(self.scene, options)

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        goal = self.core.CartesianConfiguration("link0", "tip", np.asfortranarray(target))
        return goal, self.core.JointConfiguration(self.names, start), self.core.JointConfiguration()

    def solve(self, *given: Any) -> Sequence[Any]:
        return [given[2].positions] if self.solver.solveIk(*given) else []


class IkPy(Solver):
    """IKPy, which calls scipy.optimize.least_squares, with random starts in Python."""

    def build(self, problem: Problem) -> None:
        from ikpy.chain import Chain

        mask = [False, *(True for _ in problem.lower), False]
        self.chain = Chain.from_urdf_file(problem.urdf, ["link0"], active_links_mask=mask)

    def solve(self, *given: Any) -> Sequence[Any]:
        def search(start: Array) -> Array | None:
            start = np.concatenate([[0.0], start, [0.0]])
            q = self.chain.inverse_kinematics_frame(given[0], start, orientation_mode="all", tol=1e-14)
            return q[1:-1] if np.linalg.norm(self.chain.forward_kinematics(q) - given[0]) < ERROR else None

        return self.restarted(search, given[1])


class Eaik(Solver):
    """EAIK: all answers of an arm with six joints, in closed form. EAIK does not read the tip of the URDF."""

    def build(self, problem: Problem) -> None:
        from eaik.IK_URDF import UrdfRobot

        self.robot = UrdfRobot(problem.urdf)
        self.tool = np.linalg.solve(problem.home, self.robot.fwdKin(np.zeros(6)))

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return (target @ self.tool,)

    def solve(self, *given: Any) -> Sequence[Any]:
        found = self.robot.IK(given[0])
        inside = (self.problem.inside(q) for q, estimate in zip(found.Q, found.is_LS) if not estimate)
        return [q for q in inside if q is not None]


class Ssik(Solver):
    """ssik with the code that `ssik build` writes for the arm: the answer nearest to the start."""

    most: int | None = 1

    def build(self, problem: Problem) -> None:
        path = Path(problem.urdf).with_name(f"{problem.name}_ssik.py")
        command = [str(Path(sys.executable).with_name("ssik")), "build", problem.urdf, "--base", "link0", "--ee", "tip"]
        subprocess.run([*command, "--no-validate", "--out", str(path)], check=True, stdout=sys.stderr)
        spec = importlib.util.spec_from_file_location("built_arm", path)
        assert spec is not None
        assert spec.loader is not None
        self.arm = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(self.arm)

    def solve(self, *given: Any) -> Sequence[Any]:
        return [each.q for each in self.arm.solve(given[0], q_seed=given[1], max_solutions=self.most)]


class SsikAll(Ssik):
    """ssik: all answers. If the arm has seven joints, these are the answers at samples of the redundancy."""

    most = None


class Frankik(Solver):
    """frankik for Panda and FR3: all answers in closed form at samples of joint 7. The FR3 has smaller ranges."""

    def build(self, problem: Problem) -> None:
        import frankik

        self.frankik, self.fr3 = frankik, problem.name == "fr3"

    def prepare(self, target: Array, start: Array) -> tuple[Any, ...]:
        return target, start, self.fr3, STARTS, 360.0, True

    def solve(self, *given: Any) -> Sequence[Any]:
        return [q for q in self.frankik.ik_sample_q7(*given) if not np.isnan(q).any()]


def measured(solver: Solver, count: int, cores: int) -> dict[str, Array]:
    """Answers and times of the first problems."""
    problem, before = solver.problem, os.sched_getaffinity(0)
    now = time.process_time if cores == 1 else time.perf_counter
    q, times, found = np.full(problem.starts[:count].shape, np.nan), np.zeros(count), np.zeros(count)
    os.sched_setaffinity(0, sorted(before)[-cores:])
    solver.solve(*solver.prepare(problem.targets[0], problem.starts[0]))  # Imports and caches.
    for i in range(count):
        given = solver.prepare(problem.targets[i], problem.starts[i])
        start = now()
        answers = solver.solve(*given)
        times[i], found[i] = now() - start, len(answers)
        if answers:
            q[i] = answers[0]
    os.sched_setaffinity(0, before)
    return {"q": q, "times": times, "found": found}


def poses(problem: Problem, q: Array) -> Array:
    """The poses of the answers by Pinocchio."""
    arm = Pinocchio(problem)
    return np.array([np.full((4, 4), np.nan) if np.isnan(each).any() else arm.pose(each).homogeneous for each in q])


def main() -> None:
    name, path, out, count, cores = sys.argv[1:]
    problem = Problem(Path(path))
    if name == "forward":
        answers = dict(np.load(out))
        answers["poses"] = poses(problem, answers["q"])
    else:
        answers = measured(globals()[name](problem), int(count), int(cores))
    np.savez(out, **answers)


if __name__ == "__main__":
    main()
