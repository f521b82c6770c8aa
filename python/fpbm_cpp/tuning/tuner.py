"""The search for the parameters of a scheme."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arms import Arm, JointLimits
from ..errors import TuneInterrupted
from ..motion.sweeping import Progress, reporting, sweep
from ..parameter import Parameter
from ..paths import Path
from ..schemes import FPBM
from .objectives import OfRun, measure
from .result import Trials, Tuning, joined, sensitivity, trials_of
from .search import Space, front, least, numbers, require_cmaes


def tune(
    arm: Arm,
    path: Path,
    q0: ArrayLike,
    objective: str | OfRun = "peak_velocity",
    *,
    dt: float = 1e-3,
    hold: float = 0.0,
    task: str = "position",
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

    One half of the trials searches for the least objective, by CMA-ES, the other half for the Pareto front of peak
    velocity and peak acceleration. The result is the best of all trials, the first of which is the baseline. The same
    seed gives the same result to the last bit, with any executor.

    Parameters
    ----------
    arm, path, q0, dt, hold, task
        The motion, as for simulate().
    objective : str or callable
        'peak_velocity' [rad/s], 'peak_acceleration' [rad/s^2], 'final_velocity' [rad/s], each of the fastest joint;
        'energy', the integral of |qd|^2 [rad^2/s]; 'limit_distance', the largest share of its range that a joint uses,
        0 in the middle and 1 on a bound; or a function of a Run that returns a number. The last three need whole
        motions, and are slower.
    limits, **tracking
        Limits that every motion keeps, and the other options of track() then; without them none are kept.
    search : mapping of str to (low, high), optional
        The parameters to vary, of 'alpha', 'weights', 'k1', 'k2' and 'null_damping', and their ranges; the others stay
        as in the baseline. The scale is logarithmic, except for alpha. The first weight is 1, since only ratios matter;
        the others have one range, or n - 1. By default alpha in (0, 1), weights in (0.1, 10), null_damping in
        (0.01, 10).
    baseline : FPBM, optional
        The scheme to start from and to compare with, W diagonal; all its other options are kept. By default the paper's
        choice: alpha = 0.6, W = diag(1, 2, 3, ...), k1 = k2 = 1.
    tolerance : float
        Largest position error of the tip [m], and of its orientation [rad] under 'pose', of a feasible motion.
    trials, seed : int
        How many schemes to try, and the seed of the random numbers.
    executor, workers, progress
        As for sweep().

    Raises
    ------
    ValueError, TypeError, ImportError
        If an argument is out of range, not finite, unknown, or of the wrong shape or type; if the extra 'tune' or, with
        progress=True, the extra 'progress' is missing: nothing is run.
    RuntimeError
        If no trial is feasible.
    TuneInterrupted
        On Ctrl-C: a KeyboardInterrupt whose tuning holds what was found.
    """
    start = Parameter("q0", np.ndarray, shape=f"({arm.dof},)").check(q0)
    count = Parameter("trials", int, low=1, whole=True).check(trials)
    seed = Parameter("seed", int, low=0, whole=True).check(seed)
    tolerance = Parameter("tolerance", float, low=0.0, open_low=True).check(tolerance)
    first = FPBM(0.6, np.arange(1.0, arm.dof + 1), k1=1.0, k2=1.0) if baseline is None else baseline
    if not isinstance(first, FPBM):
        raise TypeError(f"baseline: must be an FPBM, got {type(first).__name__}")
    space = Space(search, first, arm.dof)
    name, unit, of_run = measure(objective, limits or arm.limits)
    require_cmaes()
    tried: list[Trials] = []

    def run(schemes: Sequence[FPBM]) -> Trials:
        how: dict[str, Any] = {"hold": hold, "task": task, "limits": limits, **tracking}
        whole = of_run is not None
        done = sweep(arm, path, schemes, start, dt, executor=executor, workers=workers, motions=whole, **how)
        return trials_of(done, name, of_run, tolerance)

    def tuning(steps: dict[str, tuple[float, float]]) -> Tuning:
        return Tuning(joined(tried), steps, name, unit, arm, path, start, task)

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
        return f"{text}; simulate() says why for {tried.schemes[0]!r}"
    return f"{text}, and the others err by at least {tried.error[complete].min():.2g}, where tolerance = {tolerance:g}"
