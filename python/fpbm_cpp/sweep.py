"""Many motions at once: every scheme from every start."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from typing import Any

from numpy.typing import ArrayLike

from . import _core
from ._chunks import Result, run_chunks
from ._core import Arm, Path, Scheme
from ._errors import SweepInterrupted
from ._plan import Plan
from ._progress import Progress, reporting
from .sweep_result import Sweep


def sweep(
    arm: Arm,
    path: Path,
    schemes: Scheme | Sequence[Scheme],
    q0s: ArrayLike,
    dt: float = 1e-3,
    *,
    hold: float = 0.0,
    task: str = "position",
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Progress = None,
    motions: bool = False,
) -> Sweep:
    """Simulate every scheme from every start, each motion as simulate() does, and keep the key figures of each.

    Runs on all cores, without the interpreter's lock, or wherever an executor runs things, several motions side by side
    in the processor's lanes, where they agree with simulate() to 1e-12. The results are the same to the last bit
    whoever runs them, however many. A motion that must stop early raises nothing: its status says so.

    Parameters
    ----------
    arm, path
        What moves, along what.
    schemes : Scheme or sequence of Scheme
        S of them.
    q0s : array_like, shape (n,) or (K, n)
        Joint positions at the start [rad], one row a start; all begin at rest.
    dt : float
        Step [s]; it must divide the path's duration and the hold.
    hold : float
        How long to stay at rest on the path's end afterwards [s].
    task : str
        'position', or 'pose' to track the tip's orientation as well.
    executor : concurrent.futures.Executor, optional
        Who runs the motions, in chunks: a ProcessPoolExecutor, a Dask client's get_executor(), ...; it stays open.
    workers : int, optional
        Without an executor, how many threads; as many as there are processors unless given.
    progress : bool or callable, optional
        True for a progress bar, which needs the extra 'progress'; or what to call with (done, total), numbers of
        motions.
    motions : bool
        Keep the whole motions as well, in the result's motions: 8 bytes for each number of simulate()'s arrays.

    Returns
    -------
    Sweep
        Arrays of shape (S, K), also where S or K is 1.

    Raises
    ------
    ValueError
        Where an argument is out of range, not finite, or of the wrong shape; nothing is run.
    TypeError
        Where one of the schemes is none.
    SweepInterrupted
        On Ctrl-C, a KeyboardInterrupt whose sweep holds what is finished.
    ImportError
        Where progress=True and the extra is missing; nothing is run.
    """
    laws = (schemes,) if isinstance(schemes, Scheme) else tuple(schemes)
    if not laws:
        raise ValueError("schemes: must be one at least")
    for i, law in enumerate(laws):
        if not isinstance(law, Scheme):
            raise TypeError(f"schemes[{i}]: must be a Scheme, got {type(law).__name__}")
    if workers is not None and executor is not None:
        raise ValueError("workers: must be left out where there is an executor, which has its own")
    if workers is not None and workers < 1:
        raise ValueError(f"workers = {workers}: must be 1 at least")
    starts, samples = _core.check_sweep(arm, path, list(laws), q0s, dt, hold, task)
    plan = Plan(arm, path, laws, starts, float(dt), float(hold), task, bool(motions), samples)
    parts = plan.parts()
    outcomes = _core.not_run(len(plan))
    arrays: list[Any] = [None] * len(plan)

    def take(i: int, result: Result) -> None:
        outcomes[parts[i]] = result[0]
        if motions:
            arrays[parts[i]] = result[1]

    try:
        with reporting(progress, len(plan)) as report:
            run_chunks(map(plan.chunk, parts), executor, workers, take, report)
    except KeyboardInterrupt:
        raise SweepInterrupted(plan.result(outcomes, arrays)) from None
    return plan.result(outcomes, arrays)
