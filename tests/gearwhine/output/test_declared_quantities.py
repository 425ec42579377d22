"""One declaration of a quantity and what is made of it: the document, the arrays of the file, the cells of a table."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.output.dataset import arrays_of, labelled, labels_of
from gearwhine.output.quantity import ABSENT, HERTZ, RPM, Part, Quantity, Rows, document_of
from gearwhine.output.report import Contents, report_page
from gearwhine.output.report.elements import in_cell
from gearwhine.output.sections import Column, Section, Table, columns_of, percent


@dataclass(frozen=True)
class Wheel:
    name: str
    rate: float | None
    lines: tuple[float, ...]


WHEELS = (Wheel("small", 2.0 * math.pi * 50.0, (3.0, 1.0)), Wheel("large", None, (2.0,)))
FIELDS = (
    Rows(
        "wheels",
        lambda wheels: wheels,
        (
            Quantity("name", lambda one: one.name, "wheel", heading="wheel"),
            Quantity(
                "speed_rpm",
                lambda one: one.rate,
                "speed",
                (),
                "rad s-1",
                "speed of the wheel",
                document=lambda rate: rate * RPM,
                heading="speed [krpm]",
                shown=".1f",
                scale=1e-3,
            ),
            Quantity("", lambda one: np.array(one.lines), "line", ("number",), "m"),
            Quantity("", lambda _: np.array([10.0, 20.0]), "number", ("number",), common=True),
            Quantity("remark", lambda one: ABSENT if one.rate else "stands"),
        ),
        dimension="wheel",
    ),
    Part("nothing", lambda _: None, ()),
)


def test_one_turn_in_a_second_is_sixty_in_a_minute_and_one_hertz() -> None:
    turn = 2.0 * math.pi
    assert turn * RPM == pytest.approx(60.0, rel=1e-15)
    assert turn / HERTZ == pytest.approx(1.0, rel=1e-15)


def test_the_document_has_its_own_units_and_says_what_there_is_not() -> None:
    document = document_of(FIELDS, WHEELS)
    small, large = document["wheels"]
    assert small["speed_rpm"] == pytest.approx(3000.0, rel=1e-12)
    assert large == {"name": "large", "speed_rpm": None, "remark": "stands"}
    assert "remark" not in small
    assert document["nothing"] is None


def test_arrays_have_si_units_and_nothing_where_there_is_nothing() -> None:
    found = arrays_of(FIELDS, WHEELS)
    dimensions, speeds, attributes = found["speed"]
    assert dimensions == ("wheel",)
    assert attributes == {"units": "rad s-1", "long_name": "speed of the wheel"}
    np.testing.assert_allclose(np.asarray(speeds, dtype=float), [WHEELS[0].rate, np.nan])
    dimensions, lines, _ = found["line"]
    assert dimensions == ("wheel", "number")
    np.testing.assert_allclose(np.asarray(lines), [[3.0, 1.0], [2.0, np.nan]])
    # What all rows share stands once, as the coordinate along its own dimension.
    assert found["number"][0] == ("number",)
    np.testing.assert_allclose(np.asarray(found["number"][1]), [10.0, 20.0])


def test_the_speed_beside_every_result_is_in_its_unit() -> None:
    case = gw.load("spur-pair").case
    assert case.operation is not None
    _, value, attributes = labelled(labels_of(case)).scalars["speed"]
    assert attributes["units"] == "rpm"
    assert gw.rpm(float(np.asarray(value))) == pytest.approx(case.operation.speed, rel=1e-12)


def test_a_table_shows_the_scaled_number_and_leaves_out_what_no_row_has() -> None:
    rows = tuple(document_of(FIELDS, WHEELS)["wheels"])
    table = Table((*columns_of(FIELDS[0].fields), Column("weight", "weight")), rows)  # type: ignore[union-attr]
    kept, texts = table.filled()
    assert [column.heading for column in kept] == ["wheel", "speed [krpm]"]
    assert texts == [["small", "3.0"], ["large", ""]]


@pytest.mark.parametrize(("part", "said"), [(0.0, "0 %"), (5e-5, "less than 0.01 %"), (0.25, "25 %"), (1.0, "100 %")])
def test_a_part_is_said_in_percent(part: float, said: str) -> None:
    assert percent(part) == said


@pytest.mark.parametrize(
    ("text", "cell"),
    [
        ("1× pinion 1 -> wheel 1", "1× pinion\xa01\xa0→ wheel\xa01"),
        ("housing mode 19 (2664 Hz)", "housing mode\xa019 (2664\xa0Hz)"),
        ("1.0, -2.0, 3.0", "1.0, -2.0, 3.0"),
        ("19: -149 %", "19: -149\xa0%"),
        ("2 of 3 <b>", "2 of\xa03 &lt;b&gt;"),
    ],
)
def test_a_cell_breaks_between_names_not_within(text: str, cell: str) -> None:
    assert in_cell(text) == cell


def test_numbers_stand_to_the_right_and_words_to_the_left(tmp_path: object) -> None:
    from pathlib import Path

    place = Path(str(tmp_path))
    (place / "summary.json").write_text("{}", encoding="utf-8")
    table = Table((Column("wheel", "name"), Column("mass", "mass", ".1f")), ({"name": "a", "mass": 1.0},))
    page = report_page(place, Contents(lambda _: (Section("Wheels", (table,)),)))
    assert '<th scope="col" class="text">wheel</th><th scope="col">mass</th>' in page
    assert '<td class="text">a</td><td>1.0</td>' in page
