"""Runs the chunks of a sweep in threads or in any executor, until Ctrl-C."""

import os
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from queue import Empty, SimpleQueue
from signal import SIGINT, default_int_handler, getsignal, signal
from typing import Any

from .._core import Stop, sweep_chunk
from . import _lanes  # noqa: F401  # Selects the code of sweep_chunk() in this process.

Result = tuple[Any, list[Any]]  # Outcomes, one for each motion, and the arrays of each motion if requested.
POLL = 0.05  # Interval between checks for Ctrl-C [s].


def run_chunk(chunk: tuple[Any, ...], stop: Stop | None) -> Result:
    """Run a chunk in this process. Motions that `stop` interrupts are marked as not run."""
    arguments = (*chunk, stop or Stop())
    return sweep_chunk(*arguments)


def run_chunks(
    chunks: Iterable[tuple[slice, tuple[Any, ...]]],
    executor: Executor | None,
    workers: int | None,
    take: Callable[[slice, Any, list[Any]], object],
    report: Callable[[int], object],
) -> None:
    """Run chunks, given as motions and the arguments of sweep_chunk(), and call take() and report() in this thread.

    On an exception, chunks that have not started are cancelled, chunks in this process stop within a sample, and chunks
    in other processes continue. On KeyboardInterrupt, take() is still called for finished chunks.
    """
    if executor is None:
        with ThreadPoolExecutor(workers or os.cpu_count()) as threads:
            return run_chunks(chunks, threads, None, take, report)
    stop = Stop() if isinstance(executor, ThreadPoolExecutor) else None
    pending: dict[Future[Result], slice] = {}
    arrived: SimpleQueue[Future[Result]] = SimpleQueue()
    done = 0
    with interrupted_at_checks() as check:
        try:
            for which, chunk in chunks:
                future = executor.submit(run_chunk, chunk, stop)
                pending[future] = which
                future.add_done_callback(arrived.put)
                check()
            while pending:
                check()
                try:
                    future = arrived.get(timeout=POLL)
                except Empty:
                    continue
                outcomes, arrays = future.result()
                take(pending.pop(future), outcomes, arrays)
                done += len(outcomes)
                report(done)
        except BaseException as error:
            if stop is not None:
                stop.set()
            begun = {future: which for future, which in pending.items() if not future.cancel()}
            if stop is not None:
                wait(begun)
            if isinstance(error, KeyboardInterrupt):
                for future, which in begun.items():
                    if future.done() and future.exception() is None:
                        take(which, *future.result())
            raise


@contextmanager
def interrupted_at_checks() -> Iterator[Callable[[], None]]:
    """A function to call at safe points: a Ctrl-C raises KeyboardInterrupt at these points only.

    After a KeyboardInterrupt during the acquisition of one of Python's own locks, the lock would stay locked. Does
    nothing outside the main thread, or if the program has its own handler for Ctrl-C.
    """
    pressed, process = False, os.getpid()

    def handle(number: int, frame: Any) -> None:
        nonlocal pressed
        if os.getpid() != process:  # In a worker that was forked after the call of signal().
            default_int_handler(number, frame)
        pressed = True

    def check() -> None:
        nonlocal pressed
        if pressed:
            pressed = False
            raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread() or getsignal(SIGINT) is not default_int_handler:
        yield check
        return
    signal(SIGINT, handle)
    try:
        yield check
    finally:
        signal(SIGINT, default_int_handler)
    check()
