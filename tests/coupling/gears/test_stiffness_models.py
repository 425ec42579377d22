"""The named stiffness models, and the piecewise cubics that carry them."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

from gearwhine.case.gears import ToothStiffness
from gearwhine.coupling.gears import (
    STIFFNESS_MODELS,
    Gear,
    GearError,
    GearPairGeometry,
    Iso6336Stiffness,
    PotentialEnergyStiffness,
    TableStiffness,
    stiffness_model,
)
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.errors import ContactAccuracyError, StiffnessModelError
from gearwhine.coupling.gears.piecewise_cubic import PiecewiseCubic
from gearwhine.coupling.gears.stiffness.compliant_teeth import CompliantTeeth, ToothCompliance
from gearwhine.coupling.gears.stiffness.iso6336 import iso6336_stiffness

ALPHA = math.radians(20.0)
GEAR = Gear("gear", 28, 3.175e-3, ALPHA, 6.35e-3, bore=25e-3)
PAIR = GearPairGeometry(GEAR, replace(GEAR, name="wheel", teeth=41))


def test_table_of_the_energy_method_is_the_energy_method() -> None:
    model = PotentialEnergyStiffness("trochoid")
    position = np.random.default_rng(7).uniform(0.0, PAIR.contact_ratio, 500)
    exact = 1.0 / model.pair_compliance(PAIR, position)
    np.testing.assert_allclose(model.pair_stiffness(PAIR)(position), exact, rtol=1e-8)


def test_a_tooth_model_is_one_subclass() -> None:
    class Springs(CompliantTeeth):
        name = "springs"

        def solve_tooth(self, gear: Gear) -> Callable[[np.ndarray], ToothCompliance]:
            def tooth(radius: np.ndarray) -> ToothCompliance:
                none = np.zeros_like(radius)
                return ToothCompliance(none, none, none, np.full_like(radius, 1e-9 / gear.teeth))

            return tooth

    model = Springs(contact="yang-sun")
    hertz = 4.0 * (1.0 - 0.09) / (math.pi * 207e9 * 6.35e-3)
    stiffness = model.pair_stiffness(PAIR)
    np.testing.assert_allclose(stiffness([0.0, 0.3, 1.1]), 1.0 / (hertz + 1e-9 / 28 + 1e-9 / 41), rtol=1e-12)
    assert model.shared_compliance(PAIR) == 0.0


def test_norm_curve_has_the_norms_maximum_and_mean() -> None:
    norm = iso6336_stiffness(PAIR)
    curve = Iso6336Stiffness().pair_stiffness(PAIR)
    middle = 0.5 * PAIR.contact_ratio
    assert float(curve(middle)) == pytest.approx(norm.single_pair * 6.35e-3, rel=1e-12)
    assert float(curve(middle, derivative=1)) == pytest.approx(0.0, abs=1e-3)
    assert curve.mean * PAIR.contact_ratio == pytest.approx(norm.mesh_mean * 6.35e-3, rel=1e-12)


def test_norm_under_light_load_and_other_materials() -> None:
    norm = iso6336_stiffness(PAIR)
    assert iso6336_stiffness(PAIR, specific_load=200e3) == norm
    light = iso6336_stiffness(PAIR, specific_load=100e3 / 16.0)
    assert light.single_pair == pytest.approx(0.5 * norm.single_pair, rel=1e-12)
    soft = GearPairGeometry(replace(GEAR, youngs_modulus=103.5e9), replace(PAIR.driven, youngs_modulus=103.5e9))
    assert iso6336_stiffness(soft).single_pair == pytest.approx(0.5 * norm.single_pair, rel=1e-12)
    assert iso6336_stiffness(soft).theoretical == norm.theoretical
    with pytest.raises(StiffnessModelError, match="specific_load"):
        iso6336_stiffness(PAIR, specific_load=0.0)


def test_norm_numbers_gears_by_size_not_by_role() -> None:
    shifted = GearPairGeometry(replace(GEAR, profile_shift=0.3), PAIR.driven)
    swapped = GearPairGeometry(shifted.driven, shifted.driver)
    assert iso6336_stiffness(swapped).theoretical == iso6336_stiffness(shifted).theoretical


def test_models_by_name() -> None:
    names = list(STIFFNESS_MODELS)
    assert set(names[:4]) == {"potential-energy", "elastic-ring", "cornell", "weber-banaschek"}
    assert names[4:] == ["iso6336", "square", "constant", "table"]
    assert set(get_args(ToothStiffness.model_fields["model"].annotation)) == set(names)
    assert stiffness_model("square", value=2e8).pair_stiffness(PAIR).mean == 2e8
    assert float(stiffness_model("square", value=2e8).pair_stiffness(PAIR).knots[-1]) == PAIR.contact_ratio
    assert float(stiffness_model("constant", value=2e8).pair_stiffness(PAIR).knots[-1]) == 1.0


@pytest.mark.parametrize(
    ("name", "parameters", "words"),
    [
        ("energy", {}, "unknown stiffness model 'energy'; expected one of potential-energy, elastic-ring"),
        ("square", {}, "'square': .*value"),
        ("square", {"value": -1.0}, "value must be above 0"),
        ("square", {"value": 1.0, "contact_ratio": 0.9}, "contact_ratio must be at least 1"),
        ("constant", {"value": math.nan}, "value must be above 0"),
        ("iso6336", {"value": 1.0}, "'iso6336'"),
        ("table", {"position": np.array([0.0, 1.0]), "stiffness": np.array([1.0])}, "two equally long columns"),
        ("table", {"position": np.array([0.1, 1.0]), "stiffness": np.ones(2)}, "start at 0 and increase"),
        ("table", {"position": np.array([0.0, 0.0, 1.0]), "stiffness": np.ones(3)}, "start at 0 and increase"),
        ("table", {"position": np.array([0.0, 1.0]), "stiffness": np.array([1.0, 0.0])}, "must be positive"),
    ],
)
def test_wrong_models_say_what_is_wrong(name: str, parameters: dict[str, object], words: str) -> None:
    with pytest.raises(StiffnessModelError, match=words):
        stiffness_model(name, **parameters)


def test_uniform_table_is_met_at_its_points() -> None:
    position = np.linspace(0.0, 1.0, 41)
    values = 2e8 + 5e7 * np.sin(2.0 * math.pi * position)
    np.testing.assert_allclose(TableStiffness(position, values).pair_stiffness(PAIR)(position), values, rtol=1e-13)


def test_uneven_table_of_a_pair_is_met_and_never_overshoots() -> None:
    position = np.concatenate([[0.0], np.sort(np.random.default_rng(3).uniform(0.05, 1.6, 12)), [1.64]])
    position *= PAIR.contact_ratio / 1.64 * (1.0 + 2e-4)  # a table rounded in print
    values = np.linspace(1e8, 2e8, position.size) ** 1.01
    curve = TableStiffness(position, values).pair_stiffness(PAIR)
    assert curve.knots[-1] == pytest.approx(PAIR.contact_ratio, rel=1e-14)
    np.testing.assert_allclose(curve(position / (1.0 + 2e-4)), values, rtol=1e-5)
    assert np.all(np.diff(curve(np.linspace(0.0, PAIR.contact_ratio, 999))) > 0.0)


def test_table_of_another_length_is_refused() -> None:
    with pytest.raises(StiffnessModelError, match=r"ends at 1.3 base pitches; expected 1 \(whole mesh\)"):
        TableStiffness(np.array([0.0, 1.3]), np.ones(2)).pair_stiffness(PAIR)


def test_cubics_between_knots() -> None:
    line = piecewise.polyline(np.array([0.0, 1.0, 3.0]), np.array([2.0, 0.0, 4.0]))
    np.testing.assert_allclose(line([0.5, 1.0, 2.0, 9.0]), [1.0, 0.0, 2.0, 4.0])
    np.testing.assert_allclose(line([0.5, 2.0], derivative=1), [-2.0, 2.0])
    assert line.mean == pytest.approx((1.0 + 4.0) / 3.0)
    parabola = piecewise.quadratic(1.0, 4.0, 1.0, 2.0)
    np.testing.assert_allclose(parabola([0.0, 0.5, 1.0, 2.0]), [1.0, 3.25, 4.0, 1.0])


def test_a_function_with_a_step_is_not_tabulated_in_silence() -> None:
    with pytest.raises(ContactAccuracyError, match="not smooth"):
        piecewise.tabulated(lambda x: np.where(x < 0.3, 1.0, 2.0), 1.0)


def test_malformed_cubics_are_refused() -> None:
    with pytest.raises(GearError, match=r"n \+ 1 knots"):
        PiecewiseCubic(np.array([0.0, 1.0]), np.zeros((2, 4)))
    with pytest.raises(GearError, match="increasing knots"):
        PiecewiseCubic(np.array([0.0, 0.0]), np.zeros((1, 4)))
