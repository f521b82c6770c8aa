"""Compares the capsules of arms with their collision geometry: `python bench/capsules.py [per_link]`.

Requires example-robot-data and the extra `clearance`. Presets without meshes are skipped (tools/preset_capsules.py
lists the sources of the meshes). For each arm, over all links with collision geometry, prints:

- the number of capsule pairs that the clearance keeps apart,
- the ratio of the volume of the capsules (of their union, by sampling) to the volume of the convex hulls,
- the ratio of the volume of capsules around trimesh's minimum cylinders to the volume of the convex hulls,
- the distance of the capsules beyond the hulls, for the median and the worst link: the maximum over directions u of
  h_capsule(u) - h_hull(u), with support functions h.

For a cube, the smallest possible ratio of the volumes is 2.64.
"""

from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import trimesh
from scipy.spatial import ConvexHull

from fpbm_cpp.arms import SerialArm
from fpbm_cpp.capsule import Capsule
from fpbm_cpp.clearance import Clearance
from fpbm_cpp.urdf.capsule_fit import distances
from fpbm_cpp.urdf.capsules import capsules_of
from fpbm_cpp.urdf.chain import read_places
from fpbm_cpp.urdf.shapes import Shape, read_shapes

ARMS = {
    "Panda, meshes": ("panda_description/urdf/panda.urdf", "panda_hand", None),
    "Panda, Franka's capsules": ("panda_description/urdf/panda_collision.urdf", "panda_hand", None),
    "UR5": ("ur_description/urdf/ur5_robot.urdf", "tool0", None),
    "UR10": ("ur_description/urdf/ur10_robot.urdf", "tool0", None),
    "xArm 7": ("xarm_description/urdf/xarm7.urdf", "link_eef", None),
    "Jaco": ("kinova_description/robots/kinova.urdf", "j2s6s200_end_effector", None),
    "TIAGo": ("tiago_description/robots/tiago_no_hand.urdf", "arm_7_link", "torso_lift_link"),
    "TALOS": ("talos_data/robots/talos_left_arm.urdf", "gripper_left_base_link", None),
    "Romeo": ("romeo_description/urdf/romeo_small.urdf", "l_wrist", "torso"),
    "PR2": ("pr2_description/urdf/pr2.urdf", "r_wrist_roll_link", "torso_lift_link"),
    "iCub": ("icub_description/robots/icub.urdf", "l_hand", "chest"),
    "Baxter": ("baxter_description/urdf/baxter.urdf", "right_hand_link", None),
}
SAMPLES = 20_000
DIRECTIONS = 4000


def solid(shapes: list[Shape], rng: np.random.Generator) -> np.ndarray:
    """Points whose convex hull is the convex hull of the shapes, except for balls, whose surfaces are sampled."""
    u = rng.normal(size=(400, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    balls = [c + r * u for shape in shapes for c, r in zip(shape.centers, shape.radii)]
    return np.vstack([shape.corners for shape in shapes] + balls)


def union(capsules: list[Capsule], rng: np.random.Generator) -> float:
    ends = np.array([end for c in capsules for end in (c.a - c.radius, c.a + c.radius, c.b - c.radius, c.b + c.radius)])
    low, high = ends.min(axis=0), ends.max(axis=0)
    points = rng.uniform(low, high, (SAMPLES, 3))
    inside = np.any([distances(points, c.a, c.b) <= c.radius for c in capsules], axis=0)
    return float(inside.mean() * np.prod(high - low))


def beyond(capsules: list[Capsule], points: np.ndarray, rng: np.random.Generator) -> float:
    u = rng.normal(size=(DIRECTIONS, 3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    hull = np.max(points @ u.T, axis=0)
    return float(max(np.max(np.maximum(c.a @ u.T, c.b @ u.T) + c.radius - hull) for c in capsules))


def around_cylinder(points: np.ndarray) -> float:
    found = trimesh.bounds.minimum_cylinder(points)
    r, length = found["radius"], found["height"]
    return float(np.pi * r * r * (length + 4 / 3 * r))


def row(
    name: str, file: Path, tip: str, base: str | None, per_link: int, kept: Callable[[str], bool] = lambda link: True
) -> str:
    start = time.perf_counter()
    capsules = capsules_of(file, tip, base, per_link=per_link)
    taken = time.perf_counter() - start
    places = read_places(file, tip, base)[2]
    arm = SerialArm.from_urdf(file, tip, base)
    rng = np.random.default_rng(0)
    sums, reach = np.zeros(3), []
    shapes = {link: parts for link, parts in read_shapes(file).items() if kept(link)}
    capsules = [each for each in capsules if kept(each.name)]
    pairs = len(Clearance(capsules).pairs(arm))
    for link, parts in shapes.items():
        points = solid([shape.moved(places[link][1]) for shape in parts], rng)
        hull = ConvexHull(points)
        own = [c for c in capsules if c.name == link]
        sums += hull.volume, union(own, rng), around_cylinder(points[hull.vertices])
        reach.append(1e3 * beyond(own, points[hull.vertices], rng))
    ratios = f"{sums[1] / sums[0]:.2f} | {sums[2] / sums[0]:.2f}"
    return (
        f"| {name} | {len(shapes)} | {len(capsules)} | {pairs} | {ratios} | "
        f"{np.median(reach):.0f} | {max(reach):.0f} | {taken:.1f} |"
    )


def main() -> None:
    spec = importlib.util.find_spec("cmeel")
    if spec is None or spec.origin is None:
        sys.exit("needs example-robot-data: pip install example-robot-data")
    robots = Path(spec.origin).parents[1] / "cmeel.prefix/share/example-robot-data/robots"
    ratios = "volume / hulls' | about cylinders / hulls'"
    print(f"| arm | links | capsules | pairs | {ratios} | beyond, median [mm] | worst | [s] |")
    print("|---|---|---|---|---|---|---|---|---|")
    per_link = int(sys.argv[1]) if len(sys.argv) > 1 else 2
    for name, (path, tip, base) in ARMS.items():
        print(row(name, robots / path, tip, base, per_link), flush=True)
    sys.path.append(str(Path(__file__).parents[1] / "tools"))
    presets = importlib.import_module("preset_capsules")
    for name, source in presets.ARMS.items():
        try:
            with presets.urdf_of(name) as file:
                print(row(f"preset {name}", file, source.tip, None, per_link, presets.is_of_arm), flush=True)
        except (importlib.metadata.PackageNotFoundError, ValueError) as error:
            print(f"preset {name}: {error}", file=sys.stderr)


if __name__ == "__main__":
    main()
