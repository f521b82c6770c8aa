"""TorqueBounds: torques of the commanded motion at the start and the end of every tick, and errors for bad input."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import fpbm_cpp as fp

PANDA = fp.SerialArm.preset("panda")
READY = (0, -0.3, 0, -2.2, 0, 2, 0.785)
AT = (0.02, 0, 0.1)  # Centre of mass of the payloads [m].
ROBOTS: dict[str, tuple[Any, float]] = {  # Robots with payloads, and fractions of the efforts.
    "panda": (lambda: PANDA.with_payload(3.0, com=AT), 0.6),
    "ur10e": (lambda: fp.SerialArm.preset("ur10e").with_payload(8.0, com=AT), 0.6),
    "z1": (lambda: fp.SerialArm.preset("z1").with_payload(1.0, com=AT), 0.45),  # With friction.
}


def bound_of(arm, fraction):
    return fraction * arm.limits.effort - [joint.friction for joint in arm.joints]


def held_posture(arm, bound, rng):
    while True:
        q = rng.uniform(np.maximum(arm.limits.lower, -2.8), np.minimum(arm.limits.upper, 2.8))
        if np.all(np.abs(arm.gravity(q)) <= 0.9 * bound):
            return q


def tracker_of(arm, q0, *, jerk=True, dt=1e-3, **options):
    limits = arm.limits
    most = limits.jerk if np.all(np.isfinite(limits.jerk)) else 100.0 * limits.acceleration
    return fp.Tracker(
        arm,
        fp.Balanced(0.0, np.ones(arm.dof), null_damping=2.0),
        q0,
        stack=fp.Stack(fp.PostureTask(q0, name="posture", k1=12, k2=36)),
        dt=dt,
        limits=replace(limits, jerk=most if jerk else np.full(arm.dof, np.inf)),
        stall_time=np.inf,
        **options,
    )


def move(tracker, arm, bound, rng, dt):
    """States of a motion whose targets jump, with stops until rest."""
    q, qd = [tracker.q], [tracker.qd]

    def tick(target):
        done = tracker.tick({"posture": target})
        q.append(done.q)
        qd.append(done.qd)

    for _ in range(6):
        target = held_posture(arm, bound, rng)
        for _ in range(int(rng.uniform(0.1, 0.8) / dt)):
            tick(target)
        tracker.stop()
        for _ in range(int(40 / dt)):
            if not qd[-1].any():
                break
            tick(target)
        assert not qd[-1].any(), "the arm does not stop"
        tracker.resume()
    return np.array(q), np.array(qd)


def largest_excess(arm, bound, q, qd, dt):
    """Largest excess of the torques over their bounds, at both ends of each tick [Nm]."""
    qdd = np.diff(qd, axis=0) / dt
    ends = (arm.inverse_dynamics(q[:-1], qd[:-1], qdd), arm.inverse_dynamics(q[1:], qd[1:], qdd))
    return max(float(np.max(np.abs(torque) - bound)) for torque in ends)


def moved(name, bounds, seed=2, jerk=True, dt=1e-3, **options):
    """The arm of a name, the bounds on its torques, and states of a motion, with or without TorqueBounds."""
    make, fraction = ROBOTS[name]
    arm, rng = make(), np.random.default_rng(seed)
    bound = bound_of(arm, fraction)
    given = [fp.TorqueBounds(fraction=fraction, **options)] if bounds else []
    tracker = tracker_of(arm, held_posture(arm, bound, rng), jerk=jerk, dt=dt, bounds=given)
    return arm, bound, *move(tracker, arm, bound, rng, dt)


@pytest.mark.parametrize("dt", [1e-3, 4e-3])
@pytest.mark.parametrize("jerk", [True, False])
@pytest.mark.parametrize("name", ROBOTS)
def test_torques_keep_their_bounds(name, jerk, dt):
    for bounds in True, False:
        excess = largest_excess(*moved(name, bounds, jerk=jerk, dt=dt), dt)
        assert excess <= 1e-9 if bounds else excess > 1.0


def test_a_heavier_payload_is_seen():
    """A mass that is 5 % larger than the mass of the model exceeds the bounds."""
    arm, bound, q, qd = moved("panda", True)
    assert largest_excess(arm, bound, q, qd, 1e-3) <= 1e-9
    assert largest_excess(PANDA.with_payload(1.05 * 3.0, com=AT), bound, q, qd, 1e-3) > 0.1


def test_every_mass_between_two_keeps_the_bounds():
    masses = [PANDA.with_payload(mass, com=AT) for mass in (1.0, 2.0, 3.0)]
    _, bound, q, qd = moved("panda", True, lighter=masses[0])
    assert all(largest_excess(arm, bound, q, qd, 1e-3) <= 1e-9 for arm in masses)


def test_an_arm_rests_only_in_postures_that_it_can_hold():
    """Targets of the tip of a Panda with 3 kg, many of them behind postures that 60 % of the efforts cannot hold."""
    arm, fraction = ROBOTS["panda"][0](), 0.6
    bound, limits = bound_of(arm, fraction), replace(PANDA.limits, jerk=np.full(7, np.inf))
    for seed in range(6):
        rng = np.random.default_rng(seed)
        scheme = fp.FPBM(0.6, np.ones(7), 20, 100, null_damping=2.0)
        options = {"limits": limits, "error_bound": 0.5, "stall_time": np.inf}
        bounds = [fp.TorqueBounds(fraction=fraction)]
        tracker = fp.Tracker(arm, scheme, held_posture(arm, bound, rng), bounds=bounds, **options)
        for _ in range(3):
            target = arm.forward(held_posture(arm, bound, rng))[:3, 3]
            for _ in range(500):
                tick = tracker.tick(target)
                if not tick.qd.any():
                    assert np.max(np.abs(arm.gravity(tick.q)) - bound) <= 1e-9


def refused(message, **given):
    arm = given.pop("arm", PANDA)
    q0 = given.pop("q0", READY)
    limits = given.pop("limits", arm.limits)
    scheme = given.pop("scheme", fp.MAN())
    with pytest.raises(fp.ParameterError, match=message):
        fp.Tracker(arm, scheme, q0, limits=limits, bounds=[fp.TorqueBounds(**given)])


def test_bad_input_is_refused_with_the_remedy():
    weightless = fp.SerialArm([replace(joint, mass=0, inertia=np.zeros((3, 3))) for joint in PANDA.joints], PANDA.tip)
    refused("'panda_joint[1-7]'.*moves no mass", arm=weightless)
    refused("at acceleration level", scheme=fp.MVN())
    refused(
        r"limits.acceleration\[0\] = inf: must be finite, since torques", arm=planar(), q0=np.full(3, 0.3), effort=50
    )
    refused(
        "joint 'panda_joint6': torque at rest = .*: must be at most 12", arm=PANDA.with_payload(12, com=(0, 0, 0.3))
    )
    refused(r"effort\[\d\] = 0: must be greater than the dry friction", effort=0.0)
    unknown = fp.SerialArm([replace(joint, effort=np.inf) for joint in PANDA.joints], PANDA.tip)
    refused("the arm has no efforts", arm=unknown, limits=PANDA.limits)
    refused("size of effort = 3|effort", effort=[1.0, 2.0, 3.0])
    for wrong in ({"fraction": 0.0}, {"fraction": 1.5}, {"effort": -1.0}, {"lighter": 3.0}):
        with pytest.raises(fp.ParameterError):
            fp.TorqueBounds(**wrong)


def planar():
    return fp.PlanarArm([1, 1, 1], [1, 1, 1]).with_gravity((0, -9.81, 0))
