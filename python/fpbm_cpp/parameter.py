"""Data classes that declare each parameter once, for checks, docstrings, options and sliders."""

from __future__ import annotations

import inspect
import math
import re
import textwrap
from collections.abc import Callable
from dataclasses import MISSING, dataclass, field, fields, is_dataclass, replace
from functools import cache, partial
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from .errors import ParameterError, not_one_of

if TYPE_CHECKING:
    from typing_extensions import dataclass_transform
else:

    def dataclass_transform(**_: Any) -> Callable[[Any], Any]:
        return lambda decorator: decorator


REQUIRED: Any = inspect.Parameter.empty

LIBRARY: set[type] = set()  # Classes that data() has made.


@dataclass(frozen=True)
class Parameter:
    """Declaration of a parameter."""

    name: str = ""
    type: type = object  # float, int, bool, str, numpy.ndarray, or object for any other type.
    annotation: str = ""  # The type as written in the source.
    default: Any = REQUIRED  # Default of constructors.
    usual: Any = REQUIRED  # Default of jobs and of the command line.
    unit: str = ""
    low: float = -math.inf  # Bounds of a number, or of a vector's entries.
    high: float = math.inf
    open_low: bool = False  # Whether low itself is out of range.
    infinite: bool = False  # Whether infinity is allowed.
    whole: bool = False  # Whether numbers must be whole.
    choices: tuple[str, ...] = ()  # Allowed words.
    shape: str = ""  # Allowed shapes of an array: '(n,) or (n, n)'; '()' for a number.
    help: str = ""

    @property
    def required(self) -> bool:
        """Whether constructors require the parameter."""
        return self.default is REQUIRED

    @property
    def range(self) -> str:
        """The bounds in words: 'positive', 'in [0, 1]'; empty if there are none."""
        if math.isfinite(self.high):
            return f"in [{self.low:g}, {self.high:g}]"
        if self.low == 0.0:
            return "positive" if self.open_low else "not negative"
        return f"at least {self.low:g}" if math.isfinite(self.low) else ""

    def _demand(self) -> str:
        """Requirement for a number, for example 'finite and not negative'."""
        if self.whole:
            return ", ".join(filter(None, ["a whole number", self.range]))
        if self.infinite or math.isfinite(self.high):
            return self.range or "a number"
        words = {"positive": "positive and finite", "not negative": "finite and not negative"}
        return words.get(self.range, "finite")

    def check(self, value: Any) -> Any:
        """The value as the parameter's type; arrays are copied and read-only. Raises ParameterError."""
        if value is None and self.default is None:
            return value
        if type(value) is float and self.type is float and self._has(value) and math.isfinite(value):
            return value  # Most values are numbers; their check is ten times as fast without NumPy.
        if isinstance(value, str) and self.choices:
            if value not in self.choices:
                raise not_one_of(self.name, value, self.choices)
            return value
        if self.type is str and not isinstance(value, str):
            raise self._error(value, "text")
        if self.type is bool and not isinstance(value, bool):
            raise self._error(value, "true or false")
        return self._numbers(value) if self.shape or self.type in (float, int) else value

    def _has(self, value: Any) -> Any:
        """Whether a number, or each entry of an array, is within the bounds."""
        return ((value > self.low) if self.open_low else (value >= self.low)) & (value <= self.high)

    def _numbers(self, value: Any) -> Any:
        try:
            given = np.asarray(value)
        except ValueError:  # NumPy rejects rows of different lengths.
            given = np.empty(0, dtype=object)
        if given.dtype.kind not in "fiu" or not _fits(given.shape, self.shape):
            raise self._error(value, f"real numbers of shape {self.shape}" if self.shape else "a number")
        array = np.array(given, dtype=float)
        allowed = ~np.isnan(array) if self.infinite else np.isfinite(array)
        if array.ndim < 2:  # The entries of matrices need only be finite.
            allowed &= self._has(array)
        if self.whole:
            allowed &= array == np.floor(array)
        for index in map(tuple, np.argwhere(~allowed).tolist()):
            raise self._error(float(array[index]), self._demand() if array.ndim < 2 else "finite", index)
        array = array.astype(int) if self.whole else array
        array.setflags(write=False)
        return array if array.ndim else array.item()

    def _error(self, value: object, demand: str, index: tuple[int, ...] = ()) -> ParameterError:
        where = f"{self.name}[{', '.join(map(str, index))}]" if index else self.name
        shown = f"{value:.9g}" if isinstance(value, float) else " ".join(repr(value).split())[:80]
        return ParameterError(self.name, index[0] if index else None, value, f"{where} = {shown}: must be {demand}")


def _fits(shape: tuple[int, ...], required: str) -> bool:
    """Whether a text like '(n,) or (n, n)' allows a shape; the shape of a number is ()."""
    return any(
        len(sizes) == len(shape)
        and all(size == str(n) or (size.isalpha() and shape[sizes.index(size)] == n) for size, n in zip(sizes, shape))
        for sizes in (re.findall(r"\w+", each) for each in required.split(" or "))
    )


def renamed(name: str, value: Any, like: Parameter) -> Any:
    """A checked argument of a function, as a parameter. Raises ParameterError with the name of the argument."""
    return replace(like, name=name, type=like.type if like.shape else float).check(value)


POSITIVE = Parameter(low=0.0, open_low=True)
NOT_NEGATIVE = Parameter(low=0.0)
ANY = Parameter()


def parameter(help: str = "", like: Parameter = ANY, *, default: Any = REQUIRED, **known: Any) -> Any:
    """Declare a parameter as a field of a data class: `radius: float = parameter("Radius.", POSITIVE, unit="m")`.

    Keyword arguments are fields of Parameter; all other fields are copied from `like`. If `like` has no usual value,
    the usual value is the default.
    """
    usual = default if like.usual is REQUIRED else like.usual
    declared = replace(like, help=help or like.help, default=default, **{"usual": usual, **known})
    return field(default=MISSING if default is REQUIRED else default, metadata={"parameter": declared})


def _parameters(maker: Any) -> dict[str, Parameter]:
    """Parameters of a data class, its own before inherited parameters; for a function, its arguments."""
    declared = {each.name: each.metadata["parameter"] for each in fields(maker)} if is_dataclass(maker) else {}
    found = {}
    for name, argument in inspect.signature(maker).parameters.items():
        known = declared.get(name, Parameter(default=argument.default, usual=argument.default))
        annotation = str(argument.annotation)
        kind = {"float": float, "int": int, "bool": bool, "str": str}.get(annotation.split(" | ")[0], known.type)
        kind, whole = np.ndarray if known.shape else kind, known.whole or kind is int
        found[name] = replace(known, name=name, type=kind, whole=whole, annotation=annotation)
    own_first = [name for each in inspect.getmro(maker) for name in inspect.get_annotations(each)] if declared else ()
    return {name: found[name] for name in dict.fromkeys((*own_first, *found)) if name in found}


parameters: Callable[[Callable[..., Any]], dict[str, Parameter]] = cache(_parameters)


def from_file(make: Callable[..., Any], *without: str) -> Callable[..., Any]:
    """A constructor for tables: its first argument is named `file`, and it has no arguments with these names."""

    def made(file: str, **options: Any) -> Any:
        return make(file, **options)

    first, *others = inspect.signature(make).parameters.values()
    kept = [first.replace(name="file"), *(each for each in others if each.name not in without)]
    made.__signature__ = inspect.Signature(kept)  # type: ignore[attr-defined]
    return made


class Data:
    """A frozen data class that can be pickled. repr() is a constructor call; objects with equal repr() are equal."""

    def __post_init__(self) -> None:
        vars(self).update(_kept(type(self)))
        for name, declared in parameters(library_class(type(self))).items():
            object.__setattr__(self, name, declared.check(getattr(self, name)))
        self._finish()

    def _finish(self) -> None:
        """Check combinations of parameters, and construct the compiled part."""

    def _values(self) -> dict[str, Any]:
        """Arguments of the constructor, by name."""
        return {name: getattr(self, name) for name in parameters(library_class(type(self)))}

    def _with(self: D, **changes: Any) -> D:
        """An object of the library's class with other arguments."""
        made: D = library_class(type(self))(**{**self._values(), **changes})
        return made

    def _given(self) -> dict[str, Any]:
        """Arguments of the constructor that differ from their defaults."""
        known, values = parameters(library_class(type(self))), self._values().items()
        return {n: v for n, v in values if known[n].required or _text(v) != _text(known[n].check(known[n].default))}

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and repr(other) == repr(self)

    def __hash__(self) -> int:
        return hash(repr(self))

    def __repr__(self) -> str:
        given = ", ".join(f"{name}={_text(value)}" for name, value in self._given().items())
        return f"{type(self).__name__}({given})"

    def __reduce__(self) -> tuple[Any, ...]:
        if library_class(type(self)) is not type(self):  # The constructor of a subclass may have other arguments.
            return _restored, (type(self), self._values())
        return partial(type(self), **self._given()), ()


def library_class(cls: type) -> Any:
    """The class that determines the meaning of objects of a class: the class itself, or its nearest parent, in the
    library."""
    return next((each for each in cls.__mro__ if each in LIBRARY), cls)


def _kept_of(cls: type) -> dict[str, Any]:
    """Class variables of the library that a subclass outside the library hides, with the values of the library."""
    meaning = library_class(cls)
    hidden = {name for each in cls.__mro__[: cls.__mro__.index(meaning)] for name in vars(each)}
    static = {name: inspect.getattr_static(meaning, name, None) for name in hidden if not name.startswith("__")}
    known = parameters(meaning)
    return {n: v for n, v in static.items() if hasattr(meaning, n) and n not in known and not hasattr(v, "__get__")}


_kept: Callable[[type], dict[str, Any]] = cache(_kept_of)


def _restored(cls: type[Data], values: dict[str, Any]) -> Data:
    thing = cls.__new__(cls)
    vars(thing).update(values)
    thing.__post_init__()
    return thing


D = TypeVar("D", bound=Data)


@dataclass_transform(frozen_default=True, field_specifiers=(parameter,))
def data(cls: type[D]) -> type[D]:
    """Make a subclass of Data a frozen data class, and add a section with the parameters to its docstring."""
    made = dataclass(frozen=True, eq=False, repr=False)(cls)
    LIBRARY.add(made)
    entries = "\n".join(_entry(each) for each in parameters(made).values())
    made.__doc__ = f"{inspect.getdoc(cls)}\n\nParameters\n----------\n{entries}\n"
    return made


def _entry(known: Parameter) -> str:
    """Entry of a parameter in a docstring."""
    kind = known.annotation.replace(" | ", " or ") if known.type is object else known.type.__name__
    kind = f"array_like, shape {known.shape}" if known.type is np.ndarray else kind
    words = [kind, known.range, "" if known.required else f"default {_text(known.default)}"]
    unit = f" [{known.unit}]" if known.unit else ""
    choices = f" One of {', '.join(map(repr, known.choices))}." if known.choices else ""
    text = textwrap.fill(known.help + choices, 116, initial_indent="    ", subsequent_indent="    ")
    return f"{known.name} : {', '.join(filter(None, words))}{unit}\n{text}"


def _text(value: Any) -> str:
    """A value as Python source, numbers without a trailing '.0'."""
    if isinstance(value, float):
        return repr(value + 0.0).removesuffix(".0") if math.isfinite(value) else f"float('{value}')"
    if isinstance(value, np.ndarray):
        return _text(value.tolist())
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_text, value))}]"
    return repr(value)
