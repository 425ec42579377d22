"""The lumped mass model against RAPPID, a commercial transfer-matrix program (ROSS validation notebook).

A shaft of 1.5 m × 50 mm in six segments, two discs of 280 mm × 70 mm at 0.5 and 1.0 m, bearings of 1e6 N/m in x
and 0.8e6 N/m in y at the ends, 500 rpm. Printed: the station table and eight frequencies to six digits.

The source does not print its shear coefficient. With κ = 3/4 (maximum over mean shear stress of a round
section), all eight frequencies agree to 2.2e-5, which one number could not do for four pairs if the model
differed otherwise; with Cowper's κ = 0.886 they agree to 1e-3.
"""

from collections.abc import Callable

import numpy as np
import pytest

from gearwhine.rotors import Bearing, Disc, Rotor, Segment, ShaftMaterial, solve_whirl
from gearwhine.rotors.model.shaft import station_inertias

SOURCE = "RAPPID, after the ROSS validation notebook"
REMARK = (
    "A lumped chain of seven stations. The density is taken from the plain station's mass. The shear coefficient κ is "
    "not printed; 3/4 was found by trying, and Cowper's 0.886 stands beside it."
)

# The table's plain station, 3.83395 kg, is 6e-5 above 7810 kg/m³ (the discs are not): the source's rounding.
STEEL = ShaftMaterial(211e9, 81.2e9, 3.83395 / (0.25 * np.pi / 4 * 0.05**2))
PRINTED_HZ = [14.6152, 15.3284, 43.3459, 46.9251, 105.902, 112.760, 150.907, 155.810]


def rotor(shear_coefficient: float | str) -> Rotor:
    discs = [Disc.from_dimensions(z, 0.07, 0.28, 0.05, 7810.0) for z in (0.5, 1.0)]
    segment = Segment(0.25, 0.05, 0.0, STEEL, shear_coefficient)  # type: ignore[arg-type]
    return Rotor("RAPPID", [segment] * 6, discs, mass_model="lumped")


def test_station_table(published: Callable[..., None]) -> None:
    shaft = rotor("cowper")
    table = station_inertias(shaft, shaft.stations)
    printed = {
        "end": (1.91697, 0.010284, 0.00059905),
        "plain": (3.83395, 0.020568, 0.0011981),
        "disc": (36.4237, 0.19866, 0.33076),
    }
    # The plain station's mass, from which the density is, is no result and makes no row.
    columns = (("mass", "kg"), ("diametral inertia", "kg m²"), ("polar inertia", "kg m²"))
    for (station, row), found in zip(printed.items(), table[:3], strict=True):
        for (column, unit), value, ours in zip(columns, row, found, strict=True):
            # Printed to five or six digits: half a unit of the last is at most 4e-5 of the value.
            if (station, column) != ("plain", "mass"):
                published(SOURCE, f"{station} station, {column}", value, ours, unit, rel=4e-5)
    plain, end, disc = (printed[station] for station in ("plain", "end", "disc"))
    np.testing.assert_allclose(table, [end, plain, disc, plain, disc, plain, end], rtol=4e-5)


@pytest.mark.parametrize(("shear_coefficient", "tolerance"), [(0.75, 3e-5), ("cowper", 1e-3)])
def test_whirl_at_500_rpm(
    shear_coefficient: float | str,
    tolerance: float,
    published: Callable[..., None],
    remark: Callable[[str, str], None],
) -> None:
    remark(SOURCE, REMARK)
    stiffness = np.diag([1e6, 0.8e6])
    bearings = [Bearing(name, z, stiffness, np.zeros((2, 2))) for name, z in (("left", 0.0), ("right", 1.5))]
    modes = solve_whirl(rotor(shear_coefficient), bearings, 500 * 2 * np.pi / 60, count=8)
    label = "κ after Cowper" if shear_coefficient == "cowper" else "κ = 3/4"
    for number, (value, ours) in enumerate(zip(PRINTED_HZ, modes.frequencies / (2 * np.pi), strict=True), start=1):
        published(SOURCE, f"lateral {number}, 500 rpm, {label}", value, ours, "Hz", rel=tolerance)
    assert modes.certificate.complete
