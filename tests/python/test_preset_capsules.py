"""Capsules of the presets: they contain the links in every posture, and are not larger than necessary."""

from __future__ import annotations

import importlib.util
import re
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import fpbm_cpp as fp
from fpbm_cpp._types import Array
from fpbm_cpp.urdf.capsule_fit import distances
from fpbm_cpp.urdf.chain import read_places
from fpbm_cpp.urdf.mesh_file import find_mesh
from fpbm_cpp.urdf.place import pose
from fpbm_cpp.urdf.shapes import read_shapes

pytest.importorskip("trimesh")

ROOT = Path(__file__).parents[2]
PRESETS = ("panda", "fr3", "iiwa14", "gen3", "ur5e", "ur10e")  # The presets that have capsules.
HEADER = ROOT / "cpp/include/fpbm/bound/preset_capsules.hpp"
TOOL = ROOT / "tools/preset_capsules.py"
NUMBER = r"(-?\d+\.\d{4})"
POINT = rf"\{{{NUMBER}, {NUMBER}, {NUMBER}\}}"
CAPSULE = re.compile(rf'\{{(\d), \{{{POINT}, {POINT}, {NUMBER}\}}, "(\w+)"\}},')
ROUNDED = 0.0003  # [m], of ends and radius.
# In ROS-Industrial's model, two joints of the iiwa are 0.44 mm from their positions in KUKA's drawing.
SLACK = {"iiwa14": 0.0012}


def written(name: str) -> dict[tuple[int, str], list[tuple[Array, Array, float]]]:
    """A preset's capsules in the header, by link."""
    (body,) = re.findall(rf"LinkCapsule<>> {name}\(\) \{{\n(.*?)\n\}}\n", HEADER.read_text(), re.DOTALL)
    found = defaultdict(list)
    for link, *numbers, name in CAPSULE.findall(body):
        *ends, radius = map(float, numbers)
        found[int(link), name].append((np.array(ends[:3]), np.array(ends[3:]), radius))
    return dict(found)


def link_frames(arm: fp.SerialArm, q: Array) -> list[Array]:
    """Frames of the base and of each joint after its motion, in the base frame."""
    frames = [np.eye(4)]
    for joint, angle in zip(arm.joints, q):
        turn = np.eye(4)
        turn[:3, :3] = Rotation.from_rotvec(angle * np.asarray(joint.axis)).as_matrix()
        frames.append(frames[-1] @ joint.placement @ turn)
    return frames


def moved(frame: Array, points: Array) -> Array:
    return np.asarray(points @ frame[:3, :3].T + frame[:3, 3])


def load_tool() -> Any:
    """The script that wrote the header: it knows where the meshes are."""
    spec = importlib.util.spec_from_file_location(TOOL.stem, TOOL)
    assert spec is not None
    assert spec.loader is not None
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    return tool


@contextmanager
def urdf_of(tool: Any, name: str) -> Iterator[Path]:
    try:
        with tool.urdf_of(name) as urdf:
            yield urdf
    except PackageNotFoundError as missing:
        pytest.skip(f"needs {missing.name}")
    except ValueError as error:
        if "is not found" not in str(error):
            raise
        pytest.skip("needs ROS's description package")


needs_clone = pytest.mark.skipif(not TOOL.exists() or not HEADER.exists(), reason="needs a clone")


@needs_clone
@pytest.mark.parametrize("name", PRESETS)
def test_every_vertex_of_a_preset_is_inside_its_capsules(name: str) -> None:
    tool = load_tool()
    with urdf_of(tool, name) as urdf:
        shapes = {link: parts for link, parts in read_shapes(urdf).items() if tool.is_of_arm(link)}
        places = read_places(urdf, tool.ARMS[name].tip)[2]
        robot = fp.SerialArm.from_urdf(urdf, tool.ARMS[name].tip)
    capsules = written(name)
    assert set(capsules) == {(places[link][0], link) for link in shapes}
    preset = fp.SerialArm.preset(name)
    # ROS turns base_link half round from the base of UR's controller.
    base = np.diag([-1.0, -1.0, 1.0, 1.0]) if name.startswith("ur") else np.eye(4)
    rng = np.random.default_rng(4)
    loose = defaultdict(lambda: np.inf)
    for q in rng.uniform(-np.pi, np.pi, (30, preset.dof)):
        ours, theirs = link_frames(preset, q), [base @ frame for frame in link_frames(robot, q)]
        for link, parts in shapes.items():
            number, frame = places[link]
            each = [(moved(ours[number], a), moved(ours[number], b), radius) for a, b, radius in capsules[number, link]]
            for part in parts:
                points = moved(theirs[number] @ frame, part.points)
                slack = np.max([radius - part.sizes - distances(points, a, b) for a, b, radius in each], axis=0)
                loose[link] = min(loose[link], np.min(slack))
    for link, slack in loose.items():
        assert slack >= 0.0, (link, slack)
        assert len(capsules[places[link][0], link]) > 1 or slack <= ROUNDED + SLACK.get(name, 0.0), (link, slack)


# Franka's collision meshes of the Panda are convex, and the meshes of links 5 and 7 do meet: the links do not.
CONVEX = {"panda"}
APART = 0.005  # [m]


def solid(coal: Any, urdf: Path, link: str, kind: str, frame: Array) -> tuple[Any, Array]:
    """A link's mesh for coal, and its vertices, in the frame of its joint."""
    trimesh = pytest.importorskip("trimesh")
    (element,) = [each for each in ElementTree.parse(urdf).findall("link") if each.get("name") == link]
    ((origin, mesh),) = [(each.find("origin"), each.find("geometry/mesh")) for each in element.findall(kind)]
    place = {} if origin is None else origin.attrib
    xyz, rpy = ([float(x) for x in place.get(key, "0 0 0").split()] for key in ("xyz", "rpy"))
    read = trimesh.load(find_mesh(urdf, mesh.get("filename")), force="mesh", process=False)
    vertices = moved(frame @ pose(xyz, rpy), np.asarray(read.vertices))
    corners, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    corners.extend(list(vertices))
    triangles.extend([coal.Triangle(*map(int, face)) for face in read.faces])
    body = coal.BVHModelOBBRSS()
    body.beginModel(len(triangles), len(corners))
    body.addSubModel(corners, triangles)
    body.endModel()
    return body, vertices


@needs_clone
@pytest.mark.parametrize("name", PRESETS)
def test_listed_links_never_collide(name: str) -> None:
    """By branch and bound: from the middle of a box of joint positions, no vertex moves farther than levers allow."""
    coal = pytest.importorskip("coal")
    tool = load_tool()
    (listed,) = re.findall(rf"LinkNames> {name}\(\) \{{\n  return \{{(.*)\}};", HEADER.read_text())
    pairs = re.findall(r'\{"(\w+)", "(\w+)"\}', listed)
    assert tuple(pairs) == tool.ARMS[name].never_collide
    preset = fp.SerialArm.preset(name)
    for pair in pairs:
        with urdf_of(tool, name) as urdf:
            joints, _, places = read_places(urdf, tool.ARMS[name].tip)
            kind = "visual" if name in CONVEX else "collision"
            (first, _), (second, points) = (solid(coal, urdf, each, kind, places[each][1]) for each in pair)
        low, high = (places[each][0] for each in pair)
        assert high == low + 2
        joints = joints[low:high]
        step, axis = joints[1].placement, np.asarray(joints[1].axis)
        # Bounds on the distance of a point from the first axis and from the second axis.
        levers = np.array(
            [
                np.linalg.norm(step[:3, 3]) + np.max(np.linalg.norm(points, axis=1)),
                np.max(np.linalg.norm(points - np.outer(points @ axis, axis), axis=1)),
            ]
        )
        bounds = np.clip([preset.limits.lower[low:high], preset.limits.upper[low:high]], -np.pi, np.pi)
        boxes = [(bounds.mean(axis=0), np.ptp(bounds, axis=0) / 2)]
        for middle, half in boxes:
            frame = np.eye(4)
            for joint, angle in zip(joints, middle):
                turn = np.eye(4)
                turn[:3, :3] = Rotation.from_rotvec(angle * np.asarray(joint.axis)).as_matrix()
                frame = frame @ joint.placement @ turn
            there = coal.Transform3s(frame[:3, :3], frame[:3, 3])
            request, result = coal.DistanceRequest(), coal.DistanceResult()
            distance = coal.distance(first, coal.Transform3s(), second, there, request, result)
            assert distance > APART, (pair, middle)
            if distance - levers @ half < APART:
                i = int(np.argmax(levers * half))
                smaller = np.where(np.arange(2) == i, half / 2, half)
                aside = np.where(np.arange(2) == i, half / 2, 0.0)
                boxes += [(middle - aside, smaller), (middle + aside, smaller)]
