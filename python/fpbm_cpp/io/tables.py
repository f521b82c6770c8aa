"""Runs as tables, one row a sample, for pandas and as CSV; and as xarray's datasets."""

import csv
import io
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._core import rotation_vector
from .._types import Array
from ..motion.run import Run
from ..skeleton import joint_units
from . import write_whole

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


class Quantity(NamedTuple):
    """A quantity over time and, where it has several components, over 'joint', 'axis' or 'quaternion'."""

    name: str
    column: str  # What its columns are called, with {} for the component.
    over: str
    values: NDArray[Any]
    units: list[str]  # Of its components, each empty where there is none.


def _quantities(run: Run) -> Iterator[Quantity]:
    """All quantities of a run but the times, from left to right."""
    joints, none = joint_units(run.arm), [""] * 4
    for name, values, per in (("q", run.q, ""), ("qd", run.qd, "/s"), ("qdd", run.qdd, "/s^2")):
        yield Quantity(name, f"{name}_{{}}", "joint", values, [unit + per for unit in joints])
    for end, x, positions in (("", run.x, run.positions), ("_ref", run.x_ref, run.reference_positions)):
        yield Quantity(f"x{end}", f"{{}}{end}", "axis", positions, ["m"] * 3)
        if x.ndim == 3:
            yield Quantity(f"orientation{end}", f"q{{}}{end}", "quaternion", quaternions(x[:, :3, :3]), none)
        elif run.task == "pose":
            yield Quantity(f"angle{end}", f"angle{end}", "", x[:, 2], ["rad"])
    yield Quantity("error", "error_{}", "axis", run.position_error, ["m"] * 3)
    if run.x.ndim == 3:
        yield Quantity("orientation_error", "orientation_error_{}", "axis", run.orientation_error, ["rad"] * 3)
    elif run.task == "pose":
        yield Quantity("orientation_error", "orientation_error", "", run.orientation_error[:, 0], ["rad"])
    if run.scale is not None:
        yield Quantity("scale", "scale", "", run.scale, none)
    if run.saturated is not None:
        yield Quantity("saturated", "saturated_{}", "joint", run.saturated, [""] * len(joints))


def _columns(run: Run) -> Iterator[tuple[str, str, NDArray[Any]]]:
    """Name, unit and values of each column."""
    yield "t", "s", run.t
    labels = {"joint": run.arm.joint_names, "axis": "xyz", "quaternion": "xyzw", "": " "}
    for quantity in _quantities(run):
        for label, unit, values in zip(labels[quantity.over], quantity.units, np.atleast_2d(quantity.values.T)):
            yield quantity.column.format(label), unit, values


def to_pandas(run: Run) -> "pd.DataFrame":
    try:
        import pandas as pd
    except ImportError:
        raise ImportError('to_pandas needs pandas: pip install "fpbm_cpp[data]"') from None
    names, units, columns = zip(*_columns(run))
    frame = pd.DataFrame(dict(enumerate(columns)))  # Names may be there twice.
    frame.columns = pd.Index(names)
    frame.attrs["units"] = {name: unit for name, unit in zip(names, units) if unit}
    return frame


def to_csv(run: Run, file: str | os.PathLike[str]) -> None:
    names, units, columns = zip(*_columns(run))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(f"{name} [{unit}]" if unit else name for name, unit in zip(names, units))
    numbers = (column.astype(int) if column.dtype == bool else column for column in columns)
    writer.writerows(zip(*(column.tolist() for column in numbers)))
    write_whole(Path(file), text.getvalue().encode())


def to_xarray(run: Run) -> "xr.Dataset":
    try:
        import xarray as xr
    except ImportError:
        raise ImportError('to_xarray needs xarray: pip install "fpbm_cpp[data]"') from None
    coordinates = {
        "time": ("time", run.t, {"units": "s"}),
        "joint": ("joint", run.arm.joint_names),
        "joint_units": ("joint", joint_units(run.arm)),
        "axis": ("axis", list("xyz"[: run.positions.shape[1]])),
    }
    if run.x.ndim == 3:
        coordinates["quaternion"] = ("quaternion", list("xyzw"))
    data = {}
    for name, _, over, values, units in _quantities(run):
        # Both, if some joints are revolute and some prismatic; without a unit "1", as in the CF conventions.
        unit = ", ".join(sorted(set(units), reverse=True)) or "1"
        data[name] = (("time", over)[: values.ndim], values, {"units": unit})
    things = {"arm": repr(run.arm), "path": repr(run.path), "scheme": repr(run.scheme)}
    return xr.Dataset(data, coordinates, {**things, "task": run.task, "status": str(run.status)})


def quaternions(rotations: Array) -> Array:
    """Unit quaternions (x, y, z, w) of rotation matrices, shape (N, 4) of (N, 3, 3).

    Of the two quaternions of an orientation, each row takes the one nearer to the row before; the first has w >= 0.
    """
    vectors = np.array([rotation_vector(R) for R in rotations]).reshape(-1, 3)
    half = np.linalg.norm(vectors, axis=1, keepdims=True) / 2
    result = np.hstack([vectors / 2 * np.sinc(half / np.pi), np.cos(half)])
    flipped = (result[1:] * result[:-1]).sum(axis=1) < 0
    result[1:] *= np.where(flipped, -1, 1).cumprod()[:, None]
    return result
