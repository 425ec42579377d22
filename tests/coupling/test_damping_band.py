"""Bands of the sensors' lines by damping, against machines whose damping is halved and doubled."""

import numpy as np
import pytest
from test_transmissibility import geared

from gearwhine.coupling.linear.complex_modes import coupled_modes
from gearwhine.coupling.linear.damping_band import DampingBand
from gearwhine.coupling.linear.line_mechanisms import LineMechanisms
from gearwhine.coupling.statics.mean_mesh import linear_matrices, mean_contact


def test_a_band_is_the_line_of_machines_with_half_and_twice_the_damping() -> None:
    """Everything but the gyroscopic terms scales; the loads are those along the line of action."""
    machine = geared(300.0)
    system = machine.system
    stiffness, damping = linear_matrices(system, mean_contact(system))
    w = np.array([700.0, 1693.0, 2500.0, 3990.0])
    found = DampingBand(LineMechanisms(machine)).at(w)
    assert list(found) == ["top", "side"]
    (direction,) = [contact.direction for contact in system.contacts if contact.loaded]
    for number, frequency in enumerate(w):
        levels = {}
        for scale in (0.5, 1.0, 2.0):
            own = scale * (damping - system.gyroscopic) + system.gyroscopic
            dynamic = stiffness - frequency**2 * np.eye(system.size) + 1j * frequency * own
            motion = np.linalg.solve(dynamic, direction)
            levels[scale] = {name: abs(row @ motion) for name, row in machine.sensor_rows.items()}
        for name, bands in found.items():
            changes = [20.0 * np.log10(levels[scale][name] / levels[1.0][name]) for scale in (0.5, 2.0)]
            assert bands[number] == pytest.approx([min(*changes, 0.0), max(*changes, 0.0)], abs=1e-6)


def test_a_resonance_goes_as_one_over_the_damping_and_what_lies_beside_it_does_not() -> None:
    machine = geared(300.0)
    values = coupled_modes(machine.system).eigenvalues
    plate = values[np.argmin(np.abs(np.abs(values) - 900.0))]
    assert -plate.real < 0.02 * abs(plate)
    at, beside = (DampingBand(LineMechanisms(machine)).at([factor * abs(plate)])["top"][0] for factor in (1.0, 0.5))
    assert at == pytest.approx([-6.02, 6.02], abs=0.3)
    assert np.abs(beside).max() < 0.3
