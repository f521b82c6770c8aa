"""Every code block of the README and of docs/ does what it says.

Python is run, C++ compiled and whole programs run, CMake projects are built, and shell commands held against what there
is.

Blocks of a page share their names, from top to bottom. What a block needs besides, and why one is skipped, stands in a
comment before it, which readers do not see.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from cmake_block import build_project
from cpp_block import Compiler
from shell_block import check_shell
from sybil import Example, Sybil
from sybil.parsers.markdown import CodeBlockParser, PythonCodeBlockParser, SkipParser

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
SYBIL = Sybil(
    parsers=[
        PythonCodeBlockParser(),
        CodeBlockParser("cpp", Compiler(ROOT / "cpp" / "include").evaluate),
        CodeBlockParser("cmake", build_project),
        CodeBlockParser("sh", check_shell),
        SkipParser(),
    ]
)
BLOCKS = [block for page in PAGES for block in SYBIL.parse(page).examples()]


# A page stays in one process, where its blocks share their names.
CASES = [
    pytest.param(
        block, id=f"{Path(block.path).name}:{block.line}", marks=pytest.mark.xdist_group(Path(block.path).name)
    )
    for block in BLOCKS
]


@pytest.mark.parametrize("block", CASES)
def test_block(block: Example, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    block.evaluate()
