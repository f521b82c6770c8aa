"""What users call on a run that lies in rooms above: figures, the viewer, files. The one place that reaches up."""

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

    from .run import Run


class Conveniences:
    """Calls that import what they need when they are made; Run has them."""

    @property
    def _run(self) -> "Run":
        return cast("Run", self)

    def plot(self, *, panels: Sequence[str] | None = None, dark: bool = False) -> "Figure":
        """Figure of the motion on one page: arm snapshots, tip error, joints, limits, manipulability.

        panels are the names of those wanted instead, from fpbm_cpp.plot.PANELS; dark draws on black. Raises ValueError
        for an unknown name, and ImportError, with what to install, where matplotlib is missing.
        """
        from ..plot import plot_run

        return plot_run(self._run, panels=panels, dark=dark)

    def view(self, *, urdf: str | os.PathLike[str] | None = None, **how: Any) -> None:
        """Show the motion in the browser until Ctrl-C; urdf, host, port and open_browser as for view().

        Raises ImportError, with what to install, where viser is missing.
        """
        from ..viewer import Viewer

        Viewer(self._run, urdf=urdf, **{"open_browser": True, **how}).wait()

    def replay(self) -> "Run":
        """Make the motion again from arm, path, scheme and options, by simulate() or track().

        Equal to this run to the last bit in the same build on a processor of the same kind; another compiler, C library
        or kind of processor may round differently. Raises ValueError where the options do not say how it was made.
        """
        from .simulation import simulate, track

        run = self._run
        if "dt" not in run.options:
            raise ValueError(f"options = {run.options}: must hold the arguments that the run was made with")
        q0 = run.q[0] if len(run.q) else run.status.q
        if run.scale is not None:
            return track(run.arm, run.path, run.scheme, q0, task=run.task, **run.options)
        return simulate(run.arm, run.path, run.scheme, q0, task=run.task, partial=True, **run.options)

    def save(
        self, file: str | os.PathLike[str], *, note: str | None = None, seed: int | Sequence[int] | None = None
    ) -> None:
        """Write the run to an .npz file, for fp.load. An existing file is replaced, whole or not at all.

        numpy.load reads the arrays; arm, path, scheme, options, status and provenance are JSON text, in 'meta'. Nothing
        is pickled.

        Parameters
        ----------
        file : path
            The file.
        note : str, optional
            Any text to keep in the provenance.
        seed : int or sequence of int, optional
            Seed of the random numbers behind the run, kept there too.
        """
        from ..io.run_file import save

        save(self._run, file, note, seed)

    def to_pandas(self) -> "pd.DataFrame":
        """Data frame of a row for each sample.

        Columns t, q_<joint>, qd_<joint>, qdd_<joint>, the tip as x, y, z with qx, qy, qz, qw or angle for its
        orientation, its reference as x_ref and so on, error_x and so on, orientation_error_x and so on; scale and
        saturated_<joint> where the limits were kept. The units are in frame.attrs["units"]. Needs the extra 'data'.
        """
        from ..io.tables import to_pandas

        return to_pandas(self._run)

    def to_csv(self, file: str | os.PathLike[str]) -> None:
        """Write the columns of to_pandas() as CSV, with heads like 'qd_joint_1 [rad/s]'. Needs no extra.

        Numbers are exact: read back, they are the same to the last bit. An existing file is replaced, whole or not at
        all.
        """
        from ..io.tables import to_csv

        to_csv(self._run, file)

    def to_xarray(self) -> "xr.Dataset":
        """Dataset over time, joint and axis, with units as attributes.

        Variables q, qd, qdd, x, x_ref, error; in a pose orientation (a quaternion) or angle, the same with _ref, and
        orientation_error; scale and saturated where the limits were kept. Needs the extra 'data'.
        """
        from ..io.xarray import to_xarray

        return to_xarray(self._run)

    def to_rosbag(
        self, directory: str | os.PathLike[str], *, frame: str = "base_link", trajectory: bool = False
    ) -> None:
        """Write a ROS 2 bag: the joints, the tip and its reference, stamped with the run's time from 0.

        Topics /joint_states (sensor_msgs/JointState), /tip and /tip_reference (geometry_msgs/PoseStamped). Where the
        task leaves the orientation free, the tip's is the arm's and the reference has none (the identity). Needs the
        extra 'ros', but no ROS.

        Parameters
        ----------
        directory : path
            The bag, written whole or not at all.
        frame : str
            Name of the base frame.
        trajectory : bool
            Also write the whole motion as one message on /joint_trajectory (trajectory_msgs/JointTrajectory).

        Raises
        ------
        FileExistsError
            Where there is something of that name.
        ImportError
            Where the extra is missing.
        """
        from ..io.rosbag import to_rosbag

        to_rosbag(self._run, directory, frame, trajectory)
