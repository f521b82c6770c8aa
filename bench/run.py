"""Runs every benchmark that has been built or installed, and collects the output in bench/results.

Missing benchmarks are listed as missing, and all other benchmarks are run.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import metadata
from pathlib import Path
from statistics import median
from typing import Any

import count
import report
import stalls

from fpbm_cpp import _core

HERE = Path(__file__).parent
RESULTS = HERE / "results"

# Programs with Google Benchmark, one for each section of the report. Each of 20 repetitions of a row takes SECONDS.
PROGRAMS = ("step", "limited", "parts", "loop", "growth", "trees", "ticks")
SECONDS = 0.02
# Counters of bench_limited in 10,000 problems (Score in limited.hpp).
SCORES = ("slowed", "unsolved", "outside", "off_line", "smaller", "larger")
LATEST = "out.json"


def processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def machine() -> dict[str, Any]:
    return {
        "processor": processor(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "load": round(os.getloadavg()[0], 1),
    }


def isolated_core() -> int | None:
    """A processor that is isolated from the scheduler (isolcpus=…), or None."""
    try:
        cores = Path("/sys/devices/system/cpu/isolated").read_text().strip()
    except OSError:
        return None
    return int(cores.replace(",", "-").split("-")[0]) if cores else None


@contextmanager
def kept_to(core: int | None) -> Iterator[None]:
    """Runs programs on the given core only, and with real-time priority if permitted. None: no change."""
    if core is None:
        yield
        return
    cores, policy, priority = os.sched_getaffinity(0), os.sched_getscheduler(0), os.sched_getparam(0)
    os.sched_setaffinity(0, {core})
    with suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(80))
    try:
        yield
    finally:
        os.sched_setscheduler(0, policy, priority)
        os.sched_setaffinity(0, cores)


def call(program: Path, *arguments: str | Path) -> bytes:
    """The output of a program. A failure stops all programs; the failed program has printed the reason."""
    print(f"running {program.name}", flush=True)
    command = [sys.executable, program] if program.suffix == ".py" else [program]
    run = subprocess.run([*command, *arguments], stdout=subprocess.PIPE, check=False)
    if run.returncode != 0:
        raise SystemExit(f"{program.name} failed")
    return run.stdout


def google_benchmark(program: Path, quick: bool) -> list[dict[str, Any]]:
    """Times of the rows of a program, repeated in random order [ns]."""
    out = program.with_name(LATEST)
    call(
        program,
        "--benchmark_enable_random_interleaving=true",
        f"--benchmark_repetitions={4 if quick else 20}",
        f"--benchmark_min_time={SECONDS}",
        "--benchmark_format=json",
        f"--benchmark_out={out}",
    )
    runs: dict[str, list[dict[str, Any]]] = {}
    for run in sorted(json.loads(out.read_text())["benchmarks"], key=lambda run: run["family_index"]):
        if run["run_type"] == "iteration":
            runs.setdefault(run["run_name"], []).append(run)
    # The processor time does not include the time of other programs.
    return [
        summary(name, [run["cpu_time"] for run in rounds])
        | {score: int(rounds[0][score]) for score in SCORES if score in rounds[0]}
        for name, rounds in runs.items()
    ]


def summary(name: str, times: list[float]) -> dict[str, Any]:
    return {"name": name, "least": min(times), "median": median(times), "repetitions": len(times)}


def cplusplus(folder: Path, quick: bool) -> dict[str, Any]:
    results: dict[str, Any] = {"built_with": json.loads((folder / "built_with.json").read_text())}
    for section in PROGRAMS:
        if (program := folder / f"bench_{section}").exists():
            results[section] = google_benchmark(program, quick)
    # Programs in SIMD lanes that this processor supports.
    programs = [folder / f"bench_lanes_{kind}" for kind in ("baseline", *_core.processor_kinds()[::-1])]
    results["lanes"] = [row for program in programs if program.exists() for row in google_benchmark(program, quick)]
    core = isolated_core()
    results["isolated"] = core is not None
    with kept_to(core):
        results["tail"] = json.loads(call(folder / "bench_tail", *(("1e6", "1e4") if quick else ("1e7", "1e5"))))
    if (program := folder / "bench_count").exists() and shutil.which("valgrind"):
        counts = count.count(program)
        results["instructions"] = {job: each.mean for job, each in counts.items()}
        results["paths"] = {job: [each.usual, each.worst] for job, each in counts.items()}
        results["stalls"] = {job: sum(each.values()) / stalls.CALLS for job, each in stalls.stalls(program).items()}
    return results


def python(folder: Path, quick: bool) -> dict[str, Any]:
    out = folder / LATEST
    call(HERE / "python_peers.py", "--out", out, "--calls", "50" if quick else "200")
    peers = json.loads(out.read_text())
    results = {
        "python": [summary(name, times) for name, times in peers["times"].items()],
        "packages": peers["versions"],
    }
    call(HERE / "sweep.py", "--out", out, "--motions", "400" if quick else "10000")
    results["sweeps"] = json.loads(out.read_text())
    try:
        results["packages"]["scipy"] = metadata.version("scipy")
    except metadata.PackageNotFoundError:
        return results
    call(HERE / "simulate.py", "--out", out)
    return {**results, "circle": json.loads(out.read_text())}


def missing(results: dict[str, Any]) -> list[str]:
    versions = {**results["built_with"], **results.get("packages", {})}
    absent = [name for name, version in versions.items() if not version and name != "flags"]
    return absent + ([] if "instructions" in results else ["valgrind"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="folder of the built programs")
    parser.add_argument("--quick", action="store_true", help="needs one or two minutes, and is less accurate")
    options = parser.parse_args()

    folder = options.folder.resolve()
    results = {"machine": machine(), "quick": options.quick, **cplusplus(folder, options.quick)}
    results |= python(folder, options.quick)
    results["missing"] = missing(results)
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "results.json").write_text(json.dumps(results, indent=1) + "\n")
    report.write(RESULTS)
    print((RESULTS / "results.md").read_text())


if __name__ == "__main__":
    main()
