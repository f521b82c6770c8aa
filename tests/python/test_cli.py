"""The command line, especially its error messages."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import fpbm_cpp as fp

pytest.importorskip("click")
pytest.importorskip("matplotlib")

from click.testing import CliRunner, Result

from fpbm_cpp import reproduce as package
from fpbm_cpp.cli import command

MODULE = [sys.executable, "-m", "fpbm_cpp"]


def call(*arguments: str) -> Result:
    return CliRunner().invoke(command, arguments)


def assert_one_plain_line(text: str, *parts: str) -> None:
    (line,) = text.splitlines()
    assert line.startswith("Error: ")
    assert all(part in line for part in parts)


@pytest.fixture
def reproduction(monkeypatch: pytest.MonkeyPatch) -> package.Reproduction:
    """The paper's runs and tables without its figures."""
    paper = package.load()
    results = [package.Result(case, paper.simulate(case.path, case.scheme)) for case in paper.cases]
    claims = [package.Claim("W is large", "corrected", "0")]
    done = package.Reproduction(results, package.make_tables(results), claims, package.summary(results), [])
    monkeypatch.setattr(package, "reproduce", lambda out, say: say("drawing Fig. 1") or done)
    return done


def test_version() -> None:
    assert call("--version").output == f"fpbm-cpp, version {fp.__version__}\n"


def test_help_has_an_example() -> None:
    result = call("reproduce", "--help")
    assert result.exit_code == 0
    assert "Example: fpbm-cpp reproduce --out reproduction" in result.output
    assert "--out DIR" in result.output


def test_output_of_a_reproduction(reproduction: package.Reproduction) -> None:
    result = call("reproduce", "--out", "somewhere")
    assert result.exit_code == 0
    assert result.stderr == "drawing Fig. 1 ...\n"
    assert all(table.text() in result.stdout for table in reproduction.tables)
    assert "1. W is large: corrected" in result.stdout
    assert "18 cases agree to" in result.stdout
    assert result.stdout.isascii()
    assert max(map(len, result.stdout.splitlines())) <= 100


def test_disagreement_fails(reproduction: package.Reproduction, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(package, "TOLERANCE", 1e-15)
    result = call("reproduce")
    assert result.exit_code == 1
    assert result.stderr.splitlines()[-1].startswith("Error: a motion differs from the independent solution")


def test_directory_is_a_file(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    for out, reason in ((tmp_path / "file", "it is a file"), (tmp_path / "file" / "below", "Not a directory")):
        result = call("reproduce", "--out", str(out))
        assert result.exit_code == 1
        assert_one_plain_line(result.stderr, f"cannot write to {out}: {reason}")
    assert (tmp_path / "file").read_text() == "mine"


def test_directory_with_the_name_of_a_file_is_reported(tmp_path: Path) -> None:
    (tmp_path / "fig1.png").mkdir()
    result = call("reproduce", "--out", str(tmp_path))
    assert result.exit_code == 1
    assert_one_plain_line(result.stderr.splitlines()[-1], "cannot write to", str(tmp_path / "fig1.png"))
    assert [file.name for file in tmp_path.iterdir()] == ["fig1.png"]


@pytest.mark.parametrize(("module", "requirement"), [("matplotlib", "needs matplotlib"), ("click", "needs click")])
def test_missing_extra(module: str, requirement: str, tmp_path: Path) -> None:
    program = (
        f"import sys; sys.modules['{module}'] = None; sys.argv = ['fpbm-cpp', 'reproduce', '--out', 'out']\n"
        "from fpbm_cpp.__main__ import main; sys.exit(main())"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert result.returncode == 1
    assert len(result.stderr.splitlines()) == 1
    assert requirement in result.stderr
    assert 'pip install "fpbm_cpp[cli]"' in result.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_ctrl_c(tmp_path: Path) -> None:
    out = tmp_path / "out"

    def restore_interrupts() -> None:  # Background jobs of a shell ignore SIGINT.
        signal.signal(signal.SIGINT, signal.SIG_DFL)

    start = [*MODULE, "reproduce", "--out", str(out)]
    with subprocess.Popen(start, stderr=subprocess.PIPE, text=True, preexec_fn=restore_interrupts) as process:
        assert process.stderr is not None
        while "drawing" not in process.stderr.readline():
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        last = process.stderr.read().splitlines()[-1]
        assert process.wait(30) == 130
    assert last == "interrupted; every written file is complete"
    assert all(file.suffix in (".png", ".pdf") for file in out.iterdir())
