"""Data classes whose parameters are declared once: checks, docstrings, options and sliders derive from that."""

from __future__ import annotations

import inspect
import math
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
        """Tell type checkers what `data` does."""
        return lambda decorator: decorator


REQUIRED: Any = inspect.Parameter.empty


@dataclass(frozen=True)
class Parameter:
    """What there is to know about a parameter."""

    name: str = ""
    type: type = object  # float, int, str, numpy.ndarray, or object for all else.
    annotation: str = ""  # The same as the declaration has it.
    default: Any = REQUIRED  # What constructors take where it is not given.
    usual: Any = REQUIRED  # What jobs and the command line take where it is not given.
    unit: str = ""
    low: float = -math.inf  # Bounds of a number, or of a vector's entries.
    high: float = math.inf
    open_low: bool = False  # Whether the lower bound itself is out of range.
    infinite: bool = False  # Whether infinity will do.
    whole: bool = False  # Whether numbers must be whole.
    choices: tuple[str, ...] = ()  # The words to choose from.
    shape: str = ""  # The shapes that an array may have: '(n,) or (n, n)', '()' being a number.
    help: str = ""

    @property
    def required(self) -> bool:
        """Whether constructors need it."""
        return self.default is REQUIRED

    @property
    def standard(self) -> Any:
        """The default as the constructor keeps it."""
        return self.default if self.required else self.check(self.default)

    @property
    def range(self) -> str:
        """What its bounds allow: 'positive', 'in [0, 1]'; empty where it has none."""
        if math.isfinite(self.high):
            return f"in [{self.low:g}, {self.high:g}]"
        if self.low == 0.0:
            return "positive" if self.open_low else "not negative"
        return f"at least {self.low:g}" if math.isfinite(self.low) else ""

    @property
    def demand(self) -> str:
        """What a number must be: 'finite and not negative', say."""
        if self.whole:
            return f"a whole number, {self.range}" if self.range else "a whole number"
        if self.infinite or math.isfinite(self.high):
            return self.range or "a number"
        words = {"positive": "positive and finite", "not negative": "finite and not negative"}
        return words.get(self.range, "finite")

    def check(self, value: Any) -> Any:
        """The value as the parameter's type; arrays are copied, and read-only. Raises ParameterError."""
        if value is None and self.default is None:
            return None
        if isinstance(value, str) and self.choices:
            if value not in self.choices:
                raise not_one_of(self.name, value, self.choices)
            return value
        if self.shape:
            return self._array(value)
        if self.type is str and not isinstance(value, str):
            raise self._error(value, "text")
        return self._number(value) if self.type in (float, int) else value

    def _number(self, value: Any) -> float | int:
        try:
            if isinstance(value, (str, bytes, bool, np.bool_)) or np.ndim(value) > 0:
                raise TypeError
            number = float(value)
        except (TypeError, ValueError, OverflowError):
            raise self._error(value, "a number") from None
        if not self._allowed(np.float64(number)):
            raise self._error(number, self.demand)
        return int(number) if self.type is int else number

    def _array(self, value: Any) -> Any:
        try:
            given = np.asarray(value)
        except ValueError:  # Rows of different lengths.
            given = np.empty(0, dtype=object)
        if given.dtype.kind not in "fiu":
            text = f"{self.name}: must be real numbers in an array or a plain sequence, got {value!r:.80}"
            raise ParameterError(self.name, None, value, text)
        if not _fits(given.shape, self.shape):
            text = f"{self.name}: must have shape {self.shape}, got {given.shape}"
            raise ParameterError(self.name, None, value, text)
        array = np.array(given, dtype=float)
        if not np.all(allowed := self._allowed(array)):
            index = tuple(map(int, np.argwhere(~allowed)[0]))
            raise self._error(float(array[index]), self.demand if array.ndim < 2 else "finite", index)
        if array.ndim == 0:
            return float(array)
        array = array.astype(int) if self.whole else array
        array.setflags(write=False)
        return array

    def _allowed(self, values: Any) -> Any:
        """Which numbers are in range; the entries of matrices need only be finite."""
        allowed = ~np.isnan(values) if self.infinite else np.isfinite(values)
        if np.ndim(values) < 2:
            allowed &= (values > self.low if self.open_low else values >= self.low) & (values <= self.high)
        return allowed & (values == np.floor(values)) if self.whole else allowed

    def _error(self, value: object, demand: str, index: tuple[int, ...] = ()) -> ParameterError:
        where = f"{self.name}[{', '.join(map(str, index))}]" if index else self.name
        shown = f"{value:.9g}" if isinstance(value, float) else f"{value!r:.80}"
        return ParameterError(self.name, index[0] if index else None, value, f"{where} = {shown}: must be {demand}")


def _fits(shape: tuple[int, ...], wanted: str) -> bool:
    """Whether an array's shape is one of those in a text, as '(n,) or (n, n)'."""
    for each in wanted.split(" or "):
        letters: dict[str, int] = {}
        sizes = [size.strip() for size in each.strip("()").split(",") if size.strip()]
        if len(sizes) == len(shape) and all(
            (int(size) if size.isdigit() else letters.setdefault(size, length)) == length
            for size, length in zip(sizes, shape)
        ):
            return True
    return False


POSITIVE = Parameter(low=0.0, open_low=True)
NOT_NEGATIVE = Parameter(low=0.0)


def parameter(
    help: str = "", like: Parameter = Parameter(), *, default: Any = REQUIRED, kw_only: bool = False, **known: Any
) -> Any:
    """Declare a parameter as a field of a data class: `radius: float = parameter("Radius.", POSITIVE, unit="m")`.

    Takes what Parameter has; what is not given is as in `like`. Name and type are the field's; the usual value is the
    default, unless given.
    """
    usual = default if like.usual is REQUIRED else like.usual
    declared = replace(like, help=help or like.help, default=default, **{"usual": usual, **known})
    return field(default=MISSING if default is REQUIRED else default, kw_only=kw_only, metadata={"parameter": declared})


def parameters(maker: Callable[..., Any]) -> dict[str, Parameter]:
    """The parameters of a data class, its own before those that it inherits; of a function, its arguments."""
    hashable: Any = maker
    return _parameters(hashable)


@cache
def _parameters(maker: Any) -> dict[str, Parameter]:
    declared = {each.name: each.metadata["parameter"] for each in fields(maker)} if is_dataclass(maker) else {}
    found = {}
    for name, argument in inspect.signature(maker).parameters.items():
        known = declared.get(name, Parameter(default=argument.default, usual=argument.default))
        annotation = str(argument.annotation)
        kind = {"float": float, "int": int, "str": str}.get(annotation.split(" | ")[0], known.type)
        kind = np.ndarray if known.shape else kind
        whole = known.whole or kind is int
        found[name] = replace(known, name=name, type=kind, whole=whole, annotation=annotation)
    own_first = [name for each in inspect.getmro(maker) for name in inspect.get_annotations(each)] if declared else ()
    return {name: found[name] for name in dict.fromkeys((*own_first, *found)) if name in found}


class Data:
    """A frozen data class: equal where its parameters are, readable, picklable, made again by what repr() says."""

    def __post_init__(self) -> None:
        for name, declared in parameters(type(self)).items():
            object.__setattr__(self, name, declared.check(getattr(self, name)))
        self._finish()

    def _finish(self) -> None:
        """Check what the parameters are together, and make what is compiled."""

    def _values(self) -> dict[str, Any]:
        """What the constructor takes, by name."""
        return {name: getattr(self, name) for name in parameters(type(self))}

    def _given(self) -> dict[str, Any]:
        """The same without what is at its default."""
        known = parameters(type(self))
        return {name: value for name, value in self._values().items() if _key(value) != _key(known[name].standard)}

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and _key(other) == _key(self)

    def __hash__(self) -> int:
        return hash(_key(self))

    def __repr__(self) -> str:
        given = ", ".join(f"{name}={_text(value)}" for name, value in self._given().items())
        return f"{type(self).__name__}({given})"

    def __reduce__(self) -> tuple[Any, ...]:
        return partial(type(self), **self._given()), ()


D = TypeVar("D", bound=Data)


@dataclass_transform(frozen_default=True, field_specifiers=(parameter,))
def data(cls: type[D]) -> type[D]:
    """Make a frozen data class of a subclass of Data; its docstring gets a section with the parameters."""
    made = dataclass(frozen=True, eq=False, repr=False)(cls)
    entries = "\n".join(_entry(each) for each in parameters(made).values())
    made.__doc__ = f"{inspect.getdoc(cls)}\n\nParameters\n----------\n{entries}\n"
    return made


def _entry(known: Parameter) -> str:
    """A parameter as docstrings have it."""
    kind = known.annotation.replace(" | ", " or ") if known.type is object else known.type.__name__
    kind = f"array_like, shape {known.shape}" if known.shape else kind
    words = [kind, known.range, "" if known.required else f"default {_text(known.default)}"]
    unit = f" [{known.unit}]" if known.unit else ""
    choices = f" One of {', '.join(map(repr, known.choices))}." if known.choices else ""
    text = textwrap.fill(known.help + choices, 116, initial_indent="    ", subsequent_indent="    ")
    return f"{known.name} : {', '.join(filter(None, words))}{unit}\n{text}"


def _key(value: Any) -> Any:
    """What is equal, and hashes equally, where values are the same."""
    if isinstance(value, Data):
        return (type(value), *(_key(getattr(value, name)) for name in parameters(type(value))))
    if isinstance(value, np.ndarray):
        return value.shape, (value + 0.0).tobytes()  # Of two zeros, one positive.
    return tuple(map(_key, value)) if isinstance(value, tuple) else value


def _text(value: Any) -> str:
    """A value as Python reads it, numbers without a needless '.0'."""
    if isinstance(value, float):
        return repr(value).removesuffix(".0") if math.isfinite(value) else f"float('{value}')"
    if isinstance(value, np.ndarray):
        return _text(value.tolist())
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_text, value))}]"
    return repr(value)
