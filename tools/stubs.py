"""Writes the type stubs of the compiled module afresh, or checks that they are (--check).

Run it with a Python that has the package installed.
"""

import filecmp
import subprocess
import sys
import tempfile
from pathlib import Path

STUBS = Path(__file__).parent.parent / "python" / "fpbm_cpp" / "_core.pyi"


def main() -> int:
    with tempfile.TemporaryDirectory() as scratch:
        generate = [sys.executable, "-m", "pybind11_stubgen", "fpbm_cpp._core", "--exit-code", "-o", scratch]
        subprocess.run(generate, check=True, cwd=scratch)
        fresh = Path(scratch) / "fpbm_cpp" / "_core.pyi"
        ruff = [sys.executable, "-m", "ruff", "--config", STUBS.parents[2] / "pyproject.toml"]
        subprocess.run([*ruff, "check", "--quiet", "--fix", "--exit-zero", fresh], check=True)
        subprocess.run([*ruff, "format", "--quiet", fresh], check=True)
        if "--check" not in sys.argv:
            STUBS.write_bytes(fresh.read_bytes())
        elif not STUBS.exists() or not filecmp.cmp(fresh, STUBS, shallow=False):
            print(f"{STUBS} is stale: run make stubs", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
