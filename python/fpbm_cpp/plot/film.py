"""Pictures into a film: .mp4 by ffmpeg, .gif by Pillow, which comes with matplotlib."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Iterable
from contextlib import suppress
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

from .._files import write_whole

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Pictures = Iterable[NDArray[np.uint8]]

FASTEST_GIF = 50.0  # Frames per second: viewers slow down what is faster.


def film_writer(file: Path, fps: float) -> Callable[[Pictures], None]:
    """What writes pictures, all of one shape (height, width, 3), to a file: whole, or not at all.

    Raises, before anything is drawn, ValueError where its suffix is no film's, OSError where there is no such folder,
    and ImportError where ffmpeg is missing.
    """
    suffix = file.suffix.lower()
    if suffix not in (".mp4", ".gif"):
        raise ValueError(f"file = {str(file)!r}: must end in .mp4 or .gif")
    if suffix == ".gif" and fps > FASTEST_GIF:
        raise ValueError(f"fps = {fps:g}: must be at most {FASTEST_GIF:g} in a .gif")
    if not file.parent.is_dir():
        raise FileNotFoundError(f"file = {str(file)!r}: there is no folder {str(file.parent)!r}")
    ffmpeg = _ffmpeg() if suffix == ".mp4" else ""

    def write(pictures: Pictures) -> None:
        with TemporaryDirectory() as folder:
            film = Path(folder, "film" + suffix)
            if ffmpeg:
                _write_mp4(film, pictures, fps, ffmpeg)
            else:
                _write_gif(film, pictures, fps)
            write_whole(file, film.read_bytes())

    return write


def _ffmpeg() -> str:
    """The machine's ffmpeg, or the one that imageio-ffmpeg brings."""
    found = shutil.which("ffmpeg")
    if found:
        return found
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        return str(get_ffmpeg_exe())
    except (ModuleNotFoundError, RuntimeError) as missing:
        raise ImportError('a .mp4 needs ffmpeg: pip install "fpbm_cpp[film]", or write a .gif') from missing


def _write_mp4(film: Path, pictures: Pictures, fps: float, ffmpeg: str) -> None:
    first, pictures = _peeked(pictures)
    height, width = (side // 2 * 2 for side in first.shape[:2])  # One colour is stored for 2 by 2 pixels.
    source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", f"{fps:g}", "-i", "-"]
    result = ["-pix_fmt", "yuv420p", "-movflags", "+faststart", str(film)]
    with TemporaryFile() as said:
        command = [ffmpeg, "-loglevel", "error", *source, *result]
        with suppress(BrokenPipeError), subprocess.Popen(command, stdin=subprocess.PIPE, stderr=said) as process:
            assert process.stdin is not None
            for picture in pictures:
                process.stdin.write(picture[:height, :width].tobytes())
        if process.returncode:
            said.seek(0)
            raise OSError(f"ffmpeg: {said.read().decode(errors='replace').strip()}")


def _write_gif(film: Path, pictures: Pictures, fps: float) -> None:
    first, pictures = _peeked(pictures)
    colours = Image.fromarray(first).quantize(kmeans=1)  # For all pictures, so that what stands still is stored once.
    images = [Image.fromarray(picture).quantize(palette=colours, dither=Image.Dither.NONE) for picture in pictures]
    ends = np.round(np.arange(len(images) + 1) * 100.0 / fps)
    durations = (10 * np.diff(ends)).astype(int).tolist()  # [ms], as a .gif counts: in tens.
    images[0].save(film, save_all=True, append_images=images[1:], duration=durations, loop=0)


def _peeked(pictures: Pictures) -> tuple[NDArray[np.uint8], Pictures]:
    """The first picture, and all of them."""
    rest = iter(pictures)
    first = next(rest)
    return first, chain([first], rest)
