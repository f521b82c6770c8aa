"""Reproduction of the paper's results: 18 motions, figures, tables, errata and claims."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ..files import write_whole
from .cases import Result, load, of_figures
from .claims import Claim, check_claims
from .report import TOLERANCE, Table, make_figure, make_report, make_tables, rendered, summary

__all__ = ["Reproduction", "reproduce"]


@dataclass(frozen=True)
class Reproduction:
    """All runs, tables and claims, a summary in sentences, and the written files."""

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
    """Run all of the paper's cases, and write report.md, fig1.png … fig8.png and fig1.pdf … fig8.pdf to a folder.

    A missing folder is created. Only these 17 files in the folder change; each is written completely or not at all.
    say is called with a short text at each step. Raises OSError if a file cannot be written.
    """
    out.mkdir(parents=True, exist_ok=True)
    paper = load()
    say(f"running {len(paper.cases)} cases")
    results = [Result(case, paper.simulate(case.path, case.scheme)) for case in paper.cases]
    files = []
    for result in of_figures(results):
        say(f"drawing Fig. {result.case.figure}")
        drawn = make_figure(result)
        for kind in ("png", "pdf"):
            files.append(write_whole(out / f"fig{result.case.figure}.{kind}", rendered(drawn, kind)))
    say("checking the claims")
    tables, claims = make_tables(results), check_claims(paper, results)
    files.append(write_whole(out / "report.md", make_report(paper, results, tables, claims).encode()))
    return Reproduction(results, tables, claims, summary(results), files)
