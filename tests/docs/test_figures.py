"""The commands of the pages print the figures of the pages. A command that needs more than a minute is skipped."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from figures import SETTING, Figure, differences, figures

ROOT = Path(__file__).parents[2]
TESTS = ROOT / "build" / "release" / "tests" / "cpp" / "fpbm_tests"
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
FIGURES = [figure for page in PAGES for figure in figures(page)]
NOT_HERE = {
    "FPBM_SECOND_STEPS=8334 fpbm_tests --gtest_filter='SecondStep*'": "needs more than a minute",
    "FPBM_ALL_TRIALS=1 fpbm_tests --gtest_filter='Stack.keeps_every*'": "needs more than a minute",
    "python examples/08_mujoco_panda.py": "motions along joint bounds amplify round-off errors",
}


def label(figure: Figure) -> str:
    return f"{figure.page.stem}-{figure.line}"


@pytest.mark.parametrize("figure", FIGURES, ids=label)
def test_a_command_prints_its_figure(figure: Figure, tmp_path_factory: pytest.TempPathFactory) -> None:
    if figure.command in NOT_HERE:
        pytest.skip(f"{figure.command}: {NOT_HERE[figure.command]}")
    found = differences(figure.expected, output(figure.command, tmp_path_factory))
    assert not found, f"{figure.command} does not print:\n" + "\n".join(found)


def output(command: str, folders: pytest.TempPathFactory, known: dict[str, str] = {}) -> str:  # noqa: B006
    """The output of a command; each command runs once."""
    if command not in known:
        name, *arguments = shlex.split(SETTING.sub("", command))
        if name == "python":
            call, folder = [sys.executable, str(ROOT / arguments[0]), *arguments[1:]], folders.mktemp("figure")
        elif name == "pytest":
            call, folder = [sys.executable, "-m", "pytest", *arguments], ROOT
        else:
            if not TESTS.exists():
                pytest.skip("needs build/release/tests/cpp/fpbm_tests: make test-cpp")
            call, folder = [str(TESTS), *arguments], ROOT
        environment = {**os.environ, **dict(SETTING.findall(command)), "MPLBACKEND": "Agg"}
        done = subprocess.run(
            call, cwd=folder, capture_output=True, text=True, env=environment, check=False, timeout=600
        )
        if name == "pytest" and done.returncode == pytest.ExitCode.NO_TESTS_COLLECTED:
            pytest.skip(f"{command}: needs other packages")
        assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
        known[command] = done.stdout
    return known[command]


@pytest.mark.parametrize(
    ("expected", "printed"),
    [
        ("6e-10 m; 1.87 m", "tip off by at most 2e-06 m, base travels 1.87 m"),
        ("0.80 mm at most", "at most 0.14 mm"),
        ("399", "slowed in 400 ticks"),
        ("a 1.0 2.00\nb 3.0 4.00", "a 1.0 2.00\nb 3.0 4.01"),
    ],
)
def test_a_wrong_figure_is_found(expected: str, printed: str) -> None:
    assert differences(expected, printed)


def test_a_right_figure_is_accepted() -> None:
    assert differences("8e-13, 0.44 rad, at most 12,000", "off by 7.9e-13; 0.4371 of 12000") == []
    assert differences("a  1.0\nb  2e-15", "a 1.04\nb 1.5e-15") == []


def test_the_pages_have_figures() -> None:
    assert {re.sub(r"\W.*", "", figure.page.name) for figure in FIGURES} >= {"limits", "tasks", "robots", "physics"}
