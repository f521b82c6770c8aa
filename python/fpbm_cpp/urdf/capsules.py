"""Capsules that contain the collision geometry of a URDF file."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._types import Array
from ..capsule import MARGIN, Capsule
from ..errors import wrong
from ..joints import JointLimits, TreeJoint
from .capsule_fit import Fit, fit_capsule, fit_cylinder
from .capsule_gaps import CUTS, Gaps, Link, Part, link_frames, postures, rough_part
from .capsule_slabs import clear
from .chain import Places, read_places, read_tree
from .shapes import Shape, read_shapes, together

FAIR = 0.85  # A link gets several capsules if their volume is at most this fraction of the volume of one capsule.
SEARCHED = 3  # Cuts for which the search runs: those that are best before the search.
MANY = 12  # Largest number of shapes of a link for which groups of shapes are tried.
POSTURES = 64  # Postures in which distances of links are compared.
MORE = 1  # Additional capsules of a link above per_link, if its capsules are too close to others.
DELAY = 2.0  # [s]
GAIN = 0.8  # A finer cut reduces the excess of a pair to at most this fraction; not tuned.


def capsules_of(
    path: str | os.PathLike[str],
    tip: str | None = None,
    base: str | None = None,
    *,
    per_link: int = 2,
    finer: bool = True,
    margin: float = MARGIN,
    required: ArrayLike | None = None,
    allowed: Collection[tuple[str, str]] = (),
    **robot: Any,
) -> list[Capsule]:
    """Tight capsules that contain the collision geometry of the links of a URDF file, from base to tip. Deterministic.

    Arguments and errors are as for Clearance.from_urdf(). robot: arguments of read_joints(). In the required postures
    (k, n), the capsules keep the margin as far as clear() succeeds, except the capsules of allowed pairs of names.
    If finer is False, no link is cut because of other links: see Gaps.

    With tip, each link, also a tool or a finger beyond the tip, belongs to the last joint between base and tip that
    moves the link, or to the base. Other joints are fixed at zero, so the capsules of a gripper or of another arm are
    valid for that posture only. Visual geometry is not read: a link without collision geometry has no capsule.
    """
    if isinstance(per_link, bool) or not isinstance(per_link, (int, np.integer)) or per_link < 1:
        raise wrong("per_link", per_link, f" = {per_link!r}: must be a whole number, at least 1")
    joints, places = read_joints(path, tip, base, **robot)
    shapes = read_shapes(path)
    if not shapes:
        remedy = "must be on at least one link: add <collision>, or give capsules to Clearance()"
        raise ValueError(f"{os.fsdecode(path)}: has no <collision> geometry: {remedy}")
    names = sorted(shapes, key=lambda link: places[link][0])
    links = []
    fitted: dict[bytes, list[Part]] = {}  # Equal arms have equal shapes.
    with _progress(len(names) + 2) as step:
        for name in names:
            number, frame = places[name]
            moved = [shape.coarse().moved(frame) for shape in shapes[name]]
            key = b"/".join(each.points.tobytes() + each.sizes.tobytes() for each in moved)
            if key not in fitted:
                fitted[key] = _parts_of(moved, per_link)
            links.append(Link(number, joints[number - 1].parent if number else -1, list(fitted[key])))
            step()
        if finer and per_link > 1:
            refine(links, joints, per_link + MORE, margin)
        step()
        if required is not None:
            known = {frozenset(pair) for pair in allowed}
            but = {(i, j) for i in range(len(names)) for j in range(len(names)) if {names[i], names[j]} in known}
            clear(links, joints, np.asarray(required, dtype=float), margin, but)
        step()
    fits = [(link.number, part.fit, name) for link, name in zip(links, names) for part in link.parts]
    return [Capsule(number, fit.a, fit.b, fit.radius, name) for number, fit, name in fits]


@contextmanager
def _progress(total: int) -> Iterator[Callable[[], object]]:
    """A function to call after each step. After DELAY, a bar shows the steps in a terminal and in a notebook.

    Without the extra 'progress', there is no bar.
    """
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield lambda: None
        return
    shown = sys.stderr.isatty() or "ipykernel" in sys.modules
    with tqdm(desc="fitting capsules", total=total, delay=DELAY, leave=False, disable=not shown) as bar:
        yield bar.update


def read_joints(
    path: str | os.PathLike[str],
    tip: str | None,
    base: str | None,
    *,
    locked: Mapping[str, float] | None = None,
    tips: Iterable[str] | None = None,
    limits: JointLimits | None = None,
) -> tuple[list[TreeJoint], Places]:
    """The moving joints as joints of a tree, and the place of each link of the file."""
    if tip is None:
        tree = read_tree(path, base=base, locked=locked, tips=tips, limits=limits, notes=[])
        return tree["joints"], {frame.name: (frame.link, frame.offset) for frame in tree["named_frames"]}
    for name, given in {"locked": locked, "tips": tips}.items():
        if given is not None:
            raise wrong(name, given, f" = {given!r:.60}: is for a Robot: give {name}= without tip=")
    joints, _, places = read_places(path, tip, base, limits)
    return [TreeJoint(joint, i) for i, joint in enumerate(joints)], places


def refine(links: list[Link], joints: list[TreeJoint], most: int, margin: float) -> None:
    """Cut links further, into at most `most` parts, if capsules are close and the links' hulls are not: see Gaps.

    A step makes the cut, of all cuts of both links, with the least excess of the pair. Clearance does not check a pair
    that is closer than the margin in all postures; no cut makes this pair a checked pair.
    """
    gaps = Gaps(links, link_frames(joints, postures([each.joint for each in joints], POSTURES)), margin)
    given_up: set[tuple[int, int]] = set()
    halves = cache(lambda part: list(_halves(part)))
    while pair := gaps.worst(given_up):
        tried: list[tuple[float, int, list[Part]]] = []
        for i in pair:
            parts = links[i].parts
            for k, part in enumerate(parts if len(parts) < most else []):
                for both in halves(part):
                    finer = [*parts[:k], *both, *parts[k + 1 :]]
                    tried.append((gaps.excess(pair, i, finer), i, finer))
        tried = sorted(tried, key=lambda each: each[0])[:SEARCHED]
        for k, (_, i, finer) in enumerate(tried):
            finer = [part if part in links[i].parts else rough_part(part.shape) for part in finer]
            tried[k] = gaps.excess(pair, i, finer), i, finer
        excess, i, finer = min(tried, key=lambda each: each[0], default=(np.inf, 0, []))
        if excess > GAIN * gaps.excess(pair):
            given_up.add(pair)
        else:
            links[i].parts = [part.contained() for part in finer]


def _halves(part: Part) -> Iterator[list[Part]]:
    """A part, cut in two."""
    for u in part.directions():
        yield from filter(None, (part.cut(u, [place], search=False) for place in part.places(u, CUTS)))


def _parts_of(shapes: list[Shape], most: int) -> list[Part]:
    """The parts of a link with a capsule each: one part, or several parts if their volume is smaller by 1 - FAIR."""
    whole = _part(together(shapes))
    if most == 1:
        return [whole]
    tried = [_cut(whole, most)]
    if 1 < len(shapes) <= MANY:
        tried.append(_grouped(shapes, most))
    found = [_part(part.shape) for part in min(map(_searched, tried), key=_volume)]
    return found if _volume(found) < FAIR * whole.fit.volume else [whole]


def _volume(parts: Sequence[Part]) -> float:
    return sum(part.fit.volume for part in parts)


def _searched(parts: list[Part]) -> list[Part]:
    return [rough_part(part.shape) for part in parts]


def _part(shape: Shape) -> Part:
    body = shape.body
    if body.cylinder is None:
        return Part(shape, fit_capsule(body.points, body.sizes))
    radius, length, frame = body.cylinder
    fit = fit_cylinder(radius, length)
    a, b = (frame[:3, :3] @ end + frame[:3, 3] for end in (fit.a, fit.b))
    return Part(shape, Fit(a, b, fit.radius))


def _cut(whole: Part, most: int) -> list[Part]:
    """Up to `most` parts between parallel planes, normal to the axis of the capsule or to a principal axis."""
    return min((_searched(_slabs(whole, u, most)) for u in whole.directions()), key=_volume)


def _slabs(whole: Part, u: Array, most: int) -> list[Part]:
    """Cut by planes normal to u, each where the total volume of the capsules is least, while the volume decreases."""
    bounds: list[float] = []
    best = [rough_part(whole.shape, search=False)]
    for _ in range(most - 1):
        ends = [sorted([*bounds, place]) for place in whole.places(u, CUTS) if place not in bounds]
        tried = [(each, parts) for each in ends if (parts := whole.cut(u, each, search=False))]
        finer, parts = min(tried, key=lambda each: _volume(each[1]), default=([], best))
        if not finer or (len(best) > 1 and _volume(parts) >= _volume(best)):
            break
        bounds, best = finer, parts
    return best


def _grouped(shapes: list[Shape], most: int) -> list[Part]:
    """Shapes joined in pairs, first the pair whose common capsule adds the least volume."""
    groups = [rough_part(shape, search=False) for shape in shapes]
    joined = cache(lambda pair: rough_part(together([part.shape for part in pair]), search=False))
    while len(groups) > most:
        pair = min(combinations(groups, 2), key=lambda pair: joined(pair).fit.volume - _volume(pair))
        groups = [*(group for group in groups if group not in pair), joined(pair)]
    return groups
