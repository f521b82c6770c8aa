"""Sweeps: motions of every scheme from every start, and their key figures."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._core import Status, check_sweep, failed, not_run
from .._types import Array
from ..arms import Arm
from ..errors import extra, wrong
from ..joints import JointLimits, limits_of
from ..paths import Path
from ..robots import Robot
from ..schemes import Scheme
from ..shown import html_table, number
from ..tasks import Stack
from .run_data import Paths
from .simulation import (
    LimitOptions,
    StackTasks,
    make_run,
    motion_options,
    one_path,
    path_task,
    require_motion,
    simulate,
    track,
)
from .workers import run_chunks

# True for a progress bar in the terminal or in a notebook, or a function of (done, total).
Progress: TypeAlias = bool | Callable[[int, int], object] | None

# The number of motions in a chunk is a multiple of GROUP, the largest number of lanes. There are at least CHUNKS chunks
# for many workers, each of at most SAMPLES samples, which take some tenths of a second. The chunks, and so the results,
# do not depend on the number of workers.
GROUP, CHUNKS, SAMPLES = 8, 64, 200_000

# Statuses by their number in the compiled part. The last entry, index -1, is for a motion that was not run.
STATUSES = np.array([*Status, None], dtype=object)


@dataclass(frozen=True, repr=False, eq=False)
class Sweep:
    """Key figures of every scheme from every start: arrays of shape (S, K), for S schemes and K starts.

    A figure of joint vectors is the largest absolute entry; "largest" and "peak" are maxima over time. Entries are nan
    if a motion was not run or stopped before its first sample.

    Attributes
    ----------
    status, time
        Status of each motion, or None if it was not run; and the time of its last sample [s].
    max_error, max_orientation_error
        Largest distance of the tip from its reference [m], and angle between its orientation and its reference [rad],
        which is 0 if the task leaves the orientation free.
    peak_velocity, final_velocity, peak_acceleration, final_acceleration
        Of the joints [rad/s], [rad/s^2]; for a prismatic joint, read m instead of rad. At velocity level,
        accelerations are finite differences of the velocities.
    manipulability
        The least sqrt(det(J J')) of the task during the motion (Yoshikawa, 1985).
    motions
        The whole motions, each a Run, if requested; None for a motion that was not run.
    arm, path, schemes, q0s, task
        The arm, its path, S schemes, starts of shape (K, n), and the kind of the task on the path: 'position' or
        'pose'.
    """

    status: NDArray[Any]
    time: Array
    motions: NDArray[Any] | None
    arm: Arm
    path: Path
    schemes: tuple[Scheme, ...]
    q0s: Array
    task: str
    max_error: Array
    max_orientation_error: Array
    peak_velocity: Array
    final_velocity: Array
    peak_acceleration: Array
    final_acceleration: Array
    manipulability: Array

    @property
    def done(self) -> NDArray[np.bool_]:
        """Which motions were run, complete or not; all, unless the sweep was interrupted."""
        return ~np.isnan(self.time)

    @property
    def ok(self) -> NDArray[np.bool_]:
        """Which motions are complete."""
        good = [status for status in Status if not failed(status)]
        return np.isin(self.status, np.array(good, dtype=object))

    def __str__(self) -> str:
        """One line for each scheme: the number of complete motions, and their worst figures."""
        return "\n".join([repr(self), *map(self._row, range(len(self.schemes)))])

    def _row(self, i: int) -> str:
        scheme, ok = repr(self.schemes[i]), self.ok[i]
        text = f"{scheme if len(scheme) <= 72 else scheme[:69] + '...'}: {ok.sum()} of {ok.size} complete"
        if not ok.any():
            return text
        error, velocity = self.max_error[i, ok].max(), self.peak_velocity[i, ok].max()
        worst = f"tip error up to {error:.1e} m, joints up to {velocity:.3g} rad/s"
        return f"{text}; {worst}, manipulability down to {self.manipulability[i, ok].min():.3g}"

    def _repr_html_(self) -> str:
        headings = ["scheme", "complete", "tip error [m]", "peak qd [rad/s]", "manipulability"]
        rows: list[list[str]] = []
        of_schemes = zip(self.schemes, self.ok, self.max_error, self.peak_velocity, -self.manipulability)
        for scheme, ok, *figures in of_schemes:
            worst = [number(abs(float(np.max(each[ok])))) if ok.any() else "" for each in figures]
            rows.append([repr(scheme), f"{ok.sum()} of {ok.size}", *worst])
        return html_table(repr(self).strip("<>"), headings, rows)

    def __repr__(self) -> str:
        counts = {"complete": self.ok, "stopped early": self.done & ~self.ok, "not run": ~self.done}
        parts = ", ".join(f"{int(mask.sum())} {name}" for name, mask in counts.items() if mask.any())
        return f"<Sweep of {len(self.schemes)} schemes from {len(self.q0s)} starts: {parts}>"


class SweepInterrupted(KeyboardInterrupt):
    """A sweep was stopped by Ctrl-C. sweep: the result with the finished motions, which sweep.done marks."""

    def __init__(self, sweep: Sweep) -> None:
        super().__init__(f"interrupted after {int(sweep.done.sum())} of {sweep.done.size} motions")
        self.sweep = sweep


def sweep(
    arm: Arm,
    path: Paths,
    schemes: Scheme | Sequence[Scheme],
    q0s: ArrayLike,
    dt: float = 1e-3,
    *,
    hold: float = 0.0,
    task: str | None = None,
    stack: Stack | None = None,
    limits: JointLimits | None = None,
    error_bound: float = 0.1,
    integral_gain: float = 0.0,
    integral_bound: float = 1.0,
    stall_time: float = 2.0,
    singular_radius: float = 0.02,
    singular_brake: float = 10.0,
    null_damping: float = 2.0,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Progress = None,
    motions: bool = False,
) -> Sweep:
    """Simulate every scheme from every start, each motion as simulate() does, and keep the key figures of each.

    With limits, each motion keeps the limits as track() does. The motions run on all cores, without the interpreter's
    lock, or in the executor's workers. Motions of one task run side by side in the SIMD lanes of the processor, where
    they agree with simulate() to 1e-12. The results are equal to the last bit for any number of workers. A motion that
    stops early raises no error; its status has the cause.

    Raises ValueError or TypeError if an argument is wrong, ImportError if the library for progress=True is missing;
    nothing is run then. Ctrl-C raises SweepInterrupted, a KeyboardInterrupt whose sweep has the finished motions.

    Parameters
    ----------
    arm, path, dt, hold, task, stack
        As for simulate(). Motions of a stack run one by one in each worker, without lanes.
    schemes : Scheme or sequence of Scheme
        S schemes.
    q0s : array_like, shape (n,) or (K, n)
        Joint positions at the start [rad], one row per start; all motions start at rest.
    limits : JointLimits, optional
        Limits that every motion keeps; arm.limits are the limits of the arm. Default: no limits.
    error_bound, integral_gain, integral_bound, stall_time, singular_radius, singular_brake, null_damping : float
        As for Tracker; these options need limits.
    executor : concurrent.futures.Executor, optional
        Runs the motions in chunks: a ProcessPoolExecutor, a Dask client's get_executor(), ...; the executor stays open.
    workers : int, optional
        Number of threads without an executor; default: number of processors.
    progress : bool or callable, optional
        True for a progress bar, which needs the extra 'progress'; or a function of (done, total), numbers of motions.
    motions : bool
        Also keep the whole motions, in the result's motions: 8 bytes for each number in the arrays of simulate().
    """
    require_motion(arm, path)
    path, task = one_path(path, task, stack)
    if isinstance(arm, Robot):
        raise wrong("arm", arm, f" = {arm}: must be an arm; simulate() and track() accept a Robot")
    laws = tuple(schemes) if isinstance(schemes, Iterable) else (schemes,)
    if not laws:
        raise wrong("schemes", schemes, ": must have at least one scheme")
    for i, law in enumerate(laws):
        if not isinstance(law, Scheme):
            raise TypeError(f"schemes[{i}]: must be a Scheme, got {type(law).__name__}")
    if workers is not None and executor is not None:
        raise wrong("workers", workers, ": must not be given with an executor, which has its own workers")
    if workers is not None and workers < 1:
        raise wrong("workers", workers, f" = {workers}: must be at least 1")
    name, kind = path_task(task, stack)
    limits = limits_of(arm, limits)
    limited = LimitOptions(
        limits, error_bound, integral_gain, integral_bound, stall_time, singular_radius, singular_brake, null_damping
    )
    if limits is None and limited != LimitOptions():
        given = [name for name, value in limited._asdict().items() if value != LimitOptions._field_defaults[name]]
        raise wrong("limits", None, f": must be given with {', '.join(given)}: give arm.limits or other limits")
    kept = None if limits is None else limited
    tasks = None if stack is None else StackTasks(stack, name)
    options = motion_options(arm, dt, hold)
    if kept is not None:
        options |= {**kept._asdict(), "stack": stack}
    elif stack is not None:
        options["stack"] = stack
    starts, samples = check_sweep(arm, path, list(laws), q0s, dt, hold, kind, kept, tasks)
    shape, total = (len(laws), len(starts)), len(laws) * len(starts)
    parts = _parts(total, len(starts), samples)
    outcomes, status, runs = not_run(total), np.full(total, None), np.full(total, None)

    def chunk(part: slice) -> tuple[Any, ...]:
        """Input of a worker: motion i has laws[i // K] and starts[i % K], for K starts."""
        law, start = np.divmod(np.arange(part.start, part.stop), len(starts))
        which = list(laws[law[0] : law[-1] + 1]), (law - law[0]).tolist(), starts[start]
        return arm, path, *which, float(dt), float(hold), kind, motions, kept, tasks

    def take(part: slice, figures: Any, arrays: list[Any]) -> None:
        outcomes[part] = figures
        status[part] = STATUSES[figures["status"]]
        for i, rows in zip(range(total)[part], arrays):
            if status[i] is not None:
                law, start = laws[i // len(starts)], starts[i % len(starts)]
                outcome = status[i], float(outcomes["time"][i]), int(outcomes["samples"][i]), rows
                runs[i] = make_run(outcome, start, arm, path, law, name, options, simulate if kept is None else track)

    def result() -> Sweep:
        summary, whole = outcomes["summary"], runs.reshape(shape) if motions else None
        figures = {name: summary[name].reshape(shape).copy() for name in summary.dtype.names or ()}
        time = outcomes["time"].reshape(shape).copy()
        return Sweep(status.reshape(shape), time, whole, arm, path, laws, starts, kind, **figures)

    try:
        with reporting(progress, total) as report:
            run_chunks(((part, chunk(part)) for part in parts), executor, workers, take, report)
    except KeyboardInterrupt:
        raise SweepInterrupted(result()) from None
    return result()


def _parts(total: int, starts: int, samples: int) -> list[slice]:
    """The motions of each chunk: of one scheme, unless its motions are too few to fill a chunk."""
    size = min(-(-total // CHUNKS), max(1, SAMPLES // samples))
    size = GROUP * -(-size // GROUP)
    row = total if starts < size else starts
    return [slice(i, min(i + size, end)) for end in range(row, total + 1, row) for i in range(end - row, end, size)]


@contextmanager
def reporting(progress: Progress, total: int) -> Iterator[Callable[[int], object]]:
    """A function of the number of finished motions. Raises ImportError if the library of the bar is missing."""
    if callable(progress):
        yield lambda done: progress(done, total)
    elif progress:
        with extra("tqdm.auto", "progress=True", "progress").tqdm(total=total, unit="motion") as bar:
            yield lambda done: bar.update(done - bar.n)
    else:
        yield lambda done: None
