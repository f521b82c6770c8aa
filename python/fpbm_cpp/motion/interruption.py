"""Ctrl-C at safe points alone."""

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from signal import SIGINT, default_int_handler, getsignal, signal
from typing import Any


@contextmanager
def interrupted_at_checks() -> Iterator[Callable[[], None]]:
    """A function to call at safe points: there, and nowhere between, a Ctrl-C raises KeyboardInterrupt.

    Raised while one of Python's own locks is taken, KeyboardInterrupt leaves it locked, and the next thread that wants
    it waits for ever. Does nothing outside the main thread, or where the program has a handler of its own for Ctrl-C.
    """
    pressed = False
    process = os.getpid()

    def handle(number: int, frame: Any) -> None:
        nonlocal pressed
        if os.getpid() != process:  # A worker that was forked in the meantime.
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
