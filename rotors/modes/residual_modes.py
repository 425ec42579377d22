"""Residual attachment modes: the static compliance that a truncated modal basis lacks at loaded places."""

from collections.abc import Sequence

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.modes.lateral import LateralModes, lateral_modes
from gearwhine.rotors.modes.torsional_and_axial import Modes, RodModes, rod_modes
from gearwhine.rotors.transfer_matrix.discretised_shaft import DiscretisedShaft
from gearwhine.rotors.transfer_matrix.mode_shapes import (
    ShaftFields,
    SolvedModes,
    require_positions,
    responses,
    ritz_vectors,
)

# Part of the static response below which a residual is rounding.
NOTHING_LEFT = 1e-7
# A free shaft has no static response: it is taken at ω² = −(this part of the first elastic ω)². All but a thousandth of
# that response is rigid; the direction of the rest errs by the same part at most, so the compliance errs by its square.
# A smaller shift would lose more to rounding.
FREE_SHIFT = 0.03
# An estimate of the first elastic ω holds within this factor of that of the attachment modes made with it. Otherwise
# that one replaces it, this often at most: each time it falls to a part of itself, or to its final value.
NEAR_ENOUGH, CORRECTIONS = 1.5, 20


def add_attachment_modes(
    modes: LateralModes, *, forces_at: Sequence[float] = (), moments_at: Sequence[float] = ()
) -> LateralModes:
    """Modes followed by residual attachment modes, which make the static response to point loads exact.

    The static response to a unit force or moment at each place, less what the modes already carry, is
    made orthonormal in mass and diagonal in stiffness. The natural modes do not change. The attachment modes have
    frequencies too (Rayleigh quotients, not natural frequencies), so that the whole set enters a coupled model like
    natural modes. On a free shaft the response is taken at ω² slightly below zero.

    Parameters
    ----------
    modes : LateralModes
        A certified set from `gearwhine.rotors.solve_lateral_modes`, with one mode or more.
    forces_at, moments_at : sequence of float
        Places of forces and of moments in the plane from the left end [m].

    Raises
    ------
    RotorError
        A place that is not on the shaft.
    """
    forces = require_positions(modes.stations, list(forces_at))
    moments = require_positions(modes.stations, list(moments_at))
    loads = [(place, 0) for place in forces.tolist()] + [(place, 1) for place in moments.tolist()]
    solved = _attached(modes, loads)
    if solved is None:
        return modes
    return lateral_modes(solved.frequencies, solved.fields, solved.mixture, modes.supports, modes.certificate)


def add_rod_attachment_modes(modes: Modes, at: Sequence[float]) -> Modes:
    """Torsional or axial modes followed by residual attachment modes, exact in static response to point loads.

    They correspond to `add_attachment_modes`, for torques or axial forces. On a free shaft they carry the elastic part
    of the response, without the rigid motion.

    Parameters
    ----------
    modes : Modes
        A certified set from `gearwhine.rotors.solve_torsional_modes` or `gearwhine.rotors.solve_axial_modes`.
    at : sequence of float
        Places of the loads from the left end [m].

    Raises
    ------
    RotorError
        A place that is not on the shaft.
    """
    places = require_positions(modes.stations, list(at))
    solved = _attached(modes, [(place, 0) for place in places.tolist()])
    return modes if solved is None else rod_modes(type(modes), solved)


def _attached(modes: LateralModes | RodModes, loads_at: list[tuple[float, int]]) -> SolvedModes | None:
    """Modes followed by the attachment modes of some loads; None where these add nothing.

    Each load is a place [m] and the component of displacement along which it acts.
    """
    shaft = modes.fields.shaft.with_nodes(np.array([place for place, _ in loads_at]))
    loads = [(shaft.node_at(place), component) for place, component in loads_at]
    loads = [load for load in dict.fromkeys(loads) if not shaft.constrained[load]]
    if not loads:
        return None
    found = _attachment_modes(modes, shaft, loads)
    if found is None:
        return None
    fields, mixture, added = found
    old = np.hstack([modes.mixture, np.zeros((modes.count, len(loads)))])
    frequencies = np.concatenate([modes.frequencies, added])
    return SolvedModes(frequencies, fields, np.vstack([old, mixture]), modes.certificate)


Attachments = tuple[ShaftFields, FloatArray, FloatArray]


def _attachment_modes(
    modes: LateralModes | RodModes, shaft: DiscretisedShaft, loads: list[tuple[int, int]]
) -> Attachments | None:
    """Fields, their mixture in the attachment modes and frequencies of these [rad/s]; None where they add nothing.

    The first elastic ω of a free shaft with rigid modes alone is estimated by that of its attachment modes: a step of
    inverse iteration from the loads, whose Rayleigh quotient is above the first ω² that they excite, and close to it.
    """
    if not shaft.rigid_shapes.shape[0]:
        return _attachment_modes_at(modes, shaft, loads, 0.0)
    elastic = modes.frequencies[modes.frequencies > 0.0]
    if elastic.size:
        return _attachment_modes_at(modes, shaft, loads, FREE_SHIFT * elastic[0])
    # In scaled units a shaft is about as stiff as a uniform bar of unit length, whose first elastic ω is π / √m.
    reference = np.pi * np.abs(modes.mixture @ modes.fields.states[:, :, 0]).max()
    for _ in range(CORRECTIONS):
        found = _attachment_modes_at(modes, shaft, loads, FREE_SHIFT * reference)
        if found is None or reference / NEAR_ENOUGH < found[2][0] < NEAR_ENOUGH * reference:
            break
        reference = found[2][0]
    return found


def _attachment_modes_at(
    modes: LateralModes | RodModes, shaft: DiscretisedShaft, loads: list[tuple[int, int]], shift: float
) -> Attachments | None:
    """Attachment modes by the response to loads at ω² = −(shift)²."""
    static = ShaftFields(shaft, np.full(len(loads), -(shift**2)), responses(shaft, loads, -(shift**2)))
    fields = modes.fields.on(shaft).joined(static)
    mixture = _residuals(fields, modes.mixture, int(np.count_nonzero(modes.frequencies == 0.0)), len(loads))
    if mixture.shape[0] == 0:
        return None
    squared, vectors = ritz_vectors(*fields.energies(mixture))
    return fields, vectors.T @ mixture, np.sqrt(np.maximum(squared, 0.0))


def _residuals(fields: ShaftFields, modes: FloatArray, zeros: int, count: int) -> FloatArray:
    """Return combinations of fields that span the last ``count`` of them less the modes, (r, fields).

    The first ``zeros`` modes are rigid. They are removed first: the response of a nearly free shaft is almost all
    rigid, and the residual is a part of the small remainder.
    """
    carried = np.hstack([modes, np.zeros((modes.shape[0], count))])
    rows = np.hstack([np.zeros((count, modes.shape[1])), np.eye(count)])
    rows = rows / fields.mass_norms(rows)[:, None]
    rows = _without(fields, rows, carried[:zeros])
    rows = rows / fields.mass_norms(rows)[:, None]
    rows = _without(fields, rows, carried)
    left = fields.mass_norms(rows)
    rows, left = rows[left > NOTHING_LEFT], left[left > NOTHING_LEFT]
    if rows.shape[0] == 0:
        return rows
    rows /= left[:, None]
    values, vectors = np.linalg.eigh(fields.mass_products(rows, rows))
    independent = values > 1e-9
    return np.asarray((vectors[:, independent] / np.sqrt(values[independent])).T @ rows)


def _without(fields: ShaftFields, rows: FloatArray, modes: FloatArray) -> FloatArray:
    """Remove the components of combinations along orthonormal modes; twice, to remove rounding."""
    for _ in range(2 if modes.size else 0):
        rows = rows - fields.mass_products(rows, modes) @ modes
    return rows
