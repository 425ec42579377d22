"""A gear pair as it is specified, and its mesh under the mean torque: contact law, damping, transmission error."""

import math
from dataclasses import dataclass, replace

import numpy as np

from coupling.gears.crack import ToothCrack
from coupling.gears.damping import equivalent_mass, mesh_damping
from coupling.gears.face_slices import FaceSlices, face_slices
from coupling.gears.faults import MissingTooth
from coupling.gears.gear_contact import tooth_contact
from coupling.gears.geometry import Gear
from coupling.gears.hunting import hunting_mesh
from coupling.gears.pair_geometry import GearPairGeometry
from coupling.gears.static import StaticMesh, static_transmission_error
from coupling.gears.stiffness_models import (
    ConstantStiffness,
    SquareStiffness,
    StiffnessModel,
    TableStiffness,
    stiffness_under_load,
)
from coupling.gears.tooth_contact import ToothContact

_FADING = 0.1  # part of the mean compression from which on the damping of the mesh is all there
_ROUNDED_BACKLASH = 1e-3  # modules: backlash below it is the rounding of printed sizes
_MESH_SPRINGS = (ConstantStiffness, SquareStiffness, TableStiffness)  # models of the mesh, not of a pair of teeth


@dataclass(frozen=True)
class GearPair:
    """How two gears of a machine mesh.

    Attributes
    ----------
    driver, driven : str
        Names of the gears.
    stiffness : StiffnessModel or str
        Of the teeth; a name of :data:`coupling.gears.STIFFNESS_MODELS` stands for that model at the load of the pair.
    damping_ratio : float
        Fraction of critical damping of the two gears that turn against each other.
    damping : float, optional
        Damping coefficient of the mesh [N s/m], in place of the ratio.
    backlash : float, optional
        Gap of the back flanks along the line of action [m]; None: that of the teeth's thickness and the centre
        distance, and where these leave none the back flanks never touch.
    friction : float
        Coefficient of friction between the teeth.
    misalignment : float
        Angle between the flanks in the plane of action, open towards +z [rad].
    corner_contact : bool, optional
        Whether teeth touch beyond their path of contact; None: where the stiffness model is one of pairs of teeth.
    """

    driver: str
    driven: str
    stiffness: StiffnessModel | str = "elastic-ring"
    damping_ratio: float = 0.05
    damping: float | None = None
    backlash: float | None = None
    friction: float = 0.0
    misalignment: float = 0.0
    corner_contact: bool | None = None

    @property
    def meets_with_corners(self) -> bool:
        """Whether teeth touch beyond their path of contact."""
        if self.corner_contact is not None:
            return self.corner_contact
        return not isinstance(self.stiffness, _MESH_SPRINGS)

    def backlash_of(self, geometry: GearPairGeometry) -> float | None:
        """Gap of the back flanks along the line of action [m]; None where they never touch.

        A backlash below the rounding of printed sizes is none: nominal gears at their nominal distance have teeth as
        thick as the spaces, and no allowance from which a backlash would follow.
        """
        if self.backlash is not None:
            return self.backlash
        return geometry.backlash if geometry.backlash > _ROUNDED_BACKLASH * geometry.driver.module else None

    def face_slices(self, geometry: GearPairGeometry, sense: int) -> FaceSlices | None:
        """Slices of the face where the load spreads unevenly over it; None where it does not.

        Parameters
        ----------
        geometry : GearPairGeometry
        sense : int
            Of rotation of the driver about z: 1 or -1.
        """
        bent = (geometry.driver.helix_deviation, geometry.driven.helix_deviation)
        straight = all(deviation is None or deviation.is_straight for deviation in bent)
        if geometry.driver.helix_angle == 0.0 and self.misalignment == 0.0 and straight:
            return None
        return face_slices(geometry, sense=sense, misalignment=self.misalignment)

    def require_sound_faults(self, geometry: GearPairGeometry) -> None:
        """Refuse damaged teeth with which nothing can be solved, without solving anything.

        Raises
        ------
        GearError
            For a crack through the foot of a tooth, or so many missing teeth that at some phase none meet.
        """
        gears = (geometry.driver, geometry.driven)
        for gear in gears:
            for fault in gear.faults:
                if isinstance(fault, ToothCrack):
                    fault.extra_compliance(gear, np.array([math.tan(geometry.working_pressure_angle)]))
        if any(isinstance(fault, MissingTooth) for gear in gears for fault in gear.faults):
            driver, driven = (replace(gear, faults=_missing(gear)) for gear in gears)
            sparse = replace(geometry, driver=driver, driven=driven)
            contact = tooth_contact(sparse, SquareStiffness(1e8), corner_contact=self.meets_with_corners)
            hunting_mesh(contact, 1.0, points=4)


@dataclass(frozen=True)
class LoadedGearPair:
    """A gear pair at rest under its mean torque.

    Attributes
    ----------
    pair : GearPair
        As specified.
    geometry : GearPairGeometry
    model : StiffnessModel
        Of its teeth.
    contact : ToothContact
        Contact law with its damping.
    static : StaticMesh
        Over one mesh period, the first.
    hunting : StaticMesh or None
        Over the whole hunting period, where pitch deviations or damaged teeth make the mesh periods differ.
    mesh_frequency : float or None
        [Hz]; None where no speed is given.
    """

    pair: GearPair
    geometry: GearPairGeometry
    model: StiffnessModel
    contact: ToothContact
    static: StaticMesh
    hunting: StaticMesh | None
    mesh_frequency: float | None

    @property
    def torque(self) -> float:
        """On the driver, that the mesh carries [N m]."""
        return self.static.force * self.geometry.driver.base_radius

    @property
    def backlash(self) -> float | None:
        """Gap of the back flanks along their line of action [m]; None where they never meet."""
        return self.pair.backlash_of(self.geometry)

    @property
    def has_single_pairs(self) -> bool:
        """Whether the model is of pairs of teeth, which share the load, or of the mesh as one spring."""
        return math.isclose(self.contact.contact_ratio, self.geometry.contact_ratio, rel_tol=1e-9)


def load_gear_pair(
    pair: GearPair,
    geometry: GearPairGeometry,
    *,
    torque: float = 0.0,
    inertias: tuple[float, float],
    speed: float | None = None,
) -> LoadedGearPair:
    """Contact law of a gear pair, and its mesh at rest under a mean torque.

    Parameters
    ----------
    pair : GearPair
    geometry : GearPairGeometry
    torque : float
        Mean torque that the pair takes off its driver [N m], of either sign.
    inertias : tuple of float
        Polar inertia that turns with the driver and with the driven gear [kg m²], for the damping ratio.
    speed : float, optional
        Signed speed of the driver [rad/s].

    Raises
    ------
    GearError
        Where the pair cannot carry the torque, or its stiffness model does not fit the geometry.
    """
    force = abs(torque) / geometry.driver.base_radius
    given = pair.stiffness
    model = stiffness_under_load(given, geometry, force) if isinstance(given, str) else given
    contact = tooth_contact(
        geometry,
        model,
        corner_contact=pair.meets_with_corners,
        faces=pair.face_slices(geometry, 1 if speed is None or speed >= 0.0 else -1),
    )
    static = static_transmission_error(contact, force)
    # The ratio is of the mesh as it vibrates about its mean load, as linear analyses take it.
    mean_stiffness = static.mean_stiffness if force > 0.0 else contact.mean_stiffness
    damping = _damping_coefficient(pair, geometry, mean_stiffness, inertias)
    contact = contact.with_damping(damping, _FADING * force / contact.mean_stiffness)
    hunting = hunting_mesh(contact, force) if contact.hunting_period > 1 else None
    frequency = None if speed is None else abs(speed) * geometry.driver.teeth / (2.0 * math.pi)
    return LoadedGearPair(pair, geometry, model, contact, static, hunting, frequency)


def _missing(gear: Gear) -> tuple[MissingTooth, ...]:
    return tuple(fault for fault in gear.faults if isinstance(fault, MissingTooth))


def _damping_coefficient(
    pair: GearPair, geometry: GearPairGeometry, mean_stiffness: float, inertias: tuple[float, float]
) -> float:
    """Damping coefficient of the mesh [N s/m]."""
    if pair.damping is not None:
        return pair.damping
    if pair.damping_ratio == 0.0:
        return 0.0
    mass = equivalent_mass(*inertias, geometry.driver.base_radius, geometry.driven.base_radius)
    return mesh_damping(pair.damping_ratio, mean_stiffness, mass)
