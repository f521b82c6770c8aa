"""Inverse kinematics by fpbm_cpp and other libraries: `python bench/inverse_peers.py [--count 500]` prints a table.

For each arm, the targets are poses of random postures, and the starts are other random postures. All libraries read
the same URDF of the preset. In this URDF, the range of a joint that can turn more than once is [-pi, pi]. Each library
is installed from PyPI into its own virtual environment, and runs in its own process, which calls the library once for
each target. KDL is the Debian package python3-pykdl, for the Python of Debian.

A problem is solved if the answer has errors of at most 1e-6 m and 1e-6 rad by the forward kinematics of fpbm_cpp and
of Pinocchio, and is inside the joint ranges. Answers of joints that can turn more than once are compared modulo 2 pi.
The times contain the calls alone, and also contain the problems without an answer. The rows "two threads" use two
processor cores. All other rows use a single core.
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from stack_peers import HERE, Environment, processor, table
from stack_solvers import rpy

import fpbm_cpp as fp

Array = NDArray[np.float64]

ARMS = ("panda", "fr3", "iiwa14", "gen3", "ur5e", "xarm7")
TOLERANCE = 1e-6  # Of the position [m] and of the rotation [rad].
SETUP_TIMEOUT, CALL_TIMEOUT = 1200.0, 0.5  # Of a worker [s]: preparation, and each problem.


class Row(NamedTuple):
    """A row of the table: a class of inverse_worker.py and its options."""

    solver: str
    packages: tuple[str, ...]
    arms: tuple[str, ...] = ARMS
    most: int = 10**9  # Largest number of problems.
    cores: int = 1


TOOLBOX = ("roboticstoolbox-python", "numpy<2", "setuptools<80")
SIX_AXES = ("ur5e",)
ROWS = {
    "OptIK": Row("Optik", ("optik-py", "numpy")),
    "TRAC-IK": Row("TracIk", ("pytracik",)),
    "TRAC-IK, two threads": Row("TracIk", ("pytracik",), cores=2),
    "Robotics Toolbox, ik_LM": Row("Toolbox", TOOLBOX),
    "KDL, LMA": Row("KdlLma", ("numpy",)),
    "KDL, NR_JL": Row("KdlNewton", ("numpy",)),
    "Pinocchio, LM in Python": Row("Pinocchio", ("pin",)),
    "IKPy": Row("IkPy", ("ikpy",), most=20),
    "EAIK": Row("Eaik", ("EAIK",), SIX_AXES),
    "ssik": Row("Ssik", ("ssik[urdf]",)),
    "frankik": Row("Frankik", ("frankik",), ("panda", "fr3")),
}
HEADS = ["", "problems", "solved", "solved [%]", "mean [µs]", "median [µs]", "p99 [µs]", "wrong answers", "branches"]


class Problem(NamedTuple):
    arm: fp.SerialArm
    urdf: Path
    lower: Array
    upper: Array
    turns: NDArray[np.bool_]  # Joints that can turn more than once.
    targets: Array
    starts: Array


def urdf(arm: fp.SerialArm, lower: Array, upper: Array) -> str:
    def origin(frame: Array) -> str:
        numbers = [" ".join(repr(float(v)) for v in values) for values in (frame[:3, 3], rpy(frame[:3, :3]))]
        return f'<origin xyz="{numbers[0]}" rpy="{numbers[1]}"/>'

    names = [f"link{i}" for i in range(arm.dof + 1)] + ["tip"]
    parts = [f'<link name="{name}"/>' for name in names]
    for i, joint in enumerate(arm.joints):
        axis = " ".join(repr(float(v)) for v in joint.axis)
        limit = f'lower="{lower[i]!r}" upper="{upper[i]!r}" velocity="{arm.limits.velocity[i]!r}" effort="100"'
        ends = f'<parent link="link{i}"/><child link="link{i + 1}"/><axis xyz="{axis}"/><limit {limit}/>'
        parts.append(f'<joint name="joint{i + 1}" type="revolute">{origin(np.asarray(joint.placement))}{ends}</joint>')
    ends = f'<parent link="link{arm.dof}"/><child link="tip"/>'
    parts.append(f'<joint name="tip_joint" type="fixed">{origin(np.asarray(arm.tip))}{ends}</joint>')
    return f'<robot name="arm">{"".join(parts)}</robot>'.replace("np.float64(", "").replace(')"', '"')


def problem(folder: Path, name: str, count: int, seed: int) -> Problem:
    """Draw the problems of an arm, and write problem files for the workers."""
    arm = fp.SerialArm.preset(name)
    lower, upper = (np.array(each, dtype=float) for each in (arm.limits.lower, arm.limits.upper))
    turns = upper - lower > 2 * np.pi
    lower[turns], upper[turns] = -np.pi, np.pi
    path = folder / f"{name}.urdf"
    path.write_text(urdf(arm, lower, upper))
    random = np.random.default_rng([seed, ARMS.index(name)])
    postures, starts = random.uniform(lower, upper, (2, count, arm.dof))
    targets = np.array([arm.forward(q) for q in postures])
    frames = {"frames": [joint.placement for joint in arm.joints], "tip": arm.tip, "home": arm.forward(np.zeros(arm.dof))}
    given = {"targets": targets, "starts": starts, "lower": lower, "upper": upper, "urdf": str(path), "name": name}
    np.savez(folder / f"{name}.npz", **given, **frames)
    return Problem(arm, path, lower, upper, turns, targets, starts)


class Answers(NamedTuple):
    q: Array  # NaN: no answer.
    times: Array  # Of each call [s].
    found: Array  # Number of answers of each call.


def solve_ours(given: Problem) -> Answers:
    """The answers of fpbm_cpp, of the arm of the same URDF."""
    arm = fp.SerialArm.from_urdf(given.urdf, "tip")
    arm.inverse(given.targets[0], given.starts[0])
    q, times, found = np.full(given.starts.shape, np.nan), [], []
    for i, (target, start) in enumerate(zip(given.targets, given.starts)):
        before = time.perf_counter()
        answer = arm.inverse(target, start)
        times.append(time.perf_counter() - before)
        found.append(int(answer.solved))
        if answer.solved:
            q[i] = answer.q
    return Answers(q, np.array(times), np.array(found))


def errors(poses: Array, targets: Array) -> Array:
    """The larger error of position [m] and rotation [rad] of each pose."""
    position = np.linalg.norm(poses[:, :3, 3] - targets[:, :3, 3], axis=1)
    chord = np.linalg.norm((poses - targets)[:, :3, :3], axis=(1, 2)) / np.sqrt(8)
    return np.maximum(position, 2 * np.arcsin(np.minimum(chord, 1)))


def row(name: str, given: Problem, answers: Answers, poses: Array) -> list[str]:
    count = len(answers.q)
    q = np.where(given.turns, (answers.q + np.pi) % (2 * np.pi) - np.pi, answers.q)
    inside = np.all((q >= given.lower - 1e-9) & (q <= given.upper + 1e-9), axis=1)
    ours = np.array([given.arm.forward(each) if np.isfinite(each).all() else poses[i] for i, each in enumerate(q)])
    error = np.maximum(errors(poses, given.targets[:count]), errors(ours, given.targets[:count]))
    solved, answered = inside & (error <= TOLERANCE), np.isfinite(answers.q).all(axis=1)
    times = 1e6 * answers.times
    return [
        name,
        f"{count}",
        f"{solved.sum()}",
        f"{100 * solved.mean():.1f}",
        *(f"{value:.1f}" for value in (times.mean(), np.median(times), np.percentile(times, 99))),
        f"{(answered & ~solved).sum()}",
        f"{np.median(answers.found[answered]) if answered.any() else 0:.0f}",
    ]
