"""Distances between links by capsules and by convex hulls, in postures that fill the joint ranges."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise, product
from math import isfinite

import numpy as np

from .._core import Robot as CoreRobot
from .._core import link_frames as core_link_frames
from .._types import Array
from ..joints import Joint, TreeJoint
from .capsule_fit import Fit, distances, enclosing, fit_capsule, outermost, sphere
from .shapes import Shape, together

CUTS = 6  # A shape is cut in two at the ends of this number of equal parts.
PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89, 97, 101, 103, 107)
# tests/python/test_home_postures.py passes with these values; they are not from a parameter study.
CLOSE = 1.2  # Capsules closer than CLOSE margins are too close; a start at rest needs one margin.
APART = 1.5  # Links whose hulls are closer than APART margins are not cut: the gain is not worth a capsule.
FIRST = 2  # The first FIRST postures, joints at zero and in the middle: a pair too close in one of them counts.
OFTEN = 0.25  # A pair counts if it is too close in at least this fraction of the postures.
OPEN = 3.0  # [rad] or [m], range of an unbounded joint on each side of zero.
ALIKE = 0.95  # Cosine of the angle between directions that count as equal.
NORMALS = 200  # Directions of the first search for a gap between hulls.
SPREADS = 0.1 * 0.6 ** np.arange(8)  # Spread about the best direction in each round of the search.


@dataclass(frozen=True, eq=False)
class Part:
    """A part of a link, in the frame of its joint, and the capsule that contains it."""

    shape: Shape
    fit: Fit

    def contained(self) -> Part:
        """This part, with a radius such that the capsule contains the body that the shape approximates."""
        body = self.shape.body
        fit = self.fit if body is self.shape else enclosing(self.fit.a, self.fit.b, body.points, body.sizes)
        return Part(self.shape, fit)

    def directions(self, *more: Array) -> list[Array]:
        """The axis of the capsule, the principal axes and more directions, without nearly equal directions."""
        along = self.fit.b - self.fit.a
        found: list[Array] = []
        for u in (along / max(float(np.linalg.norm(along)), 1e-300), *self.shape.principal_axes(), *more):
            if np.any(u) and all(abs(u @ other) < ALIKE for other in found):
                found.append(u)
        return found

    def cut(self, u: Array, places: Iterable[float], search: bool = True) -> list[Part]:
        """The part, cut by planes normal to u at these places; empty if a piece would have no points."""
        shapes = [self.shape.between(u, *ends) for ends in pairwise([-np.inf, *places, np.inf])]
        return [rough_part(shape, search) for shape in shapes] if all(len(shape.points) for shape in shapes) else []

    def places(self, u: Array, count: int) -> list[float]:
        """The ends along u of equal parts of the shape, without its own ends."""
        s = self.shape.points @ u
        return list(np.linspace(s.min(), s.max(), count + 1)[1:-1])


def rough_part(shape: Shape, search: bool = True) -> Part:
    """A part with a rough fit."""
    return Part(shape, fit_capsule(shape.points, shape.sizes, rough=True, search=search))


@dataclass
class Link:
    """A link: its number in the tree, the number of its parent link (-1 for the base), and its parts."""

    number: int
    parent: int
    parts: list[Part]

    def may_collide(self, later: Link) -> bool:
        """Whether a link with an equal or larger number is neither this link nor its child."""
        return later.number > self.number and later.parent != self.number


class Gaps:
    """Pairs of non-adjacent links with capsules closer than CLOSE margins, but hulls farther apart than APART margins.

    A pair counts if it is too close in one of the first postures, or in a fraction OFTEN of all postures.
    """

    def __init__(self, links: list[Link], frames: Array, margin: float) -> None:
        self.links = links
        self.margin, self.close = margin, CLOSE * margin
        inverse = np.linalg.inv(frames)
        self._cases: dict[tuple[int, int], Array] = {}  # Poses of the second link, and their weights.
        self._weights: dict[tuple[int, int], Array] = {}
        self._excluded: dict[tuple[int, int], Array] = {}
        hulls = [_outer(link) for link in links]
        for i, j in combinations(range(len(links)), 2):
            if not links[i].may_collide(links[j]):
                continue
            poses = inverse[:, links[i].number] @ frames[:, links[j].number]
            gaps = self._gaps((i, j), poses)
            if np.max(gaps) < margin:
                self._excluded[i, j] = poses
                continue
            apart, near = APART * margin, np.flatnonzero(gaps < self.close)
            wrong = [k for k in near if hulls_apart(hulls[i], hulls[j], poses[k], apart) >= apart]
            self._cases[i, j] = poses[wrong]
            self._weights[i, j] = np.where(np.array(wrong) < FIRST, 1.0, 1.0 / len(poses))

    def worst(self, but: Collection[tuple[int, int]]) -> tuple[int, int] | None:
        """The pair with the largest excess of all pairs that count, except `but`; None if there is no pair."""
        close = {pair: self._gaps(pair, poses) < self.close for pair, poses in self._cases.items() if pair not in but}
        pairs = [pair for pair, few in close.items() if few @ self._weights[pair] >= OFTEN]
        return max(pairs, key=self.excess, default=None)

    def excess(self, pair: tuple[int, int], i: int = -1, parts: Sequence[Part] = ()) -> float:
        """Excess of a pair: the distances by which its capsules are too close, summed over the postures [m].

        With other parts of link i, infinite if an unchecked pair would become a checked pair.
        """
        for other, poses in self._excluded.items():
            if i in other and np.max(self._gaps(other, poses, i, parts)) > self.margin / 2:
                return np.inf
        lacks = np.maximum(self.close - self._gaps(pair, self._cases[pair], i, parts), 0.0)
        return float(lacks @ self._weights[pair])

    def _gaps(self, pair: tuple[int, int], poses: Array, i: int = -1, parts: Sequence[Part] = ()) -> Array:
        one, other = ([part.fit for part in (parts if k == i else self.links[k].parts)] for k in pair)
        return capsules_apart(one, other, poses)


def _outer(link: Link) -> Shape:
    """The points of a link that are not in the convex hull of all other points."""
    whole = together([part.shape for part in link.parts])
    points, sizes = outermost(whole.points, whole.sizes)
    return Shape(points[sizes == 0.0], centers=points[sizes > 0.0], radii=sizes[sizes > 0.0])


def postures(joints: Sequence[Joint], count: int) -> Array:
    """Positions of all joints (count, n): at zero, in the middle of their ranges, and spread as by spread_posture().

    link_frames() ignores the positions of mimic joints.
    """
    low = np.array([each.lower if isfinite(each.lower) else min(-OPEN, each.upper - OPEN) for each in joints])
    high = np.array([each.upper if isfinite(each.upper) else max(OPEN, low[i] + OPEN) for i, each in enumerate(joints)])
    roots = np.sqrt([PRIMES[i % len(PRIMES)] for i in range(len(joints))])
    shares = np.outer(np.arange(1, count - 1), roots) % 1.0
    return np.vstack([np.clip(np.zeros(len(joints)), low, high), (low + high) / 2, low + shares * (high - low)])


def link_frames(joints: Sequence[TreeJoint], q: Array) -> Array:
    """Frames (count, n + 1, 4, 4) of the base and of each joint after its motion, for positions (count, n)."""
    drives = [i for i, each in enumerate(joints) if each.joint.mimic is None]
    return core_link_frames(CoreRobot(list(joints), [], 0.0, np.zeros(3), np.zeros(3)), q[:, drives])


def capsules_apart(first: Sequence[Fit], second: Sequence[Fit], poses: Array) -> Array:
    """Distances (count,) of two links' capsules for poses (count, 4, 4) of the second link relative to the first."""
    found = np.full(len(poses), np.inf)
    for one, two in product(first, second):
        a, b = (poses[:, :3, :3] @ end + poses[:, :3, 3] for end in (two.a, two.b))
        found = np.minimum(found, _segments_apart(one.a, one.b, a, b) - one.radius - two.radius)
    return found


def _segments_apart(p: Array, q: Array, a: Array, b: Array) -> Array:
    """Distances (count,) between the segment from p to q and the segments from a to b, each (count, 3)."""
    d, e, w = q - p, b - a, p - a
    dd, ee, de, dw, ew = d @ d, np.sum(e * e, axis=1), e @ d, w @ d, np.sum(e * w, axis=1)
    det = dd * ee - de * de
    inner = det > 1e-12 * dd * ee
    s, t = ((x / np.where(inner, det, 1.0)) for x in (de * ew - dw * ee, dd * ew - de * dw))
    inner &= (s > 0.0) & (s < 1.0) & (t > 0.0) & (t < 1.0)
    crossing = np.where(inner, np.linalg.norm(w + np.outer(s, d) - t[:, None] * e, axis=1), np.inf)
    ends = [distances(a, p, q), distances(b, p, q)]
    for end in (p, q):
        share = np.clip(np.sum((end - a) * e, axis=1) / np.maximum(ee, 1e-300), 0.0, 1.0)
        ends.append(np.linalg.norm(end - a - share[:, None] * e, axis=1))
    return np.asarray(np.min([crossing, *ends], axis=0))


def hulls_apart(first: Shape, second: Shape, pose: Array, enough: float = np.inf) -> float:
    """Lower bound on the distance of two links' convex hulls: the widest gap between parallel planes, for many normals.

    The search for a better normal ends when the gap is at least `enough`.
    """
    moved = second.points @ pose[:3, :3].T + pose[:3, 3]

    def best(normals: Array) -> tuple[float, Array]:
        normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        below = np.max(first.points @ normals.T + first.sizes[:, None], axis=0)
        gaps = np.min(moved @ normals.T - second.sizes[:, None], axis=0) - below
        return float(np.max(gaps)), np.asarray(normals[np.argmax(gaps)])

    fan = sphere(NORMALS)
    found = best(fan)
    for spread in SPREADS:
        if found[0] >= enough:
            break
        found = max(found, best(found[1] + spread * fan), key=lambda each: each[0])
    return found[0]
