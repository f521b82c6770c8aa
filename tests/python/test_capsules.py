"""Capsules from a URDF's collision geometry: the capsules contain the geometry, and are as small as possible."""

from __future__ import annotations

import importlib.util
import io
import itertools
import os
import re
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull, cKDTree
from scipy.spatial.transform import Rotation

import fpbm_cpp as fp
from fpbm_cpp._types import Array
from fpbm_cpp.capsule import Capsule
from fpbm_cpp.errors import ParameterError
from fpbm_cpp.urdf import capsules
from fpbm_cpp.urdf.capsule_fit import Fit, distances, fit_capsule, fit_cylinder
from fpbm_cpp.urdf.capsules import capsules_of
from fpbm_cpp.urdf.chain import read_places
from fpbm_cpp.urdf.mesh_file import read_mesh
from fpbm_cpp.urdf.shapes import CELLS, MANY, Shape, read_shapes

trimesh = pytest.importorskip("trimesh")

# The fit


def outside(points: Array, fits: Sequence[Fit | Capsule], radii: Array | float = 0.0) -> float:
    """Largest distance of the points, or of balls around them, outside all capsules: not positive if all are inside."""
    return float(np.max(np.min([distances(points, f.a, f.b) + radii - f.radius for f in fits], axis=0)))


def volume(fits: Sequence[Fit | Capsule]) -> float:
    return float(sum(np.pi * f.radius**2 * (np.linalg.norm(f.b - f.a) + 4 / 3 * f.radius) for f in fits))


def on_line(points: Array, origin: Array, u: Array) -> float:
    """The least volume of a capsule whose axis is on a line, over a grid of radii."""
    s, d = (points - origin) @ u, np.linalg.norm(np.cross(points - origin, u), axis=1)
    best = np.inf
    for r in d.max() * np.concatenate([[1 + 1e-12], 1 + np.geomspace(1e-4, 1, 40)]):
        half_length = np.sqrt(r * r - d * d)
        best = min(best, np.pi * r * r * (max(0.0, np.max(s - half_length) - np.min(s + half_length)) + 4 / 3 * r))
    return best


def dense_search(points: Array, axes: int = 60, shifts: int = 9) -> float:
    """The least volume over axes of many directions and positions. The best axes are refined by a finer search."""
    rng = np.random.default_rng(0)
    middle, size = (points.min(axis=0) + points.max(axis=0)) / 2, np.ptp(points, axis=0).max()
    lines = [
        (rng.normal(size=3), middle + 0.1 * size * rng.normal(size=3) * (k > 0))
        for k in range(shifts)
        for _ in range(axes)
    ]
    spread = 0.3
    found: list[tuple[float, Array, Array]] = []
    for _ in range(12):
        found += [(on_line(points, p, u / np.linalg.norm(u)), u / np.linalg.norm(u), p) for u, p in lines]
        found = sorted(found, key=lambda each: each[0])[:6]
        lines = [
            (u + spread * rng.normal(size=3), p + 0.3 * spread * size * rng.normal(size=3))
            for _, u, p in found
            for _ in range(40)
        ]
        spread /= 2
    return found[0][0]


def placed(points: Array, seed: int) -> Array:
    rng = np.random.default_rng(seed)
    return np.asarray(points @ Rotation.random(random_state=seed).as_matrix().T + rng.normal(size=3))


def corners(*size: float) -> Array:
    return np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * size


SIZE = st.floats(1e-3, 2.0)
SEED = st.integers(0, 2**31)


@settings(max_examples=30, deadline=None)
@given(count=st.integers(1, 60), size=st.tuples(SIZE, SIZE, SIZE), seed=SEED, balls=st.booleans())
def test_points_and_balls_are_inside(count: int, size: tuple[float, float, float], seed: int, balls: bool) -> None:
    rng = np.random.default_rng(seed)
    points = placed(rng.normal(size=(count, 3)) * size, seed)
    radii = rng.uniform(0, max(size), count) * rng.integers(0, 2, count) if balls else np.zeros(count)
    fit = fit_capsule(points, radii)
    assert outside(points, [fit], radii) <= 0.0
    assert all(np.array_equal(x, y) for x, y in zip(fit, fit_capsule(points, radii)))
    assert (
        volume([fit])
        <= 4 / 3 * np.pi * np.max(np.linalg.norm(points - points.mean(axis=0), axis=1) + radii) ** 3 * 1.001
    )


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((1, 3)),
        np.ones((5, 3)),
        np.array([[0, 0, 0], [1.0, 2, 3]]),
        np.outer(np.linspace(-1, 1, 9), [1, 2, 3]),
        np.array([[0, 0, 0], [1, 0, 0], [0, 1.0, 0]]),
        corners(0.3, 0.2, 0.0),
        1e3 + corners(1e-3, 1e-3, 1e-3),
    ],
    ids=["point", "one point", "segment", "line", "triangle", "flat", "far"],
)
def test_points_without_volume_have_a_capsule(points: Array) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fit = fit_capsule(points)
    assert outside(points, [fit]) <= 0.0
    if np.linalg.matrix_rank(points - points[0], tol=1e-9) <= 1:
        assert fit.radius < 1e-5


@settings(max_examples=30, deadline=None)
@given(radius=SIZE, length=st.floats(0, 2), seed=SEED)
def test_a_capsule_has_itself_as_its_fit(radius: float, length: float, seed: int) -> None:
    ends = placed(np.array([[0, 0, 0], [0, 0, length]]), seed)
    fit = fit_capsule(ends, np.full(2, radius))
    assert volume([fit]) == pytest.approx(volume([Fit(*ends, radius)]), rel=1e-6)


@settings(max_examples=30, deadline=None)
@given(radius=SIZE, length=SIZE)
def test_cylinder(radius: float, length: float) -> None:
    fit = fit_cylinder(radius, length)
    turn = np.linspace(0, 2 * np.pi, 200)
    rim = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), 0 * turn])
    end = np.array([0, 0, length / 2])
    points = np.vstack([rim - end, rim + end])
    assert outside(points, [fit]) <= 0.0
    r = np.linspace(radius, np.hypot(radius, length / 2), 100_001)
    best = np.min(np.pi * r * r * (np.maximum(length - 2 * np.sqrt((r - radius) * (r + radius)), 0) + 4 / 3 * r))
    assert volume([fit]) <= best * (1 + 1e-6)
    assert np.all(fit.a[:2] == 0)
    assert np.all(fit.b[:2] == 0)


CLOUDS: dict[str, Callable[[], Array]] = {
    "long box": lambda: corners(0.1, 0.2, 0.9),
    "flat box": lambda: corners(0.5, 0.4, 0.1),
    "cube": lambda: corners(0.3, 0.3, 0.3),
    "L": lambda: np.vstack([corners(0.1, 0.1, 0.6), corners(0.5, 0.1, 0.1) + np.array([0.25, 0, -0.25])]),
    "tetrahedron": lambda: np.array([[0, 0, 0], [1.0, 0, 0], [0.2, 0.9, 0], [0.3, 0.2, 0.7]]),
    "cloud": lambda: np.random.default_rng(1).normal(size=(30, 3)) * [1, 0.5, 0.3],
    "round cloud": lambda: np.random.default_rng(2).normal(size=(30, 3)),
}


@pytest.mark.parametrize("cloud", CLOUDS.values(), ids=CLOUDS)
def test_no_axis_has_a_smaller_volume(cloud: Callable[[], Array]) -> None:
    points = placed(cloud(), 3)
    hull = points[ConvexHull(points).vertices]
    assert volume([fit_capsule(points)]) <= dense_search(hull) * 1.001


@pytest.mark.parametrize("cloud", CLOUDS.values(), ids=CLOUDS)
def test_the_volume_does_not_depend_on_the_rotation(cloud: Callable[[], Array]) -> None:
    volumes = [volume([fit_capsule(placed(cloud(), seed))]) for seed in range(8)]
    assert max(volumes) <= min(volumes) * (1 + 1e-6)


# URDF files


def link(name: str, *collisions: str) -> str:
    return f'<link name="{name}">{"".join(f"<collision>{each}</collision>" for each in collisions)}</link>'


def geometry(shape: str, origin: str = "") -> str:
    return f"{origin}<geometry><{shape}/></geometry>"


def joint(name: str, parent: str, child: str, type: str = "revolute", origin: str = "") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    limits = '<axis xyz="0 0 1"/><limit lower="-1" upper="2" velocity="3"/>'
    return f'<joint name="{name}" type="{type}">{ends}{origin}{limits}</joint>'


SPHERE = geometry('sphere radius="0.1"')


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    def write(*parts: str) -> Path:
        file = tmp_path / "arm.urdf"
        file.write_text(f'<robot name="r">{"".join(parts)}</robot>')
        return file

    return write


def test_each_link_moves_with_the_last_joint_before_it(write) -> None:
    at = '<origin xyz="{} 0 0"/>'
    file = write(
        *(link(name, SPHERE) for name in ("world", "base", "box", "a", "b", "plate", "finger", "left")),
        joint("mount", "world", "base", "fixed", at.format(1)),
        joint("shelf", "world", "box", "revolute", at.format(2)),
        joint("one", "base", "a", "revolute", at.format(4)),
        joint("side", "a", "left", "prismatic", at.format(8)),
        joint("two", "a", "b", "revolute", at.format(16)),
        joint("flange", "b", "plate", "fixed", at.format(32)),
        joint("grip", "plate", "finger", "revolute", at.format(64)),
    )
    capsules = capsules_of(file, "b")
    found = {c.name: (c.link, float(c.a[0])) for c in capsules}
    assert found == {
        "world": (0, 0),
        "base": (0, 1),
        "box": (0, 2),
        "a": (1, 0),
        "left": (1, 8),
        "b": (2, 0),
        "plate": (2, 32),
        "finger": (2, 96),
    }
    found = {c.name: (c.link, float(c.a[0])) for c in capsules_of(file, "a", "base")}
    assert found["world"] == (0, -1)
    assert found["box"] == (0, 1)
    assert found["finger"] == (1, 112)
    assert [c.link for c in capsules] == sorted(c.link for c in capsules)


def test_shapes_and_their_frames(write) -> None:
    origin = '<origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/>'
    R, p = Rotation.from_euler("xyz", [0.4, 0.5, 0.6]).as_matrix(), np.array([0.1, 0.2, 0.3])
    shapes = ('box size="0.1 0.2 0.6"', 'cylinder radius="0.1" length="0.6"', 'capsule radius="0.1" length="0.6"')
    cylinder = fit_cylinder(0.1, 0.6)
    expected = [fit_capsule(corners(0.1, 0.2, 0.6)), cylinder, Fit(*np.array([[0, 0, -0.3], [0, 0, 0.3]]), 0.1)]
    for shape, own in zip(shapes, expected):
        file = write(link("base"), link("tip", geometry(shape, origin)), joint("a", "base", "tip"))
        (c,) = capsules_of(file, "tip", per_link=1)
        ends = np.array([R @ own.a + p, R @ own.b + p])
        near = min(np.abs(ends - [c.a, c.b]).max(), np.abs(ends - [c.b, c.a]).max())
        assert near < 1e-5
        assert c.radius == pytest.approx(own.radius, abs=1e-6)


def test_parts_of_a_link_have_separate_capsules(write) -> None:
    """Two capsules have a smaller volume than one capsule. Every point of an L is inside a capsule."""
    long, across = (
        geometry('box size="0.1 0.1 0.8"', '<origin xyz="0 0 0.4"/>'),
        geometry('box size="0.8 0.1 0.1"', '<origin xyz="0.4 0 0"/>'),
    )
    file = write(link("base"), link("tip", long, across), joint("a", "base", "tip"))
    one, two, three = (capsules_of(file, "tip", per_link=count) for count in (1, 2, 3))
    assert [len(one), len(two)] == [1, 2]
    assert len(three) >= 2
    assert volume(two) < 0.3 * volume(one)
    rng = np.random.default_rng(0)
    solid = np.vstack(
        [
            rng.uniform(-0.5, 0.5, (2000, 3)) * [0.1, 0.1, 0.8] + [0, 0, 0.4],
            rng.uniform(-0.5, 0.5, (2000, 3)) * [0.8, 0.1, 0.1] + [0.4, 0, 0],
        ]
    )
    for found in (one, two, three):
        assert outside(solid, found) <= 0.0
    assert len(capsules_of(write(link("base"), link("tip", long), joint("a", "base", "tip")), "tip")) == 1


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(size=st.tuples(SIZE, SIZE, SIZE), most=st.integers(1, 3), seed=SEED)
def test_capsules_of_a_divided_box_contain_it(size: tuple[float, float, float], most: int, seed: int, write) -> None:
    box = geometry(f'box size="{size[0]!r} {size[1]!r} {size[2]!r}"')
    found = capsules_of(write(link("base"), link("tip", box), joint("a", "base", "tip")), "tip", per_link=most)
    assert 1 <= len(found) <= most
    assert outside(np.random.default_rng(seed).uniform(-0.5, 0.5, (500, 3)) * size, found) <= 0.0
    assert outside(corners(*size), found) <= 0.0


@pytest.mark.parametrize("kind", ["stl", "obj", "dae"])
def test_meshes(kind: str, tmp_path: Path, write) -> None:
    if kind == "dae":
        pytest.importorskip("collada")
    mesh = trimesh.creation.box(extents=[0.2, 0.4, 0.8])
    (tmp_path / "meshes").mkdir()
    mesh.export(tmp_path / "meshes" / f"part.{kind}")
    named = f'mesh filename="package://robot/meshes/part.{kind}" scale="1 0.5 -0.5"'
    (c,) = capsules_of(write(link("base"), link("tip", geometry(named)), joint("a", "base", "tip")), "tip")
    assert volume([c]) == pytest.approx(volume([fit_capsule(corners(0.2, 0.2, 0.4))]), rel=1e-6)


def test_unit_of_a_dae(tmp_path: Path, write) -> None:
    pytest.importorskip("collada")
    text = trimesh.creation.box(extents=[200, 200, 400]).export(file_type="dae").decode()
    (tmp_path / "part.dae").write_text(text.replace("<up_axis>", '<unit name="millimeter" meter="0.001"/><up_axis>'))
    file = write(link("base"), link("tip", geometry('mesh filename="part.dae"')), joint("a", "base", "tip"))
    (c,) = capsules_of(file, "tip")
    assert volume([c]) == pytest.approx(volume([fit_capsule(corners(0.2, 0.2, 0.4))]), rel=1e-6)


REJECTED = {
    "<geometry/>": "line 1: link 'tip': <collision> must have one <geometry> of box, cylinder, sphere, capsule, mesh",
    "": "line 1: link 'tip': <collision> must have one <geometry> of box, cylinder, sphere, capsule, mesh",
    geometry(
        "torus"
    ): "line 1: link 'tip': <collision> must have one <geometry> of box, cylinder, sphere, capsule, mesh",
    SPHERE + SPHERE: "line 1: link 'tip': <collision> has a second <geometry>: must have one",
    geometry('box size="1 2"'): "link 'tip': box size = '1 2': must be 3 finite numbers",
    geometry('sphere radius="inf"'): "link 'tip': sphere radius = 'inf': must be 1 finite number",
    geometry("sphere"): "link 'tip' has no <sphere radius=\"...\">",
    geometry('sphere radius="-1"'): "link 'tip': sphere of -1: must not be negative",
    geometry("mesh"): "link 'tip' has no <mesh filename=\"...\">",
    geometry(
        'mesh filename="package://no/where.stl"'
    ): "link 'tip': mesh 'package://no/where.stl' is not found: must be below",
}


@pytest.mark.parametrize(("collision", "message"), REJECTED.items(), ids=range(len(REJECTED)))
def test_invalid_collision_is_rejected(collision: str, message: str, write) -> None:
    file = write(link("base"), link("tip", collision), joint("a", "base", "tip"))
    with pytest.raises(ValueError, match=re.escape(f"{file}: {message}")):
        capsules_of(file, "tip")


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("part.stl", b"no mesh", "that trimesh can read|has no triangles"),
        ("part.obj", b"", "that trimesh can read|has no triangles"),
        ("part.obj", b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "its vertices are not finite"),
        (
            "part.dae",
            b"<!DOCTYPE x [<!ENTITY e SYSTEM 'file:///etc/passwd'>]><COLLADA>&e;</COLLADA>",
            "must be a dae file",
        ),
        ("part.pickle", b"", "must be one of stl, obj, dae: convert the mesh"),
    ],
)
def test_invalid_mesh_is_rejected(name: str, content: bytes, message: str, tmp_path: Path, write) -> None:
    (tmp_path / name).write_bytes(content)
    file = write(link("base"), link("tip", geometry(f'mesh filename="{name}"')), joint("a", "base", "tip"))
    with pytest.raises(ValueError, match=message):
        capsules_of(file, "tip")


def test_empty_link_and_invalid_count_are_rejected(write) -> None:
    file = write(link("base"), link("tip"), joint("a", "base", "tip"))
    with pytest.raises(ValueError, match="has no <collision> geometry"):
        capsules_of(file, "tip")
    for count in (0, True, 1.5):
        with pytest.raises(ParameterError, match=r"per_link = .*: must be a whole number, at least 1"):
            capsules_of(file, "tip", per_link=count)


def test_a_chain_alone_does_not_read_collisions(write) -> None:
    file = write(link("base"), link("tip", "<geometry/>"), joint("a", "base", "tip"))
    assert fp.SerialArm.from_urdf(file, "tip").dof == 1


def test_missing_extra_is_named(tmp_path: Path, write) -> None:
    (tmp_path / "part.stl").write_bytes(trimesh.creation.box().export(file_type="stl"))
    file = write(link("base"), link("tip", geometry('mesh filename="part.stl"')), joint("a", "base", "tip"))
    program = (
        "import sys; sys.modules['trimesh'] = None\n"
        "from fpbm_cpp.urdf.capsules import capsules_of\n"
        f"try: capsules_of({str(file)!r}, 'tip')\n"
        "except ImportError as error: print(error)"
    )
    done = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == 'a mesh\'s capsule needs trimesh: pip install "fpbm_cpp[clearance]"'


def test_capsule_is_data() -> None:
    c = Capsule(1, [0, 0, 0], [0, 0, 1], 0.1, "link")
    assert eval(repr(c)) == c
    with pytest.raises(ParameterError, match="radius"):
        Capsule(1, [0, 0, 0], [0, 0, 1], -0.1)
    with pytest.raises(ParameterError, match="link"):
        Capsule(-1, [0, 0, 0], [0, 0, 1], 0.1)


# Meshes from CAD programs

# Largest processor time of the fit in units of machine(): 2 units; without an approximation, 31 units.
UNITS = 6.0


def machine() -> float:
    """Processor time of hulls and of Python's interpreter on this machine, now [s]."""
    begin = time.process_time()
    rng = np.random.default_rng(0)
    for _ in range(60):
        ConvexHull(rng.normal(size=(20_000, 3)))
        sum(i * i for i in range(60_000))
    return time.process_time() - begin


def cad_part(seed: int) -> object:
    """A bracket with rounded bosses and holes, as a CAD program exports it: 46,000 triangles."""
    rng = np.random.default_rng(seed)
    bodies = [trimesh.creation.box(extents=[0.05, 0.04, 0.02]), trimesh.creation.box(extents=[0.02, 0.04, 0.05])]
    bodies[1].apply_translation([0.02, 0, 0.03])
    for _ in range(16):
        boss = trimesh.creation.capsule(height=0.01, radius=0.003, count=[40, 40])
        boss.apply_translation(rng.uniform(-0.025, 0.025, 3))
        bodies.append(boss)
    return trimesh.util.concatenate(bodies)


@pytest.fixture(scope="module")
def cad_arm(tmp_path_factory) -> Path:
    """Four links, each of the same three parts with 138,000 triangles."""
    folder = tmp_path_factory.mktemp("cad")
    parts = [cad_part(seed) for seed in range(3)]
    for i, part in enumerate(parts):
        part.export(folder / f"part{i}.stl")
    shapes = [
        geometry(f'mesh filename="part{i}.stl"', f'<origin xyz="{0.03 * i} 0 {0.02 * i}" rpy="0.{i} 0 0"/>')
        for i in range(3)
    ]
    links = [link(f"l{i}", *shapes) for i in range(4)]
    joints = [joint(f"j{i}", f"l{i}", f"l{i + 1}", origin='<origin xyz="0.12 0 0.02" rpy="1 0 0"/>') for i in range(3)]
    file = folder / "cad.urdf"
    file.write_text(f'<robot name="r">{"".join(links + joints)}</robot>')
    return file


def test_a_fit_to_cad_meshes_takes_seconds(cad_arm: Path) -> None:
    unit = machine()
    begin = time.process_time()
    found = capsules_of(cad_arm, "l3")
    spent = time.process_time() - begin
    assert spent < UNITS * unit, (spent, unit)
    mesh = [trimesh.load(cad_arm.parent / f"part{i}.stl", process=False) for i in range(3)]
    places = read_places(cad_arm, "l3")[2]
    for name, (_, frame) in places.items():
        own = [each for each in found if each.name == name]
        for i, part in enumerate(mesh):
            turn = Rotation.from_euler("x", i / 10).as_matrix()
            shares = np.random.default_rng(i).dirichlet([1, 1, 1], 1)
            inner = np.einsum("ij,fjk->fik", shares, np.asarray(part.triangles)).reshape(-1, 3)
            points = np.vstack([part.vertices, inner]) @ turn.T + [0.03 * i, 0, 0.02 * i]
            assert outside(points @ frame[:3, :3].T + frame[:3, 3], own) <= 1e-9


def test_an_approximation_has_the_extent_of_the_body() -> None:
    part = cad_part(0)
    corners, edges = np.unique(part.vertices, axis=0), np.zeros((0, 2), dtype=int)
    coarse = Shape(corners, edges).coarse()
    assert len(coarse.corners) < len(corners) / 3
    assert coarse.body.corners is corners
    size = np.ptp(corners, axis=0).max()
    far = cKDTree(coarse.corners).query(corners)[0]
    assert far.max() <= np.sqrt(3) * size / CELLS
    few = Shape(corners[:MANY], edges)
    assert few.coarse() is few


@pytest.mark.parametrize("terminal", [True, False])
def test_a_slow_fit_has_a_progress_bar_on_a_terminal(terminal: bool, write, monkeypatch) -> None:
    pytest.importorskip("tqdm")

    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return terminal

    file = write(link("base", SPHERE), link("tip", SPHERE), joint("a", "base", "tip"))
    for delay, shown in ((0.0, terminal), (60.0, False)):
        written = Terminal()
        monkeypatch.setattr(sys, "stderr", written)
        monkeypatch.setattr(capsules, "DELAY", delay)
        assert len(capsules_of(file, "tip")) == 2
        assert ("fitting capsules" in written.getvalue()) == shown


# Robots of other packages


def robots() -> Path | None:
    spec = importlib.util.find_spec("cmeel")
    if spec is None or spec.origin is None:
        return None
    return Path(spec.origin).parents[1] / "cmeel.prefix/share/example-robot-data/robots"


ROBOTS = robots()
# File, tip, base, capsules per link: one if many meshes with many vertices need a long time.
ARMS = {
    "panda": ("panda_description/urdf/panda.urdf", "panda_hand", None, 2),
    "panda capsules": ("panda_description/urdf/panda_collision.urdf", "panda_hand", None, 2),
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "tool0", None, 2),
    "ur10": ("ur_description/urdf/ur10_robot.urdf", "tool0", None, 2),
    "xarm7": ("xarm_description/urdf/xarm7.urdf", "link_eef", None, 2),
    "kinova": ("kinova_description/robots/kinova.urdf", "j2s6s200_end_effector", None, 1),
    "tiago": ("tiago_description/robots/tiago_no_hand.urdf", "arm_7_link", "torso_lift_link", 2),
    "talos": ("talos_data/robots/talos_left_arm.urdf", "gripper_left_base_link", None, 1),
    "romeo": ("romeo_description/urdf/romeo_small.urdf", "l_wrist", "torso", 1),
    "pr2": ("pr2_description/urdf/pr2.urdf", "r_wrist_roll_link", "torso_lift_link", 1),
    "icub": ("icub_description/robots/icub.urdf", "l_hand", "chest", 1),
    "baxter": ("baxter_description/urdf/baxter.urdf", "right_hand_link", None, 1),
}
FLOAT = 1e-6  # Pinocchio's reader of meshes keeps single precision.


def fitted(path: str, tip: str, base: str | None, per_link: int) -> fp.Clearance:
    """The clearance of a robot of example-robot-data."""
    return fp.Clearance.from_urdf(ROBOTS / path, tip, base, per_link=per_link)


def link_frames(arm: fp.SerialArm, q: Array) -> list[Array]:
    """Frames of the base and of each joint, in the base frame."""
    frames = [np.eye(4)]
    for each, position in zip(arm.joints, q):
        step = np.eye(4)
        axis = np.asarray(each.axis) / np.linalg.norm(each.axis)
        if each.type == "prismatic":
            step[:3, 3] = position * axis
        else:
            step[:3, :3] = Rotation.from_rotvec(position * axis).as_matrix()
        frames.append(frames[-1] @ each.placement @ step)
    return frames


def samples(shape: object, rng: np.random.Generator) -> Array:
    """Points of a body in Pinocchio, including all vertices of a mesh."""
    kind = type(shape).__name__
    if kind.startswith("BVH"):
        vertices = shape.vertices()
        weights = rng.dirichlet([1, 1, 1], 3000)
        faces = [shape.tri_indices(int(i)) for i in rng.integers(0, shape.num_tris, 3000)]
        corner = np.array([[vertices[face[k]] for k in range(3)] for face in faces])
        return np.vstack([vertices, np.einsum("ij,ijk->ik", weights, corner)])
    directions = rng.normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    if kind == "Box":
        return corners(1, 1, 1) * 2 * shape.halfSide
    if kind == "Sphere":
        return directions * shape.radius
    assert kind == "Cylinder"
    rim = directions[:, :2] / np.linalg.norm(directions[:, :2], axis=1, keepdims=True) * shape.radius
    return np.column_stack([rim, np.where(directions[:, 2] > 0, 1, -1) * shape.halfLength])


with_robots = pytest.mark.skipif(ROBOTS is None or not ROBOTS.exists(), reason="needs example-robot-data")


@with_robots
@pytest.mark.parametrize("mesh", ["hand", "link0", "link4", "link5", "link7"])
def test_no_axis_has_a_smaller_volume_for_a_mesh(mesh: str) -> None:
    points = read_mesh(ROBOTS / f"panda_description/meshes/collision/{mesh}.stl")[0]
    hull = points[ConvexHull(points).vertices]
    assert volume([fit_capsule(points)]) <= dense_search(hull) * 1.001


# These fits take half a minute of processor time each.
heavy = pytest.mark.skipif("FPBM_ALL_HOMES" not in os.environ, reason="takes minutes: make homes")


@with_robots
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=heavy) if name in ("xarm7", "ur10") else name for name in ARMS]
)
def test_every_vertex_of_an_arm_is_inside_its_capsules(name: str, once) -> None:
    """Vertices by our reader, exactly; vertices and faces by Pinocchio in random postures, up to single precision."""
    pin = pytest.importorskip("pinocchio")
    path, tip, base, most = ARMS[name]
    file = str(ROBOTS / path)
    found = once(fitted, path, tip, base, most).capsules
    of_link = {n: [c for c in found if c.name == n] for n in dict.fromkeys(c.name for c in found)}
    joints, end, places = read_places(file, tip, base)
    for n, shapes in read_shapes(file).items():
        frame = places[n][1]
        for shape in shapes:
            points = shape.points @ frame[:3, :3].T + frame[:3, 3]
            assert all(c.link == places[n][0] for c in of_link[n])
            if shape.cylinder is None:
                whole = shape.moved(frame)
                assert outside(whole.points, of_link[n], whole.sizes) <= 0.0
            else:
                assert outside(points, of_link[n]) <= 0.002 * shape.cylinder[0]  # Points: a prism around the cylinder.

    arm = fp.SerialArm(joints, end)
    model = pin.buildModelFromUrdf(file)
    bodies = pin.buildGeomFromUrdf(model, file, pin.GeometryType.COLLISION, package_dirs=[str(ROBOTS.parents[1])])
    data, shown = model.createData(), bodies.createData()
    rng = np.random.default_rng(0)
    checked = set()
    for _ in range(2):
        q, own = pin.neutral(model), rng.uniform(-1, 1, len(joints))
        for each, position in zip(joints, own):
            k = model.joints[model.getJointId(each.name)]
            q[k.idx_q : k.idx_q + k.nq] = [position] if k.nq == 1 else [np.cos(position), np.sin(position)]
        pin.updateGeometryPlacements(model, data, bodies, shown, q)
        pin.updateFramePlacements(model, data)
        root = model.frames[0].name if base is None else base
        origin = data.oMf[model.getFrameId(root)] if base is not None else pin.SE3.Identity()
        frames = link_frames(arm, own)
        for i, body in enumerate(bodies.geometryObjects):
            n = model.frames[body.parentFrame].name
            points = samples(body.geometry, rng)
            points = (
                points @ shown.oMg[i].rotation.T + shown.oMg[i].translation - origin.translation
            ) @ origin.rotation
            T = frames[places[n][0]]
            assert outside((points - T[:3, 3]) @ T[:3, :3], of_link[n]) <= FLOAT
            checked.add(n)
    assert checked == set(of_link)
