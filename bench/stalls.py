"""Loads that wait for stores (store-forwarding stalls) per call of each job, from a memory trace by lackey.

If the bytes of a load are still in the store buffer of the processor, the load has no stall only if a single store
wrote all these bytes. If several stores wrote the bytes, or a store wrote only a part of the bytes, the load waits
until the stores are complete: about a dozen cycles. A usual cause is a 16-byte load of two numbers that were stored
separately. The trace contains all addresses. Therefore, the counts are exact, and do not depend on the load of the
machine.

If stalls.json has counts for the compiler, the new counts are compared with the recorded counts. Fails if a job has
more stalls than recorded.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from count import compiler_of

CALLS = 8
# Size of the store buffer of a Skylake. Older stores are complete.
BUFFER = 56
RECORD = Path(__file__).with_name("stalls.json")
CASES = {"planar4/position": ["fpbm", "fpbm_damped"], "panda/pose": ["fpbm", "fpbm_damped"]}
JOBS = [
    job
    for case, schemes in CASES.items()
    for job in [
        f"kinematics/{case}",
        *(f"{part}/{case}/{scheme}" for part in ("resolve", "step") for scheme in schemes),
    ]
] + ["step/ur5e/torch/fpbm_damped"]


class Stores:
    """The last store of each byte."""

    def __init__(self) -> None:
        self.count = 0
        self.writers: dict[int, int] = {}

    def add(self, address: int, size: int) -> None:
        self.count += 1
        for byte in range(address, address + size):
            self.writers[byte] = self.count

    def stall(self, address: int, size: int) -> bool:
        """Whether a load of these bytes stalls: a store that may be in the buffer wrote a part of the bytes only."""
        writers = {self.writers.get(byte, 0) for byte in range(address, address + size)}
        return len(writers) > 1 and max(writers) > self.count - BUFFER


def find(trace: Iterable[str], mark: int) -> list[Counter[int]]:
    """For each job, the number of stalls of each instruction (by address) between stores to the mark."""
    stores, jobs, calls, instruction = Stores(), [Counter[int]()], 0, 0
    inside = False
    for line in trace:
        kind, _, rest = line.strip().partition(" ")
        address_of, _, size_of = rest.strip().partition(",")
        if kind not in ("I", "L", "S", "M") or not size_of:
            continue
        address, size = int(address_of, 16), int(size_of)
        if kind == "I":
            instruction = address
            continue
        if kind == "S" and address == mark:
            inside = not inside
            calls += inside
            if inside and calls > CALLS * len(jobs):
                jobs.append(Counter())
            continue
        if kind in ("L", "M") and inside and stores.stall(address, size):
            jobs[-1][instruction] += 1
        if kind in ("S", "M"):
            stores.add(address, size)
    return jobs


def stalls(program: Path) -> dict[str, Counter[int]]:
    """For each job, the number of stalls of each instruction, by address."""
    symbols = subprocess.run(["nm", "-C", str(program)], capture_output=True, text=True, check=True).stdout
    mark = re.search(r"^([0-9a-f]+) \w bench::.*::mark$", symbols, re.MULTILINE)
    assert mark
    command = ["valgrind", "--tool=lackey", "--trace-mem=yes", str(program), str(CALLS), *JOBS]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace") as run:
        assert run.stdout
        assert run.stderr
        jobs = find(run.stderr, int(mark[1], 16))
        names = run.stdout.read().split()
    if run.returncode != 0 or len(names) != len(jobs):
        raise SystemExit(f"{program.name} failed under valgrind")
    return dict(zip(names, jobs, strict=True))


def listing(program: Path) -> dict[int, str]:
    """The instructions of a program, by address."""
    command = ["objdump", "-d", "-C", "--no-show-raw-insn", str(program)]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return {int(m[1], 16): m[2] for m in re.finditer(r"^ *([0-9a-f]+):\s+(.+)$", text, re.MULTILINE)}


def recorded() -> dict[str, dict[str, float]]:
    return json.loads(RECORD.read_text()) if RECORD.exists() else {}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path, help="bench_count, as built")
    parser.add_argument("--record", action="store_true", help="write the counts to stalls.json")
    parser.add_argument("--where", metavar="JOB", help="also print the instructions that wait in this job")
    options = parser.parse_args()

    program = options.program.resolve()
    compiler, record = compiler_of(program), recorded()
    found = stalls(program)
    counts = {job: sum(each.values()) / CALLS for job, each in sorted(found.items())}
    known = record.get(compiler, {})
    print(f"{'loads that wait for stores, a call':40}{'found':>8}{'recorded':>10}")
    for job, each in counts.items():
        print(f"{job:40}{each:8.1f}{known.get(job, ''):>10}")
    if options.where:
        text = listing(program)
        for address, times in sorted(found[options.where].items()):
            print(f"{times / CALLS:6.1f}  {address:#x}  {text.get(address, '')}")
    if options.record:
        RECORD.write_text(json.dumps({**record, compiler: counts}, indent=2) + "\n")
    elif not known:
        print(f"No counts are recorded for {compiler}, only for {', '.join(record) or 'no compiler'}: not checked")
    elif more := [job for job in counts if counts[job] > known.get(job, 0.0)]:
        sys.exit(f"More than recorded: {', '.join(more)}. If the change is intended: python bench/stalls.py … --record")


if __name__ == "__main__":
    main()
