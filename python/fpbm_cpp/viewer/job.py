"""What stays the same while schemes are tried: an arm, a path, a start."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .._core import Arm, JointLimits, Path, Scheme
from .._types import Array
from ..run import Run
from ..simulate import simulate
from ..track import track


@dataclass(frozen=True)
class Job:
    """One arm, one path, one start; run() does it under a scheme.

    limits : JointLimits or None
        What is kept where limits are to be kept, the arm's own where it is None.
    """

    arm: Arm
    path: Path
    q0: Array
    task: str
    options: dict[str, Any]
    limits: JointLimits | None = None

    @classmethod
    def of(cls, run: Run) -> Job:
        """What a run has done."""
        q0 = run.q[0] if len(run.q) else run.status.q
        options = {key: value for key, value in run.options.items() if key in ("dt", "hold", "qd0")}
        return cls(run.arm, run.path, q0.copy(), run.task, options, run.options.get("limits"))

    def run(self, scheme: Scheme, limited: bool = False) -> Run:
        """The motion under a scheme, within the joints' limits or whatever they are, as far as it goes.

        Raises ValueError where the scheme is not one for this arm, or its limits cannot be kept.
        """
        if limited:
            return track(self.arm, self.path, scheme, self.q0, task=self.task, limits=self.limits, **self.options)
        return simulate(self.arm, self.path, scheme, self.q0, task=self.task, partial=True, **self.options)

    def has_limits(self) -> bool:
        """Whether there are limits to be kept."""
        limits = self.limits or self.arm.limits
        bounds = [limits.lower, limits.upper, limits.velocity, limits.acceleration]
        return bool(np.isfinite(bounds).any())
