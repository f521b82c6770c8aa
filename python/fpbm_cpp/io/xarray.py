"""Runs as xarray datasets."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from ..motion.run import Run
from ..skeleton import joint_units
from .orientation import quaternions

if TYPE_CHECKING:
    import xarray as xr

# (name, dimensions, values, units); a number without a unit has "1", as in the CF conventions.
Variable = tuple[str, tuple[str, ...], Any, str]


def to_xarray(run: Run) -> "xr.Dataset":
    """A run as a dataset."""
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
    data = {name: (dimensions, values, {"units": units}) for name, dimensions, values, units in _variables(run)}
    things = {"arm": repr(run.arm), "path": repr(run.path), "scheme": repr(run.scheme)}
    return xr.Dataset(data, coordinates, {**things, "task": run.task, "status": str(run.status)})


def _variables(run: Run) -> Iterator[Variable]:
    of_joints, of_axes, of_orientation = ("time", "joint"), ("time", "axis"), ("time", "quaternion")
    units = sorted(set(joint_units(run.arm)), reverse=True)  # Both, if some joints are revolute and some prismatic.
    for name, values, per in (("q", run.q, ""), ("qd", run.qd, "/s"), ("qdd", run.qdd, "/s^2")):
        yield name, of_joints, values, ", ".join(unit + per for unit in units)
    yield "x", of_axes, run.positions, "m"
    yield "x_ref", of_axes, run.reference_positions, "m"
    yield "error", of_axes, run.position_error, "m"
    if run.x.ndim == 3:
        yield "orientation", of_orientation, quaternions(run.x[:, :3, :3]), "1"
        yield "orientation_ref", of_orientation, quaternions(run.x_ref[:, :3, :3]), "1"
        yield "orientation_error", of_axes, run.orientation_error, "rad"
    elif run.task == "pose":
        yield "angle", ("time",), run.x[:, 2], "rad"
        yield "angle_ref", ("time",), run.x_ref[:, 2], "rad"
        yield "orientation_error", ("time",), run.orientation_error[:, 0], "rad"
    if run.scale is not None:
        yield "scale", ("time",), run.scale, "1"
    if run.saturated is not None:
        yield "saturated", of_joints, run.saturated, "1"
