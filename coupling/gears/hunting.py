"""Hunting period: the loaded mesh over it, with each different mesh period solved once.

Mesh periods differ by the pairs that can touch in them: by their pitch gaps and their damaged teeth. One cracked tooth
makes a few mesh periods different from all others, however long the hunting period is; only pitch deviations of both
gears make every mesh period different.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from coupling.gears.pair_geometry import IntArray
from coupling.gears.static import LoadedMesh, loaded_transmission_error, mesh_period_phases
from coupling.gears.tooth_contact import ToothContact

FloatArray = npt.NDArray[np.float64]

_AT_ONCE = 1000
"""Phases solved together: more, with face slices, exceed the processor's cache."""


def hunting_period_mesh(contact: ToothContact, force: float, points: int = 60) -> LoadedMesh:
    """Equilibrium of the mesh under a load over the hunting period.

    Parameters
    ----------
    contact : ToothContact
    force : float
        Along the line of action [N], at least 0.
    points : int
        Equally spaced phases of a mesh period, see `mesh_period_phases`.

    Returns
    -------
    StaticMesh
        Result of `loaded_transmission_error` at the phases of ``contact.hunting_period`` mesh periods.

    Raises
    ------
    GearError, ContactAccuracyError
        As `loaded_transmission_error` does.
    """
    period = mesh_period_phases(contact, points)
    first, which = _different_periods(contact)
    at = (first[:, None] + period).ravel()
    parts = [
        loaded_transmission_error(contact, force, at[begin : begin + _AT_ONCE]) for begin in range(0, at.size, _AT_ONCE)
    ]

    def over_all(rows: list[FloatArray]) -> FloatArray:
        solved = np.concatenate(rows)
        return solved.reshape(first.size, period.size, *solved.shape[1:])[which].reshape(-1, *solved.shape[1:])

    loads = [part.line_loads for part in parts if part.line_loads is not None]
    return replace(
        parts[0],
        phases=(np.arange(which.size)[:, None] + period).ravel(),
        transmission_error=over_all([part.transmission_error for part in parts]),
        positions=over_all([part.positions for part in parts]),
        pair_forces=over_all([part.pair_forces for part in parts]),
        tangent_stiffness=over_all([part.tangent_stiffness for part in parts]),
        secant_stiffness=over_all([part.secant_stiffness for part in parts]),
        line_loads=over_all(loads) if loads else None,
    )


def _different_periods(contact: ToothContact) -> tuple[IntArray, IntArray]:
    """First mesh period of every kind, and the kind of each mesh period of the hunting period."""
    start, end = contact.contact_range
    entered = np.arange(contact.hunting_period)[:, None] - np.arange(math.floor(start), math.ceil(end))
    own = [
        values[entered % values.size]
        for values in (contact.pitch_gaps, contact.pair_variants.astype(np.float64))
        if values.size
    ]
    if not own:
        return np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64)
    _, first, which = np.unique(np.concatenate(own, axis=1), axis=0, return_index=True, return_inverse=True)
    return first, which.reshape(-1)
