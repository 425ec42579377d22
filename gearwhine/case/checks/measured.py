"""Checks of a case's measured modes against its housing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from gearwhine.case.errors import Finding
from gearwhine.case.model import Draft


def check_measured(draft: Draft) -> Iterator[Finding]:
    """Yield a pairing by the strength between bearing seats and skin, of a housing without seats."""
    housing = draft.document.get("housing")
    if draft.measured is None or not isinstance(housing, Mapping) or draft.names("housing", "seat"):
        return
    if draft.measured.paired_by == "dominance":
        others = "'nearest' or 'order'" + (" or 'shapes'" if draft.measured.has_shapes else "")
        yield Finding(
            ("measured", "pairing"),
            f"{others}: dominance is the strength between bearing seats and skin, and there is no [[housing.seat]]",
        )
