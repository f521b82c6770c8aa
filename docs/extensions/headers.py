"""The directive `headers`: the declarations of all headers of a folder, with a section for each header."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.statemachine import StringList
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from sphinx.util.nodes import nested_parse_with_titles

INCLUDE = Path(__file__).parents[2] / "cpp" / "include" / "fpbm"

SECTIONS = (
    "briefdescription detaileddescription innerclass innernamespace enum func typedef var"
    " public-type public-func public-attrib public-static-func public-static-attrib user-defined"
)


class Headers(SphinxDirective):
    required_arguments = 1  # The folder of the headers, in INCLUDE.

    def run(self) -> list[nodes.Node]:
        headers = sorted((INCLUDE / self.arguments[0]).glob("*.hpp"))
        if not headers:
            raise self.error(f"no *.hpp files in {INCLUDE / self.arguments[0]}: name a folder of headers in {INCLUDE}")
        lines = StringList()
        for header in headers:
            self.env.note_dependency(str(header))
            name = header.relative_to(INCLUDE).as_posix()
            for line in (name, "-" * len(name), "", f".. doxygenfile:: {header.name}", f"   :sections: {SECTIONS}", ""):
                lines.append(line, *self.get_source_info())
        section = nodes.section(document=self.state.document)
        nested_parse_with_titles(self.state, lines, section)
        return section.children


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_directive("headers", Headers)
    return {"parallel_read_safe": True}
