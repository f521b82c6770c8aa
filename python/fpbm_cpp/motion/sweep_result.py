"""The key figures of many motions."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import Status, failed
from .._types import Array
from ..arms import Arm
from ..paths import Path
from ..schemes import Scheme


@dataclass(frozen=True, repr=False, eq=False)
class Sweep:
    """Key figures of every scheme from every start: arrays of shape (S, K), of S schemes from K starts.

    A figure of joint vectors is of the largest entry by size; largest and peak are over time. Entries are nan where
    there is no figure: where a motion was not run, or stopped before its first sample.

    Attributes
    ----------
    status, time
        How each motion ended, a Status, or None where it was not run; and the time of its last sample [s].
    max_error, max_orientation_error
        Largest distance of the tip from its reference [m], and angle between its orientation and its reference [rad],
        which is 0 where the task leaves it free.
    peak_velocity, final_velocity, peak_acceleration, final_acceleration
        Of the joints [rad/s], [rad/s^2], m for rad where one is prismatic. At velocity level, accelerations are finite
        differences of the velocities.
    manipulability
        The least sqrt(det(J J')) of the task on the way (Yoshikawa, 1985).
    motions
        The whole motions, each a Run, if they were asked for; None where one was not run.
    arm, path, schemes, q0s, task
        What moved, along what, how, from where, and as what task: S schemes, and starts of shape (K, n).
    """

    status: NDArray[Any]
    time: Array
    max_error: Array
    max_orientation_error: Array
    peak_velocity: Array
    final_velocity: Array
    peak_acceleration: Array
    final_acceleration: Array
    manipulability: Array
    motions: NDArray[Any] | None
    arm: Arm
    path: Path
    schemes: tuple[Scheme, ...]
    q0s: Array
    task: str

    @property
    def done(self) -> NDArray[np.bool_]:
        """Which motions were run, complete or not: all, unless the sweep was interrupted."""
        return ~np.isnan(self.time)

    @property
    def ok(self) -> NDArray[np.bool_]:
        """Which motions are complete."""
        good = [status for status in Status if not failed(status)]
        return np.isin(self.status, np.array(good, dtype=object))

    def __str__(self) -> str:
        """One line for each scheme: how many motions are complete, and the worst of those."""
        return "\n".join([repr(self), *map(self._row, range(len(self.schemes)))])

    def _row(self, i: int) -> str:
        scheme, ok = repr(self.schemes[i]), self.ok[i]
        text = f"{scheme if len(scheme) <= 72 else scheme[:69] + '...'}: {ok.sum()} of {ok.size} complete"
        if not ok.any():
            return text
        error, velocity = self.max_error[i, ok].max(), self.peak_velocity[i, ok].max()
        worst = f"tip error up to {error:.1e} m, joints up to {velocity:.3g} rad/s"
        return f"{text}; {worst}, manipulability down to {self.manipulability[i, ok].min():.3g}"

    def __repr__(self) -> str:
        counts = {"complete": self.ok, "stopped early": self.done & ~self.ok, "not run": ~self.done}
        parts = ", ".join(f"{int(mask.sum())} {name}" for name, mask in counts.items() if mask.any())
        return f"<Sweep of {len(self.schemes)} schemes from {len(self.q0s)} starts: {parts}>"
