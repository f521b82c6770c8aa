"""C++ blocks: compiled with warnings as errors; whole programs are also linked and run.

A block that includes a header is a translation unit. Any other block is the body of a function. An invisible block
before this block contains the prerequisites, at namespace scope.
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
        if not self.header.exists():
            self.header.write_text("#include <fpbm/fpbm.hpp>\n")
            run("g++", *self.flags, "-x", "c++-header", str(self.header), "-o", f"{self.header}.gch")
        Path("block.cpp").write_text(unit(block.namespace.pop("cpp_setup", ""), str(block.parsed)))
        compile_block = ["g++", *self.flags, "-include", str(self.header), "block.cpp"]
        if "int main(" not in block.parsed:
            run(*compile_block, "-fsyntax-only")
        else:
            run(*compile_block, "-o", "block")
            run("./block")


def unit(setup: str, code: str) -> str:
    """The translation unit of a block."""
    return f"{setup}\n{code}\n" if "#include" in code else f"{setup}\nvoid block() {{\n{code}\n}}\n"


def run(*command: str) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}{done.stderr}"
