"""The report: settings, figures, tables, errata, claims."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from io import BytesIO
from itertools import zip_longest
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from .._core import __version__
from ..paths import Circle
from ..plot import plot_run
from .cases import DT, NAMES, Case, Paper, Result, of_figures
from .claims import Claim

TOLERANCE = 1e-9  # Between our runs and the independent solution [rad, rad/s].
PANELS = ("arm", "axis_errors", "velocities", "accelerations")
COLUMNS = "Final joint velocities [rad/s] and largest tip error [m]"


def caption(case: Case) -> str:
    """Caption: path, scheme and parameters."""
    if not case.fpbm:
        return f"{NAMES[case.path]} under MAN: minimum acceleration norm, no feedback"
    p = case.fpbm
    gains = f"k₁ = {p['k1']:g} s⁻¹, k₂ = {p['k2']:g} s⁻²"
    return f"{NAMES[case.path]} under FPBM: α = {p['alpha']}, W = {case.weights}, {gains}"


def make_figure(result: Result) -> Figure:
    """The figure of a case; the paper's figures of the tricuspid have no accelerations."""
    title = f"Fig. {result.case.figure}   {caption(result.case)}"
    return plot_run(result.run, title, PANELS[:3] if result.case.path == "tricuspid" else PANELS)


def rendered(drawn: Figure, kind: str) -> bytes:
    """The figure as 'png' or 'pdf', with reproducible bytes."""
    file = BytesIO()
    drawn.savefig(file, format=kind, metadata={"CreationDate": None} if kind == "pdf" else None)
    drawn.set_layout_engine("none")  # The second file has the layout of the first.
    return file.getvalue()


@dataclass(frozen=True)
class Table:
    """A title, a header and rows of text; the first two columns are words, all others are numbers."""

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
    groups = {
        "Table 1. Circle, FPBM, W = diag(1, 2, 3, 4), k1 = k2 = 1": [r for r in results if r.case.table == "1"],
        "Tables 2 and 3. Circle, FPBM, alpha = 0.6, k1 = k2 = 1": [r for r in results if r.case.table == "2, 3"],
        "Text about Figs. 1 to 8. FPBM with alpha = 0.6, k1 = k2 = 1; * marks a misprint": of_figures(results),
    }
    header = ("case", "", *(f"joint {i}" for i in range(1, results[0].run.arm.dof + 1)), "tip error")
    labels: tuple[Callable[[Case], tuple[str, str]], ...] = (
        lambda case: (f"alpha = {case.fpbm['alpha']}", ""),
        lambda case: (f"{case.row} =", case.weights),
        lambda case: (f"Fig. {case.figure}, {NAMES[case.path]}", f"W = {case.weights}" if case.fpbm else "MAN"),
    )
    return [
        Table(title, header, tuple(row for result in group for row in _rows(result, label(result.case))))
        for (title, group), label in zip(groups.items(), labels)
    ]


def _rows(result: Result, label: tuple[str, str]) -> list[tuple[str, ...]]:
    """Printed values, our values and their differences; only our values without printed values."""
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


def summary(results: Sequence[Result]) -> list[str]:
    """Differences of the runs from the independent solution and from the printed numbers."""
    largest = max(r.from_reference for r in results)
    fpbm, man = (max(r.from_printed or 0.0 for r in results if bool(r.case.fpbm) is kind) for kind in (True, False))
    errors = [r.run.max_error() for r in results]
    return [
        f"Independent solution (DOP853, rtol 1e-12): {len(results)} cases "
        f"{'agree' if largest <= TOLERANCE else 'DO NOT AGREE'} to {TOLERANCE:.0e}, with a largest difference of "
        f"{largest:.1e} rad or rad/s.",
        f"Printed final joint velocities: FPBM agrees to {fpbm:.1e} rad/s, MAN to {man:.1e} rad/s (MAN amplifies the "
        f"error of the paper's solver), without {sum(bool(r.case.misprinted_joint) for r in results)} misprints.",
        "The printed tip errors, about 1e-5 m, are the tolerance of the paper's variable-step solver; the tip "
        f"errors of this package, {min(errors):.0e} m to {max(errors):.0e} m, are round-off.",
    ]


def make_report(paper: Paper, results: Sequence[Result], tables: Sequence[Table], claims: Sequence[Claim]) -> str:
    """The whole report as Markdown; its figures are fig1.png and so on in the same folder."""
    posture = ", ".join(f"{angle:g}°" for angle in np.rad2deg(paper.q0).round(9))
    figures = [(r.case.figure, caption(r.case)) for r in of_figures(results)]
    errata = [
        *(f"{erratum['text']} {_both_ways(paper, erratum)}" for erratum in paper.errata),
        *(_misprint(r) for r in results if r.case.misprinted_joint),
        "Remark 2 and the printed tip errors: see the claims.",
    ]
    paragraphs = [
        "# The paper, reproduced",
        paper.source,
        f"Run with fpbm_cpp {__version__}: classical fourth-order Runge–Kutta, fixed steps of {DT:g} s. {paper.arm!r}, "
        f"from rest at q(0) = [{posture}], along {', '.join(map(repr, paper.paths.values()))}.",
        "\n".join(f"- {line}" for line in summary(results)),
        "## Figures",
        *(f"![Fig. {n}](fig{n}.png)\n\nFig. {n}: {words} ([PDF](fig{n}.pdf))." for n, words in figures),
        "## Tables",
        *(table.markdown() for table in tables),
        "## Errata",
        "\n".join(f"- {line}" for line in errata),
        "## Claims",
        "\n".join(f"{i}. **{c.statement}: {c.verdict}.** {c.evidence}" for i, c in enumerate(claims, 1)),
    ]
    return "\n\n".join(paragraphs) + "\n"


def _misprint(result: Result) -> str:
    case, joint = result.case, result.case.misprinted_joint
    printed, ours = case.printed_qd[joint - 1] if case.printed_qd else np.nan, result.run.qd[-1, joint - 1]
    return (
        f"Text about Fig. {case.figure}: the final velocity of joint {joint}, printed as {printed:.6f} rad/s, is a "
        f"misprint; the velocity is {ours:.6f} rad/s. The other joints agree to {result.from_printed:.0e} rad/s."
    )


def _both_ways(paper: Paper, erratum: Mapping[str, Any]) -> str:
    """Difference of the motion of Fig. 2 from the printed numbers, for the text's value and this package's value."""
    case, circle = paper.figure(2), paper.paths["circle"]
    q0 = np.deg2rad(erratum["q0_degrees"]) if "q0_degrees" in erratum else paper.q0
    if "radius" in erratum:
        circle = Circle(erratum["radius"], circle.duration)
    printed = replace(paper, q0=q0, paths={"circle": circle})
    text, ours = (Result(case, p.simulate(case.path, case.scheme)).from_printed for p in (printed, paper))
    return (
        f"The final joint velocities of Fig. 2 differ by {text:.0e} rad/s for the text's value, by {ours:.0e} rad/s "
        "for the value of this package."
    )
