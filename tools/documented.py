"""Checks that the names in README.md and docs/ exist: files, folders, links, tests and targets of make."""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
MADE = ("build/", "demo/", "dist/")  # Folders of results.
USERS = {"my_arm.hpp", "my_robot.hpp", "main.cpp"}  # Files that a reader creates.
CODE = re.compile(r"`([^`\n]+)`")
FILE = re.compile(r"^(?:[\w.-]+/)*[\w.-]+\.(?:cpp|hpp|py|md|sh|json|yaml|toml|rst|txt)$")
FOLDER = re.compile(r"^(?:[\w.-]+/)+$")
LINK = re.compile(r"\]\(([^)#\s]+)[^)]*\)")
TEST = re.compile(r"^([A-Z]\w+)\.([a-z]+(?:_\w+){2,})$")  # Tracker.resolve_measured is not a test.
DECLARED = re.compile(r"^(?:TYPED_)?TEST(?:_[FP])?\((\w+),\s*(\w+)\)", re.MULTILINE)


def main() -> int:
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    files = [name for name in listed.splitlines() if (ROOT / name).exists()]
    ends = {name[start:] for name in files for start in _starts(name)}
    folders = {end[: slash + 1] for end in ends for slash in _slashes(end)}
    tests = "\n".join(
        (ROOT / name).read_text() for name in files if name.startswith("tests/") and name[-3:] in ("cpp", ".py")
    )
    laws = {f"{suite}.{name}" for suite, name in DECLARED.findall(tests)}
    suites = {law.partition(".")[0] for law in laws}
    functions = set(re.findall(r"^ *def (test_\w+)", tests, re.MULTILINE))
    targets = set(
        re.findall(r"[\w-]+", " ".join(re.findall(r"^([\w -]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)))
    )

    def missing(page: Path, code: str) -> str:
        """The first name in a piece of code that does not exist; empty if all names exist."""
        for word in code.split():
            named = FILE.match(word) and ("/" in word or word.endswith((".hpp", ".cpp")))
            if named and not word.startswith(MADE) and word not in ends | USERS:
                return word
            if FOLDER.match(word) and not word.startswith(MADE) and word not in folders:
                return word
            if word.startswith("test_") and re.match(r"^\w+$", word) and word not in functions:
                return word
            if (law := TEST.match(word)) and law[1] in suites and word not in laws:
                return word
        if asked := re.match(r"^make ([a-z][\w-]*)(?: |$)", code):
            return "" if asked[1] in targets else code
        return ""

    wrong = 0
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        block = False
        for number, line in enumerate(page.read_text().splitlines(), 1):
            block ^= line.startswith("```")
            if block:  # tests/docs runs the block.
                continue
            names = [missing(page, code) for code in CODE.findall(line)]
            links = [link for link in LINK.findall(line) if "://" not in link and not link.startswith("mailto:")]
            names += [link for link in links if not (page.parent / link).exists() and not link.startswith("notebooks/")]
            for name in filter(None, names):
                print(f"{page.relative_to(ROOT)}:{number}: {name} does not exist: correct the name", file=sys.stderr)
                wrong += 1
    return 1 if wrong else 0


def _slashes(name: str) -> list[int]:
    return [i for i, letter in enumerate(name) if letter == "/"]


def _starts(name: str) -> list[int]:
    """Start indices of the parts of a path."""
    return [0, *(slash + 1 for slash in _slashes(name))]


if __name__ == "__main__":
    sys.exit(main())
