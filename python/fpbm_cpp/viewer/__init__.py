"""Pages in the browser, which need the extra 'view': a motion, and an arm that follows a handle.

On the viewer's page, the user selects a scheme and a time (controls). The viewer repeats the motion; scene and readout
draw the motion. On the servo's page, the user drags a target (handle). The loop runs ticks in real time;
live_scene and readout draw the ticks. All pages draw the shapes of the clearance (shapes).
"""

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from .._core import TargetFilter
from ..arms import Arm
from ..bounds import Bound
from ..joints import JointLimits
from ..motion.run_data import Paths
from ..motion.simulation import simulate
from ..robots import Robot
from ..schemes import Scheme
from ..tasks import Stack

if TYPE_CHECKING:
    from .servoing import Servo
    from .viewer import Viewer

__all__ = ["Servo", "Viewer", "servo", "view"]


def __getattr__(name: str) -> Any:
    """Import Servo and Viewer, which need viser, on first use."""
    if name not in ("Servo", "Viewer"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        from .servoing import Servo
        from .viewer import Viewer
    except ModuleNotFoundError as missing:
        raise ImportError('viewing needs viser: pip install "fpbm_cpp[view]"') from missing
    return {"Servo": Servo, "Viewer": Viewer}[name]


def view(
    arm: Arm | Robot,
    path: Paths,
    scheme: Scheme,
    q0: ArrayLike,
    *,
    dt: float = 1e-3,
    hold: float = 0.0,
    task: str | None = None,
    stack: Stack | None = None,
    urdf: str | os.PathLike[str] | None = None,
    host: str = "127.0.0.1",
    port: int = 8080,
    open_browser: bool = True,
) -> None:
    """Show an arm on its path in the browser, with sliders for the scheme's parameters, until Ctrl-C.

    Prints the address of the page. A change of the scheme or of a parameter on the page repeats the motion by
    simulate(), or by track() if the page keeps joint limits. A motion that stops early is shown up to the stop. For a
    stack, one task follows the path, and the page shows the errors of all tasks. The class fpbm_cpp.viewer.Viewer
    serves the page without waiting.

    urdf is the URDF file of the arm. The meshes of the file are drawn. Joints that the arm does not have are at zero.
    Without urdf, the arm is drawn as rods and cylinders. Only this machine can open the page, unless host is '0.0.0.0'
    or an address on a network. Port 0 selects a free port.

    Raises ValueError if an argument is out of range, or if the URDF file is of another arm; nothing is served then.
    Raises OSError if the port is in use or the URDF file cannot be read, ImportError if the extra 'view' is missing.
    """
    from . import Viewer

    run = simulate(arm, path, scheme, q0, dt=dt, hold=hold, task=task, stack=stack, partial=True)
    Viewer(run, urdf=urdf, host=host, port=port, open_browser=open_browser).wait()


def servo(
    arm: Arm | Robot,
    scheme: Scheme,
    q0: ArrayLike,
    *,
    task: str = "position",
    stack: Stack | None = None,
    dt: float = 1e-3,
    limits: JointLimits | None = None,
    targets: TargetFilter | Mapping[str, TargetFilter] | None = None,
    bounds: Sequence[Bound] = (),
    urdf: str | os.PathLike[str] | None = None,
    host: str = "127.0.0.1",
    port: int = 8080,
    open_browser: bool = True,
) -> None:
    """Show an arm in the browser with a handle that the tip follows in real time, until Ctrl-C.

    Prints the address of the page. A Tracker moves the arm with one tick per dt on the clock. All bounds of limits
    hold, also through singular postures and at the workspace boundary. On a machine that is too slow, the arm is
    delayed. The class fpbm_cpp.viewer.Servo serves the page without waiting.

    The positions of the handle, 20 per second, are the input of targets, a TargetFilter with its own bounds. The
    default bounds depend on the length L of the arm: L per second, 5 L/s^2, 100 L/s^3 and 2 rad/s, 10 rad/s^2,
    200 rad/s^3. A slider reduces the bounds on velocity to 5 to 100 %. task, dt, limits and bounds are as for Tracker;
    urdf, host and port are as for view(). Shapes of the clearance are translucent, with a line between the nearest
    shapes. Arrows move obstacles that are capsules or boxes, which follow the arrows at 0.3 m/s.

    A stack replaces task; a Robot needs a stack. Each frame task has a handle with the name of the task, unless the
    task is relative to another frame: arrows for a position, arcs for an orientation or an axis. The z axis of the
    handle of an AxisTask is the target direction. With a stack, targets is a dictionary of filters for positions and
    poses.

    Raises the errors of Tracker and view(), and ValueError if a filter is for another task or tick.
    """
    from . import Servo

    Servo(
        arm,
        scheme,
        q0,
        task=task,
        stack=stack,
        dt=dt,
        limits=limits,
        targets=targets,
        bounds=bounds,
        urdf=urdf,
        host=host,
        port=port,
        open_browser=open_browser,
    ).wait()
