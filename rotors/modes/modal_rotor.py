"""Modal rotor: a rotor reduced to modes and residual attachment modes, and its bearings in modal form.

Both planes share the bending modes Φ at averaged bearing stiffness k̄ (TM-101442 Eqs. 7 to 13), so that q = (q_x, q_y)
obeys

    q̈ + [Ω (J ⊗ G) + C_b] q̇ + [I ⊗ diag(ω²) + K_s + K_c] q = Φᵀ f,        J = [[0, 1], [-1, 0]],

with the gyroscopic matrix G = ∫ Φ' dI_p Φ'ᵀ and, summed over the bearings, the compensation

    K_s = Σ diag(k_xx - k̄, k_yy - k̄) ⊗ Φ_b Φ_bᵀ

and the cross-coupling K_c = Σ [[0, k_xy], [k_yx, 0]] ⊗ Φ_b Φ_bᵀ (TM-104434 Eqs. 11 to 15). A bearing's tilt stiffness
enters in the same way with the slopes. The modes are followed by residual attachment modes for every load that a
bearing or a gear puts on the shaft: a lateral force at each of them, a moment and an axial force where a bearing
takes part in these motions or a gear has thrust, and a torque at every gear. They are the static response of the
truncated modes (Craig 2000), without which the shaft is too stiff at gears and bearings. Of a lumped rotor they
complete the motions of its masses: a place between these also bends without any mass, which no mode follows.

The participation factors of the modes belong to rigid motions of the ground. For a ground that moves rigidly,
u = q + R s, the modes are driven by -∫ φ R dm s'' over translation and over rotation of the sections. R is a
displacement along x (or y), a rotation of the shaft's axis about its left end in the plane of x (or y), or a motion
along the axis. The same integral with the polar inertia is the gyroscopic moment of a base that turns.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.errors import require, require_finite
from gearwhine.rotors.model.bearing import Bearing, RadialSupport
from gearwhine.rotors.model.segment import Segment, gauss_rule
from gearwhine.rotors.model.shaft import Rotor, station_inertias
from gearwhine.rotors.modes.lateral import LateralModes, solve_lateral_modes
from gearwhine.rotors.modes.residual_modes import add_attachment_modes, add_rod_attachment_modes
from gearwhine.rotors.modes.torsional_and_axial import (
    AxialModes,
    TorsionalModes,
    solve_axial_modes,
    solve_torsional_modes,
)
from gearwhine.rotors.transfer_matrix.rotor_shafts import bending_shaft, rod_shaft
from gearwhine.rotors.transfer_matrix.wittrick_williams import wittrick_williams_counts

_FRACTIONS, _WEIGHTS = gauss_rule(10)  # for intervals no longer than the shaft is thick


@dataclass(frozen=True)
class Participation:
    """Participation of m bending and a axial modes in rigid motions of the ground, integrals over the rotor.

    Attributes
    ----------
    displacement : ndarray, shape (m,)
        Integral ∫ φ dm [√kg].
    tilt : ndarray, shape (m,)
        Integral ∫ (z φ dm + β dI_d), z from the left end [√kg m].
    spin : ndarray, shape (m,)
        Integral ∫ β dI_p [√kg m].
    axial : ndarray, shape (a,)
        Integral ∫ ψ dm [√kg].
    """

    displacement: FloatArray
    tilt: FloatArray
    spin: FloatArray
    axial: FloatArray


def participation(rotor: Rotor, lateral: LateralModes, axial: AxialModes | None) -> Participation:
    """Participation of a rotor's modes and vectors in the rigid motions of its ground."""
    # At loads and where the section changes, the slopes of modes and attachment modes jump with the shear strain.
    nodes = lateral.fields.shaft.nodes
    places, inertias = _spread(rotor, nodes if axial is None else np.union1d(nodes, axial.fields.shaft.nodes))
    mass, diametral, polar = inertias.T
    displacement, slope = lateral.evaluate(places)
    along = np.zeros(0) if axial is None else axial.evaluate(places) @ mass
    return Participation(
        displacement @ mass, displacement @ (mass * places) + slope @ diametral, slope @ polar, np.asarray(along)
    )


def _spread(rotor: Rotor, cuts: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Quadrature places (p,) [m] and mass, diametral and polar inertia (p, 3) of the whole rotor there.

    No interval of the quadrature reaches over one of the ``cuts`` [m].
    """
    stations = rotor.stations
    places, inertias = [stations], [station_inertias(rotor, stations)]
    for part, left in zip(rotor.segments, rotor.joints[:-1].tolist(), strict=True):
        if rotor.mass_model == "lumped" or not isinstance(part, Segment):
            continue
        thinnest = min(outer for outer, _ in part.end_diameters)
        ends = np.linspace(0.0, 1.0, int(np.ceil(part.length / thinnest)) + 1)
        within = (cuts - left) / part.length
        ends = np.union1d(ends, within[(within > 0.0) & (within < 1.0)])
        fractions = (ends[:-1, None] + np.diff(ends)[:, None] * _FRACTIONS).ravel()
        lengths = (np.diff(ends)[:, None] * _WEIGHTS).ravel() * part.length
        sections = [part.section(float(fraction)) for fraction in fractions]
        mass = lengths * [section.mass_per_length for section in sections]
        polar = lengths * [section.polar_inertia_per_length for section in sections]
        places.append(left + fractions * part.length)
        inertias.append(np.column_stack([mass, 0.5 * polar, polar]))
    return np.concatenate(places), np.concatenate(inertias)


# Number of modes of a kind above which a wrong unit is assumed: every mode is a coordinate of a dense system.
MOST_MODES = 300
FEWEST_MODES = 4  # number of modes below which a frequency limit is taken as a mistake


@dataclass(frozen=True)
class ModalRotor:
    """A rotor reduced to modes and attachment vectors.

    Attributes
    ----------
    lateral : LateralModes
        The b bending modes and vectors, used in the x and in the y plane.
    torsional : TorsionalModes
        Torsional modes of the free shaft, the rigid rotation first.
    axial : AxialModes or None
        Axial modes of the free shaft, the rigid motion first; None where no bearing takes part in axial motion.
    bearings : tuple of Bearing
        The bearings whose averaged stiffness is in the bending modes.
    ports : tuple of float
        Places of bearings, gears and other forces from the left end [m].
    participation : Participation or None
        Participation of modes and vectors in the rigid motions of the ground.
    """

    lateral: LateralModes
    torsional: TorsionalModes
    axial: AxialModes | None = None
    bearings: tuple[Bearing, ...] = ()
    ports: tuple[float, ...] = ()
    participation: Participation | None = None

    @property
    def gyroscopic(self) -> FloatArray:
        """Gyroscopic matrix J ⊗ G over (q_x, q_y), (2 b, 2 b): times the speed [rad/s] it adds to the damping."""
        return gyroscopic_matrix(self.lateral.polar_inertia_matrix)

    @property
    def compensation(self) -> FloatArray:
        """Compensation K_s over (q_x, q_y), (2 b, 2 b) [1/s²]."""
        return self._bearing_sum("stiffness", np.eye(2)) - np.kron(np.eye(2), self.lateral.support_matrix)

    @property
    def cross_coupling(self) -> FloatArray:
        """Cross-coupling K_c over (q_x, q_y), (2 b, 2 b) [1/s²]; unsymmetric where that of the bearings is."""
        return self._bearing_sum("stiffness", 1.0 - np.eye(2))

    @property
    def bearing_damping(self) -> FloatArray:
        """Damping C_b of the bearings over (q_x, q_y), (2 b, 2 b) [1/s]."""
        return self._bearing_sum("damping", np.ones((2, 2)))

    @property
    def static_error(self) -> float:
        """Largest share of the static compliance at a port that the modes lack without the attachment modes.

        Zero for a rotor that its bearings leave free, which has no static compliance.
        """
        frequencies, proper = self.lateral.frequencies, self.lateral.certificate.found
        if not self.ports or bool((frequencies <= 0.0).any()):
            return 0.0
        shares = (self.lateral.evaluate(self.ports)[0] / frequencies[:, None]) ** 2
        return float((shares[proper:].sum(axis=0) / shares.sum(axis=0)).max())

    @property
    def size(self) -> int:
        """Number of coordinates n: two planes of bending, torsion, and motion along the axis, in this order."""
        return 2 * self.lateral.count + self.torsional.count + (0 if self.axial is None else self.axial.count)

    def motions(self, at: float) -> FloatArray:
        """Motion of the section at a place [m]: x, y, z, rotations about x and y, by all coordinates, (5, n)."""
        bending = 2 * self.lateral.count
        along = np.zeros((0, 1)) if self.axial is None else self.axial.evaluate([at])
        (section,) = section_motions(*self.lateral.evaluate([at]), along)
        rows = np.zeros((5, self.size))
        rows[:, :bending] = section[:, :bending]
        rows[:, bending + self.torsional.count :] = section[:, bending:]
        return rows

    def rotation(self, at: float) -> FloatArray:
        """Rotation about the axis of the section at a place [m], by all coordinates, (n,)."""
        row, first = np.zeros(self.size), 2 * self.lateral.count
        row[first : first + self.torsional.count] = self.torsional.evaluate([at])[:, 0]
        return row

    def _bearing_sum(self, matrix_name: str, chosen: FloatArray) -> FloatArray:
        """Sum over the bearings of the ``chosen`` entries (2, 2) of their matrices, on displacements and on slopes."""
        size = 2 * self.lateral.count
        total = np.zeros((size, size))
        # The plane that x, y and the rotations about x and y belong to; z moves no bending coordinate.
        plane = np.array([0, 1, 0, 1, 0])
        for bearing in self.bearings:
            matrix = bearing.spatial_stiffness if matrix_name == "stiffness" else bearing.spatial_damping
            motions = self.motions(bearing.at)[:, :size]
            total += motions.T @ (matrix * chosen[np.ix_(plane, plane)]) @ motions
        return total


def gyroscopic_matrix(polar_inertia: FloatArray) -> FloatArray:
    """Gyroscopic matrix J ⊗ G over (q_x, q_y) of both planes, (2 b, 2 b), from G (b, b): per rad/s of the speed."""
    return np.kron(np.array([[0.0, 1.0], [-1.0, 0.0]]), polar_inertia)


def section_motions(displacement: FloatArray, slope: FloatArray, along: FloatArray) -> FloatArray:
    """Motions of sections by the coordinates of both planes and of the axis, (p, 5, 2 b + a).

    Rows are x, y, z and the rotations about x and y: the slope in x is the rotation about y, the slope in y minus that
    about x.

    Parameters
    ----------
    displacement, slope : ndarray, shape (b, p)
        Displacement and slope of the planar motions at p places.
    along : ndarray, shape (a, p)
        Displacements of the axial motions.
    """
    b, places = displacement.shape
    rows = np.zeros((places, 5, 2 * b + along.shape[0]))
    rows[:, 0, :b] = rows[:, 1, b : 2 * b] = displacement.T
    rows[:, 2, 2 * b :] = along.T
    rows[:, 3, b : 2 * b] = -slope.T
    rows[:, 4, :b] = slope.T
    return rows


def modal_rotor(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    *,
    frequency_limit: float | None = None,
    count: int | None = None,
    gears_at: Sequence[float] = (),
    forces_at: Sequence[float] = (),
    moments_at: Sequence[float] = (),
    thrusts_at: Sequence[float] = (),
) -> ModalRotor:
    """Reduce a rotor to its modes and to residual attachment modes that make the compliance of its ports exact.

    Parameters
    ----------
    rotor, bearings : Rotor, sequence of Bearing
        The rotor and its bearings; those with tables over speed at their speed (`Bearing.at_speed`).
    frequency_limit : float
        rad/s: every bending and torsional mode below it is kept, and at least four bending modes.
    count : int
        Number of bending modes in each plane and of torsional modes, the rigid rotation included, instead.
    gears_at : sequence of float
        Places of the forces and torques of gears, from the left end [m].
    forces_at : sequence of float
        Places of other lateral forces, such as those of a bow, from the left end [m].
    moments_at : sequence of float
        Places of bending moments in addition to those of bearings that resist tilting: helical gears, and
        bearings whose resistance is not in their matrices.
    thrusts_at : sequence of float
        Places of axial forces in addition to those of bearings that resist them; without effect where none does.

    Raises
    ------
    RotorError
        Both or neither of a limit and a count, or places off the shaft.
    IncompleteModesError
        The modes fail their proof.
    """
    exactly_one = (frequency_limit is None) != (count is None)
    require(exactly_one, "frequency_limit and count", (frequency_limit, count), "one of the two")
    supports = tuple(bearing.mean_support for bearing in bearings)
    _require_few(rotor, supports, frequency_limit, count)
    lateral = solve_lateral_modes(rotor, supports, frequency_limit=frequency_limit, count=count)
    torsional = solve_torsional_modes(rotor, frequency_limit=frequency_limit, count=count)
    ports = (*(bearing.at for bearing in bearings), *gears_at, *forces_at)
    if frequency_limit is not None and lateral.count < FEWEST_MODES:
        least = min(FEWEST_MODES, bending_shaft(rotor, supports).available_modes)
        lateral = solve_lateral_modes(rotor, supports, count=int(least))
    if frequency_limit is not None and torsional.count < FEWEST_MODES:
        least = min(FEWEST_MODES, rod_shaft(rotor, (), "torsion").available_modes)
        torsional = solve_torsional_modes(rotor, count=int(least))
    tilted = [bearing.at for bearing in bearings if not {3, 4}.isdisjoint(bearing.axes)]
    lateral = add_attachment_modes(lateral, forces_at=ports, moments_at=(*tilted, *moments_at))
    torsional = add_rod_attachment_modes(torsional, gears_at)
    axial = _axial(rotor, bearings, frequency_limit, count, thrusts_at)
    return ModalRotor(lateral, torsional, axial, tuple(bearings), ports, participation(rotor, lateral, axial))


def _require_few(
    rotor: Rotor, supports: Sequence[RadialSupport], frequency_limit: float | None, count: int | None
) -> None:
    """Raise `RotorError` where more modes are requested than `MOST_MODES`."""
    most = f"{MOST_MODES} or fewer: a lower frequency_limit, or a shaft less soft"
    if count is not None:
        require(count <= MOST_MODES, f"rotor {rotor.name!r}: number of modes", count, most)
    if frequency_limit is None:
        return
    require_finite("frequency_limit", frequency_limit, positive=True)
    for kind, continuous_shaft in (
        ("bending", bending_shaft(rotor, supports)),
        ("torsional", rod_shaft(rotor, (), "torsion")),
    ):
        (number,) = wittrick_williams_counts([continuous_shaft.cut(frequency_limit)], frequency_limit)
        below = f"below {frequency_limit / (2.0 * np.pi):.5g} Hz"
        require(number <= MOST_MODES, f"rotor {rotor.name!r}: number of {kind} modes {below}", number, most)


def _axial(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    frequency_limit: float | None,
    count: int | None,
    thrusts_at: Sequence[float],
) -> AxialModes | None:
    """Free axial modes with attachment modes at the axial bearings; None without axial bearings."""
    thrust = [bearing.at for bearing in bearings if 2 in bearing.axes]
    if not thrust:
        return None
    modes = solve_axial_modes(rotor, frequency_limit=frequency_limit, count=count)
    return add_rod_attachment_modes(modes, (*thrust, *thrusts_at))
