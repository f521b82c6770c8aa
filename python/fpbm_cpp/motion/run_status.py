"""How a motion ended."""

from dataclasses import dataclass

import numpy as np

from .._core import Status, advice, failed, message
from .._types import Array


@dataclass(frozen=True)
class RunStatus:
    """How a motion ended: why, when, and where.

    Attributes
    ----------
    code : Status
        Status.OK, DAMPED or SLOWED if the whole motion is done; otherwise why it stopped.
    time : float
        Time of the last sample [s].
    q : numpy.ndarray, shape (n,)
        Joint positions there [rad].
    """

    code: Status
    time: float
    q: Array

    @property
    def ok(self) -> bool:
        """Whether the whole motion is done."""
        return not failed(self.code)

    @property
    def advice(self) -> str:
        """What to do about it; empty if all is well."""
        return advice(self.code)

    def __bool__(self) -> bool:
        return self.ok

    def __str__(self) -> str:
        if self.ok:
            remark = "" if self.code is Status.OK else f"; at times, {message(self.code)}. {self.advice}"
            return f"complete, t = {self.time:g} s{remark}"
        where = np.array2string(self.q, precision=4, separator=", ")
        return f"stopped after t = {self.time:g} s at q = {where}: {message(self.code)}. {self.advice}"
