"""Streams of joint postures through a JointStream: bounds, time to rejoin, delay, and naive forwarders for comparison.

    python bench/streams.py [--chunks 20000] [--guarded 500] [--hours 1] [--workers 2]

1. Hostile streams of a policy (re-anchoring, stalls, reordered, not finite, doubled and wrong chunks) on presets:
   excess over the bounds by differences of successive postures, and with a clearance, the smallest distance, and
   contacts of the meshes by Coal (`pip install pin coal`).
2. Time to rejoin a stream after a jump or a stall, relative to Ruckig (`pip install ruckig`) from the same state to the
   same moving target.
3. Delay and ripple of steady streams.
4. Postures sent to an FR3 by forwarders without this library, and by a JointStream, until the first abort by the
   conditions of libfranka (`pip install pylibfranka franky-sim`).
5. Hours of hostile streams at 1 kHz, checked by the conditions of libfranka.
6. Teleoperation over Wi-Fi: times without a motion.
"""

from __future__ import annotations

import argparse
import importlib
import multiprocessing
import os
import sys
import time
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

# One process for each core: the libraries of the processes must not start threads.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

RIDE = 1000  # Chunks of a motion.
LANE = 1.0  # Hours of a motion.


def print_table(title: str, headings: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    print(f"{title}\n\n| " + " | ".join(headings) + " |\n|" + "---|" * len(headings))
    for row in rows:
        print("| " + " | ".join(str(each) for each in row) + " |")
    print(flush=True)


def print_rides(title: str, rides: Sequence[Any]) -> None:
    rows = []
    for name in [*dict.fromkeys(each.name for each in rides), "all"]:
        own = [each for each in rides if name in (each.name, "all")]

        def most(field: str, own: Sequence[Any] = own) -> str:
            return f"{max(getattr(each, field) for each in own):.1e}"

        def total(field: str, own: Sequence[Any] = own) -> str:
            return f"{sum(getattr(each, field) for each in own):,}"

        nearest = min(each.distance for each in own)
        rows.append(
            [
                name,
                *map(total, ("received", "accepted", "raised", "ticks")),
                *map(most, ("position", "velocity", "acceleration", "jerk")),
                *([f"{nearest:.1e}", total("contacts")] if np.isfinite(nearest) else []),
            ]
        )
    headings = ["robot", "chunks", "accepted", "errors", "ticks", "excess of position", "velocity"]
    headings += ["acceleration", "jerk", "smallest distance beyond the margin [m]", "contacts by Coal"]
    print_table(title, headings[: len(rows[0])], rows)


def print_rejoins(rejoins: Sequence[Any]) -> None:
    rows = []
    for name, jump in {"a jump of 20 to 70 mrad": True, "a stall of 0.2 to 0.8 s": False}.items():
        ratio = [each.ours / each.ruckig for each in rejoins if each.jump == jump]
        rows.append([name, len(ratio), *(f"{np.quantile(ratio, part):.3f}" for part in (0.5, 0.95, 1.0))])
    print_table("Time to rejoin / Ruckig", ["after", "motions", "median", "95 %", "largest"], rows)


def print_quality(found: Sequence[Any]) -> None:
    rows = []
    for rate, kind in dict.fromkeys((each.rate, each.kind) for each in found):
        own = [each for each in found if (each.rate, each.kind) == (rate, kind)]
        delay, ripple = max(each.delay for each in own), [each.ripple for each in own]
        times = [f"{1e3 * value:.0f}" for value in (1 / rate, delay, delay - 1 / rate)]
        rows.append([kind, f"{rate:g}", len(own), *times, f"{np.median(ripple):.3f}", f"{max(ripple):.3f}"])
    headings = ["stream", "rate [Hz]", "tasks", "period [ms]", "delay [ms]", "delay beyond a period [ms]"]
    print_table("Steady streams", [*headings, "ripple, median", "largest"], rows)


def print_forwarders(found: Sequence[tuple[str, str, float, bool]]) -> None:
    rows = []
    for stream in dict.fromkeys(each[0] for each in found):
        row = [stream]
        for name in ("held", "linear", "JointStream", "Tracker"):
            own = [each for each in found if each[:2] == (stream, name)]
            aborted, seconds = sum(each[3] for each in own), sum(each[2] for each in own)
            row.append(f"{aborted} of {len(own)}, {3600 * aborted / max(seconds, 1e-3):,.0f}")
        rows.append(row)
    headings = ["stream", "each posture held", "interpolated linearly", "JointStream", "Tracker with a JointStream"]
    print_table("Motions aborted by libfranka, and aborts per hour of motion", headings, rows)


def print_wifi(found: Sequence[tuple[float, Any, Any]]) -> None:
    rows = []
    for delay in dict.fromkeys(each[0] for each in found):
        own = [each for each in found if each[0] == delay]
        still = [f"{1e3 * max(each[1][k] for each in own):.0f}" for k in range(3)]
        worst = [f"{max(each[2][kind] for each in own):.1e}" for kind in ("velocity", "acceleration", "jerk")]
        rows.append([f"{1e3 * delay:.0f}", len(own), *still, *worst])
    headings = ["option delay [ms]", "motions", "longest gap of the stream [ms]", "longest time at rest [ms]"]
    headings += ["after an arrival [ms]", "excess of velocity", "acceleration", "jerk"]
    print_table("Teleoperation at 72 Hz over Wi-Fi", headings, rows)


def require_libfranka() -> None:
    try:
        for name in ("pylibfranka", "franky_sim"):
            importlib.import_module(name)
    except ImportError as error:
        sys.exit(f"{error}: the conditions of libfranka need pip install pylibfranka franky-sim")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--chunks", type=int, default=20_000, help="chunks of hostile streams; 10^6 in the record run")
    parser.add_argument("--guarded", type=int, default=500, help="chunks through a tracker with a clearance")
    parser.add_argument("--hours", type=float, default=1.0, help="hours of hostile streams; 24 in the record run")
    parser.add_argument("--count", type=int, default=100, help="motions of each other table")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()

    from streams_forward import forwarders
    from streams_quality import KINDS, quality, rejoin
    from streams_robots import franka_hours, ride
    from streams_wifi import wifi_motion

    if given.count or given.hours:
        require_libfranka()
    begin = time.monotonic()
    with multiprocessing.Pool(given.workers) as pool:

        def run(function: Any, count: int) -> list[Any]:
            return list(pool.imap_unordered(function, range(count)))

        for title, chunks, guarded in (
            ("Hostile streams", given.chunks, False),
            ("Hostile streams, with a clearance", given.guarded, True),
        ):
            each = min(RIDE, max(chunks // 10, 1))
            if chunks:
                print_rides(title, sorted(run(partial(ride, given.seed, each, guarded), -(-chunks // each))))
        if given.count:
            print_rejoins(run(partial(rejoin, given.seed), given.count))
            rates, tasks = (5.0, 10.0, 20.0, 30.0, 50.0), range(max(1, given.count // 10))
            asked = [(given.seed, rate, kind, number) for kind in KINDS for rate in rates for number in tasks]
            print_quality(pool.starmap(quality, asked))
            print_forwarders([row for rows in run(partial(forwarders, given.seed, 10.0), given.count) for row in rows])
            print_wifi(
                sorted(run(partial(wifi_motion, given.seed, 60.0), max(given.count // 4, 2)), key=lambda x: x[0])
            )
        if given.hours:
            lanes = max(1, round(given.hours / LANE))
            found = run(partial(franka_hours, given.seed, given.hours / lanes), lanes)
            cycles, aborts = sum(each.ticks for each in found), [name for each in found for name in each.conditions]
            print(f"{cycles:.3g} cycles of an FR3, {sum(each.received for each in found):,} chunks: ", end="")
            print(f"{len(aborts)} aborts by libfranka {sorted(set(aborts)) or ''}\n", flush=True)
    print(f"{time.monotonic() - begin:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
