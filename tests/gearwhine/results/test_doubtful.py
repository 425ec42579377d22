"""Warnings of a command gathered in its document."""

from gearwhine.numerics.result_warnings import warning
from gearwhine.output.quantity import add_warnings, joined


def test_each_message_stands_once_and_every_document_has_the_list() -> None:
    document: dict[str, object] = {"title": "none"}
    add_warnings(document)
    assert document["warnings"] == []
    add_warnings(document, [warning("load", "too high", load_n=3.0), warning("load", "too high")])
    assert document["warnings"] == [{"name": "load", "message": "too high", "load_n": 3.0}]


def test_joined_documents_keep_the_warnings_of_all() -> None:
    gears = {"pairs": [1], "warnings": [warning("teeth", "undercut")]}
    housing = {"reused": False, "warnings": [warning("mesh", "coarse")]}
    found = joined({"title": "both"}, gears, housing, {"reused": True})
    assert [entry["message"] for entry in found["warnings"]] == ["undercut", "coarse"]
    assert (found["title"], found["pairs"], found["reused"]) == ("both", [1], True)
