"""Cells of CSV files: names are no formulas, numbers stay numbers."""

import csv

import pytest

from gearwhine.output.csv_cells import plain_cell
from gearwhine.output.export import _csv
from gearwhine.output.sections import Column, Table


@pytest.mark.parametrize(
    "name",
    [
        "=1+1",
        "@SUM(A1)",
        "+cmd",
        "-2+3",
        "-1+cmd|' /C calc'!A0",
        "+1 =A1",
        "\t=A1",
        "\r=A1",
        "-",
        "+A1",
        "-1 (x)",
        "=-1",
    ],
)
def test_a_name_that_is_a_formula_is_a_text(name: str) -> None:
    assert plain_cell(name) == f"'{name}"


@pytest.mark.parametrize(
    "cell",
    ["-1", "+2.5", "-1.5e-07", "+.5", "-inf", "-3.41 %", "+12 Hz at 3 rpm", "", "a=b", "top", "1-2", -1.5, 3, None],
)
def test_numbers_and_plain_names_stay(cell: object) -> None:
    assert plain_cell(cell) == cell


def test_a_table_has_both() -> None:
    table = Table(
        (Column("name", "name"), Column("force [N]", "force_n", ".0f")), ({"name": "=HYPERLINK(1)", "force_n": -2.5},)
    )
    assert list(csv.reader(_csv(table).splitlines())) == [["name", "force [N]"], ["'=HYPERLINK(1)", "-2.5"]]
