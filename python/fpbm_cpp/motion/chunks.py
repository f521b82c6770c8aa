"""Chunks of a sweep, and running them: in threads of our own, or in any executor."""

import os
from collections.abc import Callable, Iterable
from concurrent.futures import Executor, Future, ThreadPoolExecutor, wait
from queue import Empty, SimpleQueue
from typing import Any, NamedTuple

from .._core import Stop, sweep_chunk
from .._types import Array
from ..arms import Arm
from ..paths import Path
from ..schemes import Scheme
from .interruption import interrupted_at_checks
from .simulation import LimitOptions

# Outcomes, one for each motion, and the arrays of each if the whole motions are wanted.
Result = tuple[Any, list[Any]]

# How often to look for Ctrl-C [s].
POLL = 0.05


class Chunk(NamedTuple):
    """Motions that one worker runs one after another: schemes[which[i]] from q0s[i]. It can be pickled."""

    arm: Arm
    path: Path
    schemes: list[Scheme]
    which: list[int]
    q0s: Array
    dt: float
    hold: float
    task: str
    motions: bool
    limited: LimitOptions | None


def run_chunk(chunk: Chunk, stop: Stop | None = None) -> Result:
    """Run a chunk, in whichever process this is. Motions that stop cuts short are marked as not run."""
    return sweep_chunk(*chunk, Stop() if stop is None else stop)


def run_chunks(
    chunks: Iterable[Chunk],
    executor: Executor | None,
    workers: int | None,
    take: Callable[[int, Result], object],
    report: Callable[[int], object],
) -> None:
    """Run all chunks. In this thread, take(i, result) receives each as it arrives, report(n) the motions done so far.

    On an exception, chunks that have not begun are cancelled, those in this process stop within a sample, and those in
    other processes are left to them. On KeyboardInterrupt, all that is finished is still taken.
    """
    if executor is None:
        with ThreadPoolExecutor(workers or os.cpu_count()) as threads:
            run_chunks(chunks, threads, None, take, report)
        return
    stop = Stop() if isinstance(executor, ThreadPoolExecutor) else None
    pending: dict[Future[Result], int] = {}
    arrived: SimpleQueue[Future[Result]] = SimpleQueue()
    done = 0
    with interrupted_at_checks() as check:
        try:
            for i, chunk in enumerate(chunks):
                future = executor.submit(run_chunk, chunk) if stop is None else executor.submit(run_chunk, chunk, stop)
                pending[future] = i
                future.add_done_callback(arrived.put)
                check()
            while pending:
                check()
                try:
                    future = arrived.get(timeout=POLL)
                except Empty:
                    continue
                result = future.result()
                take(pending.pop(future), result)
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
