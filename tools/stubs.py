"""Rewrites the type stubs of the compiled module, or checks that they are up to date (--check).

Run this script with a Python that has the package installed.
"""

import filecmp
import re
import subprocess
import sys
import tempfile
from pathlib import Path

STUBS = Path(__file__).parent.parent / "python" / "fpbm_cpp" / "_core.pyi"


def with_types(text: str) -> str:
    """The text, with members of enums and tuples of words as type checkers require."""
    text = re.sub(r"^(\w+): tuple = ", r"\1: tuple[str, ...] = ", text, flags=re.MULTILINE)
    text = re.sub(r"^(\w+: tuple\[str, \.\.\.\]) = \('(\w+)'\)$", r"\1 = ('\2',)", text, flags=re.MULTILINE)
    text = re.sub(r"^    (\w+): typing\.ClassVar\[Status\].*$", r"    \1 = ...", text, flags=re.MULTILINE)
    return text.replace("    @classmethod\n    def __new__(cls, value):\n        ...\n", "")


def main() -> int:
    with tempfile.TemporaryDirectory() as scratch:
        generate = [sys.executable, "-m", "pybind11_stubgen", "fpbm_cpp._core", "--exit-code", "-o", scratch]
        subprocess.run(generate, check=True, cwd=scratch)
        fresh = Path(scratch) / "fpbm_cpp" / "_core.pyi"
        fresh.write_text(with_types(fresh.read_text()))
        config = STUBS.parents[2] / "pyproject.toml"
        subprocess.run([sys.executable, "-m", "ruff", "format", "--quiet", "--config", config, fresh], check=True)
        if "--check" not in sys.argv:
            STUBS.write_bytes(fresh.read_bytes())
        elif not STUBS.exists() or not filecmp.cmp(fresh, STUBS, shallow=False):
            print(f"{STUBS} is stale: run make stubs", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
