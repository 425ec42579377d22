"""A ring that bolts hold from turning, `fixed.bolts` of a set: its table, results of `load`, refusals at keys."""

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from planetary_case import stage

import gearwhine as gw
from gearwhine.case import CaseError, dump_case, parse_case
from gearwhine.case.checks.whole_case import warnings_of
from gearwhine.output.sections import Table
from gearwhine.results.operating_point import sections

BOLTS: dict[str, Any] = {
    "circle": "220 mm",
    "angles": ["0 deg", "120 deg", "240 deg"],
    "tangential_stiffness": ["4e8 N/m", "1e8 N/m", "2e8 N/m"],
    "radial_stiffness": "1e8 N/m",
}


def bolted(**changes: Any) -> dict[str, Any]:
    """The stage whose ring has no bearing but the bolts."""
    document = stage(fixed={"member": "r", "bolts": BOLTS | changes})
    document["bearing"] = [one for one in document["bearing"] if one["rotor"] != "ring"]
    return document


def test_a_stiffness_is_of_every_bolt_or_of_each() -> None:
    case = parse_case(bolted())
    machine = case.parts.machine
    assert machine is not None
    (support,) = machine.torque_supports
    assert (support.shaft, support.at, support.stiffness) == ("ring", 0.03, None)
    assert [bolt.radius for bolt in support.bolts] == [0.11] * 3
    assert [bolt.angle for bolt in support.bolts] == pytest.approx([0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0])
    assert [(bolt.tangential, bolt.radial, bolt.axial) for bolt in support.bolts] == [
        (4e8, 1e8, 0.0),
        (1e8, 1e8, 0.0),
        (2e8, 1e8, 0.0),
    ]
    assert not [told for told in warnings_of(case) if "floats freely" in told]
    again = parse_case(tomllib.loads(dump_case(case)))
    assert again.planetary == case.planetary


def _loaded(document: dict[str, Any], folder: Path) -> Any:
    path = folder / "case.toml"
    path.write_text(dump_case(parse_case(document)), encoding="utf-8")
    return gw.load(path).operating_point()


def test_load_has_the_force_on_every_bolt(tmp_path: Path) -> None:
    result = _loaded(bolted(), tmp_path)
    rows = result.document["support_bolts"]
    assert [row["angle_rad"] for row in rows] == pytest.approx([0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0])
    tangential = np.array([row["tangential_force_n"] for row in rows])
    # Sun 24 and ring 84: the ring holds 50 N m · 84 / 24, on a circle of 110 mm.
    assert abs(0.110 * tangential.sum()) == pytest.approx(50.0 * 84.0 / 24.0, rel=1e-6)
    assert np.ptp(tangential) > 0.2 * np.abs(tangential).max()
    in_file = result.dataset["support_bolt_tangential_force"]
    assert (in_file.dims, in_file.attrs["units"]) == (("support_bolt",), "N")
    ring = rows[0]["shaft"]
    np.testing.assert_allclose(in_file.sel(support_bolt=[f"{ring} {number}" for number in (1, 2, 3)]), tangential)
    np.testing.assert_allclose(result.dataset["support_bolt_angle"], [0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0])
    (table,) = (
        part
        for section in sections(result.document)
        for part in section.content
        if isinstance(part, Table) and part.caption == "Forces on the bolts of torque supports"
    )
    assert [row[1:4] for row in table.filled()[1]] == [
        [f"{degrees}°", f"{row['radial_force_n']:.0f}", f"{row['tangential_force_n']:.0f}"]
        for degrees, row in zip((0, 120, 240), rows, strict=True)
    ]
    without = _loaded(stage(), tmp_path)
    assert "support_bolts" not in without.document
    assert "support_bolt" not in without.dataset.dims


@pytest.mark.parametrize(
    ("changes", "key", "expected"),
    [
        ({"tangential_stiffness": ["1e8 N/m"]}, "tangential_stiffness", "one for each of 3 bolts, or one for all"),
        ({"radial_stiffness": ["1e8 N/m"] * 4}, "radial_stiffness", "one for each of 3 bolts"),
        ({"tangential_stiffness": "0 N/m"}, "tangential_stiffness", "above 0"),
        ({"circle": "0 mm"}, "circle", "above 0"),
    ],
)
def test_no_such_bolts(changes: dict[str, Any], key: str, expected: str) -> None:
    with pytest.raises(CaseError) as refused:
        parse_case(bolted(**changes))
    assert f"planetary[0].fixed.bolts.{key}" in str(refused.value)
    assert expected in str(refused.value)


def test_bolts_have_their_own_stiffness() -> None:
    with pytest.raises(CaseError, match="none beside 'bolts', which have their own"):
        parse_case(stage(fixed={"member": "r", "bolts": BOLTS, "stiffness": "1e7 N*m/rad"}))
