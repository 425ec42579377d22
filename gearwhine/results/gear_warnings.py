"""Warnings of gear geometry: teeth with a thin tip, or undercut; a backlash that the teeth do not leave."""

from coupling.gears import GearPairGeometry
from coupling.gears.errors import ThinTipError
from coupling.gears.geometry.gear import require_tip_thickness
from coupling.gears.loaded.gear_pair import GearPair


def geometry_warnings(pair: GearPair, geometry: GearPairGeometry) -> list[dict[str, str]]:
    """Warnings of what runs but is not as it should be."""
    found = []
    for gear in (geometry.driver, geometry.driven):
        try:
            require_tip_thickness(gear)
        except ThinTipError as error:
            found.append({"name": "thin tip", "message": str(error)})
        if gear.is_undercut:
            message = (
                f"gear {gear.name!r}: the teeth are undercut, their flanks begin at a diameter of "
                f"{2e3 * gear.form_radius:.6g} mm; a profile_shift of "
                f"{gear.least_generating_shift + gear.profile_shift - gear.generating_shift:.4g} avoids it"
            )
            found.append({"name": "undercut", "message": message})
    backlash = pair.backlash_warning(geometry)
    return found if backlash is None else [*found, {"name": "backlash", "message": backlash}]
