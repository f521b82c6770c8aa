"""Animations: their length, their moving parts, and that they are written whole or not at all."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from matplotlib.colors import to_rgb
from PIL import Image
from plot_runs import a_run, a_run_in_space, a_run_within_limits

import fpbm_cpp as fp
from fpbm_cpp.plot import animate, animation
from fpbm_cpp.plot.theme import LIGHT

SMALL: dict[str, Any] = {"dpi": 60}


def pictures(file: Path) -> list[np.ndarray]:
    with Image.open(file) as gif:
        return [(gif.seek(i), np.asarray(gif.convert("RGB")).astype(int))[1] for i in range(gif.n_frames)]


def seconds(file: Path) -> float:
    with Image.open(file) as gif:
        return sum((gif.seek(i), gif.info["duration"])[1] for i in range(gif.n_frames)) / 1000


@pytest.mark.parametrize("run", [a_run, a_run_in_space], ids=lambda run: run.__name__)
def test_gif_moves_in_all_its_panels(run: Any, tmp_path: Path) -> None:
    animate(run(), tmp_path / "a.gif", fps=10, speed=2.0, **SMALL)
    first, *_, last = shown = pictures(tmp_path / "a.gif")
    assert len(shown) == 11  # 2 s at twice the speed, and the last sample.
    assert seconds(tmp_path / "a.gif") == pytest.approx(1.1)
    height, width, _ = first.shape
    assert (width, height) == (426, 240)
    changed = np.abs(last - first).max(axis=2) > 60
    for part in (changed[:, : width // 2], changed[: height // 2, width // 2 :], changed[height // 2 :, width // 2 :]):
        assert part.any()
    tip = np.array(to_rgb(LIGHT.tip)) * 255
    trails = [np.sum(np.abs(picture[:, : width // 2] - tip).max(axis=2) < 60) for picture in shown]
    assert trails[-1] > 2 * trails[0]


def test_duration_of_a_gif(tmp_path: Path) -> None:
    animate(a_run(), tmp_path / "a.gif", fps=30, speed=4.0, panels=["error"], **SMALL)
    assert seconds(tmp_path / "a.gif") == pytest.approx(16 / 30, abs=0.01)


def test_panels_and_dark(tmp_path: Path) -> None:
    run = a_run_within_limits()
    animate(run, tmp_path / "a.gif", fps=2, speed=2.0, panels=["scale", "saturation"], dark=True, **SMALL)
    assert pictures(tmp_path / "a.gif")[0][0, 0].max() < 40


def test_mp4(tmp_path: Path) -> None:
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
    animate(a_run(), tmp_path / "a.MP4", fps=10, speed=4.0, dpi=61)
    count, duration = imageio_ffmpeg.count_frames_and_secs(str(tmp_path / "a.MP4"))
    assert count == 6
    assert duration == pytest.approx(0.6)
    assert [file.name for file in tmp_path.iterdir()] == ["a.MP4"]


@pytest.mark.parametrize(
    ("file", "options", "message"),
    [
        ("a.avi", {}, r"file = '.*a.avi': must end in .mp4 or .gif"),
        ("a", {}, "must end in .mp4 or .gif"),
        ("a.gif", {"fps": 0}, "fps = 0: must be positive and finite"),
        ("a.gif", {"fps": 60}, "fps = 60: must be at most 50 in a .gif"),
        ("a.gif", {"speed": -1.0}, "speed = -1: must be positive"),
        ("a.gif", {"dpi": np.nan}, "dpi = nan: must be positive"),
        ("a.gif", {"panels": ["velocity"]}, "panels: 'velocity' must be one of"),
    ],
)
def test_invalid_arguments_are_rejected(file: str, options: dict[str, Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=message):
        animate(a_run(), tmp_path / file, **options)
    assert not list(tmp_path.iterdir())


def test_no_samples(tmp_path: Path) -> None:
    run = fp.simulate(fp.PlanarArm([1, 1]), fp.Line([1, 0], 1.0), fp.MAN(), [0, 0], dt=0.01, partial=True)
    with pytest.raises(ValueError, match="run: has no samples"):
        animate(run, tmp_path / "a.gif")


def test_no_such_folder(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="there is no folder"):
        animate(a_run(), tmp_path / "none" / "a.gif")


def test_missing_ffmpeg(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    message = r'^a .mp4 needs ffmpeg: pip install "fpbm_cpp\[animation\]", or write a .gif$'
    with pytest.raises(ImportError, match=message):
        animate(a_run(), tmp_path / "a.mp4")


@pytest.mark.parametrize("suffix", [".gif", ".mp4"])
def test_the_old_file_stays_if_writing_fails(suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(animation, "_ffmpeg", lambda: shutil.which("cat"))
    file = tmp_path / f"a{suffix}"
    file.write_text("old")

    def broken() -> Any:
        yield np.zeros((2, 2, 3), np.uint8)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        animation.write_frames(file, broken(), 25.0)
    assert file.read_text() == "old"
    assert [file.name for file in tmp_path.iterdir()] == [file.name]


def test_errors_of_ffmpeg_are_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(animation, "_ffmpeg", lambda: shutil.which("cat"))
    with pytest.raises(OSError, match=r"^ffmpeg: .*cat: "):
        animation.write_frames(tmp_path / "a.mp4", np.zeros((3, 2, 2, 3), np.uint8), 25.0)
    assert not list(tmp_path.iterdir())
