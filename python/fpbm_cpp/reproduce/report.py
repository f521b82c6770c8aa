"""The report: settings, figures, tables, errata, claims."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .._core import __version__
from ..paths import Circle
from .cases import DT, Erratum, Paper, Result
from .claims import Claim
from .figures import caption
from .tables import Table

TOLERANCE = 1e-9  # Between our runs and the independent solution [rad, rad/s].


def summary(results: Sequence[Result]) -> list[str]:
    """How far the runs are from the independent solution and from the printed numbers."""
    largest = max(r.from_reference for r in results)
    fpbm, man = (max(r.from_printed or 0.0 for r in results if bool(r.case.fpbm) is kind) for kind in (True, False))
    errors = [r.run.max_error() for r in results]
    return [
        f"Independent solution (DOP853, rtol 1e-12): {len(results)} cases, largest difference {largest:.1e} rad or "
        f"rad/s; they {'agree' if largest <= TOLERANCE else 'DO NOT AGREE'} to {TOLERANCE:.0e}.",
        f"Printed final joint velocities: FPBM agrees to {fpbm:.1e} rad/s, MAN to {man:.1e} rad/s (MAN amplifies the "
        f"error of the paper's solver), without {sum(bool(r.case.misprinted_joint) for r in results)} misprints.",
        f"The printed tip errors, about 1e-5 m, are the tolerance of the paper's variable-step solver; ours, "
        f"{min(errors):.0e} m to {max(errors):.0e} m, are round-off.",
    ]


def make_report(paper: Paper, results: Sequence[Result], tables: Sequence[Table], claims: Sequence[Claim]) -> str:
    """The whole report as Markdown; its figures are fig1.png and so on in the same folder."""
    posture = ", ".join(f"{angle:g}°" for angle in np.rad2deg(paper.q0).round(9))
    figures = sorted((r.case.figure, caption(r.case)) for r in results if r.case.figure)
    errata = [
        *(f"{erratum.text} {_both_ways(paper, erratum)}" for erratum in paper.errata),
        *(_misprint(r) for r in results if r.case.misprinted_joint),
        "Remark 2 and the printed tip errors: see the claims.",
    ]
    paragraphs = [
        "# The paper, reproduced",
        paper.source,
        f"Run with fpbm_cpp {__version__}: classical fourth-order Runge–Kutta, fixed steps of {DT:g} s. {paper.arm!r}, "
        f"from rest at q(0) = [{posture}], along {', '.join(map(repr, paper.paths.values()))}.",
        _bullets(summary(results)),
        "## Figures",
        *(f"![Fig. {n}](fig{n}.png)\n\nFig. {n}: {words} ([PDF](fig{n}.pdf))." for n, words in figures),
        "## Tables",
        *(table.markdown() for table in tables),
        "## Errata",
        _bullets(errata),
        "## Claims",
        "\n".join(f"{i}. **{c.statement}: {c.verdict}.** {c.evidence}" for i, c in enumerate(claims, 1)),
    ]
    return "\n\n".join(paragraphs) + "\n"


def _bullets(lines: Sequence[str]) -> str:
    return "\n".join(f"- {line}" for line in lines)


def _misprint(result: Result) -> str:
    case, joint = result.case, result.case.misprinted_joint
    printed, ours = case.printed_qd[joint - 1] if case.printed_qd else np.nan, result.run.qd[-1, joint - 1]
    return (
        f"Text about Fig. {case.figure}: the final velocity of joint {joint}, printed as {printed:.6f} rad/s, is a "
        f"misprint; it is {ours:.6f} rad/s. The other joints agree to {result.from_printed:.0e} rad/s."
    )


def _both_ways(paper: Paper, erratum: Erratum) -> str:
    """How far from the printed numbers the motion of Fig. 2 ends, with the text's value and with ours."""
    case, circle = paper.figure(2), paper.paths["circle"]
    printed = replace(
        paper,
        q0=np.deg2rad(erratum.q0_degrees) if erratum.q0_degrees else paper.q0,
        paths={"circle": Circle(erratum.radius, circle.duration) if erratum.radius else circle},
    )
    text, ours = (Result(case, p.simulate(case.path, case.scheme)).from_printed for p in (printed, paper))
    return (
        f"Fig. 2's final joint velocities are {text:.0e} rad/s off with the text's value, {ours:.0e} rad/s with ours."
    )
