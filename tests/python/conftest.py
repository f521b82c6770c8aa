import signal

import numpy as np
import pytest
from hypothesis import settings

import fpbm_cpp as fp

# A busy machine is no fault of an example's.
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


@pytest.fixture
def ctrl_c():
    """Python's usual handler of Ctrl-C, which a shell's background jobs lack."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
