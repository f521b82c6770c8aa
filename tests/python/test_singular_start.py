"""Starts in singular postures: the tracker leaves the posture, for single tasks and for the first level of a stack."""

from __future__ import annotations

import numpy as np
import pytest

import fpbm_cpp as fp

SCHEMES = {
    "acceleration": fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=2),
    "velocity": fp.WMVN(np.ones(7), k=5),
    "manipulability_gain": fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=2, manipulability_gain=10),
    "joint_centring": fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=2, joint_centring=10),
}


def error_after(tracker: fp.Tracker, target: object, seconds: float, dt: float) -> tuple[float, float]:
    """Largest error after one second and after all seconds."""
    errors = [float(np.abs(tracker.tick(target).error).max()) for _ in range(round(seconds / dt))]
    return errors[round(1 / dt)], errors[-1]


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("task", ["position", "pose"])
@pytest.mark.parametrize("move", [(0, 0, -0.2), (0, 0.2, -0.05)])
@pytest.mark.parametrize("dt", [1e-3, 2e-2])
def test_all_joints_at_zero(scheme: str, task: str, move: tuple[float, float, float], dt: float) -> None:
    tracker = fp.Tracker(fp.SerialArm.preset("iiwa14"), SCHEMES[scheme], np.zeros(7), task=task, dt=dt)
    target = tracker.tip.copy()
    (target[:3, 3] if task == "pose" else target)[:] += move
    soon, last = error_after(tracker, target, 6.0, dt)
    assert soon < 0.19
    assert last < 1e-3


@pytest.mark.parametrize("scheme", ["acceleration", "velocity"])
@pytest.mark.parametrize("dt", [1e-3, 2e-2])
def test_first_level_of_a_stack(scheme: str, dt: float) -> None:
    gains = {"k1": 10.0, "k2": 25.0} if scheme == "acceleration" else {"k": 5.0}
    law = {"acceleration": fp.FPBM(0.6, np.ones(7), 0, 0, null_damping=2), "velocity": fp.WMVN(np.ones(7))}[scheme]
    stack = fp.Stack(fp.PositionTask("tip", name="tip", **gains), fp.PostureTask(np.zeros(7), name="posture", **gains))
    tracker = fp.Tracker(fp.SerialArm.preset("iiwa14"), law, np.zeros(7), stack=stack, dt=dt)
    target = tracker.frame("tip")[:3, 3] + [0, 0, -0.2]
    for k in range(round(6 / dt)):
        tick = tracker.tick({"tip": target})
        if k * dt < 1.0:
            soon = float(np.abs(tick.errors["tip"]).max())
    assert soon < 0.19
    assert np.abs(tick.errors["tip"]).max() < 1e-3
