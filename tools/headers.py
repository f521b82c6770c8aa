"""Writes fpbm.hpp, which includes every public header, or checks the file (--check)."""

import sys
from pathlib import Path

INCLUDE = Path(__file__).parent.parent / "cpp" / "include"
UMBRELLA = INCLUDE / "fpbm" / "fpbm.hpp"
# lanes.hpp needs <experimental/simd>, which not every standard library has.
LEFT_OUT = {"fpbm/fpbm.hpp", "fpbm/core/lanes.hpp"}


def main() -> int:
    headers = {path.relative_to(INCLUDE).as_posix() for path in INCLUDE.rglob("*.hpp") if path.parent.name != "detail"}
    head = UMBRELLA.read_text().partition("#include")[0]
    fresh = head + "".join(f'#include "{header}"\n' for header in sorted(headers - LEFT_OUT))
    if "--check" not in sys.argv:
        UMBRELLA.write_text(fresh)
    elif UMBRELLA.read_text() != fresh:
        print(f"{UMBRELLA} does not include every public header: run make format", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
