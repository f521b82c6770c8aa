"""Constant tool speed and polylines: the speed, its ramps and stops, and motions along the paths."""

import itertools

import numpy as np
import pytest

import fpbm_cpp as fp

READY = np.array([0, -0.3, 0, -2.2, 0, 2.0, 0.785])
PANDA = fp.SerialArm.preset("panda")
SQUARE = 0.2 * np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])
POSES = np.tile(np.eye(4), (4, 1, 1))
POSES[:, :3, 3] = [[0, 0, 0], [0.2, 0, 0], [0.2, 0.1, 0], [0.2, 0.1, 0.3]]
POSES[1, :3, :3], POSES[2, :3, :3] = fp.rotation([0, 0.5, 0]), fp.rotation([0.7, 0, 0.3])

# Paths, and the number of stops between their ends.
PATHS = {
    "circle": (fp.Circle(0.1, 5.0, time_law="quintic").in_plane("yz"), 0),
    "line": (fp.Line([0.3, 0, 0.4], 5.0), 0),
    "lissajous": (fp.Lissajous((0.2, 0.1), 5.0), 0),
    "tricuspid": (fp.Tricuspid(0.05, 5.0), 2),
    "waypoints": (fp.Waypoints(POSES[:, :3, 3], duration=3.0), 0),
    "waypoints through poses": (fp.Waypoints(POSES, duration=3.0), 0),
    "polyline": (fp.Polyline(SQUARE, 3.0, blend=0.01), 0),
    "polyline through poses": (fp.Polyline(POSES, 3.0, blend=0.02), 0),
    "polyline with stops": (fp.Polyline(SQUARE, 3.0), 3),
    "sequence": (fp.Circle(0.1, 1.0).then(fp.Line([0.1, 0.2], 2.0)).then(fp.Line([0.1, 0.2], 1.0)), 2),
    "turned": (fp.Circle(0.1, 1.0).in_plane("yz").with_rotation([0.1, 0.2, 0.3]), 0),
    "corner without a stop": (
        fp.Line([0.1, 0], 1.0, time_law="constant_speed").then(fp.Line([0, 0.1], 1.0, time_law="constant_speed")),
        1,
    ),
}


def linear(path):
    """Number of linear rows of a path."""
    x = path.sample(0.0)[0]
    return 3 if x.ndim == 2 else len(x)


def speeds(path, times):
    return np.array([np.linalg.norm(path.sample(t)[1][: linear(path)]) for t in times])


def moving(path, count):
    """Times of a path, and their distances from the nearest time at rest."""
    rests = [t for t in np.arange(0, path.duration + 0.005, 0.01) if speeds(path, [t])[0] < 1e-9]
    times = np.linspace(0, path.duration, count)
    return rests, times, np.abs(times[:, None] - rests).min(axis=1)


@pytest.mark.parametrize("jerk", [None, 10.0])
@pytest.mark.parametrize("name", PATHS)
def test_the_speed_is_constant_outside_the_ramps(name, jerk):
    path, stops = PATHS[name]
    run = path.at_speed(0.1, acceleration=0.5, jerk=jerk)
    rests, times, rest = moving(run, 1001)
    assert len(rests) == stops + 2
    ramp = 0.1 / 0.5 + (0.5 / jerk if jerk else 0.0) + 0.011
    found = speeds(run, times)
    assert found.max() <= 0.1 * (1 + 1e-12)
    np.testing.assert_allclose(found[rest > ramp], 0.1, rtol=1e-9)
    assert np.all(np.isfinite(np.concatenate([np.concatenate(run.sample(t)[1:]) for t in times])))
    h = 1e-3
    ticks = speeds(run, np.arange(0, run.duration, h))
    assert np.abs(np.diff(ticks)).max() / h <= 0.5 * (1 + 1e-6)
    if jerk:
        inner = np.abs(np.diff(ticks, 2))[ticks[1:-1] > 1e-9]
        assert inner.max() / h**2 <= jerk * (1 + 1e-6)


@pytest.mark.parametrize("name", PATHS)
def test_derivatives_along_the_path(name):
    run = PATHS[name][0].at_speed(0.1, acceleration=0.5, jerk=10.0)
    h = 1e-5
    _, times, rest = moving(run, 199)
    for t in times[rest > 0.02]:  # Beside a cusp, the curvature is unbounded.
        before, here, after = run.sample(t - h), run.sample(t), run.sample(t + h)
        rows = linear(run)
        point = (slice(rows), 3) if here[0].ndim == 2 else slice(rows)
        np.testing.assert_allclose((after[0][point] - before[0][point]) / (2 * h), here[1][:rows], atol=1e-6)
        np.testing.assert_allclose((after[1] - before[1]) / (2 * h), here[2], atol=1e-4, rtol=1e-4)
        if here[0].ndim == 2:
            turned = fp.rotation_vector(after[0][:3, :3] @ before[0][:3, :3].T)
            np.testing.assert_allclose(turned / (2 * h), here[1][3:], atol=1e-5)


@pytest.mark.parametrize("name", PATHS)
def test_only_the_geometry_counts(name):
    """The places at rest are places of the given path; the ends are its ends."""
    path, _ = PATHS[name]
    run = path.at_speed(0.1, acceleration=0.5)
    np.testing.assert_allclose(run.sample(0.0)[0], path.sample(0.0)[0], atol=1e-12)
    np.testing.assert_allclose(run.sample(run.duration)[0], path.sample(path.duration)[0], atol=1e-12)
    for t in (-1.0, run.duration + 1.0):
        assert not np.any(np.concatenate(run.sample(t)[1:]))


def test_durations():
    line = fp.Line([1, 0, 0], 3.0)
    assert line.at_speed(0.1, acceleration=0.5).duration == pytest.approx(10.2)
    assert line.at_speed(0.1, acceleration=0.5, jerk=5).duration == pytest.approx(10.3)
    square = fp.Polyline(SQUARE, 3.0)
    assert square.at_speed(0.1, acceleration=0.5).duration == pytest.approx(8.8)
    corners = [square.at_speed(0.1, acceleration=0.5).sample(2.2 * k)[0] for k in range(5)]
    np.testing.assert_allclose(corners, SQUARE, atol=1e-9)


def test_an_arm_follows_a_circle_at_constant_speed():
    path = fp.Circle(0.1, 5.0).in_plane("yz").at_speed(0.125, acceleration=0.5)
    scheme = fp.FPBM(0.6, np.ones(7), 10, 25, null_damping=2)
    run = fp.track(PANDA, path, scheme, READY, task="pose", hold=1.0)
    assert run.max_error() < 1e-3
    speed = np.linalg.norm(np.diff(run.x[:, :3, 3], axis=0), axis=1) / 1e-3
    steady = (run.t[1:] > 0.3) & (run.t[1:] < path.duration - 0.3)
    np.testing.assert_allclose(speed[steady], 0.125, rtol=0.01)


def test_fastest_motions_keep_the_geometry_and_the_speed():
    square = fp.Polyline(SQUARE, 3.0, blend=0.02).in_plane("yz")
    at_speed = square.at_speed(0.1, acceleration=0.5)
    runs = [fp.fastest(PANDA, path, fp.MVN(), READY, task="pose", dt=5e-3) for path in (square, at_speed)]
    assert runs[0].t[-1] < 2.0
    assert runs[1].t[-1] < at_speed.duration
    speed = np.linalg.norm(np.diff(runs[1].x[:, :3, 3], axis=0), axis=1) / 5e-3
    assert speed.max() <= 0.1 * (1 + 1e-6)
    assert np.mean(abs(speed / 0.1 - 1) < 0.01) > 0.9
    assert max(run.max_error() for run in runs) < 1e-6
    stops = fp.fastest(PANDA, fp.Polyline(SQUARE, 3.0).in_plane("yz"), fp.MVN(), READY, task="pose", dt=5e-3)
    assert stops.t[-1] > runs[0].t[-1]


def overshoot(path):
    """Distance of a path outside of the square [m]."""
    x = np.array([path.sample(t)[0] for t in np.linspace(0, path.duration, 4001)])
    return max((-x).max(), (x - 0.2).max())


def test_a_blend_does_not_overshoot():
    assert overshoot(fp.Polyline(SQUARE, 3.0, blend=0.01)) < 1e-12
    assert overshoot(fp.Waypoints(SQUARE, velocity=0.1, acceleration=0.5)) > 0.06
    for blend, law in itertools.product([0.0, 0.03, 1e6], ["quintic", "constant_speed"]):
        assert overshoot(fp.Polyline(SQUARE, 3.0, blend=blend, time_law=law)) < 1e-12


def test_rotations_follow_the_segments():
    path = fp.Polyline(POSES, 3.0, blend=0.02, time_law="constant_speed")
    half = path.sample(3.0 * 0.1 / 0.6)[0]  # The middle of the first segment.
    np.testing.assert_allclose(half[:3, 3], [0.1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(half[:3, :3], fp.rotation([0, 0.25, 0]), atol=1e-14)


def test_waypoints_keep_bounds_on_jerk():
    path = fp.Waypoints(POSES, velocity=0.5, jerk=1.0, angular_jerk=20.0)
    times = np.linspace(0, path.duration, 4001)
    xdd = np.array([path.sample(t)[2] for t in times])
    jerks = np.diff(xdd, axis=0) / (times[1] - times[0])
    used = [np.linalg.norm(jerks[:, :3], axis=1).max() / 1.0, np.linalg.norm(jerks[:, 3:], axis=1).max() / 20.0]
    assert 0.95 < max(used) <= 1.0
    assert fp.Waypoints(POSES, velocity=0.5).duration < path.duration
