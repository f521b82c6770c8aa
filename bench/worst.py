"""Instructions of the longest ticks that search_worst.cpp has found, and of ticks without active bounds, by callgrind.

Fails if the longest tick of a case has more instructions than its bound.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from count import count

# Largest number of instructions of the longest tick: 5 % more than the longest tick found.
MOST = {
    "panda/pose_jerk": 42_400,
    "panda/pose": 35_100,
    "panda/position_jerk": 40_300,
    "panda/position": 28_100,
    "panda/pose_clear": 280_800,
    "panda/three_levels": 62_000,
    "two_pandas/grasp": 133_000,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path, help="bench_worst, as built")
    counts = count(parser.parse_args().program.resolve())
    cases = [name.removeprefix("free/") for name in counts if name.startswith("free/")]
    print(f"{'instructions a tick':24}{'free':>10}{'worst':>10}{'of free':>10}")
    longer = []
    for case in cases:
        free, worst = counts["free/" + case].usual, counts["worst/" + case].worst
        print(f"{case:24}{free:10.0f}{worst:10.0f}{worst / free:10.2f}")
        if worst > MOST[case]:
            longer.append(f"{case}: the longest tick has more than {MOST[case]:,} instructions")
    if longer:
        sys.exit("\n".join(longer))


if __name__ == "__main__":
    main()
