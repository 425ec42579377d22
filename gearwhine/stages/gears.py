"""The gear pairs of a case: geometry, contact law, and the mesh at rest under its load."""

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

import coupling.gears as room
from gearwhine.case import (
    Case,
    CaseError,
    Problem,
    mesh_frequencies,
    pair_torques,
    require,
    rotor_speeds,
    shaft_of,
)
from gearwhine.case import Gear as GivenGear
from gearwhine.case import GearPair as GivenPair
from gearwhine.progress import Progress, silent
from gearwhine.stages.build import build_discs, build_gear, build_rotor, gear_inertia

FloatArray = npt.NDArray[np.float64]

# The mesh's damping is all there from this part of the mean compression on.
_FADING = 0.1
# In modules: backlash below it is the rounding of printed sizes.
_ROUNDED = 1e-3
# Part of the geometry's backlash by which a given one may differ without a word.
_DIFFERS = 0.1


@dataclass(frozen=True)
class SolvedPair:
    """One gear pair at rest under its mean load.

    Attributes
    ----------
    given : GearPair
        As in the case.
    geometry : coupling.gears.GearPairGeometry
    model : coupling.gears.StiffnessModel
        Of its teeth.
    contact : coupling.gears.ToothContact
        With its damping.
    static : coupling.gears.StaticMesh
        Over one mesh period, the first.
    hunting : coupling.gears.StaticMesh or None
        Over the whole hunting period, where pitch deviations or damaged teeth make the mesh periods differ.
    mesh_frequency : float or None
        [Hz]; None where the case gives no speed.
    """

    given: GivenPair
    geometry: room.GearPairGeometry
    model: room.StiffnessModel
    contact: room.ToothContact
    static: room.StaticMesh
    hunting: room.StaticMesh | None
    mesh_frequency: float | None

    @property
    def torque(self) -> float:
        """On the driver, that the mesh carries [N m]."""
        return self.static.force * self.geometry.driver.base_radius

    @property
    def backlash(self) -> float | None:
        """Gap of the back flanks along their line of action [m]; None where they never meet."""
        return pair_backlash(self.given, self.geometry)

    @property
    def has_single_pairs(self) -> bool:
        """Whether the model is of pairs of teeth, which share the load, or of the mesh as one spring."""
        return math.isclose(self.contact.contact_ratio, self.geometry.contact_ratio, rel_tol=1e-9)


def solve_gears(case: Case, progress: Progress = silent) -> tuple[SolvedPair, ...]:
    """Every gear pair of the case.

    Raises
    ------
    CaseError, coupling.gears.GearError
        Where the case has no gear pairs, or one cannot be solved as it stands.
    """
    require(case, "gear_pair", command="gears")
    torques = pair_torques(case) if case.operation else (0.0,) * len(case.gear_pair)
    frequencies = mesh_frequencies(case) if case.operation else (None,) * len(case.gear_pair)
    solved = []
    for number, (pair, torque, frequency) in enumerate(zip(case.gear_pair, torques, frequencies, strict=True)):
        progress(f"gear pair {pair.driver} -> {pair.driven}")
        geometry = pair_geometry(case, pair)
        force = abs(torque) / geometry.driver.base_radius
        model = _model(pair, number, geometry, force)
        contact = room.tooth_contact(
            geometry,
            model,
            corner_contact=meets_with_corners(pair),
            faces=uneven_faces(case, pair, geometry),
        )
        static = room.static_transmission_error(contact, force)
        # The ratio is of the mesh as it vibrates about its mean load, as linear analyses take it.
        mean_stiffness = static.mean_stiffness if force > 0.0 else contact.mean_stiffness
        contact = contact.with_damping(_damping(case, pair, mean_stiffness), _FADING * force / contact.mean_stiffness)
        hunting = room.hunting_mesh(contact, force) if contact.hunting_period > 1 else None
        solved.append(SolvedPair(pair, geometry, model, contact, static, hunting, frequency))
    return tuple(solved)


def require_sound_faults(pair: GivenPair, geometry: room.GearPairGeometry) -> None:
    """Refuse damaged teeth with which nothing can be solved, without solving anything.

    Raises
    ------
    coupling.gears.GearError
        For a crack through the foot of a tooth, or so many missing teeth that at some phase none meet.
    """
    for gear in (geometry.driver, geometry.driven):
        for fault in gear.faults:
            if isinstance(fault, room.ToothCrack):
                fault.extra_compliance(gear, np.array([math.tan(geometry.working_pressure_angle)]))
    if any(
        isinstance(fault, room.MissingTooth) for gear in (geometry.driver, geometry.driven) for fault in gear.faults
    ):
        whole = [replace(gear, faults=_missing(gear)) for gear in (geometry.driver, geometry.driven)]
        sparse = replace(geometry, driver=whole[0], driven=whole[1])
        contact = room.tooth_contact(sparse, room.SquareStiffness(1e8), corner_contact=meets_with_corners(pair))
        room.hunting_mesh(contact, 1.0, points=4)


def _missing(gear: room.Gear) -> tuple[room.MissingTooth, ...]:
    return tuple(fault for fault in gear.faults if isinstance(fault, room.MissingTooth))


def meets_with_corners(pair: GivenPair) -> bool:
    """Whether teeth meet beyond their path of contact: as the case says, or where the pair's model is one of teeth."""
    if pair.corner_contact is not None:
        return pair.corner_contact
    return pair.stiffness.model not in ("constant", "square", "table")


def uneven_faces(case: Case, pair: GivenPair, geometry: room.GearPairGeometry) -> room.FaceSlices | None:
    """The slices of a pair's face where the load spreads unevenly over it."""
    bent = (geometry.driver.helix_deviation, geometry.driven.helix_deviation)
    straight = all(deviation is None or deviation.is_straight for deviation in bent)
    if geometry.driver.helix_angle == 0.0 and pair.misalignment == 0.0 and straight:
        return None
    speed = rotor_speeds(case)[shaft_of(case.gear_named(pair.driver))] if case.operation else 1.0
    return room.face_slices(geometry, sense=1 if speed >= 0.0 else -1, misalignment=pair.misalignment)


def pair_backlash(pair: GivenPair, geometry: room.GearPairGeometry) -> float | None:
    """The backlash of the case, else that of the teeth's thickness and the shafts' distance; None where there is none.

    Less than the rounding of printed sizes is none: nominal gears at their nominal distance have teeth as thick as the
    spaces, and no allowance from which a backlash would follow.
    """
    if pair.backlash is not None:
        return pair.backlash
    return geometry.backlash if geometry.backlash > _ROUNDED * geometry.driver.module else None


def backlash_doubts(pair: GivenPair, geometry: room.GearPairGeometry) -> list[dict[str, str]]:
    """A warning where the given backlash is not the one that thicknesses and distance of the shafts say."""
    made = geometry.backlash
    if pair.backlash is None or made <= _ROUNDED * geometry.driver.module:
        return []
    if abs(pair.backlash - made) <= _DIFFERS * made:
        return []
    message = (
        f"{geometry.label}: the backlash of {1e3 * pair.backlash:.4g} mm is not the {1e3 * made:.4g} mm that the "
        "thickness of the teeth and the distance of the shafts leave along the line of action; leave 'backlash' out "
        "for that"
    )
    return [{"name": "backlash", "message": message}]


def pair_geometries(case: Case) -> tuple[room.GearPairGeometry, ...]:
    """Both gears of every pair of the case in mesh."""
    return tuple(pair_geometry(case, pair) for pair in case.gear_pair)


def pair_geometry(case: Case, pair: GivenPair) -> room.GearPairGeometry:
    """The two gears at the distance of their shafts, or without backlash where there are no shafts."""
    driver, driven = case.gear_named(pair.driver), case.gear_named(pair.driven)
    distance = pair.centre_distance
    if driver.rotor is not None and driven.rotor is not None:
        axes = case.rotor_named(driver.rotor).axis, case.rotor_named(driven.rotor).axis
        distance = float(np.hypot(axes[1][0] - axes[0][0], axes[1][1] - axes[0][1]))
    return room.GearPairGeometry(build_gear(case, driver), build_gear(case, driven), distance)


def _model(pair: GivenPair, number: int, geometry: room.GearPairGeometry, force: float) -> room.StiffnessModel:
    stiffness = pair.stiffness
    if stiffness.file is not None:
        position, values = _table(stiffness.file, f"gear_pair[{number}].stiffness.file")
        return room.stiffness_model("table", position=position, stiffness=values)
    if stiffness.value is not None:
        return room.stiffness_model(stiffness.model, value=stiffness.value)
    if stiffness.model == "iso6336" and force > 0.0:
        # F_t / b: tangential force at the reference circle over the common width, as the norm's load per width.
        tangential = force * geometry.driver.base_radius / geometry.driver.pitch_radius
        return room.stiffness_model("iso6336", specific_load=tangential / geometry.face_width)
    if stiffness.model in ("elastic-ring", "cornell", "weber-banaschek") and force > 0.0:
        # Their contact stiffens with the load; it is frozen where one pair carries all of it.
        return room.stiffness_model(stiffness.model, force=force)
    return room.stiffness_model(stiffness.model)


def _table(path: Path | str, key: str) -> tuple[FloatArray, FloatArray]:
    """Two columns of a CSV file: position in base pitches, stiffness [N/m]; a first line of names may stand."""
    rows = []
    try:
        lines = Path(path).read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise CaseError([Problem(key, str(path), "a text file in UTF-8")]) from error
    for number, line in enumerate(lines, start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            first, second = (float(part) for part in line.split(","))
        except ValueError as error:
            if number == 1:
                continue
            expected = f"two numbers with a comma between in line {number} of {path}"
            raise CaseError([Problem(key, line[:60], expected)]) from error
        rows.append((first, second))
    if len(rows) < 2:
        raise CaseError([Problem(key, str(path), "at least two rows: position in base pitches, stiffness in N/m")])
    columns = np.array(rows, dtype=np.float64).T
    return columns[0], columns[1]


def _damping(case: Case, pair: GivenPair, mean_stiffness: float) -> float:
    """The mesh's damping coefficient [N s/m] from the ratio, with the inertia that sits where the gears do."""
    if pair.damping is not None:
        return pair.damping
    if pair.damping_ratio == 0.0:
        return 0.0
    driver, driven = case.gear_named(pair.driver), case.gear_named(pair.driven)
    mass = room.equivalent_mass(
        _inertia_at(case, driver),
        _inertia_at(case, driven),
        build_gear(case, driver).base_radius,
        build_gear(case, driven).base_radius,
    )
    return room.mesh_damping(pair.damping_ratio, mean_stiffness, mass)


def _inertia_at(case: Case, given: GivenGear) -> float:
    """Polar inertia of a gear with the discs at its station [kg m²]; of its whole rotor where that is nothing."""
    inertia = gear_inertia(case, given)[1]
    if given.rotor is not None and given.at is not None:
        rotor = case.rotor_named(given.rotor)
        discs = build_discs(case, rotor)
        inertia += sum(disc.polar_inertia for disc in discs if abs(disc.at - given.at) < 1e-6 * rotor.length)
        if inertia == 0.0:
            inertia = build_rotor(case, rotor).polar_inertia
    return inertia if inertia > 0.0 else build_gear(case, given).polar_inertia
