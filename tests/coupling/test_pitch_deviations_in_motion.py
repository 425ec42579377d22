"""Pitch deviations in motion: one mass on a tooth contact, exact, quasi-static, and its energies."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from gearwhine.coupling import CoupledSystem, TransientOutputs, TransientSettings, simulate, static_equilibrium
from gearwhine.coupling.gears import (
    Gear,
    GearPairGeometry,
    PotentialEnergyStiffness,
    SquareStiffness,
    StiffnessModel,
    TipRelief,
    ToothContact,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.tooth_pair import ToothPairCurves
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.periodic import excitation_groups, periodic_response, superposed_response
from gearwhine.coupling.time.transient import TransientResult
from gearwhine.numerics.arrays import ComplexArray, FloatArray

TEETH = (12, 18)
PERIOD = 36
RNG = np.random.default_rng(3)
DEVIATIONS = tuple(RNG.uniform(-5e-6, 5e-6, teeth) for teeth in TEETH)
MASS = 0.4
LOAD = 2000.0


def contact_of(model: StiffnessModel, scale: float = 1.0, damping: float = 0.0, relief: float = 0.0) -> ToothContact:
    """A pair of 12 and 18 teeth at 25 degrees whose deviations are scaled."""
    gears = [
        Gear(
            str(teeth),
            teeth,
            4e-3,
            math.radians(25.0),
            12e-3,
            tip_relief=TipRelief(relief, math.radians(33.0)) if relief else None,
            pitch_deviations=tuple((scale * deviations).tolist()),
        )
        for teeth, deviations in zip(TEETH, DEVIATIONS, strict=True)
    ]
    return tooth_contact(GearPairGeometry(*gears), model, damping)


def system_of(contact: ToothContact, mesh_frequency: float, clearance: float = 0.0) -> CoupledSystem:
    """A mass that a constant force presses onto the contact."""
    direction = np.array([1.0 / math.sqrt(MASS)])
    none = np.zeros((1, 1))
    return CoupledSystem(
        components=(Component("mass", ("torsional",), none, none, none),),
        speeds=(0.0,),
        contacts=(ContactConnector("mesh", direction, contact, 0.0, mesh_frequency, np.zeros((0, 3)), clearance),),
        load=LOAD * direction,
    )


def run(system: CoupledSystem, settings: TransientSettings) -> TransientResult:
    rows = system.contact_directions.T
    return simulate(system, settings, TransientOutputs(rows, rows, rows))


def exact_motion(contact: ToothContact, stiffness: float, mesh_frequency: float, times: FloatArray) -> FloatArray:
    """Compression under unrelieved square pairs that never part: between events m x'' = F - c x' - Σ k (x - f)."""
    eps = contact.contact_ratio
    entries = np.arange(math.ceil(times[-1] * mesh_frequency) + 1.0)
    marks = np.sort(np.concatenate([entries, entries + eps % 1.0])) / mesh_frequency
    found = np.empty(times.size)
    state = np.full(2, math.nan)
    for start, end in itertools.pairwise(marks):
        phase = 0.5 * (start + end) * mesh_frequency
        whole = math.floor(phase)
        gaps = [float(contact.pitch_gaps[(whole - b) % PERIOD]) for b in range(3) if phase - whole + b < eps]
        rest = np.array([np.mean(gaps) + LOAD / (stiffness * len(gaps)), 0.0])
        rates = np.array([[0.0, 1.0], [-stiffness * len(gaps) / MASS, -contact.damping / MASS]])
        if np.isnan(state[0]):
            state = rest
        for sample in np.flatnonzero((times >= start) & (times < end)):
            found[sample] = (rest + expm(rates * (times[sample] - start)) @ (state - rest))[0]
        state = rest + expm(rates * (end - start)) @ (state - rest)
    return found


@pytest.mark.parametrize("contact_ratio", [1.4, 2.0])
def test_motion_is_the_exact_one_between_jumps(contact_ratio: float) -> None:
    contact = contact_of(SquareStiffness(2e8, contact_ratio), scale=0.2, damping=2.0 * 0.4 * math.sqrt(2e8 * MASS))
    frequency = 300.0
    settings = TransientSettings(40.0 / frequency, 0.0, 0.043 / frequency, 1e-5, tolerance=1e-4)
    result = run(system_of(contact, frequency), settings)
    expected = exact_motion(contact, 2e8, frequency, result.times)
    assert expected.min() > contact.pitch_gaps.max()  # so every pair on its path touches throughout
    swing = float(np.ptp(expected))
    np.testing.assert_allclose(result.compression[:, 0], expected, atol=2e-4 * swing)
    # With the teeth numbered one further on it is another motion: the comparison can fail.
    shifted = replace(contact, pitch_gaps=np.roll(contact.pitch_gaps, 1))
    other = exact_motion(shifted, 2e8, frequency, result.times)
    assert np.max(np.abs(other - expected)) > 0.1 * swing


@pytest.mark.parametrize("model", [PotentialEnergyStiffness(), SquareStiffness(2e8)])
def test_energies_balance_across_the_jumps(model: StiffnessModel) -> None:
    errors = []
    for tolerance in (1e-3, 3e-5):
        contact = contact_of(model, damping=200.0, relief=10e-6)
        settings = TransientSettings(20.0 / 900.0, 0.0, 1e-4, 1e-5, tolerance=tolerance)
        errors.append(run(system_of(contact, 900.0), settings).energy.error)
    assert errors[1] < 1e-4
    assert errors[1] < errors[0]


def test_slow_gears_follow_the_static_transmission_error_over_the_hunting_period() -> None:
    contact = contact_of(PotentialEnergyStiffness(), relief=25e-6)
    contact = contact.with_damping(2.0 * 0.5 * math.sqrt(contact.unloaded_mean_mesh_stiffness * MASS))
    frequency = 4.0
    settings = TransientSettings(PERIOD / frequency, 0.0, 0.0371 / frequency, 2e-4, tolerance=1e-2)
    result = run(system_of(contact, frequency), settings)
    static = loaded_transmission_error(contact, LOAD, frequency * result.times).transmission_error
    # Where a pair enters or leaves the mass still rings for a moment; elsewhere it follows.
    part = (frequency * result.times) % 1.0
    leaving = contact.contact_ratio % 1.0
    calm = (np.minimum(part, (part - leaving) % 1.0) > 0.05) & (result.times > 0.1 / frequency)
    assert calm.mean() > 0.7
    np.testing.assert_allclose(result.compression[calm, 0], static[calm], atol=2e-2 * np.ptp(static))
    perfect = loaded_transmission_error(replace(contact, pitch_gaps=np.zeros(0)), LOAD, frequency * result.times)
    assert np.ptp(static) > 1.2 * perfect.peak_to_peak_transmission_error


def test_steady_motion_repeats_with_the_hunting_period_and_no_sooner() -> None:
    contact = contact_of(PotentialEnergyStiffness(), relief=10e-6)
    contact = contact.with_damping(2.0 * 0.1 * math.sqrt(contact.unloaded_mean_mesh_stiffness * MASS))
    frequency, samples = 800.0, 16
    # Samples stand beside the jumps, never on them.
    begin, end = (2.0 * PERIOD + 0.5 / samples) / frequency, (4.0 * PERIOD + 1.0) / frequency
    settings = TransientSettings(end, begin, 1.0 / (samples * frequency), 1e-5, tolerance=1e-5)
    force = run(system_of(contact, frequency), settings).force[:, 0]
    first, second = force[: PERIOD * samples], force[PERIOD * samples : 2 * PERIOD * samples]
    scale = float(np.ptp(first))
    np.testing.assert_allclose(second, first, atol=1e-3 * scale)
    for turn in TEETH:
        assert np.max(np.abs(np.roll(first, turn * samples) - first)) > 0.05 * scale


def test_no_deviation_moves_the_same_to_the_last_bit() -> None:
    settings = TransientSettings(0.02, 0.0, 1e-4, 1e-5)
    plain = contact_of(PotentialEnergyStiffness(), scale=0.0, damping=100.0, relief=10e-6)
    assert plain.pitch_gaps.size == 0
    written_out = replace(plain, pitch_gaps=np.zeros(PERIOD))
    first, second = (run(system_of(contact, 900.0), settings) for contact in (plain, written_out))
    np.testing.assert_array_equal(second.compression, first.compression)
    np.testing.assert_array_equal(second.force, first.force)


@pytest.mark.parametrize("gap", [-2e-3, 2e-3])
def test_equilibrium_is_found_however_far_the_teeth_stand_apart(gap: float) -> None:
    # All pairs equally late or early: the load's own compression, moved by the gap.
    contact = contact_of(SquareStiffness(2e8), scale=0.0)
    moved = replace(contact, pitch_gaps=np.full(PERIOD, gap))
    here, there = (
        float((static_equilibrium(system) @ system.contact_directions)[0])
        for system in (system_of(contact, 50.0), system_of(moved, 50.0))
    )
    assert there == pytest.approx(here + gap, rel=1e-9)


def test_meshes_of_an_idler_have_a_motion_for_each_gear_and_loads_go_with_their_gear() -> None:
    """12, 18 and 13 teeth: three periods of mesh cycles; a load of the mesh is in all motions, whose weights make 1."""
    first = contact_of(PotentialEnergyStiffness(), 0.1)
    gears = [
        Gear(str(teeth), teeth, 4e-3, math.radians(25.0), 12e-3, pitch_deviations=(1e-6, *(0.0,) * (teeth - 1)))
        for teeth in (18, 13)
    ]
    second = tooth_contact(GearPairGeometry(*gears), PotentialEnergyStiffness())
    system = system_of(first, 800.0)
    (mesh,) = system.contacts
    unit = np.ones(1, dtype=np.complex128)
    rates = {"mesh": 800.0, "idler": 800.0 / 18.0, "other": 321.0}
    system = replace(
        system,
        contacts=(replace(mesh, name="a -> b"), replace(mesh, name="b -> c", contact=second)),
        harmonic_loads=tuple(HarmonicLoad(2.0 * math.pi * rate, unit) for rate in rates.values()),
    )
    assert [one.contact.hunting_period for one in system.contacts] == [36, 234]
    groups = excitation_groups(system)  # together 468 mesh cycles
    assert [one.weight for one in groups] == [-2, 1, 1, 1, 1]
    assert [round(800.0 / one.turn) if one.turn else one.turn for one in groups] == [0.0, 12, 13, 18, None]
    loads = [[round(rate / (2.0 * math.pi), 3) for rate in one.frequencies] for one in groups]
    assert loads == [[800.0], [800.0], [800.0], [800.0, 44.444], [321.0]]
    assert [one.turn for one in excitation_groups(system, longest_hunting=468)] == [None, None]


def test_the_part_of_a_gear_has_the_damage_that_most_of_its_pairs_have() -> None:
    """Tooth 5 of 12 and tooth 11 of 18 are damaged, and meet once in 36 cycles."""
    sound = contact_of(PotentialEnergyStiffness(), 0.0)
    pairs = np.arange(PERIOD)
    variants = 1 * (pairs % 12 == 5) + 2 * (pairs % 18 == 11)
    both = replace(sound, variants=(ToothPairCurves(sound.stiffness, sound.deviation),) * 3, pair_variants=variants)
    np.testing.assert_array_equal(both.teeth_of(driver=True).pair_variants, 1 * (np.arange(12) == 5))
    np.testing.assert_array_equal(both.teeth_of(driven=True).pair_variants, 2 * (np.arange(18) == 11))
    assert not both.teeth_of().pair_variants.any()
    assert both.teeth_of(driver=True, driven=True) is both


def superposed_and_whole(scale: float, relief: float) -> tuple[FloatArray, FloatArray, float]:
    """Lines at k / 36 of the mesh frequency of the sum and over the hunting period, and the neglected force."""
    contact = contact_of(PotentialEnergyStiffness(), scale, relief=relief)
    contact = contact.with_damping(2.0 * 0.1 * math.sqrt(contact.unloaded_mean_mesh_stiffness * MASS))
    system = system_of(contact, 800.0)
    groups = excitation_groups(system, longest_hunting=PERIOD - 1)
    # 12 and 18 teeth have six mesh cycles in common, which both motions have.
    assert [(one.weight, round(800.0 / one.turn) if one.turn else 0) for one in groups] == [(-1, 0), (1, 12), (1, 18)]
    whole, found = periodic_response(system), superposed_response(system, groups)
    assert [round(800.0 * one.response.period, 9) for one in found.motions] == [6, 12, 18]
    times = whole.period * (np.arange(PERIOD * 64) + 0.5) / (PERIOD * 64)
    total = np.zeros(times.size)
    for one in found.motions:
        total += one.group.weight * one.response.contacts_at(np.mod(times, one.response.period))[2][:, 0]
    sum_, exact = (np.fft.rfft(force) / times.size for force in (total, whole.contacts_at(times)[2][:, 0]))
    return sum_, exact, float(found.neglected_force[0])


def test_the_sum_by_teeth_of_each_gear_is_the_motion_over_the_hunting_period() -> None:
    """While the same pairs touch, gaps of pairs only add to the load: the sum is the whole motion, line by line."""
    sum_, exact, neglected = superposed_and_whole(0.1, 10e-6)
    assert np.abs(exact[1:PERIOD]).max() > 1e-2 * np.abs(exact[PERIOD])
    np.testing.assert_allclose(sum_, exact, atol=1e-5 * np.abs(exact[PERIOD]))
    assert neglected < 1e-6 * LOAD


def test_the_difference_from_the_hunting_period_falls_with_the_square_of_the_deviations() -> None:
    """Where a gap decides how long a pair touches, lines of both gears' teeth together are of the second order."""
    missed, parts = [], []
    for scale in (0.2, 0.1, 0.05):
        sum_, exact, neglected = superposed_and_whole(scale, 60e-6)
        difference = np.abs(exact - sum_)[1:]
        missed.append(difference[: 3 * PERIOD].max())
        parts.append(math.sqrt(2.0 * np.sum(difference**2)) / neglected)
    assert 3.0 < missed[0] / missed[1] < 5.0
    assert 3.0 < missed[1] / missed[2] < 5.0
    # The mass does not follow the shortest of the pulses that the sum leaves out.
    assert 0.7 < parts[0] < 1.3
    assert max(parts) < 1.3


def test_the_answer_to_the_neglected_force_is_what_the_sum_misses() -> None:
    """Line by line, with its phase, to 2 % of the largest: both motions are solved to some 1e-3 of their size."""
    contact = contact_of(PotentialEnergyStiffness(), relief=60e-6)
    contact = contact.with_damping(2.0 * 0.1 * math.sqrt(contact.unloaded_mean_mesh_stiffness * MASS))
    system = system_of(contact, 800.0)
    whole = periodic_response(system)
    sum_ = superposed_response(system, excitation_groups(system, longest_hunting=PERIOD - 1))
    (stiffness,) = (mean.stiffness for mean in sum_.means)

    def receptance(w: FloatArray) -> ComplexArray:
        return (1.0 / (stiffness - MASS * w**2 + 1j * w * contact.damping))[None, None]

    neglected, settled = sum_.neglected_spectrum(receptance)
    assert settled
    times = whole.period * np.arange(PERIOD * 64) / (PERIOD * 64)
    missed = whole.contacts_at(times)[0][:, 0]
    for one in sum_.motions:
        missed = missed - one.group.weight * one.response.contacts_at(np.mod(times, one.response.period))[0][:, 0]
    cycles = np.arange(1, 3 * PERIOD)
    np.testing.assert_allclose(neglected.frequencies[cycles] * whole.period, cycles, rtol=1e-9)
    answer = -receptance(2.0 * np.pi * neglected.frequencies)[0, 0] * neglected.lines[0]
    expected = 2.0 * np.fft.rfft(missed)[cycles] / times.size
    np.testing.assert_allclose(answer[cycles], expected, atol=0.02 * np.abs(expected).max())
