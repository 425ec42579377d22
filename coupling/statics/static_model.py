"""Static model of a machine's parts: shafts, bearings and gear pairs with the energy of their connectors.

Each bearing is a law of five deflections of the shaft against its seat, each gear pair one of the approach of its
flanks over the face. A law gives energy, force and tangent at any deflection; the nominal stiffness is a first guess
of the tangent, from which the search for equilibrium starts (:mod:`gearwhine.coupling.statics.operating_point`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Protocol

import numpy as np

from gearwhine.coupling.gears import GearPairGeometry, tooth_contact
from gearwhine.coupling.gears.contact.contact_law import law_between_rims
from gearwhine.coupling.gears.contact.face_slices import face_slices, face_stations
from gearwhine.coupling.gears.loaded.face_load import FaceContact
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.gears.stiffness.models import stiffness_under_load
from gearwhine.coupling.machine.bearing_laws import GapLaw
from gearwhine.coupling.machine.mesh_kinematics import LineOfAction, line_of_action
from gearwhine.coupling.machine.mounted_parts import MountedBearing
from gearwhine.coupling.machine.pins import MountedPin
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.own_copies import unchecked
from gearwhine.rotors.analyses.static_stiffness import StaticShaft
from gearwhine.rotors.rolling_bearings import RollingBearing, RollingElements, rolling_equilibrium, static_rating

_TRIAL_LOAD = 0.05  # load over the static rating at which a rolling bearing has its nominal stiffness


class ConnectorLaw(Protocol):
    """Energy, force and tangent of a connector by its deflections."""

    def at(self, deflection: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        """Energy [J], force (d,) [N, N m] and tangent (d, d) at deflections (d,) [m, rad]."""
        ...


@dataclass(frozen=True, eq=False)
class LinearLaw:
    """Constant stiffness (d, d), perhaps unsymmetric, with the energy of its symmetric part."""

    stiffness: FloatArray

    @property
    def nominal(self) -> FloatArray:
        """The symmetric factor of the polar decomposition, which resists the same motions and is never indefinite."""
        _, values, rows = np.linalg.svd(self.stiffness)
        return np.asarray((rows.T * values) @ rows)

    def at(self, deflection: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        """Energy, force and tangent."""
        force = self.stiffness @ deflection
        return 0.5 * float(deflection @ force), force, self.stiffness


@dataclass(frozen=True, eq=False)
class RollingElementLaw:
    """A rolling bearing by its elements, its spring preload included."""

    elements: RollingElements

    def at(self, deflection: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        """Energy, force and tangent."""
        state = self.elements.at(deflection)
        return state.value, state.gradient, state.hessian


@dataclass(frozen=True, eq=False)
class RadialGapLaw:
    """A ring around the shaft, touched beyond a gap, see :class:`gearwhine.coupling.machine.bearing_laws.GapLaw`."""

    law: GapLaw

    def at(self, deflection: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        """Energy, force and tangent."""
        force, tangent = np.zeros(5), np.zeros((5, 5))
        energy, force[:2], tangent[:2, :2] = self.law.at(deflection[:2])
        return energy, force, tangent


@dataclass(frozen=True, eq=False)
class FaceContactLaw:
    """Mean tooth contact of a gear pair over a mesh period, by the approach of its flanks over the face."""

    contact: FaceContact
    clearance: float = 0.0

    def at(self, deflection: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        """Energy, force and tangent."""
        state = self.contact.at(deflection - self.clearance * self.contact.uniform)
        return state.energy, state.loads, state.stiffness

    @property
    def coarse(self) -> FaceContactLaw:
        """The law with means over few phases, a quarter of the work."""
        return FaceContactLaw(self.contact.coarse, self.clearance)


@dataclass(frozen=True, eq=False)
class OffsetLaw:
    """A law about a seat that stands off its place by an offset (d,) [m, rad], as a bore or a planet's pin may."""

    law: ConnectorLaw
    offset: FloatArray

    def at(self, deflection: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        """Energy, force and tangent."""
        return self.law.at(deflection - self.offset)


def replace_linear(law: ConnectorLaw, other: LinearLaw) -> ConnectorLaw:
    """Return another linear law in place of one, about the same seat; other laws as they are."""
    if isinstance(law, OffsetLaw):
        return replace(law, law=replace_linear(law.law, other))
    return other if isinstance(law, LinearLaw) else law


@dataclass(frozen=True, eq=False)
class StaticBearing:
    """A bearing in the static model.

    Attributes
    ----------
    mounted : MountedBearing
    law : ConnectorLaw
    nominal : ndarray, shape (5, 5)
        Nominal stiffness that the search starts from.
    displacement : ndarray, shape (5,)
        Displacement of its seat from its place, such as that of a bore or of a planet's pin by its error [m, rad].
    """

    mounted: MountedBearing
    law: ConnectorLaw
    nominal: FloatArray
    displacement: FloatArray = field(default_factory=lambda: np.zeros(5))

    @property
    def placed_law(self) -> ConnectorLaw:
        """The law by the deflection from the seat's nominal place."""
        return OffsetLaw(self.law, self.displacement) if np.any(self.displacement) else self.law


def static_bearing(mounted: MountedBearing, speed: float, displacement: FloatArray) -> StaticBearing:
    """Make a bearing of the static model: by its elements, its gap, or its stiffness at a speed [rad/s].

    ``displacement`` (5,) is that of its seat from its place [m, rad].
    """
    return replace(_static_bearing(mounted, speed), displacement=displacement)


def _static_bearing(mounted: MountedBearing, speed: float) -> StaticBearing:
    rolling = mounted.elements
    if rolling is not None:
        return StaticBearing(mounted, RollingElementLaw(RollingElements(rolling)), _nominal_rolling(rolling))
    if isinstance(mounted.law, GapLaw):
        secant = mounted.law.force / (mounted.law.gap + mounted.law.depth)
        return StaticBearing(mounted, RadialGapLaw(mounted.law), np.diag([secant, secant, 0.0, 0.0, 0.0]))
    law = LinearLaw(mounted.bearing.at_speed(speed).spatial_stiffness)
    return StaticBearing(mounted, law, law.nominal)


def _nominal_rolling(rolling: RollingBearing) -> FloatArray:
    """Stiffness of a rolling bearing without clearance under a trial load, alike in x and y, (5, 5)."""
    return _stiffness_on_trial(
        unchecked(rolling, rows=tuple(unchecked(row, clearance=0.0) for row in rolling.rows), name="")
    )


@lru_cache(maxsize=64)  # the bearings of a machine, and of others with other clearances, are often alike
def _stiffness_on_trial(rolling: RollingBearing) -> FloatArray:
    trial = _TRIAL_LOAD * min(static_rating(row) for row in rolling.rows)
    load = np.array([trial, 0.0, 0.0, 0.0, 0.0])
    # Held along its axis, a row that carries thrust one way only does not slide open.
    state = rolling_equilibrium(rolling, load, held={"z": 0.0, "rx": 0.0, "ry": 0.0})
    diagonal = np.diag(state.stiffness)
    radial, tilt = max(diagonal[0], diagonal[1]), max(diagonal[3], diagonal[4])
    return np.diag([radial, radial, diagonal[2], tilt, tilt])


@dataclass(frozen=True, eq=False)
class StaticShaftPart:
    """A shaft in the static model.

    Attributes
    ----------
    name : str
    axis : tuple of float
        x and y of its axis [m].
    start : float
        z of its left end [m].
    shaft : StaticShaft
        Exact stiffness.
    acceleration : tuple of float or None
        Acceleration along x, y, z that acts on its mass as weight does: free fall, and of a planet's shaft the
        centrifugal acceleration of its axis [m/s²].
    carrier : str or None
        Shaft in which its bearings sit, of a planet; None for seats of the housing and the ground.
    rim_seat : str or None
        Seat of the housing whose bore the rim of its ring gear follows.
    pin : MountedPin or None
        Elastic pin of a planet, on which its bearings sit.
    """

    name: str
    axis: tuple[float, float]
    start: float
    shaft: StaticShaft
    acceleration: tuple[float, ...] | None = None
    carrier: str | None = None
    rim_seat: str | None = None
    pin: MountedPin | None = None


@dataclass(frozen=True, eq=False)
class StaticGear:
    """A gear of a pair in the static model.

    Attributes
    ----------
    name, shaft : str
    at : float
        Middle of the pair's common face from the shaft's left end [m].
    carriers : ndarray, shape (j,)
        Sections of the shaft, from its left end, that carry the stations of the pair's common face [m].
    arms : ndarray, shape (j,)
        Rigid arms along the shaft from these sections to the stations [m].
    """

    name: str
    shaft: str
    at: float
    carriers: FloatArray
    arms: FloatArray


@dataclass(frozen=True, eq=False)
class StaticPair:
    """A gear pair in the static model.

    Attributes
    ----------
    label : str
    driver, driven : StaticGear
    geometry : GearPairGeometry
    contact : FaceContact
        Contact of the loaded flanks, with all that the gears' bodies yield.
    clearance : float
        Gap of these flanks without load [m]: 0, or the backlash where the back flanks carry.
    line : LineOfAction
        Line of action of these flanks.
    nominal : float
        Mean mesh stiffness for the search [N/m].
    between_rims : FaceContact
        Contact without what lies behind rims that are coordinates of the static machine.
    behind_rims : float
        Compliance of these rims on their hubs along the line of action [m/N].
    under : callable or None
        Make the pair with teeth as stiff as under a mesh force [N]; None where their stiffness follows no share of a
        torque.
    """

    label: str
    driver: StaticGear
    driven: StaticGear
    geometry: GearPairGeometry
    contact: FaceContact
    clearance: float
    line: LineOfAction
    nominal: float
    between_rims: FaceContact
    behind_rims: float = 0.0
    under: Callable[[float], StaticPair] | None = None

    @property
    def push(self) -> tuple[float, float]:
        """Unit vector in the x-y plane along which the driver pushes the driven gear."""
        return self.line.push

    @property
    def axial(self) -> float:
        """Axial part of the force on the driven gear over its transverse part."""
        return self.line.axial


def static_pair(
    pair: GearPair,
    geometry: GearPairGeometry,
    gears: tuple[StaticGear, StaticGear],
    axes: tuple[tuple[float, float], tuple[float, float]],
    rotation: int,
    torque: float,
    force: float,
    behind_rims: float = 0.0,
) -> StaticPair:
    """Make a gear pair of the static model, of sound teeth, on the flanks that its mean torque loads.

    Parameters
    ----------
    pair : GearPair
    geometry : GearPairGeometry
    gears : two of StaticGear
        Driver and driven gear.
    axes : two of (x, y)
        Axes of their shafts [m].
    rotation : int
        Sense of rotation of the driver about z: 1 or -1.
    torque : float
        Torque that the pair takes from its driver [N m], positive where power flows to the driven gear.
    force : float
        Mesh force that a stiffness by name is that of, where it depends on the load [N].
    behind_rims : float
        Compliance of rims that are coordinates of the static machine, along the line of action [m/N].
    """
    tooth_stiffness = pair.stiffness
    model = (
        stiffness_under_load(tooth_stiffness, geometry, force) if isinstance(tooth_stiffness, str) else tooth_stiffness
    )
    sound = geometry
    if geometry.driver.faults or geometry.driven.faults:
        driver, driven = (unchecked(gear, faults=()) for gear in (geometry.driver, geometry.driven))
        sound = unchecked(geometry, driver=driver, driven=driven)
    faces = face_slices(sound, sense=rotation)
    contact = tooth_contact(sound, model, corner_contact=pair.has_corner_contact, faces=faces).teeth_alike
    backwards = torque < 0.0
    sense = -rotation if backwards else rotation
    backlash = pair.backlash_of(geometry)
    line = line_of_action(geometry, (axes[1][0] - axes[0][0], axes[1][1] - axes[0][1]), sense)
    loaded_contact = contact.back_flanks if backwards else contact
    over_face = (geometry, face_stations(geometry.face_width), line.axial)
    whole = FaceContact(loaded_contact, *over_face)
    between_rims = law_between_rims(loaded_contact, behind_rims)
    return StaticPair(
        label=pair.label,
        driver=gears[0],
        driven=gears[1],
        geometry=geometry,
        contact=whole,
        clearance=(backlash or 0.0) if backwards else 0.0,
        line=line,
        nominal=between_rims.unloaded_mean_mesh_stiffness,
        between_rims=whole if behind_rims == 0.0 else FaceContact(between_rims, *over_face),
        behind_rims=behind_rims,
    )
