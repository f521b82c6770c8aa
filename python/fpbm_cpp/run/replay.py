"""Runs made again from what they were made of."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .run import Run


def replay(run: Run) -> Run:
    """The run made again, by what made it: simulate() or track(). Raises ValueError where it does not say how."""
    from ..simulate import simulate
    from ..track import track

    if "dt" not in run.options:
        raise ValueError(f"options = {run.options}: must hold the arguments that the run was made with")
    q0 = run.q[0] if len(run.q) else run.status.q
    if run.scale is not None:
        return track(run.arm, run.path, run.scheme, q0, task=run.task, **run.options)
    return simulate(run.arm, run.path, run.scheme, q0, task=run.task, partial=True, **run.options)
