"""Distances and normals of capsules, half-spaces and boxes against Coal (Pan, Chitta, Manocha 2012) and exact results.

Coal has closed forms for two capsules, and for a capsule and a half-space. For two short and nearly parallel capsules,
the closed form loses digits. For a capsule and a box, Coal iterates (GJK, EPA) to a tolerance, and sometimes has no
result if the shapes touch. Therefore, all pairs are compared with an enumeration of all features in extended precision.
Pairs for which Coal agrees with this enumeration are also compared with Coal. The number of these pairs is printed and
asserted.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

coal = pytest.importorskip("coal", reason="needs Coal: pip install coal")

ROOT = Path(__file__).parents[2]
EIGEN = Path("/usr/include/eigen3")
PAIRS = 6_000  # Pairs of each kind in each round.
ROUNDS = 2  # 167 for a million pairs of each kind.
TOLERANCE = 1e-9
APART = 1e-6  # Distance of cores, divided by the size: a round-off error of 1e-15 leaves nine digits of a normal.

Array = NDArray[np.float64]
Exact = NDArray[np.longdouble]

PROGRAM = """
#include <cstdio>
#include "fpbm/bound/detail/distance.hpp"

using fpbm::Vector;

Vector<3> vector(const double* x) { return {x[0], x[1], x[2]}; }

fpbm::Nearest<> of(const char kind, const double* x) {
  const fpbm::Capsule<> first{vector(x), vector(x + 3), x[6]};
  x += 7;
  if (kind == 'c') return nearest(first, fpbm::Capsule<>{vector(x), vector(x + 3), x[6]});
  if (kind == 'h') return nearest(first, fpbm::HalfSpace<>{vector(x), x[3]});
  const fpbm::Transform<> pose{vector(x), fpbm::Matrix<3, 3>(Eigen::Map<const Eigen::Matrix3d>(x + 3))};
  return nearest(first, fpbm::Cuboid<>{pose, vector(x + 12)});
}

int main(int, char** arguments) {
  const char kind = arguments[1][0];
  const std::size_t size = kind == 'c' ? 14 : kind == 'h' ? 11 : 22;
  double pair[22];
  while (std::fread(pair, sizeof(double), size, stdin) == size) {
    const fpbm::Nearest<> found = of(kind, pair);
    std::fwrite(&found, sizeof found, 1, stdout);
  }
}
"""


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if not shutil.which("g++") or not EIGEN.exists():
        pytest.skip("needs g++ and Eigen")
    folder = tmp_path_factory.mktemp("distance")
    (folder / "main.cpp").write_text(PROGRAM)
    includes = ["-I", str(ROOT / "cpp/include"), "-isystem", str(EIGEN)]
    subprocess.run(["g++", "-std=c++17", "-O1", *includes, "main.cpp", "-o", "main"], cwd=folder, check=True)
    return folder / "main"


def ours(program: Path, kind: str, pairs: Array) -> tuple[Array, Array]:
    """Distances, and normals: a row each."""
    printed = subprocess.run([program, kind], input=pairs.tobytes(), capture_output=True, check=True).stdout
    found = np.frombuffer(printed).reshape(len(pairs), 10)
    return found[:, 0], found[:, 1:4]


def power(rng: np.random.Generator, low: float, high: float, n: int) -> Array:
    return 10 ** rng.uniform(low, high, (n, 1))


def some(rng: np.random.Generator, share: float, n: int) -> NDArray[np.bool_]:
    return rng.uniform(size=(n, 1)) < share


def segments(rng: np.random.Generator, n: int) -> Array:
    """Start and displacement: of all lengths, some of them zero, some in whole numbers."""
    start, displacement = (power(rng, -3, 1, n) * rng.uniform(-1, 1, (n, 3)) for _ in range(2))
    whole = some(rng, 0.2, n)
    start, displacement = (np.where(whole, rng.integers(-2, 3, (n, 3)), x) for x in (start, displacement))
    return np.hstack((start, np.where(some(rng, 0.1, n), 0, displacement)))


def near(rng: np.random.Generator, first: Array) -> Array:
    """Segments near other segments: parallel, crossing or touching, exactly or nearly (from 1e-18); some far away."""
    n = len(first)
    start, displacement = np.hsplit(segments(rng, n), 2)
    angle = np.where(some(rng, 0.3, n), 0, power(rng, -18, -1, n))
    length = np.linalg.norm(first[:, 3:], axis=1, keepdims=True)
    parallel = rng.uniform(-2, 2, (n, 1)) * (first[:, 3:] + angle * length * rng.uniform(-1, 1, (n, 3)))
    displacement = np.where(some(rng, 0.3, n), parallel, displacement)
    s, t = (np.where(some(rng, 0.5, n), rng.integers(0, 2, (n, 1)), rng.uniform(size=(n, 1))) for _ in range(2))
    start = np.where(some(rng, 0.5, n), first[:, :3] + s * first[:, 3:] - t * displacement, start)
    start = start + np.where(some(rng, 0.5, n), power(rng, -18, -2, n), 0) * rng.uniform(-1, 1, (n, 3))
    return np.hstack((start, displacement))


def capsules(rng: np.random.Generator, cores: Array) -> Array:
    return np.hstack((cores[:, :3], cores[:, :3] + cores[:, 3:], power(rng, -3, 1, len(cores))))


def rotations(rng: np.random.Generator, n: int) -> Array:
    q, r = np.linalg.qr(rng.normal(size=(n, 3, 3)))
    q = q * np.sign(np.diagonal(r, axis1=1, axis2=2))[:, None, :]
    q[:, :, 0] *= np.linalg.det(q)[:, None]
    return np.where(some(rng, 0.3, n)[:, :, None], np.eye(3), q)


def boxes_and_capsules(rng: np.random.Generator, n: int) -> Array:
    """Boxes of all shapes; capsules anywhere, in them, through them, along an edge or with an end on a corner."""
    half = power(rng, -3, 1, 3 * n).reshape(n, 3)
    corner = half * rng.integers(-1, 2, (n, 3))
    cores = near(rng, np.hstack((corner, half * rng.uniform(-1, 1, (n, 3)))))
    edge = half * np.eye(3)[rng.integers(0, 3, n)] * rng.uniform(-2, 2, (n, 1))
    cores[:, 3:] = np.where(some(rng, 0.2, n), edge, cores[:, 3:])
    R, p = rotations(rng, n), rng.uniform(-1, 1, (n, 3))
    turned = np.hstack([np.einsum("nij,nj->ni", R, x) for x in np.hsplit(cores, 2)])
    turned[:, :3] += p
    columns = R.transpose(0, 2, 1).reshape(n, 9)
    return np.hstack((capsules(rng, turned), p, columns, half))


def coal_capsule(row: Array) -> tuple[coal.Capsule, coal.Transform3s]:
    displacement = row[3:6] - row[:3]
    length = np.linalg.norm(displacement)
    z = displacement / length if length > 0 else np.array([0.0, 0.0, 1.0])
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    R = np.stack((x, np.cross(z, x), z), axis=1)
    return coal.Capsule(row[6], length), coal.Transform3s(R, (row[:3] + row[3:6]) / 2)


def coal_second(kind: str, row: Array) -> tuple[coal.CollisionGeometry, coal.Transform3s]:
    if kind == "c":
        return coal_capsule(row)
    if kind == "h":
        return coal.Halfspace(row[:3], row[3]), coal.Transform3s.Identity()
    return coal.Box(*(2 * row[12:])), coal.Transform3s(row[3:12].reshape(3, 3).T, row[:3])


def theirs(kind: str, pairs: Array) -> tuple[Array, Array]:
    request = coal.DistanceRequest()
    request.gjk_tolerance = request.epa_tolerance = 1e-12
    request.gjk_max_iterations = request.epa_max_iterations = 1000
    distances, normals = np.empty(len(pairs)), np.empty((len(pairs), 3))
    for i, pair in enumerate(pairs):
        result = coal.DistanceResult()
        distances[i] = coal.distance(*coal_capsule(pair[:7]), *coal_second(kind, pair[7:]), request, result)
        normals[i] = -result.normal
    return distances, normals


def dot(a: Exact, b: Exact) -> Exact:
    return (a * b).sum(axis=-1, keepdims=True)


def ratio(part: Exact, whole: Exact) -> Exact:
    return np.clip(np.divide(part, whole, out=np.zeros_like(part), where=whole > 0), 0, 1)


def exact_segments(a: Exact, u: Exact, b: Exact, v: Exact) -> Exact:
    """Difference of the nearest points: the shortest from an end to the other segment, or between both lines."""
    w = a - b
    c = np.cross(u, v)
    s = ratio(dot(np.cross(v, w), c), dot(c, c))
    candidates = [w + s * u - ratio(dot(w + s * u, v), dot(v, v)) * v]
    for end in (0, 1):
        candidates.append(w + end * u - ratio(dot(w + end * u, v), dot(v, v)) * v)
        candidates.append(w - end * v + ratio(dot(end * v - w, u), dot(u, u)) * u)
    every = np.stack(candidates)
    least = dot(every, every)[..., 0].argmin(axis=0)
    return every[least, np.arange(len(a))]


def exact_capsules(pairs: Array) -> tuple[Exact, Exact]:
    """Signed distance, and the difference of the nearest points of the cores."""
    a, b, r, c, d, q = np.split(pairs.astype(np.longdouble), [3, 6, 7, 10, 13], axis=1)
    difference = exact_segments(a, b - a, c, d - c)
    return np.sqrt(dot(difference, difference))[:, 0] - (r + q)[:, 0], difference


def exact_half_space(pairs: Array) -> tuple[Exact, Exact]:
    """As exact_capsules(), for capsules and half-spaces: distance of the lower end, and a multiple of the normal."""
    a, b, r, n, offset = np.split(pairs.astype(np.longdouble), [3, 6, 7, 10], axis=1)
    return (np.minimum(dot(n, a), dot(n, b)) - r - offset)[:, 0], 100 * n


def exact_box(pairs: Array) -> tuple[Exact, Exact]:
    """As exact_capsules(), for capsules and boxes: the minimum over ends and edges, or the penetration depth."""
    a, b, r, p, columns, half = np.split(pairs.astype(np.longdouble), [3, 6, 7, 10, 19], axis=1)
    R = columns.reshape(-1, 3, 3).transpose(0, 2, 1)
    a, u = (np.einsum("nij,ni->nj", R, x) for x in (a - p, b - a))
    differences = [x - np.clip(x, -half, half) for x in (a, a + u)]
    gaps = []
    for axis in np.eye(3, dtype=np.longdouble):
        across = [np.asarray(x) for x in np.eye(3) if x @ axis == 0]
        for i in (-1, 1):
            for j in (-1, 1):
                start = half * (i * across[0] + j * across[1] - axis)
                differences.append(exact_segments(a, u, start, 2 * half * axis))
        for n in (np.broadcast_to(axis, u.shape), np.cross(u, axis)):
            length = np.sqrt(dot(n, n))
            gap = np.abs(dot(n, a + u / 2)) - np.abs(dot(n, u)) / 2 - dot(np.abs(n), half)
            gaps.append(np.divide(gap, length, out=np.full_like(gap, -np.inf), where=length > 0)[:, 0])
    every, widest = np.stack(differences), np.max(gaps, axis=0)
    least = dot(every, every)[..., 0].argmin(axis=0)
    difference = np.einsum("nij,nj->ni", R, every[least, np.arange(len(a))])
    apart = np.sqrt(dot(difference, difference))[:, 0]
    inside = widest < 0
    return np.where(inside, widest, apart) - r[:, 0], np.where(inside[:, None], 0, difference)


def gaps(kind: str, pairs: Array, normals: Array) -> Exact:
    """Gap between the shapes of each pair along a unit vector. The gap is at most the distance of the shapes."""
    n = normals.astype(np.longdouble)
    a, b, r = np.split(pairs[:, :7].astype(np.longdouble), [3, 6], axis=1)
    lowest = np.minimum(dot(n, a), dot(n, b)) - r
    second = pairs[:, 7:].astype(np.longdouble)
    if kind == "h":
        highest = second[:, 3:]
    elif kind == "c":
        highest = np.maximum(dot(n, second[:, :3]), dot(n, second[:, 3:6])) + second[:, 6:]
    else:
        along = np.einsum("nij,nj->ni", second[:, 3:12].reshape(-1, 3, 3), n)
        highest = dot(n, second[:, :3]) + dot(np.abs(along), second[:, 12:])
    return (lowest - highest)[:, 0]


def sizes(pairs: Array) -> Array:
    return np.maximum(np.abs(pairs).max(axis=1), 1)


def rounds(kind: str) -> Iterator[Array]:
    rng = np.random.default_rng(17)
    for _ in range(ROUNDS):
        first = segments(rng, PAIRS)
        if kind == "c":
            yield np.hstack((capsules(rng, first), capsules(rng, near(rng, first))))
        elif kind == "h":
            normal = np.where(some(rng, 0.3, PAIRS), np.eye(3)[rng.integers(0, 3, PAIRS)], rng.normal(size=(PAIRS, 3)))
            normal /= np.linalg.norm(normal, axis=1, keepdims=True)
            yield np.hstack((capsules(rng, first), normal, rng.uniform(-10, 10, (PAIRS, 1))))
        else:
            yield boxes_and_capsules(rng, PAIRS)


EXACT = {"c": exact_capsules, "h": exact_half_space, "b": exact_box}


@pytest.mark.parametrize(("kind", "name"), [("c", "two capsules"), ("h", "capsule, half-space"), ("b", "capsule, box")])
def test_distances_and_normals_are_exact_and_agree_with_coal(program: Path, kind: str, name: str) -> None:
    worst = dict.fromkeys(("exact", "normal", "gap", "coal", "coal normal"), 0.0)
    count = dict.fromkeys(("pairs", "inside", "apart", "coal", "coal normal"), 0)

    def keep(what: str, errors: Array) -> None:
        worst[what] = max(worst[what], float(errors.max(initial=0)))

    for pairs in rounds(kind):
        (distance, normal), (coals, coal_normal) = ours(program, kind, pairs), theirs(kind, pairs)
        exact, difference = EXACT[kind](pairs)
        core = np.sqrt(dot(difference, difference))
        apart = core[:, 0] > APART * sizes(pairs)
        exact_normal = difference[apart] / core[apart]
        keep("exact", np.abs(distance - exact))
        keep("gap", np.abs(gaps(kind, pairs, normal) - exact))
        keep("normal", np.linalg.norm(normal[apart] - exact_normal, axis=1))
        agrees = np.abs(coals - exact) <= TOLERANCE
        keep("coal", np.abs(distance - coals)[agrees])
        normal_agrees = np.linalg.norm(coal_normal[apart] - exact_normal, axis=1) <= TOLERANCE
        keep("coal normal", np.linalg.norm(normal - coal_normal, axis=1)[apart][normal_agrees])
        for what, which in zip(
            count, (exact == exact, exact < -pairs[:, 6], apart, agrees, normal_agrees), strict=True
        ):
            count[what] += int(which.sum())
    print(
        f"\n{name}: {count['pairs']} pairs, {count['inside']} of them with the core of the first shape in the second; "
        f"largest errors: distance {worst['exact']:.1e} m, gap along the normal {worst['gap']:.1e} m, "
        f"{count['apart']} normals {worst['normal']:.1e}; the error of Coal exceeds {TOLERANCE} in "
        f"{count['pairs'] - count['coal']} distances and {count['apart'] - count['coal normal']} normals; "
        f"the other results of Coal differ by at most {worst['coal']:.1e} m, {worst['coal normal']:.1e}"
    )
    assert worst["exact"] <= TOLERANCE
    assert worst["gap"] <= TOLERANCE  # Therefore, no other vector has a larger gap, also in contact.
    assert worst["normal"] <= TOLERANCE
    assert worst["coal"] <= 2 * TOLERANCE
    assert worst["coal normal"] <= 2 * TOLERANCE
    assert count["coal"] >= 0.98 * count["pairs"]
    assert count["coal normal"] >= 0.98 * count["apart"]
