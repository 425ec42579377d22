"""Keys of `[rotor_analysis]` in `gearwhine rotors`: torsional response, orders, the map's whirl; strain of whirl."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from gearwhine.output.manifest import opened_dataset

pytestmark = pytest.mark.rendered

# A slender shaft, almost without inertia, between two discs; either end stands in a soft bearing.
SHAFT = """
title = "Two discs on a shaft"

[material.light]
youngs_modulus = "200 GPa"
shear_modulus = "80 GPa"
density = "1 kg/m^3"

[[rotor]]
name = "shaft"
material = "light"
damping_ratio = 0.01
segments = [{ length = "400 mm", diameter = "20 mm" }, { length = "400 mm", diameter = "20 mm" }]
discs = [
    { at = "0 mm", mass = "5 kg", polar_inertia = "0.02 kg*m^2", diametral_inertia = "0.01 kg*m^2" },
    { at = "800 mm", mass = "8 kg", polar_inertia = "0.05 kg*m^2", diametral_inertia = "0.03 kg*m^2" },
]

[[bearing]]
name = "left"
rotor = "shaft"
at = "0 mm"
stiffness = { xx = "1e5 N/m", yy = "1e5 N/m" }

[[bearing]]
name = "right"
rotor = "shaft"
at = "800 mm"
stiffness = { xx = "3e5 N/m", yy = "2e5 N/m" }

[operation]
speed = "1000 rpm"

[rotor_analysis]
modes = 4
speed = { from = "100 rpm", to = "3000 rpm", step = "100 rpm" }
"""
LEFT, RIGHT = 0.02, 0.05
SPRING = 80e9 * math.pi / 32.0 * 0.02**4 / 0.8


@pytest.fixture
def shaft(tmp_path: Path) -> str:
    (tmp_path / "shaft.toml").write_text(SHAFT.replace('shear_modulus = "80 GPa"', "poisson_ratio = 0.25"))
    return "shaft.toml"


TORQUE = "torques=[{rotor='shaft', at='0 mm', amplitude='3 N*m', phase='20 deg'}]"
RANGE = "frequency={from='10 Hz', to='100 Hz', points=10}"


def two_discs(hertz: float, ratio: float, spring: float = 0.0, dashpot: float = 0.0) -> tuple[complex, complex]:
    """Angles of both discs under 3 N·m at 20° on the left one: k (1 + 2iζ) between them, spring and dashpot right."""
    omega, between = 2.0 * math.pi * hertz, SPRING * (1.0 + 2j * ratio)
    held = spring + 1j * omega * dashpot
    dynamic = np.array(
        [[between - LEFT * omega**2, -between], [-between, between + held - RIGHT * omega**2]], dtype=complex
    )
    left, right = np.linalg.solve(dynamic, [3.0 * np.exp(1j * math.radians(20.0)), 0.0])
    return complex(left), complex(right)


@pytest.mark.parametrize("held", [False, True])
def test_two_discs_answer_a_torque_as_they_must(solved_rotor: Any, rotor_curves: Any, shaft: str, held: bool) -> None:
    springs = "springs=[{rotor='shaft', at='800 mm', stiffness='900 N*m/rad', damping='2 N*m*s/rad'}]"
    probes = "probes=[{name='l', rotor='shaft', at='0 mm'}, {name='r', rotor='shaft', at='800 mm'}]"
    keys = [TORQUE, RANGE, "damping_ratio=0.03", probes, *([springs] if held else [])]
    setting = f"rotor_analysis.torsional_response={{{','.join(keys)}}}"
    response, data = solved_rotor(shaft, setting)["torsional_response"], rotor_curves(shaft, setting)
    assert (response["from_hz"], response["to_hz"]) == pytest.approx((10.0, 100.0))
    assert data.torsion_frequency.values[0] == pytest.approx(np.linspace(10.0, 100.0, 10))
    angles, torques = data.torsion_angle.values, data.torsion_torque.values
    for place, hertz in enumerate(data.torsion_frequency.values[0]):
        one, other = two_discs(hertz, 0.03, *((900.0, 2.0) if held else ()))
        # The shaft's own inertia is a part in 1e6 of the discs'.
        assert angles[0, place] == pytest.approx(abs(one), rel=1e-4)
        assert angles[1, place] == pytest.approx(abs(other), rel=1e-4)
        lag = math.degrees(float(data.torsion_angle_phase[0, place]) - float(np.angle(one)))
        assert math.remainder(lag, 360.0) == pytest.approx(0.0, abs=0.05)
        twist = SPRING * (1.0 + 0.06j) * (other - one)
        assert torques[0, place] == pytest.approx(abs(twist), rel=1e-4)
    assert response["probes"][0]["largest_angle_rad"] == pytest.approx(angles[0].max(), rel=1e-12)
    assert response["largest_torque_n_m"] == pytest.approx(torques[0].max(), rel=1e-4)


def test_torsion_is_looked_at_about_its_modes_unless_frequencies_are_given(solved_rotor: Any, shaft: str) -> None:
    """At the mode itself a ratio ζ leaves k (θ₁ − θ₂) = T J₂ / (J₁ + J₂) / 2ζ, the shaft's own ζ of 0.01 here."""
    rotor = solved_rotor(shaft, f"rotor_analysis.torsional_response={{{TORQUE}}}")
    response, elastic = rotor["torsional_response"], rotor["torsional_hz"][1]
    assert elastic * 2.0 * math.pi == pytest.approx(math.sqrt(SPRING * (1 / LEFT + 1 / RIGHT)), rel=1e-4)
    assert response["damping_ratio"] == 0.01
    # It is among the frequencies.
    assert response["probes"][0]["largest_angle_at_hz"] == pytest.approx(elastic, rel=1e-12)
    assert response["to_hz"] == pytest.approx(1.25 * rotor["torsional_hz"][3])
    assert [probe["name"] for probe in response["probes"]] == ["torque 1", "right end"]
    assert response["probes"][0]["largest_torque_at_hz"] == pytest.approx(elastic, rel=1e-3)
    expected = 3.0 * RIGHT / (LEFT + RIGHT) / 0.02
    assert response["probes"][0]["largest_torque_n_m"] == pytest.approx(expected, rel=1e-2)
    assert solved_rotor(shaft)["torsional_response"] is None


@pytest.mark.slow
def test_torsional_response_is_drawn_and_kept(gearwhine: Any, shaft: str, tmp_path: Path) -> None:
    settings = ("--set", f"rotor_analysis.torsional_response={{{TORQUE},{RANGE}}}")
    outcome = gearwhine("rotors", shaft, "-o", "out", *settings)
    assert outcome.code == 0, outcome.err
    assert "Response to torques from 10 to 100 Hz" in outcome.out
    with opened_dataset("out/results.nc") as data:
        assert data.torsion_angle.dims == ("torsion_probe", "torsion_step")
        assert data.torsion_torque.attrs["units"] == "N m"
        assert data.torsion_frequency.values[0] == pytest.approx(np.linspace(10.0, 100.0, 10))
        assert data.torsion_angle.sel(torsion_probe="shaft: torque 1").values[0] == pytest.approx(
            abs(two_discs(10.0, 0.01)[0]), rel=1e-4
        )
        # Of whirl, the moment at a free end vanishes, and that of the first mode does not in the middle.
        moment = data.rotor_whirl_moment.values[0]
        assert moment.shape == (4, 101)
        assert np.abs(moment[:, 50]).min() > 0.0
    with Image.open(tmp_path / "out" / "rotor-shaft-torsional-response.png") as image:
        assert len(image.convert("RGB").getcolors(maxcolors=1 << 24) or ()) > 50


def test_orders_meet_whirl_at_their_own_speeds(solved_rotor: Any, rotor_curves: Any, shaft: str) -> None:
    campbell = solved_rotor(shaft, "rotor_analysis.orders=[1, 2, 0.5]")["campbell"]
    assert [one["order"] for one in campbell["orders"]] == [0.5, 2.0]
    speeds, frequencies = np.array(campbell["speed_rpm"]), rotor_curves(shaft).campbell_frequency.values[0]
    for one in campbell["orders"]:
        gaps = frequencies - one["order"] * speeds[:, None] / 60.0
        expected = []
        for branch in gaps.T:
            for left in np.flatnonzero((branch[1:] > 0.0) != (branch[:-1] > 0.0)):
                part = branch[left] / (branch[left] - branch[left + 1])
                expected.append(speeds[left] + part * 100.0)
        found = [each["speed_rpm"] for each in one["critical_speeds"]]
        assert len(found) == len(expected) > 0
        np.testing.assert_allclose(found, np.sort(expected), rtol=1e-4)


def test_the_map_of_backward_whirl_lies_below_that_of_forward(solved_rotor: Any, shaft: str) -> None:
    """Gyroscopic moments stiffen forward and soften backward whirl: each backward speed is the lower one."""
    span = "from='1e5 N/m', to='1e6 N/m', points=2, modes=2"
    forward, backward = (
        solved_rotor(shaft, f"rotor_analysis.stiffness_map={{{span}, whirl='{whirl}'}}")["stiffness_map"]
        for whirl in ("forward", "backward")
    )
    ahead, behind = forward["forward_critical_speeds_rpm"], backward["backward_critical_speeds_rpm"]
    assert np.array(ahead).shape == np.array(behind).shape == (2, 2)
    assert (np.array(behind) < np.array(ahead)).all()


def test_whirl_says_where_it_strains_the_rotor(
    gearwhine: Any, solved_rotor: Any, rotor_curves: Any, shaft: str
) -> None:
    (whirl, *_) = (rotor := solved_rotor(shaft))["whirl"]
    assert rotor["bearings"] == ["left", "right"]
    data = rotor_curves(shaft).sel(whirl_state="shaft at 1000 rpm")
    shares = np.hstack([data[f"whirl_{part}_strain_share"].values for part in ("segment", "bearing")])
    assert shares.shape == (4, 4)
    np.testing.assert_allclose(shares.sum(axis=1), 1.0, rtol=1e-9)
    assert "whirl_pedestal_strain_share" not in data
    names = ["segment 1", "segment 2", "left", "right"]
    for told, of in zip(whirl["most_strained"], shares, strict=True):
        assert told == {"part": names[int(of.argmax())], "share": pytest.approx(of.max())}
    # At the other speeds the file has them.
    assert ["most_strained" in one for one in rotor["whirl"]].count(True) == 1
    assert "most strain energy" in gearwhine("rotors", shaft, "-q").out


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("torsional_response={torques=[]}", "torsional_response"),
        ("torsional_response={torques=[{rotor='shift', at=0, amplitude=1}]}", "did you mean 'shaft'"),
        ("torsional_response={torques=[{rotor='shaft', at=1, amplitude=1}]}", "800 mm long"),
        ("torsional_response={torques=[{rotor='shaft', at=0, amplitude='1 N'}]}", "torque"),
        ("torsional_response={torques=[{rotor='shaft', at=0, amplitude=1}], frequency={from=9, to=3}}", "above 'from'"),
        ("orders=[0]", "orders"),
        ("stiffness_map={from=1, to=2, whirl='up'}", "whirl"),
    ],
)
def test_wrong_keys_are_told(gearwhine: Any, shaft: str, setting: str, said: str) -> None:
    outcome = gearwhine("rotors", shaft, "-q", "--set", f"rotor_analysis.{setting}")
    assert outcome.code == 2
    assert said in outcome.err
