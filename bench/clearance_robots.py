"""Arms with their clearances, and the collision meshes of these arms for Coal, for bench/clearance.py."""

from __future__ import annotations

import importlib
import re
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import fpbm_cpp as fp
from fpbm_cpp.obstacle import Obstacle

Array = NDArray[np.float64]
Pose = Callable[[Array], Array]  # Pose of a tip in a posture.

MARGIN = 0.01
JERK = 500.0  # Ratio of the bounds on jerk and acceleration, if the manufacturer gives no jerk [1/s]. From Franka.
UP = np.array([0.0, 0.0, 1.0])
NAMES = ("panda", "iiwa14", "gen3", "ur5e")


class Robot(NamedTuple):
    name: str
    arm: fp.SerialArm
    limits: fp.JointLimits
    clearance: fp.Clearance  # Self-collision only.
    meshes: Meshes


class Meshes:
    """Collision meshes of the links with capsules, and obstacles, in Coal. Pinocchio computes the placements."""

    def __init__(self, urdf: Path, joints: Sequence[str], tips: dict[str, Pose], clearance: fp.Clearance) -> None:
        """The poses of the tips by fpbm_cpp are compared with the poses by Pinocchio."""
        import pinocchio as pin

        self.pin = pin
        # Pinocchio represents the position of a continuous joint by a point on a circle. flat_urdf() has only angles.
        model = pin.buildModelFromUrdf(str(urdf))
        held = [i for i in range(1, model.njoints) if model.names[i] not in joints]
        geometry = pin.buildGeomFromUrdf(model, str(urdf), pin.GeometryType.COLLISION)
        kept = {each.name for each in clearance.capsules}
        for each in geometry.geometryObjects.copy():
            if model.frames[each.parentFrame].name not in kept:
                geometry.removeGeometryObject(each.name)
        self.model, self.geometry = pin.buildReducedModel(model, geometry, held, np.zeros(model.nq))
        self.data = self.model.createData()
        for tip, pose in tips.items():
            self._require_the_same(tip, pose)
        self.hulls = self._hulls()
        objects = self.geometry.geometryObjects
        self.links = [self.model.frames[each.parentFrame].name for each in objects]
        joint, parents = [each.parentJoint for each in objects], self.model.parents
        allowed = {frozenset(pair) for pair in clearance.allowed}
        self.pairs = [
            (i, j)
            for i in range(len(objects))
            for j in range(i)
            if joint[i] not in (joint[j], parents[joint[j]])
            and joint[j] != parents[joint[i]]
            and frozenset((self.links[i], self.links[j])) not in allowed
        ]
        self.moving = [i for i in range(len(objects)) if joint[i] > 0]

    def _require_the_same(self, tip: str, pose: Pose) -> None:
        for q in np.random.default_rng(0).uniform(-1, 1, (10, self.model.nq)):
            self.pin.framesForwardKinematics(self.model, self.data, q)
            off = np.abs(self.data.oMf[self.model.getFrameId(tip)].homogeneous - pose(q)).max()
            if off > 1e-9:
                raise SystemExit(f"{tip}: the pose differs from the pose by Pinocchio by {off:.1e}")

    def among(self, obstacles: Sequence[Obstacle]) -> Check:
        return Check(*(self._placed(geometry, obstacles) for geometry in (self.hulls, self.geometry)))

    def _hulls(self) -> Any:
        geometry = self.geometry.copy()
        for each in geometry.geometryObjects:
            if hasattr(each.geometry, "buildConvexHull"):
                each.geometry.buildConvexHull(False, "Qt")
                each.geometry = each.geometry.convex
        return geometry

    def _placed(self, links: Any, obstacles: Sequence[Obstacle]) -> Geometry:
        geometry = links.copy()
        for i, j in self.pairs:
            geometry.addCollisionPair(self.pin.CollisionPair(i, j))
        for obstacle in obstacles:
            shape, pose = coal_shape(obstacle)
            placed = self.pin.GeometryObject(obstacle.name, 0, self.pin.SE3(pose), shape)
            added = geometry.addGeometryObject(placed)
            for i in self.moving:
                geometry.addCollisionPair(self.pin.CollisionPair(i, added))
        return Geometry(self.pin, self.model, self.data, geometry, geometry.createData())


class Geometry(NamedTuple):
    pin: Any
    model: Any
    data: Any
    geometry: Any
    state: Any

    def meets(self, q: Array) -> bool:
        """Whether two links, or a link and an obstacle, are in contact."""
        return bool(self.pin.computeCollisions(self.model, self.data, self.geometry, self.state, q, True))

    def distance(self, q: Array) -> float:
        """Smallest distance of all pairs [m]."""
        self.pin.computeDistances(self.model, self.data, self.geometry, self.state, q)
        return min(float(each.min_distance) for each in self.state.distanceResults)


class Check(NamedTuple):
    """Meshes and their convex hulls. If the hulls are apart, the meshes are apart too. Hulls are faster to check."""

    hulls: Geometry
    meshes: Geometry

    def meets(self, q: Array) -> bool:
        """Whether two meshes, or a mesh and an obstacle, are in contact."""
        return self.hulls.meets(q) and self.meshes.meets(q)

    def distance(self, q: Array) -> float:
        """Smallest distance of all pairs of meshes [m]."""
        return self.meshes.distance(q)


def coal_shape(obstacle: Obstacle) -> tuple[Any, Array]:
    """The geometry of an obstacle in Coal, and the pose of this geometry."""
    import coal

    frame = np.eye(4)
    if isinstance(obstacle, fp.HalfSpace):
        # Within the workspace, a thick plate is equivalent. For a half-space, Coal would test all triangles of a mesh.
        half = np.array([2.0, 2.0, 0.5])
        middle = capsule_frame(fp.Capsule(0, [0, 0, 0], obstacle.normal, 0.0))[0]
        middle[:3, 3] = (obstacle.offset - half[2]) * middle[:3, 2]
        return coal.Box(*(2 * half)), middle
    if isinstance(obstacle, fp.Cuboid):
        return coal.Box(*(2 * obstacle.half)), np.array(obstacle.pose)
    frame, length = capsule_frame(obstacle)
    return coal.Capsule(obstacle.radius, length), frame


def capsule_frame(capsule: fp.Capsule) -> tuple[Array, float]:
    """The frame at the middle of a capsule with z along its segment, and the length of the segment."""
    segment = capsule.b - capsule.a
    length = float(np.linalg.norm(segment))
    z = segment / length if length > 0 else np.array([0.0, 0.0, 1.0])
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    frame = np.eye(4)
    frame[:3, :3] = np.stack((x, np.cross(z, x), z), axis=1)
    frame[:3, 3] = (capsule.a + capsule.b) / 2
    return frame, length


def presets() -> Any:
    """The script with the locations of the robot files."""
    folder = str(Path(__file__).parents[1] / "tools")
    if folder not in sys.path:
        sys.path.append(folder)
    return importlib.import_module("preset_capsules")


@contextmanager
def flat_urdf(name: str) -> Iterator[Path]:
    """The URDF file of a preset, with absolute paths of the meshes, and with continuous joints as revolute joints."""
    known = presets()
    with known.urdf_of(name) as given, tempfile.TemporaryDirectory() as folder:

        def whole(found: re.Match[str]) -> str:
            return f'filename="{known.find_mesh(given, found[1])}"'

        file = Path(folder) / "arm.urdf"
        text = re.sub(r'filename="([^"]*)"', whole, given.read_text())
        file.write_text(text.replace('type="continuous"', 'type="revolute"'))
        yield file


def robot(name: str) -> Robot:
    """A robot from its URDF file, with the limits of the preset."""
    known = presets()
    source = known.ARMS[name]
    with known.urdf_of(name) as given, flat_urdf(name) as flat:
        srdf = given.parents[1] / "srdf/panda.srdf"
        clearance = fp.Clearance.from_urdf(given, source.tip, srdf=srdf if srdf.exists() else None, margin=MARGIN)
        clearance = replace(clearance, allowed=[*clearance.allowed, *source.never_collide])
        arm = fp.SerialArm.from_urdf(given, source.tip)
        meshes = Meshes(flat, arm.joint_names, {source.tip: arm.forward}, clearance)
    limits = fp.SerialArm.preset(name).limits
    jerk = np.where(np.isfinite(limits.jerk), limits.jerk, JERK * limits.acceleration)
    return Robot(name, arm, replace(limits, jerk=jerk), clearance, meshes)
