"""Inputs of Python that are allowed and unlikely, or that lead nowhere: warned of, or refused where they are made."""

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
    assert light.rotors(mode_count=2).warnings == [doubt]
    assert studied(gw.ShaftMaterial(206e9, 79e9, 7850.0)).rotors(mode_count=2).warnings == []
    assert studied(gw.ShaftMaterial(206e9, 79e9, 299.0)).machine.warnings
    assert not studied(gw.ShaftMaterial(206e9, 79e9, 300.0)).machine.warnings


def test_a_catalogue_bearing_in_millimetres_is_refused() -> None:
    with pytest.raises(gw.RotorError, match=r"outer diameter is 80; expected at most 5 m, .*; are 80 mm meant\?"):
        catalogue_bearing("deep-groove", 35, 80, 21)
    assert catalogue_bearing("spherical-roller", 2.0, 2.5, 0.4).rows  # a large one is no mistake


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
