"""Runs as tables, one row a sample: for pandas, and as CSV."""

import csv
import io
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from numpy.typing import NDArray

from .._types import Array
from ..motion.run import Run
from ..skeleton import joint_units
from .orientation import quaternions
from .write_whole import write_whole

if TYPE_CHECKING:
    import pandas as pd


class Column(NamedTuple):
    """A quantity over time; its unit is empty where it has none."""

    name: str
    unit: str
    values: NDArray[Any]


def to_pandas(run: Run) -> "pd.DataFrame":
    """A run as a data frame."""
    try:
        import pandas as pd
    except ImportError:
        raise ImportError('to_pandas needs pandas: pip install "fpbm_cpp[data]"') from None
    columns = list(table(run))
    frame = pd.DataFrame({i: column.values for i, column in enumerate(columns)})
    frame.columns = pd.Index([column.name for column in columns])
    frame.attrs["units"] = {column.name: column.unit for column in columns if column.unit}
    return frame


def to_csv(run: Run, file: str | os.PathLike[str]) -> None:
    """Write a run as CSV, whole or not at all."""
    columns = list(table(run))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(f"{column.name} [{column.unit}]" if column.unit else column.name for column in columns)
    numbers = (column.values.astype(int) if column.values.dtype == bool else column.values for column in columns)
    writer.writerows(zip(*(values.tolist() for values in numbers)))
    write_whole(Path(file), text.getvalue().encode())


def table(run: Run) -> Iterator[Column]:
    """The columns of a run, from left to right."""
    yield Column("t", "s", run.t)
    joints, units = run.arm.joint_names, joint_units(run.arm)
    for quantity, per, rows in (("q", "", run.q), ("qd", "/s", run.qd), ("qdd", "/s^2", run.qdd)):
        for joint, unit, values in zip(joints, units, rows.T):
            yield Column(f"{quantity}_{joint}", unit + per, values)
    yield from _points(run, run.x, "")
    yield from _points(run, run.x_ref, "_ref")
    for axis, values in zip("xyz", run.position_error.T):
        yield Column(f"error_{axis}", "m", values)
    angular = run.orientation_error.T
    for ending, values in zip(("",) if len(angular) == 1 else ("_x", "_y", "_z"), angular):
        yield Column(f"orientation_error{ending}", "rad", values)
    if run.scale is not None:
        yield Column("scale", "", run.scale)
    if run.saturated is not None:
        for joint, flags in zip(joints, run.saturated.T):
            yield Column(f"saturated_{joint}", "", flags)


def _points(run: Run, x: Array, ending: str) -> Iterator[Column]:
    """Coordinates of the tip or its reference, and in a pose its angle or quaternion."""
    positions = x[:, :3, 3] if x.ndim == 3 else x
    planar_pose = run.task == "pose" and x.ndim == 2
    for (name, unit), values in zip(
        (("x", "m"), ("y", "m"), ("angle", "rad") if planar_pose else ("z", "m")), positions.T
    ):
        yield Column(name + ending, unit, values)
    if x.ndim == 3:
        for name, values in zip(("qx", "qy", "qz", "qw"), quaternions(x[:, :3, :3]).T):
            yield Column(name + ending, "", values)
