"""Figures of the pages: numbers that a command prints.

Two forms state a figure. (1) A table with the columns "command" and "result": the numbers of the result are numbers of
the output. (2) A block without a language, after a command in the text: the lines of the block are lines of the output.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

NUMBER = re.compile(r"(?<![\w.])[-−]?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.]*\d)")
CODE = re.compile(r"`([^`]+)`")
SETTING = re.compile(r"\b(FPBM_\w+)=(\S+)")
FACTOR = 2.0  # Between two numbers in exponent notation, which are errors of convergence.
ROUND_OFF = 1e-9  # All numbers in exponent notation up to this size are round-off errors, which depend on the machine.


@dataclass(frozen=True)
class Figure:
    page: Path
    line: int
    command: str  # With its settings, for instance "FPBM_MOTIONS=40 fpbm_tests --gtest_filter='Recovery.*'".
    expected: str


def figures(page: Path) -> list[Figure]:
    lines = page.read_text().splitlines()
    found, columns, command, fenced = [], [], "", None
    for number, line in enumerate(lines, start=1):
        if line.startswith("```"):
            if fenced is None:
                fenced = (line, number)
            elif fenced[0] in ("```", "```text") and command:
                found.append(Figure(page, fenced[1], command, "\n".join(lines[fenced[1] : number - 1])))
                fenced = None
            else:
                fenced = None
        elif fenced is not None:
            command = a_command([line.partition("  #")[0].strip()]) or command if fenced[0] == "```sh" else command
        elif line.startswith("|"):
            cells = [cell.strip() for cell in line.strip("|").split(" | ")]
            if "command" in cells and "result" in cells:
                columns = cells
            elif columns and len(cells) == len(columns):
                row = dict(zip(columns, cells))
                if named := a_command(CODE.findall(row["command"])):
                    found.append(Figure(page, number, named, row["result"]))
        else:
            columns = []
            command = "" if line.startswith("#") else a_command(CODE.findall(line)) or command
    return found


def a_command(codes: list[str]) -> str:
    """The command of a piece of text, with its settings; empty if there is none that runs alone."""
    settings = " ".join("=".join(pair) for code in codes for pair in SETTING.findall(code))
    for code in codes:
        words = SETTING.sub("", code).strip()
        if re.match(r"python \S+\.py|pytest ", words):
            return f"{settings} {words}".strip()
        tests = re.fullmatch(r"(?:\S*fpbm_tests )?(?:--gtest_filter=)?'?([A-Z]\w+[.*][\w*.]*(?::[\w*.]+)*)'?", words)
        if tests:
            return f"{settings} fpbm_tests --gtest_filter='{tests[1]}'".strip()
    return ""


def differences(expected: str, output: str) -> list[str]:
    """The numbers of a table's result, or the lines of a block, that the output does not have."""
    if "\n" in expected:
        lines = [line for line in expected.splitlines() if line.strip()]
        printed = [numbers(line) for line in output.splitlines()]
        return [line for line in lines if not any(agree(numbers(line), other) for other in printed)]
    stated = re.sub(r"(?:below|by more than|exceeded by) \S+", "", expected)  # Bounds that the test itself states.
    printed = numbers(output)
    return [number for number in numbers(stated) if not any(same(number, other) for other in printed)]


def numbers(text: str) -> list[str]:
    return [number.replace("−", "-") for number in NUMBER.findall(re.sub(r"(?<=\d),(?=\d{3})", "", text))]


def agree(expected: list[str], printed: list[str]) -> bool:
    return len(expected) == len(printed) and all(same(one, other) for one, other in zip(expected, printed))


def same(expected: str, printed: str) -> bool:
    """Whether a printed number is the expected number, rounded to the expected digits."""
    one, other = float(expected), float(printed)
    if "e" in expected:
        if max(abs(one), abs(other)) <= ROUND_OFF:
            return True
        return one * other > 0 and 1 / FACTOR <= other / one <= FACTOR
    digits = len(expected.partition(".")[2])
    return abs(other - one) <= 0.5001 * 10.0**-digits
