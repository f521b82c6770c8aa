"""Two Pandas with hands on a torso that turns on a stand: a URDF file, and its meshes for Coal."""

from __future__ import annotations

import re
from itertools import combinations
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

import fpbm_cpp as fp
from fpbm_cpp._types import Array
from fpbm_cpp.urdf.mesh_file import find_mesh
from fpbm_cpp.urdf.place import pose

SIDES = {"left": 1.0, "right": -1.0}
READY = (0.0, -0.6, 0.0, -2.4, 0.0, 1.8, 0.785, 0.01)
BOX = '<link name="{}"><collision><origin xyz="{}"/><geometry><box size="{}"/></geometry></collision></link>'
WAIST = (
    '<joint name="waist" type="revolute"><parent link="stand"/><child link="torso"/><origin xyz="0 0 0.9"/>'
    '<axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1.5"/></joint>'
)
MOUNT = (
    '<joint name="{0}_mount" type="fixed"><parent link="torso"/><child link="{0}_panda_link0"/>'
    '<origin xyz="0 {1} 0.06" rpy="{2} 0 0"/></joint>'
)


def write(robots: Path, folder: Path) -> tuple[Path, Path]:
    """The robot's URDF file and its SRDF file, from example-robot-data's Panda."""
    text = (robots / "panda_description/urdf/panda.urdf").read_text()
    arm = text[text.index("<link") : text.index("</robot>")].replace("package://example-robot-data/robots", str(robots))
    disabled = re.findall("<disable_collisions[^>]*>", (robots / "panda_description/srdf/panda.srdf").read_text())
    links = [BOX.format("stand", "0 0 0.45", "0.2 0.2 0.9"), BOX.format("torso", "0 0 0.06", "0.14 0.5 0.12"), WAIST]
    pairs = ['<disable_collisions link1="stand" link2="torso" reason="Adjacent"/>']
    for side, sign in SIDES.items():
        links += [MOUNT.format(side, 0.25 * sign, -sign), arm.replace('"panda_', f'"{side}_panda_')]
        pairs += [each.replace('"panda_', f'"{side}_panda_') for each in disabled]
    files = folder / "two_arms.urdf", folder / "two_arms.srdf"
    for file, parts in zip(files, (links, pairs)):
        file.write_text(f'<robot name="two_arms">{"".join(parts)}</robot>')
    return files


class Bodies:
    """Meshes of a robot's links and of boxes around it, as Coal measures them.

    Pairs are all except pairs of one moving link, pairs of names in `but`, and pairs of boxes and links that nothing
    moves.
    """

    def __init__(
        self, coal: Any, urdf: Path, robot: fp.Robot, boxes: list[fp.Cuboid], but: set[frozenset[str]]
    ) -> None:
        import trimesh

        self.coal, self.robot = coal, robot
        self.bodies: dict[str, tuple[Any, Array, float]] = {}  # Mesh, middle and radius of a ball that contains it.
        for element in ElementTree.parse(urdf).findall("link"):
            meshes = []
            for each in element.findall("collision"):
                (shape,) = each.find("geometry") or ()
                mesh = (
                    trimesh.creation.box([float(x) for x in shape.get("size", "").split()])
                    if shape.tag == "box"
                    else trimesh.load(find_mesh(urdf, shape.get("filename", "")), force="mesh", process=False)
                )
                origin = each.find("origin")
                place = {} if origin is None else origin.attrib
                xyz, rpy = ([float(x) for x in place.get(key, "0 0 0").split()] for key in ("xyz", "rpy"))
                meshes.append(mesh.apply_transform(pose(xyz, rpy)))
            if meshes:
                self._add(element.get("name", ""), trimesh.util.concatenate(meshes))
        numbers = {frame.name: frame.link for frame in robot.named_frames}
        self.pairs = [
            (a, b) for a, b in combinations(self.bodies, 2) if numbers[a] != numbers[b] and frozenset((a, b)) not in but
        ]
        self.boxes = {each.name: each.pose for each in boxes}
        self.pairs += [(a, each) for a in self.bodies if numbers[a] != 0 for each in self.boxes]
        for each in boxes:
            self._add(each.name, trimesh.creation.box(2 * each.half))

    def _add(self, name: str, mesh: Any) -> None:
        corners, triangles = self.coal.StdVec_Vec3s(), self.coal.StdVec_Triangle()
        corners.extend(list(np.asarray(mesh.vertices)))
        triangles.extend([self.coal.Triangle(*map(int, face)) for face in mesh.faces])
        body = self.coal.BVHModelOBBRSS()
        body.beginModel(len(triangles), len(corners))
        body.addSubModel(corners, triangles)
        body.endModel()
        middle = np.mean(mesh.bounds, axis=0)
        self.bodies[name] = body, middle, float(np.linalg.norm(mesh.vertices - middle, axis=1).max())

    def nearest(self, q: Array, enough: float) -> tuple[float, tuple[str, str] | None]:
        """The least distance of all pairs in a posture [m], if it is below `enough`; not positive in contact."""
        at = {name: self.boxes[name] if name in self.boxes else self.robot.forward(q, name) for name in self.bodies}
        middles = np.array([at[k][:3, :3] @ middle + at[k][:3, 3] for k, (_, middle, _) in self.bodies.items()])
        radii = np.array([radius for _, _, radius in self.bodies.values()])
        order = {name: i for i, name in enumerate(self.bodies)}
        i, j = np.array([(order[a], order[b]) for a, b in self.pairs]).T
        gaps = np.linalg.norm(middles[i] - middles[j], axis=1) - radii[i] - radii[j]
        found: tuple[float, tuple[str, str] | None] = (enough, None)
        request = self.coal.DistanceRequest()
        for k in np.argsort(gaps):
            a, b = self.pairs[k]
            if gaps[k] < found[0]:
                one, two = (
                    (self.bodies[name][0], self.coal.Transform3s(at[name][:3, :3], at[name][:3, 3])) for name in (a, b)
                )
                distance = self.coal.distance(*one, *two, request, self.coal.DistanceResult())
                found = min(found, (distance, (a, b)), key=lambda each: each[0])
        return found
