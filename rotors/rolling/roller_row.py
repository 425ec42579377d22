"""Roller row of a cylindrical-roller bearing, by its geometry."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from rotors.errors import require, require_count, require_finite

from .elasticity import STEEL, ContactElasticity
from .room import require_space

FloatArray = npt.NDArray[np.float64]

Profile = Literal["straight", "logarithmic"]
# ISO 16281's line contact of both raceways in series: q = 35 948 L^{8/9} δ^{10/9} in N and mm.
_PALMGREN_STEEL = 35948.0 * 1000.0 ** (8.0 / 9.0) * 1000.0 ** (10.0 / 9.0)


@dataclass(frozen=True)
class RollerRow:
    """One row of cylindrical rollers, which carry no axial load.

    Parameters
    ----------
    count
        Rollers, three or more.
    roller_diameter, length, pitch_diameter
        D, the effective length L of contact and the diameter of the rollers' centres, m.
    clearance
        Diametral, m; negative is an interference.
    profile
        ``"straight"``, or ``"logarithmic"`` as ISO 16281 takes it where nothing else is known.
    slices
        Number of laminae of a roller; ISO 16281 requires 30 or more.
    position
        Of the rollers' middles from the bearing's centre along z, m.
    elasticity
        Steel unless given.

    Raises
    ------
    RotorError
        Invalid geometry, such as rollers that do not fit on the pitch circle.
    """

    count: int
    roller_diameter: float
    length: float
    pitch_diameter: float
    clearance: float = 0.0
    profile: Profile = "logarithmic"
    slices: int = 31
    position: float = 0.0
    elasticity: ContactElasticity = STEEL

    def __post_init__(self) -> None:
        require_space("roller", self.count, self.roller_diameter, self.pitch_diameter)
        require_finite("roller length", self.length, positive=True)
        require_count("count of slices", self.slices)
        known = self.profile in ("straight", "logarithmic")
        require(known, "roller profile", self.profile, "'straight' or 'logarithmic'")
        for what in ("clearance", "position"):
            require_finite(what, getattr(self, what))

    @property
    def element_diameter(self) -> float:
        """Of the rollers, m."""
        return self.roller_diameter

    def cage_speed(self, speed: float) -> float:
        """Speed of the cage with the inner ring turning at ``speed`` and the outer at rest, ½ (1 − D/D_pw) Ω, rad/s."""
        return 0.5 * (1.0 - self.roller_diameter / self.pitch_diameter) * speed

    @property
    def stiffness(self) -> float:
        """c of one straight roller between both raceways, Q = c δ^{10/9}, N/m^{10/9}.

        35 948 L^{8/9} in N and mm (Palmgren; ISO 16281), for the steel that `ContactElasticity` holds by default, and
        in proportion to E* for others: Palmgren's δ goes as (1/E*)^{0.9}.
        """
        relative = self.elasticity.contact_modulus / STEEL.contact_modulus
        return float(_PALMGREN_STEEL * self.length ** (8.0 / 9.0) * relative)

    @property
    def slice_places(self) -> FloatArray:
        """Middles of the slices from the roller's middle, (slices,), m."""
        return self.length * ((np.arange(self.slices) + 0.5) / self.slices - 0.5)

    @property
    def slice_drops(self) -> FloatArray:
        """Profile drop P at each slice, (slices,), m.

        ISO 16281: P = 0.00035 D ln[1 / (1 − (2x/L)²)] for L ≤ 2.5 D; for longer rollers the middle is straight and
        P = 0.0005 D ln[1 / (1 − ((2|x| − L + 2.5 D) / 2.5 D)²)] at its ends.
        """
        if self.profile == "straight":
            return np.zeros(self.slices)
        x, span = np.abs(self.slice_places), 2.5 * self.roller_diameter
        if self.length <= span:
            return np.asarray(-0.00035 * self.roller_diameter * np.log1p(-((2.0 * x / self.length) ** 2)))
        into_end = np.maximum(2.0 * x - self.length + span, 0.0) / span
        return np.asarray(-0.0005 * self.roller_diameter * np.log1p(-(into_end**2)))
