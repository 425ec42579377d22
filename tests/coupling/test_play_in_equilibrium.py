"""Equilibrium of parts that lie loose in their clearance while others carry the load."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from gearwhine.coupling.statics.connector_equilibrium import ConnectedStructure
from gearwhine.numerics.arrays import FloatArray

HERTZ = 1e12  # [N/m^1.5]
NOMINAL = 1e8  # [N/m]
GAP = 1e-5  # [m]


@dataclass(frozen=True)
class Hertz:
    """Force HERTZ z^1.5."""

    def at(self, z: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        root = np.sqrt(z)
        return float(0.4 * HERTZ * z[0] ** 2 * root[0]), HERTZ * z * root, 1.5 * HERTZ * np.diag(root)


@dataclass(frozen=True)
class Loose:
    """Hardly a force within a gap to either side, NOMINAL beyond."""

    within: float = 1e-13 * NOMINAL

    def at(self, z: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        beyond = np.sign(z) * np.maximum(np.abs(z) - GAP, 0.0)
        tangent = self.within + np.where(beyond == 0.0, 0.0, NOMINAL)
        energy = 0.5 * float(self.within * z @ z + NOMINAL * beyond @ beyond)
        return energy, self.within * z + NOMINAL * beyond, np.diag(tangent)


def test_a_motion_in_play_leaves_the_balance_of_the_others() -> None:
    """Newton's own step for the loose part is a thousand gaps; the loaded contact still carries its load exactly."""
    load, spring = 1000.0, 2e7
    exact = brentq(lambda z: spring * z + HERTZ * z**1.5 - load, 1e-9, 1e-3, xtol=1e-18, rtol=1e-15)
    structure = ConnectedStructure(
        stiffness=np.diag([spring, 0.0]),
        load=np.array([load, 1e3 * GAP * Loose().within]),
        directions=np.eye(2),
        laws=[Hertz(), Loose()],
        parts=[slice(0, 1), slice(1, 2)],
        nominal=NOMINAL * np.eye(2),
        offset=np.zeros(2),
    )
    x, _ = structure._polished(np.array([exact * (1.0 + 1e-7), 0.0]))
    assert abs(spring * x[0] + HERTZ * x[0] ** 1.5 - load) < 1e-12 * load
    assert abs(x[1]) < GAP
