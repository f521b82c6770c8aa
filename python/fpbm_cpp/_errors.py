"""What is raised when an arm cannot do what it is asked to."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._core import Status, advice, message

if TYPE_CHECKING:
    from .run import Run
    from .sweep_result import Sweep


class ResolutionError(RuntimeError):
    """The motion cannot be resolved: a singular posture, a target out of reach, a number that is not finite.

    Attributes
    ----------
    status : Status
        Why.
    run : Run or None
        The motion up to there, where a simulation stopped.
    """

    def __init__(self, status: Status, text: str | None = None, run: Run | None = None) -> None:
        super().__init__(text or f"{message(status)}. {advice(status)}")
        self.status = status
        self.run = run


class SweepInterrupted(KeyboardInterrupt):
    """A sweep was stopped by Ctrl-C.

    Attributes
    ----------
    sweep : Sweep
        What was finished until then; sweep.done says which motions.
    """

    def __init__(self, sweep: Sweep) -> None:
        super().__init__(f"interrupted after {int(sweep.done.sum())} of {sweep.done.size} motions")
        self.sweep = sweep
