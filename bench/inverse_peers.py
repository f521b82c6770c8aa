"""Inverse kinematics by fpbm_cpp and other libraries: `python bench/inverse_peers.py [--count 500]` prints tables.

For each arm, the targets are poses of random postures, and the starts are other random postures. All libraries read
the same URDF, of the preset. In this URDF, the range of a joint with more than one turn is [-pi, pi]. Each library is
installed from PyPI into its own virtual environment, and solves one target per call in its own process. KDL is from
the Debian package python3-pykdl, and is missing if the version of Python is not the version of Debian.

A problem is solved if the first answer has errors of at most 1e-6 m and 1e-6 rad by the forward kinematics of fpbm_cpp
and of Pinocchio, and all angles are inside the joint ranges. Ranges of [-pi, pi] are modulo 2 pi. The times are of
single calls, also of calls without an answer. Each process uses one processor core, except in rows with "2 cores".
"Wrong": answers that the library returns as solutions, and that fail the check. "Answers": median number per call.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
from pathlib import Path
from typing import NamedTuple

import numpy as np
from inverse_worker import Array, Ours, Problem, measured
from stack_peers import HERE, Environment, call, processor, table
from stack_solvers import rpy

import fpbm_cpp as fp

WORK = HERE.parent / "build" / "inverse_peers"
ARMS = ("panda", "fr3", "iiwa14", "gen3", "ur5e", "xarm7")
TOLERANCE = 1e-6  # Largest error of the position [m] and of the rotation [rad].
ROUND_OFF = 1e-9  # Largest excess of an angle beyond its range [rad].
# Packages of each environment. PyKDL does not work with numpy 2.
PACKAGES = {
    "pin": ("pin",),
    "optik": ("optik-py", "numpy"),
    "pytracik": ("pytracik",),
    "toolbox": ("roboticstoolbox-python", "numpy<2", "setuptools<80"),
    "kdl": ("numpy<2",),
    "roboplan": ("roboplan-simple-ik",),
    "ikpy": ("ikpy",),
    "eaik": ("EAIK",),
    "ssik": ("ssik[urdf]",),
    "frankik": ("frankik",),
}


class Row(NamedTuple):
    environment: str
    solver: str  # Class of inverse_worker.py.
    arms: tuple[str, ...] = ARMS
    most: int = 10**9  # Largest number of problems.
    cores: int = 1


ROWS = {
    "OptIK": Row("optik", "Optik"),
    "TRAC-IK, 1 core": Row("pytracik", "TracIk"),
    "TRAC-IK, 2 cores": Row("pytracik", "TracIk", cores=2),
    "Robotics Toolbox, ik_LM": Row("toolbox", "Toolbox"),
    "KDL, LMA": Row("kdl", "KdlLma"),
    "KDL, NR_JL": Row("kdl", "KdlNewton", most=100),
    "Pinocchio, loop in Python": Row("pin", "Pinocchio"),
    "roboplan, SimpleIk": Row("roboplan", "Roboplan"),
    "IKPy": Row("ikpy", "IkPy", most=20),
    "EAIK": Row("eaik", "Eaik", ("ur5e",)),
    "ssik, nearest answer": Row("ssik", "Ssik"),
    "ssik, all answers": Row("ssik", "SsikAll"),
    "frankik, all answers": Row("frankik", "Frankik", ("panda", "fr3")),
}
HEADS = ["", "problems", "solved [%]", "wrong", "mean [µs]", "median [µs]", "p99 [µs]", "answers"]


def urdf(arm: fp.SerialArm, lower: Array, upper: Array) -> str:
    def text(values: Array | tuple[float, ...]) -> str:
        return " ".join(repr(float(value)) for value in values)

    def joint(name: str, kind: str, frame: Array, parent: str, child: str, more: str = "") -> str:
        origin = f'<origin xyz="{text(frame[:3, 3])}" rpy="{text(rpy(frame[:3, :3]))}"/>'
        ends = f'<parent link="{parent}"/><child link="{child}"/>'
        return f'<joint name="{name}" type="{kind}">{origin}{ends}{more}</joint>'

    parts = [f'<link name="link{i}"/>' for i in range(arm.dof + 1)] + ['<link name="tip"/>']
    for i, each in enumerate(arm.joints):
        ends = f'lower="{float(lower[i])!r}" upper="{float(upper[i])!r}" velocity="{arm.limits.velocity[i]}"'
        more = f'<axis xyz="{text(each.axis)}"/><limit {ends} effort="100"/>'
        frame = np.asarray(each.placement)
        parts.append(joint(f"joint{i + 1}", "revolute", frame, f"link{i}", f"link{i + 1}", more))
    parts.append(joint("tip_joint", "fixed", np.asarray(arm.tip), f"link{arm.dof}", "tip"))
    return f'<robot name="arm">{"".join(parts)}</robot>'


def problem(folder: Path, name: str, count: int, seed: int) -> Problem:
    """The problems of an arm, and their file for the workers."""
    arm = fp.SerialArm.preset(name)
    lower, upper = np.array(arm.limits.lower, dtype=float), np.array(arm.limits.upper, dtype=float)
    turns = upper - lower > 2 * np.pi
    lower[turns], upper[turns] = -np.pi, np.pi
    path = folder / f"{name}.npz"
    path.with_suffix(".urdf").write_text(urdf(arm, lower, upper))
    postures, starts = np.random.default_rng([seed, ARMS.index(name)]).uniform(lower, upper, (2, count, arm.dof))
    np.savez(
        path,
        name=name,
        urdf=str(path.with_suffix(".urdf")),
        targets=[arm.forward(q) for q in postures],
        starts=starts,
        lower=lower,
        upper=upper,
        frames=[*(joint.placement for joint in arm.joints), arm.tip],
        home=arm.forward(np.zeros(arm.dof)),
    )
    return Problem(path)


def solve_ours(given: Problem) -> dict[str, Array]:
    """The answers of fpbm_cpp, of the arm of the same URDF."""
    return measured(Ours(given), len(given.starts), 1)


def errors(poses: Array, targets: Array) -> Array:
    """The larger error of position [m] and rotation [rad] of each pose."""
    position = np.linalg.norm(poses[:, :3, 3] - targets[:, :3, 3], axis=1)
    chord = np.linalg.norm((poses - targets)[:, :3, :3], axis=(1, 2)) / np.sqrt(8)
    larger: Array = np.maximum(position, 2 * np.arcsin(np.minimum(chord, 1)))
    return larger


def row(name: str, given: Problem, answers: dict[str, Array]) -> list[str]:
    """Check the answers, also the poses by Pinocchio if the answers have these poses."""
    count, answered = len(answers["q"]), np.isfinite(answers["q"]).all(axis=1)
    q, targets = given.wrapped(answers["q"])[answered], given.targets[:count][answered]
    arm = fp.SerialArm.preset(given.name)
    right = np.all((q >= given.lower - ROUND_OFF) & (q <= given.upper + ROUND_OFF), axis=1)
    right &= errors(np.reshape([arm.forward(each) for each in q], (-1, 4, 4)), targets) <= TOLERANCE
    if "poses" in answers:
        right &= errors(answers["poses"][answered], targets) <= TOLERANCE
    times = 1e6 * answers["times"]
    return [
        name,
        f"{count}",
        f"{100 * right.sum() / count:.1f}",
        f"{(~right).sum()}",
        *(f"{value:.1f}" for value in (times.mean(), np.median(times), np.percentile(times, 99))),
        f"{np.median(answers['found'][answered]) if answered.any() else 0:.0f}",
    ]


def reason(error: subprocess.SubprocessError) -> str:
    """The last line of the output of a process that failed."""
    lines = (error.stderr or "").strip().splitlines() if isinstance(error, subprocess.CalledProcessError) else []
    return lines[-1] if lines else str(error)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=500, help="problems of each arm")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--arms", nargs="*", default=ARMS, metavar="ARM")
    parser.add_argument("--skip", nargs="*", default=[], metavar="ENVIRONMENT", help=", ".join(PACKAGES))
    parser.add_argument(
        "--work", type=Path, default=HERE.parent / "build" / "inverse_peers", help="for installed peers"
    )
    options = parser.parse_args()

    folder = options.work.resolve()
    (folder / "problems").mkdir(parents=True, exist_ok=True)
    threads = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "RAYON")}
    environment = {**os.environ, **threads, "PYTHONDONTWRITEBYTECODE": "1", "PYTHONWARNINGS": "ignore"}
    environments, versions, missing = {}, [], []
    for name, packages in PACKAGES.items():
        if name in options.skip:
            continue
        try:
            environments[name] = Environment(folder / name, packages)
            names = tuple(re.split(r"[\[<]", package)[0] for package in packages)
            versions.append(f"{name}: {environments[name].versions(names)}")
        except subprocess.SubprocessError as error:
            missing.append(f"{name}: {reason(error)}")

    def run(name: str, solver: str, given: Problem, count: int, cores: int = 1) -> dict[str, Array]:
        out = given.path.with_name(f"{given.name}_answers.npz")
        command = environments[name].python, HERE / "inverse_worker.py", solver, given.path, out, str(count), str(cores)
        call(*command, env=environment, stderr=subprocess.PIPE, timeout=600 + count)
        return dict(np.load(out))

    def checked(given: Problem, answers: dict[str, Array]) -> dict[str, Array]:
        if "pin" not in environments:
            return answers
        np.savez(given.path.with_name(f"{given.name}_answers.npz"), allow_pickle=False, **answers)
        return run("pin", "forward", given, len(answers["q"]))

    print(f"{processor()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, {options.count} problems of each arm")
    try:
        versions.append("kdl: " + call("dpkg-query", "--show", "python3-pykdl").strip().replace("\t", " "))
    except (subprocess.SubprocessError, OSError) as error:
        missing.append(f"python3-pykdl: {error}")
    print("\n".join(versions))
    for arm in options.arms:
        given = problem(folder / "problems", arm, options.count, options.seed)
        rows = [row("fpbm_cpp", given, checked(given, solve_ours(given)))] if hasattr(fp.SerialArm, "inverse") else []
        for name, each in ROWS.items():
            if arm not in each.arms or each.environment not in environments:
                continue
            try:
                answers = run(each.environment, each.solver, given, min(each.most, options.count), each.cores)
                rows.append(row(name, given, checked(given, answers)))
            except subprocess.SubprocessError as error:
                missing.append(f"{name}, {arm}: {reason(error)}")
        print("\n".join([f"\n{arm}", *table(HEADS, rows)[:-1]]), flush=True)
    print("\n".join(f"Missing: {each}" for each in missing))


if __name__ == "__main__":
    main()
