"""Results of several commands in one folder: each stands by itself, and the newest is told first."""

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

import gearwhine as gw
from gearwhine.case import Case
from gearwhine.output import json_text, store
from gearwhine.output.store import store_results, stored_results


@pytest.fixture(scope="module")
def case() -> Case:
    return gw.load("spur-pair").case


def keep(command: str, case: Case, folder: Path, content: str) -> dict[str, Any]:
    document: dict[str, Any] = {"content": content}
    store_results(command, document, case, folder, lambda place: _write(place, content))
    return document


def _write(place: Path, content: str) -> None:
    (place / "own.txt").write_text(content, encoding="utf-8")


@pytest.mark.parametrize("has_links", [True, False])
def test_commands_keep_to_themselves_and_a_run_takes_the_folder(
    case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, has_links: bool
) -> None:
    def refuse(*_: object) -> None:
        raise OSError("this file system has no links")

    if not has_links:
        monkeypatch.setattr(store.os, "link", refuse)
    moments = iter(f"2026-01-0{day}T10:00:00+00:00" for day in range(1, 9))
    monkeypatch.setattr(store, "_now", lambda: next(moments))
    out = tmp_path / "out"
    assert set(keep("gears", case, out, "first")["files"]) == {"case.toml", "own.txt", "summary.json"}
    keep("rotors", case, out, "second")
    assert (out / "own.txt").read_text(encoding="utf-8") == "first"
    assert (out / "rotors" / "own.txt").read_text(encoding="utf-8") == "second"
    assert keep("run", case, out, "third")["moved"] == {"command": "gears", "to": (out / "gears").as_posix()}
    texts = {place: (out / place / "own.txt").read_text(encoding="utf-8") for place in ("", "gears", "rotors")}
    assert texts == {"": "third", "gears": "first", "rotors": "second"}
    assert [document["command"] for _, document in stored_results(out)] == ["run", "rotors", "gears"]
    # Once more: it replaces its own alone.
    assert "moved" not in keep("gears", case, out, "fourth")
    assert (out / "gears" / "own.txt").read_text(encoding="utf-8") == "fourth"
    assert (out / "own.txt").read_text(encoding="utf-8") == "third"
    assert [document["command"] for _, document in stored_results(out)] == ["gears", "run", "rotors"]


def test_the_summary_is_the_document_with_what_it_was_made_of(case: Case, tmp_path: Path) -> None:
    document = keep("gears", case, tmp_path / "out", "first")
    kept = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert kept == document
    assert (kept["command"], kept["content"], kept["folder"]) == ("gears", "first", str(tmp_path / "out"))
    assert all((tmp_path / "out" / name).is_file() for name in kept["files"])


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
        lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    )
)
def test_json_is_the_document_whatever_its_texts(document: object) -> None:
    assert json.loads(json_text({"document": document})) == {"document": document}


def test_what_fits_on_a_line_stands_on_one() -> None:
    line = {"frequency_hz": 2567.0, "amplitude": 1.5}
    text = json_text({"lines": [line] * 9, "long": {"words": "x" * 200, "curve": [1.0] * 99}})
    assert '  {"frequency_hz": 2567.0, "amplitude": 1.5},' in text.splitlines()
    assert max(len(row) for row in text.splitlines() if '"curve"' not in row and "xxx" not in row) <= 160
    assert len(text.splitlines()) == 17


def test_lists_of_numbers_stand_on_one_line() -> None:
    text = json_text({"speeds": [1.5, 2, None], "name": "[\n 1,\n 2\n]", "rows": [{"n": 1}]})
    assert '"speeds": [1.5, 2, null]' in text
    assert json.loads(text)["name"] == "[\n 1,\n 2\n]"
