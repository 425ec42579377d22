"""Signature of a motion: sidebands of forces on back flanks, and lines of records of several stretches."""

from collections.abc import Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from coupled_cases import about_operating_point

from gearwhine.case import load_case
from gearwhine.coupling import coupled_modes
from gearwhine.coupling.analyses import recording
from gearwhine.coupling.analyses.signature import solve_signature
from gearwhine.coupling.analyses.transient import solve_transient
from gearwhine.results.run import transient_document
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.solve.machine import plan_of

TURNING = 5500.0 / 60.0  # of all shafts [Hz]
SHAFT = """
[[rotor]]
name = "third"
axis = ["{axis} mm", "0 mm"]
start = "-100 mm"
material = "steel"
segments = [{{ length = "200 mm", diameter = "30 mm" }}]
"""
BEARING = """
[[bearing]]
name = "third {at}"
rotor = "third"
at = "{at} mm"
stiffness = {{ xx = "1.2e8 N/m", yy = "1.2e8 N/m" }}
damping = {{ xx = "500 N*s/m", yy = "500 N*s/m" }}
"""
GEAR = """
[[gear]]
name = "{name}"
rotor = "{rotor}"
at = "60 mm"
teeth = {teeth}
module = "3.175 mm"
face_width = "6.35 mm"
pressure_angle = "20 deg"
bore = "30 mm"
errors = {{ runout = "{runout} um" }}
"""
STAGE = """
[[gear_pair]]
driver = "second pinion"
driven = "second wheel"
stiffness = { model = "potential-energy" }
damping_ratio = 0.05
backlash = "0.1 mm"
"""
BRAKED = [
    "gear.pinion.errors={ runout = '20 um' }",
    "operation.torque=-20 N*m",
    "rotor.*.modes=2",
    "transient.revolutions=2",
    "transient.discard=0",
    "transient.tolerance=2e-3",
]


def two_stages(folder: Path, teeth: int = 24, runout: float = 20.0) -> str:
    """The spur pair with a second stage behind it, of other tooth numbers; all shafts turn at one speed."""
    spur_pair = files("gearwhine.cases").joinpath("spur-pair.toml").read_text(encoding="utf-8")
    gears = "".join(
        GEAR.format(name=name, rotor=rotor, teeth=teeth, runout=runout)
        for name, rotor in (("second pinion", "output"), ("second wheel", "third"))
    )
    bearings = BEARING.format(at=20) + BEARING.format(at=180)
    path = folder / "two-stages.toml"
    third = SHAFT.format(axis=44.45 + 3.175 * teeth)
    path.write_text(spur_pair + third + bearings + gears + STAGE, encoding="utf-8")
    return str(path)


def test_sidebands_are_of_the_pressed_flanks_of_their_own_pair(tmp_path: Path) -> None:
    """The machine brakes, so that back flanks press; every pinion's runout modulates its mesh once a turn.

    Its lines are found again in a Fourier sum over the history of each force.
    """
    case = load_case(two_stages(tmp_path), BRAKED).case
    machine = about_operating_point(case).coupled
    solved = solve_transient(machine, plan_of(case))
    signature = solve_signature(solved, coupled_modes(machine.system), None)
    pairs = transient_document(solved, signature)["gear_pairs"]
    assert [pair["flanks"] for pair in pairs] == ["back", "back"]
    times = solved.histories.times
    pressed = "pinion -> wheel, back", "second pinion -> second wheel, back"
    for pair, teeth, flanks in zip(pairs, (28, 24), pressed, strict=True):
        own = f"{pair['driver']} -> {pair['driven']}"
        force = solved.histories.mesh_force[flanks]
        assert pair["mean_force_n"] == pytest.approx(force.mean(), rel=1e-3)
        assert {band["gear_pair"] for band in pair["sidebands"]} == {own}
        first = next(band for band in pair["sidebands"] if band["number"] == 1)
        assert first["carrier_hz"] == pytest.approx(teeth * TURNING)
        for key, frequency in (("carrier", teeth), ("lower", teeth - 1), ("upper", teeth + 1)):
            wave = np.exp(-2j * np.pi * frequency * TURNING * times)
            assert first[f"{key}_amplitude_n"] == pytest.approx(2.0 * abs((force * wave).mean()), rel=1e-6)


@pytest.mark.parametrize("runout", [20.0, 0.0])
def test_a_harmonic_of_another_mesh_is_no_sideband(tmp_path: Path, runout: float) -> None:
    """28 and 27 teeth on shafts of one speed: n × 27 and n × 28 are n turns apart, as sidebands of each other.

    So of the pairs 1, 2 and 3 about the n-th harmonic of either mesh the n-th is none. Where all gears run true, only
    the unbalance of the input shaft modulates a mesh, the first; the second has the lines of the other mesh beside it.
    """
    changes = [f"gear.pinion.errors={{ runout = '{runout} um' }}", "rotor.*.modes=2"]
    brief = ["transient.revolutions=2", "transient.discard=0", "transient.tolerance=2e-3"]
    case = load_case(two_stages(tmp_path, 27, runout), [*changes, *brief]).case
    machine = about_operating_point(case).coupled
    solved, modes = solve_transient(machine, plan_of(case)), coupled_modes(machine.system)
    # Beyond its limit a record has no lines to be trusted: that of 2 × 28 is the last.
    for harmonics, record in ((3, solved), (2, replace(solved, trusted_limit=2 * 28 * TURNING))):
        signature = solve_signature(record, modes, None)
        for teeth, of_shafts in zip((28, 27), signature.force_sidebands.values(), strict=True):
            found = {(round(pair.carrier / TURNING), pair.number) for one in of_shafts for pair in one.pairs}
            expected = {(n * teeth, number) for n in range(1, harmonics + 1) for number in (1, 2, 3) if number != n}
            assert found == (expected if runout or teeth == 28 else set())


@pytest.mark.slow
def test_lines_of_a_long_record_and_their_parts_are_of_all_its_stretches(monkeypatch: pytest.MonkeyPatch) -> None:
    """A free vibration that dies away in the first of seven stretches, so that the last one knows nothing of it.

    Over the stretches a part x of the line a has the share Σ Re x a* / Σ |a|²: its part of the line's power.
    """
    monkeypatch.setattr(recording, "_LONGEST_STRETCH", 700)
    settings = ["housing.box.mesh_size=40 mm", "transient.revolutions=17", "transient.discard=1"]
    case = load_case("small-gearbox", [*settings, "transient.tolerance=1e-3"]).case
    housing = solve_housing(case)
    machine = about_operating_point(case, housing).coupled
    assert housing is not None
    solved = solve_transient(machine, plan_of(case), record_bytes=1 << 16)
    assert solved.averages > 5
    signature = solve_signature(solved, coupled_modes(machine.system), housing.modes.frequencies_hz)
    stretches = list(solved.record.stretches())
    assert machine.housing is not None
    faded = 0
    for sensor in transient_document(solved, signature)["sensors"]:
        row = machine.housing.sensors[sensor["name"]]
        lines = fourier([stretch.histories.sensor_acceleration[sensor["name"]] for stretch in stretches])
        modes = fourier([stretch.modal.housing_acceleration.T for stretch in stretches])
        spacing = 1.0 / (len(stretches[0].times) * solved.record.sampling.interval)
        for peak, traced in zip(sensor["peaks"], signature.lines[sensor["name"]], strict=True):
            a, x = (spectra[..., round(peak["frequency_hz"] / spacing)] for spectra in (lines, modes))
            power = (np.abs(a) ** 2).mean()
            assert peak["amplitude_m_per_s2"] == pytest.approx(np.sqrt(power))
            assert peak["level_db"] == pytest.approx(10.0 * np.log10(0.5 * power / 1e-12))
            shares = {part.mode: part.share for part in traced.modes}
            for mode in range(x.shape[1]):
                share = row[mode] * (x[:, mode] * a.conj()).real.mean() / power
                assert shares[mode + 1] == pytest.approx(share, rel=1e-6, abs=1e-9)
            for parts in (traced.modes, (*traced.bearings, traced.free)):
                assert abs(sum(part.value for part in parts) - traced.value) < 1e-9 * abs(traced.value)
                assert sum(part.share for part in parts) == pytest.approx(1.0)
            faded += bool(abs(a[-1]) < 1e-2 * np.sqrt(power))
    assert faded > 0


def fourier(signals: Sequence[np.ndarray]) -> np.ndarray:
    """Lines of stretches of whole periods, shape (stretches, ..., lines)."""
    return 2.0 * np.fft.rfft(np.array(signals), axis=-1) / signals[0].shape[-1]
