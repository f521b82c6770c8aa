"""The search for the parameters of a scheme."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import _core
from .._core import FPBM, Arm, Path
from .._progress import Progress, reporting
from .._types import Array
from ..sweep import sweep
from .objectives import Objective, measure
from .result import TuneInterrupted, Tuning
from .search import Search, front, least, require_cmaes
from .sensitivity import changes, every, most_neighbours, neighbours
from .space import Space, make_space, paper_choice
from .trials import Trials, joined, trials_of


def tune(
    arm: Arm,
    path: Path,
    q0: ArrayLike,
    objective: Objective = "peak_velocity",
    *,
    dt: float = 1e-3,
    hold: float = 0.0,
    task: str = "position",
    search: Mapping[str, ArrayLike] | None = None,
    baseline: FPBM | None = None,
    max_error: float = 1e-3,
    trials: int = 1000,
    seed: int = 0,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Progress = None,
) -> Tuning:
    """Find the parameters of FPBM that make an objective least, for an arm on a path.

    One half of the trials goes to a search for the least objective, by CMA-ES, the other to one for the Pareto front of
    peak velocity and peak acceleration. Both run on sweep(), in batches, and the best of all trials is taken, of which
    the baseline is the first. The same seed gives the same answer to the last bit, whoever runs the motions.

    Parameters
    ----------
    arm, path, q0, dt, hold, task
        The motion, as for simulate().
    objective : str or callable
        'peak_velocity' [rad/s], 'peak_acceleration' [rad/s^2], 'final_velocity' [rad/s], each of the fastest joint;
        'energy', the integral of |qd|^2 [rad^2/s]; 'limit_distance', the largest share of its range that a joint uses,
        0 in the middle and 1 on a bound; or a function of a Run, which returns a number to be made small. The last
        three need whole motions, and are slower.
    search : mapping of str to (low, high), optional
        Which of 'alpha', 'weights', 'k1', 'k2' and 'null_damping' vary, and within which ranges; the others stay as in
        the baseline. On a logarithmic scale, but for alpha. The first weight is 1, since only ratios matter; the others
        have one range, or n - 1. Unless given, alpha in (0, 1), weights in (0.1, 10), null_damping in (0.01, 10).
    baseline : FPBM, optional
        What to begin with and to compare with, W diagonal; all its other options are kept. Unless given, the paper's
        choice: alpha = 0.6, W = diag(1, 2, 3, ...), k1 = k2 = 1.
    max_error : float
        Largest error of the tip [m], and under 'pose' of its orientation [rad], with which a motion is feasible.
    trials : int
        How many schemes to try.
    seed : int
        Of the random numbers, not negative.
    executor, workers, progress
        As for sweep().

    Returns
    -------
    Tuning
        The best scheme, the front, how firm the choice is, and all that was tried.

    Raises
    ------
    ValueError
        Where an argument is out of range, not finite, unknown, or of the wrong shape; nothing is run.
    TypeError
        Where the baseline is no FPBM.
    RuntimeError
        Where no trial is feasible.
    TuneInterrupted
        On Ctrl-C, a KeyboardInterrupt whose tuning holds what was found.
    ImportError
        Where the extra 'tune' is missing, or with progress=True the extra 'progress'; nothing is run.
    """
    start = np.asarray(q0, float)
    first = paper_choice(arm.dof) if baseline is None else baseline
    _check(arm, start, first, max_error, trials, seed)
    space, wanted = make_space(search, first, arm.dof), measure(objective, arm)
    _core.check_sweep(arm, path, [first], start, dt, hold, task)
    require_cmaes()
    tried: list[Trials] = []

    def run(schemes: Sequence[FPBM]) -> Trials:
        how: dict[str, Any] = {"hold": hold, "task": task, "executor": executor, "workers": workers}
        done = sweep(arm, path, schemes, start, dt, motions=wanted.of_run is not None, **how)
        return trials_of(done, wanted, max_error)

    def tuning(sensitivity: dict[str, tuple[float, float]]) -> Tuning:
        return Tuning(joined(tried), sensitivity, wanted.name, wanted.unit, arm, path, start, task)

    halves = (
        _half(least(space.size, int(seed)), Trials.scores, int(trials) - int(trials) // 2, space, run),
        _half(front(space.size, int(seed)), Trials.peaks, int(trials) // 2, space, run),
    )
    total = 1 + int(trials) + most_neighbours(first)
    try:
        with reporting(progress, total) as report:
            tried.append(run([first]))
            for batch in chain(*halves):
                tried.append(batch)
                report(sum(map(len, tried)))
            if not any(batch.feasible.any() for batch in tried):
                raise RuntimeError(_why_none(joined(tried), max_error))
            found = tuning({})
            around = neighbours(found.scheme)
            sensitivity = changes(found.value, around, run(every(around)))
            report(total)
    except KeyboardInterrupt:
        feasible = any(batch.feasible.any() for batch in tried)
        raise TuneInterrupted(tuning({}) if feasible else None, sum(map(len, tried))) from None
    return tuning(sensitivity)


def _check(arm: Arm, start: Array, first: object, max_error: float, trials: int, seed: int) -> None:
    """Raise for what no other part checks."""
    if start.shape != (arm.dof,) or not np.all(np.isfinite(start)):
        raise ValueError(f"q0 = {start.tolist()}: must be {arm.dof} finite numbers")
    if not isinstance(first, FPBM):
        raise TypeError(f"baseline: must be an FPBM, got {type(first).__name__}")
    if not 0.0 < max_error < np.inf:
        raise ValueError(f"max_error = {max_error}: must be positive and finite")
    for name, number, lowest in (("trials", trials, 1), ("seed", seed, 0)):
        if number != int(number) or number < lowest:
            raise ValueError(f"{name} = {number}: must be a whole number, {lowest} at least")


def _half(
    search: Search,
    score: Callable[[Trials], Array],
    count: int,
    space: Space,
    run: Callable[[Sequence[FPBM]], Trials],
) -> Iterator[Trials]:
    """So many trials of a search, as many at a time as it asks for, fewer in the end."""
    points = next(search)
    while count > 0:
        batch = run([space.scheme(point) for point in points[:count]])
        yield batch
        count -= len(batch)
        if count > 0:
            points = search.send(score(batch))


def _why_none(tried: Trials, max_error: float) -> str:
    """Why no trial is feasible."""
    complete = int(np.sum(np.isfinite(tried.value)))
    text = f"none of {len(tried)} schemes is feasible: {len(tried) - complete} stopped early or have no objective"
    if not complete:
        return f"{text}; simulate() says why of {tried.schemes[0]!r}"
    least_error = np.min(tried.error[np.isfinite(tried.value)])
    return f"{text}, and the others err by {least_error:.2g} at least, where max_error = {max_error:g}"
