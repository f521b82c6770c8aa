import numpy as np
import pytest

import fpbm_cpp as fp

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
