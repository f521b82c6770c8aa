"""Prints the program of README's section "In a control loop". .ci/run measures the cost of this program for a user.

readme_program.py [HEADING] > program.cpp
"""

import re
import sys
from pathlib import Path

README = Path(__file__).parent.parent / "README.md"


def program(heading: str) -> str:
    """The section's C++ blocks, including hidden blocks, in a main()."""
    section = README.read_text().partition(f"## {heading}\n")[2].partition("\n## ")[0]
    blocks = re.findall(r"(?:<!-- invisible-code-block: cpp|```cpp)\n(.*?)(?:-->|```)", section, re.DOTALL)
    if not blocks:
        raise SystemExit(f"README.md has no C++ under '{heading}'")
    body = "".join(f"  {line}\n" for line in "".join(blocks).splitlines())
    return f"#include <fpbm/tracker.hpp>\n\nint main() {{\n{body}  return fpbm::failed(tick.status) ? 1 : 0;\n}}\n"


if __name__ == "__main__":
    sys.stdout.write(program(sys.argv[1] if len(sys.argv) > 1 else "In a control loop"))
