"""A braked gear pair, whose driven gear drives it by the back flanks: its mesh is that of these flanks."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling.gears import Gear, GearPairGeometry, TipRelief
from gearwhine.coupling.gears.loaded.gear_pair import GearPair, load_gear_pair
from gearwhine.coupling.gears.loaded.transmission_error import hunting_period_mesh, loaded_transmission_error

ALPHA = math.radians(20.0)
HELIX = math.radians(15.0)


def helical(name: str, teeth: int, hand: float, relief: TipRelief | None = None) -> Gear:
    return Gear(name, teeth, 2e-3, ALPHA, 0.02, helix_angle=hand * HELIX, tip_relief=relief, tooth_thinning=5e-5)


def test_a_braked_pair_has_the_mesh_of_the_exchanged_pair_that_drives() -> None:
    """The flanks that touch and the gap between them are the same, whichever gear is called the driver."""
    pinion, wheel = helical("p", 23, 1.0, TipRelief(12e-6, length=1.5e-3)), helical("w", 51, -1.0)
    torque, ratio = 80.0, 51.0 / 23.0
    braked = load_gear_pair(
        GearPair("p", "w", misalignment=3e-4),
        GearPairGeometry(pinion, wheel),
        torque=-torque,
        inertias=(1e-3, 1e-2),
        speed=100.0,
    )
    driving = load_gear_pair(
        GearPair("w", "p", misalignment=3e-4),
        GearPairGeometry(wheel, pinion),
        torque=torque * ratio,
        inertias=(1e-2, 1e-3),
        speed=-100.0 / ratio,
    )
    # A place of the path is as far from its beginning as it is from the end of the exchanged pair's.
    phases = driving.geometry.contact_ratio - braked.static.phases
    mesh = loaded_transmission_error(driving.contact, driving.static.force, phases)
    np.testing.assert_allclose(braked.static.transmission_error, mesh.transmission_error, rtol=1e-9)
    np.testing.assert_allclose(braked.static.tangent_stiffness, mesh.tangent_stiffness, rtol=1e-9)
    assert braked.static.line_loads is not None
    assert mesh.line_loads is not None
    assert float(braked.static.line_loads.max()) == pytest.approx(float(mesh.line_loads.max()), rel=1e-9)


def test_a_tooth_that_stands_ahead_lags_by_its_back_flank() -> None:
    """Alone in mesh it yields as any tooth, and its back flank stands behind by the deviation along the path."""
    deviation = 10e-6

    def braked(deviations: Sequence[float]) -> tuple[float, float]:
        pinion = Gear("p", 23, 2e-3, ALPHA, 0.02, tooth_thinning=5e-5, pitch_deviations=tuple(deviations))
        wheel = replace(pinion, name="w", teeth=51, pitch_deviations=())
        loaded = load_gear_pair(
            GearPair("p", "w", corner_contact=False),
            GearPairGeometry(pinion, wheel),
            torque=-20.0,
            inertias=(1e-3, 1e-2),
            speed=100.0,
        )
        mesh = loaded.hunting or hunting_period_mesh(loaded.contact, loaded.static.force)
        return float(mesh.transmission_error.min()), float(mesh.transmission_error.max())

    lowest, highest = braked(())
    low, high = braked(np.where(np.arange(23) == 5, deviation, 0.0).tolist())
    assert high == pytest.approx(highest + deviation * math.cos(ALPHA), rel=1e-9)
    assert low == pytest.approx(lowest, rel=1e-9)
