"""Figures and films of motions, in the size and text of a paper, on white or on black.

One motion by compose() and Run.plot(), several by compare(), in motion by animate(); each panel is a function of axes
and run, for figures of one's own. Nothing here touches matplotlib.pyplot: figures are objects without global state,
made as well without a display or in several threads. Show one with IPython's display(run.plot()) or write it with
run.plot().savefig("run.pdf").

Data flows one way: theme ← lines ← panels (arm, errors, joints, limits, measures) ← compose, compare, animate.
"""

from __future__ import annotations

try:
    import matplotlib as _matplotlib  # noqa: F401
except ModuleNotFoundError as missing:
    raise ImportError('plotting needs matplotlib: pip install "fpbm_cpp[plot]"') from missing

from ..skeleton import joint_points
from .animate import animate
from .arm import arm_panel
from .compare import compare
from .compose import compose, plot_run
from .errors import error_panel, tip_error_panel, turn_error_panel
from .joints import acceleration_panel, position_panel, velocity_panel
from .limits import saturation_panel, scale_panel
from .measures import least_singular_values, manipulability_panel, null_space_panel, null_space_velocities
from .panels import OVERVIEW, PANELS
from .theme import DARK, DASHES, LIGHT, OKABE_ITO, Theme

__all__ = [
    "DARK",
    "DASHES",
    "LIGHT",
    "OKABE_ITO",
    "OVERVIEW",
    "PANELS",
    "Theme",
    "acceleration_panel",
    "animate",
    "arm_panel",
    "compare",
    "compose",
    "error_panel",
    "joint_points",
    "least_singular_values",
    "manipulability_panel",
    "null_space_panel",
    "null_space_velocities",
    "plot_run",
    "position_panel",
    "saturation_panel",
    "scale_panel",
    "tip_error_panel",
    "turn_error_panel",
    "velocity_panel",
]
