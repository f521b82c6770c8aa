"""The paper end to end: files, numbers, claims, and the independent solution."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from fpbm_cpp.reproduce import TOLERANCE, Reproduction, cases, claims, reproduce

FIGURES = {f"fig{n}.{kind}" for n in range(1, 9) for kind in ("png", "pdf")}


@pytest.fixture(scope="session")
def paper() -> cases.Paper:
    return cases.load()


def reproduced(folder: Path) -> Reproduction:
    return reproduce(folder / "made" / "here")


@pytest.fixture(scope="session")
def done(once, tmp_path_factory: pytest.TempPathFactory) -> Reproduction:
    folder = tmp_path_factory.getbasetemp()
    return once(reproduced, folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder)


@pytest.fixture(scope="session")
def report(done: Reproduction) -> str:
    return (done.files[0].parent / "report.md").read_text("utf-8")


def test_eighteen_cases_agree_with_the_independent_solution(done: Reproduction) -> None:
    assert len(done.results) == 18
    for result in done.results:
        np.testing.assert_allclose(result.run.q[-1], result.case.reference_q, rtol=0, atol=TOLERANCE)
        np.testing.assert_allclose(result.run.qd[-1], result.case.reference_qd, rtol=0, atol=TOLERANCE)
    assert done.agrees


def test_cases_agree_with_the_printed_values(done: Reproduction) -> None:
    for result in done.results:
        if result.from_printed is not None:
            assert result.from_printed < (6e-6 if result.case.fpbm else 6e-4)
        assert result.run.max_error() < 1e-11
    assert {r.case.figure: r.case.misprinted_joint for r in done.results if r.case.misprinted_joint} == {5: 4, 8: 2}


def test_a_disagreement_is_detected(paper: cases.Paper) -> None:
    case = paper.figure(2)
    run = paper.simulate(case.path, case.scheme, q0=paper.q0 + 1e-6)
    assert not Reproduction([cases.Result(case, run)], [], [], [], []).agrees


def test_every_file_is_written_and_nothing_else(done: Reproduction) -> None:
    names = {file.name for file in done.files}
    assert names == FIGURES | {"report.md"}
    assert {file.name for file in done.files[0].parent.iterdir()} == names
    for file in done.files:
        head = file.read_bytes()[:5]
        assert {".png": b"\x89PNG\r", ".pdf": b"%PDF-", ".md": b"# The"}[file.suffix] == head
        assert file.stat().st_size > 5000


def test_figures_have_resolution_for_a_talk(done: Reproduction) -> None:
    for file in done.files:
        if file.suffix == ".png":
            width, height = np.frombuffer(file.read_bytes()[16:24], dtype=">u4")
            assert (width, height) == (1920, 1080)


def test_report_holds_the_numbers(done: Reproduction, report: str) -> None:
    for result in done.results:
        row = " | ".join(f"{v:.6f}" for v in result.run.qd[-1])
        assert f"| ours | {row} |" in report
    for name in FIGURES:
        assert f"({name})" in report
    assert report.count(r"0.006216\*") == 1
    assert report.count(r"0.063234\*") == 1
    assert "is a misprint; the velocity is -0.006214 rad/s" in report
    assert "is a misprint; the velocity is 0.062036 rad/s" in report
    assert all(claim.evidence in report for claim in done.claims)
    assert all(line in report for line in done.summary)
    assert not re.search(r"\bnan\b|\bNone\b", report)


def test_tables_fit_a_terminal(done: Reproduction) -> None:
    for table in done.tables:
        lines = table.text().splitlines()
        assert max(map(len, lines)) <= 100
        assert all(line.isascii() for line in lines)
        assert len({len(row) for row in (table.header, *table.rows)}) == 1


def test_markdown_tables_have_as_many_cells_in_every_row(done: Reproduction) -> None:
    for table in done.tables:
        rows = [line for line in table.markdown().splitlines() if line.startswith("|")]
        assert len({row.count("|") for row in rows}) == 1


def test_table_of_a_case_without_printed_numbers(done: Reproduction) -> None:
    rows = [row[:3] for row in done.tables[2].rows]
    at = [row[0] for row in rows].index("Fig. 7, Tricuspid")
    assert rows[at : at + 2] == [("Fig. 7, Tricuspid", "ours", "0.432711"), ("MAN", "", "")]


def test_claims(done: Reproduction) -> None:
    verdicts = [claim.verdict.split()[0] for claim in done.claims]
    assert verdicts == [
        "confirmed",
        "corrected",
        "confirmed",
        "corrected",
        "corrected",
        "corrected",
        *["confirmed"] * 3,
    ]
    tip, peak, _, weights, rest, _, cure, _, _ = (claim.evidence for claim in done.claims)
    assert "MAN's error reaches 2.9e-04 m, 20 times FPBM's 1.4e-05 m" in tip
    assert "MAN 0.431 (Fig. 1), FPBM 0.305 (Fig. 2)" in peak
    assert done.claims[1].verdict == "corrected (holds only on: circle)"
    assert "W_5 0.066 < W_6 0.084" in weights
    assert "the joints move by 0.66 rad" in rest
    assert "from 0.30 to 2.62 rad/s (circle 13)" in rest
    assert "the joints move by 0.0043 rad" in cure


def test_successive_circles_have_common_ends(paper: cases.Paper, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(claims, "CIRCLES", 3)
    runs = claims.chained(paper, paper.figure(2).scheme)
    assert len(runs) == 3
    for before, after in pairwise(runs):
        np.testing.assert_array_equal(after.q[0], before.q[-1])
        np.testing.assert_array_equal(after.qd[0], before.qd[-1])


@pytest.fixture
def one_figure(paper: cases.Paper, monkeypatch: pytest.MonkeyPatch) -> None:
    """Fig. 2 alone, and no claims: for tests that do not depend on the other figures."""
    only = [replace(case, figure=2 if case.figure == 2 else 0) for case in paper.cases]
    monkeypatch.setattr("fpbm_cpp.reproduce.load", lambda: replace(paper, cases=only))
    monkeypatch.setattr("fpbm_cpp.reproduce.check_claims", lambda paper, results: [])


@pytest.mark.usefixtures("one_figure")
def test_second_run_overwrites_its_own_files_only(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "fig2.png").write_text("old")
    reports: list[str] = []
    first = {file: file.read_bytes() for file in reproduce(tmp_path, say=reports.append).files}
    assert reports == ["running 18 cases", "drawing Fig. 2", "checking the claims"]
    second = {file: file.read_bytes() for file in reproduce(tmp_path).files}
    assert first == second
    assert {file.name for file in tmp_path.iterdir()} == {"notes.txt", "fig2.png", "fig2.pdf", "report.md"}
    assert (tmp_path / "notes.txt").read_text() == "mine"


@pytest.mark.usefixtures("one_figure")
def test_interrupted_run_leaves_complete_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "fig2.png").write_text("old")

    def write_half(file: Path, content: bytes) -> int:
        with file.open("wb") as opened:
            opened.write(content[: len(content) // 2])
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "write_bytes", write_half)
    with pytest.raises(KeyboardInterrupt):
        reproduce(tmp_path)
    assert [file.name for file in tmp_path.iterdir()] == ["fig2.png"]
    assert (tmp_path / "fig2.png").read_text() == "old"
