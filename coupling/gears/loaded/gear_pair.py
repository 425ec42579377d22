"""Gear pair: its specification, and its mesh under the mean torque: contact law, mesh damping, transmission error.

The mesh damping coefficient follows from a damping ratio ζ, the mean mesh stiffness k between the rims and the
equivalent mass m of the two gears rotating against each other: ``2 ζ sqrt(k m)``. What the gears' bodies yield
between the rims and the shafts has no part in k.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearwhine.coupling.gears.contact.contact_law import ToothContact, law_between_rims, slices_of_teeth, tooth_contact
from gearwhine.coupling.gears.contact.face_slices import (
    DEFAULT_SLICES,
    FaceSlices,
    aligned_slices,
    face_slices,
    face_stations,
    mean_and_slope,
)
from gearwhine.coupling.gears.errors import GearError
from gearwhine.coupling.gears.geometry.faults import MissingTooth
from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry, mesh_frequency, pair_label, turning_sense
from gearwhine.coupling.gears.loaded.transmission_error import (
    LoadedMesh,
    hunting_period_mesh,
    loaded_transmission_error,
)
from gearwhine.coupling.gears.stiffness.crack import ToothCrack
from gearwhine.coupling.gears.stiffness.models import (
    GIVEN_SPRINGS,
    SquareStiffness,
    StiffnessModel,
    require_known_model,
    rim_compliances,
    stiffness_under_load,
)
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, Number, Numbers, Rule, Text, attribute_findings, refuse
from gearwhine.numerics.own_copies import keep_tuples


def equivalent_mass(
    driver_inertia: float, driven_inertia: float, driver_base_radius: float, driven_base_radius: float
) -> float:
    """Equivalent mass of the two gears rotating against each other, along the line of action [kg].

    ``J_k J_i / (J_k R_i^2 + J_i R_k^2)``, inertias [kg m^2], base radii as lengths [m].

    Raises
    ------
    GearError
        Unless all four are positive.
    """
    arguments = (driver_inertia, driven_inertia, driver_base_radius, driven_base_radius)
    if not all(math.isfinite(value) and value > 0.0 for value in arguments):
        raise GearError(f"equivalent mass: inertias and base radii must be above 0, got {arguments}")
    return (
        driver_inertia
        * driven_inertia
        / (driver_inertia * driven_base_radius**2 + driven_inertia * driver_base_radius**2)
    )


def mesh_damping(ratio: float, mean_mesh_stiffness: float, equivalent_mass: float) -> float:
    """Damping coefficient of the mesh, ``2 ratio sqrt(k m)`` [N s/m].

    Parameters
    ----------
    ratio : float
        Fraction of critical damping of the two gears rotating against each other.
    mean_mesh_stiffness : float
        Mean mesh stiffness [N/m].
    equivalent_mass : float
        See `equivalent_mass` [kg].
    """
    if not (ratio >= 0.0 and mean_mesh_stiffness > 0.0 and equivalent_mass > 0.0):
        raise GearError(
            "mesh damping: ratio must be at least 0, stiffness and mass above 0, "
            f"got {ratio!r}, {mean_mesh_stiffness!r}, {equivalent_mass!r}"
        )
    return 2.0 * ratio * math.sqrt(mean_mesh_stiffness * equivalent_mass)


_FADING = 0.1  # part of the mean compression above which the mesh is fully damped
_BACKLASH_DIFFERENCE = 0.1  # part of the designed backlash by which a given one may differ without a warning


@dataclass(frozen=True)
class GearPair:
    """Specification of a gear pair of a machine.

    Attributes
    ----------
    driver, driven : str
        Names of the gears.
    stiffness : StiffnessModel or str
        Model of the teeth; a key of :data:`gearwhine.coupling.gears.STIFFNESS_MODELS` means that model at the load of
        the pair.
    damping_ratio : float
        Fraction of critical damping of the two rims rotating against each other.
    damping : float, optional
        Damping coefficient of the mesh [N s/m], in place of the ratio.
    backlash : float, optional
        Gap of the back flanks along the line of action [m]; None: that of tooth thickness and centre distance; where
        these leave none the back flanks never touch.
    friction : float
        Coefficient of friction between the teeth.
    misalignment : float, optional
        Angle between the flanks in the plane of action, open towards +z [rad]; None: that of the machine's operating
        point, see :meth:`gearwhine.coupling.Machine.at_operating_point`. Flanks of a pair apart from a machine, or in
        one without such a point, are aligned then.
    face_gap : tuple of float
        Gap of the flanks over the face that comes with the misalignment [m], at the stations of
        :func:`gearwhine.coupling.gears.contact.face_slices.face_stations`: that of bent and twisted shafts.
    corner_contact : bool, optional
        Whether teeth touch beyond their path of contact; None: with a stiffness model of pairs of teeth.
    mean_force : float, optional
        Mean mesh force [N]; None: that of the torques. Of a pair that shares a torque with others it is that of the
        machine's operating point, see :meth:`gearwhine.coupling.Machine.at_operating_point`.
    gap_changes : tuple of tuple of float
        Gaps at angles over a turn of planet carriers beside ``face_gap``, at the same stations, with the approach of
        the flanks there beside the mean one [m]; none where the gap stays. The contact law is the mean over them.
    path_slope : float
        Slope of that gap along the line of action from the pitch point [1]: of helical teeth, whose force has an axial
        part, on shafts that tilt against each other in the plane of action.
    """

    driver: str
    driven: str
    stiffness: StiffnessModel | str = "elastic-ring"
    damping_ratio: float = 0.05
    damping: float | None = None
    backlash: float | None = None
    friction: float = 0.0
    misalignment: float | None = None
    corner_contact: bool | None = None
    face_gap: tuple[float, ...] = ()
    mean_force: float | None = None
    gap_changes: tuple[tuple[float, ...], ...] = ()
    path_slope: float = 0.0

    def __post_init__(self) -> None:
        """Keep own copies, and check every number."""
        keep_tuples(self, "face_gap", "gap_changes")
        rules: dict[str, Rule] = {
            "driver": Text(),
            "driven": Text(),
            "damping_ratio": Number(at_least=0.0, below=1.0),
            "damping": Number(at_least=0.0, optional=True, unit="N s/m"),
            "backlash": Number(at_least=0.0, optional=True, unit="m"),
            "friction": Number(at_least=0.0, at_most=0.5),
            "misalignment": Number(at_least=-0.1, at_most=0.1, optional=True, unit="rad"),
            "face_gap": Numbers(),
            "mean_force": Number(at_least=0.0, optional=True, unit="N"),
            "path_slope": Number(at_least=-0.1, at_most=0.1),
        }
        driver, driven = (getattr(gear, "name", gear) for gear in (self.driver, self.driven))
        part = ("gear pair", f"{driver} -> {driven}")
        findings = list(attribute_findings(part, self, **rules))
        if not isinstance(self.stiffness, str) and not hasattr(self.stiffness, "pair_stiffness"):
            findings.append(Finding(part, "stiffness", self.stiffness, "a stiffness model, or the name of one"))
        if self.driven == self.driver:
            findings.append(Finding(part, "driven", self.driven, "another gear than the driver"))
        refuse(findings, GearError)
        if isinstance(self.stiffness, str):
            require_known_model(self.stiffness)

    def findings(self, geometry: GearPairGeometry) -> tuple[Finding, ...]:
        """Return what is impossible or unlikely of the pair with the geometry of its gears."""
        return (*geometry.findings, *_mesh_findings(self, geometry))

    @property
    def label(self) -> str:
        """Name of the pair in messages."""
        return pair_label(self.driver, self.driven)

    @property
    def has_corner_contact(self) -> bool:
        """Whether teeth touch beyond their path of contact."""
        # A stiffness of the whole mesh, as one spring, has no single pairs of teeth.
        return not isinstance(self.stiffness, GIVEN_SPRINGS) if self.corner_contact is None else self.corner_contact

    def backlash_of(self, geometry: GearPairGeometry) -> float | None:
        """Gap of the back flanks along the line of action [m]; None where they never touch.

        See `GearPairGeometry.designed_backlash` where none is given.
        """
        return geometry.designed_backlash if self.backlash is None else self.backlash

    def backlash_warning(self, geometry: GearPairGeometry) -> str | None:
        """Sentence where a given backlash differs from that of tooth thickness and centre distance; else None."""
        made = geometry.designed_backlash
        if self.backlash is None or made is None or abs(self.backlash - made) <= _BACKLASH_DIFFERENCE * made:
            return None
        return (
            f"{geometry.label}: the backlash of {1e3 * self.backlash:.4g} mm is not the {1e3 * made:.4g} mm that the "
            "thickness of the teeth and the distance of the shafts leave along the line of action; leave 'backlash' "
            "out for that"
        )

    def face_slices(self, geometry: GearPairGeometry, sense: int) -> FaceSlices | None:
        """Face slices for an uneven load across the face; None for a uniform one.

        Parameters
        ----------
        geometry : GearPairGeometry
        sense : int
            Sense of rotation of the driver about z: 1 or -1.
        """
        misalignment = self.misalignment or 0.0
        if misalignment == self.path_slope == 0.0 and not any(self.face_gap) and not self.gap_changes:
            return aligned_slices(geometry, sense=sense)
        return face_slices(
            geometry,
            sense=sense,
            misalignment=misalignment,
            face_gap=self.face_gap,
            gap_changes=self.gap_changes,
            path_slope=self.path_slope,
        )

    def gap_slopes(self, geometry: GearPairGeometry) -> FloatArray:
        """Slope of the gap's best straight line over the face at each of ``gap_changes`` [rad]; none without them."""
        stations = face_stations(geometry.face_width)
        gaps = np.array(self.gap_changes).reshape(-1, stations.size) + (
            np.array(self.face_gap) if self.face_gap else 0.0
        )
        middles = geometry.face_width * ((np.arange(DEFAULT_SLICES) + 0.5) / DEFAULT_SLICES - 0.5)
        return np.asarray(gaps @ mean_and_slope(stations, middles)[1])

    def require_sound_faults(self, geometry: GearPairGeometry) -> None:
        """Refuse faults for which the mesh has no solution, before it is solved.

        Raises
        ------
        GearError
            For a crack through the foot of a tooth, or too many missing teeth for any to meet at some phase.
        """
        gears = (geometry.driver, geometry.driven)
        for gear in gears:
            for fault in gear.faults:
                if isinstance(fault, ToothCrack):
                    fault.extra_compliance(gear, np.array([math.tan(geometry.working_pressure_angle)]))
        if any(isinstance(fault, MissingTooth) for gear in gears for fault in gear.faults):
            driver, driven = (replace(gear, faults=_missing(gear)) for gear in gears)
            sparse = replace(geometry, driver=driver, driven=driven)
            contact = tooth_contact(sparse, SquareStiffness(1e8), corner_contact=self.has_corner_contact)
            hunting_period_mesh(contact, 1.0, points=4)


_MOST_BACKLASH = 1.0
"""Backlash beyond which the teeth hardly reach each other, in modules: a space is 1.57 wide."""
_LARGE_BACKLASH = 0.15
_LARGE_GAP = 0.1
"""Gap of the flanks at the end of the face by misalignment that is unlikely, in modules."""
_LARGE_DAMPING = 0.3


def _mesh_findings(pair: GearPair, geometry: GearPairGeometry) -> Iterator[Finding]:
    """Yield backlash, misalignment and damping that a mesh cannot have, or hardly."""
    part, module = ("gear pair", f"{pair.driver} -> {pair.driven}"), geometry.driver.module
    natural = geometry.designed_backlash or 0.0
    if pair.backlash is not None and pair.backlash > _MOST_BACKLASH * module:
        expected = f"less than the space between two teeth, at most one module, {1e3 * module:.4g} mm"
        yield Finding(part, "backlash", pair.backlash, expected)
    elif pair.backlash is not None and abs(pair.backlash - natural) > _LARGE_BACKLASH * module:
        expected = (
            f"about the {1e3 * natural:.4g} mm that the thickness of the teeth and the distance of the shafts leave"
        )
        yield Finding(part, "backlash", pair.backlash, expected, "warning")
    gap = abs(pair.misalignment or 0.0) * geometry.face_width
    if gap > _LARGE_GAP * module:
        expected = f"a gap over the face of at most a tenth of the module; it is {1e3 * gap:.4g} mm"
        yield Finding(part, "misalignment", pair.misalignment, expected, "warning")
    if pair.damping_ratio > _LARGE_DAMPING:
        expected = "at most 0.3: gear meshes have 0.02 to 0.17"
        yield Finding(part, "damping_ratio", pair.damping_ratio, expected, "warning")


_PRESSURE = 3e9
"""Contact pressure beyond which hardened teeth yield [Pa]."""
_BENDING = 2e9
"""Nominal bending stress at the root beyond which any tooth breaks [Pa]."""
_FORM_AND_NOTCH = 3.5
"""Nominal root stress over F_t / (b m), form and stress correction factors of ISO 6336-3 together: 3 to 4.5."""
_FAST, _BURSTS = 200.0, 600.0
"""Pitch-line speed of the fastest turbo gears, and one at which any rim of steel bursts, ρ v² = 2.8 GPa [m/s]."""


def operation_findings(geometry: GearPairGeometry, torque: float, speed: float) -> Iterator[Finding]:
    """Yield a load that teeth do not bear, and a speed at which gears burst.

    Hertzian pressure at the pitch point, p = √(w E* / (π R)), with the line load w on the lines of contact: of spur
    gears of one pair, of helical ones of the mean length b ε_α / cos β_b.

    Parameters
    ----------
    geometry : GearPairGeometry
    torque : float
        Mean torque on the driver [N m].
    speed : float
        Speed of the driver [rad/s].
    """
    part, (driver, driven) = (
        ("gear pair", f"{geometry.driver.name} -> {geometry.driven.name}"),
        (
            geometry.driver,
            geometry.driven,
        ),
    )
    force, base_helix = abs(torque / driver.base_radius), driver.base_helix_angle
    length = geometry.face_width * (geometry.contact_ratio if base_helix else 1.0) / math.cos(base_helix)
    radii = [radius * math.sin(geometry.working_pressure_angle) for radius in geometry.working_pitch_radii]
    curvature = sum(math.cos(base_helix) / radius for radius in radii)
    contact_modulus = 1.0 / sum((1.0 - gear.poisson_ratio**2) / gear.youngs_modulus for gear in (driver, driven))
    pressure = math.sqrt(force / (math.cos(base_helix) * length) * contact_modulus * curvature / math.pi)
    root = _FORM_AND_NOTCH * force / (geometry.face_width * driver.module)
    if pressure > _PRESSURE or root > _BENDING:
        # As of a torque in kN m that is meant in N m.
        thousandth = math.sqrt(1e-3) * pressure <= _PRESSURE and 1e-3 * root <= _BENDING and root > 10.0 * _BENDING
        expected = (
            f"a load that teeth bear: {force:.4g} N press their flanks with {1e-9 * pressure:.3g} GPa and bend their "
            f"roots with {1e-9 * root:.3g} GPa, where steel bears {1e-9 * _PRESSURE:g} GPa and {1e-9 * _BENDING:g} GPa "
            "at most" + ("; is it a thousand times too much?" if thousandth else "")
        )
        yield Finding(part, "torque", float(torque), expected, "warning")
    line_speed = abs(speed * geometry.working_pitch_radii[0])
    if line_speed > _BURSTS:
        expected = f"a pitch-line speed at which no rim bursts, at most {_BURSTS:g} m/s; it is {line_speed:.4g} m/s"
        yield Finding(part, "speed", float(speed), expected)
    elif line_speed > _FAST:
        expected = f"a pitch-line speed of at most {_FAST:g} m/s, as the fastest gears have; it is {line_speed:.4g} m/s"
        yield Finding(part, "speed", float(speed), expected, "warning")


@dataclass(frozen=True)
class LoadedGearPair:
    """A gear pair at rest under its mean torque.

    Attributes
    ----------
    pair : GearPair
        Specification of the pair.
    geometry : GearPairGeometry
    model : StiffnessModel
        Stiffness model of the teeth.
    undamped : ToothContact
        Contact law of the drive flanks without damping.
    static : LoadedMesh
        Static mesh of the flanks that carry over the first mesh period, by their own phase.
    inertias : tuple of float
        Polar inertias that rotate with the driver and with the driven gear [kg m²]; None where not given.
    mesh_frequency : float or None
        Mesh frequency [Hz]; None where no speed is given.
    """

    pair: GearPair
    geometry: GearPairGeometry
    model: StiffnessModel
    undamped: ToothContact
    static: LoadedMesh
    inertias: tuple[float, float] | None
    mesh_frequency: float | None

    @cached_property
    def hunting(self) -> LoadedMesh | None:
        """Static mesh of the flanks that carry over the hunting period, by their own phase.

        None where mesh periods are alike: they differ by pitch deviations or damaged teeth.
        """
        carrying = self.undamped.carrying_flanks
        return hunting_period_mesh(carrying, self.static.force) if carrying.hunting_period > 1 else None

    @cached_property
    def contact(self) -> ToothContact:
        """Contact law of the drive flanks with its damping."""
        force, contact = self.static.force, self.undamped
        # The damping ratio refers to the mesh that vibrates about its mean load, as in linear analyses: the mean of all
        # mesh periods, which are not alike with pitch deviations or damaged teeth. The inertias are those of the rims,
        # so what the bodies behind them yield has no part in it.
        behind = sum(rim.twist + rim.shift for rim in rim_compliances(self.model, self.geometry))

        def mean_mesh_stiffness() -> float:
            if force > 0.0:
                return (self.hunting or self.static).mean_stiffness_without(behind)
            return law_between_rims(contact, behind).unloaded_mean_mesh_stiffness

        damping = _damping_coefficient(self.pair, self.geometry, mean_mesh_stiffness, self.inertias)
        return contact.with_damping(damping, _FADING * force / contact.unloaded_mean_mesh_stiffness)

    @property
    def tilting_faces(self) -> FaceSlices:
        """Slices of the face by which the flanks resist tilting: those of the contact, or of flanks that carry evenly.

        A given spring lies evenly over the face.
        """
        even = face_slices(self.geometry)
        return self.undamped.faces or slices_of_teeth(even, self.model, self.geometry)

    @property
    def torque(self) -> float:
        """Torque on the driver that the mesh carries [N m]."""
        return self.static.force * abs(self.geometry.driver.base_radius)

    @property
    def carrying_flanks(self) -> ToothContact:
        """Contact law of the flanks that carry the mean torque, by their own phase: back flanks where it is below 0."""
        return self.undamped.carrying_flanks

    @property
    def backlash(self) -> float | None:
        """Gap of the back flanks along their line of action [m]; None where they never meet."""
        return self.pair.backlash_of(self.geometry)

    @property
    def has_single_pairs(self) -> bool:
        """Whether the model describes pairs of teeth, which share the load, and not the mesh as one spring."""
        return math.isclose(self.undamped.contact_ratio, self.geometry.contact_ratio, rel_tol=1e-9)


def load_gear_pair(
    pair: GearPair,
    geometry: GearPairGeometry,
    *,
    torque: float = 0.0,
    inertias: tuple[float, float] | None = None,
    speed: float | None = None,
) -> LoadedGearPair:
    """Contact law of a gear pair, and its mesh at rest under a mean torque.

    Parameters
    ----------
    pair : GearPair
    geometry : GearPairGeometry
    torque : float
        Mean torque that the pair takes from its driver [N m], of either sign; its amount is that of the pair's
        ``mean_force`` where it has one.
    inertias : tuple of float, optional
        Polar inertias that rotate with the driver and with the driven gear [kg m²], for the damping ratio; not needed
        for the mesh at rest.
    speed : float, optional
        Signed speed of the driver [rad/s].

    Raises
    ------
    GearError
        Where the pair cannot carry the torque, or its stiffness model does not fit the geometry.

    Examples
    --------
    >>> wheel = Gear("wheel", teeth=62, module=2e-3, pressure_angle=0.349066, face_width=20e-3, bore=35e-3)
    >>> pinion = Gear("pinion", teeth=31, module=2e-3, pressure_angle=0.349066, face_width=20e-3, bore=20e-3)
    >>> loaded = load_gear_pair(GearPair("pinion", "wheel"), GearPairGeometry(pinion, wheel), torque=60.0)
    >>> error = loaded.static.peak_to_peak_transmission_error  # also transmission_error over phases, mesh stiffness
    """
    force = abs(torque / geometry.driver.base_radius) if pair.mean_force is None else pair.mean_force
    stiffness = pair.stiffness
    model = stiffness_under_load(stiffness, geometry, force) if isinstance(stiffness, str) else stiffness
    contact = tooth_contact(
        geometry,
        model,
        corner_contact=pair.has_corner_contact,
        faces=pair.face_slices(geometry, 1 if speed is None else turning_sense(speed)),
    ).under_load(math.copysign(force, torque))
    static = loaded_transmission_error(contact.carrying_flanks, force)
    frequency = None if speed is None else mesh_frequency(speed, geometry.driver.teeth)
    return LoadedGearPair(pair, geometry, model, contact, static, inertias, frequency)


def _missing(gear: Gear) -> tuple[MissingTooth, ...]:
    return tuple(fault for fault in gear.faults if isinstance(fault, MissingTooth))


def _damping_coefficient(
    pair: GearPair,
    geometry: GearPairGeometry,
    mean_mesh_stiffness: Callable[[], float],
    inertias: tuple[float, float] | None,
) -> float:
    """Damping coefficient of the mesh [N s/m]."""
    if pair.damping is not None:
        return pair.damping
    if pair.damping_ratio == 0.0:
        return 0.0
    if inertias is None:
        raise GearError(f"{pair.label}: expected the inertias that rotate with its gears, which a damping_ratio needs")
    mass = equivalent_mass(*inertias, abs(geometry.driver.base_radius), abs(geometry.driven.base_radius))
    return mesh_damping(pair.damping_ratio, mean_mesh_stiffness(), mass)
