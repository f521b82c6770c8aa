"""Prints the program of README's section "In a control loop". .ci/run measures the cost of this program for a user.

readme_program.py [HEADING] > program.cpp
"""

import re
import sys
from pathlib import Path

README = Path(__file__).parent.parent / "README.md"


def program(heading: str) -> str:
    """The section's C++ block, which is a whole program."""
    section = README.read_text().partition(f"## {heading}\n")[2].partition("\n## ")[0]
    block = re.search(r"```cpp\n(.*?)```", section, re.DOTALL)
    if not block:
        raise SystemExit(f"README.md has no C++ under '{heading}'")
    return block[1]


if __name__ == "__main__":
    sys.stdout.write(program(sys.argv[1] if len(sys.argv) > 1 else "In a control loop"))
