"""Report on robots with several branches: kinematics compared with Pinocchio, and ticks by joints and levels."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from report import Results

ROBOTS = {"two_pandas": "two Pandas, 14 joints", "g1_upper_body": "G1's upper body, 17 joints"}
PARTS = {"J": "J of two frames", "J_and_Jd": "J and J̇", "J_and_Jd_qd": "J and J̇q̇"}
JOINTS = (7, 14, 17, 24)
LEVELS = (1, 2, 3, 4)


def kinematics(results: Results) -> list[list[str]]:
    """A row for each robot and part: the time of this library, the time of Pinocchio, and the ratio."""
    lines = []
    for robot, words in ROBOTS.items():
        for part, meaning in PARTS.items():
            row = f"trees/{robot}/{part}"
            times = [results.least(f"{row}/{library}") for library in ("fpbm_cpp", "pinocchio")]
            ratio = results.ratio(row, "pinocchio")
            shown = [f"{time:.0f} ns" if time else "" for time in times]
            lines.append([f"{words}: {meaning}", *shown, f"{ratio:.2f}" if ratio else ""])
    return lines


def ticks(results: Results) -> list[list[str]]:
    """A row for each number of joints, with a time for each number of levels [µs]."""
    lines = []
    for joints in JOINTS:
        times = [results.least(f"ticks/{joints}/{levels}/limited") for levels in LEVELS]
        lines.append([str(joints), *(f"{time / 1e3:.1f}" if time else "" for time in times)])
    return lines


def chart(results: Results, file: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    from fpbm_cpp.plot import OKABE_ITO

    figure, (by_joints, by_levels) = plt.subplots(1, 2, figsize=(10, 4), sharey=True, layout="constrained")
    for axes, lines, over, label, unit in (
        (by_joints, LEVELS, JOINTS, "joints", "levels"),
        (by_levels, JOINTS, LEVELS, "levels", "joints"),
    ):
        for line, marker, colour in zip(lines, "osD^", OKABE_ITO):
            pairs = [(n, line) if label == "joints" else (line, n) for n in over]
            times = [results.least(f"ticks/{joints}/{levels}/limited") for joints, levels in pairs]
            drawn = [(n, time / 1e3) for n, time in zip(over, times) if time]
            axes.plot(*zip(*drawn), color=colour, marker=marker, label=f"{line} {unit if line > 1 else unit[:-1]}")
        axes.set(xlabel=label, ylim=(0, None), xticks=over)
        axes.legend(fontsize=8)
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(axis="y", alpha=0.3)
    by_joints.set_ylabel("time of a tick, limits active [µs]")
    figure.savefig(file, dpi=110)
