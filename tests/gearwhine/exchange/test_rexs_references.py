"""Parts of a REXS file that refer to each other in another way than usual, and the components that notes are about."""

import pytest
from rexs_files import RexsFile, Values, helical_stage, planetary_stage

from gearwhine.exchange.rexs import ImportedCase, case_of, read_content


def imported(file: RexsFile) -> ImportedCase:
    return case_of(read_content(file.xml()), "unit.rexs", "")


def test_flanks_that_gears_refer_to_are_those_of_their_sides() -> None:
    file, sides = helical_stage(), imported(helical_stage())
    for relation in file.relations:
        if relation["type"] == "flank":
            roles = dict(relation["roles"])
            relation |= {"type": "reference", "roles": [("origin", roles["gear"]), ("referenced", roles["left"])]}
    found = imported(file)
    assert found.document["gear"] == sides.document["gear"]
    assert "tip_relief" in found.document["gear"][0]


def test_a_gear_that_a_coupling_holds_stands_on_the_shaft_of_the_coupling() -> None:
    file, expected = helical_stage(), imported(helical_stage()).document
    wheel, output = file.number("wheel"), file.number("output")
    file.relations = [one for one in file.relations if one["roles"] != [("assembly", output), ("part", wheel)]]
    del file.of(wheel)["u_coordinate_on_shaft"]
    key = file.add("coupling", "key", u_coordinate_on_shaft_inner_side=(45.0, "mm"))
    file.relate("side", assembly=key, inner_part=output, outer_part=wheel)
    assert imported(file).document["gear"] == expected["gear"]


def test_rows_of_numbers_stay_rows() -> None:
    rows = ((1.5, 2.5), (3.5, 4.5, 5.5))
    cells = "".join(f"<array>{''.join(f'<c>{number}</c>' for number in row)}</array>" for row in rows)
    attribute = f'<attribute id="table" unit="mm"><array_of_arrays>{cells}</array_of_arrays></attribute>'
    text = helical_stage().xml().decode()
    at = text.index("</component>")
    found = read_content((text[:at] + attribute + text[at:]).encode())
    value = found.components[1].attributes["table"].value
    assert tuple(tuple(map(float, row)) for row in value) == rows


def test_teeth_without_a_pressure_angle_have_twenty_degrees() -> None:
    file, expected = helical_stage(), imported(helical_stage())
    for component in file.components:
        component["attributes"].pop("normal_pressure_angle", None)
    found = imported(file)
    assert found.document["gear"] == expected.document["gear"]
    assumed = [str(note) for note in found.notes if note not in tuple(expected.notes)]
    assert len(assumed) == 2
    assert all(text.endswith("no normal_pressure_angle: 20 degrees") for text in assumed)


def test_a_brake_on_the_carrier_makes_it_the_fixed_member() -> None:
    """The ring then turns against the sun, by their teeth alone."""
    file = planetary_stage()
    brake, carrier, ring, load = (file.number(name) for name in ("brake", "carrier shaft", "ring shaft", "machine"))
    places = {
        (("assembly", brake), ("inner_part", ring), ("outer_part", 2)): ("inner_part", carrier),
        (("assembly", carrier), ("part", load)): ("assembly", ring),
    }
    for relation in file.relations:
        if (place := places.get(tuple(relation["roles"]))) is not None:
            relation["roles"] = [(role, place[1] if role == place[0] else number) for role, number in relation["roles"]]
    file.of(load)["u_coordinate_on_shaft"] = (20.0, "mm")
    document = imported(file).document
    assert document["planetary"][0]["fixed"]["member"] == document["planetary"][0]["carrier"]


def test_the_load_case_that_is_taken_is_told_where_none_is_chosen() -> None:
    told = {
        choice: [note.text for note in case_of(read_content(helical_stage().xml()), "unit.rexs", choice).notes]
        for choice in ("", "1", "2")
    }
    assumed = [text for text in told[""] if text.startswith("2 load cases: the first, load case 1")]
    assert len(assumed) == 1
    assert not [text for choice in ("1", "2") for text in told[choice] if "load cases: the first" in text]


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ({}, "no sense of its thrust"),
        (
            {"number_of_bearing_rows": (2, "none"), "distance_between_bearing_rows": (8.0, "mm")},
            "its two rows stand back to back",
        ),
    ],
)
def test_a_note_is_about_a_component_and_its_text_about_a_value(rows: Values, words: str) -> None:
    file = helical_stage()
    bearing = file.named("6205")
    bearing |= rows | {"bearing_type": ("angular_contact_ball_bearing", "none")}
    del bearing["axial_force_absorption"]
    made = next(one for one in imported(file).document["bearing"] if one["name"] == "6205")
    taken = {key: value for key, value in made["stiffness"]["rolling"].items() if key in ("arrangement", "carries")}
    assert taken == ({"arrangement": "back to back"} if rows else {"carries": "+z"})
    (assumed,) = [note for note in imported(file).notes if words in str(note)]
    about = f'rolling_bearing_with_catalog_geometry {file.number("6205")} "6205"'
    assert (assumed.about, assumed.at[:1]) == (about, ("bearing",))
    for other in (file, planetary_stage()):
        labels = tuple(component.label for component in read_content(other.xml()).components.values())
        assert not [note for note in imported(other).notes if note.text.startswith(labels)]
