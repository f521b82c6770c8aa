"""Runs a command, and prints the time and the memory that it takes beside what is promised.

    cost.py SECONDS MEGABYTES COMMAND ...

Linux only: memory is what all processes of the command together hold, looked at five times a second.
"""

import subprocess
import sys
import time
from collections import defaultdict
from pathlib import Path


def memory(root: int) -> float:
    """What a process and all below it hold [MB]."""
    children, held = defaultdict(list), {}
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            held[int(entry.name)] = int((entry / "statm").read_text().split()[1]) * 4096 / 1e6
        except OSError:
            continue  # It has ended meanwhile.
        children[parent].append(int(entry.name))
    total, left = 0.0, [root]
    while left:
        process = left.pop()
        total += held.get(process, 0.0)
        left += children[process]
    return total


def main() -> int:
    seconds, megabytes, *command = sys.argv[1:]
    begin, peak = time.monotonic(), 0.0
    with subprocess.Popen(command) as running:
        while running.poll() is None:
            peak = max(peak, memory(running.pid))
            time.sleep(0.2)
    print(f"took {time.monotonic() - begin:.0f} s (promised: at most {seconds})", flush=True)
    print(f"and {peak:.0f} MB of memory (promised: at most {megabytes})", flush=True)
    return running.returncode


if __name__ == "__main__":
    sys.exit(main())
