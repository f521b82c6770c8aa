"""How much the objective changes when one number of a scheme takes a step."""

from collections.abc import Mapping

import numpy as np

from ..schemes import FPBM
from .space import numbers, with_numbers
from .trials import Trials

ALPHA_STEP, STEP = 0.05, 0.1

Neighbours = Mapping[tuple[str, int], FPBM]


def neighbours(scheme: FPBM) -> Neighbours:
    """The schemes one step away, by the number that steps and the step's sign; a number that cannot step has none.

    A step is ALPHA_STEP for alpha, within [0, 1], and the share STEP of the value for all others.
    """
    around: dict[tuple[str, int], FPBM] = {}
    for name, value in numbers(scheme).items():
        for sign in (-1, 1):
            alpha = min(max(value + sign * ALPHA_STEP, 0.0), 1.0)
            stepped = alpha if name == "alpha" else value * (1.0 + sign * STEP)
            if stepped != value:
                around[name, sign] = with_numbers(scheme, {name: stepped})
    return around


def changes(scheme: FPBM, value: float, around: Neighbours, trials: Trials) -> dict[str, tuple[float, float]]:
    """What each step adds to a scheme's value, from the trials of its neighbours in order; see Tuning.sensitivity."""
    added = dict(zip(around, np.where(trials.feasible, trials.value - value, np.inf).tolist()))
    return {name: (added.get((name, -1), np.nan), added.get((name, 1), np.nan)) for name in numbers(scheme)}
