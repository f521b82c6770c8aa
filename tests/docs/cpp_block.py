"""C++ blocks: compiled with warnings as errors; whole programs are also linked and run.

A block that includes a header is a translation unit, which compiles as it is typed, with its own headers only. Any
other block is the body of a function; all headers are included, and an invisible block before this block contains the
prerequisites, at namespace scope.
"""

from __future__ import annotations

import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

from sybil import Example

FLAGS = ["-std=c++17", "-O1", "-Wall", "-Wextra", "-Werror", "-Wno-unused", "-isystem", "/usr/include/eigen3"]


class Compiler:
    """g++, with the umbrella header compiled once for all blocks."""

    def __init__(self, include: Path) -> None:
        self.flags = [*FLAGS, "-I", str(include)]
        self.scratch = TemporaryDirectory()
        self.header = Path(self.scratch.name, "all.hpp")

    def evaluate(self, block: Example) -> None:
        if block.document.text[block.region.start :].startswith("<!--"):
            block.namespace["cpp_setup"] = str(block.parsed)
            return
        setup, code = block.namespace.pop("cpp_setup", ""), str(block.parsed)
        if "#include" in code:
            assert not setup, "a block that includes a header has no invisible prerequisites"
            Path("block.cpp").write_text(code)
            if "int main(" in code:
                run("g++", *self.flags, "block.cpp", "-o", "block")
                run("./block")
            else:
                run("g++", *self.flags, "block.cpp", "-fsyntax-only")
            return
        if not self.header.exists():
            self.header.write_text("#include <fpbm/fpbm.hpp>\n")
            run("g++", *self.flags, "-x", "c++-header", str(self.header), "-o", f"{self.header}.gch")
        Path("block.cpp").write_text(f"{setup}\nvoid block() {{\n{code}\n}}\n")
        run("g++", *self.flags, "-include", str(self.header), "block.cpp", "-fsyntax-only")


def run(*command: str) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}{done.stderr}"
