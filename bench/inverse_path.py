"""A long path of a Panda with the fewest reconfigurations: `python bench/inverse_path.py PATH.csv`.

The file has the format of IKLink (https://github.com/uwgraphics/IKLink, `input_trajectories/panda_*.csv`): after the
head, each row is a waypoint of panda_hand: the time [s], the position [m] and the quaternion x, y, z, w.

A part of the path is followed without reconfiguration: between two waypoints, each joint moves at most by its velocity
bound times the time. From each posture at a waypoint, arm.inverse searches postures at the next waypoint, from this
posture and from postures that are displaced at random. Of these postures, one in each cell of a grid is kept, with the
shortest motion. If no posture at the next waypoint is found, the next part begins there with other postures, by
arm.inverse_all. As each part is as long as possible, the number of parts is the least for the postures found.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import fpbm_cpp as fp

Array = NDArray[np.float64]

ARM = fp.SerialArm.preset("panda")
FLANGE = Rotation.from_rotvec([0, 0, np.pi / 4])  # From panda_hand to the flange, in the URDF file of the Panda.
CELL = 0.5  # Size of a cell of the grid, relative to the largest displacement of a joint between two waypoints.


ON_BOUND = 0.01  # Largest distance from an end of the range at which a joint counts as on this end [rad].


class Part(NamedTuple):
    first: int  # Waypoint.
    motion: Array  # Postures at consecutive waypoints [rad], shape (count, 7).
    most: int  # Largest number of postures at a waypoint.


def read(file: Path) -> tuple[Array, Array]:
    """Times [s] and poses of the flange, shapes (n,) and (n, 4, 4)."""
    rows = np.loadtxt(file, delimiter=",", skiprows=1)
    poses = np.tile(np.eye(4), (len(rows), 1, 1))
    poses[:, :3, :3] = (Rotation.from_quat(rows[:, 4:8]) * FLANGE).as_matrix()
    poses[:, :3, 3] = rows[:, 1:4]
    return rows[:, 0], poses


def follow(first: int, times: Array, poses: Array, options: argparse.Namespace, rng: np.random.Generator) -> Part:
    """The longest motion from a waypoint on."""
    found = ARM.inverse_all(poses[first], count=options.postures, starts=4 * options.postures)
    if not found:
        raise SystemExit(f"waypoint {first}: no posture found")
    q, lengths = np.array([each.q for each in found]), np.zeros(len(found))
    postures, parents = [q], []
    for i in range(first + 1, len(poses)):
        most = ARM.limits.velocity * (times[i] - times[i - 1])
        before = np.repeat(q, options.moves, axis=0)
        displaced = rng.uniform(-most, most, before.shape)
        displaced[:: options.moves] = 0.0
        found = ARM.inverse(np.broadcast_to(poses[i], (len(before), 4, 4)), before + displaced, starts=1)
        step = found.q - before
        kept = np.flatnonzero(found.solved & np.all(np.abs(step) <= most, axis=1))
        if not len(kept):
            break
        after = (np.repeat(lengths, options.moves) + np.linalg.norm(step, axis=1))[kept]
        order = np.argsort(after, kind="stable")
        _, unique = np.unique(np.round(found.q[kept[order]] / (CELL * most)), axis=0, return_index=True)
        kept, lengths = kept[order][unique], after[order][unique]
        q = found.q[kept]
        postures.append(q)
        parents.append(kept // options.moves)
    index = int(np.argmin(lengths))
    motion = [postures[-1][index]]
    for q, parent in zip(postures[-2::-1], parents[::-1]):
        index = parent[index]
        motion.append(q[index])
    return Part(first, np.array(motion[::-1]), max(map(len, postures)))


def error(q: Array, pose: Array) -> float:
    """The larger of distance [m] and angle [rad] from a pose."""
    tip = ARM.forward(q)
    turn = Rotation.from_matrix(tip[:3, :3] @ pose[:3, :3].T).magnitude()
    return float(max(np.linalg.norm((tip - pose)[:3, 3]), turn))


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("file", type=Path)
    parser.add_argument("--postures", type=int, default=100, help="largest number of postures at the start of a part")
    parser.add_argument("--moves", type=int, default=4, help="searches from each posture; 1: no displaced postures")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    times, poses = read(options.file)
    rng, begin = np.random.default_rng(options.seed), time.process_time()
    parts: list[Part] = []
    while sum(len(each.motion) for each in parts) < len(poses):
        parts.append(follow(sum(len(each.motion) for each in parts), times, poses, options, rng))
    seconds = time.process_time() - begin
    print(
        "| waypoints | most postures at a waypoint | peak velocity / bound | largest error [m, rad] "
        "| first posture [rad] | joints on an end of the range at the last waypoint |"
    )
    print("|---|---:|---:|---:|---|---|")
    for first, motion, most in parts:
        last = first + len(motion) - 1
        velocity = np.abs(np.diff(motion, axis=0)) / np.diff(times[first : last + 1])[:, None]
        peak = (velocity / ARM.limits.velocity).max(initial=0.0)
        largest = max(map(error, motion, poses[first : last + 1]))
        posture = ", ".join(f"{angle:.3f}" for angle in motion[0])
        distance = np.minimum(motion[-1] - ARM.limits.lower, ARM.limits.upper - motion[-1])
        ends = ", ".join(ARM.joint_names[i] for i in np.flatnonzero(distance < ON_BOUND))
        print(f"| {first} to {last} | {most} | {peak:.3f} | {largest:.1e} | {posture} | {ends} |")
    print(f"\n{len(poses)} waypoints, {len(parts) - 1} reconfigurations, {seconds:.1f} s of processor time")


if __name__ == "__main__":
    main()
