"""Torques within bounds, and their price: `python bench/torque.py [--count 200] [--price 40] [--workers 2]`.

1. Rollouts of a Panda, a UR10e, the upper body of a Unitree G1 with two arms, and a Unitree Z1: 40 to 80 % of the
   efforts, payloads of 0 to 3 kg, targets that jump (poses, positions and postures that the efforts can hold), stops at
   random moments, ticks of 1, 2 and 4 ms, with and without bounds on jerk and a clearance. Torques by Pinocchio, from
   the URDF files of example-robot-data (G1, Z1) or the joints of the preset. The torques of a tick are those of the
   commanded motion: the acceleration is the difference of the velocities. Tracker.stop() replays the planned stop of
   the last tick, until rest.
2. Price: time until a target posture is reached, with bounds on torque, relative to the same motion without bounds on
   torque, and relative to TSID (`pip install tsid`) with the same bounds on torque and on the joints.
"""

from __future__ import annotations

import argparse
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


def print_table(headings: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    print("| " + " | ".join(headings) + " |\n|" + "---|" * len(headings))
    for row in rows:
        print("| " + " | ".join(str(each) for each in row) + " |")
    print(flush=True)


def print_rollouts(motions: Sequence[Any]) -> None:
    rows, more = [], []
    for name in [*dict.fromkeys(each.name for each in motions), "all"]:
        own = [each for each in motions if name in (each.name, "all")]

        def most(field: str, own: Sequence[Any] = own) -> float:
            return max(float(getattr(each, field)) for each in own)

        def total(field: str, own: Sequence[Any] = own) -> int:
            return sum(int(getattr(each, field)) for each in own)

        rows.append(
            [
                name,
                len(own),
                *(f"{most(field):.1e}" for field in ("ends", "middle", "change_within")),
                *(f"{most(field):.1e}" for field in ("position", "velocity", "acceleration", "jerks")),
                sum(each.distance < 0.0 for each in own),
                total("unanswered"),
                f"{total('stops')}, {total('unstopped')}",
                *(f"{most(field):.1f}" for field in ("longest_stop", "longest_ratio")),
            ]
        )
        torques_only = [each for each in own if not each.clear]
        ticks = sum(each.ticks for each in torques_only)
        free = [each for each in own if np.isfinite(each.free_ends)]
        more.append(
            [
                name,
                f"{sum(each.ends > 1e-9 for each in own)}, {sum(each.ends_at_rest > 1e-9 for each in own)}",
                *(
                    f"{sum(getattr(each, field) for each in torques_only) / max(ticks, 1):.2%}"
                    for field in ("blocked", "blocked_at_rest")
                ),
                f"{np.mean([each.free_ends > 1e-9 for each in free]):.0%}, {max(each.free_ends for each in free):.1f}",
                f"{np.median([each.change for each in free]):.3f}",
                f"{np.median([each.free_change for each in free]):.3f}",
            ]
        )
    print_table(
        [
            *(
                "robot",
                "motions",
                "excess of torque at the ends of a tick [Nm]",
                "in the middle",
                "change within a tick",
            ),
            *("excess of position [rad]", "velocity", "acceleration", "jerk", "motions below the margin"),
            *(
                "ticks without an answer",
                "stops replayed, not ended",
                "longest stop [s]",
                "longest stop / full deceleration",
            ),
        ],
        rows,
    )
    print_table(
        [
            *(
                "robot",
                "motions with an excess > 1e-9 Nm: all, at rest",
                "refused ticks, without a clearance",
                "at rest",
            ),
            "without bounds on torque: motions that exceed the efforts, largest excess [Nm]",
            *("largest change of acceleration / A: median", "without bounds on torque"),
        ],
        more,
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200, help="rollouts; 12,000 in the record run")
    parser.add_argument("--price", type=int, default=40, help="motions of each price; 0: none")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()

    from torque_price import price_tables
    from torque_rollouts import motion

    begin = time.monotonic()
    if given.count:
        with multiprocessing.Pool(given.workers) as pool:
            motions = list(pool.imap_unordered(partial(motion, given.seed), range(given.count), chunksize=4))
        print_rollouts(sorted(motions))
        print(f"{sum(each.ticks for each in motions)} ticks, {time.monotonic() - begin:.0f} s\n", flush=True)
    if given.price:
        for headings, rows in price_tables(given.price, given.seed):
            print_table(headings, rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
