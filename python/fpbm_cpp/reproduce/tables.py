"""Tables of printed values, our values and their differences, as plain text and as Markdown."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import zip_longest

from .cases import NAMES, Case, Result

COLUMNS = "Final joint velocities [rad/s] and largest tip error [m]"


@dataclass(frozen=True)
class Table:
    """A title, a header and rows of text; the first two columns are words, the others numbers."""

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def text(self) -> str:
        """The table for a terminal."""
        widths = [max(map(len, column)) for column in zip(self.header, *self.rows)]
        lines = [
            "  ".join(f"{cell:{'<' if i < 2 else '>'}{width}}" for i, (cell, width) in enumerate(zip(row, widths)))
            for row in (self.header, tuple("-" * width for width in widths), *self.rows)
        ]
        return "\n".join([self.title, COLUMNS, *(line.rstrip() for line in lines)])

    def markdown(self) -> str:
        """The table for report.md."""
        rule = (":--",) * 2 + ("--:",) * (len(self.header) - 2)
        lines = ["| " + " | ".join(row) + " |" for row in (self.header, rule, *self.rows)]
        return "\n".join([f"### {self.title}\n\n{COLUMNS}.\n", *lines]).replace("*", r"\*")


def make_tables(results: Sequence[Result]) -> list[Table]:
    """Table 1, Tables 2 and 3, and the numbers in the text about the figures."""
    return [
        _table(
            "Table 1. Circle, FPBM, W = diag(1, 2, 3, 4), k1 = k2 = 1",
            [r for r in results if r.case.table == "1"],
            lambda case: (f"alpha = {case.fpbm['alpha']}", ""),
        ),
        _table(
            "Tables 2 and 3. Circle, FPBM, alpha = 0.6, k1 = k2 = 1",
            [r for r in results if r.case.table == "2, 3"],
            lambda case: (f"{case.row} =", case.weights),
        ),
        _table(
            "Text about Figs. 1 to 8. FPBM with alpha = 0.6, k1 = k2 = 1; * marks a misprint",
            sorted((r for r in results if r.case.figure), key=lambda r: r.case.figure),
            lambda case: (f"Fig. {case.figure}, {NAMES[case.path]}", f"W = {case.weights}" if case.fpbm else "MAN"),
        ),
    ]


def _table(title: str, results: Sequence[Result], label: Callable[[Case], tuple[str, str]]) -> Table:
    joints = range(1, results[0].run.arm.dof + 1)
    header = ("case", "", *(f"joint {i}" for i in joints), "tip error")
    return Table(title, header, tuple(row for result in results for row in _rows(result, label(result.case))))


def _rows(result: Result, label: tuple[str, str]) -> list[tuple[str, ...]]:
    """Printed values, our values and their differences; only ours where nothing was printed."""
    case, ours, error = result.case, result.run.qd[-1], result.run.max_error()
    rows = [("ours", *(f"{v:.6f}" for v in ours), f"{error:.1e}")]
    if case.printed_qd is not None:
        marks = ["*" if i == case.misprinted_joint else "" for i in range(1, len(ours) + 1)]
        printed = case.printed_error
        errors = ("", "") if printed is None else (f"{printed:.3e}", f"{error - printed:.3e}")
        rows.insert(0, ("printed", *(f"{v:.6f}{mark}" for v, mark in zip(case.printed_qd, marks)), errors[0]))
        rows.append(("difference", *(f"{d:.1e}" for d in ours - case.printed_qd), errors[1]))
    blank = ("",) * len(rows[0])
    return [(word or "", *(row or blank)) for word, row in zip_longest(label, rows)]
