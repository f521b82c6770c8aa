"""Writes fpbm.hpp, which includes every public header. --check: checks fpbm.hpp, the number of public headers, the
lengths of headers, and the directions of includes between the rooms of the library (docs/architecture.md)."""

import re
import sys
from pathlib import Path

INCLUDE = Path(__file__).parent.parent / "cpp" / "include"
UMBRELLA = INCLUDE / "fpbm" / "fpbm.hpp"
# lanes.hpp needs <experimental/simd>, which not every standard library has.
LEFT_OUT = {"fpbm/fpbm.hpp", "fpbm/core/lanes.hpp"}
MOST_PUBLIC = 70
MOST_LINES = 200
# A header includes headers of its own layer and of the layers before.
LAYERS = [
    ("core", "geometry", "linalg"),
    ("model",),
    ("path",),
    ("target",),
    ("task",),
    ("singular",),
    ("objective",),
    ("scheme",),
    ("limits",),
    ("bound",),
    ("inverse",),
    ("simulate",),
    ("realtime",),
    ("any",),
]
LEVEL = {room: level for level, rooms in enumerate(LAYERS) for room in rooms}


def wrong_includes(header: Path) -> list[str]:
    """The includes of a header that are against the directions."""
    rooms = header.relative_to(INCLUDE / "fpbm").parts[:-1]
    if not rooms:
        return []
    included = re.findall(r'#include "fpbm/(\w+)/', header.read_text())
    return [room for room in included if LEVEL[room] > LEVEL[rooms[0]]]


def complaints(public: set[str], fresh: str) -> list[str]:
    found = []
    if UMBRELLA.read_text() != fresh:
        found.append(f"{UMBRELLA} does not include every public header: run make format")
    if len(public) > MOST_PUBLIC:
        found.append(f"{len(public)} headers are public: at most {MOST_PUBLIC} may be, move others to detail/")
    for header in sorted((INCLUDE / "fpbm").rglob("*.hpp")):
        lines = header.read_text().count("\n")
        if lines > MOST_LINES:
            found.append(f"{header}: has {lines} lines, at most {MOST_LINES} are allowed: move one idea to detail/")
        found += [f"{header}: includes a header of {room}/, a later layer" for room in wrong_includes(header)]
    return found


def main() -> int:
    headers = {path.relative_to(INCLUDE).as_posix() for path in INCLUDE.rglob("*.hpp") if path.parent.name != "detail"}
    head = UMBRELLA.read_text().partition("#include")[0]
    fresh = head + "".join(f'#include "{header}"\n' for header in sorted(headers - LEFT_OUT))
    if "--check" not in sys.argv:
        UMBRELLA.write_text(fresh)
        return 0
    found = complaints(headers, fresh)
    print("\n".join(found), end="\n" if found else "", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
