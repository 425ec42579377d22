"""Gearboxes varied through the clearance of their bearings: equal to the single calculation, whatever came before."""

import functools
import gc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.case.load import bundled_case, load_case
from gearwhine.coupling import Machine
from gearwhine.coupling.gears.loaded import gear_pair
from gearwhine.coupling.gears.loaded.face_load import FaceContact, MeanContactState
from gearwhine.coupling.gears.loaded.transmission_error import hunting_period_mesh, loaded_transmission_error
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.sampling import sobol_points
from gearwhine.variation.inputs import varied_inputs
from gearwhine.variation.quantities import Evaluation, Wanted, evaluate_pairs
from gearwhine.variation.samples import VariedCase

TE = "gear_pair.pinion-wheel.transmission_error_peak_to_peak_m"
BEARING = """
[[bearing]]
name = "{rotor}-{at}"
rotor = "{rotor}"
at = "{at} mm"
damping = {{ xx = "800 N*s/m", yy = "800 N*s/m" }}
stiffness.rolling = {{ element = "ball", count = 9, element_diameter = "12 mm", pitch_diameter = "62 mm", clearance = "15 um" }}
"""  # noqa: E501
VARIATION = """
[variation]
samples = 3
quantities = ["{wanted}"]
[variation.vary]
"gear.*.errors.helix.slope" = {{ class = 7, independent = true }}
"gear.*.errors.pitch" = {{ class = 6, independent = true }}
"gear.pinion.tip_relief.amount" = {{ uniform = ["20 um", "24 um"] }}
"bearing.*.stiffness.rolling.clearance" = {{ uniform = ["10 um", "25 um"], independent = true }}
"""


def forget() -> None:
    """Clear all that functions keep of earlier machines."""
    for kept in [one for one in gc.get_objects() if isinstance(one, functools._lru_cache_wrapper)]:
        if getattr(kept, "__module__", "").startswith("gearwhine"):
            kept.cache_clear()


def written(folder: Path, wanted: str = "gear_pair.*.transmission_error_peak_to_peak_m") -> Path:
    bundled = bundled_case("helical-pair")
    assert bundled is not None
    text = bundled.read_text().replace('misalignment = "0.005 deg"\n', "")
    begin, end = text.index("[[bearing]]"), text.index("[[gear]]")
    bearings = "".join(BEARING.format(rotor=rotor, at=at) for rotor in ("input", "output") for at in (20, 220))
    path = folder / "case.toml"
    path.write_text(text[:begin] + bearings + text[end:] + VARIATION.format(wanted=wanted))
    return path


@pytest.fixture(scope="module")
def gearboxes(tmp_path_factory: pytest.TempPathFactory) -> tuple[VariedCase, FloatArray]:
    """The study of varied gearboxes, and its points."""
    loaded = load_case(written(tmp_path_factory.mktemp("case")))
    assert loaded.case.variation is not None
    inputs = varied_inputs(loaded.source, loaded.case.variation)
    plain = {key: table for key, table in loaded.source.written.items() if key != "variation"}
    wanted = Wanted(("gears",), names=(TE,))
    return VariedCase(replace(loaded.source, written=plain), inputs, wanted), sobol_points(3, len(inputs), 1)


@pytest.fixture(scope="module")
def machines(gearboxes: tuple[VariedCase, FloatArray]) -> list[Machine]:
    varied, points = gearboxes
    return [varied.machine(varied.case(point)) for point in points]


def test_each_gearbox_equals_one_of_a_process_without_memory(
    gearboxes: tuple[VariedCase, FloatArray], machines: list[Machine]
) -> None:
    varied, points = gearboxes
    found = [varied.solve(point) for point in points]
    values = [one.numbers[TE] for one in found if isinstance(one, Evaluation)]
    assert len(values) == 3
    assert np.ptp(values) > 0.01 * np.mean(values)
    for value, machine in zip(values, machines, strict=True):
        forget()
        (pair,) = machine.linearised(machine.operating_point()).loaded_pairs()
        assert value == pytest.approx(pair.static.peak_to_peak_transmission_error, rel=1e-9)


def test_a_machine_about_its_operating_point_is_one_made_of_these_parts(machines: list[Machine]) -> None:
    """Its copy leaves the checks out and keeps what its stiffness has no part in."""
    about = machines[0].linearised(machines[0].operating_point())
    made = replace(about)
    assert all(mounted.bearing.spatial_stiffness[0, 0] > 1e6 for mounted in about.bearings)
    assert about.pair_torques == made.pair_torques
    assert about.warnings == made.warnings
    (kept,), (again,) = about.loaded_pairs(), made.loaded_pairs()
    np.testing.assert_array_equal(kept.static.transmission_error, again.static.transmission_error)


def test_only_quantities_that_are_asked_for_are_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    solved: list[float] = []
    monkeypatch.setattr(gear_pair, "hunting_period_mesh", lambda contact, force: solved.append(force))
    found = gw.load(written(tmp_path)).vary(2, folder=tmp_path / "out", workers=1)
    assert not solved
    assert found.dataset["quantity"].values.tolist() == [TE]
    assert np.all(found.dataset["value"].values > 0.0)
    with pytest.raises(CaseError, match=r"variation\.quantities"):
        gw.load(written(tmp_path, "gear_pair.*.whine_m")).vary(2, folder=tmp_path / "out", workers=1)


def test_the_first_mesh_period_is_that_of_the_hunting_period(machines: list[Machine]) -> None:
    machine = machines[0]
    (pair,) = machine.linearised(machine.operating_point()).loaded_pairs()
    contact, force = pair.carrying_flanks, pair.static.force
    assert contact.hunting_period == 23 * 41
    whole = hunting_period_mesh(contact, force, points=4)
    for first in (0, 500):
        period = slice(4 * first, 4 * first + 4)
        alone = loaded_transmission_error(contact, force, whole.phases[period])
        np.testing.assert_allclose(whole.transmission_error[period], alone.transmission_error, rtol=1e-9)
    assert pair.hunting is not None
    spread = pair.hunting.peak_to_peak_transmission_error
    assert spread > pair.static.peak_to_peak_transmission_error
    found = evaluate_pairs([pair], Wanted((), names=("*_over_hunting_period_m",)))
    assert found.numbers == {TE.replace("peak_to_peak", "over_hunting_period"): spread}


def test_the_search_evaluates_a_mesh_few_times(machines: list[Machine], monkeypatch: pytest.MonkeyPatch) -> None:
    """Bearings far from their first guess settle without it, and no step only shows that there is nothing to gain."""
    evaluated: list[int] = []
    at = FaceContact.at

    def counted(contact: FaceContact, approach: FloatArray) -> MeanContactState:
        evaluated.append(contact._phases)
        return at(contact, approach)

    monkeypatch.setattr(FaceContact, "at", counted)
    for machine in machines:
        evaluated.clear()
        assert machine.operating_point().residual < 1e-11
        assert evaluated.count(12) <= 5
        assert evaluated.count(48) <= 5
