"""Phasing of equal planets: lines in which they add or cancel, against sums of their phases."""

import numpy as np
import pytest

from gearwhine.coupling.linear.carriers.planet_phasing import CarriedPlanets, PlanetPhasing
from tests.machines.turning_set import TEETH, turning_machine


def _planets(*degrees: float) -> CarriedPlanets:
    groups = tuple(frozenset([f"planet {number}"]) for number in range(len(degrees)))
    return CarriedPlanets("carrier", groups, tuple(np.radians(degrees).tolist()), 0.06)


@pytest.mark.parametrize(
    ("degrees", "symmetry"),
    [
        ((0.0, 120.0, 240.0), 3),
        ((0.0, 240.0, 120.0), 3),
        ((0.0, 130.0, 240.0), 1),
        ((0.0, 85.0, 180.0, 265.0), 2),
        ((0.0, 90.0, 180.0, 270.0), 4),
        ((0.0,), 1),
    ],
)
def test_lines_cancel_where_the_phases_add_up_to_nothing_at_any_path(degrees: tuple[float, ...], symmetry: int) -> None:
    planets = _planets(*degrees)
    assert planets.symmetry == symmetry
    for waves in range(-12, 13):
        total = abs(np.exp(1j * waves * np.radians(degrees)).sum()) / len(degrees)
        ideal = planets.ideal(waves)
        if ideal is not None:
            assert total == pytest.approx(ideal, abs=1e-9)
        # Planets at other angles have no rule: what cancels on one path does not on another.
        assert (ideal is None) == (waves % symmetry == 0 and symmetry < len(degrees))


def test_a_hair_off_equal_angles_is_equal_and_a_tenth_of_a_degree_is_not() -> None:
    assert _planets(0.0, 120.0005, 240.0).symmetry == 3
    assert _planets(0.0, 120.1, 240.0).symmetry == 1


def test_order_of_the_line_in_turns_of_the_carrier_decides() -> None:
    """Lines at n z_r + k, a multiple of three, beside a ring of 83 teeth that stands still."""
    machine = turning_machine((900.0, 1300.0))
    phasing, ring = PlanetPhasing(machine), TEETH[0] + 2 * TEETH[1]
    assert phasing.carried["carrier"].symmetry == 3
    for contact in range(len(machine.meshes)):
        for harmonic in (1, 2, 3):
            for turns in range(-9, 10):
                expected = 1.0 if (harmonic * ring + turns) % 3 == 0 else 0.0
                assert phasing.ideal(contact, harmonic, {"carrier": float(turns)}) == expected
    # Meshes of one planet move the housing as one: together they are no sum of two sizes.
    of_planet = [n for n in range(len(machine.meshes)) if phasing.planet(n) == ("carrier", 0)]
    assert len(of_planet) == 2
    parts = np.array([[1.0 + 0.0j, 0.0], [-0.5, 0.0]])
    assert phasing.solved(of_planet, parts) == pytest.approx(1.0)
    other = next(n for n in range(len(machine.meshes)) if phasing.planet(n) == ("carrier", 1))
    assert phasing.solved([of_planet[0], other], parts) == pytest.approx(0.5 / 1.5)
