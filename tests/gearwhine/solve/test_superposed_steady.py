"""Steady motion of a two-stage train: each mesh's own motion, superposed, against the whole common period."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from coupled_cases import coupled
from reducer_case import reducer
from sounding_gearbox import sounding_housing

from gearwhine.case import load_case
from gearwhine.cli import run_command
from gearwhine.coupling import CoupledMachine, CoupledSystem, CouplingError, PeriodicError, amplitude_spectrum
from gearwhine.coupling.analyses import steady_state
from gearwhine.coupling.analyses.steady_state import SolvedSteady, SteadyMotion, solve_steady, spectra_of_sum
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.periodic import orbit, periodic_response, shooting, superposed_response
from gearwhine.coupling.periodic.response import PeriodicResponse
from gearwhine.coupling.periodic.superposition import SuperposedResponse, common_cycles, excitation_groups
from gearwhine.coupling.signals.spectrum import Spectrum
from gearwhine.coupling.sound.motion_lines import lines_of_steady
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.housing import HousingModes
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.output.manifest import opened_dataset
from gearwhine.results import chapters_of
from gearwhine.results.steady_state import steady_document

SHORT = (21, 30, 19, 56)  # 30 cycles of the first mesh are 19 of the second


def machine_of(folder: Path, text: str) -> CoupledMachine:
    place = folder / "reducer.toml"
    place.write_text(text, encoding="utf-8")
    case = load_case(str(place), []).case
    return coupled(case)


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> CoupledMachine:
    return machine_of(tmp_path_factory.mktemp("reducer"), reducer(SHORT))


@pytest.fixture(scope="module")
def whole(machine: CoupledMachine) -> PeriodicResponse:
    """The motion under both meshes over their common period."""
    return periodic_response(machine.system, tolerance=1e-5)


@pytest.fixture(scope="module")
def superposed(machine: CoupledMachine) -> SuperposedResponse:
    return superposed_response(machine.system, excitation_groups(machine.system, longest=1.0), tolerance=1e-5)


def test_lines_at_both_mesh_frequencies(
    machine: CoupledMachine, whole: PeriodicResponse, superposed: SuperposedResponse
) -> None:
    """Three harmonics within 3 % of the motion over the common period, in the own mesh and in the other one.

    Higher ones meet a resonance, where a small force does much: they differ by less than the force that is left out.
    """
    outputs, samples = transient_outputs(machine), 2**14
    record = whole.record(outputs, samples)
    assert [len(motion.group.meshes) for motion in superposed.motions] == [1, 1]
    for motion in superposed.motions:
        own = motion.response.record(outputs, 2048)
        for mesh in (0, 1):
            lines = amplitude_spectrum(own.force[:, mesh], motion.response.period / 2048)
            expected = amplitude_spectrum(record.force[:, mesh], whole.period / samples)
            for harmonic in range(1, 9):
                cycles = round(lines.frequencies[harmonic] * whole.period)
                missed = abs(lines.amplitude[harmonic] - expected.amplitude[cycles])
                assert missed < np.sqrt(2.0) * superposed.neglected_force[mesh]
                # Of a line that nearly cancels, small parts of the large ones beside it are all there is.
                if harmonic <= 3 and expected.amplitude[cycles] > 1e-2 * expected.amplitude[1:].max():
                    assert missed < 0.03 * expected.amplitude[cycles]
    np.testing.assert_allclose(superposed.mean_force[:2], whole.mean_force[:2], rtol=1e-3)
    # Sums of squares of lines, of which the strongest are missed by 1 to 2 %.
    np.testing.assert_allclose(superposed.rms_compression[:2], whole.rms_compression[:2], rtol=2e-2)
    # Phases are independent in the sum, and only some of them in a common period.
    np.testing.assert_allclose(superposed.peak_force[:2], whole.peak_force[:2], rtol=0.05)


def test_what_is_neglected_is_the_difference_of_the_forces(
    machine: CoupledMachine, whole: PeriodicResponse, superposed: SuperposedResponse
) -> None:
    """Its size is that by which the mesh forces of both motions differ: the machine's answer to it comes on top."""
    outputs, samples = transient_outputs(machine), 2**14
    record = whole.record(outputs, samples)
    total = np.zeros((samples, 2))
    for motion in superposed.motions:
        _, _, force = motion.response.contacts_at(np.mod(record.times, motion.response.period))
        total += force[:, :2] - superposed.mean_force[:2]
    total += superposed.mean_force[:2]
    different = np.sqrt(np.mean((record.force[:, :2] - total) ** 2, axis=0))
    assert np.all(different < 3.0 * superposed.neglected_force[:2].max())
    assert different.max() > 0.3 * superposed.neglected_force[:2].max()


def test_bearing_loads_of_the_sum_are_those_over_the_common_period(
    machine: CoupledMachine, whole: PeriodicResponse, superposed: SuperposedResponse
) -> None:
    """Means by statics, rms by powers; peaks add, as phases are independent in the long run."""

    def motion(response: PeriodicResponse, samples: int) -> SteadyMotion:
        record = response.record(transient_outputs(machine), samples)
        return SteadyMotion(1.0, response, histories(machine, record), np.inf)

    over_period = SolvedSteady(machine, (motion(whole, 2**14),)).bearing_parts()
    parts = tuple(motion(one.response, 2048) for one in superposed.motions)
    sums = SolvedSteady(machine, parts, superposed=superposed).bearing_parts()
    assert len(sums) == 6
    for (name, expected), (same, found) in zip(over_period, sums, strict=True):
        assert same == name
        largest = np.abs(expected.mean).max()
        np.testing.assert_allclose(found.mean, expected.mean, atol=1e-6 * largest)
        np.testing.assert_allclose(found.rms, expected.rms, atol=0.01 * expected.rms.max())
        # Short of a bound by the force that the sum leaves out.
        assert np.all(found.peak >= 0.97 * expected.peak)
        assert np.all(found.peak <= 1.1 * expected.peak + 1e-9 * largest)


def test_a_linear_machine_is_superposed_without_error(machine: CoupledMachine) -> None:
    """Constant mesh stiffness, runout in both meshes: the sum leaves nothing out."""
    law = ToothContact(1.0, piecewise.constant(2e8, 1.0), piecewise.constant(0.0, 1.0), damping=500.0)
    contacts = tuple(
        replace(contact, contact=law, errors=np.array([[2e-6, 2.0 * np.pi * rate, 0.3]]))
        for contact, rate in zip(machine.system.contacts, (50.0, 13.7), strict=True)
    )
    system = replace(machine.system, contacts=contacts)
    groups = excitation_groups(system)
    assert [group.meshes for group in groups] == [(), ()]
    found = superposed_response(system, groups)
    assert found.neglected_force.max() < 1e-6 * found.mean_force.max()
    assert len(found.motions) == 2


def test_runout_of_shafts_that_turn_either_way_has_a_part_in_the_sum() -> None:
    """A mass m on teeth of stiffness k follows e = Σ a cos(w t): compressions of amplitude a m w² / |k - m w² + i w c|.

    The frequency of a shaft that turns backwards is negative.
    """
    mass, stiffness, damping = 0.4, 2e8, 900.0
    contact = ToothContact(1.0, piecewise.constant(stiffness, 1.0), piecewise.constant(0.0, 1.0), damping=damping)
    errors = np.array([[3e-6, 4e3, 0.3], [2e-6, -9e3 * np.sqrt(2.0), 1.0]])
    direction, none = np.array([1.0 / np.sqrt(mass)]), np.zeros((1, 1))
    system = CoupledSystem(
        components=(Component("mass", ("torsion",), none, none, none),),
        speeds=(0.0,),
        contacts=(ContactConnector("teeth", direction, contact, 0.0, 0.0, errors),),
        load=2000.0 * direction,
    )
    found = superposed_response(system, excitation_groups(system))
    amplitudes, w = errors[:, 0], errors[:, 1]
    expected = amplitudes * mass * w**2 / np.abs(stiffness - mass * w**2 + 1j * w * damping)
    parts = sorted(float(one.response.rms_compression[0]) for one in found.motions)
    assert parts == pytest.approx(sorted(expected / np.sqrt(2.0)), rel=1e-4)
    assert found.rms_compression[0] == pytest.approx(np.sqrt(np.sum(expected**2) / 2.0), rel=1e-2)


def test_neglected_forces_move_the_sensors_by_the_machine_s_matrices(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two meshes on three masses: a = w² s (K - w² + i w C)⁻¹ D f, as the force of a mesh acts against its line."""
    generator = np.random.default_rng(8)
    directions, rows = generator.normal(size=(2, 3)), generator.normal(size=(2, 3))
    own = np.diag([1e6, 4e6, 9e6])
    contact = ToothContact(1.0, piecewise.constant(1.0, 1.0), piecewise.constant(0.0, 1.0), damping=30.0)
    connectors = [ContactConnector(str(i), d, contact, 0.0, 100.0, np.zeros((0, 3))) for i, d in enumerate(directions)]
    part = Component("masses", ("torsion",) * 3, own, 20.0 * np.eye(3), np.zeros((3, 3)))
    system = CoupledSystem((part,), (0.0,), contacts=tuple(connectors))
    frequencies = np.array([0.0, 100.0, 250.0, 400.0])
    forces = Spectrum(frequencies, generator.uniform(1.0, 2.0, (2, 4)), generator.uniform(-3.0, 3.0, (2, 4)), "uniform")
    stiffness, w = np.array([2e6, 5e6]), 2.0 * np.pi * frequencies
    total = own + (directions.T * stiffness) @ directions
    damped = 20.0 * np.eye(3) + 30.0 * directions.T @ directions
    answers = np.array([np.linalg.solve(total - v**2 * np.eye(3) + 1j * v * damped, directions.T) for v in w])

    def neglected_spectrum(receptance: Callable[[FloatArray], ComplexArray]) -> tuple[Spectrum, bool]:
        np.testing.assert_allclose(receptance(w[1:]), np.moveaxis(directions @ answers[1:], 0, 2), rtol=1e-8)
        return forces, True

    monkeypatch.setattr(steady_state, "transient_outputs", lambda _: SimpleNamespace(acceleration=rows))
    machine: Any = SimpleNamespace(system=system, sensor_rows={"top": rows[0], "side": rows[1]})
    means = [SimpleNamespace(stiffness=value) for value in stiffness]
    superposed: Any = SimpleNamespace(means=means, neglected_spectrum=neglected_spectrum)
    found, settled = steady_state._neglected_acceleration(machine, superposed, 300.0)
    assert settled
    for number, name in enumerate(("top", "side")):
        assert found[name].frequencies.tolist() == [100.0, 250.0]
        expected = [v**2 * rows[number] @ answers[i] @ forces.lines[:, i] for i, v in enumerate(w)]
        np.testing.assert_allclose(found[name].lines, expected[1:3], rtol=1e-8)


def test_groups_of_hunting_teeth(tmp_path: Path) -> None:
    """The unbalance of the input makes 21 cycles of its mesh a period; that of the output fits neither mesh."""
    system = machine_of(tmp_path, reducer(unbalanced="input")).system
    first, second = excitation_groups(system)
    assert first.meshes == (0,)
    assert first.frequencies == pytest.approx((100.0 * np.pi,))
    assert second.meshes == (1,)
    assert common_cycles(system) == pytest.approx(21 * 24)
    system = machine_of(tmp_path, reducer(unbalanced="output")).system
    assert [group.meshes for group in excitation_groups(system)] == [(0,), (1,), ()]
    (together,) = excitation_groups(machine_of(tmp_path, reducer(SHORT)).system)
    assert together.meshes == (0, 1)


def test_load_shuttling_of_a_damaged_mesh_is_of_one_motion_with_it() -> None:
    """A crack repeats with the pinion's 23 teeth; harmonics of the mesh fit in, and their lines add with phases."""
    case = load_case("helical-pair", ['gear.pinion.fault=[{kind="crack",tooth=5,depth="1 mm"}]']).case
    system = coupled(case).system
    shuttling = [abs(load.frequency) for load in system.harmonic_loads]
    assert max(shuttling) > 2.5 * 2.0 * np.pi * system.contacts[0].mesh_frequency
    assert common_cycles(system) > 40.0
    (together,) = excitation_groups(system)
    assert together.meshes == (0,)
    assert sorted(together.frequencies) == pytest.approx(sorted(shuttling))


def test_a_mesh_without_torque_is_refused(machine: CoupledMachine) -> None:
    idle = replace(machine.system, load=np.zeros(machine.system.size))
    with pytest.raises(PeriodicError, match="carries no mean force"):
        superposed_response(idle)


@pytest.mark.slow
def test_the_command_says_which_was_done(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = tmp_path / "reducer.toml"
    place.write_text(reducer(unbalanced="output"), encoding="utf-8")
    assert run_command(["steady", str(place), "-q", "-o", str(tmp_path / "out")]) == 0
    assert "these are superposed" in capsys.readouterr().out.replace("\n", " ")
    document = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert document["method"] == "superposed"
    (motion,) = document["motions"]
    names = ["mesh a -> b", "mesh c -> d", "rotation of output"]
    assert [one["name"] for one in motion["excitations"]] == names
    assert motion["stable"]
    for pair in motion["gear_pairs"]:
        assert {line["excitation"] for line in pair["force_lines"]} <= set(names)
        assert 0.0 < pair["neglected_part"] < 0.2
    with opened_dataset(tmp_path / "out" / "results.nc") as data:
        assert data["excitation_mesh_force"].dims == ("excitation", "contact", "period_part")
        assert data["excitation_period"].values == pytest.approx([1 / 1050, 72 / 1050 / 19, 72 * 56 / 1050 / 19])
    text = " ".join(sentence for section in chapters_of(document) for sentence in section.sentences)
    assert "these are superposed" in text


def test_a_line_beside_a_harmonic_of_the_other_mesh_has_the_name_of_its_cause_alone(tmp_path: Path) -> None:
    """The first mesh is at 22 turns of the input, four times the second at 4 * 19 * 22 / 75 = 22.29."""
    motion = solve_steady(machine_of(tmp_path, reducer((22, 75, 19, 56))))
    document = steady_document("reducer", motion)
    lines = [line for pair in document["motions"][0]["gear_pairs"] for line in pair["force_lines"]]
    named = {line["name"]: line["frequency_hz"] / 50.0 for line in lines}
    assert {"1× a -> b", "4× c -> d"} <= set(named)
    for name, order in named.items():
        harmonic, mesh = name.split("× ")
        assert order == pytest.approx(int(harmonic) * {"a -> b": 22.0, "c -> d": 19 * 22 / 75}[mesh], rel=1e-9)


def test_a_long_hunting_period_is_said_before_it_is_solved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """21 and 72 teeth meet again after 504 mesh periods, where one of either gear is off its place."""

    def stopped(*_: object, **__: object) -> None:
        raise PeriodicError("stopped")

    for name in ("superposed_response", "periodic_response"):
        monkeypatch.setattr(f"gearwhine.coupling.analyses.steady_state.{name}", stopped)
    text = reducer()
    for name, teeth in (("a", 21), ("b", 72)):
        deviations = ", ".join(['"0 um"'] * (teeth - 1) + ['"1 um"'])
        text = text.replace(f'name = "{name}"\n', f'name = "{name}"\nerrors = {{ pitch = [{deviations}] }}\n')
    for pitch, expected in ((text, True), (reducer(), False)):
        told: list[str] = []
        with pytest.raises(PeriodicError, match="stopped"):
            solve_steady(machine_of(tmp_path, pitch), progress=told.append, exact=True)
        assert any("a motion over 504 mesh cycles" in one for one in told) == expected


def test_a_branch_of_superposed_motions_is_refused_at_once(tmp_path: Path) -> None:
    place = tmp_path / "reducer.toml"
    place.write_text(reducer(unbalanced="input"), encoding="utf-8")
    case = load_case(str(place), []).case
    machine = coupled(case)
    with pytest.raises(CouplingError, match="holds 504 cycles of the fastest one"):
        solve_steady(machine, over_speed=(100.0, 200.0))


def test_many_changes_of_contact_are_no_fault(machine: CoupledMachine) -> None:
    """The march is made again with more room, whatever it began with."""
    ready = shooting.problem(machine.system)
    elements = ready.elements(0)
    start = np.zeros((ready.segments, ready.part.states))
    count = len(elements.starts)
    within = orbit._pass_within
    assert within(ready.part, ready.contacts, elements, start, -count // 2, varied=False) is None
    found = orbit.integrate_period(ready.part, ready.contacts, elements, start, varied=False)
    assert len(found.trace.start) >= count


def test_the_steady_motion_of_a_braked_machine_is_told_of_its_back_flanks() -> None:
    """The mean force of the flanks that carry is the torque over the base radius."""
    changes = ["operation.torque=-100 N*m", "gear_pair.0.backlash=0.1 mm", "rotor.0.modes=1", "rotor.1.modes=1"]
    case = load_case("spur-pair", changes).case
    machine = coupled(case)
    assert machine.loaded_contacts == (1,)
    (motion,) = steady_document(case.title, solve_steady(machine))["motions"]
    base_radius = 0.5 * 28 * 3.175e-3 * np.cos(np.radians(20.0))
    (pair,) = motion["gear_pairs"]
    assert pair["mean_force_n"] == pytest.approx(100.0 / base_radius, rel=1e-3)
    assert pair["contact_loss_fraction"] == 0.0


def hunting_pair(micrometres: float, name: str = "spur-pair", housing: HousingModes | None = None) -> CoupledMachine:
    """12 and 14 teeth with pitch errors of a size, which meet again after 84 mesh cycles; both shafts unbalanced."""
    errors = np.random.default_rng(5).uniform(-micrometres, micrometres, 14)
    changes = ['gear.*.module="6.838462 mm"', 'gear.*.pressure_angle="25 deg"']
    changes += ['gear.*.tip_relief={amount="10 um",start_roll_angle="33 deg"}']
    changes += ['rotor.1.unbalance=[{at="100 mm",moment="2e-5 kg*m"}]']
    for gear, teeth in (("pinion", 12), ("wheel", 14)):
        pitch = ",".join(f'"{error:.4f} um"' for error in errors[:teeth])
        changes += [f"gear.{gear}.teeth={teeth}", f"gear.{gear}.errors={{pitch=[{pitch}]}}"]
    return coupled(load_case(name, changes).case, housing)


@pytest.mark.slow
def test_unequal_teeth_of_both_gears_have_the_lines_of_the_hunting_period() -> None:
    """Errors of 1 µm, of which next to nothing is left out: lines, bearing loads and names are those of the period."""
    machine = hunting_pair(1.0)
    whole, sum_ = solve_steady(machine), solve_steady(machine, superpose=True)
    names = ["mesh pinion -> wheel", "unequal teeth of pinion, rotation of input"]
    names += ["unequal teeth of wheel, rotation of output"]
    assert [one.excitation for one in sum_.motions] == names
    assert [one.group.weight for one in sum_.motions] == [-1, 1, 1]
    assert (whole.hunting_mesh_cycles, sum_.hunting_mesh_cycles) == (None, 84)
    told, found = (steady_document("pair", one)["motions"][0] for one in (whole, sum_))
    lines = {line["name"]: line for line in told["gear_pairs"][0]["force_lines"]}
    assert {line["excitation"] for line in found["gear_pairs"][0]["force_lines"]} == set(names)
    for line in found["gear_pairs"][0]["force_lines"]:
        assert line["frequency_hz"] == pytest.approx(lines[line["name"]]["frequency_hz"], rel=1e-9)
    (motion,) = whole.motions
    for name, of_whole in motion.histories.mesh_force.items():
        expected = motion.spectrum(of_whole)
        lines_of_sum = np.zeros(5 * 84, dtype=np.complex128)
        spectra = spectra_of_sum(sum_.motions, [one.histories.mesh_force[name] for one in sum_.motions])
        for spectrum in spectra:
            cycles = np.round(spectrum.frequencies * motion.response.period).astype(int)
            lines_of_sum[cycles[(cycles > 0) & (cycles < 420)]] += spectrum.lines[(cycles > 0) & (cycles < 420)]
        np.testing.assert_allclose(lines_of_sum[1:], expected.lines[1:420], atol=0.5)
        assert np.hypot.reduce([one.rms(np.inf) for one in spectra]) == pytest.approx(expected.rms(np.inf), rel=2e-3)
    for bearing, of_whole in zip(found["bearings"], told["bearings"], strict=True):
        for key in ("mean_force_n", "rms_force_n"):
            np.testing.assert_allclose(bearing[key], of_whole[key], rtol=5e-3, atol=0.05)
    for (_, parts), (_, of_whole) in zip(sum_.bearing_parts(), whole.bearing_parts(), strict=True):
        assert np.all(of_whole.peak[:2] <= parts.peak[:2] * 1.01)
        assert np.all(parts.peak[:2] <= 1.5 * of_whole.peak[:2])
    assert not sum_.superposition_warnings()
    with pytest.raises(CouplingError, match="exact and superpose together"):
        solve_steady(machine, exact=True, superpose=True)


@pytest.mark.slow
def test_sensors_and_forces_on_the_housing_miss_as_much_as_is_estimated() -> None:
    """Errors of 4 µm: what the sum leaves out makes 4 and 6 % of accelerations, and its lines add what is missed."""
    machine = hunting_pair(4.0, "small-gearbox", sounding_housing())
    whole, sum_ = solve_steady(machine), solve_steady(machine, superpose=True)
    assert sum_.neglected_settles
    sensors = steady_document("pair", sum_)["motions"][0]["sensors"]
    (motion,) = whole.motions
    period = motion.response.period
    for name, of_whole in motion.histories.sensor_acceleration.items():
        spectrum = motion.spectrum(of_whole)
        missed = -spectrum.lines
        for part in spectra_of_sum(sum_.motions, [one.histories.sensor_acceleration[name] for one in sum_.motions]):
            cycles = np.round(part.frequencies * period).astype(int)
            np.add.at(missed, cycles[cycles < missed.size], part.lines[cycles < missed.size])
        inside = (spectrum.frequencies > 0.0) & (spectrum.frequencies <= motion.trusted_limit)
        rms = np.sqrt(0.5 * np.sum(np.abs(missed[inside]) ** 2))
        neglected = sum_.neglected_acceleration[name]
        assert rms == pytest.approx(float(neglected.rms(np.inf)), rel=0.05)
        added = np.zeros_like(missed)
        added[np.round(neglected.frequencies * period).astype(int)] = neglected.lines
        assert np.sqrt(0.5 * np.sum(np.abs(missed + added)[inside] ** 2)) < 0.05 * rms
        (told,) = (one["neglected_lines"] for one in sensors if one["name"] == name)
        assert [line["amplitude_m_per_s2"] for line in told] == pytest.approx(
            [abs(missed[round(line["frequency_hz"] * period)]) for line in told], rel=0.2
        )
        assert 0.02 < rms / motion.sensor_rms[name] < 0.1
        assert sum_.rms_of_sum(name) == pytest.approx(motion.sensor_rms[name], rel=0.03)
    expected, found = (lines_of_steady(one, motion.trusted_limit) for one in (whole, sum_))
    for bearing, of_whole in expected.forces.items():
        power, power_of_sum = (np.sum(np.abs(force) ** 2) for force in (of_whole, found.forces[bearing]))
        assert power_of_sum == pytest.approx(power, rel=0.05)
    assert set(np.round(found.frequencies * period).astype(int)) < set(
        np.round(expected.frequencies * period).astype(int)
    )
    neglected = sum_.neglected_acceleration["top"]
    share = 0.4 * sum_.rms_of_sum("top") / float(neglected.rms(np.inf))
    larger = replace(neglected, amplitude=share * neglected.amplitude)
    sum_ = replace(sum_, neglected_acceleration={"top": larger})
    (told,) = (one for one in sum_.superposition_warnings() if "sensor" in one)
    assert told["sensor"] == "top"
    assert told["neglected_part"] == pytest.approx(0.4)
