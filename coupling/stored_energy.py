"""Stored energy at the start of a time integration, in plain Python as it is evaluated once."""

import numpy as np
import numpy.typing as npt

from coupling.connector import SpeedTable
from coupling.kernel_arrays import Bearings, Contacts, Dynamics

FloatArray = npt.NDArray[np.float64]


def stored_energy(
    dynamics: Dynamics, contacts: Contacts, bearings: Bearings, q: FloatArray, v: FloatArray, turned: float, rate: float
) -> float:
    """Energy in teeth, nonlinear bearings and connectors that change with the speed [J], as in the kernel.

    Parameters
    ----------
    q, v : ndarray, shape (n,)
    turned : float
        Turned time s [s].
    rate : float
        s'.
    """
    energy = _of_connectors(dynamics, q, rate) if dynamics.connector_rates.size > 1 else 0.0
    c = contacts.phase.size
    delta, moved = contacts.direction @ q, contacts.direction[:c] @ v
    amplitude, w, phase = np.moveaxis(contacts.errors, 2, 0)
    angle = w * turned + phase
    delta[:c] -= contacts.clearance + (amplitude * np.cos(angle)).sum(axis=1)
    moved += (amplitude * w * rate * np.sin(angle)).sum(axis=1)
    if c > 0:
        energy += _of_teeth(contacts, delta, moved, turned)
    if bearings.axis.size > 0:
        energy += _of_bearings(bearings, c, delta, turned)
    return float(energy)


def _of_connectors(dynamics: Dynamics, q: FloatArray, rate: float) -> float:
    """½ qᵀ U K_t Uᵀ q, K_t linear between the speeds at which it is given."""
    law = SpeedTable(dynamics.connector_rates, dynamics.connector_stiffness, dynamics.connector_damping)
    tied = dynamics.connectors @ q
    return float(0.5 * tied @ law.at(rate)[0] @ tied)


def _of_teeth(contacts: Contacts, delta: FloatArray, moved: FloatArray, turned: float) -> float:
    from coupling.gears.kernels import tooth_force

    energy = 0.0
    for k, at in enumerate(contacts.law_at):
        phase = contacts.phase[k] + contacts.rate[k] * turned
        energy += tooth_force(phase, delta[k], moved[k], contacts.law, at)[3]
    return energy


def _of_bearings(bearings: Bearings, first: int, delta: FloatArray, turned: float) -> float:
    """Energy of the nonlinear part of the bearings' forces."""
    from coupling.bearing_kernels import evaluate_bearings

    tangents, held = np.zeros((bearings.preload.size, 5, 5)), np.zeros((8, 5))
    evaluate_bearings(bearings, first, turned, delta, np.zeros_like(delta), tangents, held)
    return float(held[0, 0])
