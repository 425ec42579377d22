"""Modal coordinates of a rotor in the machine, against the planar modes that they belong to."""

from dataclasses import replace

import numpy as np
import pytest

from gearwhine.case import load_case
from gearwhine.coupling import CoupledMachine, CouplingError
from gearwhine.coupling.time.histories import modal_rows
from gearwhine.from_case.gear_pairs import solve_gears
from gearwhine.solve.machine import build_machine


@pytest.fixture(scope="module")
def machine() -> CoupledMachine:
    """Two rotors on isotropic bearings, whose averaged stiffness is their own, in one piece with their gears."""
    case = load_case("spur-pair", ["gear.*.bore=0"]).case
    return build_machine(case, None, solve_gears(case))


@pytest.mark.parametrize("name", ["input", "output"])
def test_rows_diagonalise_the_rotor_on_its_supports(machine: CoupledMachine, name: str) -> None:
    """In a plane, rotor and bearings have the stiffness diag(ω²) by these coordinates: they are its modes, in order."""
    # Without the flanks' resistance to tilting, which is the mesh's.
    linear = tuple(one for one in machine.system.linear if one.of_contact is None)
    stiffness = replace(machine.system, linear=linear).stiffness
    rotor = next(part for part in machine.rotors if part.name == name)
    rows = modal_rows(machine, name)
    expected = np.diag(rotor.modal.lateral.frequencies[: len(rows.x)] ** 2)
    for plane in (rows.x, rows.y):
        assert plane @ plane.T == pytest.approx(np.eye(len(plane)), abs=1e-12)
        assert plane @ stiffness @ plane.T == pytest.approx(expected, abs=1e-9 * expected.max())
    assert rows.x @ stiffness @ rows.y.T == pytest.approx(0.0 * expected, abs=1e-9 * expected.max())
    torsional = np.diag(rotor.modal.torsional.frequencies[: len(rows.torsion)] ** 2)
    assert rows.torsion @ stiffness @ rows.torsion.T == pytest.approx(torsional, abs=1e-9)


def test_unit_coordinates_move_the_shaft_by_the_mode_shapes(machine: CoupledMachine) -> None:
    rotor = machine.rotors[0]
    rows = modal_rows(machine, rotor.name)
    shapes = rotor.modal.lateral.evaluate([0.03, 0.17])[0][: len(rows.x)]
    own = slice(0, rotor.size)  # the first rotor's coordinates come first
    for place, at in enumerate((0.03, 0.17)):
        assert rows.x[:, own] @ rotor.direction(at, 0) == pytest.approx(shapes[:, place], rel=1e-9, abs=1e-12)
        assert rows.y[:, own] @ rotor.direction(at, 1) == pytest.approx(shapes[:, place], rel=1e-9, abs=1e-12)
        assert rows.x[:, own] @ rotor.direction(at, 1) == pytest.approx(0.0 * shapes[:, place])
    turned = rotor.modal.torsional.evaluate([0.17])[: len(rows.torsion), 0]
    assert rows.torsion[:, own] @ rotor.rotation(0.17) == pytest.approx(turned)


def test_an_unknown_rotor_is_named_with_those_there_are(machine: CoupledMachine) -> None:
    with pytest.raises(CouplingError, match=r"'outptu'; there are: input, output"):
        modal_rows(machine, "outptu")
