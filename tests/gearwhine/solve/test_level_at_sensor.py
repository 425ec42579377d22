"""Level at a sensor, the aim of a tip relief, against lines of the linear response by transmission error and shuttling.

The lines are those of the machine assembled anew with the flanks in question, as `load --sensitivity` has them.
"""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from coupled_cases import coupled

from gearwhine.case import Case, case_document, load_case, parse_case
from gearwhine.case.gears import ReliefAim
from gearwhine.coupling.analyses.gear_pairs import solve_over_torques
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears import TipRelief, loaded_transmission_error
from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair
from gearwhine.coupling.gears.loaded.optimal_relief import PeakToPeak
from gearwhine.coupling.gears.loaded.transmission_error import mesh_period_phases
from gearwhine.coupling.linear.frequency_response import mesh_error_response
from gearwhine.coupling.linear.line_sensitivity import LineModel
from gearwhine.coupling.linear.sensor_level import SensorLevel
from gearwhine.from_case.machine import describe_machine, solve_gears
from gearwhine.housing import HousingModes
from gearwhine.solve.gear_pairs import analyse_pairs, relief_aims
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.solve.machine import reduce_housing

HELIX = 15.0  # degrees
SENSOR = "right wall"
GIVEN = TipRelief(10e-6, length=1.5e-3)
HELD = np.diag([1.0, 1.0, 1.0, 0.0, 0.0])


def helical_case(relief: TipRelief | None, *more: str) -> Case:
    """The small gearbox at 1500 rpm with helical gears that have a relief, out of the middle of their shafts."""
    overrides = ["housing.box.mesh_size=60 mm", "rotor.input.unbalance=", "operation.speed=1500 rpm"]
    document = case_document(load_case("small-gearbox", [*overrides, "gear.*.at=80 mm", *more]).case)
    for gear, hand in zip(document["gear"], (1.0, -1.0), strict=True):
        # Normal module at the same centre distance.
        gear["module"] = f"{3.175 * np.cos(np.radians(HELIX))} mm"
        gear["helix_angle"] = f"{hand * HELIX} deg"
        gear["face_width"] = "30 mm"
        gear.pop("tip_relief")
        if relief is not None:
            gear["tip_relief"] = {"amount": relief.amount, "length": relief.length, "shape": relief.shape}
    for bearing in document["bearing"]:
        if bearing["name"].endswith("back"):
            bearing["stiffness"] = {"matrix": (1.2e8 * HELD).tolist()}
            bearing["damping"] = {"matrix": (500.0 * HELD).tolist()}
    document.pop("provenance")
    document["gear_pair"][0]["relief_aim"] = {"sensor": SENSOR}
    return parse_case(document)


@dataclass(frozen=True)
class Gearbox:
    """A case with its solved pairs, and the linear response by the lines of `load`."""

    case: Case
    housing: HousingModes
    pairs: tuple[LoadedGearPair, ...]
    model: LineModel

    def lines(self) -> dict[int, float]:
        """Amplitude of the sensor by the harmonic [m/s²]."""
        limit = 2.0 * np.pi * self.housing.trusted_limit_hz
        return {one.causes[0][1]: one.value for one in self.model.lines(limit, 12) if one.output.sensor == SENSOR}

    def level(self) -> float:
        """Root mean square over all harmonics [m/s²]."""
        return math.sqrt(0.5 * sum(value**2 for value in self.lines().values()))


@pytest.fixture(scope="module")
def housing() -> HousingModes:
    return solve_housing(helical_case(GIVEN))


def gearbox(housing: HousingModes, relief: TipRelief | None, *more: str) -> Gearbox:
    case = helical_case(relief, *more)
    pairs = solve_gears(case.parts)
    point = describe_machine(case, reduce_housing(case, housing)).operating_point()
    return Gearbox(case, housing, pairs, LineModel(coupled(case, housing), point, pairs, (False,), (False,)))


@pytest.fixture(scope="module")
def given(housing: HousingModes) -> Gearbox:
    return gearbox(housing, GIVEN)


@pytest.fixture(scope="module")
def aim(given: Gearbox) -> SensorLevel:
    (found,) = relief_aims(given.case, given.pairs)
    assert isinstance(found, SensorLevel)
    return found


def test_the_aim_is_by_default_the_sensor_that_the_given_flanks_make_loudest(given: Gearbox) -> None:
    case = helical_case(GIVEN)
    silent = case.model_copy(
        update={"gear_pair": tuple(pair.model_copy(update={"relief_aim": None}) for pair in case.gear_pair)}
    )
    (found,) = relief_aims(silent, given.pairs, housing=given.housing)
    assert isinstance(found, SensorLevel)
    limit = 2.0 * np.pi * given.housing.trusted_limit_hz
    levels: dict[str, float] = {}
    for line in given.model.lines(limit, 12):
        sensor = str(line.output.sensor)
        levels[sensor] = levels.get(sensor, 0.0) + 0.5 * line.value**2
    assert set(levels) == {"top", "right wall"}
    assert found.sensor == max(levels, key=lambda name: levels[name])
    assert level(found, given.pairs[0]) == pytest.approx(math.sqrt(levels[found.sensor]), rel=1e-6)
    (without,) = relief_aims(silent, given.pairs)
    assert without == PeakToPeak()
    aimless = case.gear_pair[0].model_copy(update={"relief_aim": ReliefAim(peak_to_peak=True)})
    (chosen,) = relief_aims(case.model_copy(update={"gear_pair": (aimless,)}), given.pairs, housing=given.housing)
    assert chosen == PeakToPeak()


def level(aim: SensorLevel, pair: LoadedGearPair) -> float:
    carrying = pair.carrying_flanks
    phases = mesh_period_phases(carrying, 200)
    return aim.of(loaded_transmission_error(carrying, pair.static.force, phases), carrying)


def test_the_level_of_the_given_flanks_is_that_of_their_lines(given: Gearbox, aim: SensorLevel) -> None:
    pair, lines = given.pairs[0], given.lines()
    mesh = loaded_transmission_error(pair.contact, pair.static.force, mesh_period_phases(pair.contact, 200))
    found = {n: abs(one) for n, one in aim.accelerations(mesh, pair.contact).items()}
    assert set(found) == set(lines) == {1, 2, 3, 4}
    np.testing.assert_allclose([found[n] for n in lines], list(lines.values()), rtol=1e-6)
    assert level(aim, pair) == pytest.approx(given.level(), rel=1e-6)


@pytest.mark.parametrize(
    "other_way",
    [("operation.speed=-1500 rpm",), ("operation.torque=-71.77 N*m",)],
    ids=["backward", "braking"],
)
def test_the_level_is_that_of_the_lines_whichever_way_the_gears_turn_or_carry(
    housing: HousingModes, other_way: tuple[str, ...]
) -> None:
    other = gearbox(housing, GIVEN, *other_way)
    (aim,) = relief_aims(other.case, other.pairs)
    assert isinstance(aim, SensorLevel)
    assert level(aim, other.pairs[0]) == pytest.approx(other.level(), rel=1e-4)


def test_the_parts_of_a_line_are_its_causes_alone(given: Gearbox) -> None:
    """Together they are the line; that by the error is the transmissibility by the spring of the mesh alone."""
    model, machine = given.model, given.model.machine
    parts = model.parts(2.0 * np.pi * given.housing.trusted_limit_hz)
    row, lines = machine.sensor_rows[SENSOR], given.lines()
    assert len(parts) == len(lines)
    contact = given.pairs[0].contact
    mesh = loaded_transmission_error(contact, given.pairs[0].static.force, mesh_period_phases(contact, 200))
    errors = model.transmission_error(0, mesh, hunting_period=1)
    for n, one in enumerate(parts, start=1):
        assert one.causes == ((0, n),)
        together = sum(one.parts.values())
        assert one.frequency**2 * abs(row @ together) == pytest.approx(lines[n], rel=1e-6)
        through = mesh_error_response(machine, np.array([one.frequency])).sensor_acceleration[SENSOR][0]
        spring = 1.0 + 1j * one.frequency * model.contact.damping[0] / model.contact.stiffness[0]
        by_error = -(one.frequency**2) * (row @ one.parts["transmission_error"])
        assert by_error == pytest.approx(through / spring * errors[n - 1], rel=1e-6)


def test_torque_ripple_of_a_mesh_s_order_is_no_part_of_its_lines(given: Gearbox, housing: HousingModes) -> None:
    """Lines and their parts are by the meshes, which the ripple leaves as they are."""
    (teeth,) = {gear.teeth for gear in given.case.gear}
    ripple = f"operation.ripple=[{{ amplitude = '30 N*m', order = {teeth} }}]"
    other = gearbox(housing, GIVEN, ripple)
    loads = (model.machine.system.harmonic_loads for model in (given.model, other.model))
    without, those = (np.sum([load.amplitude for load in each if load.frequency > 0.0], axis=0) for each in loads)
    assert np.abs(those - without).max() > 1.0
    assert other.lines() == pytest.approx(given.lines(), rel=1e-9)


def test_transmission_error_alone_is_not_that_level(given: Gearbox, aim: SensorLevel) -> None:
    """Shuttling matters in this machine: by the transmissibility alone a line is off by more than half."""
    contact, lines = given.pairs[0].contact, given.lines()
    mesh = loaded_transmission_error(contact, given.pairs[0].static.force, mesh_period_phases(contact, 200))
    errors = np.abs(aim.model.transmission_error(0, mesh, hunting_period=1))
    frequencies = 2.0 * np.pi * given.pairs[0].mesh_frequency * np.array(sorted(lines))
    through = np.abs(mesh_error_response(aim.model.machine, frequencies).sensor_acceleration[SENSOR])
    ratios = [through[n - 1] * errors[n - 1] / lines[n] for n in lines]
    assert max(abs(math.log(one)) for one in ratios) > math.log(1.5)


@pytest.mark.parametrize("relief", [None, TipRelief(25e-6, length=4e-3)])
def test_the_level_of_other_flanks_is_that_of_the_machine_with_them(
    housing: HousingModes, aim: SensorLevel, relief: TipRelief | None
) -> None:
    """By the mesh stiffness of the other flanks too, though the machine of the aim has that of the given ones."""
    other = gearbox(housing, relief)
    assert level(aim, other.pairs[0]) == pytest.approx(other.level(), rel=1e-4)


@pytest.mark.slow
def test_the_best_relief_is_quieter_than_others_by_their_lines(
    housing: HousingModes, given: Gearbox, aim: SensorLevel
) -> None:
    (pair,) = solve_over_torques(analyse_pairs(given.case, given.pairs), aims=[aim])
    assert pair.optimum is not None
    best = gearbox(housing, pair.optimum.relief)
    assert pair.optimum.value[0] == pytest.approx(best.level(), rel=0.01)
    for relief in (None, GIVEN, TipRelief(5e-6, length=4e-3), TipRelief(25e-6, length=4e-3)):
        assert best.level() <= 1.01 * gearbox(housing, relief).level()


def test_an_unknown_sensor_or_an_idle_mesh_is_refused(aim: SensorLevel) -> None:
    with pytest.raises(CouplingError, match="no sensor 'roof'; there are: top, right wall"):
        SensorLevel(aim.model, 0, "roof", {1: 1.0})
    with pytest.raises(CouplingError, match="mesh number 1 carries no mean force"):
        SensorLevel(aim.model, 1, SENSOR, {1: 1.0})
