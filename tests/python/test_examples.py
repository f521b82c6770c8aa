"""Every Python example runs unchanged and has a counterpart in C++."""

from __future__ import annotations

import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("[0-9][0-9]_*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example(example: Path, tmp_path: Path) -> None:
    if "plot" in example.read_text():
        pytest.importorskip("matplotlib")
    if "mujoco" in example.read_text():
        pytest.importorskip("mujoco")
    if "example-robot-data" in example.read_text() and not list(metadata.distributions(name="example-robot-data")):
        pytest.skip("needs example-robot-data")
    if "franka" in example.stem:
        pytest.importorskip("pylibfranka", exc_type=ImportError)
        pytest.importorskip("franky_sim", exc_type=ImportError)
    if "tune" in example.stem:
        pytest.importorskip("cmaes")
    command = [sys.executable, str(example)]
    result = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=120)
    assert result.returncode == 0, result.stderr
    assert result.stdout
    for picture in tmp_path.iterdir():
        assert picture.read_bytes().startswith(b"\x89PNG")
    assert any(tmp_path.iterdir()) == ("savefig" in example.read_text())


def test_pairs() -> None:
    assert len(EXAMPLES) >= 5
    alone = {
        "08_mujoco_panda",
        "10_tune",
        "11_franka",
        "19_mujoco_tray",
    }  # Simulators and an optimiser, driven from Python.
    assert all(path.with_suffix(".cpp").exists() for path in EXAMPLES if path.stem not in alone)
