"""Checks for what a case may already say and only a later version will compute: refused rather than ignored."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from gearwhine.case.draft import Draft
from gearwhine.case.problems import Finding

_FORMS = {"matrix": "5x5 matrix", "rolling": "rolling geometry"}


def check_later(draft: Draft) -> Iterator[Finding]:
    """Yield bearings by matrix or rolling geometry, sound or not."""
    for index, bearing in draft.raw_entries("bearing"):
        for key, forms in (("stiffness", ("matrix", "rolling")), ("damping", ("matrix",))):
            given = bearing.get(key)
            form = next((form for form in forms if isinstance(given, Mapping) and form in given), None)
            if form is not None:
                expected = f"{{ xx, yy, xy, yx }}: {key} by {_FORMS[form]} comes in a later version"
                yield Finding(("bearing", index, key), expected)
