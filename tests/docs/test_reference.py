"""The reference has every public name, and the page on installation has every extra."""

from __future__ import annotations

import re
from pathlib import Path

import tomllib

import fpbm_cpp as fp

DOCS = Path(__file__).parents[2] / "docs"
INCLUDE = DOCS.parent / "cpp" / "include" / "fpbm"


def test_python() -> None:
    page = (DOCS / "reference" / "python.rst").read_text()
    listed = re.findall(r"^\.\. (?:auto\w+|py:data):: (\w+)$", page, re.MULTILINE)
    assert sorted(listed) == sorted(fp.__all__)


def test_every_folder_of_public_headers_has_a_page() -> None:
    folders = {header.parent.name for header in INCLUDE.glob("*/*.hpp")}
    assert {page.stem for page in (DOCS / "reference" / "cpp").glob("*.rst")} == folders


def test_extras() -> None:
    project = tomllib.loads((DOCS.parent / "pyproject.toml").read_text())["project"]
    listed = re.findall(r"^\| `(\w+)` \|", (DOCS / "install.md").read_text(), re.MULTILINE)
    assert sorted(listed) == sorted(project["optional-dependencies"])
