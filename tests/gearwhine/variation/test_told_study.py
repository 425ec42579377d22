"""What a study of varied gearboxes tells first, on samples made by hand: each number is one that the hand counts."""

import json
from pathlib import Path

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.case.load import bundled_case
from gearwhine.case.variation import Limit
from gearwhine.cli import run_command
from gearwhine.numerics.distributions import Normal
from gearwhine.output.sections import Document, Table
from gearwhine.results.first_page import first_page
from gearwhine.results.variation import sections, varied_document
from gearwhine.variation.inputs import Input
from gearwhine.variation.quantities import Evaluation
from gearwhine.variation.statistics import VariedResult

LEVEL, SPEED = "sensor.top.level_db", "sensor.top.loudest_speed_rpm"
RPM = 30.0 / np.pi
SPEEDS = np.array([-2000.0, -2500.0, -3000.0]) / RPM


def told(levels: np.ndarray, values: np.ndarray | None = None, limit: float | None = None) -> VariedResult:
    """A study of gearboxes with these levels over three speeds, (n, 3), and inputs (n, d)."""
    inputs = np.zeros((len(levels), 1)) if values is None else values
    law = Normal(0.0, 1.0)
    names = [f"gear.pinion.errors.e{number}" for number in range(inputs.shape[1])]
    found = [
        Evaluation({LEVEL: float(row.max()), SPEED: float(-RPM * SPEEDS[row.argmax()])}, {LEVEL: row})
        for row in np.asarray(levels, dtype=float)
    ]
    return VariedResult(
        inputs=tuple(Input(name, law, "um", (), (), "class 7") for name in names),
        points=np.zeros_like(inputs),
        values=inputs,
        nominal=found[0],
        outcomes=tuple(found),
        limits={} if limit is None else {LEVEL: Limit(at_most=limit)},
        speeds=SPEEDS,
        design=None,
        resumed=0,
    )


def shown(document: Document) -> tuple[list[str], dict[str, list[dict[str, str]]]]:
    """Sentences of a study, and the rows of its tables by the first words of their captions."""
    tables, sentences = {}, []
    for item in sections(document)[0].content:
        if isinstance(item, Table):
            columns, rows = item.filled()
            named = [dict(zip([column.heading for column in columns], row, strict=True)) for row in rows]
            tables[" ".join(item.caption.split()[:2]).rstrip(";,")] = named
        else:
            sentences.append(str(item))
    return sentences, tables


TEN = np.array([[90.0, 91.0 + number, 92.0 - number] for number in range(10)])


def test_the_study_begins_with_the_gearboxes_beyond_each_limit_and_the_worst() -> None:
    document = {"command": "vary"} | varied_document(told(TEN, limit=97.5))
    sentences, tables = shown(document)
    # Levels 92, 92, 93, ..., 100: of ten three are above 97.5. Interval of 7 of 10 by Clopper and Pearson.
    assert sentences[0] == "Yield: 7 of 10 gearboxes are within all limits, 70.0 % (34.8 to 93.3 %)."
    (row,) = tables["Gearboxes beyond"]
    assert (row["of"], row["limit"], row["beyond"]) == ("sensor top", "≤ 97.5", "3 of 10")
    worst = tables["Worst gearboxes"]
    assert [(one["gearbox"], one["value"], one["at [rpm]"]) for one in worst] == [
        ("9", "100", "2500"),
        ("8", "99", "2500"),
        ("7", "98", "2500"),
    ]
    assert "3 speeds of the first driver: 2000 to 3000 rpm." in sentences
    (key,) = tables["Varied keys"]
    assert key["tolerance"] == "class 7"
    first = first_page(None, [document], [])[0]
    assert first.title == "Varied gearboxes in short"
    assert str(first.content[0]) == sentences[0]


@pytest.mark.parametrize(
    ("written", "words"),
    [
        ({"class": 7}, "class 7"),
        ({"fit": "k6"}, "fit k6"),
        ({"normal": ["12 um", "2 um"], "within": ["6 um", "18 um"]}, "normal 12 um ± 2 um, within 6 um to 18 um"),
        ({"uniform": ["1 mm", "2 mm"]}, "uniform 1 mm to 2 mm"),
        ({"values": ["C2", "C3"]}, "C2, C3"),
    ],
)
def test_a_tolerance_is_told_as_the_case_gives_it(written: dict[str, object], words: str) -> None:
    from gearwhine.case.variation import Varied

    assert Varied.model_validate(written).words == words


def test_the_case_of_the_worst_gearbox_has_the_level_of_its_title_when_it_is_opened(tmp_path: Path) -> None:
    """The level is that of the lines which `system` finds of the case as it stands."""
    bundled = bundled_case("small-gearbox")
    assert bundled is not None
    path, out = tmp_path / "case.toml", tmp_path / "out"
    text = '[variation]\nsamples = 2\nanalyses = ["lines"]\nspeed = ["2500 rpm", "4000 rpm"]\n'
    text += 'vary = { "gear.*.errors.helix.slope" = { class = 7, independent = true } }\n'
    path.write_text(bundled.read_text() + text)
    command = ["vary", str(path), "-o", str(out), "--set", "housing.box.mesh_size=60 mm", "-q", "--workers", "1"]
    assert run_command(command) == 0
    rows = json.loads((out / "summary.json").read_text())["worst"]
    worst = next(row for row in rows if row["quantity"] == LEVEL)
    study = gw.load(out / f"worst-{LEVEL}-1.toml")
    lines = study.system().document["mesh_lines"]
    sizes = [line["sensor_acceleration_m_per_s2"]["together"]["top"] for line in lines]
    level = 20.0 * np.log10(np.sqrt(0.5 * np.sum(np.square(sizes))) / 1e-6)
    assert level == pytest.approx(worst["value"], abs=1e-3)
    assert study.case.operation is not None
    assert abs(study.case.operation.speed) * RPM == pytest.approx(worst["speed_rpm"])
    assert f"{worst['value']:.6g} at {worst['speed_rpm']:.5g} rpm" in study.case.title
    assert f"{worst['speed_rpm']:.5g} rpm" in study.case.notes
