"""Pages in the browser: a motion, and an arm that follows a handle. They need the extra 'view'.

The viewer's page asks for a scheme and a time (controls); the viewer makes the motion again; scene and readout draw it.
The servo's page asks for a target (handle); the loop makes ticks at the pace of the clock; scene and live draw them.
Both draw what the arm keeps clear of (shapes).
"""

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from .._core import TargetFilter
from ..arms import Arm, JointLimits
from ..clearance import Clearance
from ..motion.run import Paths
from ..motion.simulation import simulate
from ..robots import Robot
from ..schemes import Scheme
from ..task_bounds import TaskBounds
from ..tasks import Stack

if TYPE_CHECKING:
    from .servoing import Servo
    from .viewer import Viewer

__all__ = ["Servo", "Viewer", "servo", "view"]


def __getattr__(name: str) -> Any:
    """Import Servo and Viewer, which need viser, when they are first used."""
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

    Prints the page's address. The motion, as for simulate(), is made again whenever the scheme or a parameter is
    changed on the page; one that stops early is shown as far as it went. Of a stack, the path is that of the task that
    follows it, and the errors are those of all tasks. fpbm_cpp.viewer.Viewer does not wait.

    urdf is the arm's URDF file, whose meshes are drawn, with the joints that are not the arm's at zero; without it the
    arm is drawn as rods and cylinders. Only this machine can open the page, unless host is '0.0.0.0' or an address on a
    network. Port 0 takes a free one.

    Raises ValueError if an argument is out of range, or the URDF file is not that of the arm: nothing is served then;
    OSError if the port is in use, or the URDF file cannot be read; ImportError if the extra 'view' is missing.
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
    clearance: Clearance | None = None,
    bounds: Sequence[TaskBounds] = (),
    urdf: str | os.PathLike[str] | None = None,
    host: str = "127.0.0.1",
    port: int = 8080,
    open_browser: bool = True,
) -> None:
    """Show an arm in the browser with a handle at its tip to drag, which it follows live, until Ctrl-C.

    Prints the page's address. The arm is moved by a Tracker, a tick each dt, as many as have passed on the clock: every
    bound of limits is kept, through singular postures and at the edge of reach. On a machine that is too slow, the arm
    is late. fpbm_cpp.viewer.Servo does not wait.

    The handle's places, 20 a second, go through targets, a TargetFilter with bounds of one's own. Unless given, the
    bounds suit the arm's length L: L per second, 5 L/s^2, 100 L/s^3 and 2 rad/s, 10 rad/s^2, 200 rad/s^3. task, dt,
    limits, clearance and bounds are those of Tracker, urdf, host and port those of view(). What the arm keeps clear of
    is drawn translucent, with a line between the nearest shapes; arrows move capsules and boxes of the surroundings,
    which follow them at 0.3 m/s.

    A stack replaces task, and a Robot needs one. Each of its tasks of a frame has a handle with the task's name, unless
    the task is relative to another frame: arrows for a position, arcs for an orientation or an axis. The z axis of the
    handle of an AxisTask is the target direction. targets is then a dictionary of filters for positions and poses.

    Raises what Tracker and view() raise, and ValueError where a filter is for another task or tick.
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
        clearance=clearance,
        bounds=bounds,
        urdf=urdf,
        host=host,
        port=port,
        open_browser=open_browser,
    ).wait()
