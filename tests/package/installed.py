"""Checks the installed package, with NumPy only; fails if a wheel is incomplete, or differs from its metadata.

usage: installed.py, with the Python that has the package installed
"""

import os
import platform
import subprocess
import sys
import sysconfig
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import fpbm_cpp as fp
from fpbm_cpp.motion._lanes import LANES

ARM = fp.PlanarArm([1, 1, 1, 1])
CIRCLE = fp.Circle(0.45, 10.0)
SCHEME = fp.FPBM(0.6, [1, 2, 3, 4], k1=1, k2=1)
Q0 = np.pi / np.array([12, 12, 15, 15])


def run(*command: str, **environment: str) -> "subprocess.CompletedProcess[str]":
    environment = {**os.environ, **environment}
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)


def the_package() -> str:
    """The package is installed, has one version, and imports no optional library."""
    site = Path(sysconfig.get_path("platlib"))
    assert site in Path(fp.__file__).parents, f"{fp.__file__} is not in {site}"
    assert fp.__version__ == version("fpbm_cpp"), f"{fp.__version__} is not {version('fpbm_cpp')}"
    extras = {"click", "dask", "matplotlib", "scipy", "tqdm", "yourdfpy"} & sys.modules.keys()
    assert not extras, f"import fpbm_cpp also imports {extras}, which are optional"
    assert (site / "fpbm_cpp" / "py.typed").exists(), "py.typed is missing"
    return f"fpbm_cpp {fp.__version__}, Python {platform.python_version()}, NumPy {np.__version__}"


def the_circle() -> str:
    """The paper's circle ends in the posture of the independent solution (tests/cpp/support/paper.hpp)."""
    motion = fp.simulate(ARM, CIRCLE, SCHEME, Q0)
    off = np.abs(motion.q[-1] - [0.215222487, 0.396791734, 0.1144437012, 0.1756873322]).max()
    assert off < 1e-9, f"off by {off:.1e} rad"
    return f"circle off by {off:.1e} rad"


def a_sweep() -> str:
    """A sweep, with or without lanes, has the same motions as single calls of simulate()."""
    starts = Q0 + np.linspace(-0.05, 0.05, 11)[:, None]
    sweep = fp.sweep(ARM, CIRCLE, SCHEME, starts, 0.01)
    alone = [fp.simulate(ARM, CIRCLE, SCHEME, start, dt=0.01) for start in starts]
    off = np.abs(sweep.peak_velocity[0] - [np.abs(motion.qd).max() for motion in alone]).max()
    assert sweep.ok.all()
    assert off < 1e-12, f"off by {off:.1e} rad/s"
    return f"lanes: {LANES}, off by {off:.1e} rad/s"


def every_lane() -> str:
    """A sweep with each type of lanes that this processor has, and without lanes."""
    kinds = ["none", *fp._core.processor_kinds()]
    if sys.platform == "linux" and platform.machine() == "x86_64":
        missing = [kind for kind in ("avx2", "avx512") if find_spec(f"fpbm_cpp._lanes_{kind}") is None]
        assert not missing, f"the wheel has no code for {missing}"
    said = {}
    for kind in kinds:
        child = run(sys.executable, __file__, "sweep", FPBM_LANES=kind)
        assert child.returncode == 0, child.stderr
        said[kind] = child.stdout.strip()
    assert said["none"].startswith("lanes: 1,"), said["none"]
    return "; ".join(f"{kind}: {words}" for kind, words in said.items())


def the_command() -> str:
    """The command runs, or prints in one line which extra to install."""
    command = str(Path(sysconfig.get_path("scripts")) / "fpbm-cpp")
    child = run(command, "--version")
    if find_spec("click") is None:
        (said,) = child.stderr.splitlines()
        assert child.returncode == 1, child.returncode
        assert 'pip install "fpbm_cpp[cli]"' in said, said
    else:
        said = child.stdout.strip()
        assert child.returncode == 0, child.stderr
        assert fp.__version__ in said, said
    return f"fpbm-cpp --version: {said}"


if __name__ == "__main__":
    for check in [a_sweep] if sys.argv[1:] == ["sweep"] else [the_package, the_circle, every_lane, the_command]:
        print(check())
