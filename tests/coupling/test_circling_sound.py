"""Sound over time of mesh forces that circle with their planets: passes of planets as sidebands, by hand."""

import numpy as np
import numpy.typing as npt
import pytest
from test_ring_in_housing import _machine, _ring_housing

from gearwhine.coupling.signals.transfer_paths import housing_connections
from gearwhine.coupling.sound.microphones import microphone_histories
from gearwhine.housing.acoustics.modal_radiation import ModalRadiation

FloatArray = npt.NDArray[np.float64]

FORCE, TONE, COUNT = 100.0, 60, 4096  # amplitude of each mesh [N], its cycles in a turn of the carrier, samples
PRESSURE_ANGLE = np.radians(20.0)
BY_ORDER = {2: 0.5, 3: 0.4}  # radial motion of the ring's modes in waves around it, see _ring_housing
WEIGHT = {2: 30.0, 3: 20.0}  # pressure at the microphone by the rate of each mode that is a cosine [Pa s]


def heard(planets: int) -> tuple[FloatArray, float]:
    """Lines at the microphone by turns of the carrier [Pa], of planets in phase; speed of the carrier [rad/s]."""
    machine = _machine()
    carrier = abs(machine.speeds["carrier"])
    times = 2.0 * np.pi / carrier * np.arange(COUNT) / COUNT
    tone, forces = FORCE * np.cos(TONE * carrier * times), {}
    meshes = [one for one in housing_connections(machine) if one.contact is not None]
    assert len(meshes) == 3
    for number, mesh in enumerate(meshes):
        forces[mesh.name] = mesh.of_mesh(tone if number < planets else 0.0 * tone, times)
    values = np.zeros((5, 1, 4), dtype=complex)
    values[:, 0] = [WEIGHT[2], 0.0, WEIGHT[3], 0.0]
    nothing, zeros = np.zeros((5, 4, 4)), np.zeros(5)
    limits = np.linspace(1.0, 2.0 * TONE * carrier / (2.0 * np.pi), 5)
    transfer = ModalRadiation(
        *(limits, nothing, nothing, nothing, values, np.zeros(1)), *(zeros, zeros, zeros, np.zeros((5, 1)))
    )
    found = microphone_histories(machine, transfer, times, forces, repeats=True)
    return 2.0 * np.abs(np.fft.rfft(found.pressure[0])) / COUNT, carrier


def by_hand(order: int, at: int, carrier: float) -> float:
    """Line of one planet at a number of turns of the carrier [Pa].

    A force that circles, radial F sin α and tangential F cos α, pushes the mode u_r = a cos nθ, u_t = -a sin nθ / n by
    F cos ωt (A cos nΩt + B sin nΩt), half of which is at each of ω ± nΩ.
    """
    housing, w = _ring_housing(), at * carrier
    place = 0 if order == 2 else 2
    push = FORCE * BY_ORDER[order] * np.hypot(np.sin(PRESSURE_ANGLE), np.cos(PRESSURE_ANGLE) / order)
    dynamic = housing.stiffness[place, place] - w**2 + 1j * w * housing.damping[place, place]
    return float(0.5 * push * abs(1j * w / dynamic) * WEIGHT[order])


@pytest.mark.parametrize(("planets", "orders"), [(1, (2, 3)), (3, (3,))])
def test_planets_are_heard_as_they_pass(planets: int, orders: tuple[int, ...]) -> None:
    """One planet sounds through both modes; of three in phase the waves of order 2 cancel, and those of order 3 add."""
    lines, carrier = heard(planets)
    expected = {
        TONE + sense * order: planets * by_hand(order, TONE + sense * order, carrier)
        for order in orders
        for sense in (1, -1)
    }
    for at, amplitude in expected.items():
        assert lines[at] == pytest.approx(amplitude, rel=1e-6)
    others = [at for at in range(1, 2 * TONE) if at not in expected]
    assert lines[others].max() < 1e-9 * max(expected.values())
