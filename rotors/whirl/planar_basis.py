"""Planar basis of whirl: modes of one plane, and static responses to loads at bearings and discs.

It serves starting values, so that its modes are not certified: any mass-orthonormal basis of the space gives the same,
and the roots have a proof of their own. The modes' fields and the responses are made orthonormal one after another, by
Gram-Schmidt on their values at the quadrature points, so that the small part that a response adds to the modes keeps
its digits.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.errors import require, require_count, require_finite
from gearwhine.rotors.model.bearing import Bearing, RadialSupport
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.modes.lateral import require_unbuckled
from gearwhine.rotors.modes.residual_modes import FREE_SHIFT, NOTHING_LEFT
from gearwhine.rotors.transfer_matrix.discretised_shaft import (
    GAUSS_FRACTIONS,
    GAUSS_WEIGHTS,
    ContinuousShaft,
    DiscretisedShaft,
)
from gearwhine.rotors.transfer_matrix.mode_shapes import responses, rigid_states, shaft_with_modes, shared_roots
from gearwhine.rotors.transfer_matrix.rotor_shafts import bending_shaft
from gearwhine.rotors.transfer_matrix.wittrick_williams import (
    lowest_natural_frequencies,
    shaft_arrays,
    wittrick_williams_count,
)

DEFAULT_COUNT = 12
LEAST_MODES = 6
SPARE_MODES = 3
# Multiple of the highest whirl frequency up to which the basis has modes: it gives starting values only.
BASIS_REACH = 1.5


@dataclass(frozen=True, eq=False)
class PlanarBasis:
    """Mass-orthonormal motions of the shaft in one plane, and their values at its bearings.

    Attributes
    ----------
    stiffness : ndarray, shape (b, b)
        Stiffness of the shaft without supports [1/s²].
    polar_inertia : ndarray, shape (b, b)
        Gyroscopic matrix per rad/s.
    displacement, slope : ndarray, shape (b, bearings)
        Displacement [m] and slope [rad] at the bearings, per unit modal coordinate.
    floor : float
        The lowest frequency on the mean supports that is not a rigid motion's zero [rad/s].
    """

    stiffness: FloatArray
    polar_inertia: FloatArray
    displacement: FloatArray
    slope: FloatArray
    floor: float

    @property
    def count(self) -> int:
        """Number of motions b."""
        return int(self.stiffness.shape[0])


def mean_supports(bearings: Sequence[Bearing]) -> tuple[RadialSupport, ...]:
    """Planar springs of a basis: averaged bearing stiffness, of tables over speed at the middle of the table."""
    return tuple(
        bearing.at_speed(float(bearing.speeds[bearing.speeds.size // 2])).mean_support
        if bearing.speeds is not None
        else bearing.mean_support
        for bearing in bearings
    )


def loaded_places(rotor: Rotor, bearings: Sequence[Bearing]) -> tuple[list[float], list[float]]:
    """Places [m] of forces and of moments on the turning shaft: bearings, and discs with polar inertia."""
    moments = [disc.at for disc in rotor.discs if disc.polar_inertia > 0.0]
    moments += [bearing.at for bearing in bearings if bearing.stiffness.shape[-1] == 5]
    return [bearing.at for bearing in bearings], moments


def modes_needed(count: int | None, available: float) -> int:
    """Return the number of planar modes in the basis for ``count`` whirl modes."""
    return int(min(max((count or DEFAULT_COUNT) // 2 + SPARE_MODES, LEAST_MODES), available))


def planar_basis(
    rotor: Rotor, bearings: Sequence[Bearing], frequency_limit: float | None, count: int | None
) -> PlanarBasis:
    """Assemble the planar basis: modes at averaged bearing stiffness, and attachment modes.

    It holds every mode below 1.5 times ``frequency_limit``, or three more than half of ``count``, and at least six;
    then the static responses to a force at each bearing and to a moment at each disc, where the compensation and
    gyroscopic terms act. Tables over speed enter with the stiffness at the middle of the table.

    Parameters
    ----------
    rotor, bearings : Rotor, sequence of Bearing
        The rotor and its bearings.
    frequency_limit : float or None
        Highest whirl frequency of interest [rad/s].
    count : int or None
        Number of whirl modes of interest, instead.

    Raises
    ------
    RotorError, IncompleteModesError
        Wrong arguments, or the root count does not reach the modes.
    """
    from gearwhine.rotors.transfer_matrix.mode_shape_kernels import (
        energy_rows,
        energy_weights,
        mass_orthonormal,
        null_states,
    )

    require_count("count of modes", count)
    for bearing in bearings:
        rotor.require_on_shaft(f"bearing {bearing.name!r}", bearing.at)
    both = (frequency_limit, count)
    require(frequency_limit is None or count is None, "frequency_limit and count", both, "one of the two")
    supports = mean_supports(bearings)
    require_unbuckled(rotor, supports)
    shaft, frequencies = _lowest_modes(bending_shaft(rotor, supports), frequency_limit, count)
    zeros = min(shaft.rigid_shapes.shape[0], frequencies.size)
    elastic = frequencies[zeros:]
    forces, moments = loaded_places(rotor, bearings)
    nodes = [shaft.node_at(place) for place in forces]
    loads = [(node, 0) for node in nodes] + [(shaft.node_at(place), 1) for place in moments]
    loads = list(dict.fromkeys(loads))
    # As in `gearwhine.rotors.modes.residual_modes`, the response of a free shaft is taken at ω² slightly below zero.
    shift = -((FREE_SHIFT * (float(elastic[0]) if elastic.size else 1.0)) ** 2) if zeros else 0.0
    squared = shared_roots(elastic) ** 2
    states = [null_states(squared, *shaft_arrays(shaft))]
    if zeros:
        states.insert(0, rigid_states(shaft)[:zeros])
    if loads:
        states.append(responses(shaft, loads, shift))
    squared = np.concatenate([np.zeros(zeros), squared, np.full(len(loads), shift)])
    fields = np.concatenate(states) if len(states) > 1 else states[0]
    arrays = shaft.table.lengths, shaft.table.coefficients, shaft.element
    # The bearings' springs are added by the projection.
    nodal = np.zeros_like(shaft.node_stiffness), shaft.node_inertia, shaft.node_polar
    mass, polar, stiffness = energy_weights(GAUSS_FRACTIONS, GAUSS_WEIGHTS, *arrays, *nodal)
    motion, strain = np.empty((squared.size, mass.size)), np.empty((squared.size, stiffness.size))
    energy_rows(squared, fields, GAUSS_FRACTIONS, *arrays, motion, strain)
    at_bearings = fields[:, nodes, :2] * shaft.displacement_unit
    shapes = np.ascontiguousarray(at_bearings.reshape(squared.size, -1))
    count_kept = mass_orthonormal(motion, strain, shapes, mass, NOTHING_LEFT)
    motion, strain, shapes = motion[:count_kept], strain[:count_kept], shapes[:count_kept]
    projected = (strain * stiffness) @ strain.T
    moving = np.sqrt(projected.diagonal()[projected.diagonal() > 0.0]) if elastic.size == 0 else elastic
    return PlanarBasis(
        stiffness=projected,
        polar_inertia=(motion * polar) @ motion.T,
        displacement=shapes[:, 0::2],
        slope=shapes[:, 1::2],
        floor=float(moving.min()) if moving.size else 1.0,
    )


def _lowest_modes(
    continuous_shaft: ContinuousShaft, frequency_limit: float | None, count: int | None
) -> tuple[DiscretisedShaft, FloatArray]:
    """Return a discretised shaft and its lowest natural frequencies, rad/s, those that the basis needs."""
    available = continuous_shaft.available_modes
    if frequency_limit is not None:
        require_finite("frequency_limit", frequency_limit, positive=True)
        highest = BASIS_REACH * frequency_limit
        shaft = continuous_shaft.cut(highest)
        below = wittrick_williams_count(shaft, highest)
        if below >= min(LEAST_MODES, available):
            return shaft, lowest_natural_frequencies(shaft, below, highest)
        wanted = int(min(LEAST_MODES, available))
    else:
        wanted = modes_needed(count, available)
    shaft = shaft_with_modes(continuous_shaft, wanted)
    return shaft, lowest_natural_frequencies(shaft, wanted, shaft.highest)
