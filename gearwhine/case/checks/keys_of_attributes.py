"""Keys of a case for attributes of the library's parts, where they are not the same."""

from gearwhine.case.errors import Location
from gearwhine.case.gears import Gear

_OF_GEARS: dict[str, Location] = {
    "profile_deviation": ("errors", "profile"),
    "helix_deviation": ("errors", "helix"),
    "rim_thickness": ("rim",),
    "web_thickness": ("web",),
}


def key_in_gear(gear: Gear, attribute: str) -> Location:
    """Return the key of a gear's attribute."""
    first, *rest = attribute.split(".")
    if first == "eccentricity":
        return ("errors", "eccentricity" if gear.errors.eccentricity else "runout")
    if first == "pitch_deviations":
        return ("errors", "spacing" if gear.errors.spacing else "pitch")
    if first == "module" and gear.module is None:
        return ("diametral_pitch" if gear.diametral_pitch is not None else "base_radius",)
    return (*_OF_GEARS.get(first, (first,)), *rest)
