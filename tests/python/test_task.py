"""Paths: exact derivatives, a start at zero, a hold after the end."""

import numpy as np
import pytest

import fpbm_cpp as fp

LAWS = ["sin_squared", "quintic", "constant_speed"]
SHAPES = {
    "circle": lambda law: fp.Circle(0.45, 8.0, time_law=law),
    "lissajous": lambda law: fp.Lissajous((0.4, 0.3), 8.0, frequencies=(3, 2), phase=0.7, time_law=law),
    "tricuspid": lambda law: fp.Tricuspid(0.3, 8.0, time_law=law),
    "line": lambda law: fp.Line([0.5, -1.0], 8.0, time_law=law),
    "polyline": lambda law: fp.Polyline([[1, 2], [1, 1], [1.5, 1]], 8.0, blend=0.2, time_law=law),
}


@pytest.fixture(params=[(shape, law) for shape in SHAPES for law in LAWS], ids="-".join)
def path(request):
    shape, law = request.param
    return SHAPES[shape](law)


def test_derivatives(path):
    h = 1e-5
    for t in np.linspace(0.1, 7.9, 40):
        before, here, after = path.sample(t - h), path.sample(t), path.sample(t + h)
        np.testing.assert_allclose((after[0] - before[0]) / (2 * h), here[1], atol=1e-7)
        np.testing.assert_allclose((after[1] - before[1]) / (2 * h), here[2], atol=1e-6)


def test_ends(path):
    np.testing.assert_allclose(path.sample(0.0)[0], 0, atol=1e-15)
    x, xd, xdd = path.sample(path.duration + 1.0)
    np.testing.assert_allclose(x, [0.5, -1.0] if path.kind in ("line", "polyline") else 0, atol=1e-14)
    assert not xd.any()
    assert not xdd.any()
    assert not np.any(path.sample(-1.0)[1:])


@pytest.mark.parametrize("law", LAWS)
def test_the_papers_shapes(law):
    for t in np.linspace(0, 10, 11):
        tau = t / 10
        s = {"sin_squared": np.sin(np.pi * tau / 2) ** 2, "quintic": tau**3 * (10 - 15 * tau + 6 * tau**2)}.get(
            law, tau
        )
        phi = 2 * np.pi * s
        expected = {
            fp.Circle(0.45, 10.0, time_law=law): 0.45 * np.array([np.cos(phi) - 1, np.sin(phi)]),
            fp.Lissajous(0.4, 10.0, time_law=law): 0.4
            * np.array([np.cos(2 * phi + np.pi / 6) - np.cos(np.pi / 6), np.sin(phi + np.pi / 6) - np.sin(np.pi / 6)]),
            fp.Tricuspid(0.3, 10.0, time_law=law): 0.3
            * np.array([2 * np.cos(phi) + np.cos(2 * phi) - 3, 2 * np.sin(phi) - np.sin(2 * phi)]),
        }
        for path, x in expected.items():
            np.testing.assert_allclose(path.sample(t)[0], x, atol=1e-14)


def test_a_sequence_joins_paths():
    path = fp.Line([1, 0], 1.0).then(fp.Line([0, 1, 2], 2.0))
    assert path.duration == 3.0
    np.testing.assert_allclose(path.sample(1.0)[0], [1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(path.sample(3.0)[0], [1, 1, 2], atol=1e-15)
    turned = path.then(fp.Line([0, 0, 1], 1.0).with_rotation([0, 0, 1.0]))
    x = turned.sample(4.0)[0]
    np.testing.assert_allclose(x[:3, 3], [1, 1, 3], atol=1e-15)
    np.testing.assert_allclose(x[:3, :3], fp.rotation([0, 0, 1.0]), atol=1e-15)
    assert turned == fp.Sequence((*path.paths, turned.paths[-1]))


def test_through_waypoints():
    points = np.array([[0.5, 0.1, 0.3], [0.4, 0.3, 0.5], [0.2, 0.3, 0.2], [0.5, 0.1, 0.3]])
    times = [0, 1.0, 2.5, 4.0]
    timed = fp.Waypoints(points, times=times)
    for t, point in zip(times, points):
        np.testing.assert_allclose(timed.sample(t)[0], point - points[0], atol=1e-15)
    for end in (0.0, 4.0):
        assert np.abs(timed.sample(end)[1:]).max() < 1e-13
    assert fp.Waypoints(points, duration=3.0).duration == 3.0
    quick = fp.Waypoints(points, velocity=0.2, acceleration=0.5)
    samples = [quick.sample(t) for t in np.linspace(0, quick.duration, 2000)]
    speed = max(np.linalg.norm(xd) for _, xd, _ in samples)
    acceleration = max(np.linalg.norm(xdd) for _, _, xdd in samples)
    assert speed <= 0.2
    assert acceleration <= 0.5
    assert max(speed / 0.2, (acceleration / 0.5) ** 0.5) > 0.985
    poses = np.tile(np.eye(4), (3, 1, 1))
    poses[1:, 0, 3] = 0.1, 0.3
    poses[1, :3, :3], poses[2, :3, :3] = fp.rotation([0, 0.5, 0]), fp.rotation([0.7, 0, 0])
    posed = fp.Waypoints(poses, times=[0, 1, 2])
    for t, pose in enumerate(poses):
        np.testing.assert_allclose(posed.sample(t)[0], pose, atol=1e-14)


def test_repr_has_the_arguments():
    assert repr(fp.Circle(0.45, 10.0)) == "Circle(radius=0.45, duration=10)"
    assert repr(fp.Line([1, 2], 3.0, time_law="quintic")) == "Line(displacement=[1, 2], duration=3, time_law='quintic')"


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fp.Circle(0.0, 10.0), "radius = 0: must be positive"),
        (lambda: fp.Circle(np.nan, 10.0), "radius = nan"),
        (lambda: fp.Circle(0.45, -1.0), "duration = -1: must be positive"),
        (lambda: fp.Circle(0.45, np.inf), "duration = inf"),
        (lambda: fp.Circle(0.45, 10.0, time_law="linear"), "time_law = 'linear': must be one of sin_squared"),
        (lambda: fp.Tricuspid(-0.3, 10.0), "size = -0.3: must be positive"),
        (lambda: fp.Lissajous((0.4, 0), 10.0), r"amplitude\[1\] = 0: must be positive"),
        (lambda: fp.Lissajous("wide", 10.0), r"amplitude = 'wide': must be real numbers of shape \(\) or \(2,\)"),
        (
            lambda: fp.Lissajous((0.4, 0.4, 0.4), 10.0),
            r"amplitude = \(0.4, 0.4, 0.4\): must be real numbers of shape \(\) or \(2,\)",
        ),
        (
            lambda: fp.Lissajous(0.4, 10.0, frequencies=(0, 1)),
            r"frequencies\[0\] = 0: must be a whole number, at least 1",
        ),
        (lambda: fp.Lissajous(0.4, 10.0, phase=np.inf), "phase = inf: must be finite"),
        (lambda: fp.Line([1, np.nan], 10.0), r"displacement\[1\] = nan: must be finite"),
        (
            lambda: fp.Line([1, 2, 3, 4], 10.0),
            r"displacement = \[1, 2, 3, 4\]: must be real numbers of shape \(2,\) or \(3,\)",
        ),
        (lambda: fp.Circle(0.1, 1.0).in_plane("xx"), "plane = 'xx': must be one of xy, xz"),
        (lambda: fp.Circle(0.1, 1.0).in_plane([[1, 0, 0], [1, 1, 0]]), r"u v / \|u\| \|v\| = 0.707106781: must be 0"),
        (
            lambda: fp.Circle(0.1, 1.0).in_plane([1, 0, 0]),
            r"plane = \[1, 0, 0\]: must be real numbers of shape \(2, 3\)",
        ),
        (lambda: fp.Line([1, 2, 3], 1.0).in_plane("xy"), "in_plane: the path must be planar and without rotation"),
        (lambda: fp.Circle(0.1, 1.0).with_rotation([0, 0, 1]), "rotation: must have 0 dimensions"),
        (lambda: fp.Line([1, 2, 3], 1.0).with_rotation(1.0), "rotation: must have 1 dimension"),
        (lambda: fp.Line([1, 2], 1.0).with_rotation(np.nan), "rotation = nan: must be finite"),
        (
            lambda: fp.Line([1, 2], 1.0).with_rotation(1.0).with_rotation(1.0),
            "with_rotation: the path rotates the tip already: must be a path of positions",
        ),
        (lambda: fp.Line([1, 2], 1.0).with_rotation(1.0).then(fp.Line([1, 2, 3], 1.0)), "path: rotates the tip"),
        (
            lambda: fp.Waypoints([[0, 0], [1, 1]], duration=1, velocity=1),
            "duration, times or bounds of velocity: must be given, at most one of the three",
        ),
        (lambda: fp.Waypoints([[0, 0]], duration=1), "points has 1 entries: must have at least 2"),
        (
            lambda: fp.Waypoints([[0], [1]], duration=1),
            r"points = \[\[0\], \[1\]\]: must be real numbers of shape \(k, 2\) or \(k, 3\) or \(k, 4, 4\)",
        ),
        (lambda: fp.Waypoints([[0, 0], [0, 0]], duration=1), r"points\[1\]: must differ from the previous point"),
        (lambda: fp.Waypoints([[0, 0], [1, np.inf]], duration=1), r"points\[1, 1\] = inf: must be finite"),
        (lambda: fp.Waypoints([[0, 0], [1, 1]], times=[0, 0]), r"times\[1\] = 0: must be finite and later"),
        (lambda: fp.Waypoints([[0, 0], [1, 1]], times=[1]), "times has 1 entries: must have 2, one per point"),
        (lambda: fp.Waypoints([[0, 0], [1, 1]], velocity=0), "velocity = 0: must be positive"),
        (lambda: fp.Waypoints([[0, 0], [1, 1]], angular_velocity=1.0), "bounds: at least one bound must limit the tip"),
        (lambda: fp.Waypoints([[0, 0], [1, 1]], jerk=-1.0), "jerk = -1: must be positive"),
        (lambda: fp.Waypoints([[0, 0], [1, 1]], angular_jerk=1.0), "bounds: at least one bound must limit the tip"),
        (lambda: fp.Polyline([[0, 0], [1, 1]], 0.0), "duration = 0: must be positive"),
        (lambda: fp.Polyline([[0, 0], [1, 1]], 1.0, blend=-1), "blend = -1: must be finite and not negative"),
        (lambda: fp.Polyline([[0, 0], [0, 0]], 1.0), r"points\[1\]: must have another position than the previous"),
        (lambda: fp.Polyline([[0, 0]], 1.0), "points has 1 entries: must have at least 2"),
        (lambda: fp.Polyline([[0, 0], [1, np.nan]], 1.0), r"points\[1, 1\] = nan: must be finite"),
        (lambda: fp.Circle(0.1, 1.0).at_speed(0, acceleration=1), "speed = 0: must be positive"),
        (lambda: fp.Circle(0.1, 1.0).at_speed(np.nan, acceleration=1), "speed = nan: must be positive"),
        (lambda: fp.Circle(0.1, 1.0).at_speed(1, acceleration=-1), "acceleration = -1: must be positive"),
        (lambda: fp.Circle(0.1, 1.0).at_speed(1, acceleration=1, jerk=0), "jerk = 0: must be positive"),
        (lambda: fp.Line([0, 0], 1.0).at_speed(1, acceleration=1), "path: has no length"),
        (
            lambda: fp.Line([1, 0], 1.0).then(fp.Line([0, 0], 1.0).with_rotation(1.0)).at_speed(1, acceleration=1),
            "path: rotates the tip in one place at t = 1",
        ),
        (lambda: fp.AtSpeed("circle", 1, acceleration=1), "path = 'circle': must be a path"),
        (lambda: fp.Waypoints(np.zeros((2, 4, 4)), duration=1), r"points\[0\]: must be a homogeneous matrix"),
    ],
)
def test_bad_paths(make, words):
    with pytest.raises(ValueError, match=words):
        make()
