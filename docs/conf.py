"""Settings of Sphinx: `make docs`."""

import sys
from pathlib import Path

import fpbm_cpp

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "extensions"))

project = "fpbm_cpp"
copyright = "2026, the fpbm_cpp authors"
version = release = fpbm_cpp.__version__
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx-mathjax-offline",
    "breathe",
    "sphinxcontrib.programoutput",
    "headers",
    "plain_docstrings",
]
exclude_patterns = ["figures"]

html_theme = "furo"
html_title = f"fpbm_cpp {release}"
html_static_path = ["static"]
html_css_files = ["wide.css"]

highlight_language = "none"  # Default for blocks without a language: output of programs.

# GitHub renders the same syntax: $…$, ```math, links to headings.
myst_enable_extensions = ["dollarmath"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 3

nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 600

# Types are in the docstrings, in words.
autodoc_typehints = "none"
autoclass_content = "both"
autodoc_mock_imports = ["viser"]
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_param = False
napoleon_use_rtype = False
napoleon_custom_sections = [("Attributes", "params_style")]

breathe_projects = {"fpbm": str(HERE.parent / "build" / "doxygen" / "xml")}
breathe_default_project = "fpbm"
breathe_show_include = False

# Names of Eigen, of the standard library and of template parameters have no page here. bench/README.md has a page with
# another name.
nitpicky = True
suppress_warnings = ["duplicate_declaration.cpp"]  # Several headers may declare a namespace.
nitpick_ignore_regex = [("cpp:.*", ".*"), ("myst", r"\.\./README\.md")]


def put_page(app, error):
    """Copies the interactive page, with a link to these pages. If the page was not built, writes a note."""
    page = HERE.parent / "build" / "web" / "page.html"
    words = (
        page.read_text("utf-8") if page.exists() else "<p>The page is missing. Run make page.</p><!--DOCUMENTATION-->"
    )
    link = '<a href="index.html">Documentation</a>. '
    (Path(app.outdir) / page.name).write_text(words.replace("<!--DOCUMENTATION-->", link), "utf-8")


def setup(app):
    app.connect("build-finished", put_page)
