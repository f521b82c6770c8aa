"""Shell blocks: every command, option, extra, preset, target and file in them exists.

Commands of this project are called with --help; nothing is installed, built or configured.
"""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import tomllib

ROOT = Path(__file__).parents[2]
OTHERS = {"echo", "tee", "setcap"}  # Programs of the system, which need privileges or change the system.


def check_shell(example: Any) -> None:
    for command in commands(str(example.parsed)):
        name, *arguments = command[1:] if command[0] == "sudo" else command
        if name in CHECKS:
            CHECKS[name](arguments)
        elif name.startswith("build/"):
            known_target(Path(name).name)
        else:
            assert name in OTHERS, f"{name}: unknown command: add a check to CHECKS"


def commands(block: str) -> list[list[str]]:
    """The words of each command, without comments."""
    words = shlex.shlex(re.sub(r"\s+#\s.*", "", block), posix=True, punctuation_chars="();<>|&\n")
    words.whitespace, words.commenters = " \t", ""
    parts: list[list[str]] = [[]]
    for word in words:
        if set(word) <= set(";|&\n"):
            parts.append([])
        else:
            parts[-1].append(word)
    return [part for part in parts if part]


def check_pip(arguments: list[str]) -> None:
    assert arguments[0] in ("install", "wheel")
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    for argument in arguments[1:]:
        ours = re.fullmatch(r"(?:\.|fpbm_cpp)\[(.+)\]", argument)
        assert not ours or set(ours[1].split(",")) <= set(extras), f"{argument}: extras are {', '.join(extras)}"


def check_python(arguments: list[str]) -> None:
    if arguments[0] == "-m":
        assert find_spec(arguments[1]), f"{arguments[1]}: no such module"
    else:
        assert (ROOT / arguments[0]).is_file(), f"{arguments[0]}: no such file"


def check_cmake(arguments: list[str]) -> None:
    presets = {preset["name"] for preset in json.loads((ROOT / "CMakePresets.json").read_text())["configurePresets"]}
    settings = (ROOT / "CMakeLists.txt").read_text()
    for option, value in zip(arguments, [*arguments[1:], ""]):
        if option == "--preset":
            assert value in presets, f"{value}: presets are {', '.join(sorted(presets))}"
        elif option == "--target":
            known_target(value)
        elif option.startswith("-DFPBM_"):
            assert f"option({option[2:].split('=')[0]} " in settings, f"{option}: no such option"


def known_target(name: str) -> None:
    """A program of this project is example_NAME, from examples/NAME.cpp."""
    assert (ROOT / "examples" / f"{name.removeprefix('example_')}.cpp").is_file(), f"{name}: no such program"


def check_make(arguments: list[str]) -> None:
    targets = set(re.findall(r"^(?:\.PHONY:)?([\w -]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    known = {name for names in targets for name in names.split()}
    assert arguments[0] in known, f"make {arguments[0]}: no such target"


def check_fpbm(arguments: list[str]) -> None:
    words = [word for word in arguments[:1] if not word.startswith("-")]
    command = [sys.executable, "-m", "fpbm_cpp", *words, "--help"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    for argument in arguments:
        option = argument.split("=")[0]
        assert not option.startswith("-") or option in done.stdout, f"{option}: not an option of {' '.join(words)}"


def check_colcon(arguments: list[str]) -> None:
    for argument in arguments[arguments.index("--base-paths") + 1 :]:
        folder = argument.removeprefix("src/fpbm_cpp/")
        assert (ROOT / folder / "package.xml").is_file(), f"{folder}: no ROS package"


def check_ros2(arguments: list[str]) -> None:
    verb, package, name = arguments
    assert verb == "launch"
    assert (ROOT / "ros2" / package / "launch" / name).is_file(), f"{name}: no such launch file of {package}"


CHECKS = {
    "pip": check_pip,
    "python": check_python,
    "cmake": check_cmake,
    "make": check_make,
    "fpbm-cpp": check_fpbm,
    "colcon": check_colcon,
    "ros2": check_ros2,
}
