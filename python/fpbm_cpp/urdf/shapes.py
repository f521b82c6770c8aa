"""Collision geometry of the links of a URDF file, as corners, edges and balls whose convex hulls contain it."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._types import Array
from ..errors import extra
from .mesh_file import edges_of, find_mesh, read_mesh
from .place import pose
from .xml_file import Element, Kept, errors_of, named, read_xml

SIDES = 64  # Sides of the prism around a cylinder; the prism is 0.12 % wider than the cylinder.
MANY = 2000  # Largest number of corners of a mesh of which no approximation is made.
CELLS = 64  # Cells of an approximation along its longest side.
SHAPES = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",), "capsule": ("radius", "length")}
KEPT: Kept = {
    ("robot",): {"link": ("name",)},
    ("robot", "link"): {"collision": ()},
    ("robot", "link", "collision"): {"origin": ("xyz", "rpy"), "geometry": ()},
    ("robot", "link", "collision", "geometry"): {**SHAPES, "mesh": ("filename", "scale")},
}


@dataclass(frozen=True, eq=False)
class Shape:
    """A body in a link's frame: the faces between its edges, and balls.

    corners: shape (C, 3). edges: indices of the two corners of each edge, shape (E, 2). centers and radii of the balls:
    (B, 3) and (B,). cylinder: radius, length and frame if the body is a single cylinder; edges then form a prism around
    the cylinder. fine: the body of which this shape is an approximation with fewer corners; None if it is the body. All
    in metres.
    """

    corners: Array = field(default_factory=lambda: np.zeros((0, 3)))
    edges: NDArray[np.intp] = field(default_factory=lambda: np.zeros((0, 2), dtype=np.intp))
    centers: Array = field(default_factory=lambda: np.zeros((0, 3)))
    radii: Array = field(default_factory=lambda: np.zeros(0))
    cylinder: tuple[float, float, Array] | None = None
    fine: Callable[[], Shape] | None = None

    @property
    def points(self) -> Array:
        """Corners, and centers of balls."""
        return np.vstack([self.corners, self.centers])

    @property
    def sizes(self) -> Array:
        """The radius about each point: 0 about corners."""
        return np.concatenate([np.zeros(len(self.corners)), self.radii])

    @cached_property
    def body(self) -> Shape:
        """The body with all its corners."""
        return self if self.fine is None else self.fine()

    def principal_axes(self) -> Array:
        """Unit vectors (3, 3), from the longest to the shortest extent; each edge counts equally."""
        points = np.vstack([self.corners[self.edges.ravel()], self.centers])
        away = points - points.mean(axis=0)
        axes: Array = np.linalg.eigh(away.T @ away)[1].T[::-1]
        return axes

    def moved(self, frame: Array) -> Shape:
        R, p = frame[:3, :3], frame[:3, 3]
        cylinder = self.cylinder and (*self.cylinder[:2], frame @ self.cylinder[2])
        fine = self.fine and (lambda: self.body.moved(frame))
        return Shape(self.corners @ R.T + p, self.edges, self.centers @ R.T + p, self.radii, cylinder, fine)

    def between(self, u: Array, low: float, high: float) -> Shape:
        """The part of the body in low <= u x <= high; a ball belongs to the part with low <= u x < high of its center.

        A plane that cuts a face cuts its edges: the remaining parts of the edges and of the face have the same hull. At
        the plane, the face gets a new edge, which a later plane may cut. The new edge is inside the convex hull of the
        section; the sides of this hull become edges.
        """
        s = self.corners @ u
        side = np.where(s < low, -1, np.where(s > high, 1, 0))
        inside = side == 0
        ends = side[self.edges]
        edges = self.edges[(ends[:, 0] * ends[:, 1] != 1) & np.any(ends != 0, axis=1)]  # The edges that a plane cuts.
        row, column = np.nonzero(side[edges])
        out, other = edges[row, column], edges[row, 1 - column]
        share = (np.where(side[out] < 0, low, high) - s[out]) / (s[other] - s[out])
        ends_at_planes = self.corners[out] + share[:, None] * (self.corners[other] - self.corners[out])
        index = np.cumsum(inside) - 1
        cut = index[edges]
        cut[row, column] = np.count_nonzero(inside) + np.arange(len(row))
        corners = np.vstack([self.corners[inside], ends_at_planes])
        sides = [_section(corners, u, bound) for bound in (low, high) if np.isfinite(bound)]
        mine = (self.centers @ u >= low) & (self.centers @ u < high)
        return Shape(
            corners,
            np.concatenate([index[self.edges[np.all(ends == 0, axis=1)]], cut, *sides]),
            self.centers[mine],
            self.radii[mine],
            fine=self.fine and (lambda: self.body.between(u, low, high)),
        )

    def coarse(self) -> Shape:
        """This body, or an approximation with fewer corners if it has many: one corner for each cell of a grid.

        The corner of a cell is the farthest corner from the center of the body.
        """
        if len(self.corners) <= MANY:
            return self
        low, high = self.corners.min(axis=0), self.corners.max(axis=0)
        order = np.argsort(-np.linalg.norm(self.corners - (low + high) / 2, axis=1), kind="stable")
        cells = ((self.corners[order] - low) * (CELLS / np.max(high - low))).astype(np.intp)
        _, first, cell = np.unique(cells @ [(CELLS + 1) ** 2, CELLS + 1, 1], return_index=True, return_inverse=True)
        index = np.empty(len(order), dtype=np.intp)
        index[order] = cell
        edges = edges_of(index[self.edges])
        return Shape(self.corners[order[first]], edges, self.centers, self.radii, fine=lambda: self)


def _section(corners: Array, u: Array, bound: float) -> NDArray[np.intp]:
    """Sides of the convex hull of the corners on a plane u x = bound: indices (E, 2) of their ends."""
    spatial = extra("scipy.spatial", "a capsule that fits", "clearance")
    size = float(np.max(np.abs(corners), initial=0.0))
    on = np.flatnonzero(np.abs(corners @ u - bound) <= 1e-9 * size)
    if len(on) < 2:
        return np.zeros((0, 2), dtype=np.intp)
    points = corners[on]
    across = np.linalg.svd(u[None, :])[2][1:]
    try:
        sides: NDArray[np.intp] = on[spatial.ConvexHull(points @ across.T).simplices]
    except spatial.QhullError:  # The points are on a line.
        along = (points - points[0]) @ np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][0]
        sides = on[[[np.argmin(along), np.argmax(along)]]]
    return sides


def together(shapes: list[Shape]) -> Shape:
    """Several shapes joined to one shape."""
    if len(shapes) == 1:
        return shapes[0]
    starts = np.cumsum([0, *(len(each.corners) for each in shapes)])
    coarse = any(each.fine is not None for each in shapes)
    return Shape(
        corners=np.concatenate([each.corners for each in shapes]),
        edges=np.concatenate([each.edges + start for each, start in zip(shapes, starts)]),
        centers=np.concatenate([each.centers for each in shapes]),
        radii=np.concatenate([each.radii for each in shapes]),
        fine=(lambda: together([each.body for each in shapes])) if coarse else None,
    )


def read_shapes(path: str | os.PathLike[str]) -> dict[str, list[Shape]]:
    """Collision geometry of each link that has any, in the link's frame.

    Raises ValueError if the file is not a valid URDF, or if a mesh is not found or cannot be read; ImportError if a
    library for meshes is missing.
    """
    name = os.fsdecode(path)
    meshes: dict[str, tuple[Array, NDArray[np.intp]]] = {}
    with errors_of(name):
        return {
            link: [_shape(each, f"link {link!r}", Path(name), meshes) for each in element.parts]
            for link, element in named(read_xml(name, KEPT).all("link")).items()
            if element.parts
        }


def _shape(collision: Element, owner: str, urdf: Path, meshes: dict[str, tuple[Array, NDArray[np.intp]]]) -> Shape:
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
    sizes: list[float] = []
    for key in SHAPES[element.tag]:
        if key not in element.attributes:
            raise ValueError(f'{owner} has no <{element.tag} {key}="...">')
        sizes += element.own_numbers(key, [0.0] * (3 if key == "size" else 1), owner)
    if min(sizes) < 0.0:
        raise ValueError(f"{owner}: {element.tag} of {' '.join(f'{size:g}' for size in sizes)}: must not be negative")
    if element.tag == "box":
        corners = np.array(list(product((-0.5, 0.5), repeat=3))) * sizes
        return Shape(corners, np.array([[i, j] for i in range(8) for j in range(i) if (i ^ j) in (1, 2, 4)]))
    if element.tag == "sphere":
        return Shape(centers=np.zeros((1, 3)), radii=np.array(sizes))
    radius, length = sizes
    ends = np.array([[0.0, 0.0, -length / 2], [0.0, 0.0, length / 2]])
    if element.tag == "capsule":
        return Shape(centers=ends, radii=np.array([radius, radius]))
    turn = 2 * np.pi * np.arange(SIDES) / SIDES
    rim = np.column_stack([np.cos(turn), np.sin(turn), 0 * turn]) * radius / np.cos(np.pi / SIDES)
    i = np.arange(SIDES)
    round_first = np.column_stack([i, np.roll(i, 1)])
    edges = np.vstack([round_first, round_first + SIDES, np.column_stack([i, i + SIDES])])
    return Shape(np.vstack([rim + ends[0], rim + ends[1]]), edges, cylinder=(radius, length, np.eye(4)))


def _mesh(element: Element, owner: str, urdf: Path, meshes: dict[str, tuple[Array, NDArray[np.intp]]]) -> Shape:
    name = element.attributes.get("filename")
    if not name:
        raise ValueError(f'{owner} has no <mesh filename="...">')
    if name not in meshes:
        file = find_mesh(urdf, name)
        if file is None:
            where = "must be below a folder above the URDF file or in ROS_PACKAGE_PATH: set ROS_PACKAGE_PATH"
            raise ValueError(f"{owner}: mesh {name!r} is not found: {where}")
        meshes[name] = read_mesh(file)
    scale = element.own_numbers("scale", [1.0] * 3, owner)
    corners, edges = meshes[name]
    return Shape(corners * scale, edges)
