"""Changes of keys in cases with planets: those of all entries, and of gear pairs that a set implies."""

from pathlib import Path

import pytest

from gearwhine.case import CaseError
from gearwhine.case.load import bundled_case, load_case
from gearwhine.case.planetary import with_implied_pairs

NAME = "planetary-stage"
PAIRS = {("s", f"p {n}") for n in (1, 2, 3)} | {(f"p {n}", "r") for n in (1, 2, 3)}


@pytest.fixture(scope="module", params=[True, False], ids=["written", "implied"])
def source(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> str:
    """Case whose gear pairs are written once, and one whose set implies them."""
    if request.param:
        return NAME
    folder = tmp_path_factory.mktemp("implied")
    bundled = bundled_case(NAME)
    assert bundled is not None
    blocks = bundled.read_text(encoding="utf-8").split("\n\n")
    kept = [block for block in blocks if not block.lstrip().startswith("[[gear_pair]]")]
    assert len(kept) == len(blocks) - 2
    drawing = bundled_case(NAME)
    assert drawing is not None
    step = Path(str(drawing)).with_suffix(".step")
    text = "\n\n".join(kept).replace(f'"{NAME}.step"', f"'{step}'")
    path = folder / "implied.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_a_star_reaches_every_pair_of_the_planets(source: str) -> None:
    case = load_case(source, ["gear_pair.*.friction=0.07"]).case
    assert {(pair.driver, pair.driven) for pair in case.gear_pair} == PAIRS
    assert [pair.friction for pair in case.gear_pair] == [0.07] * 6


def test_a_pair_by_its_number_is_that_of_all_planets(source: str) -> None:
    case = load_case(source, ["gear_pair.1.friction=0.07"]).case
    frictions = {(pair.driver, pair.driven): pair.friction for pair in case.gear_pair}
    assert frictions.keys() == PAIRS
    assert {ends for ends, friction in frictions.items() if friction == 0.07} == {(f"p {n}", "r") for n in (1, 2, 3)}
    with pytest.raises(CaseError, match="a place from 0 to 1"):
        load_case(source, ["gear_pair.2.friction=0.07"])


def test_both_gears_of_a_stepped_planet_are_one_planet() -> None:
    gears = [{"name": name, "rotor": rotor} for name, rotor in (("s", "sun"), ("a", "p"), ("b", "p"), ("r", "ring"))]
    one = {"name": "set", "sun": "s", "planets": ["a", "b"], "ring": "r", "carrier": "c", "count": 3}
    document = with_implied_pairs({"gear": gears, "planetary": [one]})
    assert document["gear_pair"] == [{"driver": "s", "driven": "a"}, {"driver": "b", "driven": "r"}]
    assert document["planetary"] == [one]
    # Planets that are named each, on rotors of their own, are two.
    gears[2]["rotor"] = "q"
    document = with_implied_pairs({"gear": gears, "planetary": [{k: v for k, v in one.items() if k != "count"}]})
    ends = {(pair["driver"], pair["driven"]) for pair in document["gear_pair"]}
    assert ends == {("s", "a"), ("a", "r"), ("s", "b"), ("b", "r")}


def test_a_star_reaches_parts_of_planets_that_are_written_once() -> None:
    case = load_case(NAME, ["rotor.*.damping_ratio=0.03", "bearing.*.damping.xx=7e3 N*s/m"]).case
    assert [rotor.damping_ratio for rotor in case.rotor] == [0.03] * 6
    assert len(case.bearing) == 11
    assert {bearing.damping.xx for bearing in case.bearing if bearing.damping is not None} == {7e3}


def test_a_rim_follows_a_bore_that_has_orders_and_a_ring_in_it() -> None:
    for change, expected in (
        ('rotor.ring.rim_seat="nowhere"', r"ring_orders of 1 or more, one of .ring bore."),
        ('rotor.ring.rim_seat="back neck"', r"ring_orders of 1 or more"),
        ('rotor.sun.rim_seat="ring bore"', "no ring gear on this shaft"),
    ):
        with pytest.raises(CaseError, match=expected):
            load_case(NAME, [change])
    for orders, count in ((2, 1), (3, 0), (6, 0)):  # three planets bend the ring in three waves
        loaded = load_case(NAME, [f"housing.seat.ring bore.ring_orders={orders}"])
        assert sum("ring_orders of 3 or more, such as 6" in one for one in loaded.warnings) == count
    assert not [one for one in load_case(NAME).warnings if "rim_seat" in one]
    (told,) = [one for one in load_case(NAME, ["rotor.ring.rim_seat="]).warnings if "rim_seat" in one]
    assert 'gear[2].ring_support (gear "r")' in told


def test_a_rim_too_thick_for_its_sleeve_is_refused_with_the_thickest() -> None:
    """Root circle of 185 mm in a bore of 198 mm: half of the difference."""
    with pytest.raises(CaseError, match=r"leaves room for a rim of 6\.5 mm at most"):
        load_case(NAME, ['gear.r.rim="12 mm"'])
    load_case(NAME, ['gear.r.rim="6.5 mm"'])
