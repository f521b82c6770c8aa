"""Cuts of links, so that their capsules keep the margin in required postures."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator
from functools import cache

import numpy as np

from .._types import Array
from ..errors import extra
from ..joints import TreeJoint
from .capsule_fit import enclosing
from .capsule_gaps import CUTS, Link, Part, capsules_apart, link_frames, postures

MOST = 8  # Largest number of capsules of a link: TIAGo's torso needs 5 in its home posture.
SLABS = (3, 4, 5)  # Numbers of equal slabs that are tried.
STEPS = (0.1, 0.2, 0.5, 1.0)  # Displacements of a capsule that are tried, in radii; not tuned.
LEAST = 0.1  # Fraction of a part's missing distance that a cut must gain; not tuned.
SPREAD = 64  # Postures, in addition to the required ones, that decide which pairs are close in all postures.
ROOM = 1.01  # Required distance [margins]; Clearance accepts a posture with a distance of 1.


class Postures:
    """Missing distances of the links' capsules to a margin in required postures."""

    def __init__(
        self,
        links: list[Link],
        joints: list[TreeJoint],
        required: Array,
        margin: float,
        but: Collection[tuple[int, int]],
    ) -> None:
        self.links, self.margin, self.count = links, margin, len(required)
        frames = link_frames(joints, np.vstack([required, postures([each.joint for each in joints], SPREAD)]))
        inverse = np.linalg.inv(frames)
        self.poses = {
            (i, j): inverse[:, one.number] @ frames[:, other.number]
            for i, one in enumerate(links)
            for j, other in enumerate(links)
            if one.may_collide(other) and (i, j) not in but
        }
        self.touching = {pair for pair in self.poses if self._touch(*pair)}

    def _touch(self, i: int, j: int) -> bool:
        """Whether corners of the links, and thus their capsules, are closer than the margin in a required posture."""
        spatial = extra("scipy.spatial", "a capsule that fits", "clearance")
        one, other = (np.vstack([part.shape.points for part in self.links[k].parts]) for k in (i, j))
        tree = spatial.cKDTree(one)
        return any(
            float(np.min(tree.query(other @ pose[:3, :3].T + pose[:3, 3])[0])) < self.margin
            for pose in self.poses[i, j][: self.count]
        )

    def lack(self, i: int, j: int, one: list[Part], other: list[Part]) -> float:
        """Missing distance of parts of link i and link j to the margin, summed over the required postures [m].

        As in Clearance, capsules that are closer than the margin in all postures do not count.
        """
        found = np.zeros(self.count)
        for a in one:
            for b in other:
                gaps = capsules_apart([a.fit], [b.fit], self.poses[i, j])
                if np.max(gaps) >= self.margin:
                    found = np.maximum(found, ROOM * self.margin - gaps[: self.count])
        return float(np.sum(found))

    def lack_of_link(self, i: int, parts: list[Part]) -> float:
        """Missing distance of parts of link i to all other links [m]; infinite if nonzero for a touching link."""
        total = 0.0
        for pair in self.poses:
            if i in pair:
                one, other = (parts if k == i else self.links[k].parts for k in pair)
                lack = self.lack(*pair, one, other)
                if lack > 0.0 and pair in self.touching:
                    return np.inf
                total += lack
        return total

    def worst(self, given_up: Collection[tuple[int, int]]) -> tuple[int, int] | None:
        """The pair with the largest missing distance of all pairs that do not touch; None if it is 0."""
        lacks = {
            (i, j): self.lack(i, j, self.links[i].parts, self.links[j].parts)
            for i, j in self.poses
            if (i, j) not in self.touching and (i, j) not in given_up
        }
        pair = max(lacks, key=lambda each: lacks[each], default=None)
        return pair if pair is not None and lacks[pair] > 0.0 else None


def clear(
    links: list[Link], joints: list[TreeJoint], required: Array, margin: float, but: Collection[tuple[int, int]] = ()
) -> None:
    """Change capsules of links that keep the margin in the required postures (k, n) until the capsules keep the margin.

    Pairs of links in `but` are ignored. Capsules are first moved, since a displacement adds no capsule: TIAGo then has
    33 capsules, whereas 43 were not enough if cuts came first. If no displacement helps, the cut with the largest gain
    per added capsule is made, of all cuts of a pair's links.
    """
    state = Postures(links, joints, required, margin, but)
    given_up: set[tuple[int, int]] = set()
    slabs = cache(lambda part: list(_slabs(part)))
    while pair := state.worst(given_up):
        found = _best(state, pair, _moved) or _best(state, pair, slabs)
        if found is None:
            given_up.add(pair)
            continue
        i, parts = found
        before, links[i].parts = links[i].parts, [part.contained() for part in parts]
        if state.lack_of_link(i, links[i].parts) >= state.lack_of_link(i, before):
            links[i].parts = before
            given_up.add(pair)


def _best(
    state: Postures, pair: tuple[int, int], splits: Callable[[Part], Iterable[list[Part]]]
) -> tuple[int, list[Part]] | None:
    """The link of a pair, and its parts after the change of one part with the largest gain; None without a gain."""
    most, best = 0.0, None
    for i in pair:
        parts = state.links[i].parts
        for k, part in enumerate(parts):
            one, other = ([part] if n == i else state.links[n].parts for n in pair)
            if state.lack(*pair, one, other) == 0.0:
                continue
            lack = state.lack_of_link(i, [part])
            for new in splits(part):
                if len(parts) + len(new) - 1 <= MOST:
                    gain = lack - state.lack_of_link(i, new)
                    rate = gain / max(len(new) - 1, 1)
                    if gain > LEAST * lack and rate > most:
                        most, best = rate, (i, [*parts[:k], *new, *parts[k + 1 :]])
    return best


def _slabs(part: Part) -> Iterator[list[Part]]:
    """A part, cut in two or into equal slabs."""
    for u in part.directions(*np.eye(3)):
        halves = [[place] for place in part.places(u, CUTS)]
        yield from filter(None, (part.cut(u, each) for each in [*halves, *(part.places(u, n) for n in SLABS)]))


def _moved(part: Part) -> Iterator[list[Part]]:
    """A part with its capsule displaced: behind a flat face, a larger capsule with a farther axis bulges less."""
    for u in part.directions(*np.eye(3)):
        for step in (*STEPS, *(-step for step in STEPS)):
            a, b = (end + step * part.fit.radius * u for end in (part.fit.a, part.fit.b))
            yield [Part(part.shape, enclosing(a, b, part.shape.points, part.shape.sizes))]
