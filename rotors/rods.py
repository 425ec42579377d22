"""Rod modes: the common form of torsional and axial modes."""

from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from .certificate import ModeCertificate
from .fields import ShaftFields
from .search import SolvedModes, require_positions

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class RodModes:
    """Inertia-orthonormal modes with one motion at a station, Φᵀ M Φ = I and Φᵀ K Φ = diag(ω²).

    Attributes
    ----------
    frequencies
        (m,): ascending, rad/s; the rigid motion of a free shaft is a zero.
    stations
        (s,): segment ends, discs and springs, m from the left end; of a plain chain, 0, 1, 2, ...
    amplitude
        (m, s): angle or displacement at the stations, rad or m per unit modal coordinate.
    certificate
        Proof of completeness.
    """

    frequencies: FloatArray
    stations: FloatArray
    amplitude: FloatArray
    certificate: ModeCertificate
    fields: ShaftFields = field(repr=False)
    mixture: FloatArray = field(repr=False)

    @property
    def count(self) -> int:
        """Number of modes m."""
        return int(self.frequencies.size)

    def evaluate(self, z: npt.ArrayLike) -> FloatArray:
        """Amplitude of every mode at positions z (m), (m, len(z)), by the exact field.

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        states = self.fields.at(require_positions(self.stations, z))[:, :, 0]
        return np.asarray(self.mixture @ states * self.fields.chain.displacement_unit[0])


Modes = TypeVar("Modes", bound=RodModes)


def rod_modes(kind: type[Modes], found: SolvedModes) -> Modes:
    """Modes of a kind from what the search found; the largest amplitude of each is positive."""
    chain = found.fields.chain
    nodal = found.mixture @ found.fields.at(chain.stations)[:, :, 0]
    largest = np.take_along_axis(nodal, np.abs(nodal).argmax(axis=1)[:, None], axis=1)
    sign = np.where(largest < 0.0, -1.0, 1.0)
    return kind(
        frequencies=found.frequencies,
        stations=chain.stations,
        amplitude=sign * nodal * chain.displacement_unit[0],
        certificate=found.certificate,
        fields=found.fields,
        mixture=sign * found.mixture,
    )
