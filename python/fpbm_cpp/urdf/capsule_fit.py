"""The smallest capsule around points and balls.

A capsule is the set of points within a radius r of a segment from a to b. The volume pi r^2 |b - a| + 4/3 pi r^3 of a
capsule that contains the points is minimised over a, b and r by sequential quadratic programming, as in El Khoury,
"Planning optimal motions for anthropomorphic systems" (2013), 3.8.1. The search starts from the best capsules on lines
of many directions. On a given line, only r is searched. The result contains all points for every outcome of the search.
"""

from __future__ import annotations

from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._types import Array
from ..errors import extra

DIRECTIONS = 80  # Directions of lines that are tried.
STARTS = 4  # Lines at which the search starts.
APART = 0.9  # Cosine of the least angle between the lines of two starts.
BALL = 0.1  # Length below which a capsule gives a second, longer start; the points are scaled to a unit ball.
ACTIVE = 40  # Points in the first search.
SEARCHES = 20  # Searches, each with points outside the previous result and the near points of the previous search.
MORE = 12  # Points that are added to a search.
SPACING = 0.1  # Least distance of these points.
SLACK = 0.1  # Distance from the surface of the capsule within which the points of a search are kept.
GRID = np.linspace(0.0, 1.0, 17)
MARKS = (np.sqrt(2.0), np.pi)  # Irrational factors: points with equal marks are equal up to round-off.
ROOM = 1e-12  # Slack of the radius, relative to the coordinates, for round-off in distance computations.


class Fit(NamedTuple):
    """A capsule: the ends of its axis, and its radius."""

    a: Array
    b: Array
    radius: float

    @property
    def volume(self) -> float:
        return float(np.pi * self.radius**2 * (np.linalg.norm(self.b - self.a) + 4 / 3 * self.radius))


def fit_capsule(points: Array, radii: Array | None = None, *, rough: bool = False, search: bool = True) -> Fit:
    """The smallest capsule that contains balls at points (N, 3) with radii (N,); default radii: 0.

    Deterministic. A rough fit is several times as fast, and rarely larger. Without the search, the axis is parallel to
    a principal axis. Raises ImportError if SciPy is missing.
    """
    radii = np.zeros(len(points)) if radii is None else radii
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    scale = float(np.max(np.linalg.norm(points - middle, axis=1) + radii))
    if scale == 0.0:
        return Fit(middle, middle, 0.0)
    p, rho = outermost((points - middle) / scale, radii / scale)
    far = _farthest(p, rho)
    starts = _starts(p[far], rho[far], rough)
    if search:
        starts = [_improved(start, p, rho, far, 1e-5) for start in starts]
    best = min(starts, key=lambda fit: fit.volume)
    if not rough:
        best = _improved(best, p, rho, far, 1e-10)
    return enclosing(middle + scale * best.a, middle + scale * best.b, points, radii)


def fit_cylinder(radius: float, length: float) -> Fit:
    """The smallest capsule about the z axis that contains a cylinder about the z axis, centred at the origin."""
    half = length / 2
    rim = np.array([[radius, 0, -half], [radius, 0, half]])
    fit = _on_lines(np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]]), rim, np.zeros(2), 6)[0]
    return enclosing(fit.a, fit.b, rim, np.zeros(2))


def enclosing(a: Array, b: Array, points: Array, radii: Array) -> Fit:
    """The capsule with this axis that contains the balls, with some slack for round-off."""
    room = ROOM * float(np.max(np.abs(points), initial=0.0) + np.max(radii, initial=0.0))
    return Fit(a, b, float(np.max(distances(points, a, b) + radii)) + room)


def distances(points: Array, a: Array, b: Array) -> Array:
    """Distances (N,) of points (N, 3) from the segment from a to b."""
    return np.asarray(np.linalg.norm(points - _nearest(points, a, b)[1], axis=1))


def _nearest(points: Array, a: Array, b: Array) -> tuple[Array, Array]:
    """For each point, the nearest point of the segment: as a fraction from a to b, and in space."""
    along = b - a
    share = np.clip((points - a) @ along / max(float(along @ along), 1e-300), 0.0, 1.0)[:, None]
    return share, a + share * along


def outermost(points: Array, radii: Array) -> tuple[Array, Array]:
    """The points that are not in the convex hull of all other points."""
    spatial = extra("scipy.spatial", "a capsule that fits", "clearance")
    bare = points[radii == 0.0]
    if len(bare) > 4:
        # Edges share their ends. Points with equal marks count once; enclosing() makes the result contain all points.
        mark = bare[:, 0] + MARKS[0] * bare[:, 1] + MARKS[1] * bare[:, 2]
        bare = bare[np.sort(np.unique(mark, return_index=True)[1])]
        with suppress(spatial.QhullError):  # Coplanar points have no hull, and are usually few.
            bare = bare[spatial.ConvexHull(bare).vertices]
    balls = radii > 0.0
    return np.vstack([bare, points[balls]]), np.concatenate([np.zeros(len(bare)), radii[balls]])


def sphere(count: int) -> Array:
    """Directions on a spiral that fill the sphere evenly."""
    i = np.arange(count)
    z, turn = 1.0 - (2 * i + 1.0) / count, np.pi * (1.0 + np.sqrt(5.0)) * i
    flat = np.sqrt(1.0 - z * z)
    return np.column_stack([flat * np.cos(turn), flat * np.sin(turn), z])


SPIRAL = sphere(2 * DIRECTIONS)[:DIRECTIONS]  # Half of the sphere.


def _farthest(points: Array, radii: Array) -> NDArray[np.intp]:
    """Indices of the farthest balls in the directions of the spiral and in the opposite directions."""
    along = points @ SPIRAL.T
    return np.unique(np.argmax(np.hstack([along, -along]) + radii[:, None], axis=0))


def _starts(points: Array, radii: Array, rough: bool) -> list[Fit]:
    """The best capsules on lines of many different directions, or on a principal axis; they contain these points."""
    principal = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2]
    directions, most = (principal, 1) if rough else (np.vstack([principal, SPIRAL]), STARTS)
    fits = sorted(zip(_about(directions, points, radii, rough), directions), key=lambda found: found[0].volume)
    chosen: list[tuple[Fit, Array]] = []
    for fit, u in fits:
        if len(chosen) < most and all(abs(u @ other) < APART for _, other in chosen):
            chosen.append((fit, u))
    # The search cannot rotate a ball.
    balls = [(fit, u) for fit, u in chosen if np.linalg.norm(fit.b - fit.a) < BALL]
    longer = [Fit(fit.a - BALL * u, fit.b + BALL * u, fit.radius) for fit, u in balls]
    return [*(fit for fit, _ in chosen), *longer]


def _about(directions: Array, points: Array, radii: Array, rough: bool) -> list[Fit]:
    """A small capsule for each direction (D, 3): the axis passes near the centre of the points' projection."""
    shadows = points - (directions @ points.T)[:, :, None] * directions[:, None, :]  # (D, N, 3)
    middles = shadows.mean(axis=1)
    each = np.arange(len(directions))
    for step in range(2, 12 if rough else 30):  # Badoiu and Clarkson, "Smaller core-sets for balls".
        away = shadows - middles[:, None, :]
        far = np.argmax(np.sqrt(np.einsum("dni,dni->dn", away, away)) + radii, axis=1)
        middles = middles + away[each, far] / step
    return _on_lines(middles, directions, points, radii, 2)


def _on_lines(origins: Array, directions: Array, points: Array, radii: Array, rounds: int) -> list[Fit]:
    """A small capsule with its axis on each line (D, 3): for a larger r, the axis may be shorter.

    A grid search over r, for all lines simultaneously; each round divides the interval by 8.
    """
    away = points - origins[:, None]  # (D, N, 3)
    s = np.einsum("dnk,dk->dn", away, directions)
    d = np.linalg.norm(away - s[:, :, None] * directions[:, None], axis=2)
    least = np.max(d + radii, axis=1)
    middles = (s.min(axis=1) + s.max(axis=1)) / 2
    most = np.max(np.hypot(s - middles[:, None], d) + radii, axis=1)  # Radius of a ball around all points.
    each = np.arange(len(s))
    begin, width = np.zeros(len(s)), np.ones(len(s))
    for _ in range(rounds):
        x = np.minimum(begin[:, None] + width[:, None] * GRID, 1.0)
        # The slope of the volume at the least radius may be infinite in r, not in x.
        r = least[:, None] + (most - least)[:, None] * x * x  # (D, G)
        reach = np.sqrt(np.maximum((r[:, :, None] - radii) ** 2 - (d * d)[:, None], 0.0))  # (D, G, N)
        low, high = np.min(s[:, None] + reach, axis=2), np.max(s[:, None] - reach, axis=2)
        best = np.argmin(r * r * (np.maximum(high - low, 0.0) + 4 / 3 * r), axis=1)
        begin, width = np.maximum(x[each, best] - width / 16, 0.0), width / 8
    low, high, r = low[each, best], high[each, best], r[each, best]
    middle = (low + high) / 2
    a, b = (origins + end[:, None] * directions for end in (np.minimum(low, middle), np.maximum(high, middle)))
    return [Fit(*each) for each in zip(a, b, map(float, r))]


def _improved(start: Fit, points: Array, radii: Array, far: NDArray[np.intp], tolerance: float) -> Fit:
    """A capsule near the start that contains the points and has a local minimum of the volume."""
    optimize = extra("scipy.optimize", "a capsule that fits", "clearance")

    def volume(x: Array) -> tuple[float, Array]:
        along, r = x[3:6] - x[:3], x[6]
        length = float(np.linalg.norm(along))
        pull = r * r * along / max(length, 1e-12)
        return r * r * (length + 4 / 3 * r), np.concatenate([-pull, pull, [2 * r * length + 4 * r * r]])

    def room(x: Array, seen: NDArray[np.intp]) -> Array:
        return np.asarray(x[6] - radii[seen] - distances(points[seen], x[:3], x[3:6]))

    def rates(x: Array, seen: NDArray[np.intp]) -> Array:
        share, foot = _nearest(points[seen], x[:3], x[3:6])
        away = points[seen] - foot
        away /= np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-12)
        return np.hstack([(1 - share) * away, share * away, np.ones((len(seen), 1))])

    x = np.concatenate([start.a, start.b, [start.radius]])
    everything = np.arange(len(points))
    left = room(x, everything)
    seen = far[np.argsort(left[far], kind="stable")[:ACTIVE]]
    best = enclosing(start.a, start.b, points, radii)
    for _ in range(SEARCHES):
        constraint: dict[str, Any] = {"type": "ineq", "fun": room, "jac": rates, "args": (seen,)}
        options = {"ftol": tolerance}
        x = optimize.minimize(volume, x, jac=True, method="SLSQP", constraints=constraint, options=options).x
        if not np.all(np.isfinite(x)):
            break
        best = min(best, enclosing(x[:3], x[3:6], points, radii), key=lambda fit: fit.volume)
        left = room(x, everything)
        outside = _apart(points, everything[left < -tolerance], left)
        if not len(outside):
            break
        seen = np.union1d(seen[left[seen] < SLACK], outside)
    return best


def _apart(points: Array, some: NDArray[np.intp], left: Array) -> NDArray[np.intp]:
    """Up to MORE of some points, those with the least `left` first, at distances of at least SPACING."""
    some = some[np.argsort(left[some], kind="stable")]
    chosen: list[np.intp] = []
    while len(some) and len(chosen) < MORE:
        chosen.append(some[0])
        some = some[np.linalg.norm(points[some] - points[some[0]], axis=1) > SPACING]
    return np.array(chosen, dtype=np.intp)
