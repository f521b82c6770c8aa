"""Tuning: optimisation of the parameters of FPBM for an arm and a path."""

from .result import TuneInterrupted, Tuning
from .trials import Trials
from .tuner import tune

__all__ = ["Trials", "TuneInterrupted", "Tuning", "tune"]
