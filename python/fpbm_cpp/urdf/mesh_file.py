"""Meshes in robot description files: search and reading."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._types import Array
from ..errors import extra

TYPES = ("stl", "obj", "dae")
MAX_BYTES = 256 * 2**20


def find_mesh(urdf: Path, name: str) -> Path | None:
    """The file of a mesh that a URDF file names, or None.

    A package is a folder above the URDF file or in ROS_PACKAGE_PATH, or a subfolder of these folders.
    """
    place = name.partition("://")[2] or name
    inside = place.partition("/")[2] if name.startswith("package://") else place
    folders = [Path(entry) for entry in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if entry]
    for folder in (*urdf.resolve().parents, *folders):
        for candidate in (folder / inside, folder / place):
            if candidate.is_file():
                return candidate
    return None


def read_mesh(file: Path) -> tuple[Array, NDArray[np.intp]]:
    """Corners (C, 3) [m] of a mesh's triangles and indices (E, 2) of the corners of its edges: STL, OBJ or DAE.

    Corners at equal positions are one corner.

    As in ROS, the unit of a DAE file applies and its up axis is ignored. No other file is opened: neither materials nor
    textures. Raises ValueError if the mesh is not valid, ImportError if trimesh or pycollada is missing.
    """
    trimesh = extra("trimesh", "a mesh's capsule", "clearance")
    kind = file.suffix.lower().removeprefix(".")
    if kind not in TYPES:
        raise ValueError(f"mesh {str(file)!r}: must be one of {', '.join(TYPES)}: convert the mesh")
    if kind == "dae":
        extra("collada", "a DAE mesh's capsule", "clearance")
    if file.stat().st_size > MAX_BYTES:
        raise ValueError(f"mesh {str(file)!r}: has more than {MAX_BYTES >> 20} MiB: must be smaller: simplify the mesh")
    try:
        with open(file, "rb") as opened:
            scene = trimesh.load_scene(opened, file_type=kind, process=False)
        mesh = scene.to_mesh()
        vertices, faces = np.array(mesh.vertices, dtype=float), np.array(mesh.faces)
        if scene.units not in (None, "meters"):
            vertices *= trimesh.units.unit_conversion(scene.units, "meters")
    except Exception as error:
        raise ValueError(f"mesh {str(file)!r}: must be a {kind} file that trimesh can read: {error}") from None
    if not len(faces) or not np.all(np.isfinite(vertices)):
        problem = "its vertices are not finite" if len(faces) else "has no triangles"
        raise ValueError(f"mesh {str(file)!r}: {problem}: must have triangles of finite vertices: export it again")
    each = np.ascontiguousarray(vertices + 0.0).view([("", float)] * 3).ravel()  # -0.0 + 0.0 is 0.0.
    _, first, corner = np.unique(each, return_index=True, return_inverse=True)
    return vertices[first], edges_of(corner[faces][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2))


def edges_of(pairs: NDArray[np.intp]) -> NDArray[np.intp]:
    """The different pairs of two different corners (E, 2), in either order."""
    low, high = np.sort(pairs, axis=1).T
    count = int(high.max(initial=0)) + 1
    both = np.unique(low[low < high] * count + high[low < high])
    return np.column_stack([both // count, both % count])
