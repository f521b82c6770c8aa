"""Figures and animations of motions, sized for a paper, on a white or a dark background.

plot_run() and Run.plot() draw one motion, compare() draws several, animate() writes an animation. Each panel is a
function of axes and run, for your own figures. This package does not use matplotlib.pyplot: figures are objects
without global state, and work without a display and in several threads. Show a figure with IPython's
display(run.plot()), or write it with run.plot().savefig("run.pdf").
"""

try:
    import matplotlib as _matplotlib  # noqa: F401
except ModuleNotFoundError as missing:
    raise ImportError('plotting needs matplotlib: pip install "fpbm_cpp[plot]"') from missing

from ..skeleton import joint_points
from . import panels
from .animation import animate
from .figures import compare, plot_run
from .panels import *
from .theme import DARK, DASHES, LIGHT, OKABE_ITO, Theme

__all__ = ["DARK", "DASHES", "LIGHT", "OKABE_ITO", "Theme", "animate", "compare", "joint_points", "plot_run"]
__all__ += panels.__all__
