"""A finished motion, with methods for figures, the viewer, files and tables."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ..errors import ResolutionError
from ..shown import html_table, number
from . import rosbag, tables
from .run_data import RunData

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LONGEST = 200  # Characters of a scheme or a path in the HTML form of a run.


class Run(RunData):
    """A motion, one row per sample: N samples of n joints.

    Two runs are equal (==) if arm, path, scheme, task, options and status are equal, and all arrays to the last bit.

    Attributes
    ----------
    t : numpy.ndarray, shape (N,)
        Times [s].
    q, qd, qdd : numpy.ndarray, shape (N, n)
        Joint positions [rad], velocities [rad/s], accelerations [rad/s^2]; for a prismatic joint, read m instead of
        rad. qdd of track() is the mean over the tick that starts at the sample. qdd of simulate() at velocity level is
        from finite differences.
    x, x_ref : numpy.ndarray, shape (N, 2), (N, 3) or (N, 4, 4)
        The tip and its reference in the base frame [m]; for a stack, the point of the task that follows the path. Poses
        are (x, y, angle) in the plane, homogeneous matrices in space.
    error : numpy.ndarray, shape (N, m)
        x_ref minus x: linear rows [m], then, for a pose, angular rows [rad] (in space, a rotation vector).
    status, arm, path, scheme, task, options
        End of the motion, and the arguments that produced it; options are the other keyword arguments: dt, hold, stack,
        ... task is 'position' or 'pose'; for a stack, the name of the task of x, x_ref and error.
    scale, saturated : numpy.ndarray, shapes (N,) and (N, n), or None
        Of track(): the task scale, from 0 (the arm brakes) to 1 (the whole task), and which joints are on a bound.
        fastest() has only `saturated`: joints within 1 % of, or beyond, a bound on velocity, acceleration, jerk or
        torque.
    clearance : numpy.ndarray, shape (N,), or None
        Of track() with a clearance: distance between the two nearest shapes [m].
    scales : numpy.ndarray, shape (N, levels), or None
        Of track() with a stack: the task scale of each level, from 0 to 1.
    task_errors : numpy.ndarray, shape (N, ...), or None
        Of a stack: the arrays in `errors`, one task after another.
    provenance : dict
        Of a run from a file: date, machine and versions that produced the run, with its note and seed.
    function : function or None
        simulate, track or fastest, which made the run from these arguments.
    """

    def plot(self, *, panels: str | Sequence[str] | None = None, dark: bool = False, bounds: bool = False) -> Figure:
        """Figure of the motion on one page: arm snapshots, tip error, joints, limits, manipulability.

        A notebook shows the figure. panels: names of other panels, from fpbm_cpp.plot.panels.PANELS. dark: dark
        background. bounds: whether all finite bounds of the joints are shown. Needs matplotlib.
        """
        from ..plot import plot_run

        return plot_run(self, panels=panels, dark=dark, bounds=bounds)

    def view(self, *, urdf: str | os.PathLike[str] | None = None, **how: Any) -> None:
        """Show the motion in the browser until Ctrl-C; urdf, host, port, open_browser and errors as for view()."""
        from ..viewer import Viewer

        Viewer(self, urdf=urdf, **{"open_browser": True, **how}).wait()

    def replay(self) -> Run:
        """Repeat the motion: equal to the last bit with the same build on the same kind of processor.

        Raises ValueError if no function of this package made the run.
        """
        if self.function is None:
            raise ValueError(
                "run: must be a result of simulate(), track(), fastest() or sweep(): make the run with one of them"
            )
        try:
            again: Run = self.function(self.arm, self.path, self.scheme, self.q0, task=self.task, **self.options)
        except ResolutionError as stopped:
            again = stopped.run
        return again

    def save(
        self, file: str | os.PathLike[str], *, note: str | None = None, seed: int | Sequence[int] | None = None
    ) -> None:
        """Write the run to an .npz file, for fp.load. An existing file is replaced, completely or not at all.

        numpy.load reads the arrays. All other data are JSON text in 'meta'; nothing is pickled. The provenance contains
        the note, any text, and the seed of the run's random numbers.
        """
        from ..io.run_file import save

        save(self, file, note, seed)

    to_pandas = tables.to_pandas
    to_csv = tables.to_csv
    to_xarray = tables.to_xarray
    to_rosbag = rosbag.to_rosbag

    def _repr_html_(self) -> str:
        rows: list[list[object]] = [
            ["scheme", _brief(self.scheme)],
            ["arm", str(self.arm)],
            ["path", _brief(self.path)],
            ["samples", len(self.t)],
            ["largest tip error", f"{number(self.max_error())} m"],
            ["status", str(self.status)],
        ]
        return html_table("Run", ["", ""], rows)


def _brief(value: object) -> str:
    text = repr(value)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]} …"
