"""Collision geometry of the links of a URDF file, as edges and balls whose convex hulls contain it."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._types import Array
from ..errors import extra
from .mesh_file import find_mesh, read_mesh
from .urdf import pose
from .xml_file import Element, Kept, named, read_xml

SIDES = 64  # Sides of the prism around a cylinder; the prism is 0.12 % wider than the cylinder.
SHAPES = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",), "capsule": ("radius", "length")}
KEPT: Kept = {
    ("robot",): {"link": ("name",)},
    ("robot", "link"): {"collision": ()},
    ("robot", "link", "collision"): {"origin": ("xyz", "rpy"), "geometry": ()},
    ("robot", "link", "collision", "geometry"): {**SHAPES, "mesh": ("filename", "scale")},
}


@dataclass(frozen=True)
class Shape:
    """A body in a link's frame: the faces between its edges, and balls.

    edges: shape (E, 2, 3). centers and radii of the balls: (B, 3) and (B,). cylinder: radius, length and frame if the
    body is a single cylinder; edges then form a prism around the cylinder. All in metres.
    """

    edges: Array = field(default_factory=lambda: np.zeros((0, 2, 3)))
    centers: Array = field(default_factory=lambda: np.zeros((0, 3)))
    radii: Array = field(default_factory=lambda: np.zeros(0))
    cylinder: tuple[float, float, Array] | None = None
    sides: Array = field(default_factory=lambda: np.zeros((0, 2, 3)))  # Sides of sections by cutting planes.

    @property
    def points(self) -> Array:
        """Ends of edges and centers of balls."""
        return np.vstack([self.edges.reshape(-1, 3), self.centers])

    @property
    def sizes(self) -> Array:
        """The radius about each point: 0 about ends of edges."""
        return np.concatenate([np.zeros(2 * len(self.edges)), self.radii])

    def moved(self, frame: Array) -> Shape:
        R, p = frame[:3, :3], frame[:3, 3]
        cylinder = self.cylinder and (*self.cylinder[:2], frame @ self.cylinder[2])
        return Shape(self.edges @ R.T + p, self.centers @ R.T + p, self.radii, cylinder, self.sides @ R.T + p)

    def between(self, u: Array, low: float, high: float) -> Shape:
        """The part of the body in low <= u x < high; a ball belongs to the part that contains its center.

        A plane that cuts a face cuts its edges: the remaining parts of the edges and of the face have the same hull. At
        the plane, the face gets a new edge, which a later plane may cut. The new edge is inside the convex hull of the
        section; the sides of this hull are kept. If a plane cuts a side, the side becomes an edge.
        """
        kept, cut = _clipped(self.edges, u, low, high)
        sides_kept, sides_cut = _clipped(self.sides, u, low, high)
        edges = np.concatenate([kept, sides_kept[sides_cut]])
        ends = np.concatenate([kept[cut], sides_kept[sides_cut]]).reshape(-1, 3)
        sections = [_section(ends, u, bound) for bound in (low, high) if np.isfinite(bound)]
        mine = (self.centers @ u >= low) & (self.centers @ u < high)
        return Shape(
            edges, self.centers[mine], self.radii[mine], sides=np.concatenate([sides_kept[~sides_cut], *sections])
        )


def _clipped(edges: Array, u: Array, low: float, high: float) -> tuple[Array, NDArray[np.bool_]]:
    """The parts of edges in low <= u x <= high, and which of these edges a plane cuts."""
    s = edges @ u
    rise = s[:, 1] - s[:, 0]
    flat = rise == 0.0
    enter, leave = ((bound - s[:, 0]) / np.where(flat, 1.0, rise) for bound in (low, high))
    enter, leave = np.minimum(enter, leave), np.maximum(enter, leave)
    kept = (s.max(axis=1) >= low) & (s.min(axis=1) <= high)
    shares = np.stack([np.where(flat, 0.0, enter), np.where(flat, 1.0, leave)], axis=1)[kept].clip(0.0, 1.0)
    start, extent = edges[kept, :1], edges[kept, 1:] - edges[kept, :1]
    left = np.where(shares[:, :, None] == 1.0, edges[kept, 1:], start + shares[:, :, None] * extent)
    return left, (shares[:, 0] > 0.0) | (shares[:, 1] < 1.0)


def _section(points: Array, u: Array, bound: float) -> Array:
    """Sides of the convex hull of the points on a plane u x = bound."""
    spatial = extra("scipy.spatial", "a capsule that fits", "clearance")
    size = float(np.max(np.abs(points), initial=0.0))
    on = points[np.abs(points @ u - bound) <= 1e-9 * size]
    if len(on) < 2:
        return np.zeros((0, 2, 3))
    across = np.linalg.svd(u[None, :])[2][1:]
    try:
        corners = spatial.ConvexHull(on @ across.T).simplices
    except spatial.QhullError:  # The points are on a line.
        along = (on - on[0]) @ np.linalg.svd(on - on.mean(axis=0), full_matrices=False)[2][0]
        corners = np.array([[np.argmin(along), np.argmax(along)]])
    sides: Array = on[corners]
    return sides


def together(shapes: list[Shape]) -> Shape:
    """Several shapes joined to one shape."""
    if len(shapes) == 1:
        return shapes[0]
    return Shape(
        edges=np.concatenate([each.edges for each in shapes]),
        centers=np.concatenate([each.centers for each in shapes]),
        radii=np.concatenate([each.radii for each in shapes]),
        sides=np.concatenate([each.sides for each in shapes]),
    )


def read_shapes(path: str | os.PathLike[str]) -> dict[str, list[Shape]]:
    """Collision geometry of each link that has any, in the link's frame.

    Raises ValueError if the file is not a valid URDF, or if a mesh is not found or cannot be read; ImportError if a
    library for meshes is missing.
    """
    name = os.fsdecode(path)
    meshes: dict[str, Array] = {}
    try:
        links = named(read_xml(name, KEPT).all("link"))
        return {
            link: [_shape(each, f"link {link!r}", Path(name), meshes) for each in element.parts]
            for link, element in links.items()
            if element.parts
        }
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def _shape(collision: Element, owner: str, urdf: Path, meshes: dict[str, Array]) -> Shape:
    collision.require_one_each(f"{owner}: <collision>")
    geometry = next((part.parts for part in collision.parts if part.tag == "geometry"), [])
    if len(geometry) != 1:
        kinds = ", ".join([*SHAPES, "mesh"])
        raise ValueError(f"line {collision.line}: {owner}: <collision> must have one <geometry> of {kinds}")
    (element,) = geometry
    xyz, rpy = (collision.numbers("origin", key, [0.0] * 3, owner) for key in ("xyz", "rpy"))
    shape = _mesh(element, owner, urdf, meshes) if element.tag == "mesh" else _primitive(element, owner)
    return shape.moved(pose(xyz, rpy))


def _primitive(element: Element, owner: str) -> Shape:
    inside = Element("geometry", element.line, {}, [element])
    sizes: list[float] = []
    for key in SHAPES[element.tag]:
        if key not in element.attributes:
            raise ValueError(f'{owner} has no <{element.tag} {key}="...">')
        sizes += inside.numbers(element.tag, key, [0.0] * (3 if key == "size" else 1), owner)
    if min(sizes) < 0.0:
        raise ValueError(f"{owner}: {element.tag} of {' '.join(f'{size:g}' for size in sizes)}: must not be negative")
    if element.tag == "box":
        corners = np.array(list(product((-0.5, 0.5), repeat=3))) * sizes
        return Shape(np.array([[p, q] for i, p in enumerate(corners) for q in corners[:i] if np.sum(p != q) <= 1]))
    if element.tag == "sphere":
        return Shape(centers=np.zeros((1, 3)), radii=np.array(sizes))
    radius, length = sizes
    ends = np.array([[0.0, 0.0, -length / 2], [0.0, 0.0, length / 2]])
    if element.tag == "capsule":
        return Shape(centers=ends, radii=np.array([radius, radius]))
    turn = 2 * np.pi * np.arange(SIDES) / SIDES
    rim = np.column_stack([np.cos(turn), np.sin(turn), 0 * turn]) * radius / np.cos(np.pi / SIDES)
    rims = [np.stack([rim + end, np.roll(rim, 1, axis=0) + end], axis=1) for end in ends]
    return Shape(
        np.vstack([*rims, np.stack([rim + ends[0], rim + ends[1]], axis=1)]), cylinder=(radius, length, np.eye(4))
    )


def _mesh(element: Element, owner: str, urdf: Path, meshes: dict[str, Array]) -> Shape:
    name = element.attributes.get("filename")
    if not name:
        raise ValueError(f'{owner} has no <mesh filename="...">')
    if name not in meshes:
        file = find_mesh(urdf, name)
        if file is None:
            where = "must be below a folder above the URDF file or in ROS_PACKAGE_PATH: set ROS_PACKAGE_PATH"
            raise ValueError(f"{owner}: mesh {name!r} is not found: {where}")
        meshes[name] = read_mesh(file)
    scale = Element("geometry", element.line, {}, [element]).numbers("mesh", "scale", [1.0] * 3, owner)
    return Shape(meshes[name] * scale)
