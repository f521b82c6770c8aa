"""Figures of the scenes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from compare import GAINS, SATURATE, Case, Outcome, tracker_row
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from panda_problems import PUBLISHED, SECONDS, Row
from pointing import DT, Scene

SHOWN = {tracker_row(GAINS[0]): "#D55E00", tracker_row(GAINS[-1]): "#0072B2", SATURATE: "#444444"}
LABELS = dict(
    zip(SHOWN, ("Tracker, k₁ = 1/T", f"Tracker, k₁ = {GAINS[-1]:.0f}/s", "fp.saturate, scale of SNS"), strict=True)
)
Axis2D = NDArray[Any]
COLOURS = ("#D55E00", "#0072B2", "#444444")


def draw_planar(file: Path, scene: Scene, cases: Sequence[Case], found: Sequence[Outcome]) -> None:
    figure, axes = _grid(len(cases), (2.7 * len(cases), 8.2), (2, 1, 1))
    for column, case in enumerate(cases):
        for each in _shown(case, found):
            tip = scene.origins(each.motion.q[::10])[:, -1]
            axes[0, column].plot(tip[:, 0], tip[:, 1], color=SHOWN[each.row], label=LABELS[each.row], lw=1)
            _against_time(axes[1:, column], each)
        axes[0, column].plot(scene.vertices[:, 0], scene.vertices[:, 1], ":", color="black", lw=1, zorder=5)
        axes[0, column].set(title=case.name, aspect="equal", xlabel="x [m]", xticks=[0.5, 0.6, 0.7, 0.8, 0.9])
    axes[0, 0].set_ylabel("tip: y [m]")
    _finish(figure, axes, file)


def draw_segment(file: Path, scene: Scene, cases: Sequence[Case], found: Sequence[Outcome]) -> None:
    figure, axes = _grid(len(cases), (4.6 * len(cases), 7.2), (1, 1, 1))
    for column, case in enumerate(cases):
        for each in _shown(case, found):
            time = np.arange(len(each.motion.scales)) * DT
            off_line = 1e3 * each.measures.off_line
            axes[0, column].plot(time, off_line, color=SHOWN[each.row], label=LABELS[each.row], lw=1)
            _against_time(axes[1:, column], each)
        axes[0, column].set(title=case.name, xlabel="time [s]")
    axes[0, 0].set_ylabel("tip off the line [mm]")
    _finish(figure, axes, file)


def draw_panda(file: Path, rows: Sequence[Row]) -> None:
    figure, axis = plt.subplots(figsize=(7, 3.6), layout="constrained")
    names = ("Tracker, velocity level", "Tracker, acceleration level", "OpenSoT's law by SciPy")
    for row, name, colour in zip(rows, names, COLOURS, strict=True):
        times = np.sort(row.times)
        share = 100 * np.arange(1, len(times) + 1) / len(row.solved)
        axis.step(np.r_[times, SECONDS], np.r_[share, share[-1]], where="post", color=colour, label=name)
    published = [100 * successes / runs for successes, runs, _ in PUBLISHED.values()]
    axis.axhspan(min(published), max(published), color="#E9B44C", alpha=0.35, lw=0, label="published, nine solvers")
    axis.set(xlabel="time [s]", ylabel="problems solved [%]", xlim=(0, SECONDS), ylim=(0, 100))
    axis.legend(frameon=False, loc="lower right")
    _plain(axis)
    figure.savefig(file, dpi=100)
    plt.close(figure)


def _shown(case: Case, found: Sequence[Outcome]) -> list[Outcome]:
    return [each for each in found if each.case == case.name and each.row in SHOWN]


def _grid(columns: int, size: tuple[float, float], heights: Sequence[float]) -> tuple[Figure, Axis2D]:
    return plt.subplots(
        len(heights), columns, figsize=size, layout="constrained", sharey="row", squeeze=False, height_ratios=heights
    )


def _against_time(axes: Axis2D, each: Outcome) -> None:
    """Directional error, and the scale of the first level."""
    time = np.arange(len(each.motion.scales)) * DT
    axes[0].plot(time, each.measures.direction, color=SHOWN[each.row], lw=1)
    axes[1].plot(time, np.maximum(each.motion.scales[:, 0], 1e-4), color=SHOWN[each.row], lw=1)
    axes[1].set(xlabel="time [s]", yscale="log", ylim=(9e-5, 1.5))
    axes[1].sharex(axes[0])


def _finish(figure: Figure, axes: Axis2D, file: Path) -> None:
    axes[1, 0].set_ylabel("directional error [rad]")
    axes[2, 0].set_ylabel("scale of the first level")
    for axis in axes.flat:
        _plain(axis)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), frameon=False)
    figure.savefig(file, dpi=80)
    plt.close(figure)


def _plain(axis: Axes) -> None:
    axis.spines[["top", "right"]].set_visible(False)
    axis.grid(alpha=0.3)
