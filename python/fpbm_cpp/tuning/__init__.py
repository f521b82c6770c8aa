"""Tuning: the parameters of FPBM that suit an arm and a path best.

Imports go one way: space (schemes), search (which to try), objectives (what for) → result → tuner.
"""

from .result import Trials, Tuning
from .tuner import tune

__all__ = ["Trials", "Tuning", "tune"]
