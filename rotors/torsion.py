"""Free torsional modes of a shaft, its rigid rotation kept, and of a chain of inertias and springs."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from .certificate import ModeCertificate
from .chain import Chain, torsion_chain
from .errors import require
from .fields import Fields
from .search import FoundModes, find_modes, require_positions
from .shaft import Rotor

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class TorsionalModes:
    """Inertia-orthonormal free torsional modes, Φᵀ J Φ = I and Φᵀ K Φ = diag(ω²).

    Attributes
    ----------
    frequencies
        (m,): ascending, rad/s; the first is the rigid rotation, zero.
    stations
        (s,): segment ends and discs, m from the left end; of a plain chain, 0, 1, 2, ...
    angle
        (m, s): θ at the stations, rad per unit modal coordinate.
    certificate
        Proof of completeness.
    """

    frequencies: FloatArray
    stations: FloatArray
    angle: FloatArray
    certificate: ModeCertificate
    fields: Fields = field(repr=False)
    mixture: FloatArray = field(repr=False)

    @property
    def count(self) -> int:
        """Number of modes m."""
        return int(self.frequencies.size)

    def evaluate(self, z: npt.ArrayLike) -> FloatArray:
        """Angle of every mode at positions z (m), (m, len(z)), by the exact field.

        Raises
        ------
        RotorError
            A position is not on the shaft.
        """
        states = self.fields.at(require_positions(self.stations, z))[:, :, 0]
        return np.asarray(self.mixture @ states * self.fields.chain.displacement_unit[0])


def solve_torsional_modes(
    rotor: Rotor, *, frequency_limit: float | None = None, count: int | None = None
) -> TorsionalModes:
    """Every free torsional mode below a limit, or the lowest few; the rigid rotation is the first.

    Parameters
    ----------
    rotor
        The shaft and its discs.
    frequency_limit
        rad/s: all modes strictly below.
    count
        How many modes, the rigid rotation included; with neither, 10 or all there are.

    Raises
    ------
    RotorError
        Both a limit and a count, a rotor without polar inertia, or more modes than a lumped rotor has.
    IncompleteModesError
        The modes fail their own proof.
    """
    require(rotor.polar_inertia > 0.0, f"rotor {rotor.name!r} polar inertia", 0.0, "a positive inertia")
    return _of(find_modes(lambda highest: torsion_chain(rotor, highest), frequency_limit, count))


def solve_torsional_chain(inertias: Sequence[float], stiffnesses: Sequence[float]) -> TorsionalModes:
    """All modes of rigid inertias in a row, joined by massless springs, by the same transfer matrices.

    Parameters
    ----------
    inertias
        (s,): polar moments of inertia, kg·m²; zero is allowed, not everywhere.
    stiffnesses
        (s − 1,): of the springs between neighbours, N·m/rad.

    Raises
    ------
    RotorError
        Numbers that are negative or do not match in count.
    """
    masses, springs = np.array(inertias, dtype=np.float64), np.array(stiffnesses, dtype=np.float64)
    fitting = masses.ndim == 1 and springs.shape == (masses.size - 1,) and springs.size > 0
    expected = "two or more inertias and one spring between each two"
    require(fitting, "torsional chain shapes", (masses.shape, springs.shape), expected)
    positive = bool(np.isfinite(masses).all() and (masses >= 0.0).all() and masses.any())
    require(positive, "torsional chain inertias", list(inertias), "not negative, and not all zero")
    stiff = bool(np.isfinite(springs).all() and (springs > 0.0).all())
    require(stiff, "torsional chain stiffnesses", list(stiffnesses), "positive numbers")

    moment = float(np.exp(np.log(springs).mean()))

    def build(highest: float) -> Chain:
        return Chain(
            nodes=np.arange(masses.size, dtype=np.float64),
            flexibility=(moment / springs)[:, None],
            inertia=np.zeros((springs.size, 1)),
            node_inertia=masses[:, None] / moment,
            node_stiffness=np.zeros((masses.size, 1)),
            node_polar=np.zeros(masses.size),
            length_unit=1.0,
            displacement_unit=np.array([1.0 / np.sqrt(moment)]),
            highest=highest,
            is_station=np.ones(masses.size, dtype=np.bool_),
        )

    return _of(find_modes(build, None, int(np.count_nonzero(masses))))


def _of(found: FoundModes) -> TorsionalModes:
    return torsional_modes(found.frequencies, found.fields, found.mixture, found.certificate)


def torsional_modes(
    frequencies: FloatArray, fields: Fields, mixture: FloatArray, certificate: ModeCertificate
) -> TorsionalModes:
    """Assemble the result from fields in the chain's units and the mixture that makes modes of them."""
    chain = fields.chain
    nodal = mixture @ fields.states[:, chain.is_station, 0]
    largest = np.take_along_axis(nodal, np.abs(nodal).argmax(axis=1)[:, None], axis=1)
    sign = np.where(largest < 0.0, -1.0, 1.0)
    return TorsionalModes(
        frequencies=frequencies,
        stations=chain.nodes[chain.is_station],
        angle=sign * nodal * chain.displacement_unit[0],
        certificate=certificate,
        fields=fields,
        mixture=sign * mixture,
    )
