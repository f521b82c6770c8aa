"""Docstrings are plain text to be read in a terminal: here they become reStructuredText that says the same."""

from __future__ import annotations

import ast
import re
from typing import Any

from sphinx.application import Sphinx

MARKUP = re.compile(r"[*|`\\]|(?<=\w)_(?!\w)")


def escape(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """No |r|, J_W+ or x* is markup."""
    lines[:] = [MARKUP.sub(r"\\\g<0>", line) for line in lines]


def bare(app: Sphinx, what: str, name: str, thing: Any, options: Any, signature: str | None, returns: str | None) -> Any:
    """Arguments and defaults without the compiled module's annotations, which docstrings say better."""
    if not signature:
        return None
    try:
        arguments = ast.parse(f"def f{signature}: ...").body[0].args
    except SyntaxError:
        return None
    for argument in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs):
        argument.annotation = None
    arguments.args = [argument for argument in arguments.args if argument.arg != "self"]
    return f"({ast.unparse(arguments)})", None


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("autodoc-process-docstring", escape, priority=400)  # Before napoleon, which writes markup.
    app.connect("autodoc-process-signature", bare)
    return {"parallel_read_safe": True}
