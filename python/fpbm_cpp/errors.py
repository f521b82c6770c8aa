"""What the package raises."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from importlib import import_module
from typing import TYPE_CHECKING, Any

from ._core import Status, advice, message

if TYPE_CHECKING:
    from .motion.run import Run
    from .motion.sweeping import Sweep
    from .tuning.result import Tuning


class ParameterError(ValueError):
    """An argument is out of range, of the wrong shape or type, or unknown.

    name: the argument, 'radius' say, or 'path.radius' in a table. index: the entry of an array that is wrong, or None.
    value: what was given, where it is known. problem: the message after the name.
    """

    def __init__(self, name: str, index: int | None, value: object, message: str) -> None:
        super().__init__(name, index, value, message)
        self.name, self.index, self.value = name, index, value
        self.problem = message.removeprefix(name)

    def __str__(self) -> str:
        return f"{self.name}{self.problem}"

    def within(self, table: str) -> ParameterError:
        """The same error of an argument in that table."""
        name = f"{table}.{self.name}"
        return ParameterError(name, self.index, self.value, name + self.problem)


def wrong(name: str, value: object, problem: str) -> ParameterError:
    """The error of an argument and its problem, which follows the name: ' = -1: must be positive'."""
    return ParameterError(name, None, value, name + problem)


def not_one_of(name: str, value: object, choices: Iterable[str]) -> ParameterError:
    """The error of a word that is none of these; it suggests the one that was probably meant."""
    words = list(choices)
    return wrong(name, value, f" = {value!r}: must be one of {', '.join(words)}{suggestion(value, words)}")


def suggestion(word: object, words: Iterable[str]) -> str:
    """A question after the word that this one is close to; empty where it is close to none."""
    close = difflib.get_close_matches(str(word).lower().replace("-", "_"), list(words), 1)
    return f"; did you mean {close[0]!r}?" if close else ""


def extra(library: str, user: str, name: str) -> Any:
    """The library of an extra. Raises ImportError, with what to install for its user, where it is missing."""
    try:
        return import_module(library)
    except ImportError:
        raise ImportError(f'{user} needs {library.partition(".")[0]}: pip install "fpbm_cpp[{name}]"') from None


class ResolutionError(RuntimeError):
    """The motion cannot be resolved: a singular posture, a target out of reach, a number that is not finite.

    status: why. run: the motion up to there, where a simulation stopped.
    """

    def __init__(self, status: Status, text: str | None = None, run: Run | None = None) -> None:
        super().__init__(text or f"{message(status)}. {advice(status)}")
        self.status = status
        self.run = run


class SweepInterrupted(KeyboardInterrupt):
    """A sweep was stopped by Ctrl-C. sweep: what was finished until then; sweep.done says which motions."""

    def __init__(self, sweep: Sweep) -> None:
        super().__init__(f"interrupted after {int(sweep.done.sum())} of {sweep.done.size} motions")
        self.sweep = sweep


class TuneInterrupted(KeyboardInterrupt):
    """A tuning was stopped by Ctrl-C. tuning: what was found until then; None where no feasible scheme was."""

    def __init__(self, tuning: Tuning | None, tried: int) -> None:
        super().__init__(f"interrupted after {tried} schemes")
        self.tuning = tuning
