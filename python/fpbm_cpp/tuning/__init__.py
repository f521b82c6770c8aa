"""Tuning: the parameters of FPBM that suit an arm and a path best."""

from .result import Trials, Tuning
from .tuner import tune

__all__ = ["Trials", "Tuning", "tune"]
