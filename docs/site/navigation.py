"""Navigation at the side of the site's pages: one tree for each folder, in which a page marks its own place.

Sphinx and furo make the tree of all pages anew for each page, which is three quarters of the time of a build. All pages
of a folder have the same one, but for the marks of the page that is shown.
"""

import re
from dataclasses import dataclass, field
from typing import Any

from furo.navigation import get_navigation_tree
from sphinx.application import Sphinx
from sphinx.builders.html import StandaloneHTMLBuilder
from sphinx.environment.adapters.toctree import global_toctree_for_doc

_TAG = re.compile(r'<(/?)(ul|li|a|input)\b(?: class="([^"]*)")?([^>]*)>')
_LINK = re.compile(r' href="([^"]*)"')


@dataclass
class _Element:
    """List or entry that is open while a tree is read: its tag, and that of the entry's checkbox, as spans."""

    kind: str
    span: tuple[int, int]
    checkbox: list[tuple[int, int]] = field(default_factory=list)


class _Tree:
    """Tree of a folder, and for each link the lists and entries around it."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._around: dict[str, tuple[tuple[int, int], list[_Element]]] = {}
        stack: list[_Element] = []
        for tag in _TAG.finditer(text):
            closing, kind = tag[1], tag[2]
            if kind == "input":
                stack[-1].checkbox.append(tag.span())
            elif kind == "a":
                if not closing and (link := _LINK.search(tag[4])):
                    self._around[link[1]] = tag.span(), list(stack)
            elif closing:
                stack.pop()
            else:
                stack.append(_Element(kind, tag.span()))

    def marked(self, link: str) -> str:
        """Return the tree as the page with this link shows it: its entry current, and all around it open."""
        if link not in self._around:
            return self._text
        (start, end), around = self._around[link]
        changes = [(start, end, '<a class="current reference internal" href="#">')]
        for element in around:
            tag = self._text[slice(*element.span)]
            if element.kind == "ul":
                new = '<ul class="current">'
            else:
                new = re.sub(r"toctree-l\d+", r"\g<0> current", tag, count=1)
                if element is around[-1]:
                    new = new.replace('">', ' current-page">')
            changes.append((*element.span, new))
            for box in element.checkbox:
                changes.append((*box, self._text[slice(*box)].replace(" class=", ' checked="" class=')))
        parts, last = [], 0
        for first, after, new in sorted(changes):
            parts += [self._text[last:first], new]
            last = after
        return "".join(parts) + self._text[last:]


_trees: dict[str, _Tree] = {}
_own: dict[str, Any] = {}


def _folder(page: str) -> str:
    return page.rpartition("/")[0]


def _make_trees(builder: StandaloneHTMLBuilder) -> None:
    """Make the trees of all folders, of pages that stand in no tree."""
    for folder in {"", *map(_folder, builder.env.found_docs)}:
        toctree = global_toctree_for_doc(
            builder.env, f"{folder}/-".lstrip("/"), builder, tags=builder.tags, titles_only=True, maxdepth=-1
        )
        _trees[folder] = _Tree(get_navigation_tree(builder.render_partial(toctree)["fragment"]))


def hide_toctree(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: object) -> None:
    """Keep furo from making the tree of a page."""
    _own["toctree"] = context.get("toctree")
    context["toctree"] = lambda **options: ""


def show_tree(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: object) -> None:
    """Put the tree of the page's folder in its place."""
    builder = app.builder
    assert isinstance(builder, StandaloneHTMLBuilder)
    context["toctree"] = _own.pop("toctree")
    if not _trees:  # with the first page, before others are written by processes of their own
        _make_trees(builder)
    context["furo_navigation_tree"] = _trees[_folder(page)].marked(builder.get_target_uri(page).rpartition("/")[2])


def setup(app: Sphinx) -> dict[str, bool]:
    """Stand around furo, which has the priority of 500."""
    app.connect("html-page-context", hide_toctree, priority=400)
    app.connect("html-page-context", show_tree, priority=600)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
