"""A Panda on a mobile base: the tip, the base's bounds and the weights of example 18."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("cmeel")
sys.path.insert(0, str(Path(__file__).parents[2] / "examples"))  # As for a script in this folder.
try:
    example = importlib.import_module("18_wipe_a_table")
except SystemExit:
    pytest.skip("needs example-robot-data", allow_module_level=True)

DT = 1e-3


def test_the_tip_follows_3_m_within_the_base_s_bounds() -> None:
    points = [example.strokes.sample(t)[0] for t in np.arange(0, example.strokes.duration, DT)]
    length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    assert length == pytest.approx(3.0, abs=1e-3)
    travel = {}
    for weight in (0.05, 60.0):
        q, error, tilt = example.wipe(weight)
        assert error < 1e-5  # [m]
        assert tilt < 1e-5  # [rad]
        qd = np.diff(q, axis=0) / DT
        qdd = np.diff(qd, axis=0) / DT
        assert np.all((example.limits.lower <= q) & (q <= example.limits.upper))
        assert np.all(abs(qd) <= example.limits.velocity * (1 + 1e-9))
        assert np.all(abs(qdd) <= example.limits.acceleration + 1e-8)  # Round-off of q by dt².
        travel[weight] = np.linalg.norm(np.diff(q[:, :2], axis=0), axis=1).sum()
        if weight < 1:
            assert abs(qd[:, :2]).max() == pytest.approx(0.2)  # The bounds are active.
    assert travel[0.05] > 1.5 * travel[60.0] > 1.0
