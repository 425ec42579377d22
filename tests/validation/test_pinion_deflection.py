"""Face load factor of pinions that bend and twist under their own load, against closed forms and ISO 6336-1.

The pinion is a shaft with teeth, the wheel is rigid, and the mesh is a foundation of the stiffness c per width and
displacement that carries w(z) = c (δ − y(z)), y the deflection of the pinion in the plane of action.

- Bending: the pinion between two bearings at the ends of its face is Hetényi's simply supported beam on an elastic
  foundation under an even load (Beams on Elastic Foundation, 1946, chapter III).
- Torsion: c y'' = κ² w has Volkersen's solution for bonded joints (Luftfahrtforschung 15, 1938, pages 41-47).
- ISO 6336-1:2006, 7.5.2.4.1: equation (57) with K' of figure 13 for f_sh, equation (52) for F_βx and (39) to (42) for
  K_Hβ.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np
import pytest
from own_statics import MODULE, PRESSURE, STEEL, distance, linear_bearing, toothed

from gearwhine.coupling import Machine, MountedBearing, Output, Shaft, ShaftGear
from gearwhine.coupling.gears import ConstantStiffness
from gearwhine.coupling.gears.geometry.toothed_section import toothed_section
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.statics.operating_point import PairLoad
from gearwhine.rotors import Rotor, Segment

Published = Callable[..., None]
Remark = Callable[[str, str], None]

BENT = "Hetényi (1946), simply supported beam on an elastic foundation, as a pinion"
TWISTED = "Volkersen (1938), load along a joint, as a twisted pinion"
METHOD_C = "ISO 6336-1:2006, equation (57), deflection of pinion and shaft"

PINION = 20
RIGID = np.diag([1e12, 1e12, 1e10, 0.0, 0.0])
SECTION = toothed_section(toothed("pinion", PINION, 0.0))


def pair_on(
    width: float,
    stiffness: float,
    wheel: int,
    places: Iterable[float],
    *,
    length: float,
    at: float,
    shaft: float = 0.03,
    torque: float = 1.0,
    torque_at: float = 0.0,
    held_wheel: Iterable[float] | None = None,
    output_at: float | None = None,
    finer: int = 1,
) -> PairLoad:
    """Operating point of a pinion on rigid bearings at some places, with a wheel on a thick shaft.

    Both may have `finer` times as many teeth of as much less module, on the same reference circles.
    """
    apart = distance(PINION, wheel, 0.0)
    shafts = [
        Shaft(Rotor("in", [Segment(length, shaft, 0.0, STEEL)])),
        Shaft(Rotor("out", [Segment(length, 0.1 if wheel < 100 else 0.45, 0.0, STEEL)]), (0.0, apart)),
    ]
    places = list(places)
    on_wheel = places if held_wheel is None else list(held_wheel)
    held = [
        MountedBearing(linear_bearing(f"{name} {number}", z, RIGID), name, None)
        for name, them in (("in", places), ("out", on_wheel))
        for number, z in enumerate(them)
    ]
    gears = [
        ShaftGear(replace(toothed(name, finer * teeth, 0.0, width), module=MODULE / finer), shaft_name, at)
        for name, teeth, shaft_name in (("pinion", PINION, "in"), ("wheel", wheel, "out"))
    ]
    machine = Machine(
        shafts,
        held,
        gears,
        [GearPair("pinion", "wheel", ConstantStiffness(stiffness))],
        speed=10.0,
        torque=torque,
        torque_at=torque_at,
        outputs=[Output("out", torque * wheel / PINION, torque_at if output_at is None else output_at)],
    )
    (pair,) = machine.operating_point().pairs
    return pair


@pytest.mark.usefixtures("endless")
@pytest.mark.parametrize("size", [0.5, 1.0, 1.5, 2.0, 2.5, 3.0])
def test_a_slender_pinion_between_its_bearings(published: Published, remark: Remark, size: float) -> None:
    """K_Hβ = λb (cosh λb + cos λb) / (sinh λb + sin λb), λ = (c / 4 E I)^{1/4}: c δ over the mean of both reactions.

    A face of 1 m on a section of 60 mm, so that shear takes no part, with the torque in the middle, where it twists
    least; the wheel is 9 000 times as stiff. The shape of the deflection is a polynomial through five stations.
    """
    remark(
        BENT,
        "The load is largest at the bearings, where the pinion cannot yield. The pinion twists a little as well, and "
        "its deflection is a polynomial through five stations of the face.",
    )
    width, second = 1.0, math.pi / 64.0 * SECTION.bending_diameter**4
    per_width = 4.0 * STEEL.youngs_modulus * second * (size / width) ** 4
    pair = pair_on(width, per_width * width, 200, (0.05, 0.05 + width), length=1.1, at=0.55, torque_at=0.55)
    ends, middle = math.cosh(size) + math.cos(size), math.sinh(size) + math.sin(size)
    published(BENT, f"K_Hβ, λb = {size:g}", size * ends / middle, pair.k_h_beta, rel=0.002)
    assert pair.misalignment * width == pytest.approx(0.0, abs=1e-6 * pair.force / pair.mean_stiffness)
    assert pair.line_load.argmin() == pair.line_load.size // 2


@pytest.fixture
def endless(monkeypatch: pytest.MonkeyPatch) -> None:
    """Gears that are as stiff at the ends of the face as within, as the closed forms have them."""
    for length in ("_END_LENGTH", "_SPREAD_BENDING", "_SPREAD_TORSION"):
        monkeypatch.setattr(f"gearwhine.coupling.gears.geometry.toothed_section.{length}", 0.0)


@pytest.fixture
def unbuildable(monkeypatch: pytest.MonkeyPatch) -> None:
    """Machines that nobody can build: a closed form of twisting alone takes bearings within the face."""
    monkeypatch.setattr("gearwhine.coupling.machine_description.machine_findings", lambda *_: iter(()))


def twisted(stiffness: float) -> tuple[PairLoad, float]:
    """Twisted pinion and wheel of 20 and 60 teeth, which bearings along the face keep straight, and κb.

    Both torques act at one end of the face.
    """
    width, wheel = 0.06, 60
    places = np.linspace(0.15 - width / 2, 0.15 + width / 2, 13)
    thick = 1.05 * SECTION.bending_diameter  # the shaft goes through the teeth: no ends
    pair = pair_on(width, stiffness, wheel, places.tolist(), length=0.3, at=0.15, shaft=thick)
    squared = 0.0
    for teeth, diameter in ((PINION, thick), (wheel, toothed_section(toothed("wheel", wheel, 0.0)).torsion_diameter)):
        polar = math.pi / 32.0 * diameter**4
        base = 0.5 * MODULE * teeth * math.cos(PRESSURE)
        squared += stiffness * width * base**2 / (STEEL.shear_modulus * polar)
    return pair, math.sqrt(squared)


@pytest.mark.usefixtures("endless", "unbuildable")
@pytest.mark.parametrize("stiffness", [1e8, 1e9, 4e9])
def test_a_twisted_pinion(published: Published, remark: Remark, stiffness: float) -> None:
    """K_Hβ = κb coth κb, κ² = c (r_b1² / G J_1 + r_b2² / G J_2).

    The load acts on the shafts at five stations of the face, between which the torque is constant: K_Hβ − 1 is 3.0 to
    3.6 % too large.
    """
    remark(
        TWISTED,
        "The load acts on the shafts at five stations of the face, between which the torque stays: K_Hβ − 1 is 3.0 to "
        "3.6 % too large.",
    )
    pair, size = twisted(stiffness)
    closed = size / math.tanh(size)
    published(TWISTED, f"K_Hβ, κb = {size:.3g}", closed, pair.k_h_beta, rel=0.02)
    assert pair.k_h_beta - 1.0 == pytest.approx(closed - 1.0, rel=0.04)
    assert abs(pair.misalignment_by_cause["shafts"]) < 0.01 * abs(pair.misalignment)
    assert pair.line_load.argmax() == 0  # where the torque enters


@pytest.mark.usefixtures("endless", "unbuildable")
@pytest.mark.parametrize(("stations", "within"), [(9, 0.012), (13, 0.006)])
def test_more_stations_come_closer_to_the_twisted_pinion(
    monkeypatch: pytest.MonkeyPatch, stations: int, within: float
) -> None:
    monkeypatch.setattr("gearwhine.coupling.gears.contact.face_slices.FACE_STATIONS", stations)
    pair, size = twisted(1e9)
    assert pair.k_h_beta - 1.0 == pytest.approx(size / math.tanh(size) - 1.0, rel=within)


# Offset of the pinion from the middle of its bearings, over their distance, and the end where the torque enters: that
# of the near bearing (figure 13 a, K' = 0.8) or the other one (b, -0.8).
OFFSETS = [(0.0, True), (0.1, True), (0.1, False), (0.2, True), (0.2, False), (0.3, True), (0.3, False)]


@pytest.mark.parametrize(("offset", "near"), OFFSETS)
def test_deflection_of_pinion_and_shaft_by_iso_6336(
    published: Published, remark: Remark, offset: float, near: bool
) -> None:
    """K_Hβ of a pinion of b / d_1 = 1 on bearings 200 mm apart, d_sh = 55 mm, with 17 N/(mm µm) and nothing else.

    Wheel and bearings are rigid, there are no deviations and no running-in. d_1 / d_sh is below 1.15, so that the
    norm's pinion does not stiffen its shaft; its teeth are fine, so that they stand on that.
    """
    remark(
        METHOD_C,
        "An approximation of the norm. Its slope by the offset s of the pinion grows as s, that of a beam as "
        "s (1 − 4 s²/l²), 64 % of it at s/l = 0.3. Ours is above the norm without offset, as its pinion twists as a "
        "circle near the root, and the norm's as the reference circle. The load that grows at one end bends that end "
        "away, which the norm leaves out; it takes 0.02 to 0.10 off K_Hβ.",
    )
    width, apart, shaft, per_width, line_load = 0.06, 0.2, 0.055, 1.7e10, 2e5
    reference = MODULE * PINION
    at = 0.01 + apart * (0.5 + offset)
    length = apart + 0.02
    beside = [at - 0.5 * width - 0.001, at + 0.5 * width + 0.001]
    pair = pair_on(
        width,
        per_width * width,
        160,
        (0.01, 0.01 + apart),
        length=length,
        at=at,
        shaft=shaft,
        torque=line_load * width * reference / 2.0,
        torque_at=length if near else 0.0,
        held_wheel=beside,
        output_at=at,
        finer=2,
    )
    lever = (0.8 if near else -0.8) * apart * (offset * apart) / reference**2 * (reference / shaft) ** 4
    deflection = 0.023e-6 * (line_load / 1e3) * (abs(1.0 + lever - 0.3) + 0.3) * (width / reference) ** 2  # f_sh
    excess = 1.33 * deflection * per_width / (2.0 * line_load)
    iso = 1.0 + excess if excess <= 1.0 else 2.0 * math.sqrt(excess)
    where = "in the middle" if offset == 0.0 else f"s/l = {offset:g}, torque at the {'near' if near else 'far'} end"
    published(METHOD_C, f"K_Hβ, {where}", iso, pair.k_h_beta, rel=0.29)
