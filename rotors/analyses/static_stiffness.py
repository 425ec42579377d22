"""Static stiffness of a free shaft between stations: exact beam and rod elements, consistent weight, exact field.

The transfer matrix at ω = 0 of everything between two neighbouring stations, whatever its steps, cones, couplings and
axial forces, maps the state (displacements u, forces f to the right) at the left station to that at the right one. With
the field of the weight per unit acceleration, p (`gearwhine.rotors.analyses.statics`), and the acceleration a,

    u₁ = T₁₁ u₀ + T₁₂ f₀ + p_u a        f₁ = T₂₁ u₀ + T₂₂ f₀ + p_f a.

Solved for the forces −f₀ and f₁ on the two ends, with C = T₁₂⁻¹, this is the element's stiffness and its load,

    K = [ C T₁₁                  −C     ]        w = [ −C p_u           ]
        [ T₂₁ − T₂₂ C T₁₁    T₂₂ C     ],           [ T₂₂ C p_u − p_f  ] a,

without truncation (Pestel and Leckie, Matrix Methods in Elastomechanics, 1963). T₁₂ holds the compliances of the
span alone, so that a span of a micrometre keeps its digits. An overhang ends without force, which leaves its station
K = T₂₁ T₁₁⁻¹, w = (K p_u − p_f) a on the left, and K = T₂₂⁻¹ T₂₁, w = −T₂₂⁻¹ p_f a on the right: K is zero unless
an axial force acts there, and w is the overhang's weight and its moment.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import FloatArray, IndexArray
from gearwhine.rotors.analyses.statics import TINY
from gearwhine.rotors.errors import RotorError, require
from gearwhine.rotors.model.profile import (
    AXIAL,
    BENDING,
    STATION_TOLERANCE,
    TORSION,
    Profile,
    merged_positions,
)
from gearwhine.rotors.model.shaft import Rotor, station_index, station_inertias
from gearwhine.rotors.transfer_matrix.discretised_shaft import ELEMENT_MARGIN
from gearwhine.rotors.transfer_matrix.mode_shapes import require_positions
from gearwhine.rotors.transfer_matrix.timoshenko import ShaftElements

# Node displacements of each motion, in the order of `StaticShaft.motions`, and their signs. The slope in x is the
# rotation about y, the slope in y minus that about x.
_DISPLACEMENTS = ([0, 4], [1, 3], [2], [5])
_SIGNS = ([1.0, 1.0], [1.0, -1.0], [1.0], [1.0])
# Rows of a profile's coefficients that hold ρA, of the beam and of the rod.
_MASS_ROWS = [2, 9]
# Asymmetry of a stiffness over its largest entry above which it is not rounding.
_ASYMMETRY = 1e-9


@dataclass(frozen=True)
class StaticShaft:
    """Exact static stiffness of a free shaft between N nodes.

    The six displacements of a node are those along x, y, z [m] and the rotations about x, y, z [rad], right-handed,
    with z along the shaft. Loads on nodes are forces [N] and moments [N·m] in the same order.

    Attributes
    ----------
    places : ndarray, shape (N,)
        Positions of the nodes, ascending from the left end [m].
    stiffness : ndarray, shape (6N, 6N)
        Static stiffness, symmetric. Without axial forces it is positive semidefinite, with the six rigid motions as
        null space; an axial force of a segment does work on a tilt.
    """

    places: FloatArray
    stiffness: FloatArray
    _motions: "tuple[_Motion, ...]" = field(repr=False)

    @property
    def length(self) -> float:
        """Length of the shaft [m]."""
        return float(self._motions[0].nodes[-1])

    def node(self, at: float) -> int:
        """Index of the node at a position [m]; raises `RotorError` where there is none."""
        index = station_index(self.places, at)
        slack = 2.0 * STATION_TOLERANCE * self.length
        require(abs(self.places[index] - at) <= slack, "node position", at, f"one of {self.places.tolist()} m")
        return index

    def weight(self, gravity: Sequence[float]) -> FloatArray:
        """Nodal loads (6N,) of the weight of shaft, couplings and discs under an acceleration (3,) over x, y, z [m/s²].

        They are consistent: nodal displacements under them are those of the distributed weight.
        """
        loads = np.zeros((self.places.size, 6))
        for motion, components, sign, pull in zip(self._motions, _DISPLACEMENTS, _SIGNS, _pulls(gravity), strict=True):
            loads[:, components] = pull * motion.load * sign
        return loads.ravel()

    def motions(self, displacement: FloatArray, z: npt.ArrayLike, gravity: Sequence[float] | None = None) -> FloatArray:
        """Exact motion of sections anywhere on the shaft.

        Parameters
        ----------
        displacement : ndarray, shape (..., 6N)
            Displacements of the nodes [m, rad]; the identity gives the shape functions of all nodes.
        z : array_like, shape (m,)
            Positions from the left end [m].
        gravity : sequence of float, shape (3,), optional
            Acceleration over x, y, z [m/s²] under which the displacements occur; without it no weight acts.

        Returns
        -------
        ndarray, shape (..., 6, m)
            Motions along x, y, z [m] and about x, y, z [rad].

        Raises
        ------
        RotorError
            A position off the shaft.
        """
        return self._states(displacement, z, gravity)[0]

    def internal_forces(
        self, displacement: FloatArray, z: npt.ArrayLike, gravity: Sequence[float] | None = None
    ) -> FloatArray:
        """Force and moment that the part right of a section puts on the part left of it, just right of positions z.

        Parameters and errors are those of `motions`.

        Returns
        -------
        ndarray, shape (..., 6, m)
            Shear forces along x and y, axial force (tension positive, without the segments' own ``axial_force``) [N];
            bending moments about x and y and torque about z [N·m].
        """
        return self._states(displacement, z, gravity)[1]

    def _states(
        self, displacement: FloatArray, z: npt.ArrayLike, gravity: Sequence[float] | None
    ) -> tuple[FloatArray, FloatArray]:
        positions = require_positions(self._motions[0].nodes, z)
        lead = displacement.shape[:-1]
        nodal = displacement.reshape(*lead, self.places.size, 6)
        moved, forces = np.zeros((*lead, 6, positions.size)), np.zeros((*lead, 6, positions.size))
        for motion, components, sign, pull in zip(self._motions, _DISPLACEMENTS, _SIGNS, _pulls(gravity), strict=True):
            states = np.moveaxis(motion.states(nodal[..., components] * sign, pull, positions), -1, -2)
            moved[..., components, :] = states[..., : len(components), :] * np.array(sign)[:, None]
            forces[..., components, :] = states[..., len(components) :, :] * np.array(sign)[:, None]
        return moved, forces


def static_shaft(rotor: Rotor, stations: Sequence[float]) -> StaticShaft:
    """Assemble the exact static stiffness and the weight of a free shaft between stations.

    Parameters
    ----------
    rotor : Rotor
        The shaft with its couplings and discs.
    stations : sequence of float
        Positions of the nodes from the left end [m], in any order; those closer than 1e-9 of the length are one node.
        The stiffness of a short span is exact to rounding, but a solution on it for displacements loses digits: between
        nodes a micrometre apart on a shaft of 0.4 m, it keeps nine.

    Raises
    ------
    RotorError
        No stations, a station off the shaft, or axial forces so large that the stiffness between two stations has lost
        its digits.
    """
    return _static_shaft(rotor, tuple(stations))


@lru_cache(maxsize=32)  # shafts of machines that differ in other parts
# Fields that outgrow all numbers fail the test of symmetry.
@np.errstate(over="ignore", divide="ignore", invalid="ignore")
def _static_shaft(rotor: Rotor, stations: tuple[float, ...]) -> StaticShaft:
    where = f"rotor {rotor.name!r}"
    if not len(stations):
        raise RotorError(f"{where} has no stations; expected at least one")
    for at in stations:
        rotor.require_on_shaft(f"{where} station", at)
    profile = rotor.profile
    others = [*(disc.at for disc in rotor.discs), *stations]
    nodes = _short_of_buckling(profile, merged_positions(profile.edges, others))
    station = np.unique([station_index(nodes, at) for at in stations])

    coefficients = profile.between(nodes)
    coefficients[:, _MASS_ROWS] *= float(rotor.mass_model == "distributed")
    mass = station_inertias(rotor, nodes)[:, 0]
    bending, axial = (_motion(nodes, coefficients[:, rows], mass, station) for rows in (BENDING, AXIAL))
    # No weight turns a shaft about its axis.
    torsion = _motion(nodes, coefficients[:, TORSION] * [[1.0], [0.0]], 0.0 * mass, station)

    motions, count = (bending, bending, axial, torsion), station.size
    stiffness = np.zeros((count, 6, count, 6))
    for motion, components, sign in zip(motions, _DISPLACEMENTS, _SIGNS, strict=True):
        scale = np.outer(motion.units[: len(components)], motion.units[: len(components)])
        matrix, transposed = motion.stiffness, motion.stiffness.transpose(1, 0, 3, 2)
        if not np.abs((matrix - transposed) * scale).max() <= _ASYMMETRY * np.abs(matrix * scale).max():
            raise RotorError(
                f"{where}: its axial forces leave the static stiffness no digits between two stations; "
                "expected smaller forces, or more stations"
            )
        both = 0.5 * (matrix + transposed) * np.outer(sign, sign)
        stiffness[np.ix_(range(count), components, range(count), components)] = both.transpose(0, 2, 1, 3)
    return StaticShaft(nodes[station], stiffness.reshape(6 * count, 6 * count), motions)


@dataclass(frozen=True)
class _Motion:
    """Bending in one plane (n = 2), or the axial motion or torsion (n = 1), of p elements between N stations.

    Attributes
    ----------
    nodes : ndarray, shape (p + 1,)
        Ends of the elements [m].
    elements : ShaftElements
        Elements in scaled units.
    units : ndarray, shape (2n,)
        SI values of a scaled displacement and force of one.
    span : ndarray of int, shape (p,)
        Span of each element: 0 is the left overhang, N the right one.
    starts : ndarray, shape (p, 2n + 1, 2n + 1)
        Maps, in SI, of displacements, forces and the acceleration from the left end of a span to just right of each
        element's left end.
    spans : ndarray, shape (N + 1, 2n + 1, 2n + 1)
        The same maps to the right end of each span.
    stiffness : ndarray, shape (N, N, n, n)
        Stiffness between the stations.
    load : ndarray, shape (N, n)
        Load of the stations per unit acceleration.
    """

    nodes: FloatArray
    elements: ShaftElements
    units: FloatArray
    span: IndexArray
    starts: FloatArray
    spans: FloatArray
    stiffness: FloatArray
    load: FloatArray

    def states(self, nodal: FloatArray, pull: float, positions: FloatArray) -> FloatArray:
        """States (..., z, 2n) at positions (z,) of displacements (..., N, n) of the stations under an acceleration."""
        n = nodal.shape[-1]
        t11, t12, t21, t22, p_u, p_f = _parts(self.spans)
        left = np.zeros((*nodal.shape[:-2], self.spans.shape[0], 2 * n + 1))
        left[..., -1] = pull
        left[..., 1:, :n] = nodal
        left[..., 0, :n] = (nodal[..., 0, :] - p_u[0] * pull) @ _inverse(t11[0]).T
        end = nodal[..., 1:, :] - _apply(t11[1:-1], nodal[..., :-1, :]) - p_u[1:-1] * pull
        left[..., 1:-1, n:-1] = _apply(_inverse(t12[1:-1]), end)
        left[..., -1, n:-1] = -(nodal[..., -1, :] @ t21[-1].T + p_f[-1] * pull) @ _inverse(t22[-1]).T

        number = np.clip(self.nodes.searchsorted(positions, side="right") - 1, 0, self.span.size - 1)
        fraction = (positions - self.nodes[number]) / np.diff(self.nodes)[number]
        inside = self.elements.transfer_matrices_to(number, fraction, np.array([TINY * 1j]))[:, 0]
        states = _apply(self.starts[number], left[..., self.span[number], :])
        return _apply(_with_weight(inside, self.units), states)[..., :-1]


def _motion(nodes: FloatArray, coefficients: FloatArray, node_mass: FloatArray, station: IndexArray) -> _Motion:
    """One motion of elements with coefficients (p, 6 or 2, j) in SI and masses (p + 1,) at nodes, between stations."""
    n, length = (2 if coefficients.shape[1] == 6 else 1), float(nodes[-1])
    # The compliance of the middle of each element, 1/EI of a beam, stands for it in the unit of force.
    force = float(np.exp(-np.log(coefficients[:, n - 1, 0]).mean())) / length**n
    if n == 2:
        scales = [force, force * length**2, length**2 / force, 1.0 / force, 1.0, 1.0 / force]
        units = np.array([length, 1.0, force, force * length])
    else:
        scales, units = [force * length, length / force], np.array([1.0, force])
    table = ShaftElements(np.diff(nodes) / length, coefficients * np.array(scales)[:, None])

    steps = _with_weight(table.transfer_matrices(np.array([TINY * 1j]))[0, :, 0], units)
    carried = node_mass.copy()
    carried[station] = 0.0
    # A node's mass lowers the force to its right; those of stations are loads on their nodes.
    steps[:, n, -1] -= carried[1:]
    span = np.searchsorted(station, np.arange(nodes.size - 1), side="right")
    starts, spans = np.empty_like(steps), np.tile(np.eye(2 * n + 1), (station.size + 1, 1, 1))
    spans[0, n, -1] -= carried[0]
    for element, span_number in enumerate(span.tolist()):
        starts[element] = spans[span_number]
        spans[span_number] = steps[element] @ spans[span_number]

    t11, t12, t21, t22, p_u, p_f = _parts(spans)
    inverse, first = _inverse(t12[1:-1]), np.arange(station.size - 1)
    stiffness, load = np.zeros((station.size, station.size, n, n)), np.zeros((station.size, n))
    stiffness[first, first] += inverse @ t11[1:-1]
    stiffness[first + 1, first + 1] += t22[1:-1] @ inverse
    stiffness[first, first + 1] = -inverse
    stiffness[first + 1, first] = t21[1:-1] - t22[1:-1] @ inverse @ t11[1:-1]
    at_left, at_right = t21[0] @ _inverse(t11[0]), _inverse(t22[-1])
    stiffness[0, 0] += at_left
    stiffness[-1, -1] += at_right @ t21[-1]
    load[first] -= _apply(inverse, p_u[1:-1])
    load[first + 1] += _apply(t22[1:-1] @ inverse, p_u[1:-1]) - p_f[1:-1]
    load[0] += at_left @ p_u[0] - p_f[0]
    load[-1] -= at_right @ p_f[-1]
    load[:, 0] += node_mass[station]
    return _Motion(nodes, table, units, span, starts, spans, stiffness, load)


def _with_weight(transfer: npt.NDArray[np.complex128], units: FloatArray) -> FloatArray:
    """Return the maps (e, 2n + 1, 2n + 1) in SI of state and acceleration, from T(iε) (e, 2n, 2n) in scaled units."""
    size = units.size
    whole = np.zeros((transfer.shape[0], size + 1, size + 1))
    # Squares of iε leave parts of the order ε² where T is zero.
    still = np.where(np.abs(transfer.real) < TINY, 0.0, transfer.real)
    whole[:, :size, :size] = still * (units[:, None] / units)
    whole[:, :size, -1] = transfer.imag[:, :, 0] * (units / (TINY * units[0]))
    whole[:, -1, -1] = 1.0
    return whole


def _parts(spans: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """T₁₁, T₁₂, T₂₁, T₂₂, p_u and p_f of maps (k, 2n + 1, 2n + 1)."""
    n = spans.shape[1] // 2
    u, f = slice(0, n), slice(n, 2 * n)
    return spans[:, u, u], spans[:, u, f], spans[:, f, u], spans[:, f, f], spans[:, u, -1], spans[:, f, -1]


def _inverse(matrices: FloatArray) -> FloatArray:
    """Inverse of matrices (..., n, n), n = 1 or 2, by Cramer's rule, which no scaling of rows or columns harms."""
    if matrices.shape[-1] == 1:
        return np.asarray(1.0 / matrices)
    a, b, c, d = (matrices[..., i, j] for i in (0, 1) for j in (0, 1))
    adjugate = np.stack([np.stack([d, -b], axis=-1), np.stack([-c, a], axis=-1)], axis=-2)
    return np.asarray(adjugate / (a * d - b * c)[..., None, None])


def _apply(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    """Products of matrices (k, i, j) with vectors (..., k, j), (..., k, i)."""
    return np.asarray(np.einsum("kij,...kj->...ki", matrices, vectors))


def _pulls(gravity: Sequence[float] | None) -> list[float]:
    """Acceleration along each motion; torsion has none."""
    pull = np.zeros(3) if gravity is None else np.array(gravity, dtype=np.float64)
    require(pull.shape == (3,) and bool(np.isfinite(pull).all()), "gravity", gravity, "three finite numbers")
    return [*pull.tolist(), 0.0]


def _short_of_buckling(profile: Profile, nodes: FloatArray) -> FloatArray:
    """Add nodes until no element's axial force has a clamped field of its own (ω = 0 of `discretised_shaft`)."""
    section = profile.section_of_span[profile.spans(nodes)]
    shear, bending, force = profile.bounds[section][:, [0, 1, 4]].T
    squared = np.maximum(2.0, shear / (shear + force)) * np.abs(force) / bending
    counts = np.maximum(1.0, np.ceil(ELEMENT_MARGIN * np.diff(nodes) * np.sqrt(squared) / math.pi))
    if counts.max() == 1.0:
        return nodes
    number = np.repeat(np.arange(section.size), counts.astype(np.intp))
    within = np.arange(number.size) - np.searchsorted(number, number)
    return np.append(nodes[number] + within * (np.diff(nodes) / counts)[number], nodes[-1])
