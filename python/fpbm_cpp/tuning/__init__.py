"""Tuning: optimisation of the parameters of FPBM for an arm and a path."""

from .result import Trials, Tuning
from .tuner import tune

__all__ = ["Trials", "Tuning", "tune"]
