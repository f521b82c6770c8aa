"""Runs a command, and prints the time and the memory of the command, with the promised limits.

    cost.py [--seconds S] [--processor S] [--megabytes MB] [--largest MB] COMMAND ...

--seconds is the time by the clock, --processor the processor time of all processes, and --megabytes the memory of all
processes of the command together, measured five times a second (Linux only). These values depend on the load of the
machine and are only printed. --largest is the memory of the largest process: if this memory is above the promised
limit, cost.py fails.
"""

import argparse
import resource
import subprocess
import sys
import time
from collections import defaultdict
from pathlib import Path


def memory(root: int) -> float:
    """Memory of a process and all its descendants [MB]."""
    children, held = defaultdict(list), {}
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            held[int(entry.name)] = int((entry / "statm").read_text().split()[1]) * 4096 / 1e6
        except OSError:
            continue  # The process has ended meanwhile.
        children[parent].append(int(entry.name))
    total, left = 0.0, [root]
    while left:
        process = left.pop()
        total += held.get(process, 0.0)
        left += children[process]
    return total


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for promise in ("seconds", "processor", "megabytes", "largest"):
        parser.add_argument(f"--{promise}", type=float)
    parser.add_argument("command", nargs=argparse.REMAINDER)
    options = parser.parse_args()

    begin, peak = time.monotonic(), 0.0
    with subprocess.Popen(options.command) as running:
        while running.poll() is None:
            peak = max(peak, memory(running.pid))
            time.sleep(0.2)
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    taken = {
        "seconds": (time.monotonic() - begin, "s by the clock"),
        "processor": (usage.ru_utime + usage.ru_stime, "s of processor time"),
        "megabytes": (peak, "MB in all processes together"),
        "largest": (usage.ru_maxrss * 1024 / 1e6, "MB in the largest process"),
    }
    kept = True
    for promise, (value, unit) in taken.items():
        most = getattr(options, promise)
        if most is None:
            continue
        print(f"took {value:.1f} {unit} (promised: at most {most:g})", flush=True)
        kept = kept and (value <= most or promise != "largest")
    return running.returncode if running.returncode != 0 or kept else 1


if __name__ == "__main__":
    sys.exit(main())
