"""Writes the tables of bench/results/results.json to results.md, and a chart to results.png."""

from __future__ import annotations

import argparse
import json
import textwrap
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import promises
import report_trees

RESULTS = Path(__file__).parent / "results"
README = Path(__file__).parent.parent / "README.md"
BEGIN, END = "<!-- bench: begin -->\n", "<!-- bench: end -->\n"

CPLUSPLUS = {
    "fpbm_cpp": "fpbm_cpp",
    "fpbm_cpp_damped": "damping on",
    "pinocchio": "Pinocchio + Eigen",
    "kdl": "KDL + Eigen",
    "kdl_pinv": "KDL `_pinv`",
    "kdl_wdls": "KDL `_wdls`",
}
LANES = {
    "fpbm_cpp": "without lanes",
    "baseline": "in 2 lanes, SSE2",
    "avx2": "in 4 lanes, AVX2",
    "avx512": "in 8 lanes, AVX-512",
}
LIMITED = {
    "fpbm_cpp": "fpbm_cpp",
    "eiquadprog_rt": "eiquadprog-rt (QP)",
    "eiquadprog_fast": "eiquadprog-fast (QP)",
    "tsid": "TSID (QP)",
}
PYTHON = {
    "fpbm_cpp": "fpbm_cpp",
    "fpbm_cpp_many": "10,000 states a call",
    "pinocchio_numpy": "Pinocchio + NumPy",
    "robotics_toolbox": "Robotics Toolbox + NumPy",
    "pink": "Pink (QP)",
    "mink": "Mink (QP)",
}

Row = dict[str, Any]


def table(heads: list[str], rows: Iterable[list[str]]) -> list[str]:
    """A table in Markdown: the first column is left-aligned, and the others are right-aligned."""
    return [
        "| " + " | ".join(heads) + " |",
        "|" + "---|" + "---:|" * (len(heads) - 1),
        *("| " + " | ".join(row) + " |" for row in rows),
        "",
    ]


def nanoseconds(time: float) -> str:
    """A time in ns, µs or ms, with three digits."""
    power = min(len(str(int(time))) - 1, 8) // 3
    value = time / 1000**power
    return f"{value:.{0 if value >= 99.5 else 1 if value >= 9.95 else 2}f} {('ns', 'µs', 'ms')[power]}"


class Results:
    def __init__(self, values: dict[str, Any]) -> None:
        self.values = values
        sections = ("step", "limited", "parts", "loop", "growth", "trees", "ticks", "lanes", "python")
        self.rows: dict[str, Row] = {row["name"]: row for name in sections for row in values.get(name, [])}
        for row in values.get("limited", []):
            part, case = row["name"].split("/", 1)
            if part == "limited":  # Cost of limits in a step.
                least = row["least"] - self.rows[f"unlimited/{case}"]["least"]
                self.rows[f"limits/{case}"] = {"name": f"limits/{case}", "least": least}
        self.tails: list[Row] = values.get("tail", [])
        self.sweeps: list[Row] = values.get("sweeps", [])

    def least(self, name: str) -> float | None:
        """Smallest time of a row [ns]. Noise only increases times."""
        row = self.rows.get(name)
        return row["least"] if row else None

    def ratio(self, name: str, peer: str, library: str = "fpbm_cpp") -> float | None:
        """Ratio of a row's time by a library to the time by a peer."""
        ours, theirs = self.least(f"{name}/{library}"), self.least(f"{name}/{peer}")
        return ours / theirs if ours and theirs else None


def comparison(
    results: Results, part: str, libraries: dict[str, str], rows: list[str] | None = None, kind: str = "scheme"
) -> list[str]:
    """A table of a part: a row for each arm/task/kind, and a column for each library.

    Cells contain the time, and its ratio to the time of fpbm_cpp.
    """
    if rows is None:
        names = (name.split("/") for name in results.rows)
        rows = list(dict.fromkeys("/".join(parts[1:-1]) for parts in names if parts[0] == part and len(parts) > 1))
    present = [library for library in libraries if any(f"{part}/{row}/{library}" in results.rows for row in rows)]

    def cell(row: str, library: str) -> str:
        time, ours = results.least(f"{part}/{row}/{library}"), results.least(f"{part}/{row}/fpbm_cpp")
        if time is None:
            return ""
        if library == "fpbm_cpp" or not ours:
            return nanoseconds(time)
        return f"{nanoseconds(time)} ({time / ours:.{1 if time >= ours else 2}f} ×)"

    lines = ([row.replace("/", ", "), *(cell(row, library) for library in present)] for row in rows)
    return table([f"arm, task, {kind}", *(libraries[library] for library in present)], lines)


def summary(results: Results) -> list[str]:
    """The rows that the project's README shows, with the machine on which they were measured."""
    steps = ["planar4/position/fpbm", "panda/position/fpbm", "panda/pose/fpbm", "panda/pose/wmvn", "panda/pose/mvn"]
    lines = ["A step in C++: kinematics and scheme.", "", *comparison(results, "step", CPLUSPLUS, steps)]
    if results.values.get("limited"):
        rows = ["panda/pose/acceleration", "panda/pose/jerk", "panda/position/acceleration"]
        lines += ["A step with joint limits, in states with active limits.", ""]
        lines += comparison(results, "limited", LIMITED, rows, kind="bounds")
    if results.values.get("python"):
        calls = ["panda/pose/fpbm", "panda/pose/mvn"]
        lines += [
            "A step from Python: one call for each step, or one call for 10,000 steps.",
            "",
            *comparison(results, "python", PYTHON, calls),
        ]
    machine, built_with = results.values["machine"], results.values["built_with"]
    versions = {**built_with, **results.values.get("packages", {})}
    others = ", ".join(f"{name} {v}" for name, v in versions.items() if v and name not in ("compiler", "flags"))
    run = (
        f"{machine['processor']}, {machine['cores']} cores, {machine['system']}; {built_with['compiler']} "
        f"`{built_with['flags']}`; Python {machine['python']}; {others}. "
        f"Load average at the start: {machine['load']}."
    )
    lines += [*textwrap.wrap(run, 120, break_on_hyphens=False), ""]
    if results.values["missing"]:
        lines += [f"Missing here: {', '.join(results.values['missing'])}.", ""]
    return lines


def plain(results: Results, section: str) -> list[str]:
    rows = results.values.get(section, [])
    return table(
        ["row", "least", "median"], ([r["name"], nanoseconds(r["least"]), nanoseconds(r["median"])] for r in rows)
    )


def tails(results: Results) -> list[str]:
    columns = ("p50", "p99", "p99.9", "worst", "empty_p99.9")
    lines = (
        [
            f"{row['name']}, {row['caches']}",
            *(nanoseconds(row[c]) if c in row else "" for c in columns),
            f"{row['calls']:,.0f}",
            str(row["preempted"]),
        ]
        for row in results.tails
    )
    heads = ["job, caches", *columns[:-1], "p99.9 of an empty call of the same duration", "calls", "preempted"]
    return table(heads, lines)


def over_median(results: Results) -> list[str]:
    """Ratio p99.9 / p50 of a job, and of an empty call of the same duration that is timed alternately with the job."""

    def cells(row: Row) -> list[str]:
        job, empty = row["p99.9"] / row["p50"], row["empty_p99.9"] / row["empty_p50"]
        return [row["name"], f"{job:.2f}", f"{empty:.2f}", f"{job / empty:.2f}"]

    where = "an isolated core" if results.values.get("isolated") else "a shared core, which has no requirement"
    return [
        f"p99.9 / p50 in warm caches. On an isolated core, at most 1.5 is required. This run was on {where}.",
        "",
        *table(
            ["job", "p99.9 / p50 of the job", "p99.9 / p50 of an empty call of the same duration", "job / empty call"],
            (cells(row) for row in results.tails if "empty_p50" in row and row["name"] != "timer"),
        ),
    ]


def line(points: list[tuple[int, float]]) -> tuple[float, float]:
    """Slope and offset of a line through points, by least squares of relative distances."""
    weights = [1 / time**2 for _, time in points]
    total = sum(weights)
    n0 = sum(w * n for w, (n, _) in zip(weights, points)) / total
    t0 = sum(w * t for w, (_, t) in zip(weights, points)) / total
    slope = sum(w * (n - n0) * (t - t0) for w, (n, t) in zip(weights, points))
    slope /= sum(w * (n - n0) ** 2 for w, (n, _) in zip(weights, points))
    return slope, t0 - slope * n0


def growth(results: Results) -> list[str]:
    """Times against n, a line through these times, and the relative distance of each time from the line."""
    kinds = {"fixed": "fixed at compile time", "run_time": "given at run time"}
    text = []
    names = [name.rsplit("/", 2)[0] for name in results.rows if name.startswith("growth/") and name.count("/") == 4]
    for name in dict.fromkeys(names):
        columns = []
        text += [name.removeprefix("growth/").replace("/", ", ") + ":", ""]
        for kind, words in kinds.items():
            rows = [row for row in results.rows if row.startswith(f"{name}/{kind}/")]
            points = sorted((int(row.rsplit("/", 1)[1]), results.rows[row]["least"]) for row in rows)
            # At n = 7, a pose leaves one self-motion, which may have separate code: the line excludes this time.
            slope, offset = line([(n, time) for n, time in points if "spatial" not in name or n > 7])
            off = [time / (slope * n + offset) - 1 for n, time in points]
            text.append(
                f"- {words}: {slope:.1f} ns per joint plus {offset:.0f} ns, largest deviation {max(map(abs, off)):.0%}"
            )
            columns += [[nanoseconds(time) for _, time in points], [f"{each:+.0%}" for each in off]]
        heads = [head for words in kinds.values() for head in (words, "off the line")]
        sizes = [str(n) for n, _ in points]
        text += ["", *table(["n", *heads], (list(cells) for cells in zip(sizes, *columns, strict=True)))]
    return text


def instructions(means: dict[str, float], paths: dict[str, list[float]]) -> list[str]:
    """A table of instructions per call: the mean, the median ("usual") and the maximum ("worst")."""

    def cells(name: str) -> list[str]:
        if name not in paths:
            return ["", "", ""]
        usual, worst = paths[name]
        return [f"{usual:.0f}", f"{worst:.0f}", f"{worst / usual:.2f}"]

    lines = ([name, f"{mean:.0f}", *cells(name)] for name, mean in means.items())
    return table(["job", "mean", "usual call", "worst call", "worst / usual"], lines)


def in_lanes(results: Results) -> list[str]:
    """Tables of the time per arm: a single arm, and several arms in SIMD lanes."""
    rows = [row.split("/", 1)[1] for row in results.rows if row.startswith("step/") and row.endswith("/baseline")]
    rows = [row.removesuffix("/baseline") for row in rows]
    kinematics = [row.replace("fpbm", "acceleration") for row in rows]
    return [
        *comparison(results, "step", LANES, rows),
        "Kinematics alone:",
        "",
        *comparison(results, "kinematics", LANES, kinematics),
    ]


def limited(results: Results) -> list[str]:
    """Tables of limited steps of each library: times, the time for the limits, and a comparison of the results."""
    columns = {
        "unsolved": "without an answer",
        "outside": "outside the box",
        "off_line": "off the line",
        "smaller": "smaller s",
        "larger": "larger s",
        "slowed": "unsolvable as an equality",
    }
    scores = []
    for row in results.values["limited"]:
        part, *case, library = row["name"].split("/")
        if part == "limited" and library != "fpbm_cpp":
            counts = (str(row[key]) for key in columns)
            scores.append([f"{', '.join(case)}: {LIMITED[library]}", *counts])
    return [
        "Kinematics, scheme and limits, in random states in which the motion of the scheme exceeds the limits:",
        "",
        *comparison(results, "limited", LIMITED, kind="bounds"),
        "Times of the limits alone: the differences between the times with limits and the times without limits.",
        "",
        *comparison(results, "limits", LIMITED, kind="bounds"),
        "Results for 10,000 problems, compared with this library, which solves all problems. With bounds on jerk, the",
        "task line and s are of the second problem. The last column counts problems without a solution if the whole",
        "task is an equality.",
        "",
        *table(["arm, task, bounds: library", *columns.values()], scores),
    ]


def sweeps(results: Results) -> list[str]:
    """A table with a row for each lanes × threads, with the rate and the ratio of each case."""
    cases = list(dict.fromkeys(row["name"] for row in results.sweeps))
    rates = {(row["lanes"], row["workers"], row["name"]): row for row in results.sweeps}
    lines = []
    for lanes, workers in dict.fromkeys((row["lanes"], row["workers"]) for row in results.sweeps):
        row = [f"{lanes} × {workers}"]
        for case in cases:
            rate = rates[lanes, workers, case]
            row += [f"{rate['per_second'] / 1e6:.2f} M", f"{rate['ratio']:.1f}"]
        lines.append(row)
    heads = [head for case in cases for head in (f"{case.replace('/', ', ')}, arm-steps/s", "ratio")]
    return table(["lanes × threads", *heads], lines)


def page(results: Results) -> str:
    values = results.values
    lines = ["# Benchmark results", ""]
    if values["quick"]:
        lines += ["From a quick run: the numbers are inaccurate.", ""]
    lines += ["Definitions, and limits of the measurements: [bench/README.md](../README.md).", "", *summary(results)]
    lines += [
        "![Steps of each library, tails, growth with n, sweeps](results.png)",
        "",
        "## Promises",
        "",
        *table(["promise", "measured", "required", "kept"], promises.rows(results)),
    ]
    lines += ["## Steps in C++", "", *comparison(results, "step", CPLUSPLUS)]
    lines += ["## Kinematics in C++", "", *comparison(results, "kinematics", CPLUSPLUS)]
    if values.get("limited"):
        lines += ["## Limited steps", "", *limited(results)]
    if values.get("lanes"):
        lines += ["## Steps in lanes", "", "Time per arm, for several arms in SIMD lanes.", "", *in_lanes(results)]
    if "python" in values:
        lines += ["## Steps from Python", "", *comparison(results, "python", PYTHON)]
    lines += [
        "## Tails",
        "",
        "Latency of a call. The times include the time of the timer, which the row `timer` contains.",
        "",
        *tails(results),
        *over_median(results),
    ]
    if "instructions" in values:
        lines += ["## Instructions per call", "", *instructions(values["instructions"], values.get("paths", {}))]
    if "stalls" in values:
        counts = ([name, f"{stalls:.0f}"] for name, stalls in values["stalls"].items())
        lines += ["## Loads that wait for stores, per call", "", *table(["job", "loads"], counts)]
    if "circle" in values:
        rows = (
            [
                r["name"],
                nanoseconds(1e9 * r["median"]),
                nanoseconds(1e9 * r["least"]),
                f"{r['ratio']:.1f}",
                f"{r['error']:.0e}",
            ]
            for r in values["circle"]
        )
        heads = ["10 s circle at 1 kHz, FPBM", "median", "least", "multiple", "error of final qd [rad/s]"]
        lines += ["## Rollout from Python", "", *table(heads, rows)]
    if results.sweeps:
        lines += [
            "## Sweeps",
            "",
            "RK4 steps of 1 ms by `fp.sweep`, four evaluations of FPBM each. Ratios: to one thread without lanes.",
            "",
            *sweeps(results),
        ]
    lines += [
        "## Growth with the number of joints",
        "",
        "FPBM on planar arms (position) and spatial arms (pose). The times are approximated by a line in n.",
        "",
        *growth(results),
    ]
    if values.get("trees"):
        lines += ["## Robots as trees", "", "Kinematics, as ratios to Pinocchio's time in the same run:", ""]
        lines += table(["robot", "fpbm_cpp", "Pinocchio", "ratio"], report_trees.kinematics(results))
    if values.get("ticks"):
        lines += ["Ticks [µs] with active limits, by joints and levels:", ""]
        lines += table(["joints", *(f"levels: {k}" for k in report_trees.LEVELS)], report_trees.ticks(results))
        lines += ["![Ticks by joints and by levels](trees.png)", ""]
    for section, title in (("parts", "Parts of a step, and RK4"), ("loop", "Limits and ticks")):
        if section in values:
            lines += [f"## {title}", "", *plain(results, section)]
    return "\n".join(lines)


def chart(results: Results, file: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    from fpbm_cpp.plot import OKABE_ITO
    from fpbm_cpp.plot.theme import LIGHT

    BLUE, ORANGE, GREEN, _, SKY, VERMILION, BLACK, _ = OKABE_ITO
    figure, ((steps, tail), (size, rate)) = plt.subplots(2, 2, figsize=(12, 9), layout="constrained")

    # Rows from C++ are above rows from Python. The text of each bar is its time.
    colours = {"fpbm_cpp": BLUE, "pinocchio": ORANGE, "kdl": GREEN, "pinocchio_numpy": ORANGE, "robotics_toolbox": SKY}
    drawn = [("C++", f"step/panda/pose/fpbm/{library}", library, CPLUSPLUS[library]) for library in CPLUSPLUS]
    drawn += [("Python", f"python/panda/pose/fpbm/{library}", library, PYTHON[library]) for library in PYTHON]
    drawn = [entry for entry in drawn if entry[1] in results.rows][::-1]
    for place, (language, name, library, _) in enumerate(drawn):
        time = results.rows[name]["least"]
        hatch = "//" if language == "Python" else None
        steps.barh(place, time / 1e3, color=colours.get(library, BLACK), hatch=hatch, edgecolor="white")
        steps.annotate(f" {nanoseconds(time)}", (time / 1e3, place), va="center", fontsize=9)
    steps.set_yticks(range(len(drawn)), [f"{label}, {language}" for language, _, _, label in drawn])
    steps.set_xscale("log")
    steps.set_xlim(0.1, 1000)
    steps.set(xlabel="time of a step [µs]", title="FPBM, a whole Panda pose step")

    styles = zip(LIGHT.styles(), "osD^v<>*P")
    columns = ("p50", "p99", "p99.9", "worst")
    for row, ((colour, dash), marker) in zip((r for r in results.tails if r["caches"] == "warm"), styles):
        label = row["name"].replace("/", " ")
        tail.plot(columns, [row[c] / 1e3 for c in columns], color=colour, ls=dash, marker=marker, label=label)
    tail.set_yscale("log")
    tail.set(ylabel="time of a call [µs]", title="Latency of a call in a warm loop")
    tail.legend(fontsize=8)

    for kind, label, colour, marker in (
        ("fixed", "n fixed at compile time", BLUE, "o"),
        ("run_time", "n given at run time", VERMILION, "s"),
    ):
        start = f"growth/planar/step/{kind}/"
        rows = [(int(name.removeprefix(start)), row) for name, row in results.rows.items() if name.startswith(start)]
        size.plot([n for n, _ in rows], [row["least"] for _, row in rows], color=colour, marker=marker, label=label)
    size.set_ylim(bottom=0)
    size.set(xlabel="joints n", ylabel="time of a step [ns]", title="FPBM, planar arms of n joints")
    size.legend()

    drawn_sweeps = [row for row in results.sweeps if row["name"] == "planar4/position"][::-1]
    for place, row in enumerate(drawn_sweeps):
        rate.barh(place, row["per_second"] / 1e6, color=BLUE if row["workers"] == 1 else SKY, edgecolor="white")
        rate.annotate(f" {row['ratio']:.1f} ×", (row["per_second"] / 1e6, place), va="center", fontsize=9)
    rate.set_yticks(
        range(len(drawn_sweeps)), [f"lanes {row['lanes']}, threads {row['workers']}" for row in drawn_sweeps]
    )
    rate.set(xlabel="million RK4 steps a second", title="Sweeps of the paper's circle")
    rate.margins(x=0.12)
    rate.set_visible(bool(drawn_sweeps))

    for axes in (steps, tail, size, rate):
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(axis="x" if axes in (steps, rate) else "y", alpha=0.3)
        axes.set_axisbelow(True)
    figure.savefig(file, dpi=110)


def write(folder: Path) -> None:
    """Writes the page and, if matplotlib is installed, the chart."""
    results = Results(json.loads((folder / "results.json").read_text()))
    (folder / "results.md").write_text(page(results))
    try:
        chart(results, folder / "results.png")
        if results.values.get("ticks"):
            report_trees.chart(results, folder / "trees.png")
    except ImportError:
        print("No chart: matplotlib is not installed")


def write_readme(folder: Path) -> None:
    """Writes the summary into the README of the project, between BEGIN and END."""
    text = README.read_text()
    before, rest = text.split(BEGIN)
    lines = summary(Results(json.loads((folder / "results.json").read_text())))
    README.write_text(before + BEGIN + "\n".join(lines) + END + rest.split(END)[1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--readme", action="store_true", help="also write the summary into the project's README")
    options = parser.parse_args()
    write(RESULTS)
    if options.readme:
        write_readme(RESULTS)


if __name__ == "__main__":
    main()
