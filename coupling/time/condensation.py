"""Static condensation (Guyan) of residual coordinates that are too stiff for a time integration.

The stiffness of a residual coordinate of the housing matters, its frequency does not. Where this frequency lies within
those of the other coordinates it is integrated like them, and its inertia improves the response below. Where it lies
above, no step should be refined for it: it is in equilibrium at all times,

    K_rr q_r + K_rk q_k = 0,        q = T q_k,        T = [I; -K_rr⁻¹ K_rk],

which takes K, C, the contacts' directions and the loads to Tᵀ K T and so on (Guyan's condensation of the stiffness;
MacNeal's residual flexibility without its mass), and keeps the static compliance exact. The error by dampers that act
on q_r is w C/K of its bearing at a circular frequency w, and the square of that in the retained coordinates.

The condensed connectors' matrices are of low rank: they are kept on the common subspace in which they act. Coordinates
on which a connector acts whose directions turn are retained: their equilibrium would turn too.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.description.parts import LATERAL_LIMIT_HZ
from gearwhine.coupling.machine.components import Component, RotorComponent
from gearwhine.coupling.machine.connectors import (
    ContactConnector,
    LinearConnector,
    NonlinearConnector,
    Sliding,
    TurningPart,
)
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.time.turning_directions import law_directions
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.modes.modal_rotor import FEWEST_MODES

Law = TypeVar("Law", LinearConnector, NonlinearConnector, Sliding)

_DEFAULT_LIMIT = 2.0 * np.pi * LATERAL_LIMIT_HZ
_ABOVE_CERTIFIED = 1.0 + 1e-6  # ratio to the highest certified mode from which a frequency is above it
_SINGULAR_VALUE_ROUNDING = 1e-13  # part of a matrix's largest singular value that is rounding


def common_span(matrices: list[FloatArray]) -> tuple[FloatArray, list[FloatArray]]:
    """Orthonormal directions U in which all the matrices act, M = U (Uᵀ M U) Uᵀ, and their cores Uᵀ M U.

    Returns
    -------
    directions : ndarray, shape (n, r)
    cores : list of ndarray, shape (r, r)
    """
    scaled = [matrix / scale for matrix in matrices if (scale := float(np.abs(matrix).max(initial=0.0))) > 0.0]
    n = len(matrices[0])
    if not scaled:
        return np.zeros((n, 0)), [np.zeros((0, 0)) for _ in matrices]
    # Coordinates without any entry have no part in the decomposition.
    touched = np.any([np.any(matrix, axis=0) | np.any(matrix, axis=1) for matrix in scaled], axis=0)
    among = np.ix_(touched, touched)
    beside = np.hstack([part for m in scaled for part in (m[among], m[among].T)])
    left, sizes, _ = np.linalg.svd(beside, full_matrices=False)
    count = int(np.count_nonzero(sizes > _SINGULAR_VALUE_ROUNDING * sizes[0]))
    directions = np.zeros((n, count))
    directions[touched] = left[:, :count]
    return directions, [directions.T @ matrix @ directions for matrix in matrices]


@dataclass(frozen=True)
class Condensed:
    """A condensed system, and the recovery of all coordinates.

    Attributes
    ----------
    system : CoupledSystem
        System of the m retained coordinates, in their order, with one connector in place of all linear ones.
    kept : ndarray of int, shape (m,)
        Numbers of the retained coordinates among the n coordinates.
    recovery : ndarray, shape (n, m)
        Matrix T from the retained coordinates to all coordinates.
    """

    system: CoupledSystem
    kept: npt.NDArray[np.int64]
    recovery: FloatArray


def with_static_attachments(system: CoupledSystem) -> CoupledSystem:
    """Return a system with planets in which modes of shafts above their limit are residual.

    They carry the static response of the truncated modes, of a short shaft at frequencies that no step should resolve.
    Systems without planets are returned as they are.
    A shaft keeps modes up to a limit, those certified, and at least so few that the limit may be below them: of as few,
    those below the default limit count.
    """
    if not any(isinstance(one, RotorComponent) and one.carrier is not None for one in system.components):
        return system
    return replace(system, components=tuple(map(_with_static_attachments, system.components)))


def _with_static_attachments(component: Component) -> Component:
    if not isinstance(component, RotorComponent):
        return component
    modal = component.modal
    certified = [modes.frequencies[: modes.certificate.found] for modes in (modal.lateral, modal.torsional)]
    limit = max(
        float(found.max(initial=0.0) if len(found) > FEWEST_MODES else min(found.max(initial=0.0), _DEFAULT_LIMIT))
        for found in certified
    )
    own = np.sqrt(np.abs(np.diag(component.stiffness)))
    is_static = (own > _ABOVE_CERTIFIED * limit) & np.isin(component.kinds, ["rotor", "torsion", "axial"])
    kinds = tuple("residual" if static else kind for kind, static in zip(component.kinds, is_static, strict=True))
    return replace(component, kinds=kinds)


def condensed(system: CoupledSystem) -> Condensed:
    """Condense the residual coordinates that are stiffer than all others.

    A system without such coordinates is returned as it is, as is one whose connectors change with the speed: the
    condensation would have to change with them.
    """
    stiff = _stiff(system)
    if not stiff.any() or len(system.connector_speed_ratios) > 1:
        return Condensed(system, np.arange(system.size), np.eye(system.size))
    is_retained = ~stiff
    condensed_coordinates, retained = np.flatnonzero(stiff), np.flatnonzero(is_retained)
    # What the turning of a frame adds to a coordinate without inertia is nothing beside its stiffness.
    resting = replace(system, components=tuple(replace(one, frame=None) for one in system.components))
    stiffness, damping = resting.stiffness, resting.damping
    follow = -np.linalg.solve(
        stiffness[np.ix_(condensed_coordinates, condensed_coordinates)],
        stiffness[np.ix_(condensed_coordinates, retained)],
    )
    recovery = np.zeros((system.size, len(retained)))
    recovery[retained], recovery[condensed_coordinates] = np.eye(len(retained)), follow
    # Retained coordinates gain connectors between them that act in few directions.
    crossing = damping[np.ix_(retained, condensed_coordinates)] @ follow
    standing = replace(system, linear=tuple(one for one in system.linear if not one.turning))
    linked = [part[np.ix_(retained, retained)] for part in standing.connector_matrices()]
    linked[0] = linked[0] + stiffness[np.ix_(retained, condensed_coordinates)] @ follow
    linked[1] = (
        linked[1]
        + crossing
        + follow.T @ damping[np.ix_(condensed_coordinates, retained)]
        + follow.T @ damping[np.ix_(condensed_coordinates, condensed_coordinates)] @ follow
    )
    directions, (connector_stiffness, connector_damping) = common_span(linked)
    less = CoupledSystem(
        components=tuple(_part(component, among) for component, among in _members(system, is_retained)),
        speeds=system.speeds,
        linear=(
            LinearConnector("condensed", directions, connector_stiffness, connector_damping),
            *(_projected(connector, recovery) for connector in system.linear if connector.turning),
        ),
        contacts=tuple(_reduced(contact, recovery) for contact in system.contacts),
        load=system.load @ recovery,
        harmonic_loads=tuple(replace(load, amplitude=load.amplitude @ recovery) for load in system.harmonic_loads),
        timed_loads=tuple(replace(load, direction=load.direction @ recovery) for load in system.timed_loads),
        acceleration_load=system.acceleration_load @ recovery,
        centrifugal_load=system.centrifugal_load @ recovery,
        nonlinear=tuple(_projected(connector, recovery) for connector in system.nonlinear),
    )
    return Condensed(less, retained, recovery)


def _members(system: CoupledSystem, mask: npt.NDArray[np.bool_]) -> Iterator[tuple[Component, npt.NDArray[np.int64]]]:
    """Each component, with the numbers of its retained coordinates."""
    start = 0
    for component in system.components:
        yield component, np.flatnonzero(mask[start : start + component.size])
        start += component.size


def _reduced(contact: ContactConnector, recovery: FloatArray) -> ContactConnector:
    sliding = contact.sliding
    if sliding is not None:
        sliding = _projected(sliding, recovery)
    turning = _turning(contact.turning, recovery)
    return replace(contact, direction=contact.direction @ recovery, sliding=sliding, turning=turning)


def _projected(law: Law, recovery: FloatArray) -> Law:
    directions, turning = recovery.T @ law.directions, _turning(law.turning, recovery)
    return replace(law, directions=directions, turning=turning)


def _turning(parts: tuple[TurningPart, ...], recovery: FloatArray) -> tuple[TurningPart, ...]:
    return tuple(part.projected(recovery) for part in parts)


def _part(component: Component, among: npt.NDArray[np.int64]) -> Component:
    """Reduce a component to some of its coordinates."""
    square = np.ix_(among, among)
    return Component(
        component.name,
        tuple(component.kinds[i] for i in among),
        component.stiffness[square],
        component.damping[square],
        component.gyroscopic[square],
        frame=None if component.frame is None else component.frame.among(among),
    )


def _stiff(system: CoupledSystem) -> npt.NDArray[np.bool_]:
    """Mask of residual coordinates beyond the highest frequency of the others on which no load or law acts."""
    loaded = system.load != 0.0
    loaded |= system.acceleration_load != 0.0
    for load in [*(load.amplitude for load in system.harmonic_loads), *(load.direction for load in system.timed_loads)]:
        loaded = loaded | (load != 0.0)
    for law in law_directions(system):
        for part in (law.directions, *(one for turn in law.turning for one in (turn.cosine, turn.sine))):
            loaded = loaded | np.any(part != 0.0, axis=1)
    beyond = np.diag(system.stiffness) > system.highest_frequency**2
    return np.asarray(~system.resolved & beyond & ~loaded)
