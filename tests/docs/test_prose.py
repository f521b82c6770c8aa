"""tools/prose.py finds the sentences of every kind of file, and the terms to avoid in them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

TOOLS = Path(__file__).parents[2] / "tools"
sys.path.insert(0, str(TOOLS))

import prose  # noqa: E402
import sentences  # noqa: E402

TERMS, PLACES = prose.read_terms()


def found(name: str, text: str) -> list[tuple[int, str, str]]:
    return [(sentence.line, sentence.kind, sentence.text) for sentence in sentences.sentences(name, text)]


def findings(name: str, text: str) -> list[str]:
    return [finding.words for finding in prose.find(sentences.sentences(name, text), TERMS, PLACES)]


def test_pages() -> None:
    page = """---
front: matter
---
# Joint limits

The arm stops. Every joint keeps
its bounds, see [Limits](limits.md).

<!-- Not shown. -->
- One item, e.g. A joint
- Another item

```cpp
the code of a block();
```

| term | meaning |
|---|---|
| tick | one cycle, `a` |
"""
    assert found("docs/page.md", page) == [
        (4, "doc", "Joint limits"),
        (6, "doc", "The arm stops."),
        (6, "doc", "Every joint keeps its bounds, see [Limits]."),
        (10, "doc", "One item, e.g. A joint"),
        (11, "doc", "Another item"),
        (17, "doc", "term"),
        (17, "doc", "meaning"),
        (19, "doc", "tick"),
        (19, "doc", "one cycle, `a`"),
    ]


def test_cpp() -> None:
    source = """#include "fpbm/core/types.hpp"
/// The first sentence, which
/// has two lines. The second.
///
/// - An item.
int count = 1'000;  // Trailing "quotes" are part of it.
/* A block
 * of two lines. */
// clang-format off
const char* path = "a/b // no comment";
void check() {
  reject(argument, " has ", size, " entries: must "
         "have one");
  raise(R"(A raw "string" of words)");
  const char quote = '"';  // Not the start of a string.
}
"""
    assert found("cpp/include/a.hpp", source) == [
        (2, "comment", "The first sentence, which has two lines."),
        (3, "comment", "The second."),
        (5, "comment", "An item."),
        (6, "comment", 'Trailing "quotes" are part of it.'),
        (7, "comment", "A block of two lines."),
        (15, "comment", "Not the start of a string."),
        (10, "message", "a/b // no comment"),
        (12, "error", "has … entries: must have one"),
        (14, "message", 'A raw "string" of words'),
    ]
    assert not [sentence for sentence in found("tests/cpp/a.cpp", source) if sentence[1] in ("error", "message")]


def test_javascript() -> None:
    source = """const text = 'The arm is at rest.'; // A comment.
const other = `The tip moves ${fast(1)} times as fast.`;
"""
    assert found("web/a.js", source) == [
        (1, "comment", "A comment."),
        (1, "message", "The arm is at rest."),
        (2, "message", "The tip moves … times as fast."),
    ]


def test_python() -> None:
    source = '''"""The module. It has
two sentences."""

# A comment
# of two lines.
def check(dt):  # Trailing.
    """A function.

    >>> no.sentence
    """
    raise ValueError(f"dt = {dt}: must be positive, "
                     "and a finite number")

KEY = "not_prose"
'''
    assert found("python/a.py", source) == [
        (1, "comment", "The module."),
        (1, "comment", "It has two sentences."),
        (7, "comment", "A function."),
        (11, "error", "dt = …: must be positive, and a finite number"),
        (4, "comment", "A comment of two lines."),
        (6, "comment", "Trailing."),
    ]


def test_other_files() -> None:
    assert found("Makefile", "lint: all  # Runs all.\n\t@echo 'make lint   checks of style'\n") == [
        (2, "message", "make lint   checks of style"),
        (1, "comment", "Runs all."),
    ]
    page = '<p title="The title of it">A text of words</p><script>let no = "prose of it";</script>'
    assert [text for _, _, text in found("web/a.html", page)] == ["The title of it", "A text of words"]
    assert sentences.reader("docs/circle.png") is None
    assert sentences.reader("python/fpbm_cpp/_core.pyi") is None


@pytest.mark.parametrize("term", TERMS, ids=lambda term: term.use)
def test_terms(term: prose.Term) -> None:
    assert list(term.matches(prose.masked(term.wrong)))
    assert not list(term.matches(prose.masked(term.right)))


def test_planted_terms() -> None:
    assert findings("docs/a.md", "The arm stops at once.") == ["at once"]
    assert findings("cpp/include/a.hpp", "int a;  // The least way out.") == ["way"]
    assert findings("cpp/include/a.hpp", 'throw Error("dt = ", dt, ": wanted is a positive number");') == ["wanted"]
    assert findings("python/a.py", 'raise ValueError(f"{name}: is out of reach of the arm")') == ["out of reach"]
    assert findings("docs/a.md", "The member `way` and way(v), s·way, one_way and a.way are names.") == []


def test_places() -> None:
    place = prose.Place("docs/a.md", "in this way", "A quotation.")
    said = list(sentences.sentences("docs/a.md", "“The arm moves in this way.” No other way exists."))
    assert [finding.words for finding in prose.find(said, TERMS, [place])] == ["way"]


def test_draw_repeats() -> None:
    page = "\n\n".join(f"This is sentence number {i}." for i in range(100))
    said = list(sentences.sentences("docs/a.md", page))
    drawn = prose.draw(said, 1, 20)
    assert len(set(drawn)) == 20
    assert drawn == prose.draw(said, 1, 20) != prose.draw(said, 2, 20)


def test_command() -> None:
    run = subprocess.run(
        [sys.executable, TOOLS / "prose.py", "draw", "--seed", "1", "--count", "2"],
        check=True,
        capture_output=True,
        text=True,
    )
    assert [line.split(": ")[1] for line in run.stdout.splitlines()] == [k for k in prose.KINDS for _ in range(2)]
