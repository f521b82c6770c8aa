"""Shell blocks: commands of this project run as they are typed; the names in other commands exist.

The commands of a block run in one folder, beside a clone, with the robots my_arm.urdf and robot.urdf of this module.
Nothing is installed, built or configured here: the commands of pip, CMake, make and colcon are only compared with the
project. `fpbm-cpp servo` and `fpbm-cpp view` end as soon as they have printed the address of the page.
"""

from __future__ import annotations

import json
import os
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
EXAMPLE_ARM = ROOT / "examples" / "04_exported_arm.urdf"


def check_shell(example: Any) -> None:
    write_robots()
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


def write_robots() -> None:
    """Writes a reader's robots into the present folder: an arm with the tip tool0, and a torso with two arms."""
    Path("my_arm.urdf").write_text(EXAMPLE_ARM.read_text().replace('"tool"', '"tool0"'))
    links, joints = ["torso", "head"], [joint("neck", "torso", "head", "0 0 0.5", "0 0 1")]
    for side, y in (("left", 0.2), ("right", -0.2)):
        parent = "torso"
        for i, axis in enumerate(["0 0 1", "0 1 0", "1 0 0", "0 1 0", "1 0 0", "0 1 0", "1 0 0"]):
            links.append(f"{side}_{i}")
            joints.append(joint(f"{side}_{i}", parent, links[-1], f"0.15 {y if i == 0 else 0} 0.05", axis))
            parent = links[-1]
        links.append(f"{side}_tool")
        joints.append(
            f'<joint name="{side}_tool" type="fixed"><parent link="{parent}"/><child link="{side}_tool"/></joint>'
        )
    bodies = "".join(f'<link name="{link}"/>' for link in links)
    Path("robot.urdf").write_text(f'<robot name="torso">{bodies}{"".join(joints)}</robot>')


def joint(name: str, parent: str, child: str, xyz: str, axis: str) -> str:
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/><origin xyz="{xyz}"/>'
        f'<axis xyz="{axis}"/><limit lower="-2.8" upper="2.8" velocity="2" effort="50"/></joint>'
    )


def check_pip(arguments: list[str]) -> None:
    assert arguments[0] in ("install", "wheel")
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    for argument in arguments[1:]:
        assert not argument.startswith("fpbm_cpp"), f"{argument}: not in an index; install from a clone: '.'"
        ours = re.fullmatch(r"\.\[(.+)\]", argument)
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


def run_fpbm(arguments: list[str]) -> None:
    """Runs a command of fpbm-cpp; a command that serves a page runs until it prints the address of the page."""
    command = [sys.executable, "-m", "fpbm_cpp", *arguments]
    if arguments[0] not in ("servo", "view"):
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
        assert done.returncode == 0, f"fpbm-cpp {' '.join(arguments)}\n{done.stdout}{done.stderr}"
        return
    if find_spec("viser") is None:
        return
    command += ["--no-browser", "--port", "0"]
    unbuffered = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=unbuffered) as child:
        assert child.stdout is not None
        assert child.stderr is not None
        printed = ""
        while "http://" not in printed and (line := child.stdout.readline()):
            printed += line
        child.terminate()
        assert "http://" in printed, f"fpbm-cpp {' '.join(arguments)}\n{printed}{child.stderr.read()}"


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
    "fpbm-cpp": run_fpbm,
    "colcon": check_colcon,
    "ros2": check_ros2,
}
