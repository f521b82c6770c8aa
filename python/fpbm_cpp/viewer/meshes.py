"""An arm drawn with the meshes of its URDF file."""

from __future__ import annotations

import logging
import os
import warnings
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import yourdfpy
from viser import ViserServer
from viser.extras import ViserUrdf
from viser.transforms import SO3

from .._core import Arm
from .._types import Array
from ..serial_arm import SerialArm
from ..skeleton import joint_points

TOLERANCE = 2e-3  # [m], between a joint in the file and in the arm.


class Model:
    """A URDF file that is that of an arm: its joints in their places, and its meshes as far as they are found.

    Raises ValueError where it is not that arm's, OSError where it cannot be read; one warning tells of missing meshes.
    """

    def __init__(self, urdf: str | os.PathLike[str], arm: Arm, q: Array) -> None:
        self.file = Path(urdf)
        if not isinstance(arm, SerialArm):
            raise ValueError(f"urdf = {str(self.file)!r}: must be left out where the arm is planar")
        self._arm = arm
        self.robot = self._read()
        self._require_joints()
        self.placement = self._place()
        self._require_same(q)
        self.has_meshes = bool(self.robot.scene.geometry)

    def configuration(self, q: Array) -> Array:
        """Positions of the file's own joints: the arm's, and 0 for all others."""
        own = dict(zip(self._arm.joint_names, q))
        return np.array([own.get(name, 0.0) for name in self.robot.actuated_joint_names])

    def _read(self) -> Any:
        with self.file.open("rb"):  # yourdfpy's own complaint does not say why it cannot.
            pass
        missing: list[str] = []
        log = logging.getLogger("yourdfpy")
        level = log.level
        try:
            log.setLevel(logging.CRITICAL)  # It says the same of every mesh, in several lines.
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                robot = yourdfpy.URDF.load(str(self.file), filename_handler=partial(self._find, missing=missing))
        except Exception as error:
            raise ValueError(f"urdf = {str(self.file)!r}: yourdfpy cannot read it: {error}") from None
        finally:
            log.setLevel(level)
        if missing:
            names = list(dict.fromkeys(missing))
            which = "1 mesh is not found:" if len(names) == 1 else f"{len(names)} meshes are not found, the first is"
            warnings.warn(f"{self.file}: {which} {names[0]}", stacklevel=5)
        return robot

    def _find(self, fname: str, missing: list[str]) -> str:
        """A mesh's file: package:// is any folder above the file's, or a folder in one of those."""
        place = fname.partition("://")[2] or fname
        inside = place.partition("/")[2] if fname.startswith("package://") else place
        folders = [Path(entry) for entry in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if entry]
        for folder in (*self.file.resolve().parents, *folders):
            for candidate in (folder / inside, folder / place):
                if candidate.is_file():
                    return str(candidate)
        missing.append(fname)
        return fname

    def _require_joints(self) -> None:
        there = self.robot.actuated_joint_names
        for name in self._arm.joint_names:
            if name not in there:
                raise ValueError(
                    f"urdf = {str(self.file)!r}: has no joint {name!r}, which the arm has; its own: {', '.join(there)}"
                )

    def _origins(self, q: Array) -> Array:
        """Frames of the arm's joints in the file, seen from its root."""
        self.robot.update_cfg(self.configuration(q))
        links = (self.robot.joint_map[joint.name].child for joint in self._arm.joints)
        return np.array([self.robot.get_transform(link, self.robot.base_link) for link in links])

    def _place(self) -> Array:
        """The file's root seen from the arm's base, which may be another link."""
        first = self._origins(np.zeros(self._arm.dof))[0]
        placement: Array = np.asarray(self._arm.joints[0].placement, dtype=float) @ np.linalg.inv(first)
        return placement

    def _require_same(self, q: Array) -> None:
        there = (self.placement @ self._origins(q))[:, :3, 3]
        off = np.linalg.norm(there - joint_points(self._arm, q)[1:-1], axis=1)
        worst = int(off.argmax())
        if off[worst] > TOLERANCE:
            raise ValueError(
                f"urdf = {str(self.file)!r}: is another arm's: its joint {self._arm.joints[worst].name!r} is"
                f" {off[worst]:.3g} m from where this arm has it"
            )


class Meshes:
    """The meshes of a model, in a scene."""

    def __init__(self, server: ViserServer, model: Model, q: Array) -> None:
        turn = SO3.from_matrix(model.placement[:3, :3]).wxyz
        server.scene.add_frame("/arm", show_axes=False, wxyz=turn, position=model.placement[:3, 3])
        self._model = model
        self._shown = ViserUrdf(server, model.robot, root_node_name="/arm")
        self.pose(q)

    def pose(self, q: Array) -> None:
        """Put the arm in a posture."""
        self._shown.update_cfg(self._model.configuration(q))
