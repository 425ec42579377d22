"""Stiffness of a bolted joint against the worked examples of Shigley's Mechanical Engineering Design.

R. G. Budynas and J. K. Nisbett, 9th ed., chapter 8: Example 8-2 (cones through steel and cast iron, Fig. 8-17) and
Example 8-4 (bolts of a cast-iron vessel). Stress areas: ISO 898-1, coarse threads.
"""

import math
from dataclasses import astuple

import numpy as np
import pytest

from gearwhine.housing import HousingError, Material, bolted_joint
from gearwhine.housing.model.bolted_joints import bolt_stiffness, frustum_stiffness, stress_area

INCH, MLBF_PER_INCH, MPSI = 0.0254, 1e6 * 4.4482216152605 / 0.0254, 6894.757293168e6
STEEL, IRON = 30 * MPSI, 14.5 * MPSI


def test_cones_through_steel_and_cast_iron() -> None:
    """Example 8-2: 30.80, 285.5 and 14.15 Mlbf/in, together 9.378; all of steel 14.64."""
    d, head = 0.5 * INCH, 0.75 * INCH
    upper = frustum_stiffness(0.595 * INCH, head, d, STEEL)
    middle = frustum_stiffness(0.0775 * INCH, 1.437 * INCH, d, IRON)
    lower = frustum_stiffness(0.6725 * INCH, head, d, IRON)
    assert np.array([upper, middle, lower]) / MLBF_PER_INCH == pytest.approx([30.80, 285.5, 14.15], rel=4e-4)
    assert 1 / (1 / upper + 1 / middle + 1 / lower) / MLBF_PER_INCH == pytest.approx(9.378, rel=1e-4)
    assert frustum_stiffness(0.6725 * INCH, head, d, STEEL) / 2 / MLBF_PER_INCH == pytest.approx(14.64, rel=4e-4)
    steel, iron = Material(STEEL, 0.3, 7850.0), Material(IRON, 0.25, 7200.0)
    joint = bolted_joint(d, 1.345 * INCH, iron, steel, cover=(steel, 0.595 * INCH))
    assert joint.clamped / MLBF_PER_INCH == pytest.approx(9.378, rel=1e-4)
    turned = bolted_joint(d, 1.345 * INCH, steel, cover=(iron, 0.75 * INCH))
    assert astuple(turned.stiffness) == pytest.approx(astuple(joint.stiffness))


def test_bolt_and_vessel() -> None:
    """Example 8-4: bolt 5.21 Mlbf/in, members of cast iron (14 Mpsi) 8.95 Mlbf/in."""
    d, grip = 0.625 * INCH, 1.5 * INCH
    own = bolt_stiffness(d, grip, STEEL, shank=0.75 * INCH, thread_area=0.226 * INCH**2)
    assert own / MLBF_PER_INCH == pytest.approx(5.21, abs=0.005)
    joint = bolted_joint(d, grip, Material(14 * MPSI, 0.25, 7200.0), Material(STEEL, 0.3, 7850.0))
    assert joint.clamped / MLBF_PER_INCH == pytest.approx(8.95, abs=0.005)
    assert joint.stiffness.axial == pytest.approx(joint.bolt + joint.clamped)


@pytest.mark.parametrize(("diameter", "area"), [(5, 14.2), (8, 36.6), (10, 58.0), (20, 245.0), (36, 817.0)])
def test_stress_areas_of_coarse_threads(diameter: float, area: float) -> None:
    assert stress_area(1e-3 * diameter) == pytest.approx(1e-6 * area, rel=2e-3)


def test_parts_no_wider_than_the_head_are_a_sleeve() -> None:
    """Then no cone opens: E A / l of a hollow cylinder, and its elementary shear, bending and twist."""
    steel = Material(207e9, 0.3, 7850.0)
    d, grip, outer = 0.010, 0.025, 0.015
    joint = bolted_joint(d, grip, steel, outer=outer)
    area, bending, own = math.pi / 4 * (outer**2 - d**2), math.pi / 64 * (outer**4 - d**4), math.pi / 64 * d**4
    shear = 207e9 / 2.6
    assert joint.clamped == pytest.approx(207e9 * area / grip)
    assert joint.stiffness.shear == pytest.approx(shear * area / grip + 12 * 207e9 * own / grip**3)
    assert joint.stiffness.tilting == pytest.approx(207e9 * (bending + own) / grip)
    assert joint.stiffness.torsional == pytest.approx(2 * shear * (bending + own) / grip)


def test_a_sleeve_of_two_materials_is_springs_in_series() -> None:
    """Flexibilities Σ l / (E A), Σ l / (G A), Σ l / (E I) of its pieces, and the bolt beside them."""
    steel, aluminium = Material(207e9, 0.3, 7850.0), Material(70e9, 0.33, 2700.0)
    d, grip, outer, length = 0.010, 0.025, 0.015, 0.015
    joint = bolted_joint(d, grip, steel, cover=(aluminium, length), outer=outer)
    area, bending, own = math.pi / 4 * (outer**2 - d**2), math.pi / 64 * (outer**4 - d**4), math.pi / 64 * d**4
    axial = 1 / (length / 70e9 + (grip - length) / 207e9)
    shear = 1 / (length / (70e9 / 2.66) + (grip - length) / (207e9 / 2.6))
    assert joint.clamped == pytest.approx(axial * area)
    assert joint.stiffness.shear == pytest.approx(shear * area + 12 * 207e9 * own / grip**3)
    assert joint.stiffness.tilting == pytest.approx(axial * bending + 207e9 * own / grip)
    assert joint.stiffness.torsional == pytest.approx(2 * (shear * bending + 207e9 / 2.6 * own / grip))


def test_a_wider_part_is_stiffer_up_to_the_free_cone() -> None:
    steel = Material(207e9, 0.3, 7850.0)
    widths = [0.015, 0.018, 0.022, 0.030, 0.040, 0.2, math.inf]
    clamped = [bolted_joint(0.010, 0.025, steel, outer=width).clamped for width in widths]
    assert (np.diff(clamped[:5]) > 0.0).sum() >= 3
    # At half the grip the free cone is 1.5 d + l tan 30° = 29.4 mm wide.
    assert clamped[3:] == pytest.approx([clamped[-1]] * 4)


def test_bolts_that_cannot_be_are_refused() -> None:
    steel = Material(207e9, 0.3, 7850.0)
    with pytest.raises(HousingError, match="both must be positive"):
        bolted_joint(0.0, 0.02, steel)
    with pytest.raises(HousingError, match=r"a cover of 0\.02 m in a grip of 0\.02 m: expected a part of it"):
        bolted_joint(0.010, 0.02, steel, cover=(steel, 0.02))
    with pytest.raises(HousingError, match=r"10 mm on parts 12 mm wide: its head needs 1\.5 times"):
        bolted_joint(0.010, 0.02, steel, outer=0.012)
