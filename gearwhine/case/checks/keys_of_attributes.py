"""Findings of the library's parts at the keys of a case, for attributes of the same name and of others."""

from gearwhine.case.errors import LOOK_UP, UNSAID, Finding, Location
from gearwhine.case.gears import Gear
from gearwhine.numerics.findings import Finding as PartFinding


def steps_of(attribute: str) -> Location:
    """Return the keys that a dotted attribute names, entries of lists by their numbers."""
    return tuple(int(step) if step.isdecimal() else step for step in attribute.split(".") if step)


def placed(entry: Location, finding: PartFinding, key: Location | None = None) -> Finding:
    """Return a finding of a part at its entry of the case, at the key of its attribute or another one.

    One without a value is of the entry's relation to others.
    """
    return Finding(
        (*entry, *(steps_of(finding.attribute) if key is None else key)),
        finding.expected,
        UNSAID if finding.value is None else LOOK_UP,
        warns=finding.severity == "warning",
    )


_OF_GEARS: dict[str, Location] = {
    "profile_deviation": ("errors", "profile"),
    "helix_deviation": ("errors", "helix"),
    "rim_thickness": ("rim",),
    "web_thickness": ("web",),
    "faults": ("fault",),
}


def key_in_gear(gear: Gear, attribute: str) -> Location:
    """Return the key of a gear's attribute."""
    first, *rest = steps_of(attribute)
    if first == "eccentricity":
        return ("errors", "eccentricity" if gear.errors.eccentricity else "runout")
    if first == "pitch_deviations":
        return ("errors", "spacing" if gear.errors.spacing else "pitch")
    if first == "module" and gear.module is None:
        return ("diametral_pitch" if gear.diametral_pitch is not None else "base_radius",)
    return (*_OF_GEARS.get(str(first), (first,)), *rest)
