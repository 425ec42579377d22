"""Operating clearance of a rolling bearing: its change by interference fits and temperatures, and axial thermal growth.

Rings, shaft and housing are thick rings in plane stress (Lamé; Harris and Kotzalas, Rolling Bearing Analysis, 5th ed.,
Essential Concepts, chapter 3). With the interference I on the diameter d, the ring between d and D₁ around, and the
ring between D₂ and d inside, the pressure in the fit is

    p = (I / d) / { [(D₁² + d²)/(D₁² − d²) + ν₁]/E₁ + [(d² + D₂²)/(d² − D₂²) − ν₂]/E₂ }

and a ring between b and c > b grows at its free surface, under p inside or outside, by

    Δc = 2 p b² c / [E (c² − b²)]   (p at b),     Δb = −2 p c² b / [E (c² − b²)]   (p at c).

The ends of the rings are free and their raceways count as cylinders. I is that of the cold parts, less the asperities
that mounting smooths, and changes with the temperatures on either side of the fit; a fit that has opened carries
nothing. Heat changes the clearance by α (d_o ΔT_o − d_i ΔT_i − 2 D ΔT_D), d_i and d_o the raceways' diameters. Growth
of rings by rotation is left out.
"""

import math
from dataclasses import dataclass

from gearwhine.rotors.errors import require, require_finite
from gearwhine.rotors.rolling_bearings.hertz import STEEL, ContactElasticity

_STEEL_EXPANSION = 11.7e-6


@dataclass(frozen=True)
class RingFit:
    """Fit of a ring on its shaft or in its housing.

    Parameters
    ----------
    interference : float
        Diametral interference of the cold parts [m]; negative is a gap.
    free_diameter : float
        Diameter of the partner's other surface [m]: the bore of a hollow shaft, 0 if it is solid; the outer diameter of
        the housing, infinite if it is thick.
    smoothing : float
        Part of the interference that the asperities take [m].
    modulus, poisson_ratio, expansion : float
        Young's modulus [Pa], Poisson's ratio and thermal expansion [1/K] of the partner; steel unless given.
    temperature_rise : float
        Temperature of the partner over the one at which the sizes hold [K].

    Raises
    ------
    RotorError
        A number that is not finite, a negative smoothing, or a modulus that is not positive.
    """

    interference: float = 0.0
    free_diameter: float = 0.0
    smoothing: float = 0.0
    modulus: float = 210e9
    poisson_ratio: float = 0.3
    expansion: float = _STEEL_EXPANSION
    temperature_rise: float = 0.0

    def __post_init__(self) -> None:
        """Check that numbers are finite and admissible."""
        for attribute in ("interference", "expansion", "temperature_rise"):
            require_finite(f"{attribute.replace('_', ' ')} of a fit", getattr(self, attribute))
        require_finite("smoothing of a fit", self.smoothing, minimum=0.0)
        require_finite("modulus of a fit's partner", self.modulus, positive=True)
        within = -1.0 < self.poisson_ratio <= 0.5
        require(within, "Poisson's ratio of a fit's partner", self.poisson_ratio, "a number above -1 and at most 0.5")
        require(self.free_diameter >= 0.0, "free diameter of a fit's partner", self.free_diameter, "0 m or more")


@dataclass(frozen=True)
class OperatingClearance:
    """Diametral clearance in operation and what changes it [m].

    Attributes
    ----------
    clearance : float
        Clearance in operation; negative is an interference.
    by_inner_fit, by_outer_fit, by_heat : float
        Changes of the clearance by the fits on shaft and in housing, and by the expansion of rings and elements.
    inner_pressure, outer_pressure : float
        Pressures in the fits [Pa].
    """

    clearance: float
    by_inner_fit: float
    by_outer_fit: float
    by_heat: float
    inner_pressure: float
    outer_pressure: float


def operating_clearance(
    clearance: float,
    bore: float,
    inner_raceway: float,
    outer_raceway: float,
    outer_diameter: float,
    *,
    shaft: RingFit | None = None,
    housing: RingFit | None = None,
    inner_rise: float = 0.0,
    outer_rise: float = 0.0,
    element_rise: float | None = None,
    expansion: float = _STEEL_EXPANSION,
    elasticity: ContactElasticity = STEEL,
) -> OperatingClearance:
    """Diametral clearance of a mounted bearing at its temperatures.

    Parameters
    ----------
    clearance : float
        Diametral clearance before mounting [m].
    bore, inner_raceway, outer_raceway, outer_diameter : float
        Diameters of the rings' surfaces, ascending [m].
    shaft, housing : RingFit, optional
        Fits; None where the ring is loose. A housing's ``free_diameter`` of 0 is read as infinite.
    inner_rise, outer_rise, element_rise : float, float, float, optional
        Temperatures of the rings and of the elements over the one at which the sizes hold [K]; the elements have the
        mean of the rings where none is given.
    expansion, elasticity : float, ContactElasticity
        Thermal expansion [1/K] and elasticity of rings and elements; steel unless given.

    Raises
    ------
    RotorError
        Diameters that do not ascend, or a shaft's bore or housing that does not leave a ring.
    """
    require_finite("clearance", clearance)
    sizes = (bore, inner_raceway, outer_raceway, outer_diameter)
    ascending = all(math.isfinite(size) for size in sizes) and 0.0 < bore < inner_raceway < outer_raceway
    require(
        ascending and outer_raceway < outer_diameter,
        "diameters of a bearing",
        sizes,
        "bore, inner raceway, outer raceway and outer diameter, ascending, m",
    )
    for label, rise in (("inner ring", inner_rise), ("outer ring", outer_rise)):
        require_finite(f"temperature rise of the {label}", rise)
    modulus, ratio = elasticity.ring_modulus, elasticity.ring_poisson_ratio

    inner_pressure = outer_pressure = 0.0
    if shaft is not None:
        require(shaft.free_diameter < bore, "bore of the shaft", shaft.free_diameter, f"less than {bore:g} m")
        warmed = bore * (shaft.expansion * shaft.temperature_rise - expansion * inner_rise)
        around = _ring_compliance(bore, inner_raceway, ratio, modulus)
        inside = _ring_compliance(bore, shaft.free_diameter, -shaft.poisson_ratio, shaft.modulus)
        inner_pressure = max(shaft.interference - shaft.smoothing + warmed, 0.0) / bore / (around + inside)
    if housing is not None:
        free = housing.free_diameter or math.inf
        require(free > outer_diameter, "outer diameter of the housing", free, f"more than {outer_diameter:g} m")
        warmed = outer_diameter * (expansion * outer_rise - housing.expansion * housing.temperature_rise)
        around = _ring_compliance(outer_diameter, free, housing.poisson_ratio, housing.modulus)
        inside = _ring_compliance(outer_diameter, outer_raceway, -ratio, modulus)
        tight = max(housing.interference - housing.smoothing + warmed, 0.0)
        outer_pressure = tight / outer_diameter / (around + inside)

    grown = 2.0 * inner_pressure * bore**2 * inner_raceway / (modulus * (inner_raceway**2 - bore**2))
    shrunk = 2.0 * outer_pressure * outer_diameter**2 * outer_raceway
    shrunk /= modulus * (outer_diameter**2 - outer_raceway**2)
    elements = 0.5 * (inner_rise + outer_rise) if element_rise is None else element_rise
    require_finite("temperature rise of the elements", elements)
    between = outer_raceway - inner_raceway
    heat = expansion * (outer_raceway * outer_rise - inner_raceway * inner_rise - between * elements)
    return OperatingClearance(clearance - grown - shrunk + heat, -grown, -shrunk, heat, inner_pressure, outer_pressure)


def thermal_offset(
    distance: float,
    shaft_rise: float,
    housing_rise: float,
    *,
    shaft_expansion: float = _STEEL_EXPANSION,
    housing_expansion: float = _STEEL_EXPANSION,
) -> float:
    """Growth of a shaft over its housing between two bearings, L (α_s ΔT_s − α_h ΔT_h) [m].

    Of two opposed rows the ``axial_offset`` together grows by it where the shaft presses them apart, face to face, and
    falls by it back to back.

    Parameters
    ----------
    distance : float
        Distance L between the bearings [m].
    shaft_rise, housing_rise : float
        Temperatures over the one at which the offsets hold [K].
    shaft_expansion, housing_expansion : float
        Thermal expansion [1/K]; steel unless given.

    Raises
    ------
    RotorError
        A number that is not finite.
    """
    for label, value in (
        ("distance", distance),
        ("rise of the shaft", shaft_rise),
        ("rise of the housing", housing_rise),
    ):
        require_finite(f"{label} between bearings", value)
    return distance * (shaft_expansion * shaft_rise - housing_expansion * housing_rise)


def _ring_compliance(fit: float, free: float, ratio: float, modulus: float) -> float:
    """Relative growth of a ring at its fit under a pressure of 1 Pa there: [(c² + b²)/|c² − b²| ± ν]/E."""
    if math.isinf(free):
        return (1.0 + ratio) / modulus
    return ((free**2 + fit**2) / abs(free**2 - fit**2) + ratio) / modulus
