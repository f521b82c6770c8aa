"""Inverse kinematics by fpbm_cpp and other libraries: `python bench/inverse_peers.py [--count 500]` prints tables.

For each arm, the targets are poses of random postures, and the starts are other random postures. All libraries read
the same URDF, of the preset. In this URDF, the range of a joint with more than one turn is [-pi, pi]. Each library is
installed from PyPI into its own virtual environment, and solves one target per call in its own process. KDL is from
the Debian package python3-pykdl, and is missing if the version of Python is not the version of Debian.

A problem is solved if the first answer has errors of at most 1e-6 m and 1e-6 rad by the forward kinematics of fpbm_cpp
and of Pinocchio, and all angles are inside the joint ranges. Ranges of [-pi, pi] are modulo 2 pi. The times are of
single calls, also of calls without an answer.
"Wrong": answers that the library returns as solutions, and that fail the check. "Answers": median number per call.

With --write, results/inverse_peers.json stores quantiles of the times, and inverse_chart.py draws the share of problems
that each library solves within a time.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
from pathlib import Path
from typing import Any, NamedTuple

import inverse_chart
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
    "IKPy": Row("ikpy", "IkPy", most=100),
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


def solved(given: Problem, answers: dict[str, Array]) -> Array:
    """Whether each answer is right, also by the poses by Pinocchio if the answers have these poses."""
    count, answered = len(answers["q"]), np.isfinite(answers["q"]).all(axis=1)
    q, targets = given.wrapped(answers["q"])[answered], given.targets[:count][answered]
    arm = fp.SerialArm.preset(given.name)
    right = np.all((q >= given.lower - ROUND_OFF) & (q <= given.upper + ROUND_OFF), axis=1)
    right &= errors(np.reshape([arm.forward(each) for each in q], (-1, 4, 4)), targets) <= TOLERANCE
    if "poses" in answers:
        right &= errors(answers["poses"][answered], targets) <= TOLERANCE
    answered[answered] = right
    return answered


def row(name: str, answers: dict[str, Array], right: Array) -> list[str]:
    times, answered = 1e6 * answers["times"], np.isfinite(answers["q"]).all(axis=1)
    return [
        name,
        f"{len(times)}",
        f"{100 * right.sum() / len(times):.1f}",
        f"{(answered & ~right).sum()}",
        *(f"{value:.1f}" for value in (times.mean(), np.median(times), np.percentile(times, 99))),
        f"{np.median(answers['found'][answered]) if answered.any() else 0:.0f}",
    ]


def curve(answers: dict[str, Array], right: Array) -> dict[str, Any]:
    """The share of solved problems, and the percentiles of the times of these problems [µs]."""
    times = 1e6 * answers["times"][right]
    percentiles = np.percentile(times, np.arange(101)) if len(times) else []
    return {"problems": len(right), "solved": right.mean(), "percentiles": [round(each, 2) for each in percentiles]}


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
    parser.add_argument("--write", action="store_true", help=f"also write {inverse_chart.FILE.name} and its figure")
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

    machine = f"{processor()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}"
    print(f"{machine}, {options.count} problems of each arm")
    try:
        versions.append("kdl: " + call("dpkg-query", "--show", "python3-pykdl").strip().replace("\t", " "))
    except (subprocess.SubprocessError, OSError) as error:
        missing.append(f"python3-pykdl: {error}")
    print("\n".join(versions))
    curves: dict[str, dict[str, Any]] = {}
    for arm in options.arms:
        given = problem(folder / "problems", arm, options.count, options.seed)
        found = {"fpbm_cpp": checked(given, solve_ours(given))}
        for name, each in ROWS.items():
            if arm not in each.arms or each.environment not in environments:
                continue
            try:
                answers = run(each.environment, each.solver, given, min(each.most, options.count), each.cores)
                found[name] = checked(given, answers)
            except subprocess.SubprocessError as error:
                missing.append(f"{name}, {arm}: {reason(error)}")
        right = {name: solved(given, answers) for name, answers in found.items()}
        rows = [row(name, answers, right[name]) for name, answers in found.items()]
        curves[arm] = {name: curve(answers, right[name]) for name, answers in found.items()}
        print("\n".join([f"\n{arm}", *table(HEADS, rows)[:-1]]), flush=True)
    print("\n".join(f"Missing: {each}" for each in missing))
    if options.write:
        inverse_chart.FILE.write_text(json.dumps({"machine": machine, "versions": versions, "arms": curves}) + "\n")
        inverse_chart.draw()


if __name__ == "__main__":
    main()
