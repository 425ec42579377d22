"""The documentation site: `make docs` builds it with Sphinx, furo and MyST from the pages as they stand in the tree.

The source folder is the root of the repository, so that README, change log and the pages in `docs` link each other here
as they do anywhere else. What is made while building goes to `docs/reference` and `docs/gallery`, which git ignores.
"""

import re
import sys
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.ext.napoleon.docstring import NumpyDocstring

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "docs" / "site")]

import gallery  # noqa: E402
import generated_pages  # noqa: E402
import python_pages  # noqa: E402

import gearwhine  # noqa: E402

project = "Gearwhine"
author = "The Gearwhine developers"
release = gearwhine.__version__
language = "en"

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton", "mathml", "navigation"]

root_doc = "docs/index"
# Nothing else of the tree is read, whatever lies in it.
include_patterns = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "benchmarks/README.md", "docs/**"]
exclude_patterns = ["docs/site/**"]
suppress_warnings = [
    # The annotation `GearPair` is that of its module; Sphinx also finds those of others.
    "ref.python",
]

myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 4

autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True
maximum_signature_line_length = 90
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False
# Quotes in tables and messages are what a user types.
smartquotes = False
# In docstrings a single backtick is code, as in Markdown.
default_role = "literal"

html_theme = "furo"
html_title = "Gearwhine"
html_static_path = ["site/static"]
html_css_files = ["gearwhine.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_copyright = False
# Summaries are fetched page by page, which a browser refuses to pages that are opened from a folder.
html_show_search_summary = False

_ARRAYS = {
    "ndarray[tuple[Any, ...], dtype[float64]]": "FloatArray",
    "ndarray[tuple[Any, ...], dtype[complex128]]": "ComplexArray",
}
_pages_of: dict[str, list[str]] = {}
_START = """\
<!doctype html><meta charset="utf-8"><title>Gearwhine</title>
<meta http-equiv="refresh" content="0; url=docs/index.html"><a href="docs/index.html">Gearwhine</a>
"""


def write_pages(app: Sphinx) -> None:
    """Write the pages that no one writes by hand."""
    global _pages_of
    gallery.write_gallery(ROOT, ROOT / "docs" / "gallery", python_pages.ROOMS)
    _pages_of = python_pages.write_pages(ROOT, ROOT / "docs" / "reference")


def fill_page(app: Sphinx, name: str, source: list[str]) -> None:
    """Set the tables that are made of schema, commands and validation at the marks of a page."""
    if name in generated_pages.FILLED:
        source[0] = generated_pages.FILLED[name](source[0])


def generated_names(
    app: Sphinx, env: BuildEnvironment, added: set[str], changed: set[str], removed: set[str]
) -> list[str]:
    """Pages to be read in every build, since what they are made of has changed unseen."""
    return list(generated_pages.FILLED)


def find_public_name(
    app: Sphinx, env: BuildEnvironment, node: nodes.Element, shown: nodes.Element
) -> nodes.Element | None:
    """Link a name to its page, whichever package's docstring has it: the front door's names are those of the rooms."""
    name = node["reftarget"].rpartition(".")[2]
    homes = _pages_of.get(name, [])
    if node.get("refdomain") != "py" or len(homes) != 1:
        return None
    domain = env.domains.python_domain
    return domain.resolve_xref(env, node["refdoc"], app.builder, "obj", f"{homes[0]}.{name}", node, shown)


def whole_attribute(self: NumpyDocstring) -> tuple[str, list[str]]:
    """Read the docstring of an attribute as prose: what stands before its first colon is no type."""
    lines = self._dedent(self._consume_to_end())
    return "", self.__class__(lines, self._config).lines()


NumpyDocstring._consume_inline_attribute = whole_attribute


def name_arrays(
    app: Sphinx, what: str, name: str, obj: object, options: object, *texts: str | None
) -> tuple[str | None, ...]:
    """Write the types of arrays in a signature as the code does."""
    named = []
    for text in texts:
        for found, written in _ARRAYS.items():
            text = text.replace(found, written) if text else text
        named.append(text)
    return tuple(named)


def keep_bars(app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    """Take ``|x|`` in prose for an amount, as a reader does, and not for a substitution."""
    literal = False
    for place, line in enumerate(lines):
        indented = line.startswith((" ", "\t")) or not line.strip()
        literal = literal and indented
        if not literal and "``" not in line:
            lines[place] = re.sub(r"(?<!\\)\|", r"\\|", line)
        literal = literal or line.rstrip().endswith("::")


def add_start(app: Sphinx, failure: Exception | None) -> None:
    """Lead from the folder of the site to its first page."""
    if failure is None and app.builder.format == "html":
        (Path(app.outdir) / "index.html").write_text(_START, encoding="utf-8")


def setup(app: Sphinx) -> None:
    """Connect what happens while building."""
    app.connect("builder-inited", write_pages)
    app.connect("env-get-outdated", generated_names)
    app.connect("source-read", fill_page)
    app.connect("missing-reference", find_public_name)
    app.connect("autodoc-process-signature", name_arrays)
    app.connect("autodoc-process-docstring", keep_bars)
    app.connect("build-finished", add_start)
