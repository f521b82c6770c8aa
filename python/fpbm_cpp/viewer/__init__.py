"""The viewer: a page in the browser with the arm, the time and the scheme's parameters. Needs the extra 'view'.

The page asks for a scheme and a time (controls); the viewer makes the motion again; scene and readout draw it.
"""

import os
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from ..arms import Arm
from ..motion.simulation import simulate
from ..paths import Path
from ..schemes import Scheme

if TYPE_CHECKING:
    from .viewer import Viewer

__all__ = ["Viewer", "view"]


def __getattr__(name: str) -> Any:
    """Import Viewer, which needs viser, when it is first used."""
    if name != "Viewer":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from .viewer import Viewer

    return Viewer


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
    """Show an arm on its path in the browser, with sliders for the scheme's parameters, until Ctrl-C.

    Prints the page's address. The motion, as for simulate(), is made again whenever the scheme or a parameter is
    changed on the page; one that stops early is shown as far as it went. fpbm_cpp.viewer.Viewer does not wait.

    urdf is the arm's URDF file, whose meshes are drawn, with the joints that are not the arm's at zero; without it the
    arm is drawn as rods and cylinders. Only this machine can open the page, unless host is '0.0.0.0' or an address on a
    network. Port 0 takes a free one.

    Raises ValueError if an argument is out of range, or the URDF file is not that of the arm: nothing is served then;
    OSError if the port is in use, or the URDF file cannot be read; ImportError if the extra 'view' is missing.
    """
    from .viewer import Viewer

    run = simulate(arm, path, scheme, q0, dt=dt, hold=hold, task=task, partial=True)
    Viewer(run, urdf=urdf, host=host, port=port, open_browser=open_browser).wait()
