"""Programs of docs/coming_from.md, for other libraries and for this library. `make peers` installs and runs the
programs.

Each program runs in its own virtual environment in the folder FPBM_PEERS, because the requirements of the libraries
conflict. PyKDL is from Debian. Without FPBM_PEERS, all tests are skipped.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fpbm_cpp as fp

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "coming_from.md").read_text()
sys.path.insert(0, str(ROOT / "bench"))
from stack_solvers import mjcf, panda, urdf  # noqa: E402

PACKAGES = {
    "Pink": ["pin-pink", "daqp"],
    "Mink": ["mink", "daqp"],
    "PlaCo": ["placo"],
    "TSID": ["tsid"],
    "KDL": [],
}
PATH_PACKAGES = {"TOPP-RA": ["toppra"], "Ruckig": ["ruckig", "numpy"]}
Q0 = np.array([0, -0.3, 0, -2.2, 0, 2, 0.785])
MOVE = np.array([0.06, 0.08, 0])
END = """
import json
print(json.dumps(np.asarray(q).tolist()))
"""


def programs(section: str) -> list[str]:
    """Python blocks of a section of the page; blocks before the first section are for this library."""
    parts = re.split(r"^## (.+)$", PAGE, flags=re.MULTILINE)
    text = dict(zip(parts[1::2], parts[2::2]))[section] if section else parts[0]
    return re.findall(r"^```python\n(.+?)^```", text, flags=re.MULTILINE | re.DOTALL)


def run(python: Path | str, folder: Path, program: str) -> Any:
    (folder / "program.py").write_text(program + END)
    call = subprocess.run(
        [python, "program.py"],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert call.returncode == 0, call.stderr
    return np.array(json.loads(call.stdout.strip().split("\n")[-1]))


def environment(name: str) -> Path:
    """The interpreter of a virtual environment with a library. Skips the test if the library cannot be installed."""
    folder = Path(os.environ["FPBM_PEERS"]).resolve() / name.lower()
    python = folder / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        pip = [python, "-m", "pip", "install", "--quiet", "--no-compile", "--only-binary", ":all:"]
        pip += {**PACKAGES, **PATH_PACKAGES}[name]
        if subprocess.run(pip, check=False).returncode != 0:
            shutil.rmtree(folder)
            pytest.skip(f"{name} cannot be installed")
    return python


def require_loading(name: str, python: Path | str, folder: Path) -> None:
    """Skips the test if the packages of TSID and Pinocchio are incompatible: then, TSID aborts."""
    program = 'import tsid\ntsid.RobotWrapper("panda.urdf", [], False)'
    if name == "TSID" and subprocess.run([python, "-c", program], cwd=folder, capture_output=True).returncode != 0:
        pytest.skip("TSID's package cannot load a robot with this Pinocchio")


def errors(q: Any, target: Any) -> tuple[float, float]:
    """Errors of position [m] and rotation [rad]."""
    tip = fp.SerialArm.preset("panda").forward(q)
    cosine = (np.trace(tip[:3, :3] @ target[:3, :3].T) - 1) / 2
    return float(np.linalg.norm(tip[:3, 3] - target[:3, 3])), float(np.arccos(min(cosine, 1.0)))


@pytest.fixture(scope="module")
def ours(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return run(sys.executable, tmp_path_factory.mktemp("ours"), "import numpy as np\n" + "\n".join(programs("")))


@pytest.mark.skipif("FPBM_PEERS" not in os.environ, reason="make peers installs the libraries")
@pytest.mark.parametrize("name", PACKAGES)
def test_program(name: str, ours: Any, tmp_path: Path) -> None:
    (tmp_path / "panda.urdf").write_text(urdf(panda()))
    (tmp_path / "panda.xml").write_text(mjcf(panda()))
    given, (program,) = programs("")[0], programs(name)
    if name == "KDL":
        file = next(Path("/usr/lib/python3/dist-packages").glob("PyKDL*.so"), None)
        if file is None:
            pytest.skip("PyKDL (Debian: python3-pykdl) is not installed")
        (tmp_path / file.name).symlink_to(file)
        python: Path | str = sys.executable
    else:
        python = environment(name)
    require_loading(name, python, tmp_path)
    q = run(python, tmp_path, f"import numpy as np\n{given}\n{program}")
    target = fp.SerialArm.preset("panda").forward(Q0)
    target[:3, 3] += MOVE
    found = {"fpbm_cpp": errors(ours, target), name: errors(q, target)}
    for library, (position, rotation) in found.items():
        print(f"\n{library}: {position:.1e} m, {rotation:.1e} rad from the target", end="")
        assert position < 1e-3
        assert rotation < 0.01
    print(f"\njoints of {name} and of fpbm_cpp differ by at most {np.abs(q - ours).max():.1e} rad")


def distance_from(line: Any, points: Any) -> float:
    """Largest distance of points from a polyline [m]."""
    start, steps = line[:-1], np.diff(line, axis=0)
    worst = 0.0
    for point in points:
        shares = np.sum((point - start) * steps, axis=1) / np.maximum(np.sum(steps**2, axis=1), 1e-30)
        nearest = start + np.clip(shares, 0, 1)[:, None] * steps
        worst = max(worst, np.linalg.norm(point - nearest, axis=1).min())
    return worst


@pytest.mark.skipif("FPBM_PEERS" not in os.environ, reason="make peers installs the libraries")
@pytest.mark.parametrize("name", PATH_PACKAGES)
def test_path_program(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    given, (bounds, program), (theirs,) = programs("")[0], programs("Paths"), programs(name)
    ours: dict[str, Any] = {"np": np, "fp": fp, "arm": fp.SerialArm.preset("panda")}
    exec(f"{given}\n{bounds}\n{program}", ours)
    arm, path = ours["arm"], ours["path"]
    line = arm.forward(Q0)[:3, 3] + [path.sample(t)[0] for t in np.linspace(0, path.duration, 2001)]
    q = run(environment(name), tmp_path, f"import numpy as np\n{given}\n{bounds}\n{theirs}")
    found = {}
    for library, postures in {"fpbm_cpp": ours["q"], name: q}.items():
        away = distance_from(line, [arm.forward(each)[:3, 3] for each in postures])
        limits = [ours[bound] for bound in ("velocity", "acceleration", "jerk")]
        ratios = [np.max(np.abs(np.diff(postures, k, axis=0)) / 1e-3**k / bound) for k, bound in enumerate(limits, 1)]
        found[library] = (1e-3 * (len(postures) - 1), away, *ratios)
        print(f"\n{library}: {found[library][0]:.3f} s, {away:.0e} m from the path, ratios to the bounds", end="")
        print("".join(f" {ratio:.3f}" for ratio in ratios), end="")
        assert errors(postures[-1], arm.forward(ours["q"][-1]))[0] < 1e-4
        assert max(ratios[:2]) < 1.01
    duration, away, *ratios = found["fpbm_cpp"]
    assert away < 1e-6
    assert max(ratios) < 1 + 1e-9
    if name == "TOPP-RA":
        assert duration == pytest.approx(found[name][0], rel=0.02)
