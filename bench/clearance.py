"""Contacts of arms with a clearance: in random motions, compared with Pink and Mink, and with a moving post in MuJoCo.

python bench/clearance.py motions [--motions 10000 --minutes 12]
python bench/clearance.py peers
python bench/clearance.py post [--motions 20]
"""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path

RESULTS = Path(__file__).parent / "results"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    motions = commands.add_parser("motions", help="random motions straight through table, shelf and post")
    motions.add_argument("--motions", type=int, default=200, help="of four arms, alternately; 10,000 in the full run")
    motions.add_argument("--workers", type=int, default=2)
    motions.add_argument("--minutes", type=float, default=60.0, help="stop after this time [min]")
    commands.add_parser("peers", help="motions with fpbm_cpp, Pink and Mink to the same targets")
    post = commands.add_parser("post", help="a post that crosses a Panda's workspace in MuJoCo")
    post.add_argument("--motions", type=int, default=5, help="of each speed")
    for command in commands.choices.values():
        command.add_argument("--write", action="store_true", help=f"also write {RESULTS.name}/clearance_<command>.md")
    options = vars(parser.parse_args())
    command, write = options.pop("command"), options.pop("write")
    lines = []
    for line in import_module(f"clearance_{command}").run(**options):
        print(line, flush=True)
        lines.append(line)
    if write:
        RESULTS.joinpath(f"clearance_{command}.md").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
