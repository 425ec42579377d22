"""A ring on six unequal bolts in the end of a box: their forces, and the planets that pass them at the sensor."""

from typing import Any

import numpy as np
import pytest
from planetary_case import stage

import gearwhine as gw
from gearwhine.case import dump_case, parse_case

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("few_slices")]

RADIUS, TORQUE = 0.1125, 50.0
ANGLES = np.radians(60.0 * np.arange(6))
CARRIER_HZ = 1000.0 / 60.0 * 24.0 / (24.0 + 84.0)
"""Turns of the carrier in a second, by Willis; the mesh frequency is that of the 84 teeth of the ring."""


def bolted_stage() -> dict[str, Any]:
    """The stage in front of a box, its ring on bolts alone; one pin is off its place, and its planet carries less."""
    bolts = {
        "circle": f"{2e3 * RADIUS} mm",
        "angles": [f"{angle} deg" for angle in range(0, 360, 60)],
        "tangential_stiffness": [f"{stiffness}e8 N/m" for stiffness in (4, 1, 2, 1, 3, 2)],
        "radial_stiffness": "1e8 N/m",
        "axial_stiffness": "1e8 N/m",
    }
    document = stage(fixed={"member": "r", "bolts": bolts, "seat": "ring seat"}, pin_errors=["30 um", "0 um", "0 um"])
    document["bearing"] = [
        bearing | {"damping": {"xx": "1e3 N*s/m", "yy": "1e3 N*s/m"}}
        for bearing in document["bearing"]
        if bearing["rotor"] != "ring"
    ]
    for rotor in document["rotor"]:
        rotor["start"] = "140 mm" if rotor["name"] == "carrier" else "50 mm"
        if "axis" in rotor:
            rotor["axis"] = ["0 mm", "160 mm"]
    document["housing"] = {
        "material": "steel",
        "damping_ratio": 0.02,
        "frequency_limit": "1.4 kHz",
        "box": {
            "size": ["340 mm", "320 mm", "160 mm"],
            "wall": "20 mm",
            "mesh_size": "60 mm",
            "feet": {"size": ["60 mm", "20 mm", "50 mm"]},
        },
        "seat": [{"name": "ring seat", "center": ["0 mm", "160 mm", "80 mm"], "diameter": "232 mm"}],
        "support": [{"name": f"foot {n}", "surface": f"foot-{n}", "fixed": ["x", "y", "z"]} for n in (1, 2, 3, 4)],
        "sensor": [{"name": "top", "position": ["20 mm", "320 mm", "30 mm"], "direction": "y"}],
    }
    document["operation"] = {"speed": "1000 rpm", "torque": f"{TORQUE} N*m"}
    # Two turns of the carrier, 9 revolutions of the sun, after half a one to settle.
    document["transient"] = {"revolutions": 11.25, "discard": 2.25, "tolerance": 5e-3}
    return document


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> gw.CaseStudy:
    path = tmp_path_factory.mktemp("bolted") / "case.toml"
    path.write_text(dump_case(parse_case(bolted_stage())), encoding="utf-8")
    return gw.load(path)


def test_bolts_balance_the_planets(study: gw.CaseStudy) -> None:
    document = study.operating_point().document
    radial, tangential = (
        np.array([bolt[f"{part}_force_n"] for bolt in document["support_bolts"]]) for part in ("radial", "tangential")
    )
    # Sun 24 and ring 84: the bolts hold T · 84 / 24.
    assert RADIUS * abs(tangential.sum()) == pytest.approx(TORQUE * 84.0 / 24.0, rel=1e-6)
    # The force of a mesh stands at one angle to its planet's place, so that shifts add as the places do.
    forces = {pair["driver"]: pair["force_n"] for pair in document["gear_pairs"] if pair["driven"] == "r"}
    by_planets = sum(forces[f"p {n + 1}"] * np.exp(2j * np.pi * n / 3.0) for n in range(3))
    by_bolts = np.sum((radial + 1j * tangential) * np.exp(1j * ANGLES))
    assert abs(by_planets) > 0.05 * sum(forces.values())
    assert abs(by_bolts) == pytest.approx(abs(by_planets), rel=1e-3)
    assert np.ptp(tangential) > 0.3 * np.abs(tangential).max()


def test_planets_that_pass_the_bolts_are_heard_beside_the_mesh_harmonics(study: gw.CaseStudy) -> None:
    """The motion, whose mesh stiffness varies, against the linear response about the mean load."""
    run = study.run()
    lines = {
        round(line["frequency_hz"] / CARRIER_HZ): line["sensor_acceleration_m_per_s2"]["together"]["top"]
        for line in run.document["system"]["mesh_lines"]
    }
    spectrum = run.dataset["sensor_spectrum"].sel(sensor="top")
    # Unequal loads circle with the carrier, and are most of what the sensor has up to the third harmonic.
    for harmonic, within in ((2, 0.02), (3, 0.06), (4, 0.08)):
        for side in (-1, 1):
            order = 84 * harmonic + side
            found = float(spectrum.sel(frequency=order * CARRIER_HZ, method="nearest"))
            assert found == pytest.approx(lines[order], rel=within), (harmonic, side)
            assert found > 1.5 * float(spectrum.sel(frequency=(order - side) * CARRIER_HZ, method="nearest"))
    # All of it comes by way of the bolts: nothing else joins the set and the housing.
    highest = run.document["sensors"][0]["peaks"][0]
    assert highest["name"].endswith("1× carrier")
    (path,) = highest["contributions"]["bearings"]
    assert (path["name"], path["share"]) == ("torque support of ring", pytest.approx(1.0, abs=0.01))
