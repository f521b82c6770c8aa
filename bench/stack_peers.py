"""A stack of tasks by several libraries: `python bench/stack_peers.py` builds and runs all, and writes a results page.

In C++ (bench_stack): a limited step of this library, and a cascade of quadratic programs by eiquadprog on Pinocchio's
kinematics. In Python (stack_worker.py): a tick of fp.Tracker, and of Pink, Mink, PlaCo and roboplan. Each library is
installed from PyPI into its own virtual environment, because the requirements of the libraries conflict. The output
lists libraries that cannot be installed. Ratios are computed from times in the same run, with alternating calls.
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
from pathlib import Path
from typing import Any

from stack_solvers import PEERS

import fpbm_cpp

HERE = Path(__file__).resolve().parent
RESULT = HERE / "results" / "stack_peers.md"
CPP_PACKAGES = ("eiquadprog", "pin")


def call(*command: str | Path, **options: Any) -> str:
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, **options).stdout


class Environment:
    """A virtual environment with packages, and with the fpbm_cpp of this interpreter."""

    def __init__(self, folder: Path, packages: tuple[str, ...]) -> None:
        self.python = folder / "bin" / "python"
        if not self.python.exists():
            call(sys.executable, "-m", "venv", folder)
            call(self.python, "-m", "pip", "install", "--quiet", "--no-compile", *packages)
        self.packages = next(folder.glob("lib/python*/site-packages"))
        ours = self.packages / "fpbm_cpp"
        ours.unlink(missing_ok=True)
        ours.symlink_to(Path(fpbm_cpp.__file__).parent)

    def versions(self, packages: tuple[str, ...]) -> str:
        code = "import sys; from importlib.metadata import version\nfor p in sys.argv[1:]: print(p, version(p))"
        return ", ".join(call(self.python, "-c", code, *packages).split("\n")[:-1])


def cpp(work: Path, rounds: int, passes: int) -> tuple[dict[str, Any], str]:
    """The output of bench_stack, and the versions of its libraries."""
    wheels = Environment(work / "cpp", CPP_PACKAGES)
    build = work / "build"
    prefix = f"-DFPBM_PINOCCHIO={wheels.packages / 'cmeel.prefix'}"
    call("cmake", "--preset", "bench", "-B", build, prefix, cwd=HERE.parent)
    call("cmake", "--build", build, "--target", "bench_stack", "--parallel", "1")
    built = json.loads((build / "bench" / "built_with.json").read_text())
    found = json.loads(call(build / "bench" / "bench_stack", str(rounds), str(passes), timeout=1800))
    names = ("compiler", "flags", "Eigen")
    return found, "; ".join([wheels.versions(CPP_PACKAGES), *(f"{name} {built[name]}" for name in names)])


def python(work: Path, name: str) -> tuple[dict[str, Any], str]:
    """The results of another library and of this library, and the versions of the packages."""
    packages = PEERS[name].packages
    peer = Environment(work / name.lower(), packages)
    printed = call(peer.python, HERE / "stack_worker.py", name, env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"})
    return json.loads(printed.strip().split("\n")[-1]), peer.versions((*packages, "numpy"))


def table(heads: list[str], rows: list[list[str]]) -> list[str]:
    lines = ["| " + " | ".join(heads) + " |", "|---|" + "---:|" * (len(heads) - 1)]
    return ["", *lines, *("| " + " | ".join(row) + " |" for row in rows), ""]


TIMES = [
    "", "ratio, median", "ratio of least", "least [µs]", "median [µs]", "p50 [µs]", "p99.9 [µs]", "states: p50 [µs]",
    "states: p99.9 [µs]",
]  # fmt: skip
MOTIONS = [
    "", "ticks limited by bounds", "on a velocity bound", "on an acceleration bound", "near a position bound",
    "excess of position [rad]", "of velocity [rad/s]", "of acceleration [rad/s²]", "tip error, rms [mm]",
    "level 0 not done, median", "90 %", "QPs without answer",
]  # fmt: skip
STACKS = {
    "pose": "Pose of the tip, position of the elbow, posture",
    "position": "Position of the tip, height of the elbow, posture",
}


def time_rows(rows: list[dict[str, Any]]) -> list[list[str]]:
    keys = ("least", "median", "p50", "p99.9", "work_p50", "work_p99.9")
    return [
        [row["name"], f"{row['ratio']:.2f}", f"{row['ratio_of_least']:.2f}", *(f"{row[key] / 1e3:.2f}" for key in keys)]
        for row in rows
    ]


def motion_rows(rows: list[dict[str, Any]]) -> list[list[str]]:
    return [
        [
            row["name"],
            *(f"{row[key]}" for key in ("limited", "velocity_active", "acceleration_active", "position_active")),
            *(f"{row[key]:.0e}" for key in ("position", "velocity", "acceleration")),
            f"{1e3 * row['error_rms']:.1f}",
            *(f"{row[key]:.1e}" for key in ("lacks_median", "lacks_p90")),
            f"{row['unsolved']}",
        ]
        for row in rows
    ]


def fastest(rows: list[dict[str, Any]]) -> dict[str, Any]:
    return min((row for row in rows if "eiquadprog" in row["name"]), key=lambda row: float(row["ratio"]))


def cpp_section(found: dict[str, Any]) -> Iterator[str]:
    yield "## C++: a limited step, compared with a cascade of quadratic programs"
    yield ""
    for stack, result in found.items():
        for states in ("free", "limited"):
            row = fastest(result[states][1:])
            name = f"{stack}, {states}: the fastest cascade ({row['name']})"
            yield f"- {name} needs {row['ratio']:.2f} times the time of this library."
    yield ""
    for stack, result in found.items():
        yield f"### {STACKS[stack]}"
        for states, where in (("free", "no bound is active"), ("limited", "bounds are active")):
            yield ""
            yield f"{result[states][0]['states']} states in which {where}:"
            yield from table(TIMES, time_rows(result[states][1:]))
        yield "The motion of 20 s:"
        yield from table(MOTIONS, motion_rows(result["motions"]))
        yield (
            "Largest relative difference from the motion of level 0 by this library, without active bounds: "
            + "; ".join(f"{each['name']} {each['first']:.0e}" for each in result["differences"])
            + f". Kinematics: {max(each['kinematics'] for each in result['differences']):.0e}."
        )
        yield ""


HEADS = [
    "", "ratio to `tick`, velocity", "ratio, acceleration", "least [µs]", "p50 [µs]", "p99.9 [µs]",
    "tip error, rms [mm]", "rotation, rms [mrad]", "at the end [mm]", "excess of position [rad]", "of velocity [rad/s]",
    "acceleration / bound", "ticks over that bound", "ticks without answer",
]  # fmt: skip


def python_row(name: str, ratios: list[float], row: dict[str, Any]) -> list[str]:
    return [
        name,
        *(f"{ratio:.2f}" for ratio in ratios),
        *(f"{row[key]:.1f}" for key in ("least", "p50", "p99.9")),
        *(f"{1e3 * row[key]:.1f}" for key in ("error", "rotation")),
        f"{1e3 * row['end']:.2f}",
        *(f"{row[key]:.0e}" for key in ("position", "velocity")),
        f"{row['acceleration']:.3g}",
        *(f"{row[key]}" for key in ("over", "failed")),
    ]


def python_section(found: dict[str, dict[str, Any]]) -> Iterator[str]:
    yield "## Python: a tick, compared with a solve call of each peer"
    rows = []
    for name, result in found.items():
        peer, velocity, acceleration = result["rows"]
        bounds = "" if result["acceleration"] else " (no bound on acceleration)"
        rows.append(python_row(name + bounds, result["ratios"], peer))
        ratio = velocity["least"] / acceleration["least"]
        rows.append(python_row(f"fpbm_cpp, velocity, in the run of {name}", [1.0, ratio], velocity))
        rows.append(python_row(f"fpbm_cpp, acceleration, in the run of {name}", [1 / ratio, 1.0], acceleration))
    yield from table(HEADS, rows)
    yield "Largest relative difference from the tip motion of this library in a tick, without active bounds:"
    yield from table(
        ["", "the tip's task alone", "the whole stack"],
        [[name, f"{each['alone']:.0e}", f"{each['whole']:.0e}"] for name, each in found.items()],
    )


def processor() -> str:
    lines = Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []
    names = (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--work", type=Path, default=HERE.parent / "build" / "stack_peers", help="for installed peers")
    parser.add_argument("--out", type=Path, default=RESULT)
    parser.add_argument("--rounds", type=int, default=4000, help="of each row in C++, 64 states each")
    parser.add_argument("--passes", type=int, default=20, help="of single calls on every state in C++")
    parser.add_argument("--skip", nargs="*", default=[], metavar="PEER", help="cpp, or peers of Python")
    options = parser.parse_args()
    work = options.work.resolve()
    work.mkdir(parents=True, exist_ok=True)

    sections: list[str] = []
    versions, missing = [], []
    if "cpp" not in options.skip and shutil.which("cmake"):
        try:
            found, version = cpp(work, options.rounds, options.passes)
            versions.append(version)
            sections += cpp_section(found)
        except (subprocess.SubprocessError, OSError) as error:
            missing.append(f"the cascade: {error}")
    peers = {}
    for name in PEERS:
        if name in options.skip:
            continue
        try:
            peers[name], version = python(work, name)
            versions.append(version)
        except subprocess.SubprocessError as error:
            missing.append(f"{name}: {error}")
    if peers:
        sections += python_section(peers)
    head = [
        "# A stack of tasks, compared with peers",
        "",
        "Written by `python bench/stack_peers.py`; compared quantities: [README](../README.md#stacks).",
        f"{processor()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, Python {platform.python_version()}.",
        "",
        *(f"- {version}" for version in versions),
        *(f"- Missing: {each}" for each in missing),
        "",
    ]
    options.out.write_text("\n".join([*head, *sections]).rstrip() + "\n")
    print(options.out.read_text())


if __name__ == "__main__":
    main()
