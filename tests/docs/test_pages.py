"""Every code block of the README and of docs/ works.

Python is run. C++ is compiled, and whole programs are run. CMake projects are built. Shell commands are compared with
the existing commands and files.

Blocks of a page share their names, from top to bottom. A hidden comment before a block contains further prerequisites,
and the reason if the block is skipped.
"""

from __future__ import annotations

from pathlib import Path
from unittest import SkipTest

import pytest
from cmake_block import build_project
from cpp_block import Compiler
from shell_block import check_shell
from sybil import Sybil
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


# A page is one test, since its blocks share their names.
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_page(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for block in SYBIL.parse(page).examples():
        folder = tmp_path / str(block.line)
        folder.mkdir()
        monkeypatch.chdir(folder)
        try:
            block.evaluate()
        except SkipTest:
            continue
        except Exception as error:
            raise AssertionError(f"{page.name}, line {block.line}") from error
