"""Checks examples/firmware: a Cortex-M7 computes the same bits as a PC, in bounded time, code and stack.

Usage: check.py BOARD.elf PC_PROGRAM
"""

import re
import struct
import subprocess
import sys

QEMU = (
    "qemu-system-arm -M mps2-an500 -nographic -monitor none -serial none -icount shift=0"
    " -chardev stdio,id=console -semihosting-config enable=on,chardev=console -kernel"
)

# Tolerance of joints [rad]: sines are the library's own, and sums are in the same order. Sines of two C libraries
# differ in the last bit, which moves joints that press on their limits by up to 2.6e-6.
TOLERANCE = 0.0
MOST = {
    "code and constants [bytes]": 480_000,
    "stack [bytes]": 9_500,
    "stack at construction [bytes]": 50_000,
    "instructions a tick": 16_000,
    "instructions a tick, where limits are met": 55_000,
    "instructions a tick, within bounds on torque": 200_000,
    "instructions a tick, at bounds on torque": 350_000,
}
MOTIONS = {
    "instructions a tick": ("panda", "ur5e"),
    "instructions a tick, where limits are met": ("panda_pressed", "ur5e_pressed"),
    "instructions a tick, within bounds on torque": ("panda_torques",),
    "instructions a tick, at bounds on torque": ("panda_torques_pressed",),
}
# The heap; texts and streams; arithmetic in double, which this processor would do in software.
FORBIDDEN = re.compile(
    r"_?(malloc|calloc|realloc|free|sbrk)(_r)?|_Zn[wa].*|_Zd[la].*|.*printf.*|.*basic_stringIc.*|__aeabi_(d\w+|\w+2d)"
)


def main(board: str, host: str) -> None:
    expected, said = output([host]), output([*QEMU.split(), board])
    difference, ticks = compare(expected, said), instructions(said)
    figures = {
        "code and constants [bytes]": sum(map(int, output(["arm-none-eabi-size", board]).split("\n")[1].split()[:2])),
        "stack [bytes]": int(found(r"# stack: (\d+) bytes", said)),
        "stack at construction [bytes]": int(found(r"at construction (\d+) bytes", said)),
    }
    figures |= {what: max(ticks[name][1] for name in names) for what, names in MOTIONS.items()}
    for arm, (mean, most) in ticks.items():
        print(f"{arm}: {mean} instructions a tick, {most} at most: {1e3 * most / 400e6:.2f} ms at 400 MHz, one a cycle")
    print(f"joints differ from the PC's by {difference:.1e} rad (allowed: {TOLERANCE})")
    for what, figure in figures.items():
        print(f"{what}: {figure} (allowed: {MOST[what]})")
    names = {line.split()[-1] for line in output(["arm-none-eabi-nm", board]).splitlines()}
    unwanted = sorted(filter(FORBIDDEN.fullmatch, names))
    print(f"heap, texts or arithmetic in double: {', '.join(unwanted) or 'none'}")
    if difference > TOLERANCE or unwanted or any(figures[what] > most for what, most in MOST.items()):
        sys.exit("the firmware is not as promised")


def compare(expected: str, said: str) -> float:
    """Largest difference of the joints; the words beside them must be the same."""
    here, there = (
        [line.split() for line in text.splitlines() if line and not line.startswith("#")] for text in (expected, said)
    )
    assert len(here) == len(there) > 0, f"the board said:\n{said}"
    largest = 0.0
    for mine, its in zip(here, there, strict=True):
        if "off" in mine:  # The words of a status, and the error.
            assert mine == its, f"{mine} here, {its} there"
        else:
            differences = (abs(number(a) - number(b)) for a, b in zip(mine[1:], its[1:], strict=True))
            largest = max(largest, *differences)
    return largest


def instructions(said: str) -> dict[str, tuple[int, int]]:
    found = re.findall(r"# (\w+): (\d+) instructions a tick, (\d+) at most", said)
    return {arm: (int(mean), int(most)) for arm, mean, most in found}


def number(bits: str) -> float:
    value: float = struct.unpack(">f", bytes.fromhex(bits))[0]
    return value


def found(pattern: str, text: str) -> str:
    match = re.search(pattern, text)
    assert match, f"no {pattern} in:\n{text}"
    return match[1]


def output(command: list[str]) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=120).stdout


if __name__ == "__main__":
    main(*sys.argv[1:])
