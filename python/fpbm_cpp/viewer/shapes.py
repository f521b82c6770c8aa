"""Shapes of a clearance in the scene: capsules on the links, obstacles, and the nearest pair."""

from collections.abc import Sequence

import numpy as np
from trimesh.creation import capsule as capsule_mesh
from viser import SceneApi, SceneNodeHandle
from viser.transforms import SO3

from .._core import Nearest
from .._types import Array
from ..arms import Arm
from ..capsule import Capsule
from ..clearance import Clearance
from ..obstacle import Cuboid, HalfSpace, Obstacle
from ..robots import Robot
from ..skeleton import link_frames
from ..task_bounds import TaskBounds
from ..tasks import PositionTask
from .frames import z_to

BODY, OBSTACLE, GAP = (0, 114, 178), (230, 159, 0), (204, 121, 167)
FACES = (16, 24)  # Faces of a capsule, along and around its axis.
SLAB = 1.5  # A half-space is shown as a square of this half width [m].


def draw_bounds(scene: SceneApi, bounds: Sequence[TaskBounds]) -> None:
    """Draw the box of the bounds of a position, if all sides are bounded."""
    for i, each in enumerate(bounds):
        if isinstance(each.task, PositionTask):
            lower, upper = np.array(each.lower_corner), np.array(each.upper_corner)
            if np.all(np.isfinite(upper - lower)):
                place = (lower + upper) / 2
                scene.add_box(f"/bounds_{i}", OBSTACLE, upper - lower, wireframe=True, position=place)


class Shapes:
    """Translucent capsules and obstacles, and a line between the two nearest shapes."""

    def __init__(self, scene: SceneApi, arm: Arm | Robot, clearance: Clearance) -> None:
        self._arm = arm
        used = {each.link for each in clearance.capsules}
        self._links = {link: scene.add_frame(f"/clear/link_{link}", show_axes=False) for link in sorted(used)}
        for i, each in enumerate(clearance.capsules):
            _add(scene, f"/clear/link_{each.link}/{i}", each, BODY, 0.25)
        self._obstacles = [
            _add(scene, f"/clear/obstacle_{i}", each, OBSTACLE, 0.5) for i, each in enumerate(clearance.obstacles)
        ]
        nothing = np.zeros((0, 2, 3), dtype=np.float32)
        self._gap = scene.add_line_segments("/clear/gap", nothing, GAP, thickness=5.0, thickness_units="screen")

    def at(self, clearance: Clearance, q: Array, nearest: Nearest | None) -> None:
        """Show the capsules in a posture, obstacles at their present places, and a line between the nearest shapes."""
        frames = link_frames(self._arm, q)
        for link, node in self._links.items():
            node.position, node.wxyz = frames[link, :3, 3], SO3.from_matrix(frames[link, :3, :3]).wxyz
        for node, shape in zip(self._obstacles, clearance.obstacles):
            node.position = centre(shape)
        self._gap.visible = nearest is not None
        if nearest is not None:
            self._gap.points = nearest.points[None].astype(np.float32)


def centre(shape: Obstacle) -> Array:
    """Place of a shape [m]; for a half-space, the point of its surface that is nearest to the base frame's origin."""
    if isinstance(shape, HalfSpace):
        return np.asarray(shape.offset * shape.normal / np.linalg.norm(shape.normal))
    return np.asarray(shape.pose[:3, 3] if isinstance(shape, Cuboid) else (shape.a + shape.b) / 2)


def _add(scene: SceneApi, name: str, shape: Obstacle, color: tuple[int, int, int], opacity: float) -> SceneNodeHandle:
    """A shape at its given place."""
    looks = {"opacity": opacity, "cast_shadow": False, "position": centre(shape)}
    if isinstance(shape, Capsule):
        axis = shape.b - shape.a
        length = float(np.linalg.norm(axis))
        mesh = capsule_mesh(length, max(shape.radius, 1e-6), FACES)
        turn = along(axis) if length > 1e-12 else (1.0, 0.0, 0.0, 0.0)
        return scene.add_mesh_simple(name, mesh.vertices, mesh.faces, color=color, wxyz=turn, **looks)
    if isinstance(shape, Cuboid):
        turn = SO3.from_matrix(shape.pose[:3, :3]).wxyz
        return scene.add_box(name, color, 2.0 * shape.half, wxyz=turn, **looks)
    return scene.add_box(name, color, (2.0 * SLAB, 2.0 * SLAB, 1e-3), wxyz=along(shape.normal), **looks)


def along(direction: Array) -> Array:
    """Quaternion (w, x, y, z) of a rotation that turns the z axis to a direction."""
    return np.asarray(SO3.from_matrix(z_to(direction)).wxyz)
