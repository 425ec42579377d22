"""The bundled case of the three-stage gear system against NASA TM-101442 (Choy, Tu, Savage and Townsend, 1989).

Table I: three lateral and two torsional natural frequencies of each of three stages, 15 in all, held to 1 %. The rotors
were found so that they have them; no dimension is printed.

Discussion of Results: what its text says of Figs. 4 to 12, which the source gives as plots without numbers, is the
checklist here, statement by statement. Its plots end at 1024 Hz (Fig. 11), and so does what is read off ours. The
coupled system has not the frequencies of Table I, whose stages stand alone: a line is called 355 Hz where it lies
within 2.5 Hz, two lines of the record.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from coupled_cases import coupled

from gearwhine.case import Case, load_case
from gearwhine.coupling import TransientOutputs, TransientSettings, amplitude_spectrum, simulate
from gearwhine.coupling.analyses.transient import starting_state
from gearwhine.coupling.signals.peaks import spectral_peaks
from gearwhine.coupling.signals.spectrum import Spectrum
from gearwhine.coupling.time.histories import histories, modal_rows, transient_outputs
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import rest_frequencies, solve_torsional_modes
from gearwhine.solve.machine import plan_of

TABLE_I = "NASA TM-101442 (Choy et al., 1989), Table I, natural frequencies of the stages"
TEXT = "NASA TM-101442 (Choy et al., 1989), text on Figs. 4 to 12"
LATERAL_HZ = {1: (115.0, 145.0, 190.0), 2: (160.0, 189.0, 264.0), 3: (110.0, 200.0, 260.0)}
TORSIONAL_HZ = {1: (355.0, 1090.0), 2: (550.0, 1610.0), 3: (280.0, 820.0)}
LAST_HZ = 1024.0  # of the source's frequency axes
PER_REVOLUTION = 4096
SETTLED, ORBIT = 10, 5  # last revolutions taken for settled, and for the orbits
MESHES = ("gear-1 -> gear-2", "gear-1 -> gear-3")


@dataclass(frozen=True)
class Run:
    """The case's transient, from its unloaded start: mesh forces [N], orbits [m], and modal coordinates by stage."""

    interval: float
    force: dict[str, FloatArray]
    orbit: dict[int, FloatArray]
    torsion: FloatArray  # of stage 1: the rigid rotation and both elastic modes of Table I, shape (3, s)
    lateral: dict[int, FloatArray]  # first mode in x and in y, shape (2, s)

    def lines(self, signal: FloatArray) -> Spectrum:
        """The whole record under Hann's window: free vibrations are no whole periods of it."""
        return amplitude_spectrum(signal, self.interval, "hann")

    def settled(self, signal: FloatArray) -> FloatArray:
        return signal[..., -SETTLED * PER_REVOLUTION :]


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case("three-stage").case


@pytest.fixture(scope="module")
def run(case: Case) -> Run:
    assert case.transient is not None
    assert case.operation is not None
    machine = coupled(case)
    period = 2.0 * np.pi / case.operation.speed
    stages = {stage: modal_rows(machine, f"stage-{stage}") for stage in (1, 2, 3)}
    outputs = transient_outputs(machine)
    first = len(outputs.displacement)
    lateral = [rows for stage in stages.values() for rows in (stage.x[:1], stage.y[:1])]
    result = simulate(
        machine.system,
        TransientSettings(
            duration=case.transient.revolutions * period,
            record_from=0.0,
            sample_interval=period / PER_REVOLUTION,
            largest_step=period / case.transient.points_per_revolution,
            tolerance=case.transient.tolerance,
        ),
        TransientOutputs(
            np.concatenate([outputs.displacement, stages[1].torsion[:3], *lateral]),
            outputs.velocity,
            outputs.acceleration,
        ),
        initial=starting_state(machine, plan_of(case)),
    )
    assert result.energy.error < 1e-3
    named = histories(machine, result)
    modal = result.displacement[:, first:].T
    return Run(
        interval=period / PER_REVOLUTION,
        force=named.mesh_force,
        orbit={stage: named.gear_motion[f"gear-{stage}"][:, :2] for stage in (1, 2, 3)},
        torsion=modal[:3],
        lateral={stage: modal[1 + 2 * stage : 3 + 2 * stage] for stage in (1, 2, 3)},
    )


def fails(reason: str) -> pytest.MarkDecorator:
    return pytest.mark.xfail(strict=True, raises=AssertionError, reason=reason)


def line_at(spectrum: Spectrum, frequency: float, reach: float = 2.5) -> float:
    """The highest amplitude within a reach of a frequency [Hz]."""
    return float(spectrum.amplitude[np.abs(spectrum.frequencies - frequency) <= reach].max())


@pytest.mark.parametrize("stage", [1, 2, 3])
def test_natural_frequencies_of_the_stages(
    case: Case, stage: int, published: Callable[..., None], remark: Callable[[str, str], None]
) -> None:
    remark(
        TABLE_I,
        "Found, not predicted: no dimension is printed, and the shafts, discs and bearings of the case were searched "
        "so that these fifteen frequencies hold (studies/find_three_stage.py). Lateral modes are planar ones on "
        "averaged supports, torsional ones those of the free shaft, rigid rotation apart.",
    )
    (rotor,) = (rotor for rotor in case.parts.rotors if rotor.name == f"stage-{stage}")
    bearings = case.parts.bearings_on(rotor.name)
    both_planes = rest_frequencies(rotor, bearings, count=6).frequencies / (2.0 * np.pi)
    # Supports are isotropic, so that each lateral frequency stands in both planes.
    assert both_planes[:6:2] == pytest.approx(both_planes[1:6:2], rel=1e-9)
    torsional = solve_torsional_modes(rotor, count=3).frequencies / (2.0 * np.pi)
    assert torsional[0] == 0.0
    for number, (value, ours) in enumerate(zip(LATERAL_HZ[stage], both_planes[:6:2], strict=True), start=1):
        published(TABLE_I, f"stage {stage}, lateral mode {number}", value, ours, "Hz", rel=0.01)
    for number, (value, ours) in enumerate(zip(TORSIONAL_HZ[stage], torsional[1:], strict=True), start=1):
        published(TABLE_I, f"stage {stage}, torsional mode {number}", value, ours, "Hz", rel=0.01)


def test_gears_and_supports_are_as_published(case: Case, published: Callable[..., None]) -> None:
    for pair in case.parts.pair_geometries:
        assert pair.driver.teeth == pair.driven.teeth == 36
        published(
            TEXT, f"contact ratio of {pair.driver.name} with {pair.driven.name}", 1.6, pair.contact_ratio, abs=0.05
        )
    stiffness = {
        stage: [bearing.stiffness[0, 0] for bearing in case.parts.bearings_on(f"stage-{stage}")] for stage in (2, 3)
    }
    assert all(two > three for two, three in zip(stiffness[2], stiffness[3], strict=True))


def test_parts_of_neighbouring_stages_pass_each_other(case: Case) -> None:
    """The shafts found could be built: where two of them lie side by side, they and their discs leave a gap."""
    for other in ("stage-2", "stage-3"):
        rotors = [case.rotor_named(name) for name in ("stage-1", other)]
        centres = np.linspace(-1.0, 1.0, 4001)
        radii = np.zeros((2, centres.size))
        for row, rotor in zip(radii, rotors, strict=True):
            left = rotor.start
            for segment in rotor.segments:
                here = (centres >= left) & (centres <= left + segment.length)
                row[here] = np.maximum(row[here], 0.5 * segment.diameter)
                left += segment.length
            for disc in rotor.discs:
                here = np.abs(centres - rotor.start - disc.at) <= 0.5 * disc.width
                row[here] = np.maximum(row[here], 0.5 * disc.diameter)
        apart = float(np.hypot(*np.subtract(rotors[0].axis, rotors[1].axis)))
        both = (radii > 0.0).all(axis=0)
        assert radii.sum(axis=0)[both].max() < apart - 0.01


def test_mesh_force_of_stages_1_2_is_led_by_900_and_355_hz(
    run: Run, published: Callable[..., None], remark: Callable[[str, str], None]
) -> None:
    spectrum = run.lines(run.force[MESHES[0]])
    first, second, third = spectral_peaks(spectrum, count=3, limit=LAST_HZ).rows
    published(TEXT, "mesh 1-2, highest line", 900.0, first.frequency, "Hz", abs=0.7)
    published(TEXT, "mesh 1-2, second line", 355.0, second.frequency, "Hz", abs=2.5)
    assert second.amplitude > 5.0 * third.amplitude
    # "A large average component at zero frequency is also present."
    assert spectrum.amplitude[0] > first.amplitude
    remark(
        TEXT,
        "355 Hz is a free vibration, which the load's sudden coming excites: it is no multiple of 25 Hz, and a settled "
        "run has none of it. It stays near Table I in the coupled system because gear 1 was put near its node.",
    )


def test_shaft_frequency_and_echoes_of_the_other_stages_in_the_mesh_force(
    run: Run, remark: Callable[[str, str], None]
) -> None:
    settled = amplitude_spectrum(run.settled(run.force[MESHES[0]]), run.interval)
    at_shaft = settled.amplitude[np.isclose(settled.frequencies, 25.0)].item()
    beside = settled.amplitude[(np.abs(settled.frequencies - 25.0) < 8.0) & ~np.isclose(settled.frequencies, 25.0)]
    assert at_shaft > 4.0 * beside.max()
    # Stage 3's torsional mode, 280 Hz by itself, is heard in the mesh 1-2 as well.
    spectrum = run.lines(run.force[MESHES[0]])
    echo = spectral_peaks(spectrum, count=1, above=200.0, limit=330.0).rows[0]
    assert 240.0 < echo.frequency < 290.0
    remark(
        TEXT,
        f"25 Hz is present in the mesh force 1-2, with {at_shaft:.1f} N, but not the considerable force that the text "
        "speaks of: imbalance alone moves the gears by some micrometres, and the shafts yield to that by turning. The "
        f"echo of stage 3's torsion (282 Hz in the text) stands at {echo.frequency:.0f} Hz: the teeth, which tie that "
        "stage to the others, lower its frequency. The same holds of stage 2's 550 Hz, too small to be told apart.",
    )


def test_force_is_larger_in_the_mesh_1_3(run: Run, remark: Callable[[str, str], None]) -> None:
    two, three = (run.force[mesh] for mesh in MESHES)
    assert np.mean(two) == pytest.approx(np.mean(three), rel=1e-3)  # the torque is split equally
    assert np.std(three) > np.std(two)
    assert np.std(run.settled(three)) > np.std(run.settled(two))
    assert three.max() > two.max()
    at_mesh = [line_at(run.lines(force), 900.0) for force in (two, three)]
    assert at_mesh[1] < at_mesh[0]
    remark(
        TEXT,
        f"The varying force is larger in the mesh 1-3, {np.std(three) / np.std(two):.1f} times in rms, by harmonics "
        "of the tooth mesh above 1024 Hz; the line at 900 Hz itself is not "
        f"({at_mesh[1]:.0f} N beside {at_mesh[0]:.0f} N): just above stage 3's second torsional mode, 820 Hz, its gear "
        "yields to the teeth. Which mesh has more depends on rotors that are ours, not the source's.",
    )


STEPS_LESS = (
    "two pairs in contact share the bodies of their gears, so that stiffness and transmission error step half as far, "
    "and their higher harmonics, which stage 3 answers, are lower"
)


@fails(STEPS_LESS)
def test_force_is_substantially_larger_in_the_mesh_1_3(run: Run) -> None:
    two, three = (run.force[mesh] for mesh in MESHES)
    assert np.std(three) > 1.5 * np.std(two)


def test_the_load_comes_on_at_once_where_the_case_says_so(case: Case, run: Run) -> None:
    """The force rises from nothing past its mean; by default a case starts from equilibrium instead."""
    for mesh in MESHES:
        assert run.force[mesh][0] == 0.0
        assert run.force[mesh][: PER_REVOLUTION // 10].max() > 1.5 * run.force[mesh].mean()
    resting = load_case("three-stage", ("transient.start=equilibrium",)).case
    assert starting_state(coupled(resting), plan_of(resting)) is None


def test_stage_1_has_the_most_elliptical_orbit(run: Run, remark: Callable[[str, str], None]) -> None:
    ratios = {stage: narrowness(orbit) for stage, orbit in run.orbit.items()}
    assert ratios[1] < 0.85 * min(ratios[2], ratios[3])
    assert min(ratios[2], ratios[3]) > 0.8
    remark(
        TEXT,
        "Settled orbits of stages 1, 2 and 3, smaller axis over larger: "
        f"{', '.join(f'{ratio:.2f}' for ratio in ratios.values())}.",
    )


@fails(STEPS_LESS)
def test_the_orbit_of_stage_1_is_plainly_elliptical(run: Run) -> None:
    assert narrowness(run.orbit[1]) < 0.6


def narrowness(orbit: FloatArray) -> float:
    """Smaller over larger principal axis of the last revolutions of an orbit of shape (s, 2)."""
    moving = orbit[-ORBIT * PER_REVOLUTION :]
    moving = moving - moving.mean(axis=0)
    minor, major = np.sqrt(np.linalg.eigvalsh(moving.T @ moving))
    return float(minor / major)


def test_modal_responses_of_stage_1_fall_with_the_number_of_the_mode(
    run: Run, published: Callable[..., None], remark: Callable[[str, str], None]
) -> None:
    fixed = np.abs(run.torsion.mean(axis=1))
    varying = run.settled(run.torsion).std(axis=1)
    assert np.all(fixed > 0.0)
    assert np.all(varying > 0.0)
    assert np.all(np.diff(fixed) < 0.0)
    # "The ratio of fixed to varying signal magnitudes decreases as the mode number increases", once settled.
    assert np.all(np.diff(fixed / varying) < 0.0)
    own = spectral_peaks(run.lines(run.torsion[1]), count=1).rows[0]
    published(TEXT, "stage 1's first elastic torsional mode, highest line", 355.0, own.frequency, "Hz", abs=2.5)
    second = spectral_peaks(run.lines(run.torsion[2]), count=1).rows[0]
    assert second.frequency == pytest.approx(900.0, abs=0.7)
    whole = ", ".join(f"{ratio:.1f}" for ratio in fixed / run.torsion.std(axis=1))
    remark(
        TEXT,
        "The first three modal contributions are taken for the rigid rotation and the two torsional modes of Table I. "
        "The ratio of fixed to varying parts falls with the number once the run has settled; over the whole record, "
        f"start included, it is {whole}. The mode of 1090 Hz answers at 900 Hz, not at its own frequency: its free "
        "vibration soon dies out in the bearings, to which the teeth tie it.",
    )


def test_first_lateral_modes_turn_with_the_shafts_and_stage_3_rings(
    run: Run, published: Callable[..., None], remark: Callable[[str, str], None]
) -> None:
    ringing = {}
    for stage, coordinates in run.lateral.items():
        spectrum = run.lines(coordinates)
        amplitude = np.sqrt((spectrum.amplitude**2).sum(axis=0))
        both = Spectrum(spectrum.frequencies, amplitude, amplitude, spectrum.window)
        highest = [peak.frequency for peak in spectral_peaks(both, count=2, limit=LAST_HZ).rows]
        assert any(abs(frequency - 25.0) < 0.7 for frequency in highest)
        ringing[stage] = line_at(both, LATERAL_HZ[3][0]) / line_at(both, 25.0, 0.7)
        if stage == 3:
            own = spectral_peaks(both, count=1, limit=LAST_HZ).rows[0].frequency
            published(TEXT, "stage 3's own first lateral mode in its response", 110.0, own, "Hz", abs=2.5)
    assert ringing[3] > 1.0
    assert max(ringing[1], ringing[2]) < 0.5
    remark(
        TEXT,
        "The text calls stage 3's first lateral mode 115 Hz, where Table I has 110 Hz (and 115 Hz for stage 1); the "
        "case has the table's. It rings here because stage 3 has the lightest bearing damping, which is nominal.",
    )
