"""Instructions per call of each job in count.cpp, by callgrind. The counts do not depend on the load of the machine.

Prints the mean of all calls, the median ("usual") and the maximum ("worst"). If instructions.json has counts for the
compiler, the means are compared with these counts. Fails if a mean has grown by more than 5 %.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import fmean, median
from typing import NamedTuple

CALLS = 128
TOLERANCE = 0.05
RECORD = Path(__file__).with_name("instructions.json")


class Count(NamedTuple):
    """Instructions per call of a job."""

    mean: float
    usual: float
    worst: float


def count(program: Path) -> dict[str, Count]:
    """Instructions per call of each job."""
    with tempfile.TemporaryDirectory() as folder:
        command = ["valgrind", "--tool=callgrind", "--collect-atstart=no", "--callgrind-out-file=out", str(program)]
        run = subprocess.run([*command, str(CALLS)], cwd=folder, capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise SystemExit(f"{program.name} failed under valgrind: {run.stderr.strip().splitlines()[-1]}")
        calls: dict[str, list[int]] = {}
        for dump in Path(folder).iterdir():
            text = dump.read_text()
            job = re.search(r"^desc: Trigger: Client Request: (.+)$", text, re.MULTILINE)
            total = re.search(r"^totals: (\d+)$", text, re.MULTILINE)
            if job and total:
                calls.setdefault(job[1], []).append(int(total[1]))
    nothing = median(calls.pop("nothing"))  # Instructions of the counting itself.
    return {
        job: Count(round(fmean(each) - nothing, 1), median(each) - nothing, max(each) - nothing)
        for job, each in sorted(calls.items())
    }


def compiler_of(program: Path) -> str:
    """Name and major version of the compiler of a program, under which counts are recorded."""
    built_with = json.loads(program.with_name("built_with.json").read_text())
    return str(built_with["compiler"]).split(".")[0]


def recorded() -> dict[str, dict[str, float]]:
    return json.loads(RECORD.read_text()) if RECORD.exists() else {}


def grown(counts: dict[str, float], record: dict[str, float]) -> list[str]:
    """Messages on jobs whose counts have grown too much, and on jobs that only `counts` or only `record` has."""
    lines = [f"{job} is new: record the counts" for job in counts.keys() - record.keys()]
    lines += [f"{job} is recorded, but not counted any more" for job in record.keys() - counts.keys()]
    for job in counts.keys() & record.keys():
        growth = counts[job] / record[job] - 1
        if growth > TOLERANCE:
            lines.append(f"{job} takes {counts[job]:.0f} instructions, {growth:+.1%} on the recorded {record[job]:.0f}")
    return sorted(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path, help="bench_count, as built")
    parser.add_argument("--record", action="store_true", help="write the counts to instructions.json")
    options = parser.parse_args()

    program = options.program.resolve()
    compiler, record = compiler_of(program), recorded()
    counted = count(program)
    print(f"{'instructions a call':46}{'mean':>10}{'usual':>8}{'worst':>8}{'worst/usual':>13}")
    for job, (mean, usual, worst) in counted.items():
        print(f"{job:46}{mean:10.1f}{usual:8.0f}{worst:8.0f}{worst / usual:13.2f}")
    counts = {job: each.mean for job, each in counted.items()}
    if options.record:
        RECORD.write_text(json.dumps({**record, compiler: counts}, indent=2) + "\n")
        print(f"{len(counts)} counts recorded for {compiler}")
    elif compiler not in record:
        print(f"No instruction counts are recorded for {compiler}, only for {', '.join(record) or 'none'}: not checked")
    elif lines := grown(counts, record[compiler]):
        sys.exit("\n".join([*lines, "If the change is intended: make count RECORD=1"]))
    else:
        changes = [counts[job] / record[compiler][job] - 1 for job in counts]
        least, most = min(changes), max(changes)
        print(f"{len(counts)} instruction counts compared with the record of {compiler}: {least:+.1%} to {most:+.1%}")


if __name__ == "__main__":
    main()
