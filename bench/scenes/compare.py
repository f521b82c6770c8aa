"""The simulations of a scene: the published simulation, a Tracker with several gains, and fp.saturate."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from lower_levels import Level
from measures import Measures, measure
from pointing import DT, Motion, Scene, pursue
from resolved import by_saturate, by_tracker

GAINS = (1 / DT, 100.0, 30.0)  # k1 [1/s]; the first gain is the published law.
SATURATE = "`fp.saturate`, scale of SNS"


class Case(NamedTuple):
    name: str
    lower: Sequence[Level]
    published: dict[str, Any] | None


class Outcome(NamedTuple):
    case: str
    row: str
    motion: Motion
    measures: Measures


def tracker_row(k1: float) -> str:
    return f"`Tracker`, k1 = {k1:.0f}/s" + (" = 1/T" if k1 == GAINS[0] else "")


def outcomes(scene: Scene, cases: Sequence[Case], inner: int) -> list[Outcome]:
    found = []
    for case in cases:
        steps = {tracker_row(k1): by_tracker(scene, case.lower, k1) for k1 in GAINS}
        steps[SATURATE] = by_saturate(scene, case.lower)
        for row, step in steps.items():
            motion = pursue(scene, step)
            found.append(Outcome(case.name, row, motion, measure(scene, motion, inner)))
    return found


def table(cases: Sequence[Case], found: Sequence[Outcome], vertices: int, inner: str) -> Iterator[str]:
    axes = cases[0].published or {}
    places = "xyz"[: len(axes["place"])]
    yield (
        "| levels | resolved by | vertices | time [s] | e_d [rad] | off the line: mean, most [mm] "
        f"| speed of {inner} [m/s] | {inner}: {', '.join(places)} [m] |"
    )
    yield "|---|---|---:|---:|---:|---:|---:|---:|"
    for case in cases:
        if case.published is not None:
            p = case.published
            yield (
                f"| {case.name} | published | {vertices} | {p['time']:.3f} | {p['direction']:.4f} | | {p['speed']:.4f} "
                f"| {', '.join(f'{x:.4f}' for x in p['place'])} |"
            )
        for each in (each for each in found if each.case == case.name):
            m = each.measures
            yield (
                f"| {case.name} | {each.row} | {each.motion.reached} | {m.time:.3f} | {m.direction.mean():.4f} "
                f"| {1e3 * m.off_line.mean():.2f}, {1e3 * m.off_line.max():.1f} | {m.speed:.4f} "
                f"| {', '.join(f'{x:.4f}' for x in m.place[: len(places)])} |"
            )


def scale_table(found: Sequence[Outcome]) -> Iterator[str]:
    yield "| levels | resolved by | least scale of each level | mean scale | q | q̇ by Δq | q̈ by Δq̇ | q̈ by Δ²q |"
    yield "|---|---|---:|---:|---:|---:|---:|---:|"
    for each in found:
        least = ", ".join(f"{x:.1e}" if 0 < x < 0.01 else f"{x:.2f}" for x in each.motion.scales.min(axis=0))
        mean = ", ".join(f"{x:.3f}" for x in each.motion.scales.mean(axis=0))
        beyond = " | ".join("none" if x <= 0 else f"{x:.1e}" for x in each.measures.excess)
        yield f"| {each.case} | {each.row} | {least} | {mean} | {beyond} |"


def agreement(scene: Scene, found: Sequence[Outcome]) -> float:
    """Largest difference of the tip between NumPy's kinematics and the library's [m]."""
    arm = scene.arm
    return max(
        float(np.abs(scene.origins(q[None])[0, -1] - arm.forward(q)[:3, 3]).max())
        for each in found
        for q in each.motion.q[::500]
    )
