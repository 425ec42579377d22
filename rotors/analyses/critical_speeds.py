"""Critical speeds of a rotor, where a whirl frequency equals the speed, and the undamped critical-speed map.

The map shows the forward critical speeds over the stiffness of the bearings. In isotropic bearings forward synchronous
whirl is a planar problem: with Ω = ω the rotary inertia enters as (I_d − I_p) ω², here a circular block of
`gearwhine.rotors.whirl.equations` at λ = iω and Ω = ω. Every curve is exact, and at every stiffness the number of its
points is proved by the count of `gearwhine.rotors.whirl.completeness`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.analyses.campbell import campbell
from gearwhine.rotors.certificate import ACCEPTED, ModeCertificate
from gearwhine.rotors.errors import RotorError, require, require_count
from gearwhine.rotors.model.bearing import Bearing, undamped
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.whirl.circular_coordinates import coupled_motions
from gearwhine.rotors.whirl.completeness import NO_OSCILLATION, is_conservative
from gearwhine.rotors.whirl.eigenvalues import SYNCHRONOUS
from gearwhine.rotors.whirl.modal_projection import ModalProjection
from gearwhine.rotors.whirl.planar_basis import DEFAULT_COUNT, planar_basis
from gearwhine.rotors.whirl.whirl_modes import MOSTLY_AXIAL, WhirlRoots, WhirlSolver, certified_whirl

# Number of speeds of a diagram that is searched, and the factor beyond them up to which branches are followed.
DIAGRAM_SPEEDS = 60
DIAGRAM_REACH = 1.2


@dataclass(frozen=True)
class CriticalSpeeds:
    """Speeds at which the rotor whirls once per turn.

    Attributes
    ----------
    speeds : ndarray, shape (c,)
        Critical speeds, ascending [rad/s].
    direction : ndarray, shape (c,)
        Whirl direction: 1 circular forward, −1 circular backward, 0 planar, as in `gearwhine.rotors.WhirlModes`.
    axial_share : ndarray, shape (c,)
        Part of the kinetic energy along the axis, as in `gearwhine.rotors.WhirlModes`.
    certificate : ModeCertificate
        Proof that none is missing.
    """

    speeds: FloatArray
    direction: FloatArray
    axial_share: FloatArray
    certificate: ModeCertificate

    @property
    def lateral(self) -> "CriticalSpeeds":
        """The critical speeds of lateral motion, without mostly axial ones, which no unbalance drives."""
        is_lateral = self.axial_share <= MOSTLY_AXIAL
        return replace(
            self,
            speeds=self.speeds[is_lateral],
            direction=self.direction[is_lateral],
            axial_share=self.axial_share[is_lateral],
        )

    @property
    def forward(self) -> FloatArray:
        """The speeds that unbalance excites: those whose whirl is not purely backward, nor mostly along the axis."""
        return np.asarray(self.speeds[(self.direction > -1.0 + 1e-6) & (self.axial_share <= MOSTLY_AXIAL)])


def critical_speeds(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    *,
    speed_limit: float | None = None,
    count: int | None = None,
) -> CriticalSpeeds:
    """Undamped critical speeds: where a whirl frequency Im λ in undamped bearings equals the speed of rotation Ω.

    In bearings of constant symmetric stiffness λ = iω, the gyroscopic term joins the mass at Ω = ω, and all of them are
    roots of one eigenproblem,

        K q = ω² [[M, −i G], [i G, M]] q

    over both planes; a disc whose polar inertia exceeds its diametral one takes its forward root away.
    Where stiffness depends on speed or its cross-coupling drives whirl (k_xy ≠ k_yx, λ with a real part), they are the
    crossings of a Campbell diagram of 60 speeds: in the range that the tables share, or of constants from rest to
    1.2 times the highest root of the eigenproblem, as far as the rotor can turn. Damping is left out, which is the
    usual definition; the damped whirl frequency crosses a little elsewhere, where `gearwhine.rotors.Campbell.crossings`
    has it.

    Parameters
    ----------
    rotor, bearings : Rotor, sequence of Bearing
        The rotor and its bearings.
    speed_limit : float, optional
        Speed strictly below which all critical speeds are found [rad/s].
    count : int, optional
        Number of critical speeds, instead of a limit; with neither, 12.

    Raises
    ------
    RotorError, IncompleteModesError
        As `gearwhine.rotors.solve_whirl`.
    """
    free = [undamped(bearing) for bearing in bearings]
    chosen = planar_basis(rotor, free, speed_limit, count)
    tables = [bearing.speeds for bearing in free if bearing.speeds is not None]
    if tables:
        low, high = max(float(table[0]) for table in tables), min(float(table[-1]) for table in tables)
        high = min(high, speed_limit or np.inf)
        require(low < high, "speeds of the bearings' tables", (low, high), "a range of speeds that they share")
        return _crossed_speeds(rotor, free, low, high, speed_limit, count)
    sets = [ModalProjection.of(rotor, free, blocks, chosen) for blocks in coupled_motions(free)]
    roots, certificate = certified_criticals(rotor, free, sets, speed_limit, count)
    speeds = roots.eigenvalues.imag
    if speeds.size and not is_conservative(free):
        high = min(speed_limit or DIAGRAM_REACH * float(speeds.max()), rotor.highest_speed)
        return _crossed_speeds(rotor, free, 0.0, high, speed_limit, count or speeds.size)
    order = np.argsort(speeds)
    motion = roots.motion
    return CriticalSpeeds(speeds[order], motion.direction[order], motion.axial_share[order], certificate)


def _crossed_speeds(
    rotor: Rotor, bearings: Sequence[Bearing], low: float, high: float, limit: float | None, count: int | None
) -> CriticalSpeeds:
    """Crossings of the Campbell diagram between two speeds."""
    diagram = campbell(rotor, bearings, np.linspace(low, high, DIAGRAM_SPEEDS), frequency_limit=DIAGRAM_REACH * high)
    crossings = [crossing for crossing in diagram.crossings() if crossing.speed < (limit or np.inf)][:count]
    speeds = np.array([crossing.speed for crossing in crossings])
    proof = ModeCertificate(high, speeds.size, speeds.size, ACCEPTED, "crossings")
    direction = np.array([crossing.direction for crossing in crossings])
    return CriticalSpeeds(speeds, direction, np.array([crossing.axial_share for crossing in crossings]), proof)


def certified_criticals(
    rotor: Rotor, bearings: Sequence[Bearing], sets: Sequence[ModalProjection], limit: float | None, count: int | None
) -> tuple[WhirlRoots, ModeCertificate]:
    """Certify critical speeds: synchronous whirl in undamped bearings, below a limit or the lowest by their number.

    ``sets`` holds one projection for each set of coupled motions.
    """
    return certified_whirl(
        WhirlSolver(rotor, bearings),
        bearings,
        [(one.blocks, one.critical(bearings)) for one in sets],
        SYNCHRONOUS,
        None,
        NO_OSCILLATION * sets[0].floor,
        limit,
        None if limit is not None else count or DEFAULT_COUNT,
        0.25 * np.pi,
    )


DEFAULT_CRITICALS = 4


@dataclass(frozen=True)
class CriticalSpeedMap:
    """Critical speeds over bearing stiffness.

    Attributes
    ----------
    stiffnesses : ndarray, shape (s,)
        Stiffness of every bearing [N/m].
    speeds : ndarray, shape (s, c)
        Critical speeds, ascending [rad/s]; NaN where a disc's polar inertia leaves fewer.
    direction : int
        1 of forward whirl, −1 of backward.
    """

    stiffnesses: FloatArray
    speeds: FloatArray
    direction: int = 1


def critical_speed_map(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    stiffnesses: npt.ArrayLike,
    *,
    count: int = DEFAULT_CRITICALS,
    direction: int = 1,
) -> CriticalSpeedMap:
    """Undamped critical speeds with every bearing's stiffness replaced by each of ``stiffnesses``.

    Parameters
    ----------
    rotor, bearings : Rotor, sequence of Bearing
        The rotor, and where its bearings are; a bearing's own stiffness and damping do not matter.
    stiffnesses : array_like, shape (s,)
        Stiffnesses [N/m], alike in all directions.
    count : int
        Number of critical speeds.
    direction : int
        1 for forward whirl, −1 for backward.

    Raises
    ------
    RotorError
        A stiffness that is not positive, no bearings, or another direction.
    IncompleteModesError
        A count and its roots do not agree.
    """
    values = np.atleast_1d(np.asarray(stiffnesses, dtype=np.float64))
    good = values.ndim == 1 and bool(np.isfinite(values).all() and (values > 0.0).all())
    require(good, "stiffnesses", values.tolist(), "positive numbers, N/m")
    require_count("count of critical speeds", count)
    require(direction in (1, -1), "direction", direction, "1 (forward) or -1 (backward)")
    if not bearings:
        raise RotorError(f"rotor {rotor.name!r} has no bearings; expected at least one to vary")
    rows = np.full((values.size, count), np.nan)
    for k, stiffness in enumerate(values.tolist()):
        replaced = [
            replace(b, stiffness=stiffness * np.eye(2), damping=np.zeros((2, 2)), speeds=None, pedestal=None)
            for b in bearings
        ]
        basis = planar_basis(rotor, replaced, None, 2 * count)
        projection = ModalProjection.of(rotor, replaced, (direction,), basis)
        roots, _ = certified_criticals(rotor, replaced, [projection], None, count)
        speeds = np.sort(roots.eigenvalues.imag)
        rows[k, : speeds.size] = speeds
    return CriticalSpeedMap(values, rows, direction)
