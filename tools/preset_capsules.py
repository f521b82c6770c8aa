"""Writes preset_capsules.hpp: capsules that contain the collision meshes of the links of the presets.

Needs fpbm_cpp[clearance], clang-format and the packages in ARMS. No package has meshes of the UR10e: they are read from
ROS's ur_description in ROS_PACKAGE_PATH. The pose of link i of a URDF file in the frame of joint i of the preset of the
same arm is the same in all postures, up to the digits of the file. The largest difference is printed. This difference
and the error of rounding to 0.1 mm are added to the radius.
"""

import importlib.metadata
import re
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fpbm_cpp import SerialArm
from fpbm_cpp._core import rotation
from fpbm_cpp.capsule import Capsule
from fpbm_cpp.urdf.capsules import capsules_of
from fpbm_cpp.urdf.mesh_file import find_mesh

HEADER = Path(__file__).parent.parent / "cpp/include/fpbm/bound/detail/arm_capsules.hpp"
GRID = 1e-4  # [m]
POSTURES = 1000
MOST_OFF = 1e-3  # [m] or [rad]
Frame = NDArray[np.float64]  # (4, 4)


class Source(NamedTuple):
    package: str  # Package with the URDF file.
    urdf: str
    tip: str  # Link of the preset's flange.
    title: str
    origin: str  # Author and licence of the meshes.
    meshes: tuple[str, str, str] | None = None  # Package, folder and suffix of meshes that the URDF's package lacks.
    ros: str | None = None  # ROS package with the meshes.
    never_collide: tuple[tuple[str, str], ...] = ()  # See tests/python/test_preset_capsules.py.


FRANKA = "Franka's franka_description, Apache-2.0"
UR = "Universal Robots' ur_description, BSD-3-Clause"
MANIPULAPY = "ManipulaPy/ManipulaPy_data"
ARMS = {
    "panda": Source(
        "example-robot-data",
        "cmeel.prefix/share/example-robot-data/robots/panda_description/urdf/panda.urdf",
        "panda_link8",
        "Franka Emika Panda, without a hand.",
        FRANKA,
        never_collide=(("panda_link5", "panda_link7"),),
    ),
    "fr3": Source(
        "franky-sim",
        "franky_sim/assets/fr3.urdf",
        "fr3_link8",
        "Franka Research 3, without a hand.",
        FRANKA,
        never_collide=(("fr3_link5", "fr3_link7"),),
    ),
    "iiwa14": Source(
        "rtb-data",
        "rtbdata/xacro/kuka_description/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.urdf",
        "tool0",
        "KUKA LBR iiwa 14 R820.",
        "ROS-Industrial's kuka_lbr_iiwa_support, Apache-2.0",
        never_collide=(("link_5", "link_7"),),
    ),
    "gen3": Source(
        "ManipulaPy",
        f"{MANIPULAPY}/kinova/gen3/gen3_v12.urdf",
        "end_effector_link",
        "Kinova Gen3 with a spherical wrist and the vision module.",
        "Kinova's kortex_description, BSD-3-Clause",
        ("robosuite", "robosuite/models/assets/robots/kinova3/meshes", ".stl"),
    ),
    "ur5e": Source(
        "ManipulaPy",
        f"{MANIPULAPY}/universal_robots/ur5e/ur5e.urdf",
        "tool0",
        "Universal Robots UR5e.",
        UR,
        ("airo-models", "airo_models/arms/ur5e/collision", ".obj"),
        never_collide=(("forearm_link", "wrist_2_link"),),
    ),
    "ur10e": Source(
        "ManipulaPy",
        f"{MANIPULAPY}/universal_robots/ur10e/ur10e.urdf",
        "tool0",
        "Universal Robots UR10e.",
        UR,
        ros="ur_description",
    ),
}


class Robot(NamedTuple):
    """The links of a preset by the URDF file of its meshes."""

    capsules: list[Capsule]  # In the frames of the file's joints.
    poses: NDArray[np.float64]  # Positions of these frames in the frames of the preset's joints, the base first.
    off: NDArray[np.float64]  # Largest deviation of each of these poses [m].
    turned: NDArray[np.float64]  # Largest rotation of each of these poses [rad].


def version(source: Source) -> str:
    """Name of the package that has the meshes."""
    if source.ros is not None:
        file = find_mesh(located(source.package, source.urdf), f"package://{source.ros}/package.xml")
        found = re.search("<version>(.*)</version>", file.read_text() if file else "")
        return f"{source.ros} {found[1] if found else '?'}"
    package = source.meshes[0] if source.meshes else source.package
    return f"{package} {importlib.metadata.version(package)}"


def located(package: str, place: str) -> Path:
    return Path(str(importlib.metadata.distribution(package).locate_file(place)))


def frames(arm: SerialArm, q: Sequence[float]) -> Iterator[Frame]:
    """Frames of the base and of each joint after its motion, in the base frame."""
    frame = np.eye(4)
    yield frame
    for joint, angle in zip(arm.joints, q):
        turn = np.eye(4)
        axis = np.asarray(joint.axis)
        turn[:3, :3] = rotation(angle * axis / np.linalg.norm(axis))
        frame = frame @ joint.placement @ turn
        yield frame


@contextmanager
def urdf_of(name: str) -> Iterator[Path]:
    """The URDF file of a preset, in a folder with its meshes."""
    source = ARMS[name]
    urdf = located(source.package, source.urdf)
    if source.meshes is None:
        yield urdf
        return
    package, folder, suffix = source.meshes
    with tempfile.TemporaryDirectory() as place:
        file = Path(place) / urdf.name
        file.write_text(
            re.sub(r"package://[^\"]*/(\w+)\.stl\"", rf'\1{suffix}"', urdf.read_text(), flags=re.IGNORECASE)
        )
        for mesh in located(package, folder).glob(f"*{suffix}"):
            (file.parent / mesh.name).symlink_to(mesh)
        yield file


def is_of_arm(link: str) -> bool:
    return not re.search("hand|finger", link)


def read(name: str) -> Robot:
    """Raises ValueError if the preset and the file are not the same arm, or a mesh is not found."""
    with urdf_of(name) as urdf:
        return _read(name, urdf, ARMS[name].tip)


def _read(name: str, urdf: Path, tip: str) -> Robot:
    preset = SerialArm.preset(name)
    other = SerialArm.from_urdf(urdf, tip)
    zero = np.zeros(preset.dof)
    base = preset.forward(zero) @ np.linalg.inv(other.forward(zero))

    def poses(q: Sequence[float]) -> list[Frame]:
        return [np.linalg.inv(ours) @ base @ theirs for ours, theirs in zip(frames(preset, q), frames(other, q))]

    postures = np.random.default_rng(0).uniform(-np.pi, np.pi, (POSTURES, preset.dof))
    every = np.array([poses(q.tolist()) for q in postures])
    same = np.array(poses(zero.tolist()))
    same[:, :3, 3] = every[:, :, :3, 3].mean(axis=0)
    off = np.linalg.norm(every[:, :, :3, 3] - same[:, :3, 3], axis=-1).max(axis=0)
    turned = np.linalg.norm(every[:, :, :3, :3] - same[:, :3, :3], axis=(-2, -1)).max(axis=0)
    if max(off.max(), turned.max()) > MOST_OFF:
        raise ValueError(f"{name}: {urdf} is another arm, off by {off.max():g} m and {turned.max():g} rad")
    capsules = [capsule for capsule in capsules_of(urdf, tip, finer=False) if is_of_arm(capsule.name)]
    return Robot(capsules, same, off, turned)


def written(robot: Robot) -> Iterator[str]:
    """The capsules as C++ in the frames of the preset's joints, each larger by the rounding error of its numbers."""
    for link, a, b, radius, name in ((c.link, c.a, c.b, c.radius, c.name) for c in robot.capsules):
        pose = robot.poses[link]
        exact = np.array([pose[:3, :3] @ end + pose[:3, 3] for end in (a, b)])
        ends = np.round(exact / GRID) * GRID + 0.0
        moved = np.max(np.linalg.norm(ends - exact, axis=1))
        reach = np.max(np.linalg.norm([a, b], axis=1)) + radius
        whole = np.ceil((radius + moved + robot.off[link] + robot.turned[link] * reach) / GRID) * GRID
        yield f'{{{link}, {{{_braced(ends[0])}, {_braced(ends[1])}, {whole:.4f}}}, "{name}"}},'


def _braced(point: ArrayLike) -> str:
    return f"{{{', '.join(f'{x + 0.0:.4f}' for x in np.asarray(point))}}}"


def function(name: str, robot: Robot) -> str:
    source = ARMS[name]
    lines = "\n".join(f"      {line}" for line in written(robot))
    return f"""\
/// {source.title}
///
/// Meshes: {version(source)}, from {source.origin}.
[[nodiscard]] inline std::vector<LinkCapsule<>> {name}() {{
  return {{
{lines}
  }};
}}
"""


def never_collide(name: str) -> str:
    pairs = ", ".join(f'{{"{a}", "{b}"}}' for a, b in ARMS[name].never_collide)
    return f"[[nodiscard]] inline std::vector<LinkNames> {name}() {{ return {{{pairs}}}; }}"


def main() -> None:
    robots = {name: read(name) for name in ARMS}
    for name, robot in robots.items():
        off = f"{1e3 * robot.off.max():.2g} mm and {robot.turned.max():.2g} rad"
        print(f"{name}: {len(robot.capsules)} capsules, of links that are off by {off} at most")
    functions = "\n".join(function(name, robot) for name, robot in robots.items())
    pairs = "\n".join(map(never_collide, robots))
    every = ", ".join(f'{{"{name}", capsules::{name}, never_collide::{name}}}' for name in robots)
    HEADER.write_text(f"""\
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "fpbm/bound/clearance.hpp"

/// Capsules on the links of the presets [m]. The capsules contain the collision meshes of the manufacturers in every
/// posture, but no cables, tools or other mounted parts. Written by tools/preset_capsules.py.
namespace fpbm::presets::capsules {{

{functions}
}}  // namespace fpbm::presets::capsules

/// Links of the presets whose capsules may overlap although the links never collide within the joint bounds, for the
/// last argument of Clearance. The two links of a pair are always at least 5 mm apart.
namespace fpbm::presets::never_collide {{

using LinkNames = std::pair<std::string, std::string>;

{pairs}

}}  // namespace fpbm::presets::never_collide

namespace fpbm::presets {{

/// Capsules of a preset by name, for programs that read the name at run time.
struct PresetCapsules {{
  const char* name;
  std::vector<LinkCapsule<>> (*capsules)();
  std::vector<never_collide::LinkNames> (*never_collide)();
}};
inline constexpr PresetCapsules kAllCapsules[] = {{{every}}};

}}  // namespace fpbm::presets
""")
    subprocess.run(["clang-format", "-i", HEADER], check=True)


if __name__ == "__main__":
    main()
