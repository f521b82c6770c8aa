"""The scene: ground, arm, tip and paths, and the camera that sees them."""

from __future__ import annotations

import numpy as np
from viser import ClientHandle, SceneApi, ViserServer
from viser.transforms import SO3

from .._core import PlanarArm
from .._types import Array
from ..skeleton import joint_points
from .colours import START, TARGET, TIP
from .film import Film
from .links import Links
from .meshes import Meshes, Model
from .space import in_space

FIELD = 0.7  # Of view, from below to above [rad].


class Scene:
    """An arm on its path: show() puts a run into it, at() a time of the run."""

    def __init__(self, server: ViserServer, film: Film, model: Model | None) -> None:
        self._server = server
        arm = film.run.arm
        q = film.q[0]
        self._flat = isinstance(arm, PlanarArm)
        self._arm: Links | Meshes
        if model is not None and model.has_meshes:
            self._arm = Meshes(server, model, q)
        else:
            self._arm = Links(server.scene, arm, q)
        centre, radius = _ball(film)
        self._ground(server.scene, radius)
        self._camera(server, centre, radius)
        size = 0.16 * radius
        self._tip = server.scene.add_frame("/tip", axes_length=size, axes_radius=0.06 * size)
        nothing = np.zeros((0, 2, 3), dtype=np.float32)
        lines = ("/start", START, 2.0), ("/target", TARGET, 2.0), ("/tip_path", TIP, 5.0)
        self._start, self._target, self._path = (
            server.scene.add_line_segments(name, nothing, color, thickness=width, thickness_units="screen")
            for name, color, width in lines
        )

    def show(self, film: Film) -> None:
        """Lay a run into the scene."""
        self._film = film
        self._start.points = _segments(in_space(joint_points(film.run.arm, film.q[0])))
        target = _segments(film.target)
        self._target.points = target[::2] if len(target) > 50 else target  # Dashes.

    def at(self, sample: int) -> None:
        """Put arm and tip where they are at a sample, with the way that the tip has come."""
        film = self._film
        pose = film.pose(sample)
        with self._server.atomic():
            self._arm.pose(film.q[sample])
            self._tip.position, self._tip.wxyz = pose[:3, 3], SO3.from_matrix(pose[:3, :3]).wxyz
            way = film.tip[: film.frame(sample) + 1]
            self._path.points = _segments(np.vstack([way, pose[None, :3, 3]]))

    def _ground(self, scene: SceneApi, radius: float) -> None:
        cell = 10.0 ** np.floor(np.log10(radius))
        cell = cell / 2 if radius / cell < 3 else cell
        scene.add_grid(
            "/ground",
            width=40 * cell,
            height=40 * cell,
            plane="xy",
            cell_size=cell / 2,
            section_size=2 * cell,
            position=(0.0, 0.0, -(0.1 if self._flat else 0.002) * radius),  # Under the joints.
            shadow_opacity=0.15,
        )

    def _camera(self, server: ViserServer, centre: Array, radius: float) -> None:
        """From above on an arm in the plane, from aside and above on one in space, with all of the motion in view."""
        server.scene.set_up_direction("+y" if self._flat else "+z")
        way = np.array([0.0, 0.0, 1.0] if self._flat else [1.0, -1.3, 0.7])
        room = 1.1 if self._flat else 0.95  # Seen from aside, a ball about an arm is emptier.
        way *= room * radius / np.sin(FIELD / 2) / np.linalg.norm(way)
        camera = server.initial_camera
        camera.fov = FIELD
        camera.position, camera.look_at = centre + way, centre
        camera.up = (0.0, 1.0, 0.0) if self._flat else (0.0, 0.0, 1.0)

        def step_back(client: ClientHandle) -> None:
            if client.camera.aspect < 1.0:  # The field of view is from below to above.
                client.camera.position = centre + way / client.camera.aspect

        server.on_client_connect(step_back)


def _ball(film: Film) -> tuple[Array, float]:
    """Centre and radius of a ball about the arm in all its postures and its targets."""
    run = film.run
    postures = in_space(joint_points(run.arm, film.q[film.frames])).reshape(-1, 3)
    points = np.vstack([postures, film.target])
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    return centre, max(float(np.linalg.norm(points - centre, axis=1).max()), 1e-3)


def _segments(points: Array) -> Array:
    """A line through points as pieces, each from a point to the next."""
    pieces: Array = np.stack([points[:-1], points[1:]], axis=1).astype(np.float32)
    return pieces
