"""How much the objective changes when one parameter of a scheme takes a step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..schemes import FPBM
from .space import tunable
from .trials import Trials

ALPHA_STEP, STEP = 0.05, 0.1

Neighbours = Mapping[tuple[str, int], FPBM]


def numbers(scheme: FPBM) -> dict[str, float]:
    """A scheme's tunable parameters, with a name for each number: 'weights[0]' and so on."""
    return {
        f"{name}[{i}]" if np.ndim(value) else name: entry
        for name, value in tunable(scheme).items()
        for i, entry in enumerate(np.atleast_1d(value).tolist())
    }


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
                around[name, sign] = _with(scheme, name, stepped)
    return around


def changes(scheme: FPBM, value: float, around: Neighbours, trials: Trials) -> dict[str, tuple[float, float]]:
    """What each step adds to a scheme's value, from the trials of its neighbours in order; see Tuning.sensitivity."""
    added = dict(zip(around, np.where(trials.feasible, trials.value - value, np.inf).tolist()))
    return {name: (added.get((name, -1), np.nan), added.get((name, 1), np.nan)) for name in numbers(scheme)}


def _with(scheme: FPBM, name: str, value: float) -> FPBM:
    """The scheme with another value of one number."""
    parameter, _, index = name.rstrip("]").partition("[")
    changed: Any = value
    if index:
        changed = np.array(getattr(scheme, parameter))
        changed[int(index)] = value
    return replace(scheme, **{parameter: changed})
