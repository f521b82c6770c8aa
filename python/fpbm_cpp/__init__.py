"""Redundancy resolution for robot arms in closed form.

If an arm has more joints than its task has rows, many joint motions give the same tip motion. A scheme selects a joint
motion at joint-velocity level (MVN, WMVN) or at joint-acceleration level (MAN, WMVNAcceleration, Balanced, FPBM). Units
are radians, metres and seconds. Numbers in brackets are the equations of Wang et al., IEEE Access 2019.
"""

from . import arms, joints, paths, robots, schemes, tasks
from ._core import (
    MAX_DOF,
    InverseKinematics,
    JointStream,
    Kinematics,
    Limiter,
    Nearest,
    PathFollower,
    PoseStream,
    Posture,
    Postures,
    SaturatedLevels,
    SaturatedMotion,
    Status,
    TargetFilter,
    Tick,
    Tracker,
    __version__,
    failed,
    rotation,
    rotation_vector,
    saturate,
)
from .arms import *
from .capsule import Capsule
from .clearance import Clearance
from .errors import ParameterError, ResolutionError, UrdfWarning
from .io.run_file import load
from .joints import *
from .motion.comparison import Comparison, comparison
from .motion.fastest import fastest
from .motion.run import Run
from .motion.run_data import RunStatus
from .motion.simulation import simulate, track
from .motion.start_posture import PathFailure, StartPosture, start_posture
from .motion.sweeping import Sweep, SweepInterrupted, sweep
from .obstacle import Cuboid, HalfSpace
from .paths import *
from .robots import *
from .schemes import *
from .task_bounds import TaskBounds
from .tasks import *
from .torque_bounds import TorqueBounds
from .tuning import TuneInterrupted, Tuning, tune
from .viewer import servo, view

__all__ = ["Run", "RunStatus", "Sweep", "Tuning", "load", "simulate", "sweep", "track", "tune"]
__all__ += ["Comparison", "comparison", "fastest", "servo", "view"]
__all__ += ["Capsule", "Clearance", "Cuboid", "HalfSpace", "Nearest"]
__all__ += ["InverseKinematics", "PathFailure", "Posture", "Postures", "StartPosture", "start_posture"]
__all__ += ["JointStream", "Kinematics", "Limiter", "PathFollower", "PoseStream", "SaturatedMotion"]
__all__ += ["Status", "TargetFilter", "Tick"]
__all__ += ["SaturatedLevels", "TaskBounds", "TorqueBounds", "Tracker", "failed", "saturate"]
__all__ += ["MAX_DOF", "ParameterError", "ResolutionError", "SweepInterrupted", "TuneInterrupted", "UrdfWarning"]
__all__ += ["__version__", "rotation", "rotation_vector"]
__all__ += arms.__all__ + joints.__all__ + paths.__all__ + robots.__all__ + schemes.__all__ + tasks.__all__
