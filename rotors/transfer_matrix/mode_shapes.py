"""Mode shapes of a shaft: null vectors of its transfer equations, their exact fields, and certified modes.

A shape integrated from one end loses a mode that is localised at the other end. All node states are therefore
unknowns together (multiple shooting): the equations u_{i+1} = T₁₁ u_i + T₁₂ f_i, the same for forces with
the node's springs and inertias added, and free ends. A held displacement takes the place of its force balance. Node by
node, this matrix is a band; in the shaft's scaled units it is well conditioned for any number of shaft elements, and
inverse iteration on it with as many vectors as the root's multiplicity gives every shape, localised or not.

A field is the state (displacements, then forces) at the left end of every shaft element at one ω²; inside an element
the transfer matrix continues it. Quadrature over an element is Gauss–Legendre, which integrates products of two such
fields on elements this short to rounding.

Modes in bending, torsion or axial motion are found below a frequency limit or by their number, and certified.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy import linalg

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.certificate import ModeCertificate, certify
from gearwhine.rotors.errors import IncompleteModesError, RotorError, require, require_count, require_finite
from gearwhine.rotors.model.profile import STATION_TOLERANCE
from gearwhine.rotors.transfer_matrix.discretised_shaft import GAUSS_FRACTIONS, ContinuousShaft, DiscretisedShaft
from gearwhine.rotors.transfer_matrix.wittrick_williams import (
    lowest_natural_frequencies,
    shaft_arrays,
    wittrick_williams_count,
)


@dataclass(frozen=True)
class ShaftFields:
    """Exact fields along one discretised shaft, in its scaled units.

    Attributes
    ----------
    shaft : DiscretisedShaft
        The shaft.
    frequency_squared : ndarray, shape (k,)
        Squared frequency ω² of each field [rad²/s²].
    states : ndarray, shape (k, p + 1, 2n)
        State just right of each node.
    """

    shaft: DiscretisedShaft
    frequency_squared: FloatArray
    states: FloatArray

    def at(self, positions: FloatArray) -> FloatArray:
        """States at positions (z,) in m on the shaft, (k, z, 2n)."""
        number, fraction = self.shaft.places(positions)
        transfer_matrices = self.shaft.transfer_matrices_to(number, fraction, self.frequency_squared)
        return np.asarray(np.einsum("zkij,kzj->kzi", transfer_matrices, self.states[:, number]))

    def energies(self, mixture: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
        """Mass and stiffness matrices of combinations of the fields, in the shaft's scaled units.

        Kinetic energy is ½ q̇ᵀ M q̇ and strain energy, springs to ground and the work of an axial force
        included, ½ qᵀ K q. In bending the energies per length are ½ (ρA x² + ρI β²) ω² and
        ½ [f_x²/(κGA + P) + f_β²/EI + g P β²]. The fields are combined before they are squared: a combination
        that cancels keeps its digits.

        Parameters
        ----------
        mixture : ndarray, shape (m, k), optional
            Combinations, in rows; by default the fields themselves.

        Returns
        -------
        mass, stiffness : ndarray, shape (m, m)
        """
        motion, strain = self._rows
        if mixture is not None:
            motion, strain = mixture @ motion, mixture @ strain
        weights = self.shaft.energy_weights
        return (motion * weights.mass) @ motion.T, (strain * weights.strain) @ strain.T

    def mass_products(self, rows: FloatArray, others: FloatArray) -> FloatArray:
        """Entries of the mass matrix between two sets of combinations (a, k) and (b, k), (a, b)."""
        motion = self._rows[0]
        weighted = (rows @ motion) * self.shaft.energy_weights.mass
        return np.asarray(weighted @ (others @ motion).T)

    def bending_participation(self, rows: FloatArray) -> FloatArray:
        """Mass products of combinations of bending fields (a, k) with the motions of the shaft as a whole, (a, 2).

        These are a unit shift and a unit tilt about the first node, in scaled units. Under an axial force the tilt is
        no field without forces, so that both are given by their displacements.
        """
        place = self.shaft.quadrature_places
        shift = np.stack([np.ones_like(place), np.zeros_like(place)], axis=1)
        tilt = np.stack([place, np.ones_like(place)], axis=1)
        weighted = (rows @ self._rows[0]) * self.shaft.energy_weights.mass
        return np.asarray(weighted @ np.stack([shift.ravel(), tilt.ravel()], axis=1))

    def mass_norms(self, rows: FloatArray) -> FloatArray:
        """Norms in mass of combinations (a, k), (a,)."""
        motion = rows @ self._rows[0]
        return np.sqrt((motion**2) @ self.shaft.energy_weights.mass)

    def polar_matrix(self, mixture: FloatArray) -> FloatArray:
        """∫ ρI_p βᵢ βⱼ dz plus the nodes' polar inertias, of combinations of bending fields, (m, m)."""
        motion = mixture @ self._rows[0]
        return np.asarray((motion * self.shaft.energy_weights.polar) @ motion.T)

    def strain_of_elements(self, mixture: FloatArray) -> FloatArray:
        """Twice the strain energy in each shaft element of combinations of the fields, springs left out, (m, p)."""
        strain, weights = mixture @ self._rows[1], self.shaft.energy_weights.strain
        inside = weights.size - self.shaft.finite_stiffness.size
        elements = (strain**2 * weights)[:, :inside]
        return np.asarray(elements.reshape(mixture.shape[0], self.shaft.element.size, -1).sum(axis=2))

    def joined(self, other: "ShaftFields") -> "ShaftFields":
        """Join these fields and those of ``other``, on the same shaft."""
        return ShaftFields(
            self.shaft,
            np.concatenate([self.frequency_squared, other.frequency_squared]),
            np.concatenate([self.states, other.states]),
        )

    def on(self, shaft: DiscretisedShaft) -> "ShaftFields":
        """Return the same fields on a discretised shaft with further nodes."""
        if shaft is self.shaft:
            return self
        return ShaftFields(shaft, self.frequency_squared, self.at(shaft.nodes))

    @cached_property
    def _rows(self) -> tuple[FloatArray, FloatArray]:
        """Motion and strain of every field at the Gauss points and the nodes, as of `energy_rows`."""
        from gearwhine.rotors.transfer_matrix.mode_shape_kernels import energy_rows

        table, weights, count = self.shaft.table, self.shaft.energy_weights, self.frequency_squared.size
        motion, strain = np.empty((count, weights.mass.size)), np.empty((count, weights.strain.size))
        energy_rows(
            self.frequency_squared,
            np.ascontiguousarray(self.states),  # contiguous at every call: the kernel is compiled for each layout
            GAUSS_FRACTIONS,
            table.lengths,
            table.coefficients,
            self.shaft.element,
            motion,
            strain,
        )
        return motion, strain


# Relative distance below which roots share one null space, at their mean: frequencies are good to 1e-12. Shapes err by
# as much, which a heavy disc amplifies.
ONE_NULL_SPACE = 2e-12
# Relative distance below which roots are one multiple root: a set of modes holds all of them or none.
SAME_ROOT = 1e-10
# Smallest share of a rigid motion in the norm of an elastic mode that is removed.
LEAST_SHARE = 1e-12
# Relative distance of roots below which rounding mixes their shapes; their energies separate them again.
NEAR_ROOT = 1e-4


def groups(frequencies: FloatArray, tolerance: float) -> list[slice]:
    """Group ascending frequencies whose neighbours differ by less than ``tolerance`` of their value."""
    breaks = np.flatnonzero(np.diff(frequencies) > tolerance * frequencies[1:]) + 1
    edges = [0, *breaks.tolist(), frequencies.size]
    return [slice(left, right) for left, right in pairwise(edges) if right > left]


def responses(shaft: DiscretisedShaft, loads: list[tuple[int, int]], frequency_squared: float) -> FloatArray:
    """Node states under unit forces at one ω² off the roots, each on a node and a component, (loads, p + 1, 2n)."""
    from gearwhine.rotors.transfer_matrix.mode_shape_kernels import shooting_responses

    n = shaft.size
    sides = np.zeros((len(loads), 2 * n * shaft.nodes.size))
    for load, (node, component) in enumerate(loads):
        # The force balance of a displacement at a node; an external force stands in it with a negative sign.
        sides[load, 2 * n * node + component] = -1.0
    return np.asarray(shooting_responses(frequency_squared, sides, *shaft_arrays(shaft)))


def rigid_states(shaft: DiscretisedShaft) -> FloatArray:
    """Node states of the rigid motions, orthonormal in mass, (zero modes, p + 1, 2n).

    Raises
    ------
    RotorError
        A rigid motion moves no inertia, so that it has no frequency.
    """
    shapes = shaft.rigid_shapes
    states = np.concatenate([shapes, np.zeros_like(shapes)], axis=-1)
    if states.shape[0] == 0:
        return states
    mass, _ = ShaftFields(shaft, np.zeros(states.shape[0]), states).energies()
    size = np.sqrt(np.diag(mass))
    if size.min() == 0.0 or linalg.eigvalsh(mass / np.outer(size, size))[0] < 1e-13:
        raise RotorError(
            "a rigid motion of the free shaft moves no inertia; expected a disc with diametral inertia, "
            "a shaft with density, or another support"
        )
    lower = linalg.cholesky(mass, lower=True)
    return np.asarray(np.einsum("ij,jkl->ikl", linalg.inv(lower), states))


def shared_roots(elastic: FloatArray) -> FloatArray:
    """Ascending natural frequencies (m,), those that share one null space at their mean."""
    if not has_neighbours(elastic):
        return elastic
    shared = elastic.copy()
    for group in groups(elastic, ONE_NULL_SPACE):
        shared[group] = elastic[group].mean()
    return shared


def has_neighbours(elastic: FloatArray) -> bool:
    """Whether any two neighbouring roots are closer than `NEAR_ROOT`."""
    return bool(np.count_nonzero(elastic[1:] - elastic[:-1] <= NEAR_ROOT * elastic[1:]))


def solve_mode_shapes(
    shaft: DiscretisedShaft, frequencies: FloatArray
) -> tuple[ShaftFields, FloatArray, FloatArray, FloatArray]:
    """Fields of the modes at the given natural frequencies, the mixture that makes them orthonormal, and its energies.

    Parameters
    ----------
    shaft : DiscretisedShaft
        The shaft.
    frequencies : ndarray, shape (m,)
        Natural frequencies, ascending [rad/s], the rigid motions' zeros first.

    Returns
    -------
    fields : ShaftFields
        The m fields.
    mixture : ndarray, shape (m, m)
        Modes are ``mixture @ fields``; block diagonal over groups of near roots, but for the rigid motions'
        share that is taken out of the others where rounding has left one.
    mass, stiffness : ndarray, shape (m, m)
        Integrated anew where modes are combinations of fields, so that what cancels keeps its digits.
    """
    from gearwhine.rotors.transfer_matrix.mode_shape_kernels import null_states

    zeros = min(shaft.rigid_shapes.shape[0], frequencies.size)
    shared, elastic, near = frequencies, frequencies[zeros:], []
    if has_neighbours(elastic):
        shared, near = np.concatenate([frequencies[:zeros], shared_roots(elastic)]), groups(elastic, NEAR_ROOT)
    squared = shared**2
    states = null_states(squared[zeros:], *shaft_arrays(shaft))
    if zeros:
        states = np.concatenate([rigid_states(shaft)[:zeros], states])
    fields = ShaftFields(shaft, squared, states)
    mass, stiffness = fields.energies()
    scale = 1.0 / np.sqrt(mass.diagonal())
    scale[:zeros] = 1.0
    mixture = np.diag(scale)
    # Beside a very heavy disc the share of a rigid motion in an elastic shape is rounding, but not negligible.
    rigid = scale[zeros:, None] * mass[zeros:, :zeros]
    leaning = zeros > 0 and np.abs(rigid).max(initial=0.0) > LEAST_SHARE
    if not near and not leaning:
        both = scale[:, None] * scale
        return fields, mixture, both * mass, both * stiffness
    for group in near:
        if group.stop - group.start > 1:
            part = slice(group.start + zeros, group.stop + zeros)
            mixture[part, part] = ritz_vectors(mass[part, part], stiffness[part, part])[1].T
    if leaning:
        mixture[zeros:, :zeros] = -mixture[zeros:, zeros:] @ mass[zeros:, :zeros]
    return fields, mixture, *fields.energies(mixture)


def ritz_vectors(mass: FloatArray, stiffness: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Ascending ω² and mass-orthonormal columns of the small eigenproblem K q = ω² M q.

    Raises
    ------
    IncompleteModesError
        The mass matrix is singular: the shapes are not independent.
    """
    size = np.sqrt(np.diag(mass))
    scaled = mass / np.outer(size, size)
    if np.linalg.eigvalsh(scaled)[0] < 1e-12:
        raise IncompleteModesError("shapes of near roots are not independent; this is a defect, please report")
    values, vectors = linalg.eigh(stiffness / np.outer(size, size), scaled)
    return np.asarray(values), np.asarray(vectors / size[:, None])


DEFAULT_COUNT = 10
# Part of the frequency scale below which only rigid motions lie.
STANDSTILL = 1e-12
# Largest error of a first guess; beyond it the model has no finite frequency.
MOST_DOUBLINGS = 200


@dataclass(frozen=True)
class SolvedModes:
    """Modes of a shaft: frequencies (m,) in rad/s, k fields, their mixture (m, k) in each mode, and a certificate."""

    frequencies: FloatArray
    fields: ShaftFields
    mixture: FloatArray
    certificate: ModeCertificate


def find_modes(continuous_shaft: ContinuousShaft, frequency_limit: float | None, count: int | None) -> SolvedModes:
    """Every mode of a shaft below the limit [rad/s], or the lowest ``count``."""
    require(
        frequency_limit is None or count is None,
        "frequency_limit and count",
        (frequency_limit, count),
        "one of the two",
    )
    if frequency_limit is not None:
        require_finite("frequency_limit", frequency_limit, positive=True)
        shaft = continuous_shaft.cut(frequency_limit)
        return certified_modes(shaft, wittrick_williams_count(shaft, frequency_limit), frequency_limit)
    available = continuous_shaft.available_modes
    if count is None:
        wanted = int(min(DEFAULT_COUNT, available))
    else:
        require_count("count of modes", count)
        require(count <= available, "count of modes", count, f"at most {available:g}, all this lumped rotor has")
        wanted = count
    return certified_modes(shaft_with_modes(continuous_shaft, wanted), wanted)


def certified_modes(shaft: DiscretisedShaft, wanted: int, limit: float | None = None) -> SolvedModes:
    """Solve for the lowest ``wanted`` modes of a shaft: all below a limit [rad/s], or with all twins of the last one.

    Raises
    ------
    IncompleteModesError
        The modes fail their own proof.
    """
    frequencies = lowest_natural_frequencies(shaft, wanted, limit or shaft.highest)
    if limit is None:
        limit = limit_above(float(frequencies[-1]), shaft)
        wanted = wittrick_williams_count(shaft, limit)
    return proved_modes(shaft, frequencies, wanted, limit)


def limit_above(last: float, shaft: DiscretisedShaft) -> float:
    """Return a limit [rad/s] a little above the last mode, which takes in its twins, if it has any."""
    return min(max(last * (1.0 + 2.0 * SAME_ROOT), STANDSTILL * shaft.highest), shaft.highest)


def proved_modes(shaft: DiscretisedShaft, frequencies: FloatArray, expected: int, limit: float) -> SolvedModes:
    """Modes of a shaft at its lowest frequencies (m,), or at the ``expected`` lowest where those lack twins.

    Raises
    ------
    IncompleteModesError
        The modes fail their own proof.
    """
    if expected > frequencies.size:
        frequencies = lowest_natural_frequencies(shaft, expected, shaft.highest)
    fields, mixture, mass, stiffness = solve_mode_shapes(shaft, frequencies)
    return SolvedModes(frequencies, fields, mixture, certify(limit, expected, frequencies, mass, stiffness))


def shaft_with_modes(continuous_shaft: ContinuousShaft, wanted: int) -> DiscretisedShaft:
    """Discretise a shaft so that it has at least ``wanted`` modes below the highest frequency that it is good for."""
    highest = continuous_shaft.likely_frequency(wanted)
    for _ in range(MOST_DOUBLINGS):
        shaft = continuous_shaft.cut(highest)
        if wittrick_williams_count(shaft, highest) >= wanted:
            return shaft
        highest *= 2.0
    raise RotorError(f"{wanted} modes are not found below {highest:g} rad/s; expected a rotor with fewer")


def require_positions(stations: FloatArray, z: npt.ArrayLike) -> FloatArray:
    """Positions [m] as an array clipped onto the shaft; raises `RotorError` for one beyond its ends."""
    positions = np.atleast_1d(np.asarray(z, dtype=np.float64))
    low, high = float(stations[0]), float(stations[-1])
    slack = STATION_TOLERANCE * (high - low)
    inside = (positions >= low - slack) & (positions <= high + slack)
    if positions.ndim != 1 or not bool(inside.all()):
        raise RotorError(f"positions are {z!r}; expected places on the shaft, {low:g} to {high:g} m")
    return np.asarray(np.minimum(np.maximum(positions, low), high))
