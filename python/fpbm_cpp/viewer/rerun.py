"""A motion made again, under another scheme."""

import numpy as np

from ..motion.run import Run
from ..motion.simulation import simulate, track
from ..schemes import Scheme


def rerun(run: Run, scheme: Scheme, limited: bool) -> Run:
    """The motion of a run under another scheme, as far as it goes; within the run's limits, or the arm's, if limited.

    Raises ValueError if the scheme does not suit the arm, or the limits cannot be kept.
    """
    q0 = run.q[0] if len(run.q) else run.status.q
    if limited:
        return track(run.arm, run.path, scheme, q0, task=run.task, **run.options)
    options = {name: run.options[name] for name in ("dt", "hold", "qd0") if name in run.options}
    return simulate(run.arm, run.path, scheme, q0, task=run.task, partial=True, **options)


def has_limits(run: Run) -> bool:
    """Whether there are any limits to keep."""
    limits = run.limits
    return bool(np.isfinite([limits.lower, limits.upper, limits.velocity, limits.acceleration]).any())
