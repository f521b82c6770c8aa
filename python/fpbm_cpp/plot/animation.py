"""Animation of one motion: the arm and the trail of its tip, beside panels with a time cursor."""

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from numpy.typing import NDArray

from .._types import Array
from ..motion.run import Run
from ..parameter import Parameter
from ..skeleton import joint_points
from .animation_file import animation_writer
from .arm import LINK, draw_base, draw_target, frame_arm
from .legends import head_legend
from .panels import PANELS, Panel, choose
from .run_figure import lay_out
from .theme import TEXT, Theme, theme_of


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
    """Write an animation of a run: the moving arm, the trail of its tip, and panels with a cursor at that time.

    Parameters
    ----------
    run : Run
        The motion.
    file : path
        The file, replaced if it exists: .mp4, which needs ffmpeg or the extra 'animation', or .gif. It is written
        whole or not at all.
    fps : float
        Frames per second.
    speed : float
        Seconds of the motion in a second of the animation.
    panels : sequence of str
        Names from PANELS, shown beside the arm.
    dark : bool
        Dark background.
    dpi : float
        Pixels per inch; with 180 and two panels the animation has 1280 × 720 pixels.

    Raises
    ------
    ValueError
        If an argument is out of range, the file has another suffix, or the run has no samples.
    ImportError
        If the file is .mp4 and there is no ffmpeg.
    OSError
        If the file cannot be written.
    """
    for name, value in (("fps", fps), ("speed", speed), ("dpi", dpi)):
        Parameter(name, float, low=0.0, open_low=True).check(value)
    if not len(run.t):
        raise ValueError("run: has no samples to animate")
    shown = {name: PANELS[name] for name in choose(run, panels) if name != "arm"}
    write = animation_writer(Path(file), fps)
    times = np.append(np.arange(run.t[0], run.t[-1], speed / fps), run.t[-1])
    samples = np.searchsorted(run.t, times).clip(max=len(run.t) - 1)
    write(_frames(run, samples, {"arm": Panel("", _draw_background), **shown}, theme_of(dark), dpi))


def _frames(
    run: Run, samples: Iterable[int], panels: Mapping[str, Panel], theme: Theme, dpi: float
) -> Iterator[NDArray[np.uint8]]:
    """Frames of the samples, shape (height, width, 3); what does not move is drawn once."""
    figure, drawn = lay_out(run, "", panels, theme, lettered=False)
    figure.set_dpi(dpi)
    canvas: Any = FigureCanvasAgg(figure)
    moving = _MovingParts(run, drawn, theme)
    canvas.draw()
    background = canvas.copy_from_bbox(figure.bbox)
    for sample in samples:
        canvas.restore_region(background)
        moving.draw(sample)
        yield np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _draw_background(axes: Any, run: Run, theme: Theme) -> None:
    """Draw what does not move: base, target and first posture, with room for all other postures."""
    postures = np.unique(np.linspace(0, len(run.t) - 1, 200).astype(int))
    axes.plot(*np.concatenate(joint_points(run.arm, run.q[postures])).T, alpha=0.0)
    axes.plot(*joint_points(run.arm, run.q[0]).T, color=theme.fade(0.0), mec=theme.paper, **LINK)
    draw_base(axes, run.arm, run.q[0], theme)
    target = draw_target(axes, run, theme)
    frame_arm(axes, theme)
    (trail,) = axes.plot(*run.positions[:0].T, color=theme.tip, lw=2.4, label="tip")
    head_legend(axes, theme, [trail, *target])


class _MovingParts:
    """What is drawn anew in each frame: trail, arm, time and cursors."""

    def __init__(self, run: Run, drawn: Mapping[str, Any], theme: Theme) -> None:
        axes = drawn["arm"]
        style = {"textcoords": "offset points", "fontsize": TEXT, "fontweight": "bold", "color": theme.ink}
        nowhere = np.full((run.positions.shape[1], 1), np.nan)
        self.run = run
        (self.trail,) = axes.plot(*nowhere, color=theme.tip, lw=2.4, animated=True)
        (self.arm,) = axes.plot(*nowhere, color=theme.fade(1.0), mec=theme.paper, animated=True, **{**LINK, "lw": 2.6})
        self.clock = axes.annotate("", (0.0, 1.0), xycoords="axes fraction", xytext=(0.0, 4.0), animated=True, **style)
        panels = [other for other in drawn.values() if other is not axes]
        self.cursors = [panel.axvline(run.t[0], color=theme.ink, lw=0.9, animated=True) for panel in panels]

    def draw(self, sample: int) -> None:
        run = self.run
        _set_points(self.trail, run.positions[: sample + 1])
        _set_points(self.arm, joint_points(run.arm, run.q[sample]))
        self.clock.set_text(f"t = {run.t[sample]:.2f} s")
        for cursor in self.cursors:
            cursor.set_xdata([run.t[sample]])
        for artist in (self.trail, self.arm, self.clock, *self.cursors):
            artist.axes.draw_artist(artist)


def _set_points(line: Any, points: Array) -> None:
    """Move a line in the plane or in space."""
    (line.set_data if points.shape[1] == 2 else line.set_data_3d)(*points.T)
