"""Speeds and torques of trains by their constraint matrix: planetary sets, compound sets, differentials, rank."""

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearwhine.coupling import CouplingError
from gearwhine.coupling.description.gear_train import (
    GearedShafts,
    GearTrain,
    GivenSpeed,
    Output,
    carrying_flanks,
    gear_train,
    require_balanced_outputs,
    turning_senses,
)

SUN, PLANET, RING = 21, 24, 69
"""Teeth of one set: ring = sun + 2 planets."""
STATIONARY = Fraction(-RING, SUN)
"""Stationary ratio i₀ = (ω_s - ω_c) / (ω_r - ω_c) of a set with single planets."""


def pairs_of_set(path: str, count: int = 3, name: str = "") -> list[GearedShafts]:
    """Meshes of one set in the order in which power passes from the first to the last member: "sun ring"."""
    teeth = {"sun": SUN, "ring": -RING}
    first, last = path.split()
    pairs = []
    for number in range(count):
        planet = f"{name}planet {number}"
        pairs.append(GearedShafts(name + first, planet, (teeth[first], PLANET), name + "carrier"))
        pairs.append(GearedShafts(planet, name + last, (PLANET, teeth[last]), name + "carrier"))
    return pairs


def train_of(pairs: Sequence[GearedShafts], held: Sequence[str] = (), **given_too: object) -> GearTrain:
    """Train of pairs; shafts whose name has "planet" in it are planets."""
    names = list(dict.fromkeys(shaft for pair in pairs for shaft in pair.row))
    planets = [name for name in names if "planet" in name]
    return gear_train(pairs, names, held=held, planets=planets, **given_too)  # type: ignore[arg-type]


def torques_on(train: GearTrain, torque: float, speed: float, **outside: object) -> dict[str, list[float]]:
    """All torques about z on each shaft [N m]: from outside, of meshes, of supports."""
    applied = train.applied_torques(torque, speed, [], ends=dict.fromkeys(train.ratios, 0.0), **outside)  # type: ignore[arg-type]
    along = train.torques_along(applied, speed)
    on: dict[str, list[float]] = {name: [] for name in train.ratios}
    for each in applied:
        on[each.rotor].append(each.value)
    for mesh in train.mesh_torques(train.pair_torques(along), speed):
        for name, value in mesh.items():
            on[name].append(value)
    for name, value in train.support_torques(along, speed).items():
        on[name].append(value)
    return on


@pytest.mark.parametrize(
    ("path", "held", "first", "last", "ratio"),
    [
        ("sun ring", "ring", "sun", "carrier", 1 - STATIONARY),
        ("sun ring", "carrier", "sun", "ring", STATIONARY),
        ("ring sun", "sun", "ring", "carrier", 1 - 1 / STATIONARY),
        ("ring sun", "carrier", "ring", "sun", 1 / STATIONARY),
        ("sun ring", "sun", "carrier", "ring", 1 / (1 - 1 / STATIONARY)),
        ("ring sun", "ring", "carrier", "sun", 1 / (1 - STATIONARY)),
    ],
)
def test_the_six_arrangements_of_a_set(path: str, held: str, first: str, last: str, ratio: Fraction) -> None:
    """Input over output speed by Willis' equation ω_s - i₀ ω_r = (1 - i₀) ω_c; torques by T_s : T_r = 1 : -i₀."""
    train = train_of(pairs_of_set(path), [held])
    assert train.first == first
    assert list(train.problems(list(train.ratios), [""] * 6)) == []
    assert train.ratios[first] / train.ratios[last] == ratio
    assert train.ratios[held] == 0
    assert train.output_shafts == (last,)
    planet = train.ratios["planet 0"] - train.ratios["carrier"]
    assert planet == Fraction(-SUN, PLANET) * (train.ratios["sun"] - train.ratios["carrier"])
    assert planet == Fraction(RING, PLANET) * (train.ratios["ring"] - train.ratios["carrier"])
    for speed in (40.0, -40.0):
        on = torques_on(train, 150.0, speed)
        outside = {first: 150.0, last: -150.0 * float(ratio), held: 150.0 * float(ratio - 1)}
        for member in ("sun", "ring", "carrier"):
            assert sum(on[member]) == pytest.approx(0.0, abs=1e-10)
            sense = 1.0 if speed > 0.0 else -1.0
            from_outside = next(value for value in on[member] if abs(value - sense * outside[member]) < 1e-9)
            assert from_outside == pytest.approx(sense * outside[member], rel=1e-12)
        assert all(sum(on[f"planet {k}"]) == pytest.approx(0.0, abs=1e-12) for k in range(3))
        carried = train.pair_torques(train.torques_along(_applied(train, 150.0, speed), speed))
        assert carrying_flanks(carried, 150.0) == ["drive"] * 6
        assert carried[::2] == pytest.approx([carried[0]] * 3, rel=1e-12)
    frequencies = train.mesh_frequencies(1.0)
    assert frequencies == pytest.approx([frequencies[0]] * 6, rel=1e-15)
    assert all(train.shares_torque)


def _applied(train: GearTrain, torque: float, speed: float) -> tuple[object, ...]:
    return train.applied_torques(torque, speed, [], ends=dict.fromkeys(train.ratios, 0.0))


def test_one_planet_shares_with_no_other() -> None:
    assert train_of(pairs_of_set("sun ring", 1), ["ring"]).shares_torque == (False, False)


def test_stepped_planets() -> None:
    """Planet gears of 30 and 20 teeth on one shaft: i₀ = -(z_p1 z_r) / (z_s z_p2)."""
    pairs = [
        GearedShafts("sun", "planet", (18, 30), "carrier"),
        GearedShafts("planet", "ring", (20, -68), "carrier"),
    ]
    stationary = Fraction(-30 * 68, 18 * 20)
    assert 1 / train_of(pairs, ["ring"]).ratios["carrier"] == 1 - stationary


def test_double_planets() -> None:
    """Planets that mesh in twos between sun and ring: i₀ = +z_r / z_s, and held the ring turns the carrier back."""
    pairs = [
        GearedShafts("sun", "planet in", (30, 17), "carrier"),
        GearedShafts("planet in", "planet out", (17, 19), "carrier"),
        GearedShafts("planet out", "ring", (19, -90), "carrier"),
    ]
    train = train_of(pairs, ["ring"])
    assert 1 / train.ratios["carrier"] == 1 - Fraction(90, 30)
    assert train.senses == (1, -1, 1)
    on = torques_on(train, 10.0, 1.0)
    assert all(sum(values) == pytest.approx(0.0, abs=1e-12) for values in on.values())


def ravigneaux(path: Sequence[str]) -> list[GearedShafts]:
    """Small sun, large sun and ring on short and long planets."""
    small, large, ring, short, long = 28, 32, -74, 19, 21
    rows = {
        "small": ("small sun", "planet short", (small, short)),
        "between": ("planet short", "planet long", (short, long)),
        "large": ("large sun", "planet long", (large, long)),
        "ring": ("planet long", "ring", (long, ring)),
    }
    pairs = []
    for name in path:
        back = name.startswith("-")
        driver, driven, teeth = rows[name.lstrip("-")]
        ends = (driven, driver, teeth[::-1]) if back else (driver, driven, teeth)
        pairs.append(GearedShafts(*ends, "carrier"))
    return pairs


def test_the_gears_of_a_ravigneaux_set() -> None:
    """Ratios of the four-speed Ravigneaux gearbox by its teeth (Naunheimer et al., Automotive Transmissions)."""
    small, large, ring = 28, 32, 74
    first = train_of(ravigneaux(["small", "between", "ring", "large"]), ["carrier"])
    assert 1 / first.ratios["ring"] == Fraction(ring, small)
    second = train_of(ravigneaux(["small", "between", "-large", "ring"]), ["large sun"])
    assert 1 / second.ratios["ring"] == Fraction(ring * (small + large), small * (ring + large))
    fourth = train_of(ravigneaux(["large", "ring", "-between", "-small"]), ["large sun"], first="carrier")
    assert 1 / fourth.ratios["ring"] == Fraction(ring, ring + large)
    reverse = train_of(ravigneaux(["large", "ring", "-between", "-small"]), ["carrier"])
    assert 1 / reverse.ratios["ring"] == Fraction(-ring, large)
    direct = train_of(ravigneaux(["small", "between", "ring", "large"]), given={"carrier": Fraction(1)})
    assert set(direct.ratios.values()) == {Fraction(1)}
    assert direct.mesh_frequencies(300.0) == (0.0,) * 4


def test_sets_in_series_and_behind_a_parallel_stage() -> None:
    """A wheel on the first sun's shaft, and the first carrier the second sun: the ratios multiply."""
    shared = [GearedShafts("input", "a sun", (17, 51)), *pairs_of_set("sun ring", 3, "a ")]
    second = [
        GearedShafts(
            *("a carrier" if name == "b sun" else name for name in (pair.driver, pair.driven)), pair.teeth, pair.carrier
        )
        for pair in pairs_of_set("sun ring", 4, "b ")
    ]
    train = train_of([*shared, *second], ["a ring", "b ring"])
    assert train.ratios["b carrier"] == Fraction(-17, 51) / (1 - STATIONARY) ** 2
    assert train.output_shafts == ("b carrier",)
    on = torques_on(train, 25.0, 90.0)
    assert all(sum(values) == pytest.approx(0.0, abs=1e-9) for values in on.values())
    held = sum(train.support_torques(train.torques_along(_applied(train, 25.0, 90.0), 90.0), 90.0).values())
    turned = -25.0 * 3.0  # torque on the first sun, which the wheel turns the other way
    assert held == pytest.approx(turned * float((1 - STATIONARY) ** 2 - 1), rel=1e-12)


def test_a_differential_of_two_inputs() -> None:
    """Willis at two given speeds; the second drive's torque is what the set balances, T_s : T_r = 1 : z_r / z_s."""
    train = train_of(pairs_of_set("sun ring"), given={"ring": Fraction(1, 5)})
    carrier = (SUN * 1 + RING * Fraction(1, 5)) / (SUN + RING)
    assert train.ratios["carrier"] == carrier
    drive = GivenSpeed("ring", 0.2 * 60.0)
    applied = train.applied_torques(80.0, 60.0, [], ends=dict.fromkeys(train.ratios, 0.0), given=[drive])
    found = {torque.rotor: torque.value for torque in applied}
    assert found["ring"] == pytest.approx(80.0 * RING / SUN, rel=1e-12)
    assert found["carrier"] == pytest.approx(-80.0 * (RING + SUN) / SUN, rel=1e-12)
    assert sum(value * float(train.ratios[name]) for name, value in found.items()) == pytest.approx(0.0, abs=1e-10)
    on = torques_on(train, 80.0, 60.0, given=[drive])
    assert all(sum(values) == pytest.approx(0.0, abs=1e-10) for values in on.values())


@pytest.mark.parametrize(
    ("held", "given", "match"),
    [
        ([], {}, "2 degrees of freedom and 1 speed .*freely; expected 1 more of 'carrier', 'ring' held"),
        (["ring", "carrier"], {}, r"'ring'|'planet.*held shafts \('ring', 'carrier'\) free"),
        (
            ["ring"],
            {"carrier": Fraction(1, 2)},
            "'carrier' is given 0.5 of the first driver's speed, and turns at 0.23",
        ),
        (["sun"], {}, None),
        (["sun", "carrier"], {}, "torque comes in on shaft 'carrier', which is held; .* one of 'ring'"),
    ],
)
def test_rank_tells_missing_and_contradictory_drives(
    held: list[str], given: dict[str, Fraction], match: str | None
) -> None:
    train = train_of(pairs_of_set("sun ring"), held, given=given)
    if match is None:
        train.turning_ratios(list(train.ratios), ["pair"] * 6)
        return
    names = [*train.ratios, *train.open_shafts]
    with pytest.raises(CouplingError, match=match):
        train.turning_ratios(names, [f"pair {n}" for n in range(6)])


def test_planets_and_held_shafts_give_no_power() -> None:
    train = train_of(pairs_of_set("sun ring"), ["ring"])
    with pytest.raises(CouplingError, match="output on shaft 'ring', which stands still; expected one of 'sun', 'car"):
        require_balanced_outputs(train, 5.0, [Output("ring")])
    with pytest.raises(CouplingError, match="output on shaft 'planet 0', a planet"):
        require_balanced_outputs(train, 5.0, [Output("planet 0")])


def test_senses_are_those_seen_from_the_carrier() -> None:
    """A ring that stands still turns back as its carrier sees it; at rest too the ratios tell."""
    train = train_of(pairs_of_set("ring sun", 1), ["ring"])
    assert train.first == "carrier"
    assert train.senses == (-1, -1)
    speeds = {name: -3.0 * float(ratio) for name, ratio in train.ratios.items()}
    assert turning_senses(train.pairs, speeds) == [1, 1]
    behind = [GearedShafts("pinion", "ring", (20, -70)), GearedShafts("ring", "wheel", (30, 20))]
    assert turning_senses(behind, dict.fromkeys(("pinion", "ring", "wheel"), 0.0)) == [1, 1]


teeth = st.integers(12, 90)


@st.composite
def trains(draw: st.DrawFn) -> GearTrain:
    """Stages in a row: pairs, planetary sets with either member held, stepped planets, loops of planets."""
    pairs: list[GearedShafts] = []
    held: list[str] = []
    last = "input"
    for number in range(draw(st.integers(1, 3))):
        kind = draw(st.sampled_from(["pair", "idler", "set", "set", "stepped"]))
        if kind in ("pair", "idler"):
            names = [last, *(["idler " + str(number)] if kind == "idler" else []), f"shaft {number}"]
            counts = [draw(teeth) for _ in names]
            pairs += [GearedShafts(*ends, both) for ends, both in zip(pairwise(names), pairwise(counts), strict=True)]
            last = names[-1]
            continue
        name = f"{number} "
        inner, outer = draw(teeth), draw(teeth)
        steps = (outer, draw(teeth)) if kind == "stepped" else (outer, outer)
        ring, carrier = -(inner + 2 * outer), f"{name}carrier"
        for planet in range(draw(st.integers(1, 4))):
            shaft = f"{name}planet {planet}"
            pairs.append(GearedShafts(last, shaft, (inner, steps[0]), carrier))
            pairs.append(GearedShafts(shaft, f"{name}ring", (steps[1], ring), carrier))
        held.append(draw(st.sampled_from([f"{name}ring", carrier])))
        last = carrier if held[-1] != carrier else f"{name}ring"
    return train_of(pairs, held)


@given(trains(), st.sampled_from([70.0, -70.0]))
def test_random_trains_satisfy_every_row_and_balance(train: GearTrain, speed: float) -> None:
    """Speeds satisfy A ω = 0 exactly; torques balance on every shaft and do no work on the admissible speeds."""
    assert list(train.problems(list(train.ratios), [""] * len(train.pairs))) == []
    for pair in train.pairs:
        assert sum(value * train.ratios[shaft] for shaft, value in pair.row.items()) == 0
    assert all(train.ratios[name] == 0 for name in train.held)
    on = torques_on(train, 30.0, speed)
    for values in on.values():
        assert sum(values) == pytest.approx(0.0, abs=1e-12 * max(map(abs, values), default=1.0) * 100)
    applied = _applied(train, 30.0, speed)
    powers = [torque.value * speed * float(train.ratios[torque.rotor]) for torque in applied]  # type: ignore[attr-defined]
    assert sum(powers) == pytest.approx(0.0, abs=1e-12 * max(map(abs, powers)))
