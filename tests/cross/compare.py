"""Compares the output of motions.cpp on two machines: equal lines and statuses, and numbers within a tolerance.

Prints the largest difference in double and in float, relative to the largest number of a line.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path


def read(path: Path) -> dict[str, tuple[str, list[float]]]:
    """Status and numbers of each motion."""
    lines = (line.split() for line in path.read_text().splitlines())
    return {name: (status, [float.fromhex(number) for number in numbers]) for name, status, *numbers in lines}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("here", type=Path)
    parser.add_argument("there", type=Path)
    parser.add_argument("--double", type=float, default=0.0, help="largest relative difference in double")
    parser.add_argument("--float", type=float, default=0.0, help="and in float")
    options = parser.parse_args()

    here, there = read(options.here), read(options.there)
    if here.keys() != there.keys() or not here:
        sys.exit(f"other motions: {sorted(here.keys() ^ there.keys())}")
    most = {"double": 0.0, "float": 0.0}
    for name, (status, numbers) in here.items():
        other_status, others = there[name]
        if status != other_status or len(numbers) != len(others):
            sys.exit(f"{name}: status {status} here and {other_status} there")
        scale = max(map(abs, numbers), default=0.0) or 1.0
        kind = "float" if name.endswith("float") else "double"
        for a, b in zip(numbers, others):
            difference = abs(a - b) / scale
            if not difference <= most[kind]:  # NaN is the largest.
                most[kind] = difference
    print(f"{len(here)} motions differ by {most['double']:.1e} in double and {most['float']:.1e} in float")
    if not (most["double"] <= options.double and most["float"] <= options.float):
        sys.exit(f"more than {options.double:.1e} or {options.float:.1e}")


if __name__ == "__main__":
    main()
