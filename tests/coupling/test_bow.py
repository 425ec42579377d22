"""A bowed shaft in the coupled system: the steady motion against the exact response of the rotor by itself."""

import numpy as np
import pytest

from gearwhine.coupling import MachineLoads, MountedBearing, assemble_machine
from gearwhine.coupling.machine.components import rotor_component
from gearwhine.coupling.machine.loads import BowReactions
from gearwhine.rotors import Bearing, Disc, Rotor, Segment, ShaftMaterial, modal_rotor, unbalance_response
from gearwhine.rotors.analyses.unbalance import bow_shape
from gearwhine.rotors.model.loads import Bow

STEEL = ShaftMaterial.from_poisson_ratio(207e9, 0.3, 7850.0)
SHAFT = Rotor("shaft", [Segment(0.5, 0.05, 0.0, STEEL)] * 3, [Disc(0.5, 30.0, 0.3, 0.2), Disc(1.0, 50.0, 0.6, 0.4)])
BOW = Bow(np.array([0.0, 0.6, 1.0, 1.5]), np.array([0.0, 3e-5, 2e-5, 0.0]), np.array([0.0, 0.4, 1.1, 0.0]))
PLACES = (0.3, 0.6, 1.0, 1.4)


@pytest.mark.parametrize("speed", [20.0, 70.0, -120.0, 300.0])
def test_bow_response_is_the_rotors_own(speed: float) -> None:
    """(K - Ω² + iΩC) q = F of the coupled system's load; the reference solves the shaft's transfer equations."""
    stiffness, damping = np.array([[2e6, 1e5], [-5e4, 1e6]]), np.diag([3e3, 2e3])
    bearings = [Bearing(name, at, stiffness, damping) for name, at in (("left", 0.0), ("right", 1.5))]
    exact = unbalance_response(SHAFT, bearings, [], [speed], bow=BOW)
    modal = modal_rotor(SHAFT, bearings, count=24, forces_at=BOW.at.tolist())
    parts = assemble_machine(
        [rotor_component("shaft", modal, start=0.0)],
        None,
        speeds={"shaft": speed},
        bearings=[MountedBearing(bearing, "shaft", None) for bearing in bearings],
        loads=MachineLoads(bows=[BowReactions("shaft", BOW.at, bow_shape(SHAFT, BOW).reactions)]),
    )
    (load,) = parts.system.harmonic_loads
    assert (load.frequency, load.follows) == (speed, "turning")
    system = parts.system
    q = np.linalg.solve(system.stiffness - speed**2 * np.eye(system.size) + 1j * speed * system.damping, load.amplitude)
    x, y = exact.motion.evaluate(PLACES)
    size = np.abs(np.concatenate([x, y])).max()
    for k, at in enumerate(PLACES):
        found = [parts.rotors[0].direction(at, axis) @ q for axis in (0, 1)]
        np.testing.assert_allclose(found, [x[0, k], y[0, k]], atol=1e-5 * size)
