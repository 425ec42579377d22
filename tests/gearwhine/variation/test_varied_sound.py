"""Sound power of varied gearboxes and designs, against the sound of each line solved by itself."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from sounding_gearbox import TOP

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.case.load import load_case
from gearwhine.coupling import CouplingError
from gearwhine.coupling.analyses.loaded_machine import load_machine
from gearwhine.coupling.linear.lines_over_speed import housing_rates
from gearwhine.coupling.sound.solution import build_radiation
from gearwhine.numerics.distributions import Discrete
from gearwhine.solve.housing_modes import solve_housing, with_modes_of
from gearwhine.solve.machine import reduce_housing
from gearwhine.variation.quantities import Wanted
from gearwhine.variation.samples import VariedCase
from gearwhine.variation.statistics import VariedResult

RPM = 30.0 / np.pi
SPEEDS = (2500.0, 4000.0)
ESTIMATE = {"acoustics.method": "erp", "acoustics.mesh_size": "24 mm", "acoustics.highest_frequency": "3 kHz"}
STUDY: dict[str, Any] = {
    "variation.vary": {"operation.torque": {"uniform": ["50 N*m", "90 N*m"]}},
    "variation.analyses": ["sound"],
    "variation.speed": [f"{speed} rpm" for speed in SPEEDS],
}


@cache
def _coarse() -> gw.CaseStudy:
    """The small gearbox in a coarse housing, whose modes take less than a second."""
    return gw.load("small-gearbox", {"housing.box.mesh_size": "60 mm"})


def _weighting(hertz: float) -> float:
    """Frequency weighting A of IEC 61672-1 [dB]."""
    f = hertz**2
    passed = 12194.0**2 * f**2 / ((f + 20.6**2) * np.sqrt((f + 107.7**2) * (f + 737.9**2)) * (f + 12194.0**2))
    return float(20.0 * np.log10(passed) + 2.0)


def _own(study: gw.CaseStudy, changes: dict[str, Any]) -> tuple[list[float], list[float]]:
    """Sound power levels at the speeds, and A-weighted, of a machine made at each and the sound of each line."""
    machine, housing, acoustics = study.machine, study.housing, study.settings.acoustics
    assert housing is not None
    assert acoustics is not None
    radiation = build_radiation(acoustics, housing.displacement_field)
    plain, weighted = [], []
    for speed in SPEEDS:
        there = study.changed(changes | {"operation.speed": f"{speed} rpm"}).machine
        coupled = load_machine(there, there.operating_point()).coupled
        frequencies, rates = housing_rates(coupled, 2.0 * np.pi * 3000.0)
        powers = [
            (hertz, radiation.solve(hertz, rate[:, None]).power / 1e-12)
            for hertz, rate in zip((frequencies / (2.0 * np.pi)).tolist(), rates, strict=True)
        ]
        plain.append(10.0 * np.log10(sum(power for _, power in powers)))
        weighted.append(10.0 * np.log10(sum(power * 10.0 ** (0.1 * _weighting(hertz)) for hertz, power in powers)))
    assert machine is not None
    return plain, weighted


@cache
def _varied() -> VariedResult:
    """The study of one gearbox whose sound is that of the quick estimate."""
    with TemporaryDirectory() as folder:
        return _coarse().changed(ESTIMATE | STUDY).vary(1, folder=folder, workers=1).solved


@pytest.mark.parametrize("acoustics", [ESTIMATE, pytest.param(TOP, marks=pytest.mark.slow)])
def test_each_gearbox_has_the_power_of_its_lines(tmp_path: Path, acoustics: dict[str, Any]) -> None:
    study = _coarse().changed(acoustics)
    found = _varied()
    if acoustics is not ESTIMATE:
        found = study.changed(STUDY).vary(1, folder=tmp_path / "out", workers=1).solved
    torque = float(found.values[0, 0])
    plain, weighted = _own(study, {"operation.torque": f"{torque!r} N*m"})
    values = {one.name: float(one.values[0]) for one in found.quantities}
    # A table over frequency is good to a tenth of a decibel.
    assert found.outcomes[0].curves["housing.sound_power_db"] == pytest.approx(plain, abs=0.1)
    assert found.outcomes[0].curves["housing.sound_power_db_a"] == pytest.approx(weighted, abs=0.15)
    assert values["housing.sound_power_db"] == pytest.approx(max(plain), abs=0.1)
    assert values["housing.sound_power_db_a_speed_rpm"] == pytest.approx(SPEEDS[int(np.argmax(weighted))])


def test_the_quieter_of_two_torques_is_the_best_design(tmp_path: Path) -> None:
    design = {
        "optimisation.design": {"operation.torque": {"values": ["50 N*m", "90 N*m"]}},
        "optimisation.aim": {"housing.sound_power_db_a": {"sense": "least"}},
        "optimisation.speed": STUDY["variation.speed"],
        "optimisation.verify": False,
    }
    study = _coarse().changed(ESTIMATE)
    found = study.changed(design).optimise(folder=tmp_path / "out", workers=1)
    loudest = {torque: max(_own(study, {"operation.torque": torque})[1]) for torque in ("50 N*m", "90 N*m")}
    (key,) = found.document["keys"]
    assert key["designs"] == [min(loudest, key=lambda torque: loudest[torque])]
    assert found.document["aims"][0]["designs"][0] == pytest.approx(min(loudest.values()), abs=0.1)


def test_a_case_without_a_housing_of_its_own_has_no_sound(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"housing: expected .*analyses = \['sound'\]"):
        gw.load("spur-pair", STUDY).vary(1, folder=tmp_path / "out", workers=1)


def test_a_gearbox_with_other_walls_has_a_radiation_of_its_own(tmp_path: Path) -> None:
    walls = {"variation.vary": {"housing.box.wall": {"uniform": ["8 mm", "12 mm"]}}}
    found = _coarse().changed(ESTIMATE).changed(STUDY | walls).vary(1, folder=tmp_path / "out", workers=1)
    wall = float(found.solved.values[0, 0])
    study = _coarse().changed(ESTIMATE | {"housing.box.wall": f"{wall!r} mm"})
    plain, _ = _own(study, {})
    assert found.solved.outcomes[0].curves["housing.sound_power_db"] == pytest.approx(plain, abs=0.1)


def test_sound_of_thinner_air_is_as_much_lower(tmp_path: Path) -> None:
    """The equivalent radiated power is the density of the air times what the walls do."""
    air = {"variation.vary": {"acoustics.density": {"uniform": [0.6, 0.9]}}}
    found = _coarse().changed(ESTIMATE).changed(STUDY | air).vary(1, folder=tmp_path / "out", workers=1).solved
    lower = (
        np.array(found.outcomes[0].curves["housing.sound_power_db"]) - found.nominal.curves["housing.sound_power_db"]
    )
    assert lower == pytest.approx(10.0 * np.log10(found.values[0, 0] / 1.204))


def test_machines_of_python_sound_as_those_of_a_case() -> None:
    study, found = _coarse().changed(ESTIMATE), _varied()
    machine, acoustics = study.machine, study.settings.acoustics
    speeds = [speed / RPM for speed in SPEEDS]
    law = {"torque": Discrete([float(found.values[0, 0])])}

    def loaded(values: Any) -> gw.Machine:
        return replace(machine, torque=values["torque"])

    settings: dict[str, Any] = {"speeds": speeds, "acoustics": acoustics}
    own = gw.vary(loaded, law, 1, analyses=["sound"], **settings).solved.outcomes[0]
    assert own.curves["housing.sound_power_db"] == pytest.approx(found.outcomes[0].curves["housing.sound_power_db"])
    best = gw.optimise(loaded, law, {"housing.sound_power_db": "least"}, **settings).solved.best
    assert best.aims == pytest.approx([own.numbers["housing.sound_power_db"]])
    bare = replace(machine, housing=machine.housing_component)
    with pytest.raises(CouplingError, match="modes on a mesh"):
        gw.vary(lambda values: replace(bare, **values), law, 1, analyses=["sound"], **settings)


def test_samples_of_other_damping_or_sensors_take_the_modes_that_are_solved() -> None:
    study, source = _coarse(), load_case("small-gearbox", ["housing.box.mesh_size='60 mm'"]).source
    assert study.housing is not None
    varied = VariedCase(source, (), Wanted(("lines",)), solved=study.housing)
    for change, of_modes in (
        ("housing.damping_ratio=0.02", True),
        ("housing.sensor.top.position=['20 mm', '160 mm', '-30 mm']", True),
        ("housing.box.wall='11 mm'", False),
    ):
        case = source.changed_case([change])
        known = with_modes_of(case, study.housing)
        assert (known is not None) == of_modes
        if known is not None:
            assert known.record.modes is study.housing.record.modes
        found, own = varied.machine(case).housing_component, reduce_housing(case, solve_housing(case))
        assert found is not None
        np.testing.assert_allclose(found.damping, own.damping, rtol=1e-12)
        np.testing.assert_allclose(found.sensors["top"], own.sensors["top"], rtol=1e-9, atol=1e-12)
