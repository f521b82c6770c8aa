"""Exceptions of the package."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from importlib import import_module
from typing import Any

from ._core import Status, advice, message


class ParameterError(ValueError):
    """An argument is out of range, of the wrong shape or type, or unknown.

    name: the argument, for example 'radius', or 'path.radius' in a table. index: index of the wrong entry of an array,
    or None. value: the given value, if known. problem: the message after the name.
    """

    def __init__(self, name: str, index: int | None, value: object, message: str) -> None:
        super().__init__(name, index, value, message)
        self.name, self.index, self.value = name, index, value
        self.problem = message.removeprefix(name)

    def __str__(self) -> str:
        return f"{self.name}{self.problem}"

    def within(self, table: str) -> ParameterError:
        """This error with the name of the table before the name of the argument: 'radius' becomes 'path.radius'."""
        name = f"{table}.{self.name}"
        return ParameterError(name, self.index, self.value, name + self.problem)


def wrong(name: str, value: object, problem: str) -> ParameterError:
    """ParameterError for an argument; problem follows the name in the message: ' = -1: must be positive'."""
    return ParameterError(name, None, value, name + problem)


def require(
    name: str, value: object, classes: type | tuple[type, ...], demand: str, *, index: int | None = None
) -> None:
    """Raise ParameterError unless a value, or the entry of that index, is an object of the classes.

    demand: the requirement in words, for example 'an arm or a Robot'.
    """
    if not isinstance(value, classes):
        where = name if index is None else f"{name}[{index}]"
        given = f"the class {value.__name__}" if isinstance(value, type) else type(value).__name__
        raise ParameterError(name, index, value, f"{where} = {value!r:.80}: must be {demand}, got {given}")


def not_one_of(name: str, value: object, choices: Iterable[str]) -> ParameterError:
    """ParameterError for a word that is not one of the choices, with the closest choice as a suggestion."""
    words = list(choices)
    return wrong(name, value, f" = {value!r}: must be one of {', '.join(words)}{suggestion(value, words)}")


def suggestion(word: object, words: Iterable[str]) -> str:
    """The text '; did you mean ...?' with the closest of the words; empty if no word is close."""
    close = difflib.get_close_matches(str(word).lower().replace("-", "_"), list(words), 1)
    return f"; did you mean {close[0]!r}?" if close else ""


def extra(library: str, user: str, name: str) -> Any:
    """Import a library of the extra `name`. If the library is missing, raises ImportError: `user` needs the extra."""
    try:
        return import_module(library)
    except ImportError:
        raise ImportError(f'{user} needs {library.partition(".")[0]}: pip install "fpbm_cpp[{name}]"') from None


class UrdfWarning(UserWarning):
    """A URDF file is read, but a joint is not as the file says; the message has the consequence."""


class ResolutionError(RuntimeError):
    """The motion cannot be resolved: singular posture, unreachable target, or a number that is not finite.

    status: the cause. run: the Run before the error, if a simulation stopped.
    """

    def __init__(self, status: Status, text: str | None = None, run: Any = None) -> None:
        super().__init__(text or f"{message(status)}. {advice(status)}")
        self.status = status
        self.run = run
