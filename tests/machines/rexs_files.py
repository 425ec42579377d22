"""REXS files of small gear units, made for tests: a helical stage with a load spectrum, and a planetary stage."""

import base64
import io
import json
import math
import struct
import zipfile
from dataclasses import dataclass, field
from typing import Any
from xml.sax.saxutils import escape, quoteattr

Values = dict[str, tuple[Any, str]]
"""Value and unit of each attribute by name."""


@dataclass
class RexsFile:
    """A file as lists that tests change: components, relations and load cases."""

    version: str = "1.4"
    components: list[dict[str, Any]] = field(default_factory=list)
    relations: list[dict[str, Any]] = field(default_factory=list)
    load_cases: list[dict[int, Values]] = field(default_factory=list)

    def add(self, kind: str, name: str = "", **attributes: tuple[Any, str]) -> int:
        """Add a component; return its number."""
        number = len(self.components) + 1
        self.components.append({"id": number, "type": kind, "name": name, "attributes": dict(attributes)})
        return number

    def relate(self, kind: str, **roles: int) -> None:
        """Add a relation."""
        self.relations.append({"id": len(self.relations) + 1, "type": kind, "roles": list(roles.items())})

    def of(self, number: int) -> Values:
        """Attributes of a component."""
        return self.components[number - 1]["attributes"]  # type: ignore[no-any-return]

    def named(self, name: str) -> Values:
        """Attributes of the component of a name."""
        return next(one["attributes"] for one in self.components if one["name"] == name)  # type: ignore[no-any-return]

    def number(self, name: str) -> int:
        """Number of the component of a name."""
        return next(one["id"] for one in self.components if one["name"] == name)  # type: ignore[no-any-return]

    def part(self, kind: str, of: int, name: str = "", **attributes: tuple[Any, str]) -> int:
        """Add a component that is a part of another one."""
        number = self.add(kind, name, **attributes)
        self.relate("assembly", assembly=of, part=number)
        return number

    def xml(self, *, coded: bool = False) -> bytes:
        """The file in XML, lists coded where that is asked for."""
        lines = [
            '<?xml version="1.0" encoding="UTF-8"?>',
            f'<model version="{self.version}" applicationId="Test" applicationVersion="1.2" date="2024-05-06">',
            "<relations>",
        ]
        kinds = {one["id"]: one["type"] for one in self.components}
        for relation in self.relations:
            lines.append(f'<relation id="{relation["id"]}" type="{relation["type"]}">')
            lines += [
                f'<ref id="{number}" role="{role}" hint="{kinds.get(number, "")}"/>'
                for role, number in relation["roles"]
            ]
            lines.append("</relation>")
        lines += ["</relations>", "<components>"]
        for one in self.components:
            lines += _xml_component(one, coded)
        lines.append("</components>")
        if self.load_cases:
            lines.append('<load_spectrum id="1">')
            for place, changes in enumerate(self.load_cases):
                lines.append(f'<load_case id="{place + 1}">')
                for number, attributes in changes.items():
                    lines += _xml_component({**self.components[number - 1], "attributes": attributes}, coded)
                lines.append("</load_case>")
            lines.append("</load_spectrum>")
        lines.append("</model>")
        return "\n".join(lines).encode()

    def json(self, *, coded: bool = False) -> bytes:
        """The file in JSON."""
        relations = [
            {
                "id": one["id"],
                "type": one["type"],
                "refs": [{"id": number, "role": role} for role, number in one["roles"]],
            }
            for one in self.relations
        ]
        model: dict[str, Any] = {
            "version": self.version,
            "applicationId": "Test",
            "applicationVersion": "1.2",
            "date": "2024-05-06",
            "relations": relations,
            "components": [_json_component(one, coded) for one in self.components],
        }
        if self.load_cases:
            cases = [
                {
                    "id": place + 1,
                    "components": [
                        _json_component({**self.components[number - 1], "attributes": attributes}, coded)
                        for number, attributes in changes.items()
                    ],
                }
                for place, changes in enumerate(self.load_cases)
            ]
            model["load_spectrum"] = {"id": 1, "load_cases": cases}
        return json.dumps({"model": model}).encode()

    def zip(self, name: str = "unit.rexs") -> bytes:
        """The file in an archive, beside another one."""
        return archive({name: self.json() if name.endswith("j") else self.xml(), "readme.txt": b"a gear unit"})


def archive(members: dict[str, bytes]) -> bytes:
    """Return a zip archive."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as file:
        for name, text in members.items():
            file.writestr(name, text)
    return content.getvalue()


def _code(values: Any) -> str:
    return base64.b64encode(struct.pack(f"<{len(values)}d", *values)).decode()


def _xml_component(one: dict[str, Any], coded: bool) -> list[str]:
    lines = [f'<component id="{one["id"]}" type="{one["type"]}" name={quoteattr(one["name"])}>']
    for name, (value, unit) in one["attributes"].items():
        if isinstance(value, bool):
            text = "true" if value else "false"
        elif isinstance(value, list) and coded and not any(isinstance(entry, bool) for entry in value):
            text = f'<array code="float64">{_code(value)}</array>'
        elif isinstance(value, list) and value and isinstance(value[0], list):
            rows = "".join("<r>" + "".join(f"<c>{entry!r}</c>" for entry in row) + "</r>" for row in value)
            text = f"<matrix>{rows}</matrix>"
        elif isinstance(value, list):
            text = "<array>" + "".join(f"<c>{str(entry).lower()}</c>" for entry in value) + "</array>"
        else:
            text = escape(str(value))
        lines.append(f'<attribute id="{name}" unit="{unit}">{text}</attribute>')
    return [*lines, "</component>"]


def _json_component(one: dict[str, Any], coded: bool) -> dict[str, Any]:
    attributes = []
    for name, (value, unit) in one["attributes"].items():
        kinds = {bool: "boolean", str: "string", int: "integer", float: "floating_point"}
        if isinstance(value, list):
            flags = any(isinstance(entry, bool) for entry in value)
            kind = "boolean_array" if flags else "floating_point_array"
            if coded and not flags:
                entry: Any = {"code": "float64", "value": _code(value)}
                attributes.append({"id": name, "unit": unit, f"{kind}_coded": entry})
                continue
        else:
            kind = kinds[type(value)]
        attributes.append({"id": name, "unit": unit, kind: value})
    return {"id": one["id"], "type": one["type"], "name": one["name"], "attributes": attributes}


def _at(u: float, v: float = 0.0, w: float = 0.0) -> Values:
    """Place of a component relative to the gear unit [mm]."""
    return {
        "support_vector": ([u, v, w], "mm"),
        "u_axis_vector": ([1.0, 0.0, 0.0], "mm"),
        "w_axis_vector": ([0.0, 0.0, 1.0], "mm"),
        "reference_component_for_position": (1, "none"),
    }


def _shaft(file: RexsFile, name: str, place: Values, sections: list[tuple[float, float, float]], **more: Any) -> int:
    """Add a shaft of sections of length, outer and inner diameter [mm], of the material number 3."""
    shaft = file.part("shaft", 1, name, **place, **more)
    begin = 0.0
    for length, outer, inner in sections:
        file.part(
            "shaft_section",
            shaft,
            u_coordinate_on_shaft=(begin, "mm"),
            length=(length, "mm"),
            outer_diameter_begin=(outer, "mm"),
            outer_diameter_end=(outer, "mm"),
            inner_diameter_begin=(inner, "mm"),
            inner_diameter_end=(inner, "mm"),
        )
        begin += length
    file.relate("reference", origin=shaft, referenced=3)
    return shaft


def _flank(file: RexsFile, gear: int, shift: float | None) -> int:
    """Add one flank for both sides of a gear."""
    shifted: Values = {} if shift is None else {"addendum_modification_coefficient": (shift, "none")}
    flank = file.add("cylindrical_gear_flank", normal_pressure_angle=(20.0, "deg"), **shifted)
    file.relate("flank", gear=gear, left=flank, right=flank)
    return flank


def _between(file: RexsFile, kind: str, name: str, inner: int, outer: int, **attributes: Any) -> int:
    """Add a bearing or a coupling between two parts."""
    number = file.add(kind, name, **attributes)
    file.relate("side", assembly=number, inner_part=inner, outer_part=outer)
    return number


def _unit(file: RexsFile) -> None:
    """Add gear unit 1, casing 2 and material 3."""
    unit = file.add("gear_unit", "small unit", **_at(0.0))
    file.part("gear_casing", unit, "casing")
    file.add(
        "material", "steel 1", elastic_modulus=(206e3, "MPa"), poisson_ratio=(0.3, "none"), density=(7.85, "kg / dm^3")
    )


POINTS = {
    "6205": (95.0, 0.0, 0.0),
    "front": (5.0, 0.0, 0.0),
    "NU 207": (12.0, 60.0, -80.0),
    "rear": (90.0, 60.0, -80.0),
}
"""Places of the bearings of the helical stage along u, v, w of the gear unit [mm]."""


def add_reduced_casing(file: RexsFile, matrix: list[list[float]], place: Values, **more: tuple[Any, str]) -> int:
    """Add a stiffness of the helical stage's casing, with a reduction point at each of its bearings."""
    attributes = {"reduced_static_stiffness_matrix": (matrix, "none")} | more
    group = file.add("assembly_group", "casing by finite elements", **place, **attributes)
    file.relate("reference", origin=2, referenced=group)
    for bearing, (u, v, w) in POINTS.items():
        point = file.add("reduction_point", f"at {bearing}", **_at(u, v, w))
        file.relate("ordered_assembly", assembly=group, part=point)
        file.relate("reference", origin=point, referenced=file.number(bearing))
    return group


HELIX = math.radians(15.0)
CENTRE_DISTANCE = 100.0
"""Centre distance [mm] of 20 and 59 teeth of normal module 2.4 mm at a helix angle of 15 degrees."""


def helical_stage() -> RexsFile:
    """Return a stage of 20 : 59 teeth, with four bearings, a force on the input and two load cases."""
    file = RexsFile()
    _unit(file)
    pinion_shaft = _shaft(
        file,
        "input",
        _at(-10.0),
        [(30.0, 24.0, 0.0), (60.0, 30.0, 0.0), (30.0, 25.0, 0.0)],
        rotational_speed=(1500.0, "1 / min"),
        defines_speed=(True, "none"),
    )
    wheel_shaft = _shaft(file, "output", _at(0.0, 60.0, -80.0), [(25.0, 35.0, 10.0), (75.0, 45.0, 10.0)])
    gear = {"normal_module": (2.4, "mm"), "face_width": (30.0, "mm")}
    pinion = file.part(
        "cylindrical_gear",
        pinion_shaft,
        "pinion",
        u_coordinate_on_shaft=(55.0, "mm"),
        number_of_teeth=(20, "none"),
        helix_angle_reference_diameter=(-15.0, "deg"),
        tip_diameter=(55.6, "mm"),
        root_diameter=(44.8, "mm"),
        **gear,
    )
    wheel = file.part(
        "cylindrical_gear",
        wheel_shaft,
        "wheel",
        u_coordinate_on_shaft=(45.0, "mm"),
        number_of_teeth=(59, "none"),
        helix_angle_reference_diameter=(15.0, "deg"),
        tip_diameter=(152.2, "mm"),
        root_diameter=(141.4, "mm"),
        inner_diameter=(45.0, "mm"),
        upper_backlash_allowance_referenced_to_span=(-40.0, "mum"),
        lower_backlash_allowance_referenced_to_span=(-60.0, "mum"),
        **gear,
    )
    flank = _flank(file, pinion, 0.3)
    relief = file.add(
        "tip_relief",
        "relief",
        tip_relief_depth=(0.012, "mm"),
        tip_relief_datum_diameter=(54.0, "mm"),
        shape_of_relief=("linear", "none"),
    )
    crowning = file.add(
        "helix_crowning",
        helix_crowning_amount_datum_face=(0.004, "mm"),
        helix_crowning_amount_non_datum_face=(0.004, "mm"),
    )
    for modification in (relief, crowning):
        file.relate("reference", origin=flank, referenced=modification)
    _flank(file, wheel, None)
    stage = file.part("cylindrical_stage", 1, "stage", center_distance=(CENTRE_DISTANCE, "mm"))
    file.relate("stage", stage=stage, gear_1=pinion, gear_2=wheel)
    spring = {"radial_stiffness": (3e8, "N / m"), "radial_force_absorption": (True, "none")}
    _between(
        file,
        "rolling_bearing_with_catalog_geometry",
        "6205",
        pinion_shaft,
        2,
        u_coordinate_on_shaft_inner_side=(105.0, "mm"),
        bearing_type=("radial_grooved_ball_bearing", "none"),
        inner_diameter=(25.0, "mm"),
        outer_diameter=(52.0, "mm"),
        width=(15.0, "mm"),
        radial_dynamic_load_rating=(14.8, "kN"),
        radial_static_load_rating=(7.8, "kN"),
        operating_radial_bearing_clearance=(10.0, "mum"),
        axial_force_absorption=("both_directions", "none"),
    )
    _between(
        file,
        "concept_bearing",
        "front",
        pinion_shaft,
        2,
        u_coordinate_on_shaft_inner_side=(15.0, "mm"),
        axial_force_absorption=("no_direction", "none"),
        **spring,
    )
    rows = _between(
        file,
        "rolling_bearing_with_detailed_geometry",
        "NU 207",
        wheel_shaft,
        2,
        u_coordinate_on_shaft_inner_side=(12.0, "mm"),
        bearing_type=("radial_roller_bearing", "none"),
    )
    row = file.add("rolling_bearing_row", number_of_rolling_elements=(14, "none"), reference_diameter=(54.0, "mm"))
    file.relate("ordered_assembly", assembly=rows, part=row)
    element = file.add(
        "rolling_element", diameter_of_rolling_element=(9.0, "mm"), length_of_rolling_element=(9.0, "mm")
    )
    file.relate("ordered_assembly", assembly=row, part=element)
    _between(
        file,
        "concept_bearing",
        "rear",
        wheel_shaft,
        2,
        u_coordinate_on_shaft_inner_side=(90.0, "mm"),
        axial_force_absorption=("both_directions", "none"),
        axial_stiffness=(1e8, "N / m"),
        **spring,
    )
    motor = file.part(
        "external_load",
        pinion_shaft,
        "motor",
        u_coordinate_on_shaft=(0.0, "mm"),
        defines_torque=(True, "none"),
        transmits_torque=(True, "none"),
        torque_around_u_axis=(60.0, "N m"),
        force_v_direction=(250.0, "N"),
    )
    file.part(
        "external_load", wheel_shaft, "machine", u_coordinate_on_shaft=(100.0, "mm"), transmits_torque=(True, "none")
    )
    oil = file.add("lubricant", "oil", viscosity_at_40_degree_celsius=(100.0, "mm^2 / s"))
    file.relate("reference", origin=2, referenced=oil)
    file.load_cases = [
        {
            1: {"operating_time_fraction": (70.0, "%")},
            pinion_shaft: {"rotational_speed": (1200.0, "1 / min")},
            motor: {"torque_around_u_axis": (80.0, "N m")},
        },
        {
            1: {"operating_time_fraction": (30.0, "%")},
            pinion_shaft: {"rotational_speed": (1800.0, "1 / min")},
            motor: {"torque_around_u_axis": (40.0, "N m")},
        },
    ]
    return file


SUN, PLANET, RING = 24, 30, 84


def planetary_stage() -> RexsFile:
    """Return a stage of three planets between sun and held ring, its carrier of two plates."""
    file = RexsFile("1.7")
    _unit(file)
    module, distance = 2.0, 54.0
    sun_shaft = _shaft(
        file,
        "sun shaft",
        _at(-80.0),
        [(130.0, 30.0, 0.0)],
        rotational_speed=(-900.0, "1 / min"),
        defines_speed=(True, "none"),
    )
    ring_shaft = _shaft(file, "ring shaft", _at(0.0), [(40.0, 210.0, 190.0)])
    stage = file.part("planetary_stage", 1, "set")
    carrier = file.part("planet_carrier", stage, "carrier")
    plates = [
        file.part(
            "side_plate",
            carrier,
            f"plate {place}",
            length=(10.0, "mm"),
            inner_diameter=(inner, "mm"),
            outer_diameter=(150.0, "mm"),
            **_at(place),
        )
        for place, inner in ((-10.0, 40.0), (40.0, 0.0))
    ]
    carrier_shaft = _shaft(file, "carrier shaft", _at(50.0), [(80.0, 60.0, 0.0)])
    file.relate("assembly", assembly=carrier, part=carrier_shaft)
    rigid = {
        "radial_stiffness": (1e20, "N / m"),
        "axial_stiffness": (1e20, "N / m"),
        "bending_stiffness": (1e20, "N mm / rad"),
        "rotational_stiffness": (1e20, "N mm / rad"),
    }
    _between(file, "coupling", "fit", carrier_shaft, plates[1], **rigid)
    face = {"normal_module": (module, "mm"), "face_width": (38.0, "mm"), "u_coordinate_on_shaft": (20.0, "mm")}
    sun = file.part("cylindrical_gear", sun_shaft, "sun", number_of_teeth=(SUN, "none"), **face)
    file.of(sun)["u_coordinate_on_shaft"] = (100.0, "mm")
    _flank(file, sun, 0.0)
    ring = file.part("ring_gear", ring_shaft, "ring", number_of_teeth=(RING, "none"), **face)
    file.of(ring)["tip_diameter"] = (164.6, "mm")
    _flank(file, ring, 0.0)
    spring = {"radial_stiffness": (2e8, "N / m")}
    for place in range(3):
        angle = 2.0 * math.pi * place / 3.0
        v, w = distance * math.sin(angle), distance * math.cos(angle)
        shaft = _shaft(file, f"planet shaft {place + 1}", _at(0.0, v, w), [(40.0, 50.0, 40.0)])
        pin = _shaft(file, f"pin {place + 1}", _at(-10.0, v, w), [(60.0, 25.0, 0.0)])
        file.relate("assembly", assembly=carrier, part=pin)
        file.relate("planet_shaft", planetary_stage=stage, shaft=shaft)
        file.relate("planet_pin", planetary_stage=stage, shaft=pin)
        for plate in plates:
            _between(file, "coupling", f"seat {place + 1} in {plate}", pin, plate, **rigid)
        gear = file.part("cylindrical_gear", shaft, f"planet {place + 1}", number_of_teeth=(PLANET, "none"), **face)
        _flank(file, gear, 0.0)
        for at, absorbs in ((10.0, "both_directions"), (30.0, "no_direction")):
            _between(
                file,
                "concept_bearing",
                f"pin bearing {place + 1} at {at:g}",
                pin,
                shaft,
                u_coordinate_on_shaft_inner_side=(at + 10.0, "mm"),
                u_coordinate_on_shaft_outer_side=(at, "mm"),
                axial_force_absorption=(absorbs, "none"),
                axial_stiffness=(5e7, "N / m"),
                **spring,
            )
        for first, second in ((sun, gear), (gear, ring)):
            mesh = file.part("cylindrical_stage", stage, f"mesh {first} {second}", center_distance=(distance, "mm"))
            file.relate("stage", stage=mesh, gear_1=first, gear_2=second)
    for shaft in (sun_shaft, ring_shaft):
        file.relate("central_shaft", planetary_stage=stage, shaft=shaft)
    file.relate("planet_carrier_shaft", planetary_stage=stage, shaft=carrier_shaft)
    _between(
        file,
        "switchable_coupling",
        "brake",
        ring_shaft,
        2,
        u_coordinate_on_shaft_inner_side=(20.0, "mm"),
        is_engaged=([True], "none"),
        **rigid,
    )
    for name, shaft, places in (("sun", sun_shaft, (20.0, 50.0)), ("carrier", carrier_shaft, (20.0, 60.0))):
        for at in places:
            _between(
                file,
                "concept_bearing",
                f"{name} bearing {at:g}",
                shaft,
                2,
                u_coordinate_on_shaft_inner_side=(at, "mm"),
                axial_force_absorption=("both_directions" if at == places[0] else "no_direction", "none"),
                axial_stiffness=(1e8, "N / m"),
                **spring,
            )
    file.part(
        "external_load",
        sun_shaft,
        "motor",
        u_coordinate_on_shaft=(0.0, "mm"),
        power=(10.0, "kW"),
        defines_torque=(True, "none"),
        transmits_torque=(True, "none"),
    )
    file.part(
        "external_load", carrier_shaft, "machine", u_coordinate_on_shaft=(80.0, "mm"), transmits_torque=(True, "none")
    )
    return file
