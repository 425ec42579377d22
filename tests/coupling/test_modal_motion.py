"""Modal coordinates of a rotor in the machine, against the planar modes that they belong to."""

from dataclasses import replace

import numpy as np
import pytest

from coupling import CoupledMachine, CouplingError
from coupling.time.histories import modal_rows
from gearwhine.case import load_case
from gearwhine.from_case.gear_pairs import solve_gears
from gearwhine.solve.machine import build_machine


@pytest.fixture(scope="module")
def machine() -> CoupledMachine:
    """Two rotors on isotropic bearings, whose averaged stiffness is their own."""
    case = load_case("spur-pair").case
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
    # By the free shaft's modes and the rotation of the rim against its hub, K is diagonal and M is not.
    (body,), free = rotor.bodies, rotor.modal.torsional
    free_stiffness = np.diag([*free.frequencies**2, body.stiffness])
    mass = np.diag([*np.ones(free.count), body.rim_inertia])
    mass[-1, :-1] = mass[:-1, -1] = body.coupling_inertia * free.evaluate([body.at])[:, 0]
    frequencies = np.linalg.eigvals(np.linalg.solve(mass, free_stiffness))
    torsional = np.diag(np.sort(frequencies.real)[: len(rows.torsion)])
    found = rows.torsion @ stiffness @ rows.torsion.T
    assert found == pytest.approx(torsional, abs=1e-9 * torsional.max())


def test_unit_coordinates_move_the_shaft_by_the_mode_shapes(machine: CoupledMachine) -> None:
    rotor = machine.rotors[0]
    rows = modal_rows(machine, rotor.name)
    shapes = rotor.modal.lateral.evaluate([0.03, 0.17])[0][: len(rows.x)]
    own = slice(0, rotor.size)  # the first rotor's coordinates come first
    for place, at in enumerate((0.03, 0.17)):
        assert rows.x[:, own] @ rotor.direction(at, 0) == pytest.approx(shapes[:, place], rel=1e-9, abs=1e-12)
        assert rows.y[:, own] @ rotor.direction(at, 1) == pytest.approx(shapes[:, place], rel=1e-9, abs=1e-12)
        assert rows.x[:, own] @ rotor.direction(at, 1) == pytest.approx(0.0 * shapes[:, place])
    free = rotor.modal.torsional
    turned = rotor.torsion_basis[: free.count].T @ free.evaluate([0.17])[:, 0]
    assert rows.torsion[:, own] @ rotor.rotation(0.17) == pytest.approx(turned[: len(rows.torsion)])


def test_an_unknown_rotor_is_named_with_those_there_are(machine: CoupledMachine) -> None:
    with pytest.raises(CouplingError, match=r"'outptu'; there are: input, output"):
        modal_rows(machine, "outptu")
