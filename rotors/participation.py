"""Participation factors of a rotor's modes in rigid motions of the ground.

For a ground that moves rigidly, u = q + R s, the modes are driven by -∫ φ R dm s'' over translation and over rotation
of the sections. R is a displacement along x (or y), a turn of the shaft's line about its left end in the plane of x
(or y), or a motion along the axis. The same integral with the polar inertia is the gyroscopic moment of a base that
turns.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .axial import AxialModes
from .lateral import LateralModes
from .quadrature import gauss_rule
from .segment import Segment
from .shaft import Rotor, station_inertias

FloatArray = npt.NDArray[np.float64]

_FRACTIONS, _WEIGHTS = gauss_rule(10)  # on pieces no longer than the shaft is thick


@dataclass(frozen=True)
class Participation:
    """Participation of m bending and a axial modes in rigid motions of the ground, integrals over the rotor.

    Attributes
    ----------
    displacement : ndarray, shape (m,)
        ∫ φ dm [√kg].
    tilt : ndarray, shape (m,)
        ∫ (z φ dm + β dI_d), z from the left end [√kg m].
    spin : ndarray, shape (m,)
        ∫ β dI_p [√kg m].
    axial : ndarray, shape (a,)
        ∫ ψ dm [√kg].
    """

    displacement: FloatArray
    tilt: FloatArray
    spin: FloatArray
    axial: FloatArray


def participation(rotor: Rotor, lateral: LateralModes, axial: AxialModes | None) -> Participation:
    """Participation of a rotor's modes and vectors in the rigid motions of its ground."""
    places, inertias = _spread(rotor)
    mass, diametral, polar = inertias.T
    displacement, slope = lateral.evaluate(places)
    along = np.zeros(0) if axial is None else axial.evaluate(places) @ mass
    return Participation(
        displacement @ mass, displacement @ (mass * places) + slope @ diametral, slope @ polar, np.asarray(along)
    )


def _spread(rotor: Rotor) -> tuple[FloatArray, FloatArray]:
    """Quadrature places (p,) [m] and mass, diametral and polar inertia (p, 3) of the whole rotor there."""
    stations = rotor.stations
    places, inertias = [stations], [station_inertias(rotor, stations)]
    for part, left in zip(rotor.segments, rotor.joints[:-1].tolist(), strict=True):
        if rotor.mass_model == "lumped" or not isinstance(part, Segment):
            continue
        thinnest = min(outer for outer, _ in part.end_diameters)
        count = int(np.ceil(part.length / thinnest))
        fractions = ((np.arange(count)[:, None] + _FRACTIONS) / count).ravel()
        lengths = np.tile(_WEIGHTS, count) * part.length / count
        sections = [part.section(float(fraction)) for fraction in fractions]
        mass = lengths * [section.mass_per_length for section in sections]
        polar = lengths * [section.polar_inertia_per_length for section in sections]
        places.append(left + fractions * part.length)
        inertias.append(np.column_stack([mass, 0.5 * polar, polar]))
    return np.concatenate(places), np.concatenate(inertias)
