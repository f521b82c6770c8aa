"""How firm a choice is: what the objective does as one parameter steps aside."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .._core import FPBM
from .._scheme import arguments
from .space import parameters
from .trials import Trials

ALPHA_STEP, STEP = 0.05, 0.1

# Of each number of a scheme, by name, the scheme with a lower one and that with a higher, None where there is none.
Neighbours = Mapping[str, "tuple[FPBM | None, FPBM | None]"]


def flat(scheme: FPBM) -> dict[str, float]:
    """A scheme's parameters with a name for each number, weights[0] and so on."""
    values = parameters(scheme)
    weights = {f"weights[{i}]": float(weight) for i, weight in enumerate(values["weights"])}
    return {key: x for name in values for key, x in (weights.items() if name == "weights" else [(name, values[name])])}


def neighbours(scheme: FPBM) -> Neighbours:
    """The schemes a step away: ALPHA_STEP of alpha, within [0, 1], or the share STEP of all else."""
    return {name: (_stepped(scheme, name, -1.0), _stepped(scheme, name, 1.0)) for name in flat(scheme)}


def most_neighbours(scheme: FPBM) -> int:
    """How many neighbours there are at most."""
    return 2 * len(flat(scheme))


def every(around: Neighbours) -> list[FPBM]:
    """All neighbours, in order."""
    return [scheme for pair in around.values() for scheme in pair if scheme is not None]


def changes(value: float, around: Neighbours, trials: Trials) -> dict[str, tuple[float, float]]:
    """What each step adds to a value, from the trials of all neighbours in order; as in Tuning.sensitivity."""
    values = iter(np.where(trials.feasible, trials.value, np.inf).tolist())
    return {
        name: (np.nan if down is None else next(values) - value, np.nan if up is None else next(values) - value)
        for name, (down, up) in around.items()
    }


def _stepped(scheme: FPBM, name: str, side: float) -> FPBM | None:
    made, value = arguments(scheme), flat(scheme)[name]
    stepped = min(max(value + side * ALPHA_STEP, 0.0), 1.0) if name == "alpha" else value * (1.0 + side * STEP)
    if stepped == value:
        return None
    if name.startswith("weights"):
        weights = np.array(made["weights"], float)
        weights[int(name[len("weights[") : -1])] = stepped
        return FPBM(**{**made, "weights": weights})
    return FPBM(**{**made, name: stepped})
