"""The search for the parameters of a scheme, and its objectives: figures of the motion to minimise."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arms import Arm
from ..joints import JointLimits, limits_of
from ..motion.run import Run
from ..motion.run_data import Paths
from ..motion.simulation import one_path, path_task
from ..motion.sweeping import Progress, Sweep, reporting, sweep
from ..parameter import Parameter
from ..schemes import FPBM
from ..tasks import Stack
from .search import Space, front, least, numbers, require_cmaes
from .trials import Trials, TuneInterrupted, Tuning, joined, sensitivity

OfRun = Callable[[Run], float]


def energy(run: Run) -> float:
    """Integral of |qd|² over the motion [rad²/s], by the trapezoidal rule."""
    squares = np.sum(run.qd**2, axis=1)
    return float(np.sum(np.diff(run.t) * (squares[1:] + squares[:-1])) / 2)


def limit_distance(run: Run) -> float:
    """Largest distance of a joint with two bounds from its middle, in half ranges: 1 on a bound, more beyond."""
    bounded = _bounded(run.limits)
    lower, upper = run.limits.lower[bounded], run.limits.upper[bounded]
    return float(np.max(np.abs(2 * run.q[:, bounded] - (lower + upper)) / (upper - lower)))


def _bounded(limits: JointLimits) -> NDArray[np.bool_]:
    """Which joints have two different bounds."""
    return np.isfinite(limits.lower) & np.isfinite(limits.upper) & (limits.lower < limits.upper)


# Unit, and function of a Run; None for a key figure of a sweep, which is faster to compute.
OBJECTIVES: dict[str, tuple[str, OfRun | None]] = {
    "peak_velocity": ("rad/s", None),
    "peak_acceleration": ("rad/s²", None),
    "final_velocity": ("rad/s", None),
    "energy": ("rad²/s", energy),
    "limit_distance": ("of the range", limit_distance),
}


def measure(objective: str | OfRun, limits: JointLimits) -> tuple[str, str, OfRun | None]:
    """Name, unit and function. Raises ValueError if the objective is unknown, or needs bounds that limits lack."""
    if callable(objective):
        return getattr(objective, "__name__", type(objective).__name__), "", objective
    if objective not in OBJECTIVES:
        names = ", ".join(map(repr, OBJECTIVES))
        raise ValueError(f"objective = {objective!r}: must be one of {names}, or a function of a Run")
    if objective == "limit_distance" and not np.any(_bounded(limits)):
        demand = "must have a joint with two bounds, and the arm has none: give limits"
        raise ValueError(f"objective = 'limit_distance': {demand}")
    return objective, *OBJECTIVES[objective]


def tune(
    arm: Arm,
    path: Paths,
    q0: ArrayLike,
    objective: str | OfRun = "peak_velocity",
    *,
    dt: float = 1e-3,
    hold: float = 0.0,
    task: str | None = None,
    stack: Stack | None = None,
    limits: JointLimits | None = None,
    search: Mapping[str, ArrayLike] | None = None,
    baseline: FPBM | None = None,
    tolerance: float = 1e-3,
    trials: int = 1000,
    seed: int = 0,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Progress = None,
    **tracking: float,
) -> Tuning:
    """Find the parameters of FPBM that minimise an objective, for an arm on a path.

    One half of the trials searches for the least objective by CMA-ES, the other half for the Pareto front of peak
    velocity and peak acceleration. The result is the best of all trials; the first trial is the baseline. Equal seeds
    give results that are equal to the last bit, with any executor.

    Raises ValueError or TypeError if an argument is wrong, ImportError if the extra 'tune' or the library for
    progress=True is missing; nothing is run then. Raises RuntimeError if no trial is feasible. Ctrl-C raises
    TuneInterrupted, a KeyboardInterrupt whose tuning has the result so far.

    Parameters
    ----------
    arm, path, q0, dt, hold, task, stack, executor, workers, progress
        As for simulate() and sweep().
    objective : str or callable
        'peak_velocity' [rad/s], 'peak_acceleration' [rad/s^2], 'final_velocity' [rad/s], each of the fastest joint;
        'energy', the integral of |qd|^2 [rad^2/s]; 'limit_distance', the largest distance of a joint from the middle of
        its range, 0 in the middle and 1 on a bound; or a function of a Run that returns a number. 'energy',
        'limit_distance' and functions need whole motions and are slower.
    limits, **tracking
        Limits that every motion keeps, and with limits, the other options of track(). Default: no limits.
    search : mapping of str to (low, high), optional
        Ranges of the parameters that vary, among 'alpha', 'weights', 'k1', 'k2' and 'null_damping'; all other
        parameters are as in the baseline. The scale is logarithmic, except for alpha. The first weight is 1, since only
        ratios count; the other weights have one range, or n - 1 ranges. Default: alpha in (0, 1), weights in (0.1, 10),
        null_damping in (0.01, 10).
    baseline : FPBM, optional
        The first scheme, for comparison, with a diagonal W; its other options apply to all trials. Default: the paper's
        choice, alpha = 0.6, W = diag(1, 2, 3, ...), k1 = k2 = 1; for a stack, whose tasks have gains, k1 = k2 = 0.
    tolerance : float
        Largest position error of the tip [m], and largest orientation error [rad] under 'pose', of a feasible motion.
    trials, seed : int
        Number of schemes to try, and seed of the random numbers.
    """
    path, task = one_path(path, task, stack)
    start = Parameter("q0", np.ndarray, shape=f"({arm.dof},)").check(q0)
    count = Parameter("trials", int, low=1, whole=True).check(trials)
    seed = Parameter("seed", int, low=0, whole=True).check(seed)
    tolerance = Parameter("tolerance", float, low=0.0, open_low=True).check(tolerance)
    gain = 1.0 if stack is None else 0.0  # The tasks of a stack have gains of their own.
    first = FPBM(0.6, np.arange(1.0, arm.dof + 1), k1=gain, k2=gain) if baseline is None else baseline
    if not isinstance(first, FPBM):
        raise TypeError(f"baseline: must be an FPBM, got {type(first).__name__}")
    space = Space(search, first, arm.dof)
    name, unit, of_run = measure(objective, limits_of(arm, limits) or arm.limits)
    require_cmaes()
    tried: list[Trials] = []

    def run(schemes: Sequence[FPBM]) -> Trials:
        how: dict[str, Any] = {"hold": hold, "task": task, "stack": stack, "limits": limits, **tracking}
        whole = of_run is not None
        done = sweep(arm, path, schemes, start, dt, executor=executor, workers=workers, motions=whole, **how)
        return trials_of(done, name, of_run, tolerance)

    def tuning(steps: dict[str, tuple[float, float]]) -> Tuning:
        return Tuning(joined(tried), steps, name, unit, arm, path, start, path_task(task, stack)[0])

    size = len(space.names)
    halves = ((least(size, seed), Trials.scores, count - count // 2), (front(size, seed), Trials.peaks, count // 2))
    total = 1 + count + 2 * len(numbers(first))
    try:
        with reporting(progress, total) as report:
            tried.append(run([first]))
            for points_of, scores_of, left in halves:
                points = next(points_of)
                while left > 0:
                    tried.append(run([space.scheme(point) for point in points[:left]]))
                    report(sum(map(len, tried)))
                    left -= len(tried[-1])
                    if left > 0:
                        points = points_of.send(scores_of(tried[-1]))
            if not any(batch.feasible.any() for batch in tried):
                raise RuntimeError(_why_none(joined(tried), tolerance))
            found = tuning({})
            steps = sensitivity(found.scheme, found.value, run)
            report(total)
    except KeyboardInterrupt:
        feasible = any(batch.feasible.any() for batch in tried)
        raise TuneInterrupted(tuning({}) if feasible else None, sum(map(len, tried))) from None
    return tuning(steps)


def _why_none(tried: Trials, tolerance: float) -> str:
    complete = np.isfinite(tried.value)
    text = f"none of {len(tried)} schemes is feasible: {np.sum(~complete)} stopped early or have no objective"
    if not complete.any():
        return f"{text}; simulate() with {tried.schemes[0]!r} shows the cause"
    error = tried.error[complete].min()
    least = f"the least error of the other schemes is {error:.2g}, above tolerance = {tolerance:g}"
    return f"{text}; {least}: give a larger tolerance, or a smaller dt"


def trials_of(sweep: Sweep, objective: str, of_run: OfRun | None, tolerance: float) -> Trials:
    ok, schemes = sweep.ok[:, 0], np.empty(len(sweep.schemes), dtype=object)
    schemes[:] = sweep.schemes
    if of_run is None:
        value = np.where(ok, getattr(sweep, objective)[:, 0], np.nan)
    else:
        runs = sweep.motions[:, 0] if sweep.motions is not None else ()
        value = np.array([float(of_run(run)) if done else np.nan for done, run in zip(ok, runs)])
    error = np.maximum(sweep.max_error, sweep.max_orientation_error)[:, 0]
    feasible = ok & np.isfinite(value) & (error <= tolerance)
    return Trials(schemes, value, sweep.peak_velocity[:, 0], sweep.peak_acceleration[:, 0], error, feasible)
