"""Studies of many machines of Python: the numbers of the same study of a case to the last bit; bad input refused."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.coupling.description.changed import changed, number_at
from gearwhine.numerics.distributions import Discrete, Distribution, Normal, Uniform
from gearwhine.optimisation.scatter import Scatter
from gearwhine.solutions import Failure

SHIFT, TORQUE = "gears[pinion].gear.profile_shift", "torque"
ERROR = "gear_pair.pinion-wheel.transmission_error_peak_to_peak_m"
LAWS: Mapping[str, Distribution] = {SHIFT: Normal(0.0, 0.05), TORQUE: Uniform(60.0, 80.0)}
VARIED = {
    "gear.pinion.profile_shift": {"normal": [0.0, 0.05]},
    "operation.torque": {"uniform": [60.0, 80.0]},
}


@pytest.fixture(scope="module")
def spur_pair() -> gw.CaseStudy:
    designed = {
        "gear.pinion.tip_relief.amount": {"values": [15e-6, 25e-6]},
        "gear.wheel.face_width": {"range": [6e-3, 7e-3], "levels": 2},
    }
    optimisation = {"method": "grid", "robust": {"samples": 2}, "verify": False, "design": designed}
    aims = {"aim": {ERROR: {"sense": "least"}}, "limit": {"machine.mass_kg": {"at_most": 4.0}}}
    scatter = {"variation": {"vary": VARIED | {"gear.pinion.profile_shift": {"normal": [0.0, 1e-3]}}}}
    robust = gw.load("spur-pair", scatter | {"optimisation": optimisation | aims})
    assert robust.case.variation is not None
    return robust


@pytest.fixture(scope="module")
def machine(spur_pair: gw.CaseStudy) -> gw.Study:
    return gw.Study(spur_pair.machine, spur_pair.settings)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("objects")


def test_varied_machines_are_those_of_the_varied_case_to_the_last_bit(
    spur_pair: gw.CaseStudy, machine: gw.Study, folder: Path, tmp_path: Path
) -> None:
    limits = {ERROR: (None, 4e-6)}
    limited = {"limit": {ERROR: {"at_most": 4e-6}}}
    case = spur_pair.changed({"optimisation": "", "variation": {"vary": VARIED} | limited})
    of_case = case.vary(8, folder=tmp_path, workers=1)
    found = machine.vary(LAWS, 8, limits=limits, folder=folder, workers=1)
    assert found.solved.nominal.numbers == of_case.solved.nominal.numbers
    assert np.array_equal(found.solved.values, of_case.solved.values)
    for one, other in zip(found.solved.outcomes, of_case.solved.outcomes, strict=True):
        if isinstance(one, Failure):  # teeth that jam: the case adds its key before the same words
            assert isinstance(other, Failure)
            assert not one.traceback
            assert other.message.endswith(one.message)
        else:
            assert not isinstance(other, Failure)
            assert one.numbers == other.numbers
    assert 0 < len(found.solved.failures) < 8
    assert found.document["yield"] == of_case.document["yield"]
    assert found.document.keys() == of_case.document.keys()
    # More machines go on where these ended, by processes of their own, and the failed ones are tried again.
    more = machine.vary(LAWS, 10, limits=limits, folder=folder, workers=2)
    assert more.document["resumed"] == 8 - len(found.solved.failures)
    assert [isinstance(one, Failure) for one in more.solved.outcomes[:8]] == [
        isinstance(one, Failure) for one in found.solved.outcomes
    ]
    assert (folder / "samples").is_dir()
    # Another machine is another study.
    another = machine.changed({"speed": 300.0}).vary(LAWS, 1, analyses=["mass"], folder=folder)
    assert another.document["resumed"] == 0


def test_designed_machines_are_those_of_the_designed_case_to_the_last_bit(
    spur_pair: gw.CaseStudy, machine: gw.Study, tmp_path: Path
) -> None:
    of_case = spur_pair.optimise(folder=tmp_path, workers=1).solved
    relief, width = "gears[pinion].gear.tip_relief.amount", "gears[wheel].gear.face_width"
    found = machine.optimise(
        {relief: Discrete([15e-6, 25e-6]), width: Uniform(6e-3, 7e-3)},
        {ERROR: "least"},
        limits={"machine.mass_kg": (None, 4.0)},
        scatter=Scatter({SHIFT: Normal(0.0, 1e-3), TORQUE: Uniform(60.0, 80.0)}, samples=2),
        method="grid",
        levels=2,
        analyses=["gears", "mass"],
        workers=1,
    ).solved
    assert len(found.designs) == 4
    for one, other in zip((found.start, *found.designs), (of_case.start, *of_case.designs), strict=True):
        assert np.array_equal(one.point, other.point)
        assert one.sides == other.sides
    assert found.chosen == of_case.chosen
    assert [float(written) for written in found.written] == [2.3e-5, 6.35e-3]
    # The transient of the start and of the proposed design, which the case left out.
    assert found.verification is not None
    assert not isinstance(found.verification.start, Failure)


@pytest.mark.slow
def test_faults_of_machines_are_seen_as_those_of_the_case_to_the_last_bit(tmp_path: Path) -> None:
    keys: dict[str, Any] = {"healthy": 10, "faulty": 1, "sensor_noise": 0.02, "false_alarm": 0.1, "baseline": "fleet"}
    sizes = [1e-3, 2e-3]
    case = gw.load(
        "small-gearbox",
        {
            "gear.pinion.fault": {"kind": "crack", "tooth": 3, "depth": "1 mm"},
            "transient": {"revolutions": 12, "discard": 6, "tolerance": 5e-3},
            "housing.frequency_limit": "2.8 kHz",
            "housing.box.mesh_size": "60 mm",
            "variation": {"vary": {"operation.torque": {"normal": [20.0, 0.5]}}},
            "detection": {"fault": "gear.pinion.fault.depth", "severities": sizes} | keys,
        },
    )
    of_case = case.detect(folder=tmp_path / "case", workers=1).solved
    machine, fault = gw.Study(case.machine, case.settings), "gears[pinion].gear.faults[0].depth"
    found = machine.detect(fault, sizes, {"torque": Normal(20.0, 0.5)}, folder=tmp_path / "m", workers=1, **keys)
    for one, other in zip(found.solved.parts, of_case.parts, strict=True):
        assert np.array_equal(one.healthy, other.healthy, equal_nan=True)
        assert np.array_equal(one.responses, other.responses, equal_nan=True)
    assert (found.solved.gear, found.solved.turns) == (of_case.gear, of_case.turns)
    refused: tuple[tuple[str, list[float], dict[str, Any], type[Exception], str], ...] = (
        ("gears[pinion].gear.faults[1].depth", sizes, {}, gw.CouplingError, "number of an entry of .*faults"),
        ("gears[pinion].gear.tip_relief", sizes, {}, gw.CouplingError, "expected a number"),
        (fault, sizes[::-1], {}, CaseError, r"severities\[1\]: expected sizes above 0"),
        (fault, [1e-3, 9e-3], {}, CaseError, r"severities\[1\].*it goes through the foot"),
        (fault, sizes, {"sensors": ["topp"]}, CaseError, "did you mean 'top'"),
        (fault, sizes, {"noise": 1.0}, CaseError, "no such key"),
        (fault, sizes, {"between": ["speed"]}, CaseError, r"between\[0\]"),
        (fault, sizes, {"sensor_noise": 0.0}, CaseError, "without scatter"),
    )
    for path, wrong, more, kind, said in refused:
        with pytest.raises(kind, match=said):
            machine.detect(path, wrong, **{"sensor_noise": 0.1} | more)
    with pytest.raises(gw.CouplingError, match="settings with a transient"):
        gw.Study(case.machine).detect(fault, sizes, sensor_noise=0.1)


@pytest.mark.parametrize(
    ("laws", "said"),
    [
        ({"gears[pinon].gear.bore": Normal(0.03, 1e-3)}, r"entry of gears \(pinion, wheel\); did you mean 'pinion'"),
        ({"gears[2].gear.bore": Normal(0.03, 1e-3)}, r"entry of gears \(pinion, wheel\)"),
        ({"gears[pinion].gear.bor": Normal(0.03, 1e-3)}, "an attribute of Gear .*did you mean 'bore'"),
        ({"torque.mean": Normal(0.03, 1e-3)}, "torque is a float, without attributes"),
        ({"gravity.x": Normal(0.03, 1e-3)}, "gravity is None; expected a path that ends there"),
        ({"gears[": Normal(0.03, 1e-3)}, "a path of attributes"),
        ({"torque": 70.0}, "expected a distribution"),
        ({"gears[pinion].gear.module": Normal(0.0, 1e-3)}, "gear 'pinion': module is 0"),
        ({}, "a distribution of one value or more"),
    ],
)
def test_a_path_that_leads_nowhere_and_a_median_that_cannot_be_are_refused(
    machine: gw.Study, laws: Mapping[str, Any], said: str
) -> None:
    with pytest.raises(gw.CouplingError, match=said):
        machine.vary(laws, 2)


def test_what_a_machine_has_not_is_refused(machine: gw.Study) -> None:
    shaft = replace(machine.machine, gears=(), gear_pairs=(), torque=0.0, bearings=())
    with pytest.raises(gw.CouplingError, match="no quantity of load"):
        gw.Study(shaft).vary({"speed": Normal(100.0, 1.0)}, 2, analyses=["load"])
    with pytest.raises(CaseError, match=r"quantities\[0\]"):
        machine.vary(LAWS, 2, analyses=["mass"], quantities=["gear.pinion.weight_n"])
    with pytest.raises(gw.CouplingError, match="samples is 0"):
        machine.vary(LAWS, 0)
    with pytest.raises(gw.CouplingError, match="'gravity' is None; expected a number"):
        machine.optimise({"gravity": Uniform(0.0, 1.0)}, {"machine.mass_kg": "least"})


def test_changes_are_made_at_once_and_where_they_are_said(machine: gw.Study) -> None:
    description = machine.machine
    bearing = description.bearings[0].bearing.name
    stiffer = changed(
        description,
        {
            f"bearings['{bearing}'].bearing.stiffness[0][0]": 2e8,
            f'bearings."{bearing}".bearing.damping[1][1]': 700.0,
            "shafts[0].unbalances[0].moment": 1e-5,
            "gear_pairs[pinion-wheel].backlash": 2e-4,
        },
    )
    assert stiffer.bearings[0].bearing.stiffness[0, 0] == 2e8
    assert stiffer.bearings[0].bearing.stiffness[1, 1] == description.bearings[0].bearing.stiffness[1, 1]
    assert stiffer.bearings[0].bearing.damping[1, 1] == 700.0
    assert stiffer.shafts[0].unbalances[0].moment == 1e-5
    assert number_at(stiffer, "gear_pairs.pinion-wheel.backlash") == 2e-4
    assert stiffer.bearings[1] is description.bearings[1]
    # One gear of another module meshes with none, both do; and shafts at another distance.
    both = {f"gears[{name}].gear.module": 3e-3 for name in ("pinion", "wheel")}
    axes = {f"shafts[{number}].axis[0]": side * 0.042 for number, side in ((0, -1.0), (1, 1.0))}
    assert machine.changed(both | axes).machine.gears[1].gear.module == 3e-3
    with pytest.raises(gw.GearError):
        machine.changed({"gears[pinion].gear.module": 3e-3})
    with pytest.raises(gw.CouplingError, match="each place once, and none inside another"):
        machine.changed({"gears[0].gear.bore": 0.02, "gears[pinion].gear.bore": 0.03})
    with pytest.raises(gw.CouplingError, match="each place once, and none inside another"):
        machine.changed({"gears[0].gear": None, "gears[0].gear.bore": 0.03})


def _shaft(bore: float) -> Callable[[Mapping[str, float]], gw.Machine]:
    def make(values: Mapping[str, float]) -> gw.Machine:
        rotor = gw.Rotor("shaft", [gw.Segment(0.5, values["diameter"], bore, gw.STEEL)])
        held = [gw.Bearing.isotropic(f"at {at}", at, 1e8) for at in (0.02, 0.48)]
        return gw.Machine([gw.Shaft(rotor)], [gw.MountedBearing(one, "shaft", None) for one in held], speed=100.0)

    return make


def test_machines_of_a_function_are_resumed_where_it_is_the_same(tmp_path: Path) -> None:
    law = {"diameter": Normal(0.03, 1e-4)}

    def resumed(make: Callable[[Mapping[str, float]], gw.Machine], samples: int = 4, **more: Any) -> int:
        found = gw.vary(make, law, samples, analyses=["mass"], folder=tmp_path, **more)
        masses = found.dataset["value"].sel(quantity="machine.mass_kg").values
        diameters, bore = found.dataset["input_value"].values[:, 0], 0.0 if make is solid else 0.01
        expected = 7850.0 * 0.5 * np.pi / 4.0 * (diameters**2 - bore**2)
        assert masses == pytest.approx(expected, rel=1e-9)
        return int(found.document["resumed"])

    solid, hollow = _shaft(0.0), _shaft(0.01)
    assert [resumed(solid), resumed(solid, 6), resumed(solid, fresh=True)] == [0, 4, 0]
    # Another value that the function holds on to, and another function, are other studies.
    assert [resumed(hollow), resumed(hollow)] == [0, 4]
