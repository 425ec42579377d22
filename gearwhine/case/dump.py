"""Resolved case as TOML: defaults written out, every quantity with its unit."""

from __future__ import annotations

from typing import Any

import tomli_w

from gearwhine.case.model import Case


def case_document(case: Case) -> dict[str, Any]:
    """Return a case as nested tables and lists with quantities as text; what is None or empty is left out."""
    document = case.model_dump(mode="json", by_alias=True, exclude_none=True)
    return {key: value for key, value in document.items() if value not in ("", [], {})}


def dump_case(case: Case) -> str:
    """Return a case as TOML that loads back to an equal case.

    Quantities are in SI units, or in degrees and rpm where these give back the very same number.
    """
    return tomli_w.dumps(case_document(case))
