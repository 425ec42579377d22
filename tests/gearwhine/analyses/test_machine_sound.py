"""Sound of a machine of Python: that of the same machine in a case, and refused in the same words."""

import json
from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.case.acoustics import Acoustics as AcousticsTable
from gearwhine.coupling.errors import AcousticsError
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.coupling.sound import Acoustics, Microphone

COARSE: dict[str, Any] = {
    "housing.box.mesh_size": "45 mm",
    "operation.speed": "2500 rpm",
    "transient": "",
}
EAR = (1.0, 0.3, 0.2)
ELEMENTS: dict[str, Any] = {
    "mesh_size": 0.04,
    "highest_frequency": 1300.0,
    "floor": -0.02,
    "microphone_box": 1.0,
    "microphone": (Microphone("ear", EAR),),
    "caps": "rest",
    "lines": 4,
}


def in_case(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Changes of a case for these settings, in SI."""
    written = {
        f"acoustics.{key}": list(value) if isinstance(value, tuple) else value for key, value in settings.items()
    }
    if "microphone" in settings:
        written["acoustics.microphone"] = [
            {"name": one.name, "position": list(one.position)} for one in settings["microphone"]
        ]
    return written


def words_of_case(changes: dict[str, Any]) -> list[str]:
    """Expectations of a case that is refused."""
    with pytest.raises(CaseError) as caught:
        gw.load("small-gearbox", changes).sound()
    return [problem.expected for problem in caught.value.problems]


@pytest.fixture(scope="module")
def study() -> gw.CaseStudy:
    return gw.load("small-gearbox", COARSE)


@pytest.fixture(scope="module")
def machine(study: gw.CaseStudy) -> gw.Study:
    return gw.Study(study.machine, gw.Settings(study.case.title))


def test_the_words_and_defaults_are_those_of_a_case() -> None:
    assert AcousticsTable().build() == Acoustics()
    keys = {one.name for one in fields(Acoustics)} | {"in_run"}
    assert keys == set(AcousticsTable.model_fields)


@pytest.mark.parametrize(
    "settings",
    [
        {"method": "rayleigh"},
        {"method": "rayleigh", "faces": ("top",), "floor": 0.0, "caps": "rest", "mesh_size": 0.02},
        {"method": "rayleigh", "faces": ("top", "front"), "microphone": (Microphone("ear", EAR),)},
        {"faces": ("top",)},
        {"microphone_box": 1.0},
        {"method": "erp", "floor": 0.0, "microphone_box": 1.0},
        {"microphone": (Microphone("box 3", EAR),)},
    ],
)
def test_choices_that_do_not_fit_are_refused_in_the_words_of_a_case(settings: dict[str, Any]) -> None:
    with pytest.raises(AcousticsError) as caught:
        Acoustics(**settings)
    assert [finding.expected for finding in caught.value.findings] == words_of_case(in_case(settings))


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"method": "fem"}, "method is 'fem'; expected one of boundary-elements, rayleigh, erp"),
        ({"mesh_size": np.nan}, "mesh_size is nan; expected a finite number above 0"),
        ({"density": 0.0}, "density is 0; expected a finite number above 0"),
        ({"lines": 0}, "lines is 0; expected a whole number"),
        ({"faces": "top", "method": "rayleigh"}, "faces is 'top'; expected a list of names"),
        ({"microphone": [EAR]}, r"microphone\[0\] .* expected a Microphone"),
        ({"microphone": [Microphone("ear", EAR)] * 2}, "'ear': name is 'ear'; expected each name once"),
    ],
)
def test_settings_that_cannot_be_are_refused(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(AcousticsError, match=message):
        Acoustics(**settings)
    with pytest.raises(AcousticsError, match=r"position .* expected 3 numbers"):
        Microphone("ear", (1.0, 2.0))  # type: ignore[arg-type]


def test_a_machine_without_a_field_of_its_housing_says_what_sound_needs() -> None:
    """Motions at seats and sensors make a machine; the sound is that of the walls between them."""
    on_ground = gw.load("spur-pair").machine
    with pytest.raises(AcousticsError, match=r"mesh and the mode shapes .* the machine has no housing"):
        gw.Study(on_ground).sound()
    one = np.eye(1)
    reduced = HousingComponent("housing", ("housing",), 1e6 * one, one, 0.0 * one, seats={}, seat_z={}, sensors={})
    with pytest.raises(AcousticsError, match=r"gearwhine\.Housing\.modes\(\) gives; the machine has a reduced housing"):
        gw.Study(replace(on_ground, housing=reduced)).sound()


@pytest.mark.slow
def test_the_sound_of_a_machine_is_that_of_its_case(study: gw.CaseStudy, machine: gw.Study, tmp_path: Path) -> None:
    found, expected = machine.sound(**ELEMENTS), study.changed(in_case(ELEMENTS)).sound()
    assert found.document["lines"]
    for key in found.document.keys() - {"warnings"}:
        assert json.dumps(found.document[key], default=str) == json.dumps(expected.document[key], default=str), key
    assert set(found.warnings) <= set(expected.warnings)
    assert found.proofs.items() <= expected.proofs.items()
    for name, array in found.dataset.data_vars.items():
        np.testing.assert_array_equal(array, expected.dataset[name])
        assert array.attrs == expected.dataset[name].attrs
    assert [name for name, _ in found.figures()] == [name for name, _ in expected.figures()]
    assert {"results.nc", "summary.json"} <= set(found.write(tmp_path, pictures=False))


@pytest.mark.slow
@pytest.mark.parametrize(
    "settings",
    [
        {"still": ("sole",)},
        {"floor": 0.05},
        {
            "floor": -0.02,
            "microphone": (Microphone("in", (0.0, 0.08, 0.0)), Microphone("low", (1.0, -0.05, 0.0))),
        },
        {"floor": -0.02, "microphone_box": 1e-4},
        {"mesh_size": 0.2},
        {"method": "rayleigh", "faces": ("input-back",)},
        {"method": "rayleigh", "faces": ("lid",)},
    ],
)
def test_acoustics_that_do_not_fit_the_housing_are_refused_in_the_words_of_a_case(
    machine: gw.Study, settings: dict[str, Any]
) -> None:
    settings = {"highest_frequency": 2000.0} | settings
    if settings.get("method") != "rayleigh":
        settings = {"mesh_size": 0.03} | settings
    with pytest.raises(AcousticsError) as caught:
        machine.sound(**settings)
    assert [finding.expected for finding in caught.value.findings] == words_of_case(COARSE | in_case(settings))
