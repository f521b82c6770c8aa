"""A motion in three dimensions, in the browser."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from ._core import Arm, Path, Scheme


def view(
    arm: Arm,
    path: Path,
    scheme: Scheme,
    q0: ArrayLike,
    *,
    dt: float = 1e-3,
    hold: float = 0.0,
    task: str = "position",
    urdf: str | os.PathLike[str] | None = None,
    host: str = "127.0.0.1",
    port: int = 8080,
    open_browser: bool = True,
) -> None:
    """Show an arm on its path in the browser, with the scheme and its gains at hand, until Ctrl-C.

    The motion is simulated anew, as simulate() does, whenever the scheme or a gain is changed at the page; one that
    must stop early is shown as far as it went. fpbm_cpp.viewer.Viewer does the same without waiting.

    Parameters
    ----------
    arm, path, scheme, q0, dt, hold, task
        As for simulate().
    urdf : path, optional
        The arm's URDF file, whose meshes are drawn; without it the arm is drawn from its own joints and links. Joints
        of the file that are not the arm's stay at zero.
    host : str
        Address to serve at: this machine alone sees the page, unless it is '0.0.0.0', or an address on a network.
    port : int
        Port to serve at; 0 takes one that is free.
    open_browser : bool
        Open the page in the browser.

    Raises
    ------
    ValueError
        Where an argument is out of range, or the URDF file is not that of the arm; nothing is served.
    OSError
        Where the port is in use, or the URDF file cannot be read.
    ImportError
        Where the extra 'view' is missing.
    """
    from .viewer import Viewer

    Viewer(
        arm,
        path,
        scheme,
        q0,
        dt=dt,
        hold=hold,
        task=task,
        urdf=urdf,
        host=host,
        port=port,
        open_browser=open_browser,
    ).wait()
