"""Operating point: static equilibrium of the whole machine under its torques, weight and preloads.

Shafts are exact Timoshenko beams between the stations of bearings, gears and torques, within the face of a solid gear
as stiff as its section with the teeth (:mod:`gearwhine.rotors.analyses.static_stiffness`,
:mod:`gearwhine.coupling.gears.geometry.toothed_section`). The housing is its modes with the residual ones, whose static
compliance at the seats is exact. Rolling bearings act by each of their elements, gear pairs by slices of their faces,
averaged over a mesh period (:mod:`gearwhine.coupling.gears.loaded.face_load`). Bearings, gear pairs and pedestals are
the connectors of this linear structure; their equilibrium with it is that of
:mod:`gearwhine.coupling.statics.connector_equilibrium`.

Rigid motions that nothing holds, such as the rotation of the train, must carry no load; they stay at zero.

From the equilibrium follow bearing loads and tangent stiffness, deflections, and for each gear pair the misalignment
of its flanks with its causes, the load over the face and its factor K_Hβ (ISO 6336-1), and the transmission error.
Friction of the teeth and the change of the load with the mesh phase are left out: the means over a mesh period act.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.description.parts import TorqueSupport
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears.loaded.contact_pressure import mesh_pressure
from gearwhine.coupling.gears.loaded.face_load import FaceLoad, face_load_factor
from gearwhine.coupling.gears.loaded.transmission_error import LoadedMesh, even_phases, mesh_period_phases, period_mean
from gearwhine.coupling.machine.bearing_laws import RollingLaw
from gearwhine.coupling.machine.mounted_parts import MountedBearing
from gearwhine.coupling.statics.static_model import (
    FaceContactLaw,
    StaticPair,
    StaticShaftPart,
)
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.rolling_bearings import RollingState
from gearwhine.rotors.rolling_bearings.equilibrium import require_held, rolling_state


@dataclass(frozen=True, eq=False)
class ShaftDeflection:
    """Deflection of a shaft at the operating point.

    Attributes
    ----------
    part : StaticShaftPart
    displacement : ndarray, shape (6 N,)
        Displacement of the nodes along and about x, y, z [m, rad].
    """

    part: StaticShaftPart
    displacement: FloatArray

    @property
    def name(self) -> str:
        """Name of the shaft."""
        return self.part.name

    def motions(self, z: npt.ArrayLike) -> FloatArray:
        """Motion of sections at positions from the left end (m,) [m]: along and about x, y, z, shape (6, m)."""
        return self.part.shaft.motions(self.displacement, z, self.part.acceleration)


@dataclass(frozen=True, eq=False)
class BearingLoad:
    """Load of a bearing at the operating point, over x, y, z and the rotations about x and y.

    Attributes
    ----------
    mounted : MountedBearing
    force : ndarray, shape (5,)
        Force of the shaft on the seat [N, N m].
    deflection : ndarray, shape (5,)
        Deflection of the shaft relative to the seat [m, rad].
    seat_motion : ndarray, shape (5,)
        Motion of the seat or pedestal [m, rad]; zero on rigid ground.
    stiffness : ndarray, shape (5, 5)
        Tangent stiffness over x, y, z and the rotations about x and y, in N/m, N/rad and N m/rad.
    rolling : RollingState or None
        Loads, angles and pressures of the elements of a rolling bearing.
    """

    mounted: MountedBearing
    force: FloatArray
    deflection: FloatArray
    seat_motion: FloatArray
    stiffness: FloatArray
    rolling: RollingState | None = None

    @property
    def name(self) -> str:
        """Name of the bearing."""
        return self.mounted.bearing.name

    @property
    def tilt(self) -> float:
        """Angle between the shaft and the seat's axis [rad]."""
        return float(np.hypot(*self.deflection[3:]))

    def require_held(self) -> None:
        """Raise `gearwhine.rotors.EquilibriumError` where :func:`linearised_about` does."""
        if self.mounted.needs_load and self.rolling is not None:
            require_held(self.rolling)

    def in_axes(self, angle: float) -> "BearingLoad":
        """Return the load along axes that are turned about z by an angle [rad]."""
        turn = np.eye(5)
        turn[:2, :2] = turn[3:, 3:] = [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
        of_vectors = {name: turn @ getattr(self, name) for name in ("force", "deflection", "seat_motion")}
        return replace(self, **of_vectors, stiffness=turn @ self.stiffness @ turn.T)


def linearised_about(loads: Sequence[BearingLoad]) -> MountedBearing:
    """Linearise a bearing about its loads where its stiffness follows from these; else return the bearing as it is.

    Over several loads, as over a turn of carriers, it has the mean tangent and the mean force at the mean deflection. A
    nonlinear law starts at the mean deflection, with its own force there.

    Raises
    ------
    gearwhine.rotors.EquilibriumError
        Where clearance leaves the shaft loose in x or y under the first load.
    """
    mounted, rolling = loads[0].mounted, loads[0].rolling
    if not mounted.needs_load or rolling is None:
        return mounted
    nominal, law = mounted.bearing, mounted.law
    force, deflection, stiffness = (
        np.mean([getattr(load, name) for load in loads], axis=0) for name in ("force", "deflection", "stiffness")
    )
    require_held(rolling)
    bearing = replace(nominal, stiffness=stiffness)
    if mounted.damping_time > 0.0:
        bearing = replace(bearing, damping=nominal.spatial_damping + mounted.damping_time * stiffness)
    if isinstance(law, RollingLaw):
        if len(loads) > 1:
            rolling = rolling_state(rolling.bearing, rolling.displacement + deflection - loads[0].deflection)
        return replace(mounted, bearing=bearing, law=replace(law, state=rolling))
    return replace(mounted, bearing=bearing, offset=force - stiffness @ deflection)


_FORCE_STEP = 1e-4  # step over a mesh force, in the differences of loads by the stiffness that follows it

# Largest gap over the face of spur teeth that counts as none, of the teeth's mean deflection, and at least [m]: the
# face carries evenly to half of that, and one spring for the face is ten times faster than one for each slice.
_EVEN_GAP, _LEAST_GAP = 0.01, 1e-9

CAUSES = ("shafts", "bearings", "housing", "carrier", "seats", "bodies")
"""Causes of misalignment: bending of the shafts, deflection of the bearings, motion of their seats, of planets that of
their pins on the carrier with the pins' bending and errors, errors of the seats' places, and the twist of shaft and
gear body over the face."""


@dataclass(frozen=True, eq=False)
class PairLoad:
    """A gear pair at the operating point.

    Attributes
    ----------
    pair : StaticPair
    force : float
        Mean mesh force along the line of action, transverse [N].
    approach : ndarray, shape (m,)
        Mean approach of the flanks over the components of the pair's contact [m, rad].
    misalignment : float
        Angle between the flanks in the plane of action, open towards +z [rad]. It is minus the slope of the approach's
        best straight line over the face.
    misalignment_by_cause : dict of str to float
        Parts of the misalignment by `CAUSES`, which add up to it [rad].
    loading : float
        Force under which the face is looked at [N]: the mesh force, or a small one of an idle pair.
    shape : ndarray, shape (m,)
        Approach but for its mean over the face.
    """

    pair: StaticPair
    force: float
    approach: FloatArray
    misalignment: float
    misalignment_by_cause: dict[str, float]
    loading: float
    shape: FloatArray

    @cached_property
    def mean(self) -> FaceLoad:
        """Face load at the phases of a mesh period for the means."""
        return self.pair.contact.under_force(self.loading, self.shape)

    @cached_property
    def fine(self) -> FaceLoad:
        """Face load at even phases of the mesh period, for the transmission error."""
        return self.pair.contact.under_force(self.loading, self.shape, even_phases())

    @cached_property
    def period(self) -> FaceLoad:
        """Face load at those phases and at both sides of every step and corner between them, see `mesh_period_phases`.

        Of helical teeth, which have none, it is `fine`.
        """
        phases = mesh_period_phases(self.pair.contact.tooth_contact)
        more = phases.size > even_phases().size
        return self.pair.contact.under_force(self.loading, self.shape, phases) if more else self.fine

    @property
    def names(self) -> tuple[str, str]:
        """Driver and driven gear."""
        return self.pair.driver.name, self.pair.driven.name

    @property
    def label(self) -> str:
        """Name of the pair, driver -> driven gear."""
        return " -> ".join(self.names)

    @property
    def loaded(self) -> "PairLoad | None":
        """The pair where it carries load; None for an idle one."""
        return self if self.force > 0.0 else None

    @property
    def known_face(self) -> "PairLoad | None":
        """The pair where its face width is known; None of teeth that touch in one point."""
        return self if self.pair.geometry.has_face else None

    @property
    def loaded_face(self) -> "PairLoad | None":
        """The pair where it carries load on a face of known width, by which alone line loads and pressures follow."""
        return self.known_face and self.loaded

    @property
    def misalignment_over_face(self) -> float:
        """Misalignment over the width of the face [m]."""
        return self.misalignment * self.pair.geometry.face_width

    @property
    def z(self) -> FloatArray:
        """Distance of the slices from the middle of the face [m], shape (s,)."""
        return self.pair.contact.z

    @property
    def gap(self) -> FloatArray:
        """Gap of the flanks over the face by the deflection of the machine, less its mean [m], shape (s,)."""
        over = self.pair.contact.over_face @ self.approach[:-1]
        return np.asarray(over.mean() - over)

    @property
    def station_gap(self) -> tuple[float, ...]:
        """Gap of the flanks at the stations of the face, less its mean [m], for the pair's ``face_gap``."""
        mean = float(self.pair.contact.face_mean @ self.approach)
        return tuple((mean - self.approach[:-1]).tolist())

    @property
    def tooth_deflection(self) -> float:
        """Mean deflection of the teeth under the load, by their mean stiffness [m]; 0 of an idle pair."""
        return self.force / self.mean_stiffness if self.force > 0.0 else 0.0

    @property
    def path_slope(self) -> float:
        """Slope of that gap along the line of action, by the tilt of the shafts against each other [1]."""
        return self.pair.axial * float(self.approach[-1])

    @property
    def line_load(self) -> FloatArray:
        """Transverse load per face width, all tooth pairs together, mean over the mesh period [N/m], shape (s,)."""
        return np.asarray(self.fine.line_load.mean(axis=0))

    @property
    def mean_line_load(self) -> float:
        """Mean line load F / b [N/m]."""
        return float(self.line_load.mean())

    @property
    def maximum_line_load(self) -> float:
        """Maximum line load K_Hβ F / b [N/m]."""
        return self.k_h_beta * self.mean_line_load

    @property
    def peak_line_load(self) -> float:
        """Largest line load over face and mesh period, all tooth pairs together [N/m]."""
        return float(self.fine.line_load.max())

    @cached_property
    def even(self) -> FaceLoad:
        """Load of the flanks under an even approach and without helix modifications, at ``fine.phases``."""
        return self.pair.contact.evenly(self.fine.force, self.fine.phases)

    @cached_property
    def k_h_beta(self) -> float:
        """Face load factor K_Hβ of ISO 6336-1 at the mean torque, without K_A, K_V, tolerances and running-in.

        It is the largest mean load per width over that of an even approach.
        """
        return face_load_factor(self.fine, self.even)

    @property
    def transmission_error(self) -> FloatArray:
        """Static transmission error under the mean load along the line of action, of teeth and gaps without shafts [m].

        It stands at ``fine.phases``.
        """
        return self.fine.deflection

    @property
    def mean_transmission_error(self) -> float:
        """Mean static transmission error under the mean load [m]."""
        return period_mean(self.period.phases, self.period.deflection)

    @property
    def peak_to_peak_transmission_error(self) -> float:
        """Peak-to-peak static transmission error under the mean load [m]."""
        return float(np.ptp(self.period.deflection))

    @property
    def thrust(self) -> float:
        """Axial force on the driven gear along z [N]."""
        return self.force * self.pair.axial + 0.0  # never -0

    @property
    def touched(self) -> FloatArray:
        """Approach of the flanks between the rims beyond their clearance, by the static machine's coordinates, (m,)."""
        return self.approach - (self.pair.clearance + self.pair.behind_rims * self.force) * self.pair.contact.uniform

    @cached_property
    def stiffening(self) -> FloatArray:
        """Derivative of the loads (m,) by the force that the teeth are as stiff as under, at the same approach."""
        under = self.pair.under
        if under is None or self.force == 0.0:
            return np.zeros(self.pair.contact.size)
        step = _FORCE_STEP * self.force
        more, less = (under(self.force + way).between_rims.at(self.touched).loads for way in (step, -step))
        return (more - less) / (2.0 * step)

    @cached_property
    def force_slope(self) -> FloatArray:
        """Derivative of the mesh force (m,) by the approach, with teeth whose stiffness follows it.

        With f the loads, T their tangent and F = cᵀ f, dF = cᵀ (T dy + ∂f/∂F dF).
        """
        uniform, tangent = self.pair.contact.uniform, self.pair.between_rims.at(self.touched).stiffness
        return np.asarray(uniform @ tangent / (1.0 - uniform @ self.stiffening))

    @cached_property
    def mesh(self) -> LoadedMesh:
        """The load of every tooth pair over its face at ``fine.phases``."""
        return self.pair.contact.loaded_mesh(self.fine)

    @cached_property
    def peak_pressure(self) -> float:
        """Greatest Hertzian pressure of the flanks on the path of contact over the mesh period [Pa]."""
        mesh = self.pair.contact.loaded_mesh(self.period)
        pressure = mesh_pressure(self.pair.geometry, self.pair.contact.tooth_contact, mesh)
        return float(np.nanmax(pressure, initial=0.0))

    @property
    def carrying_part(self) -> float:
        """Part of the face that carries load at some phase of the mesh period, 0 to 1."""
        return float(np.mean(self.fine.line_load.max(axis=0) > 0.0))

    @property
    def mean_stiffness(self) -> float:
        """Mean mesh stiffness under load over the mesh period [N/m]."""
        return period_mean(self.period.phases, self.pair.contact.stiffness_of(self.period))


class FlankGap(NamedTuple):
    """Gap of the flanks that mesh stiffness and motion take, by the attributes of a gear pair."""

    face_gap: tuple[float, ...] = ()
    gap_changes: tuple[tuple[float, ...], ...] = ()
    path_slope: float = 0.0


def flank_gap(loads: Sequence[PairLoad]) -> FlankGap:
    """Gap of a pair that motion takes at its loads over a turn of carriers.

    The gap is the mean of `PairLoad.station_gap`; there is none where spur teeth carry evenly with all of them. Its
    changes contain the approach at each gap beside the mean one, both under the mean force: the swing of the force is
    the machine's motion. A gap that moves as little has none. Its slope along the path is the mean of all.
    """
    gaps = np.array([load.station_gap for load in loads])
    is_spur = loads[0].pair.geometry.driver.helix_angle == 0.0
    if len(loads) == 1 and not is_spur:
        # What counts as none is found from the mean stiffness, which takes half as long as the equilibrium.
        return FlankGap(tuple(gaps[0].tolist()), (), loads[0].path_slope)
    small = max(_EVEN_GAP * float(np.mean([load.tooth_deflection for load in loads])), _LEAST_GAP)
    if is_spur and np.ptp(gaps, axis=1).max() <= small:
        return FlankGap()
    mean = gaps.mean(axis=0)
    path_slope = float(np.mean([load.path_slope for load in loads]))
    if np.ptp(gaps - mean, axis=1).max() <= small:
        return FlankGap(tuple(mean.tolist()), (), path_slope)
    more = np.array([load.force for load in loads]) - np.mean([load.force for load in loads])
    approach = np.array([float(load.pair.contact.face_mean @ load.approach) for load in loads])
    approach -= more / [load.mean_stiffness for load in loads]
    changes = gaps - mean - (approach - approach.mean())[:, None]
    return FlankGap(tuple(mean.tolist()), tuple(map(tuple, changes.tolist())), path_slope)


@dataclass(frozen=True, eq=False)
class StaticTangent:
    """The static machine linearised about its equilibrium, by n coordinates: stations of the shafts, then the housing.

    Attributes
    ----------
    stiffness : ndarray, shape (n, n)
        Derivative of the forces by the coordinates, tangents of bearings and flanks included; free motions are fixed.
    shafts : mapping of str to slice
        Coordinates of each shaft, six at each station.
    housing : slice
        The housing's coordinates.
    bearings : mapping of str to ndarray, shape (n, 5)
        Deflection of each bearing by the coordinates, as columns.
    pairs : tuple of ndarray, shape (n, m)
        Approach of each pair's flanks by the coordinates, as columns.
    """

    stiffness: FloatArray
    shafts: Mapping[str, slice]
    housing: slice
    bearings: Mapping[str, FloatArray]
    pairs: tuple[FloatArray, ...]


@dataclass(frozen=True, eq=False)
class SupportLoad:
    """Load on a torque support.

    Attributes
    ----------
    support : TorqueSupport
    force : ndarray, shape (d,)
        Load of the shaft on the support: its torque about z [N m]; by bolts forces [N] and moments along and about x,
        y, z.
    deflection : ndarray, shape (d,)
        Motion of the shaft against the seat, along and about the same [m, rad].
    """

    support: TorqueSupport
    force: FloatArray
    deflection: FloatArray

    @property
    def torque(self) -> float:
        """Torque of the shaft on the support about z [N m]."""
        return float(self.force[-1])

    @property
    def bolt_forces(self) -> FloatArray:
        """Force on each bolt outwards, along the circle and along z, shape (b, 3) [N]; none without bolts."""
        bolts = self.support.bolts
        forces = [bolt.stiffness * (bolt.motions @ self.deflection) for bolt in bolts]
        return np.array(forces, dtype=np.float64).reshape(len(bolts), 3)


@dataclass(frozen=True, eq=False, repr=False)
class OperatingPoint:
    """Static equilibrium of a machine under its mean load.

    Attributes
    ----------
    shafts : tuple of ShaftDeflection
    bearings : tuple of BearingLoad
    pairs : tuple of PairLoad
    housing : ndarray, shape (h,), or None
        The housing's modal coordinates.
    residual : float
        Largest force out of balance over the largest load; moments over that load times the longest shaft. Beyond the
        rounding of the elastic forces it is at most `gearwhine.coupling.statics.operating_point_search.RESIDUAL_BOUND`.
    iterations : int
        Number of steps of the trust region and Newton's method.
    free : tuple of str
        Motions that nothing holds and no load drives, in words.
    tangent : StaticTangent
        For its sensitivities (:mod:`gearwhine.coupling.statics.sensitivity`).
    gravity : tuple of float or None
        Acceleration of free fall along x, y, z [m/s²].
    supports : tuple of SupportLoad
        Loads on the torque supports.
    turned_by : mapping of str to float
        Angle that each carrier has turned by from its first place [rad]; empty there.
    over_turn : tuple of OperatingPoint
        Equilibria over a common turn of the carriers from this one on, see
        :meth:`gearwhine.coupling.Machine.over_turn`; this one alone where all are alike, and none where they are not
        sought.
    """

    shafts: tuple[ShaftDeflection, ...]
    bearings: tuple[BearingLoad, ...]
    pairs: tuple[PairLoad, ...]
    housing: FloatArray | None
    residual: float
    iterations: int
    free: tuple[str, ...]
    tangent: StaticTangent
    gravity: tuple[float, ...] | None = None
    supports: tuple[SupportLoad, ...] = ()
    turned_by: Mapping[str, float] = field(default_factory=dict)
    over_turn: "tuple[OperatingPoint, ...]" = ()

    @cached_property
    def settled_stiffness(self) -> FloatArray:
        """Derivative of the forces by the coordinates, with teeth whose stiffness follows their mesh force, (n, n).

        It is the tangent stiffness and, of each such pair, D ∂f/∂F (dF/dy)ᵀ Dᵀ, D the approach by the coordinates.
        """
        stiffness = self.tangent.stiffness
        for pair, rows in zip(self.pairs, self.tangent.pairs, strict=True):
            if np.any(pair.stiffening):
                stiffness = stiffness + np.outer(rows @ pair.stiffening, rows @ pair.force_slope)
        return stiffness

    def __repr__(self) -> str:
        """Return the loads on the bearings and the misalignment of the gear pairs; the rest is arrays."""
        loads = [f"{one.name} {np.linalg.norm(one.force[:3]):.5g} N" for one in self.bearings]
        pairs = [f"{' -> '.join(one.names)} {1e6 * one.misalignment:.4g} µrad" for one in self.pairs]
        return f"<OperatingPoint: {', '.join([*loads, *pairs])}>"

    def shaft(self, name: str) -> ShaftDeflection:
        """Return the deflection of the shaft of this name."""
        return next(shaft for shaft in self.shafts if shaft.name == name)

    def shaft_around(self, load: BearingLoad) -> str | None:
        """Name of the shaft that holds a bearing: a planet's carrier, or one that is its seat; None for other seats."""
        name = self.shaft(load.mounted.rotor).part.carrier or load.mounted.seat
        return name if any(shaft.name == name for shaft in self.shafts) else None

    def is_on_elastic_pin(self, load: BearingLoad) -> bool:
        """Whether a bearing of a planet sits on an elastic pin."""
        return self.shaft(load.mounted.rotor).part.pin is not None

    def gear_forces(self, number: int) -> tuple[FloatArray, FloatArray]:
        """Return the forces of a pair's flanks on the shafts of driver and driven gear, (6,) each.

        Components are along x, y, z [N] and about them [N m], at the middle of the common face. The thrust acts at the
        pitch point, and the load of an uneven face off its middle, so that both have moments.
        """
        pair = self.pairs[number]
        _, loads, _ = FaceContactLaw(pair.pair.contact, pair.pair.clearance).at(pair.approach)
        forces = []
        for gear in (pair.pair.driver, pair.pair.driven):
            part = self.shaft(gear.shaft).part
            nodes = -(self.tangent.pairs[number] @ loads)[self.tangent.shafts[gear.shaft]].reshape(-1, 6)
            arm = part.shaft.places - gear.at
            whole = nodes.sum(axis=0)
            whole[3] -= float(arm @ nodes[:, 1])
            whole[4] += float(arm @ nodes[:, 0])
            forces.append(whole)
        return forces[0], forces[1]

    def bearing(self, name: str) -> BearingLoad:
        """Return the load of the bearing of this name."""
        return next(bearing for bearing in self.bearings if bearing.name == name)

    def in_carriers(self, angles: Mapping[str, float]) -> "OperatingPoint":
        """Return the point with the loads of bearings on carriers along axes that have turned with these [rad]."""

        def angle(load: BearingLoad) -> float:
            carrier = self.shaft(load.mounted.rotor).part.carrier or load.mounted.seat
            return angles.get(carrier or "", 0.0)

        return replace(self, bearings=tuple(load.in_axes(angle(load)) for load in self.bearings), turned_by=angles)

    def is_alike(self, other: "OperatingPoint", rounding: float) -> bool:
        """Whether pairs and bearings carry the same forces as at another point, but for a part of the largest."""
        pairs, others = ([pair.force for pair in point.pairs] for point in (self, other))
        seats, their = (np.array([one.force[:3] for one in point.bearings]) for point in (self, other))
        return bool(
            np.abs(np.subtract(pairs, others)).max(initial=0.0) <= rounding * max(others, default=0.0)
            and np.abs(seats - their).max(initial=0.0) <= rounding * np.abs(their).max(initial=0.0)
        )


def flank_gaps(points: Sequence[OperatingPoint], unaligned: Sequence[str]) -> dict[tuple[str, str], FlankGap]:
    """Gap of the flanks over the face that motion takes at operating points, by the names of the gears.

    See `flank_gap`.

    Parameters
    ----------
    points : sequence of OperatingPoint
        None, one, or those over a turn of carriers.
    unaligned : sequence of str
        Labels of the pairs whose misalignment follows from these.

    Raises
    ------
    CouplingError
        Where there are such pairs and no torque loads the flanks.
    """
    pairs = [point.pairs for point in points]
    if unaligned and pairs and not pairs[0]:
        raise CouplingError(
            f"{', '.join(unaligned)}: no flanks carry a load without a torque, so no misalignment follows; "
            "expected a torque, or the misalignment"
        )
    return {loads[0].names: flank_gap(loads) for loads in zip(*pairs, strict=True)}
