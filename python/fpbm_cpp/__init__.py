"""Redundancy resolution for robot arms, in closed form.

An arm with more joints than its task needs must decide how every joint moves so that the tip follows its path. The
schemes here decide at joint-velocity level (MVN, WMVN) or joint-acceleration level (MAN, WMVNAcceleration, Balanced,
FPBM). Radians, metres, seconds throughout; numbers in brackets are the equations of Wang et al., IEEE Access 2019.
"""

from ._core import (
    FPBM,
    MAN,
    MAX_DOF,
    MVN,
    WMVN,
    Arm,
    Balanced,
    Circle,
    PathFollower,
    Gaze,
    JointLimits,
    Kinematics,
    Line,
    Lissajous,
    Path,
    PlanarArm,
    Scheme,
    SecondTask,
    Status,
    Tick,
    Tracker,
    Tricuspid,
    Waypoints,
    WMVNAcceleration,
    __version__,
    failed,
    rotation,
    rotation_vector,
)
from ._errors import ResolutionError, SweepInterrupted
from ._lanes import LANES
from .joint import Joint
from .run import Run, RunStatus, load
from .serial_arm import SerialArm
from .simulate import simulate
from .sweep import sweep
from .sweep_result import Sweep
from .track import track
from .tuning import TuneInterrupted, Tuning, tune
from .view import view

__all__ = [
    "FPBM",
    "LANES",
    "MAN",
    "MAX_DOF",
    "MVN",
    "WMVN",
    "Arm",
    "Balanced",
    "Circle",
    "PathFollower",
    "Gaze",
    "Joint",
    "JointLimits",
    "Kinematics",
    "Line",
    "Lissajous",
    "Path",
    "PlanarArm",
    "ResolutionError",
    "Run",
    "RunStatus",
    "Scheme",
    "SecondTask",
    "SerialArm",
    "Status",
    "Sweep",
    "SweepInterrupted",
    "Tick",
    "Tracker",
    "Tricuspid",
    "TuneInterrupted",
    "Tuning",
    "WMVNAcceleration",
    "Waypoints",
    "__version__",
    "failed",
    "load",
    "rotation",
    "rotation_vector",
    "simulate",
    "sweep",
    "track",
    "tune",
    "view",
]
