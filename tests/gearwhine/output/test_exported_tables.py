"""Tables as CSV: every number that a page tells is there with all its digits, as in the summary."""

import csv
import json
from pathlib import Path
from shutil import copytree, ignore_patterns
from typing import Any

import pytest

import gearwhine as gw
from gearwhine.failures import DamagedResultsError
from gearwhine.output.export import _csv
from gearwhine.output.manifest import MANIFEST
from gearwhine.output.sections import Column, Table
from gearwhine.results.sweep import sections
from gearwhine.results_folder import export_results, write_report

pytestmark = pytest.mark.usefixtures("few_reliefs_tried")
THIRD = 1.0 / 3.0


def rows_of(text: str) -> list[list[str]]:
    return list(csv.reader(text.splitlines()))


def test_numbers_are_written_whatever_the_page_shows() -> None:
    columns = (
        Column("name", "name"),
        Column("force [N]", "force_n", "z.1f", shown=lambda row: f"about {row['force_n']:.1f}"),
        Column("share", "share", shown=lambda row: f"{100 * row['share']:.0f} %"),
        Column("place x, y [mm]", "position_m", ".2f", 1e3),
        Column("second [mm]", "position_m.1", ".2f", 1e3),
        Column("largest", lambda row: f"{row['peak']['of']:.2g} at {row['peak']['at_hz']:.0f} Hz", numbers=("peak",)),
        Column("kind", "kind", shown=lambda row: row["kind"].upper()),
        Column("good", "good"),
    )
    first = {"name": "a", "force_n": THIRD, "share": THIRD, "position_m": [THIRD, 2.0 * THIRD], "good": True}
    first |= {"peak": {"of": THIRD, "at_hz": 7.0 * THIRD}, "kind": "bent"}
    second = first | {"name": "b", "force_n": 2, "position_m": [THIRD], "good": False}
    table = Table(columns, (first, second))
    headings, one, other = rows_of(_csv(table))
    assert headings == [
        "name",
        "force [N]",
        "share (share)",
        "place x [mm]",
        "place y [mm]",
        "second [mm]",
        "largest",
        "peak of",
        "peak at_hz",
        "kind",
        "good",
    ]
    numbers = [THIRD, THIRD, 1e3 * THIRD, 2e3 * THIRD, 2e3 * THIRD]
    assert one[0] == "a"
    assert [float(cell) for cell in one[1:6]] == numbers
    assert one[6:] == ["0.33 at 2 Hz", repr(THIRD), repr(7.0 * THIRD), "BENT", "yes"]
    assert (other[1], other[4], other[5]) == ("2", "", "")
    # The page is as it was.
    assert table.filled()[1][0] == ["a", "about 0.3", "33 %", "333.33, 666.67", "666.67", "0.33 at 2 Hz", "BENT", "yes"]


def test_components_without_a_name_each_are_counted() -> None:
    """Three numbers under two names, and names that the heading has none of."""
    rows = ({"place": [1.0, 2.0, 3.0]},)
    table = Table((Column("x, y [mm]", "place"), Column("place [m, peak]", "place")), rows)
    headings = rows_of(_csv(table))[0]
    assert headings == [f"{heading} {number}" for heading in ("x, y [mm]", "place [m, peak]") for number in (1, 2, 3)]


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Tables of rotors, gears and coupled modes of the bundled pair."""
    folder = tmp_path_factory.mktemp("tables")
    study = gw.load("spur-pair")
    study.rotors().write(folder, pictures=False)
    study.gears().write(folder, pictures=False)
    study.system().write(folder, pictures=False)
    export_results(folder, ("csv",))
    return folder


def table_rows(folder: Path, part: str) -> list[dict[str, str]]:
    (path,) = (folder / "exports").glob(f"*{part}*.csv")
    return list(csv.DictReader(rows_text(path)))


def rows_text(path: Path) -> list[str]:
    return path.read_text(encoding="utf-8").splitlines()


def summary(folder: Path, command: str) -> dict[str, Any]:
    found = [json.loads(path.read_text(encoding="utf-8")) for path in folder.rglob("summary.json")]
    (document,) = [one for one in found if one["command"] == command]
    return dict(document)


def test_roll_angles_and_sliding_have_all_digits(exported: Path) -> None:
    (pair,) = summary(exported, "gears")["pairs"]
    rows = table_rows(exported, "Path-of-contact")
    for row, point in zip(rows, pair["path_of_contact"], strict=True):
        for side in ("driver", "driven"):
            for key in (f"{side}_roll_angle_rad", f"{side}_specific_sliding"):
                (cell,) = (value for heading, value in row.items() if heading.endswith(f"({key})"))
                assert float(cell) == point[key]


def test_reactions_and_strain_have_all_digits(exported: Path) -> None:
    rotor = summary(exported, "rotors")["rotors"][0]
    rows = table_rows(exported, f"{rotor['name']}-Under-its-weight")
    for row, bearing in zip(rows, rotor["static"]["bearings"], strict=True):
        assert [float(row["x [N]"]), float(row["y [N]"])] == bearing["load_n"][:2]
    rows = table_rows(exported, f"{rotor['name']}-Turning")
    whirl = rotor["whirl"][0]
    for row, decrement, strained in zip(rows, whirl["log_decrement"], whirl["most_strained"], strict=False):
        assert float(row["log decrement (log_decrement)"]) == decrement
        assert float(row["strained.share"]) == strained["share"]


def test_responses_to_a_micrometre_of_error_are_in_the_unit_that_their_row_names(exported: Path) -> None:
    (response,) = summary(exported, "system")["transmissibility"]
    rows = {row["at"]: row for row in table_rows(exported, "system-Coupled-system-peak-amplitude-of")}
    for name, peaks in response["mesh_force_n"].items():
        row = rows[name]
        assert row["peak amplitude of"] == "mesh force [N/µm]"
        for place, peak in enumerate(peaks[:4]):
            assert float(row[f"peaks.{place}.frequency_hz"]) == peak["frequency_hz"]
            # By an error of one metre in the document.
            assert float(row[f"peaks.{place}.amplitude"]) == pytest.approx(1e-6 * peak["amplitude"])


def test_a_missed_peak_has_both_speeds_and_what_peaks() -> None:
    peak = {"settings": {}, "below_rpm": 3000.0, "above_rpm": 4200.0, "line": "1x", "mode": "housing"}
    peak |= {"frequency_hz": 900.0, "speed_rpm": 3600.0, "half_width_rpm": 20.0, "rise_db": 9.0}
    sensor = peak | {"output": "right wall", "level_db": 140.0, "rms_m_per_s2": 10.0}
    document = {
        "points": [],
        "resumed": 0,
        "failed": 0,
        "done": 0,
        "missed_peaks": [sensor, peak | {"output": "sound", "level_db": 80.0}],
        "speeds_to_add_rpm": [3600.0],
        "over_with_peaks": "",
    }
    (table,) = [part for part in sections(document)[0].content if isinstance(part, Table)]
    headings, *rows = rows_of(_csv(table))
    found = [dict(zip(headings, row, strict=True)) for row in rows]
    assert [row["between [rpm]"] for row in found] == ["3000 and 4200"] * 2
    assert [(float(row["below_rpm"]), float(row["above_rpm"])) for row in found] == [(3000.0, 4200.0)] * 2
    assert [row["estimate"] for row in found] == ["right wall 10 m/s²", "L_W 80.0 dB"]
    assert [float(row["level_db"]) for row in found] == [140.0, 80.0]
    assert [row["rms_m_per_s2"] for row in found] == ["10.0", ""]


def test_results_of_another_build_are_refused(exported: Path, tmp_path: Path) -> None:
    """A folder whose documents lack a quantity, as a build of the same version left it, ends in a sentence."""
    # Without the list of its files, which would tell that one is changed.
    folder = copytree(exported, tmp_path / "old", ignore=ignore_patterns(MANIFEST, "exports"))
    for path in folder.rglob("summary.json"):
        document = json.loads(path.read_text(encoding="utf-8"))
        for pair in document["pairs"] if document["command"] == "gears" else ():
            del pair["contact_ratio"]
        path.write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(DamagedResultsError, match=r"a result has no .*another build.*run its command again"):
        export_results(folder, ("csv",))
    with pytest.raises(DamagedResultsError, match="a result has no"):
        write_report(folder)
