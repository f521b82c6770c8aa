"""Times of a step of each scheme from Python: fpbm_cpp, Pinocchio, the Robotics Toolbox, Pink and Mink, if installed.

Pinocchio and the Robotics Toolbox do not have these schemes. NumPy computes the schemes on the kinematics of these
libraries, by solving linear systems instead of the paper's pseudoinverses. Before the timing, the results are compared
with fpbm_cpp, to 1e-9. Pink and Mink solve a quadratic program for the tip only, without limits. For the small
displacements of the targets, the program equals MVN with feedback, to 1e-3. Each round times all rows in another order.
"""

from __future__ import annotations

import argparse
import gc
import importlib
import json
import random
import time
from collections.abc import Callable, Iterator
from importlib import metadata
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

import fpbm_cpp as fp

Array = NDArray[np.float64]

ALPHA, GAIN, K1, K2 = 0.6, 10.0, 20.0, 100.0
STATES, ROUNDS = 32, 15
MANY = 10_000  # Number of states in one call of fpbm_cpp.


class Case(NamedTuple):
    """An arm with a task. rows: rows of the task in the twist of the tip."""

    arm: fp.SerialArm | fp.PlanarArm
    joints: tuple[fp.Joint, ...]
    tip: Array
    task: str
    rows: slice
    bent: Array


class Input(NamedTuple):
    q: Array
    qd: Array
    x: Array  # Reference in the format of fpbm_cpp.
    target: Array  # Reference as a homogeneous matrix.
    xd: Array
    xdd: Array


# Pose of the tip, J and Jd at (q, qd); Jd is None unless requested.
Kinematics = Callable[[Array, Array, bool], tuple[Array, Array, Any]]


class Peer(Protocol):
    """Kinematics of a library, and x ⊖ y of poses."""

    def __init__(self, case: Case) -> None: ...
    def kinematics(self, q: Array, qd: Array, with_rate: bool) -> tuple[Array, Array, Any]: ...
    def difference(self, x: Array, y: Array) -> Array: ...


def cases() -> Iterator[tuple[str, Case]]:
    shift = np.eye(4)
    shift[0, 3] = 1.0
    links = tuple(fp.Joint(placement=shift if i else np.eye(4)) for i in range(4))
    yield "planar4/position", Case(fp.PlanarArm(np.ones(4)), links, shift, "position", slice(2), np.full(4, 0.6))
    bent = np.array([0.0, -0.3, 0.0, -1.8, 0.0, 1.6, 0.8])
    for name in ("panda", "iiwa14"):
        arm = fp.SerialArm.preset(name)
        yield f"{name}/position", Case(arm, arm.joints, arm.tip, "position", slice(3), bent)
        yield f"{name}/pose", Case(arm, arm.joints, arm.tip, "pose", slice(6), bent)


def inputs(case: Case, *, shifts: bool = False) -> list[Input]:
    """States around a bent posture, and references near the tip. shifts: references at rest, nearer to the tip."""
    rng = np.random.default_rng(1)
    n, m = case.arm.dof, case.rows.stop
    result = []
    for _ in range(STATES):
        q, qd = case.bent + rng.uniform(-0.45, 0.45, n), rng.uniform(-1.0, 1.0, n)
        target = np.eye(4)
        if m == 2:
            target[:2, 3] = case.arm.forward(q)
        else:
            target = case.arm.forward(q)
        reach = 1e-4 if shifts else 0.01
        target[: min(m, 3), 3] += rng.uniform(-reach, reach, min(m, 3))
        if m == 6 and not shifts:
            target[:3, :3] = fp.rotation(rng.uniform(-0.01, 0.01, 3)) @ target[:3, :3]
        x = target if m == 6 else target[:m, 3].copy()
        xd, xdd = (np.zeros(m), np.zeros(m)) if shifts else rng.uniform(-0.5, 0.5, (2, m))
        result.append(Input(q, qd, x, target, xd, xdd))
    return result


def schemes(n: int) -> dict[str, fp.Scheme]:
    w = np.arange(1.0, n + 1.0)
    return {
        "mvn": fp.MVN(k=GAIN),
        "wmvn": fp.WMVN(w, k=GAIN),
        "man": fp.MAN(),
        "wmvn_acceleration": fp.WMVNAcceleration(w),
        "balanced": fp.Balanced(ALPHA, w),
        "fpbm": fp.FPBM(ALPHA, w, K1, K2),
    }


class Pinocchio:
    def __init__(self, case: Case) -> None:
        import pinocchio as pin

        self.pin, self.model, joint = pin, pin.Model(), 0
        for i, link in enumerate(case.joints):
            joint = self.model.addJoint(joint, pin.JointModelRZ(), pin.SE3(np.asarray(link.placement)), f"joint_{i}")
        self.tip = self.model.addFrame(pin.Frame("tip", joint, 0, pin.SE3(case.tip), pin.FrameType.OP_FRAME))
        self.data = self.model.createData()

    def kinematics(self, q: Array, qd: Array, with_rate: bool) -> tuple[Array, Array, Any]:
        pin, model, data, tip = self.pin, self.model, self.data, self.tip
        if not with_rate:
            pin.computeJointJacobians(model, data, q)
            pose = pin.updateFramePlacement(model, data, tip)
            return pose.homogeneous, pin.getFrameJacobian(model, data, tip, pin.LOCAL_WORLD_ALIGNED), None
        pin.computeJointJacobiansTimeVariation(model, data, q, qd)
        return (
            pin.updateFramePlacement(model, data, tip).homogeneous,
            pin.getFrameJacobian(model, data, tip, pin.LOCAL_WORLD_ALIGNED),
            pin.getFrameJacobianTimeVariation(model, data, tip, pin.LOCAL_WORLD_ALIGNED),
        )

    def difference(self, x: Array, y: Array) -> Array:
        return np.concatenate([x[:3, 3] - y[:3, 3], self.pin.log3(x[:3, :3] @ y[:3, :3].T)])


class RoboticsToolbox:
    def __init__(self, case: Case) -> None:
        from roboticstoolbox import ET, ETS
        from roboticstoolbox.tools import angle_axis

        self.angle_axis = angle_axis
        parts = [part for joint in case.joints for part in (ET.SE3(np.asarray(joint.placement)), ET.Rz())]
        self.ets = ETS([*parts, ET.SE3(case.tip)])

    def kinematics(self, q: Array, qd: Array, with_rate: bool) -> tuple[Array, Array, Any]:
        pose, J = self.ets.eval(q), self.ets.jacob0(q)
        return pose, J, np.tensordot(self.ets.hessian0(J0=J), qd, (0, 0)) if with_rate else None

    def difference(self, x: Array, y: Array) -> Array:
        difference: Array = self.angle_axis(y, x)
        return difference


def by_numpy(law: str, case: Case, peer: Peer) -> Callable[[Input], Array]:
    """The scheme in typical NumPy code, on the kinematics of another library."""
    rows, m = case.rows, case.rows.stop
    winv = 1.0 / np.arange(1.0, case.arm.dof + 1.0)
    alpha = {"man": 0.0, "wmvn_acceleration": 1.0}.get(law, ALPHA)

    def error(target: Array, pose: Array) -> Array:
        return peer.difference(target, pose) if m == 6 else target[:m, 3] - pose[:m, 3]

    def velocity(given: Input) -> Array:
        pose, J, _ = peer.kinematics(given.q, given.qd, False)
        J = J[rows]
        v = given.xd + GAIN * error(given.target, pose)
        Jt = J.T if law == "mvn" else winv[:, None] * J.T
        return Jt @ np.linalg.solve(J @ Jt, v)

    def acceleration(given: Input) -> Array:
        pose, J, Jd = peer.kinematics(given.q, given.qd, True)
        J, Jd = J[rows], Jd[rows]
        b = given.xdd - Jd @ given.qd
        if law == "fpbm":
            b += K1 * (given.xd - J @ given.qd) + K2 * error(given.target, pose)
        qdd = np.zeros(case.arm.dof)
        if alpha < 1.0:
            qdd += (1.0 - alpha) * J.T @ np.linalg.solve(J @ J.T, b)
        if alpha > 0.0:
            WinvJt = winv[:, None] * J.T
            gram = J @ WinvJt
            u = alpha * winv * (Jd.T @ np.linalg.solve(gram, given.xd))
            qdd += u + WinvJt @ np.linalg.solve(gram, alpha * b - J @ u)
        return qdd

    return velocity if law in ("mvn", "wmvn") else acceleration


DT = 1.0 / GAIN  # The QP computes a displacement. Divided by DT, this displacement is the velocity of the feedback.
DAMPING = 1e-9


def by_pink(case: Case) -> Callable[[Input], Array]:
    import pink
    import pinocchio as pin

    peer = Pinocchio(case)
    configuration = pink.Configuration(peer.model, peer.data, case.bent)
    turn = 1.0 if case.task == "pose" else 0.0
    task = pink.FrameTask("tip", position_cost=1.0, orientation_cost=turn)

    def step(given: Input) -> Array:
        configuration.update(given.q)
        task.set_target(pin.SE3(given.target))
        qd: Array = pink.solve_ik(configuration, [task], DT, "daqp", damping=DAMPING, limits=[])
        return qd

    return step


def mjcf(case: Case) -> str:
    """The arm as MJCF for MuJoCo."""
    import mujoco

    def place(frame: Array) -> str:
        quaternion = np.empty(4)
        mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(frame[:3, :3]).ravel())
        numbers = [" ".join(repr(float(v)) for v in values) for values in (frame[:3, 3], quaternion)]
        return f'pos="{numbers[0]}" quat="{numbers[1]}"'

    weight = '<geom size="0.01" contype="0" conaffinity="0"/>'
    frames = [place(np.asarray(joint.placement)) for joint in case.joints]
    bodies = "".join(f'<body {frame}><joint axis="0 0 1"/>{weight}' for frame in frames)
    ends = "</body>" * len(case.joints)
    return f'<mujoco><worldbody>{bodies}<site name="tip" {place(case.tip)}/>{ends}</worldbody></mujoco>'


def by_mink(case: Case) -> Callable[[Input], Array]:
    import mink
    import mujoco

    configuration = mink.Configuration(mujoco.MjModel.from_xml_string(mjcf(case)))
    turn = 1.0 if case.task == "pose" else 0.0
    task = mink.FrameTask("tip", "site", position_cost=1.0, orientation_cost=turn)

    def step(given: Input) -> Array:
        configuration.update(given.q)
        task.set_target(mink.SE3.from_matrix(given.target))
        qd: Array = mink.solve_ik(configuration, [task], DT, "daqp", damping=DAMPING, limits=[])
        return qd

    return step


KINEMATICS: dict[str, tuple[str, type[Peer]]] = {
    "pinocchio_numpy": ("pin", Pinocchio),
    "robotics_toolbox": ("roboticstoolbox-python", RoboticsToolbox),
}
PROGRAMS = {"pink": ("pin-pink", by_pink), "mink": ("mink", by_mink)}  # With daqp.
MODULES = {"pin": "pinocchio", "roboticstoolbox-python": "roboticstoolbox", "pin-pink": "pink"}


def version(package: str) -> str:
    """Version of a package; empty if the package is not installed, or cannot be imported."""
    try:
        importlib.import_module(MODULES.get(package, package))
        return metadata.version(package)
    except (ImportError, metadata.PackageNotFoundError):
        return ""


class Row(NamedTuple):
    name: str
    step: Callable[[Input], Array]
    inputs: list[Input]
    states: int = 1  # Number of states per call.


def at_once(ours: Row) -> Row:
    """A row with MANY states in one call. The states of `ours` are repeated."""
    times = -(-MANY // STATES)
    stacked = (np.concatenate([np.stack(each)] * times)[:MANY] for each in zip(*ours.inputs, strict=True))
    row = Row(f"{ours.name}_many", ours.step, [Input(*stacked)], MANY)
    if row.step(row.inputs[0])[:STATES].tobytes() != np.stack([ours.step(each) for each in ours.inputs]).tobytes():
        raise SystemExit(f"{row.name}: the result differs from the result of fpbm_cpp")
    return row


def agreeing(name: str, step: Callable[[Input], Array], ours: Row, tolerance: float) -> Row:
    """The row of another library, after a check that its results equal the results of this library."""
    worst = 0.0
    for given in ours.inputs:
        expected = ours.step(given)
        worst = max(worst, float(np.linalg.norm(step(given) - expected) / np.linalg.norm(expected)))
    if not worst <= tolerance:
        raise SystemExit(f"{name}: the result differs from the result of fpbm_cpp by {worst:.1e}")
    return Row(name, step, ours.inputs)


def rows(installed: set[str]) -> Iterator[Row]:
    for name, case in cases():
        for law, scheme in schemes(case.arm.dof).items():

            def step(given: Input, scheme: fp.Scheme = scheme, case: Case = case) -> Array:
                q, qd, x, _, xd, xdd = given
                return scheme.resolve(case.arm, q, qd, x, xd, xdd, task=case.task)

            def shift(given: Input, scheme: fp.Scheme = scheme, case: Case = case) -> Array:
                return scheme.resolve(case.arm, given.q, given.qd, given.x, given.xd, task=case.task)

            row = f"python/{name}/{law}"
            ours = Row(f"{row}/fpbm_cpp", step, inputs(case))
            yield from (ours, at_once(ours))
            for library, (package, kind) in KINEMATICS.items():
                if package in installed:
                    yield agreeing(f"{row}/{library}", by_numpy(law, case, kind(case)), ours, 1e-9)
            if law == "mvn" and case.rows.stop != 2:
                for library, (package, make) in PROGRAMS.items():
                    if {package, "daqp"} <= installed:
                        shifts = Row(ours.name, shift, inputs(case, shifts=True))
                        yield agreeing(f"{row}/{library}", make(case), shifts, 1e-3)


def timed(row: Row, calls: int) -> float:
    """Time per state [ns]."""
    step, given = row.step, row.inputs
    calls = max(1, calls // row.states)
    begin = time.perf_counter_ns()
    for i in range(calls):
        step(given[i % len(given)])
    return (time.perf_counter_ns() - begin) / (calls * row.states)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, help="also write the times to this JSON file")
    parser.add_argument("--calls", type=int, default=200, help="in a round")
    options = parser.parse_args()

    packages = [package for package, _ in (*KINEMATICS.values(), *PROGRAMS.values())]
    versions = {package: version(package) for package in (*packages, "mujoco", "daqp", "numpy")}
    every = list(rows({package for package, found in versions.items() if found}))
    times: dict[str, list[float]] = {row.name: [] for row in every}
    gc.disable()
    order = random.Random(1)
    for _ in range(ROUNDS):
        order.shuffle(every)
        for row in every:
            times[row.name].append(timed(row, options.calls))
    for name, values in times.items():
        print(f"{name:50} {min(values) / 1e3:9.2f} µs")
    if options.out:
        options.out.write_text(json.dumps({"versions": versions, "times": times}, indent=1))


if __name__ == "__main__":
    main()
