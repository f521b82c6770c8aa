"""Runs as tables with one row per sample, for pandas and CSV, and as xarray datasets."""

import csv
import io
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._core import rotation_vector
from .._types import Array
from ..errors import extra
from ..files import write_whole
from ..skeleton import joint_units, torque_units
from .run_data import RunData
from .task_errors import error_parts

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


# Name; names of the columns, with {} for the component; dimension of the components ('joint', 'axis', 'quaternion', or
# '' for a scalar); values over time; units of the components, '' for no unit.
Quantity = tuple[str, str, str, NDArray[Any], list[str]]


def _quantities(run: RunData) -> Iterator[Quantity]:
    """All quantities of a run except the times, in the order of the columns."""
    joints, none = joint_units(run.arm), [""] * 4
    for name, values, per in (("q", run.q, ""), ("qd", run.qd, "/s"), ("qdd", run.qdd, "/s^2")):
        yield name, f"{name}_{{}}", "joint", values, [unit + per for unit in joints]
    torque = run.torque
    if torque is not None:
        yield "torque", "torque_{}", "joint", torque, torque_units(run.arm)
    for end, x, positions in (("", run.x, run.positions), ("_ref", run.x_ref, run.reference_positions)):
        yield f"x{end}", f"{{}}{end}", "axis", positions, ["m"] * 3
        if x.ndim == 3:
            yield f"orientation{end}", f"q{{}}{end}", "quaternion", quaternions(x[:, :3, :3]), none
        elif run.kind == "pose":
            yield f"angle{end}", f"angle{end}", "", x[:, 2], ["rad"]
    yield "error", "error_{}", "axis", run.position_error, ["m"] * 3
    if run.x.ndim == 3:
        yield "orientation_error", "orientation_error_{}", "axis", run.orientation_error, ["rad"] * 3
    elif run.kind == "pose":
        yield "orientation_error", "orientation_error", "", run.orientation_error[:, 0], ["rad"]
    if run.scale is not None:
        yield "scale", "scale", "", run.scale, none
    if run.saturated is not None:
        yield "saturated", "saturated_{}", "joint", run.saturated, [""] * len(joints)
    if run.clearance is not None:
        yield "clearance", "clearance", "", run.clearance, ["m"]
    if run.scales is not None:
        yield "scales", "scale_of_level_{}", "level", run.scales, [""] * run.scales.shape[1]
    for name, unit, values, rows in error_parts(run):
        of = "joints" if rows != ["x", "y", "z"] else "angle" if unit == "rad" else "position"
        yield f"{of}_error_of_{name}", f"{of}_error_of_{name}_{{}}", f"rows of {name}", values, [unit] * len(rows)


def _columns(run: RunData) -> Iterator[tuple[str, str, NDArray[Any]]]:
    """Name, unit and values of each column."""
    yield "t", "s", run.t
    labels: dict[str, Sequence[str]] = {"joint": run.arm.joint_names, "axis": "xyz", "quaternion": "xyzw", "": " "}
    labels["level"] = "0123"
    labels |= {f"rows of {name}": rows for name, _, _, rows in error_parts(run)}
    for _, column, over, values, units in _quantities(run):
        for label, unit, component in zip(labels[over], units, np.atleast_2d(values.T)):
            yield column.format(label), unit, component


def to_pandas(run: RunData) -> "pd.DataFrame":
    """Data frame with a row for each sample, and units in frame.attrs["units"]. Needs the extra 'data'.

    Columns t, q_<joint>, qd_<joint>, qdd_<joint>, torque_<joint> if torques are known, x, y, z with qx, qy, qz, qw or
    angle, x_ref and so on, error_x and so on, orientation_error_x and so on; scale and saturated_<joint> within limits,
    and clearance.
    """
    pandas = extra("pandas", "to_pandas", "data")
    names, units, columns = zip(*_columns(run))
    frame: pd.DataFrame = pandas.DataFrame(dict(enumerate(columns)))  # Names may be repeated.
    frame.columns = pandas.Index(names)
    frame.attrs["units"] = {name: unit for name, unit in zip(names, units) if unit}
    return frame


def to_csv(run: RunData, file: str | os.PathLike[str]) -> None:
    """Write the columns of to_pandas() as CSV, with headings like 'qd_joint_1 [rad/s]'. Needs no extra.

    Numbers read back are equal to the last bit. An existing file is replaced, completely or not at all.
    """
    names, units, columns = zip(*_columns(run))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(f"{name} [{unit}]" if unit else name for name, unit in zip(names, units))
    numbers = (column.astype(int) if column.dtype == bool else column for column in columns)
    writer.writerows(zip(*(column.tolist() for column in numbers)))
    write_whole(Path(file), text.getvalue().encode())


def to_xarray(run: RunData) -> "xr.Dataset":
    """Dataset over time, joint and axis, with units as attributes. Needs the extra 'data'.

    Variables q, qd, qdd, torque if torques are known, x, x_ref, error; for a pose, orientation (a quaternion) or angle,
    orientation_ref or angle_ref, and orientation_error; scale and saturated within limits, and clearance.
    """
    xarray = extra("xarray", "to_xarray", "data")
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
        # Both units for revolute and prismatic joints; "1" without a unit, as in the CF conventions.
        unit = ", ".join(sorted(set(units), reverse=True)) or "1"
        data[name] = (("time", over)[: values.ndim], values, {"units": unit})
    things = {"arm": repr(run.arm), "path": repr(run.path), "scheme": repr(run.scheme)}
    dataset: xr.Dataset = xarray.Dataset(data, coordinates, {**things, "task": run.task, "status": str(run.status)})
    return dataset


def quaternions(rotations: Array) -> Array:
    """Unit quaternions (x, y, z, w) of rotation matrices, shape (N, 4) of (N, 3, 3).

    Of the two quaternions of an orientation, a row has the quaternion nearer to the previous row; the first has w >= 0.
    """
    vectors = np.array([rotation_vector(R) for R in rotations]).reshape(-1, 3)
    half = np.linalg.norm(vectors, axis=1, keepdims=True) / 2
    result = np.hstack([vectors / 2 * np.sinc(half / np.pi), np.cos(half)])
    flipped = (result[1:] * result[:-1]).sum(axis=1) < 0
    result[1:] *= np.where(flipped, -1, 1).cumprod()[:, None]
    return result
