"""Inputs of Python that are allowed and unlikely, or that lead nowhere: warned of, or refused where they are made."""

import re
from dataclasses import replace

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.housing.model.patches import Patch
from gearwhine.meshes import BoxGeometry, WallThickness
from gearwhine.rotors.rolling_bearings import catalogue_bearing

BOX = BoxGeometry((0.2, 0.15, 0.1), WallThickness.uniform(0.01), ())


def studied(material: gw.ShaftMaterial) -> gw.Study:
    shaft = gw.Shaft(gw.Rotor("shaft", [gw.Segment(0.5, 0.03, 0.0, material)]))
    bearings = [gw.MountedBearing(gw.Bearing.isotropic(f"at {at}", at, 1e8), "shaft", None) for at in (0.02, 0.48)]
    return gw.Study(gw.Machine([shaft], bearings, speed=100.0))


def test_a_shaft_in_grams_per_cubic_centimetre_is_doubted_by_machine_and_results() -> None:
    """7.85 is the density of steel in g/cm³; the same warning as that of a case."""
    light = studied(gw.ShaftMaterial(206e9, 79e9, 7.85))
    (doubt,) = light.machine.warnings
    assert doubt.startswith("shaft 'shaft': material.density is 7.85; expected a density of 300 to 23000 kg/m^3")
    assert light.warnings == (doubt,)
    assert light.rotors(mode_count=2).warnings == [doubt]
    assert studied(gw.ShaftMaterial(206e9, 79e9, 7850.0)).rotors(mode_count=2).warnings == []
    assert studied(gw.ShaftMaterial(206e9, 79e9, 299.0)).machine.warnings
    assert not studied(gw.ShaftMaterial(206e9, 79e9, 300.0)).machine.warnings


def test_a_catalogue_bearing_in_millimetres_is_refused() -> None:
    with pytest.raises(gw.RotorError, match=r"outer diameter is 80; expected at most 5 m, .*; are 80 mm meant\?"):
        catalogue_bearing("deep-groove", 35, 80, 21)
    assert catalogue_bearing("spherical-roller", 2.0, 2.5, 0.4).rows  # a large one is no mistake


TAPERED = {"static": 68e3, "dynamic": 61.6e3, "contact_angle": np.arctan(0.4 / 1.6), "carries": "+z"}
"""A 30208, whose Y is 1.6 and e 0.37."""


def on_tapered_rollers(offset: float = 5e-6, **changes: float) -> tuple[str, ...]:
    shaft = gw.Shaft(gw.Rotor("shaft", [gw.Segment(0.24, 0.04, 0.0, gw.STEEL)]))
    held = catalogue_bearing("tapered-roller", 0.04, 0.08, 0.01975, **(TAPERED | changes))
    held = replace(held, rows=tuple(replace(row, axial_offset=offset) for row in held.rows))
    facing = catalogue_bearing("tapered-roller", 0.04, 0.08, 0.01975, **(TAPERED | {"carries": "-z"}))
    bearings = [("right", 0.22, held), ("left", 0.02, facing)]
    mounted = [gw.MountedBearing.from_elements(name, at, "shaft", None, one) for name, at, one in bearings]
    return tuple(gw.Machine([shaft], mounted, speed=100.0).warnings)


def test_a_rating_in_kilonewtons_a_factor_e_for_y_and_an_offset_in_millimetres_are_doubted() -> None:
    assert not on_tapered_rollers()
    (rating,) = on_tapered_rollers(dynamic=61.6)
    assert "bearing 'right'" in rating
    assert "it is 0.0616 kN" in rating
    near = re.search(r"by ISO 281, ([\d.]+) kN", rating)
    assert near is not None
    assert float(near[1]) == pytest.approx(1e-3 * TAPERED["dynamic"], rel=0.3)
    (angle,) = on_tapered_rollers(contact_angle=np.arctan(0.4 / 0.37))
    assert "47.2° is a factor Y = 0.4 / tan α of 0.37" in angle
    (offset,) = on_tapered_rollers(offset=5e-3)
    assert "it is 5 mm" in offset


def test_a_limit_in_kilohertz_without_its_unit_is_doubted() -> None:
    limited = gw.load("steel-box", {"housing.frequency_limit": 2.5})
    (doubt,) = [text for text in limited.warnings if "frequency_limit" in text]
    assert "expected at least 10 Hz" in doubt
    assert not any("frequency_limit" in text for text in gw.load("steel-box").warnings)


FIXTURES = {
    "support": gw.Support("f", surface="botom", fixed=(True, True, True)),
    "mass": gw.LumpedMass("f", 1.0, Patch("botom")),
}


@pytest.mark.parametrize("kind", FIXTURES)
def test_a_fixture_on_a_surface_that_is_none_is_refused_where_the_housing_is_made(kind: str) -> None:
    message = rf"{kind} 'f': surface is 'botom'; expected the name of a surface of the mesh, one of .*'bottom'"
    with pytest.raises(gw.HousingError, match=message):
        gw.Housing.from_box(BOX, 0.05, gw.STEEL, fixtures=[FIXTURES[kind]])


def test_materials_of_a_housing_are_doubted() -> None:
    light = gw.Material(206e9, 0.3, 7.85)
    housing = gw.Housing.from_box(BOX, 0.05, light)
    assert [finding.attribute for finding in housing.findings] == ["density"]
    assert not np.any(list(gw.Housing.from_box(BOX, 0.05, gw.STEEL).findings))
