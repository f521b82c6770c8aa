"""Finds the sentences of the repository: its pages, its comments, and the texts that programs show.

tools/prose.py reads the sentences. Comments and string literals of C++ and JavaScript are found by one regular
expression, and comments and strings of Python by the parser of Python.
"""

from __future__ import annotations

import ast
import io
import re
import subprocess
import tokenize
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from html.parser import HTMLParser
from pathlib import Path

ROOT = Path(__file__).parent.parent
# Kinds of sentences. A message is a text that a program shows; an error is a message of an exception.
DOC, COMMENT, ERROR, MESSAGE = "doc", "comment", "error", "message"
# Files that a program writes, and the sentences of tools/terms.toml itself.
GENERATED = re.compile(r"^(bench/results/|docs/results/|tools/terms\.toml|web/package-lock|.*/(_core\.pyi|LICENSE)$)")
HASH_FILES = re.compile(r"(^|/)(Makefile|CMakeLists\.txt|run|\.clang-tidy|\.gitignore)$|\.(cmake|in|sh|toml|ya?ml|ld)$")
TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)
      | R"(?P<mark>[^()\\\s]*)\((?P<raw>.*?)\)(?P=mark)"
      | "(?P<text>(?:\\.|[^"\\\n])*)"
      | (?<!\w)'(?P<single>(?:\\.|[^'\\\n])*)'  # A character, or a string of JavaScript; not 1'000.
      | `(?P<template>(?:\\.|[^`\\])*)`""",
    re.DOTALL | re.VERBOSE,
)
# Begins a call that throws, in C++ and in Python.
THROWS = re.compile(
    r"\b(?:fail|reject\w*|require\w*|(?:invalid_argument|out_of_range|runtime_error)|raise \w+|wrong)\("
)
NEXT_MESSAGE = re.compile(r"[;{}&]|py::|\bdef\b|==")  # Ends a message that is built of several literals.
END = re.compile(r"(?<!e\.g\.)(?<!i\.e\.)(?<!et al\.)(?<!vs\.)(?<=[.!?])[\"”)*_]*\s+(?=[A-Z0-9`\"“(\[*_{|])")
PROSE = re.compile(r"(?:^|[\s(“])[A-Za-z][\w'’-]*[,:;]? (?:[\w'’-]+[,:;]? )?[a-z'’-]+")  # Not paths or formats.
ESCAPES = {r"\n": "\n", r"\t": " ", r"\"": '"', r"\'": "'", r"\\": "\\"}


@dataclass(frozen=True)
class Sentence:
    """A sentence, a heading or a cell of a table."""

    file: str
    line: int
    kind: str
    text: str


Lines = list[tuple[int, str]]  # Lines of one paragraph, with their numbers.


def all_sentences() -> Iterator[Sentence]:
    """The sentences of every file that git has or would add."""
    listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listed, cwd=ROOT, check=True, capture_output=True, text=True).stdout.splitlines()
    for name in sorted(set(names)):
        if (ROOT / name).is_file() and reader(name):
            yield from sentences(name, (ROOT / name).read_text())


def sentences(name: str, text: str) -> Iterator[Sentence]:
    """The sentences of a file with this name, which decides how to read the text."""
    read = reader(name)
    for kind, lines in read(text) if read else ():
        if not (kind in (ERROR, MESSAGE) and name.startswith("tests/")):  # Tests repeat messages and name cases.
            yield from _split(name, kind, lines)


def reader(name: str) -> Callable[[str], Iterator[tuple[str, Lines]]] | None:
    """The function that finds the paragraphs of a file; None if the file has no prose."""
    if GENERATED.match(name):
        return None
    if HASH_FILES.search(name):
        return _hash_comments
    by_suffix = {".md": _pages, ".rst": _pages, ".py": _python, ".html": _html}
    by_suffix |= dict.fromkeys((".hpp", ".cpp", ".h", ".js", ".mjs", ".css"), _braces)
    return by_suffix.get(Path(name).suffix)


def _split(name: str, kind: str, lines: Lines) -> Iterator[Sentence]:
    """Splits a paragraph into sentences, each with the line of its first word."""
    text, starts = "", []
    for number, line in lines:
        starts.append((len(text), number))
        text += line.strip() + " "
    begin = 0
    for end in [*(match.end() for match in END.finditer(text)), len(text)]:
        if sentence := text[begin:end].strip():
            yield Sentence(name, max(number for start, number in starts if start <= begin), kind, sentence)
        begin = end


def _paragraphs(lines: Lines) -> Iterator[Lines]:
    """Splits lines at empty lines, headings and items of a list; without code, links' addresses and rules."""
    paragraph: Lines = []
    fence = ""
    for number, line in lines:
        stripped = line.strip()
        if mark := re.match(r"```+|~~~+", stripped):
            fence = "" if fence else mark[0]
        item = re.match(r"([-*+]|\d+\.|#+|>>>|\.\.|:|@\w+|\|)(\s|:|$)", stripped)
        if paragraph and (item or mark or not stripped):
            yield paragraph
            paragraph = []
        if fence or mark or re.match(r"(>>>|\.\. |:\w+:|::|%)|\W*$", stripped):
            continue
        words = re.sub(r"^([-*+]|\d+\.|#+)\s+", "", re.sub(r"(?<=\])\([^)\s]*\)|<!--.*?-->", "", stripped))
        if words.startswith("|"):
            yield from ([(number, cell)] for cell in re.split(r"(?<!\\)\|", words.strip("|")) if cell.strip())
        else:
            paragraph.append((number, words))
    if paragraph:
        yield paragraph


def _pages(text: str) -> Iterator[tuple[str, Lines]]:
    """Markdown and reStructuredText. A front matter and HTML comments are not shown, so they are not read."""
    hidden = re.compile(r"\A---\n.*?\n---\n|<!--.*?-->", re.DOTALL)
    text = hidden.sub(lambda match: "\n" * match[0].count("\n"), text)
    yield from ((DOC, lines) for lines in _paragraphs(list(enumerate(text.splitlines(), 1))))


def _comments(found: list[tuple[int, int, str, bool]]) -> Iterator[tuple[str, Lines]]:
    """Joins comments of one column on consecutive lines: (line, column, text, whether code precedes the comment)."""
    block: Lines = []
    before = (-1, -1)
    for number, column, text, trailing in found:
        if block and (number != before[0] + 1 or column != before[1] or (trailing and text[:1].isupper())):
            yield from ((COMMENT, lines) for lines in _paragraphs(block))
            block = []
        if not re.match(r"\s*(clang-format|NOLINT|noqa|type: ignore|!|===|pragma|shellcheck)", text):
            block.append((number, text))
        before = (number, column)
    yield from ((COMMENT, lines) for lines in _paragraphs(block))


def _braces(text: str) -> Iterator[tuple[str, Lines]]:
    """Languages with the comments of C: C++, JavaScript and CSS."""
    found: list[tuple[int, int, str, bool]] = []
    messages: list[tuple[str, Lines]] = []  # Kind and literals.
    end = 0  # End of the last literal.
    for token in TOKEN.finditer(text):
        number = text.count("\n", 0, token.start()) + 1
        start = text.rfind("\n", 0, token.start()) + 1
        if comment := token["comment"]:
            for i, line in enumerate(comment.removesuffix("*/").splitlines()):
                words = re.sub(r"^\s*(/{2,}[!<]*|/?\*+)( (?=\S))?", "", line)
                found.append((number + i, token.start() - start, words, bool(text[start : token.start()].strip())))
            continue
        literal = next((token[name] for name in ("raw", "text", "single", "template") if token[name] is not None), "")
        literal = re.sub(r"\$\{[^}]*\}", "…", re.sub(r"\\.", lambda match: ESCAPES.get(match[0], ""), literal))
        between = text[end : token.start()]
        if messages and not NEXT_MESSAGE.search(between) and len(between) < 120:
            messages[-1][1].append((number, ("…" if between.strip() else "") + literal))
        else:
            call = re.split(r"[;{}]", text[max(start - 200, end) : token.start()])[-1]
            messages.append((ERROR if THROWS.search(call) else MESSAGE, [(number, literal)]))
        end = token.end()
    yield from _comments(found)
    yield from (paragraph for kind, parts in messages for paragraph in _message(parts, kind))


def _message(parts: Lines, kind: str = MESSAGE) -> Iterator[tuple[str, Lines]]:
    """The paragraphs of a text that a program shows; none if its words are not a sentence."""
    joined = "".join(part for _, part in parts)
    if PROSE.search(joined):
        lines = [(parts[0][0] + i, line) for i, line in enumerate(joined.splitlines())]
        yield from ((kind, paragraph) for paragraph in _paragraphs(lines))


def _python(text: str) -> Iterator[tuple[str, Lines]]:
    """Comments, docstrings and string literals of Python."""
    tree = ast.parse(text)
    shown: list[tuple[int, str, str]] = []  # Line, text and kind.
    inside: set[ast.AST] = set()  # Docstrings, and parts of f-strings.
    thrown = {id(part) for node in ast.walk(tree) if isinstance(node, ast.Raise) for part in ast.walk(node)}
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)) and node.body:
            first = node.body[0]
            if isinstance(first, ast.Expr) and isinstance(doc := first.value, ast.Constant):
                inside.add(doc)
                if isinstance(doc.value, str):
                    lines = list(enumerate(doc.value.splitlines(), doc.lineno))
                    yield from ((COMMENT, paragraph) for paragraph in _paragraphs(lines))
        elif isinstance(node, ast.JoinedStr):
            inside.update(node.values)
            words = (part.value if isinstance(part, ast.Constant) else "…" for part in node.values)
            shown.append((node.lineno, "".join(map(str, words)), ERROR if id(node) in thrown else MESSAGE))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in inside:
            shown.append((node.lineno, node.value, ERROR if id(node) in thrown else MESSAGE))
    for number, literal, kind in sorted(shown):
        yield from _message([(number, literal)], kind)
    comments = (
        token for token in tokenize.generate_tokens(io.StringIO(text).readline) if token.type == tokenize.COMMENT
    )
    yield from _comments(
        [(*c.start, c.string.lstrip("#").removeprefix(" "), bool(c.line[: c.start[1]].strip())) for c in comments]
    )


def _hash_comments(text: str) -> Iterator[tuple[str, Lines]]:
    """Comments after #, texts that make prints, and descriptions of parameters in YAML files."""
    found = []
    for number, line in enumerate(text.splitlines(), 1):
        if comment := re.search(r"""^([^"'#]*(?:"[^"]*"[^"'#]*|'[^']*'[^"'#]*)*(?<!\S))#+ ?([^#].*)""", line):
            found.append((number, comment.start(2), comment[2], bool(comment[1].strip())))
        elif shown := re.search(r"""(?:@echo|description:|description =|message\([A-Z_]+) *["'](.*)["']""", line):
            yield from _message([(number, shown[1])])
    yield from _comments(found)


class _Shown(HTMLParser):
    """Collects the texts of a web page, and the attributes that are shown or read aloud."""

    def __init__(self) -> None:
        super().__init__()
        self.found: Lines = []
        self._code = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._code = tag in ("script", "style")
        shown = (value for name, value in attrs if name in ("aria-label", "title", "placeholder", "alt") and value)
        self.found += [(self.getpos()[0], value) for value in shown]

    def handle_data(self, data: str) -> None:
        if not self._code and data.strip():
            self.found.append((self.getpos()[0], data))


def _html(text: str) -> Iterator[tuple[str, Lines]]:
    """Texts of a web page."""
    page = _Shown()
    page.feed(text)
    for line in page.found:
        yield from _message([line])
