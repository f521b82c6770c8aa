"""Instructions of the longest ticks that search_worst.cpp has found, and of ticks without active bounds, by callgrind.

Fails if the ratio of the longest tick to a tick without active bounds ("free") exceeds the bound of its case.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from count import count

# Largest ratio of the longest tick to a free tick. Cases without an entry have 4.
MOST = {"panda/pose_clear": 6.0}


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
        if worst > MOST.get(case, 4.0) * free:
            longer.append(f"{case}: the longest tick takes more than {MOST.get(case, 4.0):.0f} free ticks")
    if longer:
        sys.exit("\n".join(longer))


if __name__ == "__main__":
    main()
