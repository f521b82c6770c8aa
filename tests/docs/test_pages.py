"""Every code block of the README and of docs/ does what it says: Python is run, C++ compiled, linked and run, CMake
configured, and shell commands are held against what there is.

Blocks of a page share their names, from top to bottom. What a block needs besides, and why one is skipped, stands in a
comment before it, which readers do not see.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from cmake_block import configure
from cpp_block import Compiler
from shell_block import check_shell
from sybil import Sybil
from sybil.parsers.markdown import CodeBlockParser, PythonCodeBlockParser, SkipParser

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.fixture(scope="session")
def sybil(tmp_path_factory: pytest.TempPathFactory) -> Sybil:
    compiler = Compiler(ROOT, tmp_path_factory.mktemp("cpp"))
    return Sybil(
        parsers=[
            PythonCodeBlockParser(),
            CodeBlockParser("cpp", compiler.evaluate),
            CodeBlockParser("cmake", configure),
            CodeBlockParser("sh", check_shell),
            SkipParser(),
        ]
    )


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_page(page: Path, sybil: Sybil, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for example in sybil.parse(page).examples():
        example.evaluate()
