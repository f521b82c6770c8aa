"""C++ blocks: compiled with warnings as errors, linked and run.

A block that includes something is a translation unit; any other is the body of a function. An invisible block before it
is what it takes for granted, at namespace scope.
"""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

EIGEN = "/usr/include/eigen3"
FLAGS = ["-std=c++17", "-O1", "-Wall", "-Wextra", "-Werror", "-Wno-unused", "-isystem", EIGEN]


class Compiler:
    """g++, with the umbrella header compiled once for all blocks."""

    def __init__(self, root: Path, scratch: Path) -> None:
        self.scratch = scratch
        self.flags = [*FLAGS, "-I", str(root / "cpp" / "include")]
        self.header = scratch / "all.hpp"

    def evaluate(self, example: Any) -> None:
        code, line = str(example.parsed), example.line
        if example.document.text[example.region.start :].startswith("<!--"):
            example.namespace["cpp_setup"] = code
            return
        setup = example.namespace.pop("cpp_setup", "")
        source = self.scratch / f"{Path(example.path).stem}_{line}.cpp"
        source.write_text(program(setup, code))
        run(["g++", *self.flags, "-include", str(self._precompiled()), str(source), "-o", str(source.with_suffix(""))])
        run([str(source.with_suffix(""))])

    def _precompiled(self) -> Path:
        if not self.header.exists():
            self.header.write_text("#include <fpbm/fpbm.hpp>\n")
            run(["g++", *self.flags, "-x", "c++-header", str(self.header), "-o", f"{self.header}.gch"])
        return self.header


def program(setup: str, code: str) -> str:
    """What is compiled for a block."""
    if "#include" not in code:
        return f"{setup}\nvoid block() {{\n{code}\n}}\nint main() {{ block(); }}\n"
    return f"{setup}\n{code}\n" + ("" if "int main(" in code else "int main() {}\n")


def run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}{done.stderr}"
