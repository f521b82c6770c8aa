"""The tests that comments of headers and pages cite exist."""

import re
from fnmatch import fnmatch
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DEFINED = re.compile(r"^(?:TEST|TEST_F|TEST_P|TYPED_TEST|TYPED_TEST_P)\((\w+),\s*(\w+)\)", re.MULTILINE)
CITED = re.compile(r"\b([A-Z]\w+)\.([a-z]\w*\*?)")  # Suite.test, or Suite.tes*
FILTER = re.compile(r"gtest_filter='([^']+)'")
PAGES = [ROOT / "README.md", *ROOT.glob("bench/README.md"), *sorted(ROOT.glob("docs/*.md"))]
HEADERS = sorted(ROOT.glob("cpp/include/fpbm/**/*.hpp"))


def defined() -> set[tuple[str, str]]:
    """Suite and name of each C++ test."""
    return {pair for file in ROOT.glob("tests/cpp/*.cpp") for pair in DEFINED.findall(file.read_text())}


def missing(text: str, suites: bool) -> list[str]:
    """The cited tests that do not exist. suites: whether Suite.test is a citation also outside of a filter."""
    tests = {f"{suite}.{name}" for suite, name in defined()}
    names = {suite for suite, _ in defined()}
    text = re.sub(r"\n\s*(?:///|//)?\s*", " ", text)  # A citation may be split at the end of a line.
    cited = [pattern for found in FILTER.findall(text) for pattern in found.split(":")]
    if suites:
        cited += [f"{suite}.{name}" for suite, name in CITED.findall(text) if suite in names]
    return [pattern for pattern in cited if not any(fnmatch(test, pattern) for test in tests)]


@pytest.mark.parametrize("file", [*HEADERS, *PAGES], ids=lambda file: str(file.relative_to(ROOT)))
def test_cited_tests_exist(file: Path) -> None:
    assert missing(file.read_text(), suites=file.suffix == ".hpp") == []


def test_a_missing_test_is_found() -> None:
    assert missing("/// Bounds.does_not_exist fails.", suites=True) == ["Bounds.does_not_exist"]
    assert missing("`fpbm_tests --gtest_filter='Guards*'`", suites=False) == ["Guards*"]
