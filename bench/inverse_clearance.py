"""Postures clear of obstacles, checked by Coal on meshes: `python bench/inverse_clearance.py [--count 1000]`.

A Panda at a table with a post, and two Pandas at a table. The targets are poses of random postures within the ranges,
in which the capsules keep the margin of the clearance. Each answer is checked by Coal on the meshes of the links, with
placements by Pinocchio, and by the distances of the capsules. "Without bounds": the same targets without a clearance.
"""

from __future__ import annotations

import argparse
import re
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from clearance_robots import Array, Check, Meshes, flat_urdf

import fpbm_cpp as fp

FLOOR = fp.HalfSpace([0, 0, 1], 0.0, name="floor")
TABLE = fp.Cuboid(
    np.array([[1, 0, 0, 0.6], [0, 1, 0, 0], [0, 0, 1, 0.25], [0, 0, 0, 1]]), [0.3, 0.7, 0.02], name="table"
)
POST = fp.Capsule(0, [0.45, 0.25, 0.27], [0.45, 0.25, 0.9], 0.05, name="post")
SIDES = {"right": -0.4, "left": 0.4}  # Position y of each base of the preset two_pandas [m].


class Scene(NamedTuple):
    name: str
    robot: fp.SerialArm | fp.Robot
    clearance: fp.Clearance
    stack: fp.Stack
    tips: dict[str, Callable[[Array], Array]]  # Pose of each task.
    meshes: Check


def urdf_of_two(one: str) -> str:
    """A URDF file with two Pandas, from the file with a Panda. The order of the arms is the order of the mounts."""
    links = one[one.index("<link") : one.index("</robot>")]
    mounts = [
        f'<joint name="{i}_mount" type="fixed"><parent link="table"/><child link="{side}_panda_link0"/>'
        f'<origin xyz="0 {y} 0"/></joint>' + re.sub('"panda_', f'"{side}_panda_', links)
        for i, (side, y) in enumerate(SIDES.items())
    ]
    return f'<robot name="two_pandas"><link name="table"/>{"".join(mounts)}</robot>'


def scenes() -> Iterator[Scene]:
    with flat_urdf("panda") as urdf, tempfile.TemporaryDirectory() as folder:
        arm, clearance = fp.SerialArm.preset("panda"), fp.Clearance.preset("panda", obstacles=[FLOOR, TABLE, POST])
        check = Meshes(urdf, arm.joint_names, {"panda_link8": arm.forward}, clearance).among(clearance.obstacles)
        yield Scene(
            "a Panda at a table with a post", arm, clearance, fp.Stack(fp.PoseTask()), {"pose": arm.forward}, check
        )

        two = Path(folder) / "two_pandas.urdf"
        two.write_text(urdf_of_two(urdf.read_text()))
        robot, clearance = fp.Robot.preset("two_pandas"), fp.Clearance.preset("two_pandas", obstacles=[FLOOR, TABLE])
        tips = {side: partial(robot.forward, frame=f"{side}_tip") for side in SIDES}
        flanges = {f"{side}_panda_link8": tip for side, tip in tips.items()}
        check = Meshes(two, robot.joint_names, flanges, clearance).among(clearance.obstacles)
        stack = fp.Stack([fp.PoseTask(f"{side}_tip", name=side) for side in SIDES])
        yield Scene("two Pandas at a table", robot, clearance, stack, tips, check)


def beyond(scene: Scene, q: Array) -> float:
    """Distance of the nearest capsules beyond the margin [m]."""
    nearest = scene.clearance.nearest(scene.robot, q)
    assert nearest is not None
    return nearest.distance - scene.clearance.margin


def clear_postures(scene: Scene, count: int, rng: np.random.Generator) -> Array:
    limits, found = scene.robot.limits, []
    while len(found) < count:
        q = rng.uniform(limits.lower, limits.upper)
        if beyond(scene, q) >= 0:
            found.append(q)
    return np.array(found)


def row(scene: Scene, postures: Array, bounds: Sequence[fp.Clearance], starts: int) -> str:
    solver = fp.InverseKinematics(scene.robot, stack=scene.stack, bounds=bounds, starts=starts)
    answers, times = [], []
    for q in postures:
        target = {name: tip(q) for name, tip in scene.tips.items()}
        begin = time.process_time_ns()
        found = solver.solve(target)
        times.append(1e-3 * (time.process_time_ns() - begin))
        if found.solved:
            answers.append(found.q)
    contacts = sum(scene.meshes.meets(q) for q in answers)
    near = min(beyond(scene, q) for q in answers)
    apart = min(scene.meshes.distance(q) for q in answers)
    name, count = scene.name if bounds else f"{scene.name}, without bounds", f"{len(answers)} of {len(postures)}"
    figures = " | ".join(f"{value:.0f}" for value in (np.mean(times), np.median(times), np.percentile(times, 99)))
    return f"| {name} | {count} | {contacts} | {1e3 * near:.2f} | {1e3 * apart:.1f} | {figures} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=1000, help="postures of each scene")
    parser.add_argument("--starts", type=int, default=256)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    print(
        "| scene | found | with contacts of meshes | least distance of capsules beyond the margin [mm] "
        "| least distance of meshes [mm] | mean [µs] | median | p99 |"
    )
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    for scene in scenes():
        postures = clear_postures(scene, options.count, np.random.default_rng(options.seed))
        for bounds in ([scene.clearance], []):
            print(row(scene, postures, bounds, options.starts), flush=True)


if __name__ == "__main__":
    main()
