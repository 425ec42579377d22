r"""Mesh friction under a steady load: sliding friction force, moments on both gears, power loss and efficiency.

At the distances xi_k and xi_i of a contact from both tangent points the flanks move along each other, across the line
of action, with ``w_k xi_k`` and ``w_i xi_i``; these are equal at the pitch point. Before it the driven flank is the
faster one and draws the driver's along with mu F, after it the force is reversed. With t the direction in which the
driver's flank moves, on the driver

    Q = sum_j mu F_j sgn(w_i xi_i - w_k xi_k),        M_k = sum_j mu F_j sgn(...) xi_k,

on the driven gear -Q and, against its rotation, ``sum_j mu F_j sgn(...) xi_i``; the power lost is
``sum_j mu F_j |w_k xi_k - w_i xi_i|``. The loads are those without friction, F_j the normal ones: those in the
transverse plane over cos(beta_b), the flanks of helical gears sliding in that plane too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearwhine.coupling.gears.contact.contact_law import ToothContact
from gearwhine.coupling.gears.contact.sliding_friction import sliding_direction_means
from gearwhine.coupling.gears.errors import require_finite
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry
from gearwhine.coupling.gears.loaded.transmission_error import LoadedMesh, period_mean
from gearwhine.numerics.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class MeshFriction:
    """Friction of a loaded mesh at n phases.

    Attributes
    ----------
    phases : ndarray, shape (n,)
        Mesh periods.
    force : ndarray, shape (n,)
        Force Q on the driver, across the line of action in the direction in which its flanks move [N].
    driver_moment, driven_moment : ndarray, shape (n,)
        Moments on the driver in the sense of its rotation, and on the driven gear against its rotation [N m].
    loss : ndarray, shape (n,)
        Energy lost per radian of the driver's rotation [J/rad]: times the driver's speed, the power loss.
    efficiency : float
        Output work over input work, mean over the mesh period.
    """

    phases: FloatArray
    force: FloatArray
    driver_moment: FloatArray
    driven_moment: FloatArray
    loss: FloatArray
    efficiency: float


def mesh_friction(
    geometry: GearPairGeometry, contact: ToothContact, mesh: LoadedMesh, coefficient: float
) -> MeshFriction:
    """Friction of a gear mesh under its static loads.

    Parameters
    ----------
    geometry : GearPairGeometry
    contact : ToothContact
        Contact law with which `mesh` was solved.
    mesh : LoadedMesh
        Loaded mesh at phases over whole mesh periods.
    coefficient : float
        Coefficient of friction, mu.

    Raises
    ------
    GearError
        For a coefficient that is negative or not finite.
    """
    require_finite("friction coefficient", coefficient, minimum=0.0)
    if contact.faces is not None and mesh.line_loads is not None:
        positions, half = mesh.positions[..., None] + contact.faces.shift, contact.faces.half_span
        forces = mesh.line_loads * contact.faces.width
    else:
        positions, half, forces = mesh.positions[..., None], 0.0, mesh.pair_forces[..., None]
    signed, moment = sliding_direction_means(positions, half, geometry.pitch_point_position, geometry.contact_ratio)
    normal = coefficient * forces / math.cos(geometry.driver.base_helix_angle)
    # Before the pitch point the force is positive, and both distances are straight lines along the path.
    across, by_position = -(normal * signed).sum(axis=(1, 2)), -(normal * moment).sum(axis=(1, 2))
    driver_moment, driven_moment = (
        abs(gear.base_radius) * (roll(0.0) * across + (roll(1.0) - roll(0.0)) * by_position)
        for gear, roll in (
            (geometry.driver, geometry.driver_roll_angle),
            (geometry.driven, geometry.driven_roll_angle),
        )
    )
    lost = driven_moment / abs(geometry.ratio) - driver_moment  # the sliding over the driver's speed
    put_in = mesh.force * abs(geometry.driver.base_radius)
    mean = period_mean(mesh.phases, lost)
    return MeshFriction(
        mesh.phases,
        across,
        driver_moment,
        driven_moment,
        lost,
        1.0 - mean / put_in if put_in > 0.0 else 1.0,
    )
