"""Sobol' indices as they are shown: how many samples they want, and tables that are whole."""

import io
import re

import numpy as np
from rich.console import Console

from gearwhine.numerics.distributions import Uniform
from gearwhine.numerics.sampling import index_points
from gearwhine.output.sections import Column, Table
from gearwhine.output.terminal import _fitting
from gearwhine.results.variation import sections, varied_document
from gearwhine.variation.inputs import Input
from gearwhine.variation.quantities import Evaluation
from gearwhine.variation.statistics import VariedResult

ERROR = "gear_pair.pinion-wheel.transmission_error_peak_to_peak_m"
LEVEL = "sensor.top.level_db"


def study(rows: int) -> VariedResult:
    """Gearboxes whose error is of the first input, and whose level is of both."""
    design = index_points(rows, ((0,), (1,)), 1)
    found = [
        Evaluation({ERROR: float(1e-6 * x), LEVEL: float(100.0 + x + 0.7 * y + x * y)})
        for x, y in design.points.tolist()
    ]
    inputs = tuple(Input(f"gear.{name}.tip_relief.amount", Uniform(0.0, 1.0), "um", (), ()) for name in ("one", "two"))
    return VariedResult(inputs, design.points, design.points, found[0], tuple(found), {}, np.zeros(0), design, 0)


def test_as_many_samples_as_are_advised_give_the_intervals() -> None:
    (few,) = [one for one in varied_document(study(32))["warnings"] if "few samples" in one.values()]
    advised = int(re.search(r"some (\d+) in place of 32", few["message"])[1])  # type: ignore[index]
    assert advised & (advised - 1) == 0
    widths = [np.ptp(one.indices.total_interval, axis=1).max() for one in study(advised).quantities]  # type: ignore[union-attr]
    assert max(widths) < 0.2
    widths = [np.ptp(one.indices.total_interval, axis=1).max() for one in study(advised // 4).quantities]  # type: ignore[union-attr]
    assert max(widths) > 0.2


def test_errors_are_ranked_beside_levels_and_each_row_says_what_it_is_of() -> None:
    document = varied_document(study(32))
    assert document["headlines"] == [ERROR, LEVEL]
    tables = [one for one in sections(document)[0].content if isinstance(one, Table)]
    (matters,) = [one for one in tables if one.caption.startswith("What matters")]
    _, rows = matters.filled()
    assert [row[0] for row in rows] == ["pinion-wheel"] * 2 + ["sensor top"] * 2
    assert {row[2] for row in rows} == {"gear.one.tip_relief.amount", "gear.two.tip_relief.amount"}


def test_a_key_is_whole_on_a_narrow_terminal() -> None:
    columns = (Column("key", "key"), Column("words", "words"))
    row = {"key": "gear.pinion.errors.helix.slope", "words": "a column that wraps at its spaces"}
    written = io.StringIO()
    console = Console(file=written, width=36)
    console.print(*_fitting(console, Table(columns, [row], ""), 0))
    first = [line[: line.index("  ", 2)] if "  " in line[2:] else line for line in written.getvalue().splitlines()]
    assert "gear.pinion.errors.helix.slope" in "".join(one.strip() for one in first)
