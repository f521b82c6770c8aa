"""Checks the sentences of pages, comments and messages for terms to avoid, or draws sentences to read.

  prose.py check                      reports the terms of tools/terms.toml; fails if there is any
  prose.py draw --seed N [--count 20] draws sentences of each kind at random
  prose.py list [KIND]                lists all sentences: doc, comment, error or message

Needs Python 3.11 or later.
"""

from __future__ import annotations

import argparse
import random
import re
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import tomllib
from sentences import COMMENT, DOC, ERROR, MESSAGE, Sentence, all_sentences

TERMS = Path(__file__).with_name("terms.toml")
KINDS = (DOC, COMMENT, ERROR, MESSAGE)
# Names in code fonts, names with an underscore or a scope, calls, members and factors: not words.
CODE = re.compile(r"``[^`]+``|`[^`]+`|[\w.]*(?:\w_|_\w|::\w)[\w.:]*|\b\w+\((?!s\))|\b\w+\.\w+|\w·\w+|\$[^$]+\$")
WORD = re.compile(r"[A-Za-z]{2,}")


@dataclass(frozen=True)
class Term:
    """A term to avoid, its replacement, and the contexts in which the term is right."""

    pattern: str
    use: str
    wrong: str  # A sentence with a finding.
    right: str = ""  # A sentence without a finding.
    allow: list[str] = field(default_factory=list)

    def matches(self, words: str) -> Iterator[str]:
        """The parts of a sentence with masked code that match, outside of allowed contexts."""
        allowed = [match.span() for pattern in self.allow for match in re.finditer(pattern, words)]
        for match in re.finditer(self.pattern, words):
            if not any(begin < match.end() and match.start() < end for begin, end in allowed):
                yield match[0]


@dataclass(frozen=True)
class Place:
    """A phrase of one file in which a term is right, for a reason: a quotation, or the name of an interface."""

    file: str
    phrase: str
    reason: str


@dataclass(frozen=True)
class Finding:
    """A term to avoid in a sentence."""

    sentence: Sentence
    words: str
    use: str

    def __str__(self) -> str:
        at = f"{self.sentence.file}:{self.sentence.line}"
        return f"{at}: '{self.words}' in a {self.sentence.kind}: write {self.use}\n    {self.sentence.text}"


def masked(text: str) -> str:
    """The text with code replaced by a word of the same length, so that a name is not taken for a word."""
    return CODE.sub(lambda match: "Z" * len(match[0]), text)


def read_terms(file: Path = TERMS) -> tuple[list[Term], list[Place]]:
    """The terms to avoid, and the places in which they are right."""
    table = tomllib.loads(file.read_text())
    return [Term(**term) for term in table["term"]], [Place(**place) for place in table.get("place", [])]


def find(sentences: Iterable[Sentence], terms: list[Term], places: list[Place]) -> Iterator[Finding]:
    """The terms to avoid in these sentences, except in the allowed places."""
    for sentence in sentences:
        text = masked(sentence.text)
        for place in places:
            if place.file == sentence.file:
                text = text.replace(masked(place.phrase), "")
        for term in terms:
            yield from (Finding(sentence, words, term.use) for words in term.matches(text))


def draw(sentences: Iterable[Sentence], seed: int, count: int) -> list[Sentence]:
    """Up to `count` sentences of each kind, equal for equal seeds. Texts of few words are left out."""
    kinds: dict[str, list[Sentence]] = {kind: [] for kind in KINDS}
    for sentence in sentences:
        if len(WORD.findall(CODE.sub("", sentence.text))) >= 4:
            kinds[sentence.kind].append(sentence)
    generator = random.Random(seed)
    return [drawn for found in kinds.values() for drawn in generator.sample(found, min(count, len(found)))]


def check() -> int:
    """Prints all findings, and allowed places that no sentence has any more."""
    terms, places = read_terms()
    sentences = list(all_sentences())
    findings = list(find(sentences, terms, places))
    stale = [p for p in places if not any(p.file == s.file and p.phrase in s.text for s in sentences)]
    for finding in findings:
        print(finding, file=sys.stderr)
    for place in stale:
        print(f"{TERMS.name}: {place.file} has no '{place.phrase}': remove this place", file=sys.stderr)
    if findings:
        print(f"{len(findings)} terms to avoid: rewrite the sentences, or see {TERMS.name}", file=sys.stderr)
    return 1 if findings or stale else 0


def main() -> int:
    parser = argparse.ArgumentParser(description="Checks the sentences of pages, comments and messages.")
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("check", help="report terms to avoid")
    drawing = commands.add_parser("draw", help="draw sentences of each kind at random")
    drawing.add_argument("--seed", type=int, required=True, help="equal seeds draw equal sentences")
    drawing.add_argument("--count", type=int, default=20, help="sentences of each kind (default: 20)")
    listing = commands.add_parser("list", help="list all sentences")
    listing.add_argument("kind", nargs="?", choices=KINDS, help="only sentences of this kind")
    options = parser.parse_args()
    if options.command == "check":
        return check()
    if options.command == "draw":
        shown = draw(all_sentences(), options.seed, options.count)
    else:
        shown = [sentence for sentence in all_sentences() if options.kind in (None, sentence.kind)]
    for sentence in shown:
        print(f"{sentence.file}:{sentence.line}: {sentence.kind}: {sentence.text}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
