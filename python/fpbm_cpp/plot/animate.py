"""Film of one motion: the arm and the trail of its tip, beside panels over time with a cursor."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg

from ..skeleton import joint_points
from .arm import LINK, draw_base, draw_target, frame_arm
from .compose import lay_out
from .film import film_writer
from .legends import head_legend
from .panels import PANELS, Panel, choose
from .theme import TEXT, Theme, theme_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .._types import Array
    from ..run import Run


def animate(
    run: Run,
    file: str | os.PathLike[str],
    *,
    fps: float = 25.0,
    speed: float = 1.0,
    panels: Sequence[str] = ("error", "velocities"),
    dark: bool = False,
    dpi: float = 180.0,
) -> None:
    """Write a film of a run: the arm in motion, what its tip has drawn, and panels with a cursor at that time.

    Parameters
    ----------
    run : Run
        The motion.
    file : path
        Where to, replaced if it exists: .mp4, which needs ffmpeg or the extra 'film', or .gif. Written whole or not
        at all.
    fps : float
        Frames per second.
    speed : float
        Seconds of the motion in a second of the film.
    panels : sequence of str
        Names from PANELS, of what is shown beside the arm.
    dark : bool
        On black instead of white.
    dpi : float
        Pixels per inch; 180 makes 1280 by 720 of two panels beside the arm.

    Raises
    ------
    ValueError
        Where an argument is out of range, the suffix is another, or the run has no sample.
    ImportError
        Where a .mp4 is asked for and there is no ffmpeg.
    OSError
        Where the file cannot be written.
    """
    for name, value in (("fps", fps), ("speed", speed), ("dpi", dpi)):
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"{name} = {value}: must be positive and finite")
    if not len(run.t):
        raise ValueError("run: has no samples to animate")
    shown = {name: PANELS[name] for name in choose(run, panels) if name != "arm"}
    write = film_writer(Path(file), fps)
    times = np.append(np.arange(run.t[0], run.t[-1], speed / fps), run.t[-1])
    samples = np.searchsorted(run.t, times).clip(max=len(run.t) - 1)
    write(_pictures(run, samples, {"arm": STAGE, **shown}, theme_of(dark), dpi))


def _pictures(
    run: Run, samples: Iterable[int], panels: Mapping[str, Panel], theme: Theme, dpi: float
) -> Iterator[NDArray[np.uint8]]:
    """Pictures of the samples, of shape (height, width, 3); what stands still is drawn once."""
    figure, drawn = lay_out(run, "", panels, theme, lettered=False)
    figure.set_dpi(dpi)
    canvas: Any = FigureCanvasAgg(figure)
    moving = _Moving(run, drawn, theme)
    canvas.draw()
    still = canvas.copy_from_bbox(figure.bbox)
    for sample in samples:
        canvas.restore_region(still)
        moving.draw(sample)
        yield np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _draw_stage(axes: Any, run: Run, theme: Theme) -> None:
    """What stands still: the base, the target, the first posture, and room for all others."""
    postures = np.unique(np.linspace(0, len(run.t) - 1, 200).astype(int))
    axes.plot(*np.concatenate(joint_points(run.arm, run.q[postures])).T, alpha=0.0)
    axes.plot(*joint_points(run.arm, run.q[0]).T, color=theme.fade(0.0), mec=theme.paper, **LINK)
    draw_base(axes, run.arm, run.q[0], theme)
    target = draw_target(axes, run, theme)
    frame_arm(axes, theme)
    (trail,) = axes.plot(*run.positions[:0].T, color=theme.tip, lw=2.4, label="tip")
    head_legend(axes, theme, [trail, *target])


STAGE = Panel("", _draw_stage)


class _Moving:
    """What is drawn afresh in each picture: trail, arm, time and cursors."""

    def __init__(self, run: Run, drawn: Mapping[str, Any], theme: Theme) -> None:
        stage = drawn["arm"]
        style = {"textcoords": "offset points", "fontsize": TEXT, "fontweight": "bold", "color": theme.ink}
        nowhere = np.full((run.positions.shape[1], 1), np.nan)
        self.run = run
        (self.trail,) = stage.plot(*nowhere, color=theme.tip, lw=2.4, animated=True)
        (self.arm,) = stage.plot(*nowhere, color=theme.fade(1.0), mec=theme.paper, animated=True, **{**LINK, "lw": 2.6})
        self.clock = stage.annotate("", (0.0, 1.0), xycoords="axes fraction", xytext=(0.0, 4.0), animated=True, **style)
        panels = [axes for name, axes in drawn.items() if name != "arm"]
        self.cursors = [axes.axvline(run.t[0], color=theme.ink, lw=0.9, animated=True) for axes in panels]

    def draw(self, sample: int) -> None:
        run = self.run
        _place(self.trail, run.positions[: sample + 1])
        _place(self.arm, joint_points(run.arm, run.q[sample]))
        self.clock.set_text(f"t = {run.t[sample]:.2f} s")
        for cursor in self.cursors:
            cursor.set_xdata([run.t[sample]])
        for artist in (self.trail, self.arm, self.clock, *self.cursors):
            artist.axes.draw_artist(artist)


def _place(line: Any, points: Array) -> None:
    """Move a line in the plane or in space."""
    (line.set_data if points.shape[1] == 2 else line.set_data_3d)(*points.T)
