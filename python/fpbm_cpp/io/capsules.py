"""A URDF's collision geometry as capsules that contain it."""

from __future__ import annotations

import os
from collections.abc import Callable
from itertools import combinations, pairwise

import numpy as np

from .._types import Array
from ..capsule import Capsule
from ..errors import wrong
from .capsule_fit import Fit, fit_capsule, fit_cylinder
from .urdf import read_places
from .urdf_shapes import Shape, read_shapes, together

FAIR = 0.85  # More capsules than one have at most this share of its volume.
CUTS = 6  # A cut is tried at each of so many parts of a shape.
ALIKE = 0.95  # Cosine of an angle between directions that are as good as one.
MANY = 12  # So many shapes are not tried in groups.


def capsules_of(path: str | os.PathLike[str], tip: str, base: str | None = None, *, per_link: int = 2) -> list[Capsule]:
    """Capsules that contain the collision geometry of a URDF file's links: tight, and the same each time.

    Each link has one, of least volume, or up to per_link where these take at least 15 % less room. Chain and joints are
    those of SerialArm.from_urdf(path, tip, base). Links that no joint between base and tip moves belong to the base,
    each other link to the last such joint before it: tools and fingers beyond the tip as well. Joints that are not
    between base and tip are held at zero, so capsules of an open gripper or of another arm hold for that posture alone.
    Visual geometry is not read: a link that has no other has no capsule.

    Returns
    -------
    list of Capsule
        From base to tip, in frames of the arm's links: that of link i is the file's own for the child of joint i.

    Raises ValueError where the file is no sound URDF, has no such chain or no collision geometry, or a mesh is not
    found or cannot be read; OSError where the file cannot be read; ImportError where an extra is missing.
    """
    if isinstance(per_link, bool) or not isinstance(per_link, (int, np.integer)) or per_link < 1:
        raise wrong("per_link", per_link, f" = {per_link!r}: must be a whole number, at least 1")
    places = read_places(path, tip, base)[2]
    shapes = read_shapes(path)
    if not shapes:
        raise ValueError(f"{os.fsdecode(path)}: has no <collision> geometry")
    found = []
    for name in sorted(shapes, key=lambda link: places[link][0]):
        link, frame = places[name]
        for fit in _fits([shape.moved(frame) for shape in shapes[name]], per_link):
            found.append(Capsule(link, fit.a, fit.b, fit.radius, name))
    return found


def _fits(shapes: list[Shape], most: int) -> list[Fit]:
    """The capsules of a link: one, or more where that saves a fair share of the volume."""
    whole = together(shapes)
    fits = [_fit(whole)]
    ways: list[Callable[[], list[Fit]]] = [lambda: _cut(whole, fits[0], most)]
    if 1 < len(shapes) <= MANY:
        ways.append(lambda: [_fit(group) for group in _grouped(shapes, most)])
    if most > 1:
        fits = min(fits, *(way() for way in ways), key=lambda some: _volume(some) * (FAIR if len(some) == 1 else 1.0))
    return fits


def _volume(fits: list[Fit]) -> float:
    return sum(fit.volume for fit in fits)


def _fit(shape: Shape) -> Fit:
    if shape.cylinder is not None:
        radius, length, frame = shape.cylinder
        fit = fit_cylinder(radius, length)
        R, p = frame[:3, :3], frame[:3, 3]
        return Fit(R @ fit.a + p, R @ fit.b + p, fit.radius)
    return fit_capsule(shape.points, shape.sizes)


def _cut(whole: Shape, fit: Fit, most: int) -> list[Fit]:
    """Up to so many capsules, of the parts between parallel planes: across the one capsule, or a principal axis."""
    along = fit.b - fit.a
    length = float(np.linalg.norm(along))
    directions = [along / length] if length > 0.0 else []
    for u in np.linalg.svd(whole.points - whole.points.mean(axis=0), full_matrices=False)[2]:
        if all(abs(u @ other) < ALIKE for other in directions):
            directions.append(u)
    cuts = [_parts(whole, u, most) for u in directions]
    return [_fit(part) for part in min(cuts, key=lambda parts: sum(map(_rough_volume, parts)))]


def _parts(whole: Shape, u: Array, most: int) -> list[Shape]:
    """Cut by planes across u, each where the parts' capsules get least, while that helps."""
    s = whole.points @ u
    places = np.linspace(s.min(), s.max(), CUTS + 1)[1:-1]
    bounds = [-np.inf, np.inf]
    best = [whole]
    for _ in range(most - 1):
        tried = []
        for place in places:
            if place not in bounds:
                ends = sorted([*bounds, float(place)])
                parts = [whole.between(u, low, high) for low, high in pairwise(ends)]
                if all(len(part.points) for part in parts):
                    tried.append((sum(map(_rough_volume, parts)), ends, parts))
        if not tried:
            break
        volume, ends, parts = min(tried, key=lambda each: each[0])
        if len(best) > 1 and volume >= sum(map(_rough_volume, best)):
            break
        bounds, best = ends, parts
    return best


def _rough_volume(shape: Shape) -> float:
    return fit_capsule(shape.points, shape.sizes, rough=True).volume


def _grouped(shapes: list[Shape], most: int) -> list[Shape]:
    """Shapes joined two by two, those first whose common capsule is least larger than their own."""
    groups = list(shapes)
    while len(groups) > most:
        own = list(map(_rough_volume, groups))
        pairs = combinations(range(len(groups)), 2)
        i, j = min(
            pairs, key=lambda ij: _rough_volume(together([groups[ij[0]], groups[ij[1]]])) - own[ij[0]] - own[ij[1]]
        )
        joined = together([groups[i], groups[j]])
        groups = [group for k, group in enumerate(groups) if k not in (i, j)] + [joined]
    return groups
