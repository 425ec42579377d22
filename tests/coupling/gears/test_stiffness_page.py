"""The page of stiffness models says what the models say."""

import importlib.util
import math
import sys
from pathlib import Path

import numpy as np
import pytest

from gearwhine.coupling.gears import STIFFNESS_MODELS, Gear

ROOT = Path(__file__).parents[3]
NUMBERLESS = {"square", "constant", "table"}


@pytest.fixture(scope="module")
def script():  # type: ignore[no-untyped-def]
    specification = importlib.util.spec_from_file_location("page", ROOT / "scripts" / "gear_stiffness_page.py")
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    sys.modules["page"] = module
    specification.loader.exec_module(module)
    return module


def test_tables_are_fresh(script) -> None:  # type: ignore[no-untyped-def]
    text = script.PAGE.read_text(encoding="utf-8")
    assert script.page(text) == text, "run: python scripts/gear_stiffness_page.py"


def test_every_model_is_on_the_page(script) -> None:  # type: ignore[no-untyped-def]
    text = script.PAGE.read_text(encoding="utf-8")
    assert set(STIFFNESS_MODELS) == {name for name in STIFFNESS_MODELS if f"`{name}`" in text}
    assert set(STIFFNESS_MODELS) - NUMBERLESS <= set(script.models())


def test_the_twist_that_a_half_plane_leaves_out(script) -> None:  # type: ignore[no-untyped-def]
    gear: Gear = script.RIG
    shear = gear.youngs_modulus / (2.0 * (1.0 + gear.poisson_ratio))
    turn = (4.0 / gear.bore**2 - 1.0 / gear.root_circle_radius**2) / (4.0 * math.pi * shear * gear.face_width)
    assert f"{1e12 * gear.base_radius**2 * turn:.0f} pm/N" in script.PAGE.read_text(encoding="utf-8")
    np.testing.assert_allclose(script.TORQUE, 71.77)
