"""Converts docstrings, which are plain text for a terminal, to reStructuredText with the same content."""

from __future__ import annotations

import ast
import inspect
import re
from typing import Any

from sphinx.application import Sphinx

MARKUP = re.compile(r"[*|`\\]|(?<=\w)_(?!\w)")  # Texts like |r|, J_W+ or x* are not markup.
OVERLOAD = re.compile(r"^\d+\. \w+(\(self: .*\)) -> .*$")
SECTION = re.compile(r"^-{3,}$")


def rewrite(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Escapes text that is not markup, and puts summaries of overloads before the first overload's sections."""
    parts: list[tuple[str, list[str]]] = [("", [])]
    for line in lines:
        if found := OVERLOAD.match(line):
            parts.append((bare(found[1]), []))
        elif line != "Overloaded function.":
            parts[-1][1].append(escaped(line))
    if len(parts) == 1:
        lines[:] = parts[0][1]
        return
    (signature, first), *others = parts[1:]
    begin = next((i - 1 for i, line in enumerate(first) if SECTION.match(line)), len(first))
    text = [f"``{signature}``", "", *first[:begin]]
    for signature, other in others:
        text += ["", f"``{signature}``", "", *other]
    lines[:] = [*text, "", *first[begin:]]


def restore(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """If the sentence of a property has a colon, Napoleon reads the words before the colon as its type."""
    if what == "property":
        lines[:] = [*map(escaped, (inspect.getdoc(thing) or "").splitlines()), ""]


def shorten(app: Sphinx, what: str, name: str, thing: Any, options: Any, signature: str | None, returns: Any) -> Any:
    """Removes the annotations of the compiled module from signatures, since docstrings describe the types."""
    return signature and ("()" if signature == "(*args, **kwargs)" else bare(signature), None)


def escaped(line: str) -> str:
    return MARKUP.sub(r"\\\g<0>", line)


def bare(signature: str) -> str:
    """Names and defaults alone."""
    try:
        function = ast.parse(f"def f{signature}: ...").body[0]
    except SyntaxError:
        return signature
    assert isinstance(function, ast.FunctionDef)
    arguments = function.args
    for argument in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs):
        argument.annotation = None
    if arguments.args and arguments.args[0].arg == "self":
        del arguments.args[0]
    return f"({ast.unparse(arguments)})"


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("autodoc-process-docstring", rewrite, priority=400)  # Before napoleon, which writes markup,
    app.connect("autodoc-process-docstring", restore, priority=600)  # and after it.
    app.connect("autodoc-process-signature", shorten)
    return {"parallel_read_safe": True}
