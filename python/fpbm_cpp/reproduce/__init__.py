"""The paper's results from beginning to end: 18 motions, figures, tables, errata and claims.

Imports go one way: paper.json → cases (runs) → tables, figures, claims → report.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ..io.write_whole import write_whole
from .cases import Result, load, run_all
from .claims import Claim, check_claims
from .figures import make_figure, rendered
from .report import TOLERANCE, make_report, summary
from .tables import Table, make_tables

__all__ = ["Reproduction", "reproduce"]


@dataclass(frozen=True)
class Reproduction:
    """All runs, tables and claims, a summary in sentences, and the files written."""

    results: list[Result]
    tables: list[Table]
    claims: list[Claim]
    summary: list[str]
    files: list[Path]

    @property
    def agrees(self) -> bool:
        """Whether every run agrees with the independent solution to TOLERANCE."""
        return max(result.from_reference for result in self.results) <= TOLERANCE


def reproduce(out: Path, say: Callable[[str], None] = lambda step: None) -> Reproduction:
    """Run all of the paper's cases, and write report.md, fig1.png … fig8.png and fig1.pdf … fig8.pdf.

    Parameters
    ----------
    out : pathlib.Path
        Folder to write to, created if it does not exist. Only these 17 files in it are touched; each is written whole
        or not at all.
    say : callable
        Called with a few words at each step.

    Raises
    ------
    OSError
        If a file cannot be written.
    """
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    paper = load()
    say(f"running {len(paper.cases)} cases")
    results = run_all(paper)
    files = []
    for result in sorted((r for r in results if r.case.figure), key=lambda r: r.case.figure):
        say(f"drawing Fig. {result.case.figure}")
        drawn = make_figure(result)
        for kind in ("png", "pdf"):
            files.append(write_whole(out / f"fig{result.case.figure}.{kind}", rendered(drawn, kind)))
    say("checking the claims")
    tables, claims = make_tables(results), check_claims(paper, results)
    files.append(write_whole(out / "report.md", make_report(paper, results, tables, claims).encode()))
    return Reproduction(results, tables, claims, summary(results), files)
