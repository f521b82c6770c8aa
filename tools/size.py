"""Prints the size of the library: lines, headers, and the files that an addition touches (docs/architecture.md)."""

import re
from pathlib import Path

ROOT = Path(__file__).parent.parent
PARTS = {
    "core": ("cpp/include", "*.hpp"),
    "bindings": ("python/bindings", "*.?pp"),
    "package": ("python/fpbm_cpp", "*.py"),
}
LONG = 200  # Lines of a long header.
SOURCES = re.compile(r"^\| `(?!tests|docs|python/fpbm_cpp/_core\.pyi)|^\| a header")


def lines(folder: str, pattern: str) -> dict[Path, int]:
    return {path: len(path.read_text().splitlines()) for path in sorted((ROOT / folder).rglob(pattern))}


def main() -> None:
    total = 0
    for name, where in PARTS.items():
        sizes = lines(*where)
        total += sum(sizes.values())
        print(f"{name:10}{len(sizes):5} files{sum(sizes.values()):8,} lines")
    print(f"{'together':10}{total:19,} lines")
    headers = lines(*PARTS["core"])
    public = [path for path in headers if path.parent.name != "detail"]
    print(f"public headers: {len(public)}")
    print(f"headers of more than {LONG} lines: {sum(size > LONG for size in headers.values())}")
    sections = re.split(r"^## Add an? ", (ROOT / "docs" / "architecture.md").read_text(), flags=re.MULTILINE)[1:]
    for section in sections:
        touched = sum(bool(SOURCES.match(line)) for line in section.partition("\n## ")[0].splitlines())
        print(f"rows of files of sources that a new {section.split()[0]} touches for users of Python: {touched}")


if __name__ == "__main__":
    main()
