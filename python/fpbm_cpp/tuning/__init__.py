"""Tuning: the parameters of FPBM that suit an arm and a path best.

Data flows one way: space (schemes) → search (which to try) → trials (what came of them) → result.
"""

from .result import TuneInterrupted, Tuning
from .trials import Trials
from .tune import tune

__all__ = ["Trials", "TuneInterrupted", "Tuning", "tune"]
