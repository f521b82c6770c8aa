"""Chunks of a sweep, and those who run them: threads of our own, or any executor."""

from __future__ import annotations

import os
from collections.abc import Iterable
from concurrent.futures import Executor, Future, ThreadPoolExecutor, wait
from queue import Empty, SimpleQueue
from typing import Any, Callable, NamedTuple

from . import _core
from ._core import Arm, Path, Scheme, Stop
from ._types import Array

# Outcomes, one for each motion, and the arrays of each where the whole motions are wanted.
Result = tuple[Any, list[Any]]

# How often a platform whose locks no signal wakes looks for Ctrl-C [s].
TICK = 0.1


class Chunk(NamedTuple):
    """Motions that are run one after another by one worker: schemes[which[i]] from q0s[i]. It can be pickled."""

    arm: Arm
    path: Path
    schemes: list[Scheme]
    which: list[int]
    q0s: Array
    dt: float
    hold: float
    task: str
    motions: bool


def run_chunk(chunk: Chunk, stop: Stop | None = None) -> Result:
    """Run a chunk, in whichever process this is. Motions that stop keeps from ending are marked as not run."""
    return _core.sweep_chunk(*chunk, Stop() if stop is None else stop)


def run_chunks(
    chunks: Iterable[Chunk],
    executor: Executor | None,
    workers: int | None,
    take: Callable[[int, Result], object],
    report: Callable[[int], object],
) -> None:
    """Run all chunks; take(i, result) in this thread as they arrive, and report() how many motions are done.

    Where that is interrupted or fails, what has not begun is cancelled, what runs in this process stops within a
    sample, and what other processes run is left to them. On KeyboardInterrupt, all that is finished is still taken,
    the last chunk perhaps a second time.
    """
    if executor is None:
        with ThreadPoolExecutor(workers or os.cpu_count()) as threads:
            run_chunks(chunks, threads, None, take, report)
        return
    stop = Stop() if isinstance(executor, ThreadPoolExecutor) else None
    pending: dict[Future[Result], int] = {}
    arrived: SimpleQueue[Future[Result]] = SimpleQueue()
    done = 0
    try:
        for i, chunk in enumerate(chunks):
            future = executor.submit(run_chunk, chunk) if stop is None else executor.submit(run_chunk, chunk, stop)
            pending[future] = i
            future.add_done_callback(arrived.put)
        while pending:
            try:
                future = arrived.get(timeout=TICK)
            except Empty:
                continue
            result = future.result()
            take(pending[future], result)
            del pending[future]
            done += len(result[0])
            report(done)
    except BaseException as error:
        if stop is not None:
            stop.set()
        begun = {future: i for future, i in pending.items() if not future.cancel()}
        if stop is not None:
            wait(begun)
        if isinstance(error, KeyboardInterrupt):
            for future, i in begun.items():
                if future.done() and future.exception() is None:
                    take(i, future.result())
        raise
