"""Natural modes of a planetary set: Lin & Parker, J. Vib. Acoust. 121, 316 (1999), and phasing after Parker (2000).

The frequencies for three planets are printed there (OH-58, Table 1); those for four are recomputed from the same data.
"""

from functools import cache

import numpy as np
import numpy.typing as npt
import pytest

from gearwhine.coupling import Machine
from gearwhine.coupling.linear.complex_modes import CoupledModes
from gearwhine.coupling.linear.frequency_response import response
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.statics.mean_mesh import mean_contact
from tests.machines.plane_planetary_set import equal_angles, plane_set

PRESSURE_ANGLE = np.radians(24.6)
PRINTED = {
    3: {
        "rotational": [0.0, 1475.7, 1930.3, 2658.3, 7462.8, 11775.3],
        "translational": [743.2, 1102.4, 1896.0, 2276.4, 6986.3, 9647.9],
        "planet": [],
    },
    4: {
        "rotational": [0.0, 1536.6, 1970.6, 2625.7, 7773.6, 13071.1],
        "translational": [727.0, 1091.0, 1892.8, 2342.5, 7189.9, 10437.6],
        "planet": [1808.2, 5963.8, 6981.7],
    },
}  # Hz


@cache
def _set(count: int) -> tuple[CoupledSystem, CoupledModes]:
    machine = Machine(**plane_set(equal_angles(count), pressure_angle=PRESSURE_ANGLE, with_ring=True))
    return machine.assembled.system, machine.modes()


def _motions(system: CoupledSystem, shapes: npt.NDArray[np.complex128]) -> dict[str, npt.NDArray[np.complex128]]:
    """Motion x, y [m] and rotation [rad] of the middle of each body in each mode, shape (m, 3)."""
    found, start = {}, 0
    for part in system.components:
        own = shapes[:, start : start + part.size]
        rows = np.vstack([part.motions(0.05)[:2], part.rotation(0.05)])
        found[part.name] = own @ rows.T
        start += part.size
    return found


def _in_plane(system: CoupledSystem, modes: CoupledModes) -> npt.NDArray[np.int64]:
    """Modes that move the bodies in their plane; tilts and bending of their shafts are no part of the model."""
    motions = _motions(system, modes.shapes)
    size = sum(np.abs(motion[:, :2]).sum(axis=1) + 0.05 * np.abs(motion[:, 2]) for motion in motions.values())
    return np.flatnonzero((size > 1e-6 * size.max()) & (modes.frequencies_hz < 2e4))


@pytest.mark.parametrize("count", [3, 4])
def test_natural_frequencies_and_their_multiplicities_are_the_printed_ones(count: int) -> None:
    system, modes = _set(count)
    found = modes.frequencies_hz[_in_plane(system, modes)]
    printed = PRINTED[count]
    expected = np.sort([*printed["rotational"], *printed["planet"], *np.repeat(printed["translational"], 2)])
    assert len(found) == len(expected) == 3 * (3 + count)
    assert np.abs(found[0]) < 1e-3
    # Four planets' translational modes are recalled to four digits only.
    assert np.abs(found[1:] / expected[1:] - 1.0).max() < (1e-4 if count == 3 else 1e-3)
    pairs = found[[np.argmin(np.abs(found - one)) for one in printed["translational"]]]
    for one in pairs:
        assert np.count_nonzero(np.abs(found / one - 1.0) < 1e-9) == 2


@pytest.mark.parametrize("count", [3, 4])
def test_modes_are_named_by_their_kind_in_the_set(count: int) -> None:
    _, modes = _set(count)
    for kind, frequencies in PRINTED[count].items():
        for frequency in frequencies:
            number = int(np.argmin(np.abs(modes.frequencies_hz - frequency)))
            assert modes.planetary[number] == f"{kind}: carrier"


def test_planet_modes_leave_sun_ring_and_carrier_at_rest() -> None:
    system, modes = _set(4)
    for frequency in PRINTED[4]["planet"]:
        number = int(np.argmin(np.abs(modes.frequencies_hz - frequency)))
        motions = _motions(system, modes.shapes[number : number + 1])
        planets = max(np.abs(motions[f"planet {place}"][:, :2]).max() for place in range(1, 5))
        for member in ("sun", "ring", "carrier"):
            assert np.abs(motions[member][:, :2]).max() < 1e-10 * planets
            assert 0.05 * np.abs(motions[member][:, 2]).max() < 1e-10 * planets


def _answer(system: CoupledSystem, errors: npt.NDArray[np.complex128], hz: float) -> dict[str, np.ndarray]:
    """Motion of the bodies by transmission errors of all meshes at a frequency."""
    w = 2.0 * np.pi * hz
    state = mean_contact(system)
    load = sum(k * e * one.direction for k, e, one in zip(state.stiffness, errors, system.contacts, strict=True))
    moved = response(system, np.asarray(load)[None, None, :], np.array([w]), state)[0]
    return _motions(system, moved)


@pytest.mark.parametrize(
    ("count", "harmonic", "silent"),
    # Parker (2000): with k = harmonic · z_sun mod N, k = 0 drives rotational modes alone, k = 1 or N - 1 translational
    # ones, others planet modes. Suns have 24 and 36 teeth.
    [(3, 1, "translation"), (4, 1, "translation"), (5, 1, "rotation"), (5, 2, "both"), (5, 5, "translation")],
)
def test_phasing_of_the_meshes_suppresses_what_parkers_rules_say(count: int, harmonic: int, silent: str) -> None:
    teeth = (36, 24) if count == 5 else (24, 30)
    parts = plane_set(equal_angles(count), pressure_angle=PRESSURE_ANGLE, with_ring=True, damping=1e-6, teeth=teeth)
    system = Machine(**parts).assembled.system
    phases = np.array([contact.phase for contact in system.contacts])
    phased = _answer(system, np.exp(2j * np.pi * harmonic * phases), 1300.0)
    alone = _answer(system, np.eye(1, len(phases))[0].astype(np.complex128), 1300.0)
    for member in ("sun", "ring", "carrier"):
        if silent in ("translation", "both"):
            assert np.abs(phased[member][:, :2]).max() < 1e-8 * np.abs(alone[member][:, :2]).max()
        if silent in ("rotation", "both"):
            assert np.abs(phased[member][:, 2]).max() < 1e-8 * np.abs(alone[member][:, 2]).max()
    if silent == "translation":
        assert np.abs(phased["sun"][:, 2]).max() > np.abs(alone["sun"][:, 2]).max()
    elif silent == "rotation":
        assert np.abs(phased["sun"][:, :2]).max() > np.abs(alone["sun"][:, :2]).max()
    else:
        assert np.abs(phased["planet 1"]).max() > 0.0
