"""Tuning: the parameters of FPBM that suit an arm and a path best.

Imports go one way: space (schemes) → search (which to try) → trials (their motions) → result.
"""

from .result import Tuning
from .trials import Trials
from .tuner import tune

__all__ = ["Trials", "Tuning", "tune"]
