"""Schemes as what they were made with: a kind, its gains, and the options that all kinds share."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._core import FPBM, MAN, MVN, WMVN, Balanced, Scheme, WMVNAcceleration
from .._scheme import arguments

KINDS: dict[str, type[Scheme]] = {kind.__name__: kind for kind in (MVN, WMVN, MAN, WMVNAcceleration, Balanced, FPBM)}

# What each kind takes besides the options that all share.
GAINS = {
    "MVN": ("k",),
    "WMVN": ("k", "weights"),
    "MAN": ("null_damping",),
    "WMVNAcceleration": ("null_damping", "weights"),
    "Balanced": ("alpha", "null_damping", "weights"),
    "FPBM": ("alpha", "k1", "k2", "null_damping", "weights"),
}

# Of gains that a scheme has not, once another is chosen that has them.
DEFAULTS = {"alpha": 0.6, "k": 0.0, "k1": 10.0, "k2": 25.0, "null_damping": 0.0}


class Family:
    """Schemes that differ from one in their kind and gains alone: rest posture, second task and so on stay."""

    def __init__(self, scheme: Scheme, dof: int) -> None:
        given = arguments(scheme)
        self.kind = type(scheme).__name__
        self.gains: dict[str, Any] = {**DEFAULTS, "weights": np.ones(dof)}  # float() makes numbers of all but weights.
        self.gains.update({name: np.asarray(given.pop(name), dtype=float) for name in GAINS[self.kind]})
        self.options = given

    def scheme(self, kind: str, gains: dict[str, Any]) -> Scheme:
        """One of them. Raises ValueError where a gain is out of range."""
        taken = {name: gains[name] for name in GAINS[kind]}
        return KINDS[kind](**taken, **self.options)
