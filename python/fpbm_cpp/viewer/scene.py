"""The scene of an arm, and the scene of a run."""

from __future__ import annotations

import logging
import os
import warnings
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import yourdfpy
from viser import ClientHandle, LineSegmentsHandle, SceneApi, SceneNodeHandle, ViserServer
from viser.extras import ViserUrdf
from viser.transforms import SO3

from .._core import Nearest, rotation_vector
from .._types import Array
from ..arms import Arm, PlanarArm
from ..bounds import Bound, clearance_among, task_bounds_among
from ..clearance import Clearance
from ..robots import Robot
from ..skeleton import joint_points, joints_of, length, link_frames
from ..urdf.mesh_file import find_mesh
from .frames import in_space
from .playback import Playback
from .shapes import Shapes, along, draw_bounds

TIP, TARGET, START = (213, 94, 0), (40, 40, 40), (170, 176, 184)
LINK, JOINT, BASE = (196, 203, 212), (62, 84, 112), (110, 116, 124)
RADIUS = 0.019  # Radius of the links, relative to the length of the arm.
FIELD = 0.7  # Vertical field of view [rad].
BASE_JOINTS = ("base_x", "base_y", "base_yaw")  # Joints of Robot.from_urdf(base="planar"), which are not in the file.
TOLERANCE = 2e-3  # Largest distance between a joint in the URDF file and in the arm [m].


class Meshes:
    """The meshes of a robot's URDF file that exist; show() adds them to a scene.

    Raises ValueError if the file is of another robot, OSError if it cannot be read. Warns once about missing meshes.
    """

    def __init__(self, urdf: str | os.PathLike[str], arm: Arm | Robot, q: Array) -> None:
        self.file = Path(urdf)
        if isinstance(arm, PlanarArm):
            raise self._error("must not be given for a planar arm")
        self._arm = arm
        self.robot = self._read()
        there = self.robot.actuated_joint_names
        for name in arm.joint_names:
            if name not in (*there, *BASE_JOINTS):
                raise self._error(f"has no joint {name!r} of the arm; joints of the file: {', '.join(there)}")
        self._held = _held(self.robot, arm) if isinstance(arm, Robot) else {}
        self._links = {joint.name: i for i, joint in enumerate(joints_of(arm), 1) if joint.name in self.robot.joint_map}
        self.placement = self._placement(q)
        own = link_frames(arm, q)[list(self._links.values())]
        distances = np.linalg.norm((self.placement @ self._frames())[:, :3, 3] - own[:, :3, 3], axis=1)
        worst = int(distances.argmax())
        if distances[worst] > TOLERANCE:
            joint = f"joint {list(self._links)[worst]!r} is displaced by {distances[worst]:.3g} m from this arm's joint"
            raise self._error(f"must be of this arm: {joint}")
        self.found = bool(self.robot.scene.geometry)

    def show(self, server: ViserServer) -> None:
        self._root = server.scene.add_frame("/arm", show_axes=False)
        self._shown = ViserUrdf(server, self.robot, root_node_name="/arm")
        self._place()

    def pose(self, q: Array) -> None:
        self._shown.update_cfg(self.configuration(q))
        if isinstance(self._arm, Robot):  # The base may move.
            self.placement = self._placement(q)
            self._place()

    def configuration(self, q: Array) -> Array:
        """Positions of the joints in the file: the robot's positions; for other joints, the fixed position or 0."""
        own = self._held | dict(zip(self._arm.joint_names, q))
        return np.array([own.get(name, 0.0) for name in self.robot.actuated_joint_names])

    def _place(self) -> None:
        self._root.position = self.placement[:3, 3]
        self._root.wxyz = SO3.from_matrix(self.placement[:3, :3]).wxyz

    def _placement(self, q: Array) -> Array:
        """The root of the file in the frame of the robot's base, which may be another link."""
        self.robot.update_cfg(self.configuration(q))
        first = next(iter(self._links.values()))
        return np.asarray(link_frames(self._arm, q)[first] @ np.linalg.inv(self._frames()[0]))

    def _read(self) -> Any:
        self.file.read_bytes()  # yourdfpy does not report why a file cannot be read.
        missing: list[str] = []
        log = logging.getLogger("yourdfpy")
        level = log.level
        try:
            log.setLevel(logging.CRITICAL)  # yourdfpy logs several lines for every mesh.
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                robot = yourdfpy.URDF.load(str(self.file), filename_handler=partial(self._find, missing=missing))
        except Exception as error:
            raise self._error(f"must be a file that yourdfpy can read: {error}") from None
        finally:
            log.setLevel(level)
        if missing:
            count = len(set(missing))
            which = "1 mesh is not found:" if count == 1 else f"{count} meshes are not found, the first is"
            warnings.warn(f"{self.file}: {which} {missing[0]}: add the package to ROS_PACKAGE_PATH", stacklevel=4)
        return robot

    def _find(self, fname: str, missing: list[str]) -> str:
        found = find_mesh(self.file, fname)
        if found is None:
            missing.append(fname)
        return fname if found is None else str(found)

    def _frames(self) -> Array:
        """Frames of the joints in the file, in the frame of its root, for the present configuration."""
        links = (self.robot.joint_map[name].child for name in self._links)
        return np.array([self.robot.get_transform(link, self.robot.base_link) for link in links])

    def _error(self, text: str) -> ValueError:
        return ValueError(f"urdf = {str(self.file)!r}: {text}")


def _held(urdf: Any, robot: Robot) -> dict[str, float]:
    """Positions at which a robot fixes joints of its URDF file [rad, m], from the frames of the links."""
    places, held = {each.name: each.offset for each in robot.named_frames}, {}
    for name in urdf.actuated_joint_names:
        joint = urdf.joint_map[name]
        if name not in robot.joint_names and joint.parent in places and joint.child in places:
            origin = np.eye(4) if joint.origin is None else joint.origin
            step = np.linalg.inv(places[joint.parent] @ origin) @ places[joint.child]
            motion = step[:3, 3] if joint.type == "prismatic" else rotation_vector(step[:3, :3])
            held[name] = float(motion @ joint.axis) / float(np.linalg.norm(joint.axis))
    return held


class Scene:
    """An arm on the ground, the axes of its tip, and its bounds. The camera shows the given points."""

    def __init__(
        self,
        server: ViserServer,
        arm: Arm | Robot,
        q: Array,
        meshes: Meshes | None,
        points: Array,
        bounds: Sequence[Bound],
    ) -> None:
        self._server = server
        self._arm: Links | Meshes
        if meshes is not None and meshes.found:
            meshes.show(server)
            self._arm = meshes
        else:
            self._arm = Links(server.scene, arm, q)
        centre = (np.nanmin(points, axis=0) + np.nanmax(points, axis=0)) / 2
        self._radius = max(float(np.nanmax(np.linalg.norm(points - centre, axis=1))), 1e-3)
        _add_ground(server.scene, self._radius, isinstance(arm, PlanarArm))
        _place_camera(server, centre, self._radius, isinstance(arm, PlanarArm))
        size = 0.16 * self._radius
        self._tip = server.scene.add_frame("/tip", axes_length=size, axes_radius=0.06 * size)
        clearance = clearance_among(bounds)
        self._shapes = None if clearance is None else Shapes(server.scene, arm, clearance)
        draw_bounds(server.scene, task_bounds_among(bounds))

    def _add_lines(self, name: str, color: tuple[int, int, int], width: float) -> LineSegmentsHandle:
        """Lines without points."""
        nothing = np.zeros((0, 2, 3), dtype=np.float32)
        return self._server.scene.add_line_segments(name, nothing, color, thickness=width, thickness_units="screen")

    def _pose(self, q: Array, tip: Array, clearance: Clearance | None, nearest: Nearest | None) -> None:
        """Show a posture, the frame of the tip, shape (4, 4), and the shapes of the clearance."""
        self._arm.pose(q)
        self._tip.position, self._tip.wxyz = tip[:3, 3], SO3.from_matrix(tip[:3, :3]).wxyz
        if self._shapes is not None and clearance is not None:
            self._shapes.at(clearance, q, nearest)


class RunScene(Scene):
    """An arm on its path: show() draws start and target of a run, at() moves the arm to a sample."""

    def __init__(self, server: ViserServer, playback: Playback, meshes: Meshes | None, bounds: Sequence[Bound]) -> None:
        run = playback.run
        postures = in_space(joint_points(run.arm, run.q[playback.frames])).reshape(-1, 3)
        points = np.vstack([postures, *(target for _, target in playback.tracks)])
        super().__init__(server, run.arm, run.q[0], meshes, points, bounds)
        self._start = self._add_lines("/start", START, 2.0)
        self._target = self._add_lines("/target", TARGET, 2.0)
        self._path = self._add_lines("/tip_path", TIP, 5.0)

    def show(self, playback: Playback) -> None:
        self._playback, run = playback, playback.run
        self._start.points = rods(run.arm, run.q[0]).astype(np.float32)
        targets = [segments(target[playback.frames]) for _, target in playback.tracks]
        self._target.points = np.concatenate([target[::2] if len(target) > 50 else target for target in targets])

    def at(self, sample: int) -> None:
        """Move arm and tip to a sample, and draw the path up to this sample; for a stack, the paths of its tasks."""
        playback = self._playback
        self._pose(playback.run.q[sample], playback.pose(sample), playback.clearance, playback.nearest(sample))
        passed = [*playback.frames[: playback.frame(sample) + 1], sample]
        self._path.points = np.concatenate([segments(tip[passed]) for tip, _ in playback.tracks])


def segments(points: Array) -> Array:
    """The lines from each point to the next, shape (N - 1, 2, 3)."""
    return np.stack([points[:-1], points[1:]], axis=1).astype(np.float32)


def rods(arm: Arm | Robot, q: Array) -> Array:
    """Both ends of each link, shape (links, 2, 3)."""
    points = in_space(joint_points(arm, q))
    ends = np.stack([points[:-1], points[1:]], axis=1)
    return np.asarray(ends[~np.isnan(ends).any(axis=(1, 2))])


def _add_ground(scene: SceneApi, radius: float, planar: bool) -> None:
    """A grid under the arm, with cells for a motion within a ball of this radius."""
    cell = 10.0 ** np.floor(np.log10(radius))
    cell = cell / 2 if radius / cell < 3 else cell
    sizes = {"width": 40 * cell, "height": 40 * cell, "cell_size": cell / 2, "section_size": 2 * cell}
    under = (0.0, 0.0, -(0.1 if planar else 0.002) * radius)  # Below the joints.
    scene.add_grid("/ground", plane="xy", position=under, shadow_opacity=0.15, **sizes)


def _place_camera(server: ViserServer, centre: Array, radius: float, planar: bool) -> None:
    """View a planar arm from above, an arm in space from the side and above, with the whole ball in view."""
    server.scene.set_up_direction("+y" if planar else "+z")
    offset = np.array([0.0, 0.0, 1.0] if planar else [1.0, -1.3, 0.7])
    room = 1.1 if planar else 0.95  # From the side, an arm fills less of the ball.
    offset *= room * radius / np.sin(FIELD / 2) / np.linalg.norm(offset)
    camera = server.initial_camera
    camera.fov = FIELD
    camera.position, camera.look_at = centre + offset, centre
    camera.up = (0.0, 1.0, 0.0) if planar else (0.0, 0.0, 1.0)

    def step_back(client: ClientHandle) -> None:
        if client.camera.aspect < 1.0:  # On a narrow screen, the smaller field of view is horizontal.
            client.camera.position = centre + offset / client.camera.aspect

    server.on_client_connect(step_back)


class Links:
    """A rod for each link, a cylinder along the axis of each revolute joint, and a box along each prismatic joint."""

    def __init__(self, scene: SceneApi, arm: Arm | Robot, q: Array) -> None:
        self._arm = arm
        r = RADIUS * max(length(arm, q), 1e-3)
        scene.add_cylinder("/arm/base", 2.6 * r, 0.8 * r, BASE)
        self._links = [scene.add_cylinder(f"/arm/link_{i}", r, 1.0, LINK) for i in range(len(rods(arm, q)))]
        self._joints: list[SceneNodeHandle] = [
            scene.add_box(f"/arm/joint_{i}", JOINT, (3.0 * r, 3.0 * r, 3.4 * r))
            if joint.type == "prismatic"
            else scene.add_cylinder(f"/arm/joint_{i}", 1.5 * r, 3.4 * r, JOINT)
            for i, joint in enumerate(joints_of(arm))
        ]
        self._axes = [joint.axis for joint in joints_of(arm)]
        self.pose(q)

    def pose(self, q: Array) -> None:
        for link, (start, end) in zip(self._links, rods(self._arm, q)):
            span = float(np.linalg.norm(end - start))
            link.visible = span > 1e-9
            if link.visible:
                link.scale = (1.0, 1.0, span)
                link.position, link.wxyz = (start + end) / 2, along(end - start)
        for joint, frame, axis in zip(self._joints, link_frames(self._arm, q)[1:], self._axes):
            joint.position, joint.wxyz = frame[:3, 3], along(frame[:3, :3] @ axis)
