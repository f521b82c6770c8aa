"""An arm drawn with the meshes of its URDF file."""

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

from .._types import Array
from ..arms import Arm, SerialArm
from ..skeleton import joint_points

TOLERANCE = 2e-3  # Between a joint of the file and of the arm [m].


class Meshes:
    """The meshes of an arm's URDF file, as far as they are found; show() puts them into a scene.

    Raises ValueError if it is not that arm's file, OSError if it cannot be read. Warns once about missing meshes.
    """

    def __init__(self, urdf: str | os.PathLike[str], arm: Arm, q: Array) -> None:
        self.file = Path(urdf)
        if not isinstance(arm, SerialArm):
            raise self._error("must be left out where the arm is planar")
        self._arm = arm
        self.robot = self._read()
        there = self.robot.actuated_joint_names
        for name in arm.joint_names:
            if name not in there:
                raise self._error(f"has no joint {name!r}, which the arm has; its own: {', '.join(there)}")
        # The file's root, seen from the arm's base, which may be another link.
        self.placement: Array = arm.joints[0].placement @ np.linalg.inv(self._frames(np.zeros(arm.dof))[0])
        distances = np.linalg.norm((self.placement @ self._frames(q))[:, :3, 3] - joint_points(arm, q)[1:-1], axis=1)
        worst = int(distances.argmax())
        if distances[worst] > TOLERANCE:
            joint = f"its joint {arm.joints[worst].name!r} is {distances[worst]:.3g} m from where this arm has it"
            raise self._error(f"is another arm's: {joint}")
        self.found = bool(self.robot.scene.geometry)

    def show(self, server: ViserServer) -> None:
        rotation = SO3.from_matrix(self.placement[:3, :3]).wxyz
        server.scene.add_frame("/arm", show_axes=False, wxyz=rotation, position=self.placement[:3, 3])
        self._shown = ViserUrdf(server, self.robot, root_node_name="/arm")

    def pose(self, q: Array) -> None:
        self._shown.update_cfg(self.configuration(q))

    def configuration(self, q: Array) -> Array:
        """Positions of the file's own joints: the arm's, and 0 for all others."""
        own = dict(zip(self._arm.joint_names, q))
        return np.array([own.get(name, 0.0) for name in self.robot.actuated_joint_names])

    def _read(self) -> Any:
        with self.file.open("rb"):  # yourdfpy's own error does not say why it cannot be read.
            pass
        missing: list[str] = []
        log = logging.getLogger("yourdfpy")
        level = log.level
        try:
            log.setLevel(logging.CRITICAL)  # It logs several lines for every mesh.
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                robot = yourdfpy.URDF.load(str(self.file), filename_handler=partial(self._find, missing=missing))
        except Exception as error:
            raise self._error(f"yourdfpy cannot read it: {error}") from None
        finally:
            log.setLevel(level)
        if missing:
            count = len(set(missing))
            which = "1 mesh is not found:" if count == 1 else f"{count} meshes are not found, the first is"
            warnings.warn(f"{self.file}: {which} {missing[0]}", stacklevel=4)
        return robot

    def _find(self, fname: str, missing: list[str]) -> str:
        """The file of a mesh. A package is any folder above the URDF file, or a folder in one of those."""
        place = fname.partition("://")[2] or fname
        inside = place.partition("/")[2] if fname.startswith("package://") else place
        folders = [Path(entry) for entry in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if entry]
        for folder in (*self.file.resolve().parents, *folders):
            for candidate in (folder / inside, folder / place):
                if candidate.is_file():
                    return str(candidate)
        missing.append(fname)
        return fname

    def _frames(self, q: Array) -> Array:
        """Frames of the arm's joints in the file, seen from its root."""
        self.robot.update_cfg(self.configuration(q))
        links = (self.robot.joint_map[joint.name].child for joint in self._arm.joints)
        return np.array([self.robot.get_transform(link, self.robot.base_link) for link in links])

    def _error(self, text: str) -> ValueError:
        return ValueError(f"urdf = {str(self.file)!r}: {text}")
