"""Residual attachment modes: the static compliance at loaded places that a truncated basis lacks."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy import linalg

from .fields import Fields
from .lateral import LateralModes, lateral_modes
from .search import require_positions
from .shapes import responses, ritz_vectors

FloatArray = npt.NDArray[np.float64]

# A residual smaller than this part of the static response is rounding: the basis has it already.
NOTHING_LEFT = 1e-7
# A free shaft has no static response: a shift of ω² this far below its first elastic ω stands in for it.
FREE_SHIFT = 1e-3


def attach_loads(
    modes: LateralModes, *, forces_at: Sequence[float] = (), moments_at: Sequence[float] = ()
) -> LateralModes:
    """Modes, and behind them vectors that make their static response to point loads exact.

    The static response to a unit force or moment at each place, less what the modes already carry, is
    made orthonormal in mass and diagonal in stiffness. The modes proper stay as they were; the vectors
    added have frequencies too (Rayleigh quotients, not natural frequencies), so that the whole set enters
    a coupled model like any other. On a free shaft the response is taken at ω² slightly below zero.

    Parameters
    ----------
    modes
        A certified set from `rotors.solve_lateral_modes`, with one mode or more.
    forces_at, moments_at
        Places of forces and of moments in the plane, m from the left end.

    Raises
    ------
    RotorError
        A place that is not on the shaft.
    """
    forces = require_positions(modes.stations, list(forces_at))
    moments = require_positions(modes.stations, list(moments_at))
    chain = modes.fields.chain.with_nodes(np.concatenate([forces, moments]))
    loads = [(chain.node_at(place), 0) for place in forces] + [(chain.node_at(place), 1) for place in moments]
    loads = [load for load in dict.fromkeys(loads) if not chain.constrained[load]]
    if not loads:
        return modes
    elastic = modes.frequencies[modes.frequencies > 0.0]
    is_free = chain.rigid_shapes.shape[0] > 0
    reference = elastic[0] if elastic.size else 1.0
    squared_shift = -((FREE_SHIFT * reference) ** 2) if is_free else 0.0
    static = Fields(chain, np.full(len(loads), squared_shift), responses(chain, loads, squared_shift))
    fields = modes.fields.on(chain).joined(static)
    mixture = _residuals(fields, modes.mixture, len(loads))
    if mixture.shape[0] == 0:
        return modes
    squared, vectors = ritz_vectors(*fields.energies(mixture))
    old = np.hstack([modes.mixture, np.zeros((modes.count, len(loads)))])
    return lateral_modes(
        np.concatenate([modes.frequencies, np.sqrt(np.maximum(squared, 0.0))]),
        fields,
        np.vstack([old, vectors.T @ mixture]),
        modes.supports,
        modes.certificate,
    )


def _residuals(fields: Fields, modes: FloatArray, count: int) -> FloatArray:
    """Combinations of fields that span the last ``count`` of them less the modes, (r, fields)."""
    kept = np.hstack([modes, np.zeros((modes.shape[0], count))])
    rows = np.hstack([np.zeros((count, modes.shape[1])), np.eye(count)])
    size = np.sqrt(np.diag(fields.energies(rows)[0]))
    rows /= size[:, None]
    # Twice: the first projection of a nearly rigid response leaves rounding of its size.
    for _ in range(2):
        mass = fields.energies(np.vstack([kept, rows]))[0]
        rows = rows - mass[kept.shape[0] :, : kept.shape[0]] @ kept
    mass = fields.energies(rows)[0]
    left = np.sqrt(np.diag(mass))
    rows, left = rows[left > NOTHING_LEFT], left[left > NOTHING_LEFT]
    if rows.shape[0] == 0:
        return rows
    rows /= left[:, None]
    values, vectors = linalg.eigh(fields.energies(rows)[0])
    independent = values > 1e-9
    return np.asarray((vectors[:, independent] / np.sqrt(values[independent])).T @ rows)
