"""Wrong arguments of the front door: refused with the name of the argument, its value and what was expected."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.coupling.gears import TipRelief
from gearwhine.rotors.rolling_bearings import catalogue_bearing

WRONG = ("2.5 mm", math.nan, None, [1.0, 2.0], True, (None,))
"""Values that are no number: a text with its unit, what a failed computation leaves, a list, a truth value."""

_shaft = gw.Shaft(gw.Rotor("shaft", [gw.Segment(0.5, 0.03, 0.0, gw.STEEL)]))
_bearings = [gw.MountedBearing(gw.Bearing.isotropic(f"at {at}", at, 1e8), "shaft", None) for at in (0.02, 0.48)]
_study = gw.Study(gw.Machine([_shaft], _bearings, speed=100.0))

CALLS: dict[str, tuple[Callable[..., Any], dict[str, object]]] = {
    "Gear": (
        partial(gw.Gear, "gear", 21),
        {"module": 2.5e-3, "pressure_angle": 0.35, "face_width": 0.03, "profile_shift": 0.0, "addendum": 1.0}
        | {"dedendum": 1.25, "bore": 0.0, "youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7850.0}
        | {"eccentricity": 0.0, "eccentricity_phase": 0.0, "helix_angle": 0.0, "tooth_thinning": 0.0},
    ),
    "TipRelief": (TipRelief, {"amount": 8e-6, "length": 2e-3}),
    "GearPair": (partial(gw.GearPair, "a", "b"), {"damping_ratio": 0.05}),
    "Bearing": (partial(gw.Bearing, "bearing"), {"at": 0.1, "stiffness": np.eye(2), "damping": np.eye(2)}),
    "isotropic": (partial(gw.Bearing.isotropic, "bearing"), {"at": 0.1, "stiffness": 1e8, "damping": 0.0}),
    "Segment": (
        partial(gw.Segment, material=gw.STEEL),
        {"length": 0.1, "outer_diameter": 0.03, "inner_diameter": 0.0, "axial_force": 0.0},
    ),
    "ShaftMaterial": (gw.ShaftMaterial, {"youngs_modulus": 2e11, "shear_modulus": 8e10, "density": 7850.0}),
    "from_poisson_ratio": (
        gw.ShaftMaterial.from_poisson_ratio,
        {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7850.0},
    ),
    "Material": (gw.Material, {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7850.0}),
    "Disc": (gw.Disc, {"at": 0.1, "mass": 1.0, "polar_inertia": 0.01, "diametral_inertia": 0.005}),
    "Rotor": (partial(gw.Rotor, "rotor"), {"segments": [gw.Segment(0.5, 0.03, 0.0, gw.STEEL)]}),
    "catalogue_bearing": (
        partial(catalogue_bearing, "deep-groove"),
        {"bore": 0.035, "outer_diameter": 0.08, "width": 0.021, "clearance": 0.0},
    ),
    "GivenSpeed": (partial(gw.GivenSpeed, "shaft"), {"speed": 1.0}),
    "PlanetarySet": (partial(gw.PlanetarySet, "set", carrier="c", sun="s"), {"planets": ("a", "b")}),
    "Machine": (partial(gw.Machine, [_shaft], _bearings), {"speed": 100.0, "torque": 0.0, "gravity": (0, -9.81, 0)}),
    "TransientPlan": (gw.TransientPlan, {"revolutions": 5.0}),
    "rotors": (_study.rotors, {"mode_count": 4}),
    "system": (_study.system, {"sidebands": 0, "mesh_harmonics": 3, "mesh_phase": 0.5}),
    "steady": (_study.steady, {"points": 100}),
    "simulate": (_study.simulate, {"revolutions": 1.0}),
    "sweep": (_study.sweep, {"speeds": [100.0], "plan": gw.TransientPlan(revolutions=1.0)}),
}
ALLOWED = {("system", "mesh_phase"), ("rotors", "mode_count"), ("TransientPlan", "revolutions")}  # None, a default
ALLOWED |= {("TipRelief", "length"), ("sweep", "plan"), ("simulate", "revolutions"), ("Machine", "gravity")}


@pytest.mark.parametrize(("call", "argument"), [(name, key) for name, (_, good) in CALLS.items() for key in good])
def test_what_is_no_number_is_refused_with_its_name(call: str, argument: str) -> None:
    """Each such value raises the error of its room, whose message names the argument."""
    made, good = CALLS[call]
    for value in WRONG:
        if (value is None and (call, argument) in ALLOWED) or (argument == "speeds" and value == [1.0, 2.0]):
            continue
        with pytest.raises(ValueError, match=f"{argument}|{argument.replace('_', ' ')}"):
            made(**good | {argument: value})


def test_the_library_names_part_attribute_value_and_expectation() -> None:
    with pytest.raises(gw.GearError, match=r"gear 'x': module is '2.5 mm'; expected a finite number above 0"):
        gw.Gear("x", 21, "2.5 mm", 0.35, 0.03)  # type: ignore[arg-type]
    with pytest.raises(gw.RotorError, match=r"bearing 'x': stiffness is '1e8 N/m'; expected a finite number"):
        gw.Bearing.isotropic("x", 0.1, "1e8 N/m")  # type: ignore[arg-type]
    with pytest.raises(gw.CouplingError, match=r"sweep: speeds is \['1500 rpm'\]; expected numbers, .* rad/s"):
        _study.sweep(["1500 rpm"], gw.TransientPlan(revolutions=1.0))  # type: ignore[list-item]
    with pytest.raises(ValueError, match=r"rpm: value is '1500'; expected a number of revolutions per minute"):
        gw.rpm("1500")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="to_rpm: speed is None; expected a number"):
        gw.to_rpm(None)  # type: ignore[arg-type]


@pytest.mark.parametrize("limit", ["3 kHz", math.nan, 0.0, [1.0], True])
def test_a_limit_of_modes_that_is_no_frequency_is_refused(limit: object) -> None:
    """Before anything is assembled: the wrong limit is found without a mesh."""
    unmeshed = object.__new__(gw.Housing)
    with pytest.raises(gw.HousingError, match=r"housing: below_hz is .*; expected a finite number above 0 Hz, or None"):
        unmeshed.modes(below_hz=limit)  # type: ignore[arg-type]
    with pytest.raises(gw.HousingError, match=r"housing: count is .*; expected a whole number of at least 1, or None"):
        unmeshed.modes(count=limit)  # type: ignore[arg-type]
