import os
import pickle
import signal
import time
from collections.abc import Callable, Hashable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings

import fpbm_cpp as fp

# A busy machine is not an error of an example.
settings.register_profile("patient", deadline=None)
settings.load_profile("patient")

Q0 = np.pi / np.array([12, 12, 15, 15])


@pytest.fixture(scope="session")
def arm() -> fp.PlanarArm:
    """The paper's robot."""
    return fp.PlanarArm([1, 1, 1, 1])


@pytest.fixture(scope="session")
def circle() -> fp.Path:
    return fp.Circle(0.45, 10.0)


@pytest.fixture(scope="session")
def q0() -> np.ndarray:
    return Q0.copy()


@pytest.fixture(scope="session")
def once(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Any]:
    """once(make, *arguments) is make(*arguments), computed once for all processes of pytest-xdist."""
    folder = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        folder = folder.parent
    known: dict[Hashable, Any] = {}

    def shared(file: Path, make: Callable[..., Any], arguments: tuple[Hashable, ...]) -> Any:
        lock = file.with_suffix(".lock")
        give_up = time.monotonic() + 600.0  # The process with the lock has crashed.
        while time.monotonic() < give_up:
            try:
                lock.mkdir()
            except FileExistsError:
                time.sleep(0.1)
                continue
            try:
                if not file.exists():
                    file.write_bytes(pickle.dumps(make(*arguments)))
                return pickle.loads(file.read_bytes())
            finally:
                lock.rmdir()
        return make(*arguments)

    def once(make: Callable[..., Any], *arguments: Hashable) -> Any:
        key = (make.__module__, make.__qualname__, *arguments)
        if key not in known:
            name = "".join(each if each.isalnum() else "-" for each in repr(key))
            known[key] = shared(folder / f"{name}.pickle", make, arguments)
        return known[key]

    return once


@pytest.fixture
def ctrl_c():
    """Python's usual handler of Ctrl-C, which a shell's background jobs lack."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
