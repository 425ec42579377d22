"""Locating and floating ball bearings in cases: thrust, mean forces of the motion, refusals and warnings."""

import math
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.coupling.errors import CouplingError

BALLS = {"type": "deep-groove", "bore": "40 mm", "outer_diameter": "80 mm", "width": "18 mm"}
# 150 N·m on 23 teeth of 3 mm at 15°: T tan β / r on the reference circle, along z in the sense of the pinion's helix.
THRUST = 150.0 * math.tan(math.radians(15.0)) / (0.5 * 23 * 3e-3 / math.cos(math.radians(15.0)))


def changes(*floating: int, law: str = "linear", **more: Any) -> dict[str, Any]:
    """Changes of the helical pair: deep groove ball bearings at all places, those of the given numbers floating."""
    found: dict[str, Any] = {"gear_pair.0.misalignment": "found"}
    for number in range(4):
        rolling = {"catalogue": BALLS, "clearance": "8 um", "law": law}
        if number in floating:
            rolling = {**rolling, "floating": True, **more}
        found[f"bearing.{number}.stiffness"] = {"rolling": rolling}
        found[f"bearing.{number}.damping"] = {"xx": "8e2 N*s/m", "yy": "8e2 N*s/m"}
    return found


def forces(study: gw.CaseStudy) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Forces x, y, z of the shafts on the four bearings at the operating point [N], shape (4, 3)."""
    return np.array([one["force_n"] for one in study.operating_point().document["bearings"]])


def test_the_locating_bearing_takes_all_thrust() -> None:
    study = gw.load("helical-pair", changes(1, 3))
    found = forces(study)
    assert found[1, 2] == found[3, 2] == 0.0
    assert found[:, 2] == pytest.approx([THRUST, 0.0, -THRUST, 0.0], rel=1e-6)
    # Where both locate the shaft they share it.
    shared = forces(gw.load("helical-pair", changes()))
    assert shared[0, 2] + shared[1, 2] == pytest.approx(THRUST, rel=1e-6)
    assert min(shared[:2, 2]) > 0.2 * THRUST
    (first, _) = study.check().document["axial_location"]
    assert first["thrust_plus_z"] == first["thrust_minus_z"] == ["input-left"]


def test_floating_at_the_other_end_is_located_there() -> None:
    found = forces(gw.load("helical-pair", changes(0, 3)))
    assert found[:, 2] == pytest.approx([0.0, THRUST, -THRUST, 0.0], rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["linear", "nonlinear"])
def test_motion_has_the_forces_of_the_equilibrium(law: str) -> None:
    motion = {"transient.revolutions": 4, "transient.discard": 3}
    study = gw.load("helical-pair", changes(1, 3, law=law) | motion)
    mean = np.array([one["mean_force_n"] for one in study.run().document["bearings"]])
    expected = forces(study)
    assert not mean[[1, 3], 2].any()
    assert mean == pytest.approx(expected, abs=2e-3 * float(np.abs(expected).max()))


def test_all_analyses_have_the_same_tangent() -> None:
    """With the load typed that the equilibrium finds, a bearing has its stiffness across the axis."""
    study = gw.load("helical-pair", changes(1, 3))
    (bearing,) = (one for one in study.operating_point().solved.point.bearings if one.name == "input-right")
    x, y, z = bearing.force[:3]
    typed = gw.load("helical-pair", changes(1, 3) | {"bearing.1.load": {"x": x, "y": y, "z": z}})
    (_, own) = typed.case.parts.bearings_on("input")
    # The shaft's tilt in the bearing is left out there, and is small.
    assert own.spatial_stiffness[:2, :2] == pytest.approx(bearing.stiffness[:2, :2], rel=0.02)
    assert not own.spatial_stiffness[2].any()
    assert not bearing.stiffness[2].any()


def test_a_shaft_of_floating_bearings_alone_is_refused_under_thrust() -> None:
    study = gw.load("helical-pair", changes(0, 1, 3))
    for analysis in (study.operating_point, study.run, study.steady):
        with pytest.raises(CouplingError, match=r"rotor 'input'.*a rolling bearing that does not float"):
            analysis()


def test_a_shaft_of_floating_bearings_alone_is_refused_under_its_weight() -> None:
    upright = changes(0, 1, 3) | {"operation.gravity": [0, 0, -9.81]}
    del upright["gear_pair.0.misalignment"]
    with pytest.raises(CouplingError, match="nothing holds the axial motion of shaft 'input'"):
        gw.load("spur-pair", upright).operating_point()


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ({"preload": "50 N"}, r"rolling\.preload.*expected nothing: the outer ring of a floating bearing slides"),
        ({"axial_offset": "5 um"}, r"rolling\.axial_offset.*expected nothing: the outer ring of a floating bearing"),
        ({"arrangement": "back to back", "spacing": "18 mm"}, r"rolling\.floating.*only a single bearing floats"),
        ({"catalogue": {**BALLS, "type": "tapered-roller"}}, "tapered-roller bearings would slide open"),
        ({"catalogue": {**BALLS, "type": "angular-contact"}}, "angular-contact bearings would slide open"),
        (
            {
                "catalogue": {**BALLS, "type": "cylindrical-roller"},
                "flanges": "one",
                "flange_stiffness": "1e7 N/m",
            },
            "rollers with a flange on one side would slide open",
        ),
    ],
)
def test_bearings_that_cannot_float_are_refused(more: dict[str, Any], told: str) -> None:
    with pytest.raises(CaseError, match=told):
        gw.load("helical-pair", changes(1, **more))


def test_axial_load_and_axial_damping_of_a_floating_bearing_are_refused() -> None:
    load = {"bearing.1.load": {"x": "100 N", "z": "10 N"}}
    with pytest.raises(CaseError, match=r"bearing\[1\]\.load\.z .*expected 0: a floating bearing takes no axial force"):
        gw.load("helical-pair", changes(1) | load)
    damping = np.diag([800.0, 800.0, 600.0, 0.0, 0.0]).tolist()
    with pytest.raises(CaseError, match=r"bearing\[1\]\.damping .*expected zeros in the row and column of z"):
        gw.load("helical-pair", changes(1) | {"bearing.1.damping": {"matrix": damping}})
    damping[2][2] = 0.0
    gw.load("helical-pair", changes(1) | {"bearing.1.damping": {"matrix": damping}})


def test_ball_bearings_that_share_the_thrust_are_named() -> None:
    told = gw.load("helical-pair", changes()).warnings
    assert len(told) == 2
    assert told[0].startswith("shaft 'input' is located both ways by 'input-left' and 'input-right': ")
    assert "statically indeterminate" in told[0]
    assert "`floating = true`" in told[0]
    assert gw.load("helical-pair", changes(1, 3)).warnings == ()
    (left,) = gw.load("helical-pair", changes(3)).warnings
    assert left.startswith("shaft 'input' ")
    # Set against each other at assembly, they are meant to share it.
    offset = {"rolling": {"catalogue": BALLS, "clearance": "8 um", "axial_offset": "20 um"}}
    assert gw.load("helical-pair", changes(3) | {"bearing.0.stiffness": offset}).warnings == ()
    # Rollers without flanges do not locate a shaft.
    rollers = {"rolling": {"catalogue": {**BALLS, "type": "cylindrical-roller"}}}
    assert gw.load("helical-pair", changes(3) | {"bearing.0.stiffness": rollers}).warnings == ()
