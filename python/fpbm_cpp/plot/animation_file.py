"""Frames into a file: .mp4 by ffmpeg, .gif by Pillow, which comes with matplotlib."""

import shutil
import subprocess
from collections.abc import Callable, Iterable
from contextlib import suppress
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ..io.write_whole import write_whole

Frame = NDArray[np.uint8]
FASTEST_GIF = 50.0  # Frames per second; many programs play faster files slowly.


def animation_writer(file: Path, fps: float) -> Callable[[Iterable[Frame]], None]:
    """A function that writes frames, all of one shape (height, width, 3), to a file: whole, or not at all.

    Raises at once, before anything is drawn: ValueError for another suffix than .mp4 and .gif, OSError if the folder
    does not exist, ImportError if ffmpeg is missing.
    """
    suffix = file.suffix.lower()
    if suffix not in (".mp4", ".gif"):
        raise ValueError(f"file = {str(file)!r}: must end in .mp4 or .gif")
    if suffix == ".gif" and fps > FASTEST_GIF:
        raise ValueError(f"fps = {fps:g}: must be at most {FASTEST_GIF:g} in a .gif")
    if not file.parent.is_dir():
        raise FileNotFoundError(f"file = {str(file)!r}: there is no folder {str(file.parent)!r}")
    ffmpeg = _ffmpeg() if suffix == ".mp4" else ""

    def write(frames: Iterable[Frame]) -> None:
        rest = iter(frames)
        first = next(rest)
        with TemporaryDirectory() as folder:
            part = Path(folder, "animation" + suffix)
            if ffmpeg:
                _write_mp4(part, first, chain([first], rest), fps, ffmpeg)
            else:
                _write_gif(part, first, chain([first], rest), fps)
            write_whole(file, part.read_bytes())

    return write


def _ffmpeg() -> str:
    """The machine's ffmpeg, or imageio-ffmpeg's."""
    found = shutil.which("ffmpeg")
    if found:
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
    colours = Image.fromarray(first).quantize(kmeans=1)  # One palette, so that what does not move is stored once.
    images = [Image.fromarray(frame).quantize(palette=colours, dither=Image.Dither.NONE) for frame in frames]
    ends = np.round(np.arange(len(images) + 1) * 100.0 / fps)
    durations = (10 * np.diff(ends)).astype(int).tolist()  # [ms]; a .gif counts in steps of 10 ms.
    images[0].save(file, save_all=True, append_images=images[1:], duration=durations, loop=0)
