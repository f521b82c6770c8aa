"""The panels that a figure of a motion may have, by name."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ..motion.run import Run
from .arm import arm_panel
from .errors import error_panel, orientation_error_panel, tip_error_panel
from .joints import acceleration_panel, position_panel, velocity_panel
from .limits import saturation_panel, scale_panel
from .measures import manipulability_panel, null_space_panel
from .theme import Theme


@dataclass(frozen=True)
class Panel:
    """A panel: its heading, its function, whether it has a line for each joint, and whether a run has data for it."""

    heading: str
    draw: Callable[[Any, Run, Theme], None]
    of_joints: bool = False
    suits: Callable[[Run], bool] = lambda run: True


PANELS = {
    "arm": Panel("Arm", arm_panel),
    "error": Panel("Tip error", tip_error_panel),
    "axis_errors": Panel("Tip error", error_panel),
    "axis_orientation_errors": Panel(
        "Orientation error", orientation_error_panel, suits=lambda run: run.task == "pose"
    ),
    "positions": Panel("Joint positions", position_panel, of_joints=True),
    "velocities": Panel("Joint velocities", velocity_panel, of_joints=True),
    "accelerations": Panel("Joint accelerations", acceleration_panel, of_joints=True),
    "saturation": Panel("Joints on a bound", saturation_panel, suits=lambda run: run.saturated is not None),
    "scale": Panel("Share of the task kept", scale_panel, suits=lambda run: run.scale is not None),
    "manipulability": Panel("Manipulability", manipulability_panel),
    "null_space": Panel("Null-space velocity", null_space_panel),
}
OVERVIEW = tuple(name for name in PANELS if not name.startswith("axis"))


def choose(run: Run, panels: str | Sequence[str] | None) -> list[str]:
    """The panels asked for, or OVERVIEW, without those that the run has no data for. Raises ValueError."""
    asked = OVERVIEW if panels is None else (panels,) if isinstance(panels, str) else tuple(panels)
    for name in asked:
        if name not in PANELS:
            raise ValueError(f"panels: {name!r} must be one of {', '.join(PANELS)}")
        if asked.count(name) > 1:
            raise ValueError(f"panels: {name!r} is given twice")
    names = [name for name in asked if PANELS[name].suits(run)]
    if not names:
        raise ValueError(f"panels: {asked} leave nothing to draw of this run")
    return names
