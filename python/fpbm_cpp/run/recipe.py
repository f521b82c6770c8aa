"""Arms, paths, schemes and limits as data that JSON holds, and back: what pickle does, with nothing but this package.

A thing is written as the call that makes it, and as those of its methods that led on from there. Floats are exact.

    {"make": "Circle", "args": [0.1, 10.0], "kwargs": {"time_law": "quintic"}, "calls": [["in_plane", ["yz"], {}]]}
"""

from __future__ import annotations

import math
from dataclasses import fields
from functools import partial
from operator import methodcaller
from typing import Any

import numpy as np

from .. import _core
from .._core import Gaze, JointLimits, Path, PlanarArm, Scheme, SecondTask
from ..joint import Joint
from ..serial_arm import SerialArm

PATHS = (_core.Circle, _core.Lissajous, _core.Tricuspid, _core.Line, _core.Waypoints)
SCHEMES = (_core.MVN, _core.WMVN, _core.MAN, _core.WMVNAcceleration, _core.Balanced, _core.FPBM)
MAKERS = {
    kind.__name__: kind for kind in (PlanarArm, SerialArm, Joint, JointLimits, SecondTask, Gaze, *PATHS, *SCHEMES)
}
METHODS = ("in_plane", "with_rotation", "then")  # Of paths.
BOUNDS = ("lower", "upper", "velocity", "acceleration")


def to_data(thing: Any) -> Any:
    """A thing of this package, or a number, text, array or sequence, as JSON holds it. Raises ValueError for others."""
    if thing is None or isinstance(thing, (bool, str)) or type(thing) is int:
        return thing
    if isinstance(thing, (np.generic, np.ndarray)) and thing.dtype.kind in "biuf":
        # No dtype wider than float64 is read by any argument, nor held by JSON.
        array = thing.astype(float) if thing.dtype.itemsize > 8 else thing
        return {"array": to_data(array.tolist()), "dtype": array.dtype.name}
    if isinstance(thing, float):
        return thing if math.isfinite(thing) else {"float": repr(thing)}
    if isinstance(thing, list):
        return [to_data(item) for item in thing]
    if isinstance(thing, tuple):
        return {"tuple": [to_data(item) for item in thing]}
    if isinstance(thing, (PlanarArm, SerialArm, Joint, JointLimits, SecondTask, Gaze, Path, Scheme)):
        return _call_data(thing)
    array = np.asarray(thing)
    if array.dtype.kind not in "biuf":
        raise ValueError(f"{thing!r}: must be a thing of this package, numbers or text to be written to a file")
    return to_data(array)


def from_data(data: Any) -> Any:
    """The thing that to_data() wrote. Raises ValueError, or what the thing's making raises, where it is none."""
    if isinstance(data, list):
        return [from_data(item) for item in data]
    if not isinstance(data, dict):
        return data
    if data.keys() == {"float"} and data["float"] in ("inf", "-inf", "nan"):
        return float(data["float"])
    if data.keys() == {"tuple"}:
        return tuple(from_data(data["tuple"]))
    if data.keys() == {"array", "dtype"}:
        dtype = np.dtype(str(data["dtype"]))
        if dtype.kind not in "biuf":
            raise ValueError(f"dtype = {data['dtype']!r}: must be one of numbers")
        return np.array(from_data(data["array"]), dtype)[()]
    return _made(data)


def _made(data: dict[str, Any]) -> Any:
    name = data.get("make")
    if name not in MAKERS:
        raise ValueError(f"make = {name!r}: must be one of {', '.join(MAKERS)}")
    thing: Any = MAKERS[name](*_args(data.get("args", [])), **_kwargs(data.get("kwargs", {})))
    for method, args, kwargs in data.get("calls", []):
        if method not in METHODS or not isinstance(thing, Path):
            raise ValueError(f"call of {method!r} on a {type(thing).__name__}: must be {', '.join(METHODS)} on a path")
        thing = getattr(thing, method)(*_args(args), **_kwargs(kwargs))
    return thing


def _args(data: list[Any]) -> list[Any]:
    return [from_data(item) for item in data]


def _kwargs(data: dict[str, Any]) -> dict[str, Any]:
    return {name: from_data(item) for name, item in data.items()}


def _call_data(thing: Any) -> dict[str, Any]:
    """The call that makes a thing, and the calls of its methods since. Chains of those may be long: no recursion."""
    calls: list[list[Any]] = []
    while True:
        make, args, kwargs = _call(thing)
        if not isinstance(make, methodcaller):
            break
        (thing,) = args
        name, args, kwargs = _method_call(make)
        calls.append([name, _args_data(args), _kwargs_data(kwargs)])
    parts = {"args": _args_data(args), "kwargs": _kwargs_data(kwargs), "calls": calls[::-1]}
    return {"make": make.__name__, **{name: part for name, part in parts.items() if part}}


def _args_data(args: tuple[Any, ...]) -> list[Any]:
    return [to_data(item) for item in args]


def _kwargs_data(kwargs: dict[str, Any]) -> dict[str, Any]:
    return {name: to_data(item) for name, item in kwargs.items()}


def _call(thing: Any) -> tuple[Any, tuple[Any, ...], dict[str, Any]]:
    """What makes a thing: a class, or a method of the one argument."""
    if isinstance(thing, PlanarArm):
        return PlanarArm, (thing.lengths,), {}
    if isinstance(thing, Joint):
        return Joint, (), {field.name: getattr(thing, field.name) for field in fields(Joint)}
    if isinstance(thing, JointLimits):
        return JointLimits, (), {name: getattr(thing, name) for name in BOUNDS}
    call, args = thing.__reduce__()[:2]
    if isinstance(call, partial):
        return call.func, call.args, call.keywords
    return call, args, {}


def _method_call(caller: Any) -> tuple[str, tuple[Any, ...], dict[str, Any]]:
    """Name and arguments of a methodcaller, which only pickle is told."""
    make, args = caller.__reduce__()
    if isinstance(make, partial):
        return make.args[0], args, make.keywords
    return args[0], args[1:], {}
