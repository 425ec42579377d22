"""Rolling bearings by their geometry: loads of the elements and tangent stiffness under a load.

    row = BallRow(count=7, ball_diameter=11.5e-3, pitch_diameter=43.5e-3)
    state = rolling_equilibrium(RollingBearing([row]), [1000.0, 0.0, 0.0, 0.0, 0.0])
    bearing = linearised_bearing(state, "drive end", at=0.02)

A state carries the displacement, the 5x5 tangent stiffness, each element's load, contact angles and pressures, and the
residual of its equilibrium. `RollingElements` is the energy of the elements at any displacement, with reaction and
tangent, for the equilibrium of a whole machine; `rolling_state` is the state at a displacement found so.
`catalogue_row` estimates a row from bore, outer diameter and width; `paired` sets two against each other. Coordinates
are x, y, z and the rotations about x and y of the inner ring against the outer.
"""

from gearwhine.rotors.rolling_bearings.catalogue import bearing_of_row, catalogue_bearing, catalogue_row, standing_rows
from gearwhine.rotors.rolling_bearings.clearance import OperatingClearance, RingFit, operating_clearance, thermal_offset
from gearwhine.rotors.rolling_bearings.element_contacts import ElementLoads
from gearwhine.rotors.rolling_bearings.equilibrium import (
    COORDINATES,
    ROLLING_DAMPING_TIME,
    RollingElements,
    RollingState,
    linearised_bearing,
    rolling_equilibrium,
    rolling_state,
)
from gearwhine.rotors.rolling_bearings.frequencies import (
    CharacteristicFrequencies,
    characteristic_frequencies,
    frequencies_in_seat,
    pressed_azimuth,
)
from gearwhine.rotors.rolling_bearings.hertz import STEEL, ContactElasticity, point_contact
from gearwhine.rotors.rolling_bearings.ratings import Row, dynamic_rating, static_rating
from gearwhine.rotors.rolling_bearings.roller_rows import RollerRow, SphericalRollerRow, TaperedRollerRow
from gearwhine.rotors.rolling_bearings.rolling_bearing import RollingBearing, paired, preload_offset
from gearwhine.rotors.rolling_bearings.rows import BallRow, FourPointRow, spherical_groove
from gearwhine.rotors.rolling_bearings.slip import NO_SLIP, CageSlip
from gearwhine.rotors.rolling_bearings.spalls import (
    BearingDamage,
    CageFault,
    RollingSpall,
    SpallContact,
    require_possible,
    spall_contacts,
)

__all__ = [
    "COORDINATES",
    "NO_SLIP",
    "ROLLING_DAMPING_TIME",
    "STEEL",
    "BallRow",
    "BearingDamage",
    "CageFault",
    "CageSlip",
    "CharacteristicFrequencies",
    "ContactElasticity",
    "ElementLoads",
    "FourPointRow",
    "OperatingClearance",
    "RingFit",
    "RollerRow",
    "RollingBearing",
    "RollingElements",
    "RollingSpall",
    "RollingState",
    "Row",
    "SpallContact",
    "SphericalRollerRow",
    "TaperedRollerRow",
    "bearing_of_row",
    "catalogue_bearing",
    "catalogue_row",
    "characteristic_frequencies",
    "dynamic_rating",
    "frequencies_in_seat",
    "linearised_bearing",
    "operating_clearance",
    "paired",
    "point_contact",
    "preload_offset",
    "pressed_azimuth",
    "require_possible",
    "rolling_equilibrium",
    "rolling_state",
    "spall_contacts",
    "spherical_groove",
    "standing_rows",
    "static_rating",
    "thermal_offset",
]
