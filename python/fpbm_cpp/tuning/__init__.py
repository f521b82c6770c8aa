"""Tuning: optimisation of the parameters of FPBM for an arm and a path."""

from .trials import Trials, TuneInterrupted, Tuning
from .tuner import tune

__all__ = ["Trials", "TuneInterrupted", "Tuning", "tune"]
