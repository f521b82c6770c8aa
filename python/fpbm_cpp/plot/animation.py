"""Animation of one motion, and its file: .mp4 by ffmpeg, .gif by Pillow, a dependency of matplotlib."""

import os
import shutil
import subprocess
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from numpy.typing import NDArray
from PIL import Image

from .._types import Array
from ..files import write_whole
from ..motion.run import Run
from ..motion.task_errors import tracks
from ..parameter import Parameter
from ..skeleton import joint_points
from .figures import lay_out
from .lines import head_legend
from .panels import LINK, Panel, choose, draw_base, draw_target, frame_arm
from .theme import DARK, LIGHT, TEXT, Theme

Frame = NDArray[np.uint8]
FASTEST_GIF = 50.0  # Frames per second; many programs play faster files too slowly.


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
    """Write an animation of a run: the moving arm, the trail of its tip, and panels with a cursor at the current time.

    The file is an .mp4, which needs ffmpeg or the extra 'animation', or a .gif. An existing file is replaced,
    completely or not at all. fps is frames per second, speed the seconds of the motion per second of the animation, and
    dpi pixels per inch: with 180 and two panels the animation has 1280 × 720 pixels. panels are names from PANELS, for
    panels beside the arm. dark: dark background.

    Raises ValueError if an argument is out of range, the file has another suffix, or the run has no samples;
    ImportError if ffmpeg for an .mp4 is missing; OSError if the file cannot be written.
    """
    for name, value in (("fps", fps), ("speed", speed), ("dpi", dpi)):
        Parameter(name, float, low=0.0, open_low=True).check(value)
    if not len(run.t):
        raise ValueError("run: has no samples: must have at least one: run.status has the cause")
    shown = {**choose(run, panels), "arm": Panel("", _draw_background)}
    times = np.append(np.arange(run.t[0], run.t[-1], speed / fps), run.t[-1])
    samples = np.searchsorted(run.t, times).clip(max=len(run.t) - 1)
    write_frames(Path(file), _frames(run, samples, shown, DARK if dark else LIGHT, dpi), fps)


def _frames(run: Run, samples: Iterable[int], panels: Mapping[str, Panel], theme: Theme, dpi: float) -> Iterator[Frame]:
    """Frames of the samples, shape (height, width, 3); the background is drawn once."""
    figure, drawn = lay_out(run, "", panels, theme, lettered=False)
    figure.set_dpi(dpi)
    canvas: Any = FigureCanvasAgg(figure)
    axes = drawn.pop("arm")
    nowhere = np.full((run.positions.shape[1], 1), np.nan)
    tips = [tip for tip, _ in tracks(run)]
    trails = [axes.plot(*nowhere, color=theme.tip, lw=2.4, animated=True)[0] for _ in tips]
    (arm,) = axes.plot(*nowhere, color=theme.fade(1.0), mec=theme.paper, animated=True, **{**LINK, "lw": 2.6})
    style = {"textcoords": "offset points", "fontsize": TEXT, "fontweight": "bold", "color": theme.ink}
    clock = axes.annotate("", (0.0, 1.0), xycoords="axes fraction", xytext=(0.0, 4.0), animated=True, **style)
    cursors = [panel.axvline(run.t[0], color=theme.ink, lw=0.9, animated=True) for panel in drawn.values()]
    canvas.draw()
    background = canvas.copy_from_bbox(figure.bbox)
    for sample in samples:
        canvas.restore_region(background)
        for trail, tip in zip(trails, tips):
            _set_points(trail, tip[: sample + 1])
        _set_points(arm, joint_points(run.arm, run.q[sample]))
        clock.set_text(f"t = {run.t[sample]:.2f} s")
        for cursor in cursors:
            cursor.set_xdata([run.t[sample]])
        for artist in (*trails, arm, clock, *cursors):
            artist.axes.draw_artist(artist)
        yield np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _set_points(line: Any, points: Array) -> None:
    (line.set_data if points.shape[1] == 2 else line.set_data_3d)(*points.T)


def _draw_background(axes: Any, run: Run, theme: Theme) -> None:
    """Draw the background: base, target and first posture, with space for all other postures."""
    postures = np.unique(np.linspace(0, len(run.t) - 1, 200).astype(int))
    axes.plot(*np.concatenate(joint_points(run.arm, run.q[postures])).T, alpha=0.0)
    axes.plot(*joint_points(run.arm, run.q[0]).T, color=theme.fade(0.0), mec=theme.paper, **LINK)
    draw_base(axes, run.arm, run.q[0], theme)
    target = draw_target(axes, run, theme)
    frame_arm(axes, theme)
    (trail,) = axes.plot(*run.positions[:0].T, color=theme.tip, lw=2.4, label="tip")
    head_legend(axes, theme, [trail, target[0]])


def write_frames(file: Path, frames: Iterable[Frame], fps: float) -> None:
    """Write frames of one shape (height, width, 3) to a file, completely or not at all. Checks the file name first."""
    suffix = file.suffix.lower()
    if suffix not in (".mp4", ".gif"):
        raise ValueError(f"file = {str(file)!r}: must end in .mp4 or .gif")
    if suffix == ".gif" and fps > FASTEST_GIF:
        raise ValueError(f"fps = {fps:g}: must be at most {FASTEST_GIF:g} in a .gif")
    if not file.parent.is_dir():
        raise FileNotFoundError(f"file = {str(file)!r}: there is no folder {str(file.parent)!r}: make the folder first")
    ffmpeg = _ffmpeg() if suffix == ".mp4" else ""
    rest = iter(frames)
    first = next(rest)
    with TemporaryDirectory() as folder:
        part = Path(folder, "animation" + suffix)
        if ffmpeg:
            _write_mp4(part, first, chain([first], rest), fps, ffmpeg)
        else:
            _write_gif(part, first, chain([first], rest), fps)
        write_whole(file, part.read_bytes())


def _ffmpeg() -> str:
    if found := shutil.which("ffmpeg"):
        return found
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        return str(get_ffmpeg_exe())
    except (ModuleNotFoundError, RuntimeError) as missing:
        raise ImportError('a .mp4 needs ffmpeg: pip install "fpbm_cpp[animation]", or write a .gif') from missing


def _write_mp4(file: Path, first: Frame, frames: Iterable[Frame], fps: float, ffmpeg: str) -> None:
    height, width = (side // 2 * 2 for side in first.shape[:2])  # yuv420p stores one colour for 2 × 2 pixels.
    source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", f"{fps:g}", "-i", "-"]
    command = [ffmpeg, "-loglevel", "error", *source, "-pix_fmt", "yuv420p", "-movflags", "+faststart", str(file)]
    with TemporaryFile() as errors:
        with suppress(BrokenPipeError), subprocess.Popen(command, stdin=subprocess.PIPE, stderr=errors) as process:
            assert process.stdin is not None
            for frame in frames:
                process.stdin.write(frame[:height, :width].tobytes())
        if process.returncode:
            errors.seek(0)
            raise OSError(f"ffmpeg: {errors.read().decode(errors='replace').strip()}")


def _write_gif(file: Path, first: Frame, frames: Iterable[Frame], fps: float) -> None:
    colours = Image.fromarray(first).quantize(kmeans=1)  # One palette, so that the background is stored once.
    images = [Image.fromarray(frame).quantize(palette=colours, dither=Image.Dither.NONE) for frame in frames]
    ends = np.round(np.arange(len(images) + 1) * 100.0 / fps)
    durations = (10 * np.diff(ends)).astype(int).tolist()  # [ms]; a .gif counts in steps of 10 ms.
    images[0].save(file, save_all=True, append_images=images[1:], duration=durations, loop=0)
