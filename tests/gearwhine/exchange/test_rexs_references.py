"""Parts of a REXS file that refer to each other in another way than usual, and the components that notes are about."""

from rexs_files import RexsFile, helical_stage, planetary_stage

from gearwhine.case import parse_case
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


def test_a_note_is_about_a_component_and_its_text_about_a_value() -> None:
    file = helical_stage()
    file.named("6205")["bearing_type"] = ("angular_contact_ball_bearing", "none")
    del file.named("6205")["axial_force_absorption"]
    bearing = next(one for one in parse_case(imported(file).document).bearing if one.name == "6205")
    assert bearing.stiffness.rolling.carries == "+z"  # type: ignore[union-attr]
    (assumed,) = [note for note in imported(file).notes if "no sense of its thrust" in str(note)]
    assert (assumed.about, assumed.at[:1]) == (
        f'rolling_bearing_with_catalog_geometry {file.number("6205")} "6205"',
        ("bearing",),
    )
    for other in (file, planetary_stage()):
        components = read_content(other.xml()).components
        labels = tuple(component.label for component in components.values())
        for note in imported(other).notes:
            assert not note.text.startswith(labels), note
