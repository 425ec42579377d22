"""Residual compliance of a shaft over the face of a gear: what its modes and attachment modes lack there.

The load of a mesh is spread over its face. Its mean, its moment and its twist over the face are loads on the sections
that carry the face; the modes of the shaft are static-exact for a force and a torque in the middle alone (residual
flexibility: MacNeal 1971). With P the exact static flexibility (:mod:`gearwhine.rotors.analyses.static_stiffness`) and
Φ the shapes by frequencies ω, each load p lacks

    R = pᵀ (P - Σ φ φᵀ / ω²) p,

which has no mass: its frequencies are far above those of the modes. A free motion has no part in it: the torques of p
are taken less that in the middle of the face, for which nothing is missing, and balance themselves.
"""

from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.gears.contact.face_slices import DEFAULT_SLICES, face_stations, mean_and_slope
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import ModalRotor, Rotor
from gearwhine.rotors.analyses.static_stiffness import static_shaft


@dataclass(frozen=True, eq=False)
class FaceCompliance:
    """Compliance over a face that the modes of its shaft lack.

    Attributes
    ----------
    bending : ndarray, shape (3, 3)
        By lateral forces: over the mean deflection of the face, its slope and the tilt in its middle [m/N, 1/N,
        rad/(N m)].
    twisting : ndarray, shape (3, 3)
        By torques: over the mean rotation of the face and its twist [rad/(N m), rad/(N m²)]; zeros for the tilt.
    """

    bending: FloatArray
    twisting: FloatArray

    def along_action(self, base_radius: float) -> FloatArray:
        """Compliance along the line of action of a gear of a base radius [m], (3, 3)."""
        return np.asarray(self.bending + base_radius**2 * self.twisting)


def face_compliance(
    rotor: Rotor, modal: ModalRotor, at: float, face_width: float, carried: tuple[float, float]
) -> FaceCompliance:
    """Compliance over a face that the modes of a rotor lack.

    Parameters
    ----------
    rotor : Rotor
        Rotor with its gears.
    modal : ModalRotor
        Its modes, with attachment modes for a force and a torque in the middle of the face.
    at : float
        Middle of the face from the left end [m].
    face_width : float
        [m]
    carried : tuple of float
        Ends of the length that moves with the gear's body [m].
    """
    stations = face_stations(face_width)
    mean, slope = mean_and_slope(stations, stations[-1] * _EVEN_FACE_PLACES)
    carriers = np.clip(at + stations, *carried)
    supports = [bearing.mean_support for bearing in modal.bearings]
    shaft = static_shaft(rotor, [at, *carriers.tolist(), *(support.at for support in supports)])
    count = shaft.places.size
    middle, nodes = shaft.node(at), [shaft.node(place) for place in carriers.tolist()]
    # Lateral forces on the nodes, then moments; torques.
    loads, torques = np.zeros((3, 2, count)), np.zeros((3, count))
    for row, forces in enumerate((mean, slope)):
        np.add.at(loads[row, 0], nodes, forces)
        np.add.at(loads[row, 1], nodes, forces * (at + stations - carriers))
        np.add.at(torques[row], nodes, forces)
    loads[0, 0, middle] -= 1.0
    torques[0, middle] -= 1.0
    loads[2, 1, middle] = 1.0
    bending, twisting = np.zeros((3, 3)), np.zeros((3, 3))
    lateral, torsional = modal.lateral, modal.torsional
    if lateral.frequencies[0] > 0.0:
        # Motion along x, and the slope in its plane: the rotation about y.
        rows = [6 * node + axis for axis in (0, 4) for node in range(count)]
        stiffness = shaft.stiffness[np.ix_(rows, rows)].copy()
        for support in supports:
            node = shaft.node(support.at)
            stiffness[node, node] += support.stiffness
            stiffness[count + node, count + node] += support.tilt_stiffness
        shapes = np.hstack(lateral.evaluate(shaft.places))
        bending = _missing(
            np.asarray(np.linalg.inv(stiffness), dtype=np.float64), shapes, lateral.frequencies, loads.reshape(3, -1)
        )
    rows = [6 * node + 5 for node in range(count)]
    elastic = torsional.frequencies > 0.0
    turning = shaft.stiffness[np.ix_(rows, rows)]
    flexibility = np.asarray(np.linalg.pinv(turning, rcond=_RIGID_ROTATION_STIFFNESS, hermitian=True), dtype=np.float64)
    shapes = torsional.evaluate(shaft.places)[elastic]
    twisting = _missing(flexibility, shapes, torsional.frequencies[elastic], torques)
    return FaceCompliance(bending, twisting)


_EVEN_FACE_PLACES = 2.0 * (np.arange(DEFAULT_SLICES) + 0.5) / DEFAULT_SLICES - 1.0  # places over half the face
_RIGID_ROTATION_STIFFNESS = 1e-12  # stiffness below this part of the largest is the rotation as a whole


def _missing(flexibility: FloatArray, shapes: FloatArray, frequencies: FloatArray, loads: FloatArray) -> FloatArray:
    """Compliance by loads (3, p) that shapes (m, p) at frequencies (m,) lack of a flexibility (p, p), (3, 3)."""
    exact = loads @ flexibility @ loads.T
    carried = (shapes @ loads.T) / frequencies[:, None]
    missing = exact - carried.T @ carried
    # Rounding of the flexibility is none of the shaft's.
    values, vectors = np.linalg.eigh(0.5 * (missing + missing.T))
    return np.asarray((vectors * np.maximum(values, 0.0)) @ vectors.T)
